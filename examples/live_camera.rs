//! A camera that delivers 30 pictures a second, whether they can be localized or not: the demonstration walk, played six times as
//! fast as it was recorded. Ends by itself.
//! `cargo run --release --example live_camera`, or with a recording and a rate: `… --example live_camera -- assets/walk 60`.

#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use std::{
    env,
    error::Error,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use reality_sim::{
    Localizer, Observation, Sequence, SequenceError,
    evaluation::{PoseError, percentile},
    localization::{LiveFeed, LiveFrame, LiveLocalizer, Pushed},
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| "assets/walk".to_owned());
    let rate_hz: f64 = arguments.next().map_or(Ok(30.0), |rate| rate.parse())?;
    if !(1.0..=1000.0).contains(&rate_hz) {
        return Err("give a rate from 1 to 1000 pictures a second".into());
    }

    let walk = Sequence::open(Path::new(&folder))?;
    let localizer = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build()?;
    let mut live = LiveLocalizer::new(localizer);
    // A camera decodes no files: all pictures are there before it starts.
    let pictures: Vec<Observation> =
        (0..walk.frames.len()).map(|index| observe(&walk, index)).collect::<Result<_, _>>()?;
    let feed = live.feed();
    let camera = thread::spawn(move || deliver(&feed, pictures, rate_hz));

    let mut latencies_s = Vec::new();
    // The camera closes the feed after its last picture; then the results end.
    while let Some(result) = live.wait() {
        let result = result?;
        print_frame(&walk, &result);
        latencies_s.push(result.latency_s);
    }
    let dropped = camera.join().map_err(|_| "the camera panicked")?;
    latencies_s.sort_by(f64::total_cmp);
    let latency_ms = |part| 1e3 * percentile(&latencies_s, part).unwrap_or(0.0);
    println!(
        "{} localized, {dropped} dropped; latency {:.0} ms in the median, {:.0} ms at most",
        latencies_s.len(),
        latency_ms(0.5),
        latency_ms(1.0)
    );
    Ok(())
}

fn observe(walk: &Sequence, index: usize) -> Result<Observation, SequenceError> {
    Ok(Observation::of_frame(walk, index, walk.load_image(index)?))
}

/// Delivers the pictures by the clock, and returns how many were dropped.
fn deliver(feed: &LiveFeed, pictures: Vec<Observation>, rate_hz: f64) -> u64 {
    let begin = Instant::now();
    for (index, picture) in pictures.into_iter().enumerate() {
        let due = begin + Duration::from_secs_f64(index as f64 / rate_hz);
        thread::sleep(due.saturating_duration_since(Instant::now()));
        if feed.push(picture) == Pushed::Refused {
            break;
        }
    }
    feed.close();
    feed.dropped()
}

fn print_frame(walk: &Sequence, LiveFrame { frame, dropped_before, latency_s }: &LiveFrame) {
    let record = walk.frames.iter().find(|record| record.timestamp_s == frame.timestamp_s);
    let truth = record.and_then(|record| record.reference_pose);
    let error = truth.map(|truth| 100.0 * PoseError::new(frame.pose, truth).distance_m);
    println!(
        "{:6.2} s: {:6.3} m {:6.3} m {:6.1}°{}, {:3.0} ms old{}{}",
        frame.timestamp_s,
        frame.pose.x_m,
        frame.pose.y_m,
        frame.pose.yaw_rad.to_degrees(),
        error.map_or(String::new(), |error_cm| format!(", {error_cm:.1} cm off")),
        1e3 * latency_s,
        if frame.sure { "" } else { ", not sure" },
        if *dropped_before > 0 { format!(", {dropped_before} dropped before") } else { String::new() },
    );
}
