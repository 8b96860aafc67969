//! Time and frame of a message.

use crate::{log::LATEST_NS, schema::View};

/// Nanoseconds in a second.
const SECOND_NS: i64 = 1_000_000_000;

/// Time and frame of a message.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Header {
    /// Time of what the message tells, nanoseconds; `None` if it is zero or not there.
    pub stamp_ns: Option<i64>,
    /// Name of the frame, without a slash before it.
    pub frame: String,
}

impl Header {
    /// Reads the header of a message of ROS (`header`) or Foxglove (`timestamp`, `frame_id`).
    pub fn of(message: &View<'_>) -> Self {
        let header = message.field("header").unwrap_or(*message);
        let frame = header.any_field(&["frame_id", "parent_frame_id"]).as_ref().and_then(frame_name);
        let stamp = header.any_field(&["stamp", "timestamp"]);
        Self {
            stamp_ns: stamp
                .and_then(stamp_ns)
                .filter(|stamp| *stamp != 0 && stamp.unsigned_abs() <= LATEST_NS as u64),
            frame: frame.unwrap_or_default(),
        }
    }
}

/// Reads the name of a frame, without the slash that older programs put before it.
pub fn frame_name(view: &View<'_>) -> Option<String> {
    view.text().map(|name| name.trim_start_matches('/').to_owned())
}

/// Reads a time: seconds and nanoseconds, by any of their names, or nanoseconds alone.
fn stamp_ns(view: View<'_>) -> Option<i64> {
    let Some(seconds) = view.any_field(&["sec", "seconds"]) else { return view.integer() };
    let nanos = view.any_field(&["nanosec", "nsec", "nanos", "nanoseconds"])?.integer()?;
    seconds.integer()?.checked_mul(SECOND_NS)?.checked_add(nanos)
}

/// Converts nanoseconds to seconds; to the nearest number where the time is counted from the start of a robot.
pub fn seconds(time_ns: i64) -> f64 {
    if time_ns.unsigned_abs() < 1 << 53 {
        time_ns as f64 / SECOND_NS as f64
    } else {
        (time_ns / SECOND_NS) as f64 + (time_ns % SECOND_NS) as f64 / SECOND_NS as f64
    }
}
