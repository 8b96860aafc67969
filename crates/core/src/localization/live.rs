//! Localization of a camera that delivers pictures now, faster perhaps than they can be localized.

mod queue;

use std::{
    fmt,
    num::NonZeroUsize,
    sync::{Arc, mpsc},
    thread,
};

pub use self::queue::Pushed;
use self::queue::Queue;
use super::{
    error::LocalizationError, frame::LocalizedFrame, localizer::Localizer, observation::Observation,
};

/// Number of pictures that wait by default, besides the one that is being localized: one that is as new as can be.
const WAITING: NonZeroUsize = NonZeroUsize::MIN;
/// Maximum number of results that wait to be read.
const RESULTS: usize = 32;

/// Result for one picture of a live camera.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveFrame {
    /// Pose of the picture, and how far to trust it.
    pub frame: LocalizedFrame,
    /// Number of pictures that were dropped since the one before.
    pub dropped_before: u64,
    /// Time from when the picture was handed over until its pose was known, seconds.
    pub latency_s: f64,
}

/// Picture of a live camera that could not be localized. Those after it are localized all the same.
#[derive(Debug, thiserror::Error)]
#[error("picture at {timestamp_s} s: {reason}")]
pub struct LiveError {
    /// Time at which the picture was taken, by the observation's clock, seconds.
    pub timestamp_s: f64,
    /// Number of pictures that were dropped since the one before.
    pub dropped_before: u64,
    /// What is wrong.
    #[source]
    pub reason: Box<LocalizationError>,
}

/// Camera's end of a [`LiveLocalizer`]: takes pictures from any thread and never waits.
#[derive(Clone)]
pub struct LiveFeed {
    queue: Arc<Queue>,
}

impl LiveFeed {
    /// Hands over a picture. If too many wait already, the oldest one is dropped: a pose is worth most while it is new. The
    /// odometry of a dropped picture is not lost: it is a pose, not a step, and the next picture's contains it. A picture at which
    /// the odometry restarts at its origin is therefore dropped last.
    pub fn push(&self, observation: Observation) -> Pushed {
        self.queue.push(observation)
    }

    /// Says that no more pictures come, as [`LiveLocalizer::close`] does.
    pub fn close(&self) {
        self.queue.close();
    }

    /// Returns the number of pictures that were dropped so far.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }
}

/// Localizes the pictures of a live camera on a thread of its own.
///
/// Memory is bounded: one picture is localized, one waits by default, and at most 32 results wait to be read. If nobody reads them,
/// localization waits, and pictures are dropped; no result and no error ever is. Dropping the value stops the thread.
///
/// ```
/// use std::{path::Path, thread};
///
/// use reality_sim_core::{
///     localization::{LiveLocalizer, Localizer, Observation},
///     sequence::Sequence,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let walk = Sequence::open(Path::new("../../assets/walk"))?;
/// let localizer = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build()?;
/// let mut live = LiveLocalizer::new(localizer);
///
/// // The camera's driver has its own thread, and never waits.
/// let (feed, camera) = (live.feed(), walk.clone());
/// let driver = thread::spawn(move || {
///     for index in 0..5 {
///         let Ok(picture) = camera.load_image(index) else { break };
///         let _ = feed.push(Observation::of_frame(&camera, index, picture));
///     }
///     feed.close();
/// });
/// // Whoever steers the robot reads the poses as they come.
/// let first = live.wait().ok_or("there is a picture")??;
/// println!("{:.3} m, {:.0} ms old", first.frame.pose.x_m, 1e3 * first.latency_s);
///
/// let mut pictures = 1 + first.dropped_before;
/// while let Some(result) = live.wait() {
///     pictures += 1 + result?.dropped_before;
/// }
/// assert_eq!(pictures, 5, "every picture has its pose or is counted");
/// driver.join().map_err(|_| "the driver panicked")?;
/// # Ok(())
/// # }
/// ```
pub struct LiveLocalizer<L = Localizer> {
    queue: Arc<Queue>,
    /// `None` once results are no longer wanted.
    results: Option<mpsc::Receiver<Result<LiveFrame, LiveError>>>,
    /// `None` once the thread has ended.
    thread: Option<thread::JoinHandle<L>>,
    /// What the thread left when it ended.
    localizer: Option<L>,
}

impl LiveLocalizer {
    /// Starts a thread that localizes. One picture waits at most, so that the poses are as new as can be.
    pub fn new(localizer: Localizer) -> Self {
        Self::with_waiting(localizer, WAITING)
    }

    /// Works as [`LiveLocalizer::new`], with room for more pictures: fewer are dropped where some take longer than others, and
    /// poses are older then.
    pub fn with_waiting(localizer: Localizer, pictures: NonZeroUsize) -> Self {
        Self::start(localizer, Localizer::update, pictures)
    }
}

/// Function that localizes one picture.
type Update<L> = fn(&mut L, &Observation) -> Result<LocalizedFrame, LocalizationError>;

impl<L: Send + 'static> LiveLocalizer<L> {
    fn start(mut localizer: L, update: Update<L>, pictures: NonZeroUsize) -> Self {
        let queue = Arc::new(Queue::new(pictures));
        let (sender, receiver) = mpsc::sync_channel(RESULTS);
        let waiting = queue.clone();
        let thread = thread::spawn(move || {
            // Also if `update` panics: nobody shall hand over pictures to a thread that is gone.
            let _closing = ClosesAtEnd(&waiting);
            while let Some(next) = waiting.pop() {
                let (observation, dropped_before) = (&next.observation, next.dropped_before);
                let result = match update(&mut localizer, observation) {
                    Ok(frame) => {
                        let latency_s = next.since.elapsed().as_secs_f64();
                        Ok(LiveFrame { frame, dropped_before, latency_s })
                    }
                    Err(reason) => {
                        let (timestamp_s, reason) = (observation.timestamp_s, Box::new(reason));
                        Err(LiveError { timestamp_s, dropped_before, reason })
                    }
                };
                // The receiver is gone once nobody wants more results.
                if sender.send(result).is_err() {
                    break;
                }
            }
            localizer
        });
        Self { queue, results: Some(receiver), thread: Some(thread), localizer: None }
    }
}

impl<L> LiveLocalizer<L> {
    /// Returns the camera's end, for any number of threads.
    pub fn feed(&self) -> LiveFeed {
        LiveFeed { queue: self.queue.clone() }
    }

    /// Waits for the next result; `None` once [`LiveLocalizer::close`] was called and every picture has its result.
    ///
    /// # Panics
    ///
    /// If localizing a picture panicked.
    pub fn wait(&mut self) -> Option<Result<LiveFrame, LiveError>> {
        let result = self.results.as_ref()?.recv().ok();
        if result.is_none() {
            self.join();
        }
        result
    }

    /// Returns the next result if there is one already.
    pub fn poll(&self) -> Option<Result<LiveFrame, LiveError>> {
        self.results.as_ref()?.try_recv().ok()
    }

    /// Refuses further pictures. Those that wait are localized, and their results can be read.
    pub fn close(&self) {
        self.queue.close();
    }

    /// Stops: throws away the pictures that wait and the results that were not read, and returns the localizer (`None` only while
    /// the caller itself panics).
    ///
    /// # Panics
    ///
    /// If localizing a picture panicked.
    pub fn stop(mut self) -> Option<L> {
        self.end();
        self.localizer.take()
    }

    fn end(&mut self) {
        self.queue.stop();
        // A thread that waits for a reader goes on.
        self.results = None;
        self.join();
    }

    /// Waits for the thread's end; a panic in the thread is resumed here.
    fn join(&mut self) {
        match self.thread.take().map(thread::JoinHandle::join) {
            Some(Ok(localizer)) => self.localizer = Some(localizer),
            Some(Err(panic)) if !thread::panicking() => std::panic::resume_unwind(panic),
            _ => {}
        }
    }
}

/// Refuses further pictures when it is dropped.
struct ClosesAtEnd<'a>(&'a Queue);

impl Drop for ClosesAtEnd<'_> {
    fn drop(&mut self) {
        self.0.stop();
    }
}

impl<L> Drop for LiveLocalizer<L> {
    fn drop(&mut self) {
        self.end();
    }
}

impl fmt::Debug for LiveFeed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("LiveFeed").field("dropped", &self.dropped()).finish_non_exhaustive()
    }
}

impl<L> fmt::Debug for LiveLocalizer<L> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("LiveLocalizer")
            .field("dropped", &self.queue.dropped())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
