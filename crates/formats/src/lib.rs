//! Logs and models of others in and out: a robot's log becomes a recording, tags and databases become models that other
//! programs read.

pub mod import;
mod input;
pub mod log;
pub mod message;
mod schema;

pub use self::input::Input;
