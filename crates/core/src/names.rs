//! Names by which a person chooses from a list: of models, methods, devices.

/// Name that is not in its list.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{found:?} is no {what}: give one of {}", known.join(", "))]
pub struct UnknownName {
    /// What the list is of, in the singular.
    pub what: &'static str,
    /// The name that was looked for.
    pub found: String,
    /// The names in the list.
    pub known: Vec<&'static str>,
}

/// Returns the entry of a list that has this name; `what` says what the list is of, in the singular.
pub fn by_name<T: Copy>(
    what: &'static str,
    all: &[T],
    name_of: fn(T) -> &'static str,
    name: &str,
) -> Result<T, UnknownName> {
    all.iter().copied().find(|&entry| name_of(entry) == name).ok_or_else(|| UnknownName {
        what,
        found: name.to_owned(),
        known: all.iter().copied().map(name_of).collect(),
    })
}

#[cfg(test)]
mod tests {
    use std::{
        fmt::{Debug, Display},
        str::FromStr,
    };

    use serde::{
        Deserialize,
        de::value::{Error, StrDeserializer},
    };

    use super::*;
    use crate::{
        backend::DeviceChoice,
        filter::{Estimator, Resampling},
        observation::ObservationKind,
    };

    fn check_names<T>(all: &[T], name_of: fn(T) -> &'static str)
    where
        T: Copy + PartialEq + Debug + Display + FromStr<Err = UnknownName>,
    {
        let names: Vec<&str> = all.iter().copied().map(name_of).collect();
        for (&entry, &name) in all.iter().zip(&names) {
            assert_eq!(name.parse(), Ok(entry));
            assert_eq!(entry.to_string(), name);
        }
        let unknown = "Unknown".parse::<T>().unwrap_err();
        assert_eq!((unknown.found.as_str(), unknown.known), ("Unknown", names));
    }

    #[test]
    fn every_name_is_read_back_and_an_unknown_one_lists_those_known() {
        check_names(&ObservationKind::ALL, ObservationKind::name);
        check_names(&Resampling::ALL, Resampling::name);
        check_names(&Estimator::ALL, Estimator::name);
        check_names(&DeviceChoice::ALL, DeviceChoice::name);
    }

    #[test]
    fn files_spell_the_names_alike() {
        fn check<T>(all: &[T], name_of: fn(T) -> &'static str)
        where
            T: Copy + PartialEq + Debug + for<'a> Deserialize<'a>,
        {
            for &entry in all {
                assert_eq!(T::deserialize(StrDeserializer::<Error>::new(name_of(entry))), Ok(entry));
            }
        }
        check(&ObservationKind::ALL, ObservationKind::name);
        check(&Resampling::ALL, Resampling::name);
        check(&Estimator::ALL, Estimator::name);
    }
}
