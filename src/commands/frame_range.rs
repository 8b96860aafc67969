//! Ranges of frames, as options give them.

use std::ops::Range;

/// Half-open range of frames, counted from 0; a missing bound leaves that side open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    /// First frame of the range.
    pub first: usize,
    end: Option<usize>,
}

impl FrameRange {
    /// Parses `A..B`, `A..` or `..B`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let form = || "give A..B, A.. or ..B with A below B, counted from 0".to_owned();
        let (first, end) = text.split_once("..").ok_or_else(form)?;
        let number =
            |text: &str| if text.is_empty() { Ok(None) } else { text.parse().map(Some).map_err(|_| form()) };
        let (first, end) = (number(first.trim())?.unwrap_or(0), number(end.trim())?);
        if end.is_some_and(|end| end <= first) { Err(form()) } else { Ok(Self { first, end }) }
    }

    /// Returns the range among this many frames, which may end before the range does.
    pub fn among(self, count: usize) -> Range<usize> {
        self.first..self.end.unwrap_or(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_half_open_and_may_be_open() {
        let range = |text| FrameRange::parse(text).map(|range| range.among(20));
        assert_eq!(range("3..8"), Ok(3..8));
        assert_eq!(range("3.."), Ok(3..20));
        assert_eq!(range("..8"), Ok(0..8));
        for wrong in ["", "5", "8..3", "3..3", "-1..4", "a..b", "1..2..3", "1...4"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
    }
}
