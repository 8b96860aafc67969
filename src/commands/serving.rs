//! `--serve`: pictures that are shown live.

use std::net::SocketAddr;

use clap::Args;

use reality_sim_formats::show::{TopicServer, Topics};

/// Where pictures are shown while they are made.
#[derive(Debug, Args)]
pub struct ServingArgs {
    /// Show the work live, no faster than its times: listen for Foxglove's websocket at this address
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:8765")]
    serve: Option<SocketAddr>,
    /// Wait for somebody to connect before the first picture
    #[arg(long, requires = "serve")]
    serve_wait: bool,
}

impl ServingArgs {
    /// Returns whether anything is shown.
    pub fn is_wanted(&self) -> bool {
        self.serve.is_some()
    }

    /// Starts the server, if it is wanted, and says where it is.
    pub fn start<T: Topics>(&self) -> anyhow::Result<Option<TopicServer<T>>> {
        let Some(address) = self.serve else { return Ok(None) };
        let live = TopicServer::start(address)?;
        // On standard error: standard output may be for JSON.
        eprintln!("open ws://{} in Foxglove", live.address());
        if self.serve_wait {
            live.wait_for_client();
        }
        Ok(Some(live))
    }
}
