//! A picture of the window in a file.

use std::{
    error::Error,
    path::{Path, PathBuf},
    time::Duration,
};

use bevy::{
    prelude::*,
    render::view::screenshot::{Screenshot, ScreenshotCaptured},
    time::TimeUpdateStrategy,
};

/// Simulated time from frame to frame until the picture is taken, seconds: it does not depend on the machine.
const FRAME_S: f64 = 1.0 / 15.0;

/// Picture of the window that is wanted.
#[derive(Debug, Clone, Resource)]
pub struct Wanted {
    /// File, PNG or JPEG by its name.
    pub file: PathBuf,
    /// Simulated time, seconds.
    pub at_s: f64,
}

/// Lets an application save its window's picture and exit.
pub fn add(app: &mut App, wanted: Wanted) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(FRAME_S)))
        .insert_resource(wanted)
        .add_systems(Last, take);
}

/// Asks for the picture once it is time.
fn take(mut commands: Commands, time: Res<Time>, wanted: Res<Wanted>, mut is_taken: Local<bool>) {
    if *is_taken || time.elapsed_secs_f64() < wanted.at_s {
        return;
    }
    *is_taken = true;
    commands.spawn(Screenshot::primary_window()).observe(save_and_exit);
}

fn save_and_exit(captured: On<ScreenshotCaptured>, wanted: Res<Wanted>, mut exit: MessageWriter<AppExit>) {
    exit.write(match save(&captured.image, &wanted.file) {
        Ok(()) => AppExit::Success,
        Err(error) => {
            error!("{error}");
            AppExit::error()
        }
    });
}

fn save(image: &Image, file: &Path) -> Result<(), Box<dyn Error>> {
    let picture = image.clone().try_into_dynamic()?.into_rgb8();
    picture.save(file).map_err(|error| format!("{}: {error}", file.display()).into())
}
