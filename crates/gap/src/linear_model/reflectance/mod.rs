//! Reflectance of carpet and paint, which differs from place to place, as a spatially correlated random field.
//!
//! The natural logarithm of a surface's reflectance relative to its mean is constant within the smallest patches of the field.
//! The value of a patch is that of the patch twice as large that contains it, plus a normal increment whose variance depends on
//! the surface and on the size of the patch (multiscale model on a quadtree: Chou, Willsky and Benveniste, IEEE Transactions on
//! Automatic Control 39, 1994). Two places are therefore the more alike the smaller the patch is that contains both. The
//! variances are estimated from the recording: where most of the variance is, there is the length over which the
//! reflectance is alike.
//!
//! Values are eliminated from the smallest patches up, in a time that grows linearly with their number.

mod elimination;
mod estimation;
mod field;
mod increments;
mod tree;

pub(crate) use self::{
    elimination::{Eliminated, PatchEquations},
    estimation::increment_variances,
    field::ReflectanceField,
    increments::IncrementVariances,
    tree::{PatchIndex, Tree},
};
