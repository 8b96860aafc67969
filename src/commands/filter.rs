//! Recordings tagged on the way to something else: what `build` and `gap` share.

use reality_sim::{
    Sequence, TagConfig, TaggedFrame, Tagger, observation::ObservationKind, tag::tag_sequence,
};

use super::{device::BackendArgs, output::frame_progress};

/// A recording whose pictures the particle filter has tagged.
pub struct Tagged {
    pub frames: Vec<TaggedFrame>,
    pub tagger: Tagger,
    pub config: TagConfig,
    /// Name of the device that did it.
    pub device: String,
}

/// Tags every picture with the usual settings, under a progress bar.
pub fn tagged(sequence: &Sequence, backend: &BackendArgs, seed: u64) -> anyhow::Result<Tagged> {
    let mut config = TagConfig::new(ObservationKind::Contrast);
    config.filter.seed = seed;
    let device = backend.device()?;
    let Sequence { setup, field, start, .. } = sequence;
    let mut tagger = Tagger::with_backend(&setup.camera, field, *start, config, device.backend)?;
    let progress = frame_progress(sequence.frames.len())?;
    let frames = tag_sequence(sequence, &mut tagger, |_, _, _, _| {
        progress.inc(1);
        Ok(())
    });
    progress.finish_and_clear();
    Ok(Tagged { frames: frames?, tagger, config, device: device.name.to_owned() })
}
