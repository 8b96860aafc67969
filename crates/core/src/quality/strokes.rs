//! Strokes: points of a picture that hang together.

use glam::DVec2;

/// Returns the number of groups of at least `least` points in which each is within `near_px` of another one.
pub(super) fn count_strokes(mut points: Vec<DVec2>, near_px: f64, least: usize) -> u32 {
    let mut strokes = 0;
    while let Some(first) = points.pop() {
        let mut group = vec![first];
        let mut next = 0;
        while let Some(&point) = group.get(next) {
            next += 1;
            group.extend(points.extract_if(.., |other| other.distance(point) <= near_px));
        }
        strokes += u32::from(group.len() >= least);
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_are_what_hangs_together_and_is_long_enough() {
        let line = |v: f64, count: u32| (0..count).map(move |i| DVec2::new(6.0 * f64::from(i), v));
        let points: Vec<DVec2> = line(0.0, 9).chain(line(50.0, 12)).chain(line(100.0, 3)).collect();
        assert_eq!(count_strokes(points.clone(), 10.0, 8), 2);
        assert_eq!(count_strokes(points.clone(), 10.0, 10), 1);
        assert_eq!(count_strokes(points.clone(), 60.0, 1), 1);
        assert_eq!(count_strokes(points, 5.0, 2), 0);
        assert_eq!(count_strokes(Vec::new(), 5.0, 0), 0);
    }
}
