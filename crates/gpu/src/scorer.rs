//! The observation models on the GPU, one call at a time.

use std::sync::{Arc, Mutex, PoisonError};

use reality_sim_core::{
    backend::BackendError,
    camera::Camera,
    field::FieldDimensions,
    observation::{CameraFromGround, LineModel, ObservationConfig, Scorer},
    pose::CameraPose,
    preprocess::Prepared,
};

use crate::{
    GpuContext, GpuError,
    buffers::{readback, storage, write},
    kernel::{BoundKernel, run_steps},
    layout::PoseLayout,
    picture::PictureStage,
    scoring::LineScoring,
};

/// Largest number of poses per dispatch: it limits each upload and read-back to a few megabytes.
const POSES_PER_DISPATCH: usize = 1 << 17;

/// Scorer that computes log-weights in compute shaders.
#[derive(Debug)]
pub struct GpuScorer {
    context: Arc<GpuContext>,
    picture: PictureStage,
    scoring: LineScoring,
    poses: Mutex<PoseBuffers>,
}

/// Buffers for poses on their way to the device and for their sums on the way back.
#[derive(Debug)]
struct PoseBuffers {
    capacity: usize,
    poses: wgpu::Buffer,
    sums: wgpu::Buffer,
    readback: wgpu::Buffer,
    kernel: BoundKernel,
}

impl GpuScorer {
    /// Prepares the samples of a field's lines on the device, for one camera.
    pub fn new(
        context: Arc<GpuContext>,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Self, GpuError> {
        let model = LineModel::new(camera, field, config);
        let picture = PictureStage::new(&context, camera, &model)?;
        let scoring = LineScoring::new(&context, model)?;
        let poses = Mutex::new(PoseBuffers::new(&context, &picture, &scoring, 1024)?);
        context.check()?;
        Ok(Self { context, picture, scoring, poses })
    }

    /// Returns the shader's sums for every pose, see [`reality_sim_core::observation::CpuScorer::sums`].
    pub fn sums(&self, poses: &[CameraPose]) -> Result<Vec<[f32; 2]>, GpuError> {
        let mut sums = Vec::with_capacity(poses.len());
        for chunk in poses.chunks(POSES_PER_DISPATCH) {
            sums.extend(self.sums_of_chunk(chunk)?);
        }
        Ok(sums)
    }

    fn sums_of_chunk(&self, poses: &[CameraPose]) -> Result<Vec<[f32; 2]>, GpuError> {
        let context = &*self.context;
        let mut buffers = self.poses.lock().unwrap_or_else(PoisonError::into_inner);
        if buffers.capacity < poses.len() {
            *buffers =
                PoseBuffers::new(context, &self.picture, &self.scoring, poses.len().next_power_of_two())?;
        }
        let layouts: Vec<PoseLayout> =
            poses.iter().map(|pose| PoseLayout::from(CameraFromGround::new(*pose))).collect();
        write(context, &buffers.poses, &layouts);
        let groups = self.scoring.configure(context, poses.len());
        let bytes = size_of::<[f32; 2]>() as u64 * poses.len() as u64;
        context.submit(|encoder| {
            run_steps(encoder, [(&buffers.kernel, groups)]);
            encoder.copy_buffer_to_buffer(&buffers.sums, 0, &buffers.readback, 0, bytes);
        });
        context.read(&buffers.readback, bytes)
    }
}

impl Scorer for GpuScorer {
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError> {
        self.scoring.set_levels(picture.levels);
        self.picture.load(&self.context, picture);
        self.context.submit(|encoder| run_steps(encoder, self.picture.steps()));
        Ok(self.context.check()?)
    }

    fn log_weights(&self, poses: &[CameraPose]) -> Result<Vec<f64>, BackendError> {
        let sums = self.sums(poses)?;
        Ok(sums.into_iter().map(|sums| self.scoring.model().log_weight(sums)).collect())
    }
}

impl PoseBuffers {
    fn new(
        context: &GpuContext,
        picture: &PictureStage,
        scoring: &LineScoring,
        capacity: usize,
    ) -> Result<Self, GpuError> {
        let bytes = capacity * size_of::<[f32; 2]>();
        let poses = storage(context, "the poses", capacity * size_of::<PoseLayout>())?;
        let sums = storage(context, "the sums", bytes)?;
        Ok(Self {
            capacity,
            readback: readback(context, "the sums read back", bytes)?,
            kernel: scoring.bind(context, picture.texels(), &poses, &sums),
            poses,
            sums,
        })
    }
}
