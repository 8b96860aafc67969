//! Demonstration of the plugin: a camera moves beside the poses at which a walk was recorded, and sees a ball and two robots that
//! Bevy moves. `cargo run -- walk.db`; `--help` has the options.

mod demo;

use std::path::PathBuf;

use bevy::app::AppExit;
use clap::Parser;
use reality_sim::image::ImageFormat;

/// Shows what a camera in Bevy sees of a recorded field.
#[derive(Debug, Clone, Parser)]
#[command(version)]
struct Args {
    /// Database of `reality-sim build`
    database: PathBuf,
    /// Leave out the people, robots and balls that stood there while it was recorded
    #[arg(long)]
    clean: bool,
    /// Save the window's picture to this file, PNG or JPEG, and exit
    #[arg(long, value_parser = picture_file)]
    screenshot: Option<PathBuf>,
    /// Simulated time at which the window's picture is saved, seconds
    #[arg(long, default_value_t = 8.0, requires = "screenshot")]
    at: f64,
}

fn picture_file(text: &str) -> Result<PathBuf, String> {
    let is_known = matches!(ImageFormat::from_path(text), Ok(ImageFormat::Png | ImageFormat::Jpeg));
    is_known.then(|| text.into()).ok_or_else(|| "give a file name that ends in .png or .jpg".to_owned())
}

fn main() -> AppExit {
    let args = Args::parse();
    let screenshot = args.screenshot.map(|file| demo::Wanted { file, at_s: args.at });
    demo::open(&args.database, args.clean).map(|camera| demo::run(camera, screenshot)).unwrap_or_else(
        |error| {
            eprintln!("{error}");
            AppExit::error()
        },
    )
}
