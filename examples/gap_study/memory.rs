//! Peak memory of a run, where the system tells it.

use std::fs;

/// Starts a new measurement of the peak.
pub fn reset() {
    // Where this is not possible, there is no peak to read either, or that of the whole study.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Returns memory in megabytes: what is held now, and the peak since the last reset.
pub fn now_and_peak_mb() -> Option<[f64; 2]> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let of = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse::<f64>().ok().map(|kilobytes| kilobytes / 1024.0)
    };
    Some([of("VmRSS:")?, of("VmHWM:")?])
}
