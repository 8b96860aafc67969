//! Indices of the frames and views of a recording, and values by frame.

use std::ops::{Index, IndexMut};

/// Index of a frame among those of a [`Recording`](crate::recording::Recording), which are compared with a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct FrameIndex(usize);

impl FrameIndex {
    /// Iterates over the first `count` frames.
    pub(crate) fn first(count: usize) -> impl Iterator<Item = Self> {
        (0..count).map(Self)
    }

    /// Returns the index of the following frame, which may not exist.
    pub(crate) fn next(self) -> Self {
        Self(self.0 + 1)
    }
}

/// Index of a view: successive frames from one place, in order of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct ViewIndex(pub(crate) usize);

/// One value for each frame of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PerFrame<T>(Vec<T>);

impl<T> PerFrame<T> {
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the value of a frame. None if the frame does not exist.
    pub(crate) fn get(&self, frame: FrameIndex) -> Option<&T> {
        self.0.get(frame.0)
    }

    pub(crate) fn iter(&self) -> std::slice::Iter<'_, T> {
        self.0.iter()
    }

    /// Iterates over the values, each with the index of its frame.
    pub(crate) fn indexed(&self) -> impl Iterator<Item = (FrameIndex, &T)> {
        self.0.iter().enumerate().map(|(index, value)| (FrameIndex(index), value))
    }

    pub(crate) fn as_slice(&self) -> &[T] {
        &self.0
    }
}

impl<T> Index<FrameIndex> for PerFrame<T> {
    type Output = T;

    fn index(&self, frame: FrameIndex) -> &T {
        &self.0[frame.0]
    }
}

impl<T> IndexMut<FrameIndex> for PerFrame<T> {
    fn index_mut(&mut self, frame: FrameIndex) -> &mut T {
        &mut self.0[frame.0]
    }
}

impl<'a, T> IntoIterator for &'a PerFrame<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<T> FromIterator<T> for PerFrame<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self(values.into_iter().collect())
    }
}

impl<T> From<Vec<T>> for PerFrame<T> {
    fn from(values: Vec<T>) -> Self {
        Self(values)
    }
}
