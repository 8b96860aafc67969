//! What was found: numbers first ([`Report`]), then the text and the page made of them.

pub(crate) mod data;
mod file;
pub mod html;
pub(crate) mod maps;
pub(crate) mod pictures;
pub(crate) mod text;

pub use self::{
    data::*,
    file::{ReportError, ReportFault},
    pictures::{Pictures, PicturesError},
};
