//! Who gets the messages: a file, a server.

#[cfg(feature = "live")]
use reality_sim_formats::ros2::CameraServer;
use reality_sim_formats::ros2::{CameraLog, CameraShot};

use super::options::StreamArgs;

/// Receivers of one stream.
pub struct Receivers {
    file: Option<CameraLog>,
    #[cfg(feature = "live")]
    server: Option<CameraServer>,
}

impl Receivers {
    /// Begins the file and starts the server that the options name.
    pub fn start(args: &StreamArgs) -> anyhow::Result<Self> {
        Ok(Self {
            file: args.out.as_ref().map(|path| CameraLog::create(path)).transpose()?,
            #[cfg(feature = "live")]
            server: args.serving.start()?,
        })
    }

    /// Sends a picture.
    pub fn send(&mut self, shot: &CameraShot<'_>) {
        if let Some(file) = &self.file {
            file.log(shot);
        }
        #[cfg(feature = "live")]
        if let Some(server) = &mut self.server {
            server.show(shot);
        }
    }

    /// Completes the file, and then ends the server: a client that has stalled may hold up its end, and costs no file.
    pub fn finish(self) -> anyhow::Result<()> {
        let finished = self.file.map_or(Ok(()), CameraLog::finish);
        #[cfg(feature = "live")]
        if let Some(server) = self.server {
            server.stop();
        }
        Ok(finished?)
    }
}
