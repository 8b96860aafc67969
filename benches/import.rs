//! Import of a robot's log, against a copy of its file in the same run.

#[allow(clippy::unwrap_used, reason = "it writes the log that is measured, as tests do")]
#[path = "../crates/formats/tests/import/cdr.rs"]
mod cdr;
#[allow(dead_code, clippy::unwrap_used, reason = "it writes the log that is measured, as tests do")]
#[path = "../crates/formats/tests/import/log_writer.rs"]
mod log_writer;
#[allow(clippy::unwrap_used, reason = "it writes the log that is measured, as tests do")]
#[path = "../tests/common/walk_log.rs"]
mod walk_log;

use std::fs;

use criterion::{BatchSize, Criterion, SamplingMode, Throughput};
use mcap::Compression;
use reality_sim::Sequence;
use reality_sim_formats::{
    import::{ImportOptions, import_log},
    log::Log,
};

use crate::scene::Scene;

/// Times that the demonstration walk is in the log: 100 MB of JPEG files.
const WALKS: usize = 20;

/// Measures the import of a log of JPEG files in chunks, and a copy of it; bytes are the log's.
pub fn bench(criterion: &mut Criterion, scene: &Scene) {
    let walk = Sequence::open(&scene.walk.folder).expect("the demonstration walk is part of the repository");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("walk.mcap");
    let log = walk_log::walk_log(&walk, WALKS).mcap(Some(Compression::Lz4), Some(1 << 20));
    fs::write(&file, &log).expect("space on the disk");
    let mut group = criterion.benchmark_group("import");
    group.sampling_mode(SamplingMode::Flat).throughput(Throughput::Bytes(log.len() as u64));
    let place = || tempfile::tempdir_in(folder.path()).expect("a temporary folder");
    group.bench_function("log", |bencher| {
        let options = ImportOptions::new("walk", walk.field.clone());
        let import = |out: tempfile::TempDir| {
            let log = Log::open(&file).expect("a log");
            import_log(&log, &options, out.path(), &mut |_| {}).expect("it is whole");
            out
        };
        bencher.iter_batched(place, import, BatchSize::PerIteration);
    });
    group.bench_function("copy", |bencher| {
        let copy = |out: tempfile::TempDir| {
            fs::copy(&file, out.path().join("copy")).expect("space on the disk");
            out
        };
        bencher.iter_batched(place, copy, BatchSize::PerIteration);
    });
    group.finish();
}
