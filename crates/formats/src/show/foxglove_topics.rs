//! The topics that Foxglove shows of a recorded picture.

use std::sync::Arc;

use foxglove::{
    Channel, ChannelBuilder, Context, Encode, FoxgloveError,
    messages::{
        CameraCalibration, CompressedImage, FrameTransform, ImageAnnotations, PoseInFrame, PosesInFrame,
        SceneUpdate,
    },
};

#[cfg(feature = "live")]
use super::live::TopicServer;
use super::{log_file::TopicFile, messages, shot::Shot, topics::Topics};

/// MCAP file of recorded pictures.
pub type LogFile = TopicFile<FoxgloveTopics>;

/// Server that shows recorded pictures as they are localized.
#[cfg(feature = "live")]
pub type LiveView = TopicServer<FoxgloveTopics>;

/// Topics of a recorded picture.
#[derive(Debug)]
pub struct FoxgloveTopics {
    image: Channel<CompressedImage>,
    calibration: Channel<CameraCalibration>,
    lines: Channel<ImageAnnotations>,
    pose: Channel<PoseInFrame>,
    transform: Channel<FrameTransform>,
    field: Channel<SceneUpdate>,
    particles: Channel<PosesInFrame>,
}

impl Topics for FoxgloveTopics {
    type Shot<'a> = Shot<'a>;

    const PROFILE: &'static str = "";

    fn open(context: &Arc<Context>) -> Result<Self, FoxgloveError> {
        fn channel<T: Encode>(context: &Arc<Context>, topic: &str) -> Channel<T> {
            ChannelBuilder::new(topic).context(context).build()
        }
        Ok(Self {
            image: channel(context, "/camera/image"),
            calibration: channel(context, "/camera/calibration"),
            lines: channel(context, "/camera/lines"),
            pose: channel(context, "/camera/pose"),
            transform: channel(context, "/tf"),
            field: channel(context, "/field"),
            particles: channel(context, "/particles"),
        })
    }

    fn timestamp_s(shot: &Shot<'_>) -> f64 {
        shot.timestamp_s
    }

    /// Logs everything of a picture at its time. The calibration and the field are repeated with every picture: whoever
    /// connects late, or jumps to another time, has them.
    fn log(&self, shot: &Shot<'_>) {
        let time = messages::timestamp(shot.timestamp_s);
        self.transform.log_with_time(&messages::transform(shot, time), time);
        self.calibration.log_with_time(&messages::calibration(shot, time), time);
        self.field.log_with_time(&messages::field(shot.field, time), time);
        self.pose.log_with_time(&messages::pose_in_frame(shot, time), time);
        if !shot.particles.is_empty() {
            self.particles.log_with_time(&messages::particles(shot, time), time);
        }
        self.lines.log_with_time(&messages::lines(shot, time), time);
        self.image.log_with_time(&messages::image(shot, time), time);
    }
}
