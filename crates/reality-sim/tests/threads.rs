//! Compile-time check of which types can be sent to threads and shared among them.

use reality_sim::{
    Archive, Camera, CameraPose, FieldDimensions, LocalizationError, LocalizedFrame, Localizer,
    LocalizerConfig, Pose2, Reconstruction, Sequence, SequenceError, SynthesisError, Synthesizer,
    db::{Database, DbError, ImageRecord, PoseEstimate, PoseSource, index::PoseIndex},
    sensor::{Chain, Model, ModelError, Renderer, Trajectory},
    synthesis::SynthesisConfig,
};

const fn shared<T: Send + Sync>() {}

const _: () = {
    shared::<Camera>();
    shared::<CameraPose>();
    shared::<Pose2>();
    shared::<FieldDimensions>();
    shared::<Sequence>();
    shared::<SequenceError>();
    shared::<Localizer>();
    shared::<LocalizerConfig>();
    shared::<LocalizedFrame>();
    shared::<LocalizationError>();
    shared::<Database>();
    shared::<DbError>();
    shared::<ImageRecord>();
    shared::<PoseEstimate>();
    shared::<PoseSource>();
    shared::<PoseIndex>();
    shared::<Archive>();
    shared::<Synthesizer>();
    shared::<SynthesisConfig>();
    shared::<SynthesisError>();
    shared::<Reconstruction>();
    shared::<Renderer>();
    shared::<Chain>();
    shared::<Model>();
    shared::<ModelError>();
    shared::<Trajectory>();
};

#[cfg(feature = "gpu")]
const _: () = {
    shared::<reality_sim::gpu::GpuContext>();
    shared::<reality_sim::gpu::GpuBackend>();
    shared::<reality_sim::gpu::GpuWarper>();
    shared::<reality_sim::gpu::GpuError>();
};
