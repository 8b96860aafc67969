//! Which effects the normal equations speak for, and from which size on each would be found.

pub(crate) mod detection_limit;
pub(crate) mod effect_test;
pub(crate) mod evidence;
pub(crate) mod held_out;
pub(crate) mod measured;
pub(crate) mod model_error;
pub(crate) mod model_search;
pub(crate) mod split;
