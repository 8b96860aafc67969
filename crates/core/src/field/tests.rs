mod crossings;
mod presets;
mod sampling;
mod validation;
mod visibility;

use proptest::prelude::*;

use super::*;

fn any_preset() -> impl Strategy<Value = FieldDimensions> {
    proptest::sample::select(preset_names().collect::<Vec<_>>())
        .prop_map(|name| FieldDimensions::preset(name).unwrap())
}
