//! A closed loop: a robot finds itself and a rolling ball in pictures that are made from recorded ones, and follows the ball.
//! It never learns where it truly is; the errors are printed.
//!
//! `cargo run --release --example simulator`, or in another database, with another seed, for longer, with its pictures:
//! `… --example simulator -- --database walk.db --seed 3 --seconds 60 --pictures FOLDER`.
//!
//! | file | what it is |
//! |---|---|
//! | `closed_loop.rs` | the loop |
//! | `world.rs`, `walker.rs`, `rolling_ball.rs`, `noise.rs` | what is so: the true poses, and the noise of what is sensed |
//! | `robot.rs`, `ball_seeing.rs`, `ball_track.rs`, `plan.rs` | what the robot makes of it: it gets `senses.rs`, and no more |
//! | `report.rs` | the two compared |

#![expect(clippy::print_stdout, reason = "an example shows what it does")]

mod ball_seeing;
mod ball_track;
mod closed_loop;
mod noise;
mod plan;
mod report;
mod robot;
mod rolling_ball;
mod senses;
#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]
mod tests;
mod walker;
mod world;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use anyhow::Context;
use clap::Parser;
use reality_sim::{
    Archive, Sequence,
    db::{Database, PoseEstimate, PoseSource},
    sequence::save_image,
};

use crate::closed_loop::{Moment, RATE_HZ};

/// Lets a robot follow a ball by its camera, whose pictures are made from recorded ones.
#[derive(Debug, Parser)]
struct Args {
    /// Database of `reality-sim build`; without it, one of the walk that comes with the project is made
    #[arg(long)]
    database: Option<PathBuf>,
    /// Seed of the ball's way and of all noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Time that is simulated, seconds
    #[arg(long, default_value_t = 20.0, value_parser = seconds)]
    seconds: f64,
    /// Folder for the pictures that the robot sees
    #[arg(long)]
    pictures: Option<PathBuf>,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    let is_possible = (1.0 / RATE_HZ..=3600.0).contains(&seconds);
    is_possible.then_some(seconds).ok_or_else(|| "give 0.1 to 3600 seconds".to_owned())
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    let folder = tempfile::tempdir()?;
    let database = match &args.database {
        Some(database) => database.clone(),
        None => demonstration(&folder.path().join("walk.db"))?,
    };
    // Decoded pictures take up to 512 MiB.
    let archive = Arc::new(Archive::open(&database, 512 << 20)?);
    let mut pictures = 0;
    let mut saved = Ok(());
    let report = closed_loop::run(&archive, args.seed, args.seconds, |moment| {
        if pictures % RATE_HZ as u32 == 0 {
            print_moment(moment);
        }
        if let (Some(folder), Ok(())) = (&args.pictures, &saved) {
            saved = save_image(&folder.join(format!("{pictures:06}.png")), &moment.senses.picture);
        }
        pictures += 1;
    })?;
    saved?;
    print!("{report}");
    Ok(())
}

fn print_moment(Moment { senses, thought, truth, errors }: &Moment<'_>) {
    let ball = match errors.ball_m {
        Some(ball_m) => {
            let distance_m = truth.camera.planar().position_in_world().distance(truth.ball_in_world);
            format!("{distance_m:.2} m away, {:.1} cm off", 100.0 * ball_m)
        }
        None => "not seen".to_owned(),
    };
    println!(
        "{:5.1} s: robot {:5.2} m {:5.2} m {:4.0}°, {:.1} cm off{}; ball {ball}",
        senses.time_s,
        thought.camera.x_m,
        thought.camera.y_m,
        thought.camera.yaw_rad.to_degrees(),
        100.0 * errors.robot.distance_m,
        if thought.is_sure { "" } else { ", not sure" },
    );
}

/// Builds a database of the walk that comes with the project.
fn demonstration(file: &Path) -> anyhow::Result<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/walk"));
    let walk = Sequence::open(folder).context("the demonstration walk comes with the project's checkout")?;
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    Database::create_or_open(file)?.ingest(&walk, &poses, &PoseSource::GroundTruth)?;
    Ok(file.to_owned())
}
