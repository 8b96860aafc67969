//! Setters of settings.

/// Writes a setter for each field: a method that replaces the field's value and returns the settings.
macro_rules! setters {
    ($config:ty { $($setter:ident: $field:ident = $value:ty,)+ }) => {
        impl $config {
            $(
                #[doc = concat!("Replaces [`Self::", stringify!($field), "`].")]
                pub fn $setter(self, $field: $value) -> Self {
                    Self { $field, ..self }
                }
            )+
        }
    };
}

pub(crate) use setters;
