//! Recordings tagged on the way to something else: what `build` and `gap` share.

use reality_sim::{LocalizedFrame, Localizer, LocalizerConfig, Sequence, observation::ObservationKind};

use super::{device::BackendArgs, output::frame_progress};

/// A recording whose pictures the particle filter has tagged.
pub struct Tagged {
    pub frames: Vec<LocalizedFrame>,
    pub localizer: Localizer,
    pub config: LocalizerConfig,
    /// Name of the device that did it.
    pub device: String,
}

/// Tags every picture with the usual settings, under a progress bar.
pub fn tagged(sequence: &Sequence, backend: &BackendArgs, seed: u64) -> anyhow::Result<Tagged> {
    let config = LocalizerConfig::new(ObservationKind::Contrast).with_seed(seed);
    let device = backend.device()?;
    let Sequence { setup, field, start, .. } = sequence;
    let builder = Localizer::builder(&setup.camera, field).config(config).start(*start);
    let mut localizer = builder.backend(device.backend).build()?;
    let progress = frame_progress(sequence.frames.len())?;
    let frames: Result<_, _> = localizer.run(sequence).inspect(|_| progress.inc(1)).collect();
    progress.finish_and_clear();
    Ok(Tagged { frames: frames?, localizer, config, device: device.name.to_owned() })
}
