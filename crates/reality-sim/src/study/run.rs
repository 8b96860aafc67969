//! One recording with all settings.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use reality_sim_core::sequence::Sequence;

use super::{About, Findings, StudyError, StudySettings, dataset, evaluate, gap, tag};
use crate::{
    comparison::compare,
    tagging::{TagSettings, tag as tag_with},
};

/// Studies a recording, the folder of a sequence, with each of the settings, on the processor. Returns what was found, or why nothing was,
/// for each of the settings in their order. Pictures are decoded once for all settings of `tag`.
pub fn study(recording: &Path, settings: &[StudySettings]) -> Vec<Result<Findings, StudyError>> {
    let opened = defended(|| {
        let sequence = Sequence::open(recording)?;
        let about = About::new(&sequence)?;
        Ok((sequence, about))
    });
    let (sequence, about) = match opened {
        Ok(opened) => opened,
        Err(error) => return settings.iter().map(|_| Err(error.clone())).collect(),
    };
    let mut tags = tagged(&sequence, &about, settings).into_iter();
    let one = |settings: &StudySettings| match settings {
        StudySettings::Tag(_) => tags.next().unwrap_or_else(|| unreachable!("there is one for each of them")),
        StudySettings::Gap(settings) => {
            defended(|| Ok(gap::findings(about.clone(), &compare(&sequence, settings)?.analysis)))
        }
        StudySettings::Evaluate(settings) => {
            defended(|| evaluate::evaluate(about.clone(), &sequence, settings))
        }
        StudySettings::Dataset(settings) => {
            defended(|| dataset::make_pictures(about.clone(), &sequence, settings))
        }
    };
    settings.iter().map(one).collect()
}

/// Tags the recording with those of the settings that ask for it: together, and one by one where that fails.
fn tagged(
    sequence: &Sequence,
    about: &About,
    settings: &[StudySettings],
) -> Vec<Result<Findings, StudyError>> {
    let of_tags = settings.iter().filter_map(|settings| match settings {
        StudySettings::Tag(settings) => Some(settings.clone()),
        _ => None,
    });
    let of_tags: Vec<TagSettings> = of_tags.collect();
    let some = |settings: &[TagSettings]| {
        defended(|| {
            sequence.check_pictures()?;
            let tagged = tag_with(sequence, settings)?;
            let findings = |tagged| Ok(tag::findings(about.clone(), sequence, tagged)?);
            tagged.iter().map(findings).collect::<Result<Vec<_>, StudyError>>()
        })
    };
    match some(&of_tags) {
        Ok(all) => all.into_iter().map(Ok).collect(),
        Err(error) if of_tags.len() < 2 => of_tags.iter().map(|_| Err(error.clone())).collect(),
        Err(_) => {
            let alone =
                |settings: &TagSettings| some(std::slice::from_ref(settings)).map(|mut one| one.remove(0));
            of_tags.iter().map(alone).collect()
        }
    }
}

/// Does some work, and makes an error of a panic in it.
fn defended<T>(work: impl FnOnce() -> Result<T, StudyError>) -> Result<T, StudyError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(StudyError::defect(&*panic)))
}
