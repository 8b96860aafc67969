//! Reference poses in words.

use crate::recording::ReferenceSource;

/// Returns the source of the poses.
pub fn reference_source(source: ReferenceSource) -> &'static str {
    match source {
        ReferenceSource::Measured => "measured by something else than the pictures",
        ReferenceSource::Tagged => "found in the pictures; height, pitch and roll are those of the robot",
    }
}

/// Returns what poses estimated from the pictures themselves cannot show; empty for measured poses.
pub fn absorbed(source: ReferenceSource) -> &'static str {
    match source {
        ReferenceSource::Measured => "",
        ReferenceSource::Tagged => {
            "place and heading were found in these pictures: whatever moves all lines as another place or heading would is in \
             the poses and not seen here (a camera turned sideways on the robot, part of a time offset while the robot turns); \
             pitch, roll and height are the robot's own, effects on them are seen against those"
        }
    }
}
