//! Measurements of pictures: pieces of white line and blocks of plain carpet, where a model predicts them.

pub(crate) mod camera;
pub(crate) mod carpet;
pub(crate) mod curve_index;
pub(crate) mod frame;
pub(crate) mod line_profile;
pub(crate) mod line_search;
pub(crate) mod lines;
pub(crate) mod luma;
pub(crate) mod quantity;
pub(crate) mod quantization;
pub(crate) mod scalar;
pub(crate) mod visibility;
