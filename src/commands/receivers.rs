//! Who gets messages: a file, a server.

use std::path::Path;

#[cfg(feature = "live")]
use reality_sim_formats::show::TopicServer;
use reality_sim_formats::show::{TopicFile, Topics};

#[cfg(feature = "live")]
use super::serving::ServingArgs;

/// Receivers of the same messages.
pub struct Receivers<T> {
    file: Option<TopicFile<T>>,
    #[cfg(feature = "live")]
    server: Option<TopicServer<T>>,
}

impl<T: Topics> Receivers<T> {
    /// Begins the file, if one is wanted.
    pub fn of_file(path: Option<&Path>) -> anyhow::Result<Self> {
        Ok(Self {
            file: path.map(TopicFile::create).transpose()?,
            #[cfg(feature = "live")]
            server: None,
        })
    }

    /// Starts the server too, if one is wanted.
    #[cfg(feature = "live")]
    pub fn and_server(self, serving: &ServingArgs) -> anyhow::Result<Self> {
        Ok(Self { server: serving.start()?, ..self })
    }

    /// Returns whether nobody gets anything.
    pub fn is_empty(&self) -> bool {
        #[cfg(feature = "live")]
        let has_server = self.server.is_some();
        #[cfg(not(feature = "live"))]
        let has_server = false;
        self.file.is_none() && !has_server
    }

    /// Sends everything of a picture.
    pub fn send(&mut self, shot: &T::Shot<'_>) {
        if let Some(file) = &self.file {
            file.log(shot);
        }
        #[cfg(feature = "live")]
        if let Some(server) = &mut self.server {
            server.show(shot);
        }
    }

    /// Completes the file, and then ends the server: what clients do costs no file.
    pub fn finish(self) -> anyhow::Result<()> {
        let finished = self.file.map_or(Ok(()), TopicFile::finish);
        #[cfg(feature = "live")]
        if let Some(server) = self.server {
            server.stop();
        }
        Ok(finished?)
    }
}
