//! The graphics device through the program and the library: the same walk must give the same result. Needs an adapter; the
//! package mesa-vulkan-drivers provides one that runs on the processor.

#![cfg(feature = "gpu")]
#![allow(clippy::print_stdout, reason = "a test")]

use std::{path::Path, process::Command, sync::Arc};

use serde_json::Value;

use reality_sim::{
    CameraPose, LocalizedFrame, Localizer, LocalizerConfig, ObservationKind, Pose2, Sequence,
    backend::{Backend, CpuBackend},
    evaluation::PoseError,
    filter::Resampling,
    gpu::{GpuBackend, GpuContext},
    localization::mount_of_frame,
    preprocess::Preprocessor,
};

fn walk() -> Sequence {
    Sequence::open(Path::new("assets/walk")).expect("the demonstration walk is part of the repository")
}

fn gpu() -> Arc<dyn Backend> {
    let context = GpuContext::new(None).unwrap_or_else(|error| panic!("{error}"));
    println!("on {:?}", context.adapter());
    Arc::new(GpuBackend::new(Arc::new(context)))
}

fn localize(
    sequence: &Sequence,
    config: LocalizerConfig,
    start: Option<Pose2>,
    backend: Arc<dyn Backend>,
) -> Vec<LocalizedFrame> {
    let Sequence { setup, field, .. } = sequence;
    let builder = Localizer::builder(&setup.camera, field).config(config).start(start);
    let mut localizer = builder.backend(backend).build().expect("a device that works");
    localizer.run(sequence).collect::<Result<_, _>>().expect("every picture can be read")
}

fn distance_m(a: CameraPose, b: CameraPose) -> f64 {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// Both filters run independently over the whole walk. One survivor more or less of a particle changes the random numbers
/// of all particles after it, so the filters diverge within a few pictures; their results must be equally good.
#[test]
fn the_gpu_localizes_the_walk_as_well_as_the_cpu() {
    let (sequence, gpu) = (walk(), gpu());
    // Half the pictures agree to the first number, 95 % to the second: this is the filters' own noise, and `contrast` is
    // refined.
    for (kind, median_m, p95_m) in [
        (ObservationKind::Gauss, 0.005, 0.015),
        (ObservationKind::Distance, 0.01, 0.025),
        (ObservationKind::Contrast, 0.0002, 0.001),
    ] {
        let config = LocalizerConfig::new(kind);
        let found = localize(&sequence, config, sequence.start, gpu.clone());
        let expected = localize(&sequence, config, sequence.start, Arc::new(CpuBackend));
        let error = |frames: &[LocalizedFrame]| {
            let pairs = frames.iter().zip(sequence.reference_poses());
            mean(pairs.filter_map(|(frame, truth)| Some(PoseError::new(frame.pose, truth?).distance_m)))
        };
        let (gpu_m, cpu_m) = (error(&found), error(&expected));
        let mut apart: Vec<f64> =
            found.iter().zip(&expected).map(|(a, b)| distance_m(a.pose, b.pose)).collect();
        apart.sort_by(f64::total_cmp);
        let about =
            format!("{kind:?}: {gpu_m} m off, on the CPU {cpu_m}; apart {:?}", [apart[30], apart[56]]);
        println!("{about}");
        assert!((gpu_m - cpu_m).abs() < 0.15 * cpu_m + 1e-4, "{about}");
        assert!(apart[30] < median_m && apart[56] < p95_m, "{about}");
        assert!(found.iter().zip(&expected).filter(|(a, b)| a.sure != b.sure).count() <= 1, "{about}");
    }
}

/// With the same particles, the same picture and the same random numbers, the best particle of five iterations agrees to a
/// tolerance in at least 95 of 100 pictures, and is identical in most of them. In the others, a particle whose expected
/// number of copies is nearly whole had one survivor more or less, which gave other random numbers to all particles after
/// it. The residual scheme rounds every particle's copies, the systematic one hardly any.
#[test]
fn from_the_same_particles_gpu_and_cpu_agree_on_the_best_one() {
    let (sequence, gpu) = (walk(), gpu());
    let Sequence { setup, field, .. } = &sequence;
    let preprocessor = Preprocessor::new(&setup.camera, field.line_width_m);
    // Tolerances in metres. Many poses of the distance model have nearly equal weights: it is 2 cm off on average.
    for (kind, tolerance_m) in [
        (ObservationKind::Gauss, 0.001),
        (ObservationKind::Distance, 0.015),
        (ObservationKind::Contrast, 0.001),
    ] {
        for resampling in [Resampling::Residual, Resampling::Systematic] {
            let mut config = LocalizerConfig::new(kind);
            config.filter.resampling = resampling;
            let filter = |backend: &dyn Backend| {
                let filter = backend.filter(&setup.camera, field, config.observation, config.filter);
                filter.expect("a device that works")
            };
            let (mut found, mut expected) = (filter(&*gpu), filter(&CpuBackend));
            let (mut same, mut apart_m) = (0, Vec::new());
            for (index, truth) in sequence.reference_poses().enumerate() {
                let picture = Arc::new(sequence.load_image(index).expect("every picture can be read"));
                let mount = mount_of_frame(&sequence, index);
                let prepared = preprocessor.prepare(picture, mount);
                let sigma = config.filter.noise.sigma(None);
                let near = truth.expect("exact truth").planar();
                let [a, b] = [&mut found, &mut expected].map(|filter| {
                    filter.load(&prepared)?;
                    filter.predict(None)?;
                    filter.initialize(&[(near, 1.0)], sigma)?;
                    filter.update(mount, sigma)
                });
                let [a, b] = [a, b].map(|estimate| estimate.expect("a device that works").pose);
                same += usize::from(distance_m(a, b) < 1e-5 && (a.yaw_rad - b.yaw_rad).abs() < 1e-5);
                apart_m.push(distance_m(a, b));
            }
            apart_m.sort_by(f64::total_cmp);
            let about =
                format!("{kind:?}, {resampling:?}: {same} of 60 the same, 95 % within {} m", apart_m[56]);
            println!("{about}");
            assert!(same >= 40 && apart_m[56] < tolerance_m, "{about}");
        }
    }
}

#[test]
fn an_unknown_start_is_found_on_the_gpu() {
    let mut sequence = walk();
    sequence.frames.truncate(5);
    let config = LocalizerConfig::new(ObservationKind::Contrast);
    let found = localize(&sequence, config, None, gpu());
    let (last, truth) = (found[4].pose, sequence.frames[4].reference_pose.expect("exact truth"));
    assert!(distance_m(last, truth).min(distance_m(last.mirrored(), truth)) < 0.02, "{last:?}");
}

fn program(arguments: &[&str]) -> (Option<i32>, Value, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_reality-sim")).args(arguments).output().expect("the program runs");
    let json = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output.status.code(), json, String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn the_program_names_the_adapter_it_computed_on() {
    let (code, report, errors) =
        program(&["tag", "assets/walk", "--backend", "gpu", "--frames", "0..4", "--json"]);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    assert_eq!(report["backend"], "gpu", "{report}");
    assert!(report["adapter"].as_str().is_some_and(|name| !name.is_empty()), "{report}");
    assert!(report["error"]["max_m"].as_f64().is_some_and(|error| error < 0.015), "{report}");
}

#[test]
fn doctor_lists_adapters_and_compares_them_with_the_cpu() {
    let (code, report, errors) = program(&["doctor", "--json"]);
    assert_eq!((code, errors.as_str()), (Some(0), ""), "{report}");
    let adapters = report["adapters"].as_array().expect("a list");
    assert!(!adapters.is_empty(), "{report}");
    for adapter in adapters {
        assert_eq!(adapter["agrees"], true, "{report}");
        assert!(adapter["worst_difference"].as_f64().is_some_and(|difference| difference > 0.0), "{report}");
    }
    let (code, _, errors) = program(&["doctor", "--adapter", "no-such-card"]);
    assert!(code == Some(1) && errors.contains("no-such-card"), "{errors}");
}
