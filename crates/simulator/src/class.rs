//! What a pixel shows.

/// Class of a pixel, of a box or of a mask. The number of a class stays the same in every version.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Class {
    /// Neither field nor object: the hall, its floor beside the carpet, and what the lens leaves black.
    #[default]
    Outside = 0,
    /// Carpet without a line.
    Carpet = 1,
    /// White line or mark.
    Line = 2,
    /// Post, crossbar or net of a goal.
    Goal = 3,
    /// Ball.
    Ball = 4,
    /// Robot.
    Robot = 5,
}

impl Class {
    /// All classes, by their numbers.
    pub const ALL: [Self; 6] = [Self::Outside, Self::Carpet, Self::Line, Self::Goal, Self::Ball, Self::Robot];

    /// Returns the name of the class in files and on screens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Carpet => "carpet",
            Self::Line => "line",
            Self::Goal => "goal",
            Self::Ball => "ball",
            Self::Robot => "robot",
        }
    }

    /// Returns the number of the class.
    pub fn number(self) -> u8 {
        self as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_is_found_by_its_number() {
        for (number, class) in Class::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(class.number()), number, "{}", class.name());
        }
    }
}
