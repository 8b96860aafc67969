//! Calibration from the lines of the field: lens, mount and all poses of a recording together.
