//! Points on the centres of the white lines that a picture shows, found without knowing where the camera is.

mod cells;

use std::ops::RangeInclusive;

use glam::DVec2;
use image::{GrayImage, RgbImage};

use self::cells::PointCells;
use super::{FieldBorder, LineScale, WhiteLevels, white_line::flank_distances};

/// Minimum step between the rows, and between the columns, that are looked along, pixels.
const LEAST_STEP_PX: usize = 6;
/// Number of columns or rows that are looked along in larger pictures, so that the work does not grow with their size.
const MOST_SCANS: usize = 160;
/// Distance within which points belong together, in steps: on one line they are about a step apart.
const NEIGHBOUR_STEPS: f64 = 1.7;
/// Minimum number of other points near one: what stands alone is noise or a speck.
const LEAST_NEIGHBOURS: usize = 2;
/// Maximum number of points, five times those of a picture full of lines: noise is thinned.
const MOST_POINTS: usize = 2000;

/// Points on the centres of the white lines in one picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinePoints {
    /// Columns and rows, pixels, to about half a pixel.
    pub points: Vec<DVec2>,
    /// Length of line that a point stands for, pixels. A line at 45° has up to 1.4 times as many points.
    pub spacing_px: f64,
}

impl LinePoints {
    /// Returns the distance within which two points belong to the same line, pixels.
    pub fn neighbour_px(&self) -> f64 {
        NEIGHBOUR_STEPS * self.spacing_px
    }

    /// Keeps the points that have others beside them, and of too many every few.
    fn without_specks(self, size: [usize; 2]) -> Self {
        let near = self.neighbour_px();
        let cells = PointCells::new(&self.points, size, near);
        let has_neighbours = |point: &&DVec2| {
            let beside = cells.around(**point).filter(|other| point.distance(*other) <= near);
            // The point itself is among them.
            beside.count() > LEAST_NEIGHBOURS
        };
        let kept: Vec<DVec2> = self.points.iter().filter(has_neighbours).copied().collect();
        let every = kept.len().div_ceil(MOST_POINTS).max(1);
        Self { points: kept.into_iter().step_by(every).collect(), ..self }
    }
}

/// Picture in which lines are looked for.
pub(super) struct LineScan<'a> {
    pub picture: &'a RgbImage,
    pub whiteness: &'a GrayImage,
    pub border: &'a FieldBorder,
    pub scale: LineScale,
    pub levels: &'a WhiteLevels,
}

impl LineScan<'_> {
    /// Finds the centres of white lines: along every few rows and columns, the middle of each stretch that is brighter than both
    /// its flanks, on carpet. A line of any direction so gets a point every few pixels of its length, however broad it is.
    pub fn line_points(&self) -> LinePoints {
        let size = [self.whiteness.width() as usize, self.whiteness.height() as usize];
        let step = LEAST_STEP_PX.max(size[0].max(size[1]) / MOST_SCANS);
        let mut points = Vec::new();
        for direction in [Direction::Row, Direction::Column] {
            let [length, across] = direction.in_order(size);
            for at in (step / 2..across).step_by(step) {
                let middles = self.middles(direction, at, length);
                points.extend(middles.into_iter().map(|middle| direction.point(middle, at as f64)));
            }
        }
        LinePoints { points, spacing_px: step as f64 }.without_specks(size)
    }

    /// Returns the middles of the white stretches of one row or column.
    fn middles(&self, direction: Direction, across: usize, length: usize) -> Vec<f64> {
        let look = |along: usize| self.look(direction, [along, across], length);
        let (mut found, mut begin, mut before) = (Vec::new(), None, Look::Unknown);
        for along in 0..=length {
            let here = if along < length { look(along) } else { Look::Unknown };
            match (before, here) {
                (Look::Dark, Look::White) => begin = Some(along),
                (Look::White, Look::Dark) => {
                    let stretch = begin.map(|first| first..=along - 1);
                    let on_carpet = stretch.filter(|s| self.lies_on_carpet(direction, s, across));
                    found.extend(on_carpet.map(|s| 0.5 * (s.start() + s.end()) as f64));
                }
                _ => {}
            }
            if here != Look::White {
                begin = None;
            }
            before = here;
        }
        found
    }

    fn look(&self, direction: Direction, [along, across]: [usize; 2], length: usize) -> Look {
        let value = |along| {
            let [u, v] = direction.pixel([along, across]);
            self.whiteness.get_pixel(u, v).0[0]
        };
        // Most pixels are darker than any line: they need no look at their flanks.
        let Some(level) = value(along).checked_sub(self.levels.threshold) else { return Look::Dark };
        let Some(flank) = self.flank(direction, [along, across]) else { return Look::Unknown };
        if along < flank || along + flank >= length {
            return Look::Unknown;
        }
        if level > value(along - flank) && level > value(along + flank) { Look::White } else { Look::Dark }
    }

    /// Returns the distance of a pixel's flanks along the row or column, pixels; `None` outside the border.
    fn flank(&self, direction: Direction, place: [usize; 2]) -> Option<usize> {
        let [beside, above] = flank_distances(self.border, self.scale, direction.pixel(place))?;
        Some(match direction {
            Direction::Row => beside,
            Direction::Column => above,
        })
    }

    /// Returns whether there is carpet on both sides of a white stretch: white things that stand on the field are no lines.
    fn lies_on_carpet(&self, direction: Direction, stretch: &RangeInclusive<usize>, across: usize) -> bool {
        let middle = (stretch.start() + stretch.end()) / 2;
        let Some(flank) = self.flank(direction, [middle, across]) else { return false };
        [middle.checked_sub(flank), Some(middle + flank)].into_iter().all(|along| {
            let pixel = along.map(|along| direction.pixel([along, across]));
            let color = pixel.and_then(|[u, v]| self.picture.get_pixel_checked(u, v));
            color.is_some_and(|color| self.border.carpet.may_be_carpet(color.0))
        })
    }
}

/// What a pixel is.
#[derive(Clone, Copy, PartialEq)]
enum Look {
    White,
    Dark,
    /// Bright, with flanks outside the picture or the border: a stretch that ends here has no known middle.
    Unknown,
}

/// Direction in which a picture is looked along.
#[derive(Clone, Copy, PartialEq)]
enum Direction {
    Row,
    Column,
}

impl Direction {
    /// Orders two numbers that belong to columns and rows: that along the direction first.
    fn in_order<T>(self, [u, v]: [T; 2]) -> [T; 2] {
        match self {
            Self::Row => [u, v],
            Self::Column => [v, u],
        }
    }

    fn pixel(self, place: [usize; 2]) -> [u32; 2] {
        self.in_order(place.map(|at| at as u32))
    }

    fn point(self, along: f64, across: f64) -> DVec2 {
        self.in_order([along, across]).into()
    }
}

#[cfg(test)]
mod tests;
