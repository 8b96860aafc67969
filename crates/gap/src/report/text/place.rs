//! Places in the picture and on the field, in words.

use reality_sim_sensor::text::rounded;

/// Returns where a cell of the picture's grid lies: "left of the middle, in the lower part". Cells count from the upper
/// left.
pub(super) fn picture_place([column, row]: [usize; 2], grid: [usize; 2]) -> String {
    let across = [
        "at the left edge",
        "left of the middle",
        "in the middle",
        "right of the middle",
        "at the right edge",
    ];
    let down = ["at the top", "in the upper part", "at half height", "in the lower part", "at the bottom"];
    let [column, row] = [fifth(column, grid[0]), fifth(row, grid[1])];
    if (column, row) == (2, 2) { across[2].to_owned() } else { format!("{}, {}", across[column], down[row]) }
}

/// Returns the fifth of the grid that a cell lies in.
fn fifth(cell: usize, cells: usize) -> usize {
    let middle = (cell as f64 + 0.5) / cells.max(1) as f64;
    (5.0 * middle).clamp(0.0, 4.0) as usize
}

/// Returns a place on the field, world axes in metres: "around x = 1.5 m, y = −0.5 m".
pub(super) fn field_place(x_m: f64, y_m: f64) -> String {
    format!("around x = {} m, y = {} m", rounded(x_m, 1), rounded(y_m, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_the_picture_have_names() {
        let names =
            [([0, 0], "at the left edge, at the top"), ([2, 4], "left of the middle, in the lower part")];
        for (cell, name) in names {
            assert_eq!(picture_place(cell, [8, 6]), name);
        }
        assert_eq!(picture_place([4, 2], [9, 5]), "in the middle");
        assert_eq!(picture_place([7, 5], [8, 6]), "at the right edge, at the bottom");
    }

    #[test]
    fn cells_outside_of_the_grid_are_at_its_edge() {
        assert_eq!(picture_place([0, 99], [8, 6]), "at the left edge, at the bottom");
        assert_eq!(picture_place([0, 0], [0, 0]), "in the middle");
    }

    #[test]
    fn places_on_the_field_are_given_to_a_tenth_of_a_metre() {
        assert_eq!(field_place(1.5, -0.5), "around x = 1.5 m, y = −0.5 m");
    }
}
