use proptest::prelude::*;
use reality_sim_core::field::{FieldDimensions, preset_names};

use super::*;

/// Decodes run lengths by the description in pycocotools' `maskApi.c`, and paints them.
fn decoded(rle: &Rle) -> Vec<bool> {
    let [height, width] = rle.size.map(|side| side as usize);
    let (mut runs, mut bytes) = (Vec::<i64>::new(), rle.counts.bytes());
    while bytes.len() > 0 {
        let (mut value, mut shift) = (0_i64, 0);
        loop {
            let group = i64::from(bytes.next().unwrap() - 48);
            value |= (group & 0x1f) << shift;
            shift += 5;
            if group & 0x20 == 0 {
                if group & 0x10 != 0 {
                    value |= -1 << shift;
                }
                break;
            }
        }
        let before = if runs.len() > 2 { runs[runs.len() - 2] } else { 0 };
        runs.push(value + before);
    }
    let mut columns = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        columns.extend(std::iter::repeat_n(index % 2 == 1, usize::try_from(*run).unwrap()));
    }
    assert_eq!(columns.len(), width * height);
    (0..width * height).map(|index| columns[index % width * height + index / width]).collect()
}

proptest! {
    #[test]
    fn a_mask_is_what_its_run_lengths_say(
        width in 1_u32..40,
        height in 1_u32..300,
        // Long runs and short ones.
        seeds in prop::collection::vec((any::<bool>(), 1_usize..400), 1..200),
    ) {
        let pixels = (width * height) as usize;
        let runs = seeds.iter().flat_map(|(inside, length)| std::iter::repeat_n(*inside, *length));
        let mask: Vec<bool> = runs.chain(std::iter::repeat(false)).take(pixels).collect();
        let rle = Rle::new([width, height], |index| mask[index]);
        prop_assert_eq!(decoded(&rle), mask);
    }
}

/// Strings that pycocotools 2.0.11 makes: `mask.encode(numpy.asfortranarray(mask))["counts"]`.
#[test]
fn run_lengths_are_those_of_pycocotools() {
    let counts = |size, mask: fn(usize) -> bool| Rle::new(size, mask).counts;
    assert_eq!(counts([4, 3], |_| false), "<");
    assert_eq!(counts([4, 3], |_| true), "0<");
    assert_eq!(counts([5, 4], |index| index % 3 == 0), "0120O030M010O01");
}

#[test]
fn categories_have_one_number_and_name_each_and_keypoints_are_named_once() {
    for name in preset_names() {
        let field = FieldDimensions::preset(name).unwrap();
        let categories = categories(&field);
        for (index, category) in categories.iter().enumerate() {
            let others = &categories[index + 1..];
            assert!(others.iter().all(|other| other.id != category.id && other.name != category.name));
        }
        let keypoints = categories.iter().find(|category| category.id == FIELD_CATEGORY).unwrap();
        let mut names = keypoints.keypoints.clone().unwrap();
        assert_eq!(names.len(), field.crossings().len());
        assert_eq!(names.len(), keypoints.keypoint_places_m.as_ref().unwrap().len());
        names.sort();
        names.dedup();
        assert_eq!(names.len(), field.crossings().len(), "{name}");
    }
}
