//! The topics.

use std::sync::Arc;

use foxglove::{
    Channel, ChannelBuilder, Context, Encode,
    messages::{
        CameraCalibration, CompressedImage, FrameTransform, ImageAnnotations, PoseInFrame, PosesInFrame,
        SceneUpdate,
    },
};

use super::{Shot, messages};

/// Topics of one log or one live view.
#[derive(Debug)]
pub(super) struct Channels {
    image: Channel<CompressedImage>,
    calibration: Channel<CameraCalibration>,
    lines: Channel<ImageAnnotations>,
    pose: Channel<PoseInFrame>,
    transform: Channel<FrameTransform>,
    field: Channel<SceneUpdate>,
    particles: Channel<PosesInFrame>,
}

impl Channels {
    pub fn new(context: &Arc<Context>) -> Self {
        fn channel<T: Encode>(context: &Arc<Context>, topic: &str) -> Channel<T> {
            ChannelBuilder::new(topic).context(context).build()
        }
        Self {
            image: channel(context, "/camera/image"),
            calibration: channel(context, "/camera/calibration"),
            lines: channel(context, "/camera/lines"),
            pose: channel(context, "/camera/pose"),
            transform: channel(context, "/tf"),
            field: channel(context, "/field"),
            particles: channel(context, "/particles"),
        }
    }

    /// Logs everything of a picture at its time. The calibration and the field are repeated with every picture: whoever
    /// connects late, or jumps to another time, has them.
    pub fn log(&self, shot: &Shot<'_>) {
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
