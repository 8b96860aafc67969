//! Categories of a data set.

use reality_sim_core::field::FieldDimensions;

use super::records::Category;
use crate::class::Class;

/// Category of the whole field; those of the classes have the classes' numbers.
pub const FIELD_CATEGORY: u32 = 100;

/// Returns the categories of pictures of a field: all classes but [`Class::Outside`], and the field, whose keypoints are its
/// crossings and marks.
pub fn categories(field: &FieldDimensions) -> Vec<Category> {
    let of_class = |class: Class| Category {
        id: class.number().into(),
        name: class.name().to_owned(),
        supercategory: if class > Class::Goal { "object" } else { "field" }.to_owned(),
        keypoints: None,
        keypoint_places_m: None,
        skeleton: None,
    };
    let crossings = field.crossings();
    let names = crossings.iter().enumerate().map(|(index, crossing)| {
        let number = crossings[..=index].iter().filter(|earlier| earlier.kind == crossing.kind).count();
        format!("{}_{number}", crossing.kind.name())
    });
    let whole = Category {
        id: FIELD_CATEGORY,
        name: "field".to_owned(),
        supercategory: "field".to_owned(),
        keypoints: Some(names.collect()),
        keypoint_places_m: Some(crossings.iter().map(|at| at.point_in_world.to_array()).collect()),
        skeleton: Some(Vec::new()),
    };
    Class::ALL.into_iter().filter(|class| *class != Class::Outside).map(of_class).chain([whole]).collect()
}
