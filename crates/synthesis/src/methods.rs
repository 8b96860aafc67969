//! The list of methods.

use crate::{Blend, Method, Nearest, Plane, Quadratic};

/// Methods that can be compared with each other; [`crate::Auto`] chooses among them.
pub const METHODS: [&dyn Method; 4] = [&Nearest, &Quadratic, &Plane, &Blend];
