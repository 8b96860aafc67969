//! White lines of the field as curves on the ground (line centres), its marks and its goals.

use std::f64::consts::TAU;

use glam::DVec2;

use super::FieldDimensions;

/// Half the side of the penalty and centre marks, metres: they are drawn as squares parallel to the lines.
pub const MARK_HALF_SIDE_M: f64 = 0.05;

/// Kind of a white line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LineKind {
    /// Line along a side of the field.
    TouchLine,
    /// Line across an end of the field.
    GoalLine,
    /// Line across the middle of the field.
    HalfwayLine,
    /// Line around a goal area.
    GoalArea,
    /// Line around a penalty area.
    PenaltyArea,
    /// Centre circle.
    CenterCircle,
}

impl LineKind {
    /// Returns the name of the kind in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TouchLine => "touch_line",
            Self::GoalLine => "goal_line",
            Self::HalfwayLine => "halfway_line",
            Self::GoalArea => "goal_area",
            Self::PenaltyArea => "penalty_area",
            Self::CenterCircle => "center_circle",
        }
    }
}

/// Centre line of a white line on the ground, world axes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// A straight line.
    Segment {
        /// First end.
        from: DVec2,
        /// Second end.
        to: DVec2,
    },
    /// A full circle.
    Circle {
        /// Centre.
        center: DVec2,
        /// Radius of the line's centre.
        radius_m: f64,
    },
}

impl Curve {
    /// Returns the length along the curve, metres.
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Segment { from, to } => from.distance(*to),
            Self::Circle { radius_m, .. } => TAU * radius_m,
        }
    }

    /// Returns point and unit tangent at a fraction (0–1) of the length.
    pub fn at(&self, fraction: f64) -> (DVec2, DVec2) {
        match self {
            Self::Segment { from, to } => {
                (from.lerp(*to, fraction), (*to - *from).try_normalize().unwrap_or(DVec2::X))
            }
            Self::Circle { center, radius_m } => {
                let direction = DVec2::from_angle(TAU * fraction);
                (*center + *radius_m * direction, direction.perp())
            }
        }
    }

    /// Returns the distance of a point from the curve, metres.
    pub fn distance_m(&self, point: DVec2) -> f64 {
        match self {
            Self::Segment { from, to } => {
                let along = *to - *from;
                let squared = along.length_squared().max(f64::MIN_POSITIVE);
                let fraction = ((point - *from).dot(along) / squared).clamp(0.0, 1.0);
                point.distance(*from + fraction * along)
            }
            Self::Circle { center, radius_m } => (point.distance(*center) - radius_m).abs(),
        }
    }
}

/// Upright cylinder on the carpet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoalPost {
    /// Axis of the cylinder on the ground, world axes, metres.
    pub center: DVec2,
    /// Radius, metres.
    pub radius_m: f64,
    /// Height above the carpet, metres.
    pub height_m: f64,
}

/// Goal: two posts joined by a crossbar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Left and right post as seen from the field's centre.
    pub posts: [GoalPost; 2],
}

impl FieldDimensions {
    /// Returns the centre lines of all white lines.
    pub fn curves(&self) -> Vec<Curve> {
        self.lines().into_iter().map(|(_, curve)| curve).collect()
    }

    /// Returns the centre lines of all white lines with their kinds, in the order of [`FieldDimensions::curves`].
    pub fn lines(&self) -> Vec<(LineKind, Curve)> {
        let (half_length, half_width) = (self.length_m / 2.0, self.width_m / 2.0);
        let segment = |kind, x0, y0, x1, y1| {
            (kind, Curve::Segment { from: DVec2::new(x0, y0), to: DVec2::new(x1, y1) })
        };
        let mut lines = vec![
            segment(LineKind::TouchLine, -half_length, -half_width, half_length, -half_width),
            segment(LineKind::TouchLine, -half_length, half_width, half_length, half_width),
            segment(LineKind::GoalLine, -half_length, -half_width, -half_length, half_width),
            segment(LineKind::GoalLine, half_length, -half_width, half_length, half_width),
            segment(LineKind::HalfwayLine, 0.0, -half_width, 0.0, half_width),
        ];
        let goal_area = (LineKind::GoalArea, self.goal_area_length_m, self.goal_area_width_m);
        let penalty_area = self.penalty_area_length_m.zip(self.penalty_area_width_m);
        let penalty_area = penalty_area.map(|(depth, width)| (LineKind::PenaltyArea, depth, width));
        for (kind, depth, width) in [Some(goal_area), penalty_area].into_iter().flatten() {
            if depth <= 0.0 || width <= 0.0 {
                continue;
            }
            for side in [-1.0, 1.0] {
                let (goal_line, front) = (side * half_length, side * (half_length - depth));
                lines.push(segment(kind, front, -width / 2.0, front, width / 2.0));
                lines.push(segment(kind, goal_line, -width / 2.0, front, -width / 2.0));
                lines.push(segment(kind, goal_line, width / 2.0, front, width / 2.0));
            }
        }
        if self.center_circle_diameter_m > 0.0 {
            let circle = Curve::Circle { center: DVec2::ZERO, radius_m: self.center_circle_diameter_m / 2.0 };
            lines.push((LineKind::CenterCircle, circle));
        }
        lines
    }

    /// Returns the centres of the penalty marks and of the centre mark.
    pub fn marks(&self) -> [DVec2; 3] {
        let x = self.length_m / 2.0 - self.penalty_mark_distance_m;
        [DVec2::new(-x, 0.0), DVec2::ZERO, DVec2::new(x, 0.0)]
    }

    /// Returns the goals at −x and at +x.
    pub fn goals(&self) -> [Goal; 2] {
        [-1.0, 1.0].map(|side| {
            let radius_m = self.goal_post_diameter_m / 2.0;
            let y = self.goal_width_m / 2.0 + radius_m;
            let post = |y| GoalPost {
                center: DVec2::new(side * self.length_m / 2.0, y),
                radius_m,
                height_m: self.goal_height_m + self.goal_post_diameter_m,
            };
            Goal { posts: [post(side * y), post(-side * y)] }
        })
    }
}
