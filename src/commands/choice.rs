//! Options whose value is one name of a list.

use std::{error::Error, str::FromStr};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads one of these names.
pub fn one_of<T>(names: impl IntoIterator<Item: Into<PossibleValue>>) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Error + Send + Sync + 'static> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

/// A name with a line that says what it stands for.
pub fn described(name: &'static str, description: &'static str) -> PossibleValue {
    PossibleValue::new(name).help(description)
}
