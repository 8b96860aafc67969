//! Report of an analysis: numbers first ([`Report`]), then the text and the page made from them.

pub(crate) mod analysis;
pub(crate) mod data;
mod file;
pub mod html;
mod json;
pub(crate) mod maps;
pub(crate) mod pictures;
pub mod text;

pub use self::{
    analysis::Analysis,
    data::*,
    file::{Contradiction, ReportError, ReportFault},
    pictures::{Pictures, PicturesError},
};
pub use crate::{
    diagnostics::{
        finding::{FieldLine, Finding, Movement, NominalValue, OdometryComponent, PatternCell},
        input_mistake::InputMistake,
        object::{Object, ObjectMotion},
    },
    inference::detection_limit::{MissingInput, UnobservableCause},
    measurement::quantity::{Channel, ColorChannel},
};
