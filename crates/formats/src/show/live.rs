//! A live view: Foxglove's websocket.

use std::{
    net::SocketAddr,
    path::PathBuf,
    sync::{Arc, mpsc},
    thread,
    time::{Duration, Instant},
};

use foxglove::{Context, FoxgloveError, WebSocketServer, WebSocketServerHandle};
use reality_sim_core::sequence::one_line;

use super::topics::Topics;
use crate::model_error::{ModelError, ModelFault};

/// How often it is looked whether somebody has connected.
const POLL: Duration = Duration::from_millis(20);

/// Longest time between two pictures that is waited for: a recording may have gaps.
const LONGEST_PAUSE: Duration = Duration::from_secs(1);

/// Time that a client is given to subscribe to topics after it has connected.
const SUBSCRIPTION: Duration = Duration::from_millis(500);

/// Time that the last pictures are given to be sent before the server ends, which drops what still waits.
const LAST_PICTURES: Duration = Duration::from_millis(500);

/// Time that clients are given to take their leave. One that has stalled does not, and its connection ends with the program.
const LEAVE: Duration = Duration::from_secs(2);

/// Server that shows pictures as they are made. Clients that come late see what comes after; slow ones miss pictures,
/// and hold nobody up.
#[derive(Debug)]
pub struct TopicServer<T> {
    /// Holds what the server belongs to.
    _context: Arc<Context>,
    topics: T,
    server: WebSocketServerHandle,
    address: SocketAddr,
    /// When the last picture was shown, and its own time.
    last: Option<(Instant, f64)>,
}

impl<T: Topics> TopicServer<T> {
    /// Starts the server. Port 0 is any free one. Fails if the address cannot be had.
    pub fn start(address: SocketAddr) -> Result<Self, ModelError> {
        let context = Context::new();
        let failed = |error: FoxgloveError| {
            let message =
                format!("cannot be listened at ({}): give another address or port", one_line(&error));
            ModelError::of_file(&PathBuf::from(address.to_string()), ModelFault::Show { message })
        };
        let topics = T::open(&context).map_err(failed)?;
        let server = WebSocketServer::new()
            .name("reality-sim")
            .bind(address.ip().to_string(), address.port())
            .context(&context)
            .start_blocking()
            .map_err(failed)?;
        let address = SocketAddr::new(address.ip(), server.port());
        Ok(Self { _context: context, topics, server, address, last: None })
    }

    /// Returns the address at which the server listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Waits until somebody has connected, and has had the time to subscribe.
    pub fn wait_for_client(&self) {
        while self.server.client_count() == 0 {
            thread::sleep(POLL);
        }
        thread::sleep(SUBSCRIPTION);
    }

    /// Shows a picture, not sooner after the one before than it was recorded.
    pub fn show(&mut self, shot: &T::Shot<'_>) {
        let shot_s = T::timestamp_s(shot);
        if let Some((shown, timestamp_s)) = self.last {
            let step = Duration::try_from_secs_f64(shot_s - timestamp_s).unwrap_or_default();
            thread::sleep(step.min(LONGEST_PAUSE).saturating_sub(shown.elapsed()));
        }
        self.last = Some((Instant::now(), shot_s));
        self.topics.log(shot);
    }

    /// Ends the server, after the last pictures have had the time to be sent to clients that keep up.
    pub fn stop(self) {
        if self.server.client_count() > 0 {
            thread::sleep(LAST_PICTURES);
        }
        let stopping = self.server.stop();
        let (sender, receiver) = mpsc::sync_channel(1);
        thread::spawn(move || {
            stopping.wait_blocking();
            // Nobody listens any more where it took too long.
            let _ = sender.send(());
        });
        let _ = receiver.recv_timeout(LEAVE);
    }
}
