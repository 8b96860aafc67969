//! Labels in the form of COCO, the format of Lin et al., "Microsoft COCO: common objects in context", ECCV 2014, as the package
//! pycocotools reads it. Keys that COCO does not know are beside its own.
//!
//! | category | annotations of a picture |
//! |---|---|
//! | `carpet`, `line` | one, of all pixels of the class |
//! | `goal`, `ball`, `robot` | one for each that is seen |
//! | `field` | one, of the pixels of carpet and lines; its keypoints are the crossings and marks of the field |

mod annotations;
mod categories;
mod records;
mod rle;

pub use self::{
    annotations::{annotations, crossings, lines},
    categories::{FIELD_CATEGORY, categories},
    records::{Annotation, Category, SeenCrossingRecord, SeenLineRecord},
    rle::Rle,
};

#[cfg(test)]
mod tests;
