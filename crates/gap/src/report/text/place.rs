//! Places in the picture and on the field.

use reality_sim_sensor::text::rounded;

/// Where a cell of the picture's grid lies, cells counted from the upper left: "left of the middle, in the lower part".
pub(crate) fn picture_place(cell: (i32, i32), grid: [usize; 2]) -> String {
    let across = [
        "at the left edge",
        "left of the middle",
        "in the middle",
        "right of the middle",
        "at the right edge",
    ];
    let down = ["at the top", "in the upper part", "at half height", "in the lower part", "at the bottom"];
    let [column, row] = [fifth(cell.0, grid[0]), fifth(cell.1, grid[1])];
    if (column, row) == (2, 2) { across[2].to_owned() } else { format!("{}, {}", across[column], down[row]) }
}

/// In which fifth of the cells a cell lies.
fn fifth(cell: i32, cells: usize) -> usize {
    let middle = (f64::from(cell) + 0.5) / cells.max(1) as f64;
    (5.0 * middle).clamp(0.0, 4.0) as usize
}

/// The middle of a square cell of the field whose corner with the least coordinates is given, metres:
/// "around x = 1.5 m, y = −0.5 m".
pub(crate) fn field_place(x0_m: f64, y0_m: f64, side_m: f64) -> String {
    let middle = |from_m: f64| rounded(from_m + 0.5 * side_m, 1);
    format!("around x = {} m, y = {} m", middle(x0_m), middle(y0_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_the_picture_have_names() {
        let names =
            [((0, 0), "at the left edge, at the top"), ((2, 4), "left of the middle, in the lower part")];
        for (cell, name) in names {
            assert_eq!(picture_place(cell, [8, 6]), name);
        }
        assert_eq!(picture_place((4, 2), [9, 5]), "in the middle");
        assert_eq!(picture_place((7, 5), [8, 6]), "at the right edge, at the bottom");
    }

    #[test]
    fn cells_outside_of_the_grid_are_at_its_edge() {
        assert_eq!(picture_place((-3, 99), [8, 6]), "at the left edge, at the bottom");
        assert_eq!(picture_place((0, 0), [0, 0]), "in the middle");
    }

    #[test]
    fn cells_of_the_field_are_named_by_their_middle() {
        assert_eq!(field_place(1.0, -1.0, 1.0), "around x = 1.5 m, y = −0.5 m");
    }
}
