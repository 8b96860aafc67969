//! Pictures at poses and along paths.

use std::fs;

use reality_sim::Sequence;

use super::{assert_fails, demonstration, json, part_of_walk, shown};

#[test]
fn every_method_gives_a_picture_at_a_pose() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    for method in ["nearest", "quadratic", "plane", "blend", "simulated"] {
        let out = own.path().join(format!("{method}.png"));
        let report = json(&[
            "render",
            shown(database),
            "--pose",
            "-2.05,0.9,1.6",
            "--method",
            method,
            "--out",
            shown(&out),
        ]);
        assert_eq!(report["method"], method);
        assert_eq!(image::open(&out).unwrap().into_rgb8().dimensions(), (640, 480));
    }
    let [origins, trust, out] = ["origins.png", "trust.png", "out.jpg"].map(|name| own.path().join(name));
    let report = json(&[
        "render",
        shown(database),
        "--pose",
        "-2.05,0.9,1.6,0.52,0.4,0.0",
        "--origins",
        shown(&origins),
        "--trust",
        shown(&trust),
        "--out",
        shown(&out),
        "--neighbours",
        "3",
    ]);
    assert_eq!(report["used"].as_array().unwrap().len(), 3);
    assert!(report["covered"].as_f64().unwrap() > 0.8);
    assert!(origins.exists() && trust.exists() && out.exists());
}

#[test]
fn a_path_becomes_a_sequence_of_pictures_and_a_strip() {
    let own = tempfile::tempdir().unwrap();
    let (folder, database, _) = demonstration();
    let [pictures, strip] = ["pictures", "strip.jpg"].map(|name| own.path().join(name));
    let path = folder.path().join("probes").join("groundtruth.tum");
    let report = json(&[
        "render",
        shown(database),
        "--path",
        shown(&path),
        "--out",
        shown(&pictures),
        "--strip",
        shown(&strip),
        "--method",
        "plane",
    ]);
    assert_eq!(report["pictures"], 20);
    assert_eq!(fs::read_dir(&pictures).unwrap().count(), 20);
    assert!(pictures.join("000019.png").exists());
    let strip = image::open(&strip).unwrap();
    assert!(strip.width() > 1200 && strip.height() > 400, "two rows of four");
}

#[test]
fn reconstructions_are_nearer_to_the_truth_than_the_nearest_picture() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, probes) = demonstration();
    let [details, pictures] = ["details.csv", "pictures"].map(|name| own.path().join(name));
    let report = json(&[
        "evaluate",
        shown(database),
        shown(probes),
        "--details",
        shown(&details),
        "--pictures",
        shown(&pictures),
    ]);
    let field = |method: &str| report["methods"][method]["psnr_field_db"].as_f64().unwrap();
    let ssim = |method: &str| report["methods"][method]["ssim"].as_f64().unwrap();
    assert!(field("plane") > field("nearest") + 5.5, "{report:#}");
    assert!(field("plane") > field("quadratic") + 2.0, "{report:#}");
    assert!(field("blend") > field("nearest") + 8.0 && ssim("blend") > ssim("nearest") + 0.1, "{report:#}");
    for method in ["nearest", "quadratic", "plane", "blend"] {
        assert_eq!(report["methods"][method]["answered"], 1.0);
        assert!(report["methods"][method]["milliseconds"].as_f64().unwrap() > 0.0);
        assert!(report["methods"][method]["psnr_db"].as_f64().unwrap() > 5.0);
    }
    let rows = fs::read_to_string(&details).unwrap();
    assert_eq!(rows.lines().count(), 1 + 20 * 5);
    assert_eq!(fs::read_dir(&pictures).unwrap().count(), 20);
}

#[cfg(feature = "gpu")]
#[test]
fn drawing_on_the_graphics_device_gives_the_same_picture() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let [cpu, gpu] = ["cpu", "gpu"].map(|backend| {
        let out = own.path().join(format!("{backend}.png"));
        json(&[
            "render",
            shown(database),
            "--pose",
            "-2.05,0.9,1.6",
            "--backend",
            backend,
            "--out",
            shown(&out),
        ]);
        image::open(&out).unwrap().into_rgb8()
    });
    let different = cpu.iter().zip(gpu.iter()).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    assert!(different < cpu.len() / 500, "{different} of {}", cpu.len());
}

/// A single picture, and a robot that only turned on the spot: there is no triangulation, but there are pictures.
#[test]
fn the_smallest_databases_give_pictures() {
    let own = tempfile::tempdir().unwrap();
    let one = part_of_walk(own.path(), "one", 0..1);
    let mut still = Sequence::open(&part_of_walk(own.path(), "still", 0..12)).unwrap();
    for (index, frame) in still.frames.iter_mut().enumerate() {
        let planar = reality_sim::Pose2::new(0.1, 0.2, 0.5 * index as f64);
        frame.reference_pose = frame.reference_pose.map(|pose| pose.with_planar(planar));
    }
    still.write(&still.folder).unwrap();
    let at = Sequence::open(&one).unwrap().frames[0].reference_pose.unwrap();
    for (sequence, pose) in
        [(one, format!("{},{},0.6", at.x_m, at.y_m)), (still.folder, "0.1,0.2,0.7".to_owned())]
    {
        let database = sequence.with_extension("db");
        let report = json(&["build", shown(&sequence), "--out", shown(&database)]);
        assert!(report.get("hall").is_none(), "one place does not tell where walls are: {report}");
        for method in ["nearest", "plane", "blend", "auto"] {
            let out = own.path().join("out.png");
            json(&[
                "render",
                shown(&database),
                "--pose",
                &pose,
                "--method",
                method,
                "--out",
                shown(&out),
                "--best-effort",
            ]);
        }
        json(&["info", shown(&database)]);
    }
}

#[test]
fn pixels_outside_the_image_circle_are_black_and_do_not_count_as_missing() {
    let own = tempfile::tempdir().unwrap();
    let walk = part_of_walk(own.path(), "walk", 0..20);
    let file = walk.join("camera.toml");
    let camera = fs::read_to_string(&file).unwrap();
    let circle = "image_circle = { cx = 319.5, cy = 239.5, radius = 185.0 }\n";
    fs::write(&file, format!("{circle}{camera}")).unwrap();
    let database = own.path().join("walk.db");
    json(&["build", shown(&walk), "--out", shown(&database)]);
    for method in ["quadratic", "plane", "blend"] {
        let out = own.path().join("out.png");
        let report = json(&[
            "render",
            shown(&database),
            "--pose=-1.8,0.35,2.1",
            "--method",
            method,
            "--out",
            shown(&out),
            "--best-effort",
        ]);
        let picture = image::open(&out).unwrap().into_rgb8();
        for corner in [(2, 2), (637, 2), (2, 477), (637, 477), (319, 40)] {
            assert_eq!(picture.get_pixel(corner.0, corner.1).0, [0; 3], "{method} {corner:?}");
        }
        assert!(report["covered"].as_f64().unwrap() > 0.6, "{method} {report}");
    }
}

#[test]
fn pictures_are_drawn_for_another_lens_but_nearest_needs_the_same_size() {
    let own = tempfile::tempdir().unwrap();
    let (_, database, _) = demonstration();
    let (camera, out) = (own.path().join("camera.toml"), own.path().join("out.png"));
    let lens = "model = 'PINHOLE'\nwidth = 200\nheight = 120\nfx = 120.0\nfy = 120.0\ncx = 99.5\ncy = 59.5\ndistortion = []\n";
    fs::write(&camera, format!("{lens}[mount]\nheight_m = 0.5\n")).unwrap();
    let render = |method: &'static str| {
        [
            "render",
            shown(database),
            "--pose",
            "-2.05,0.9,1.6",
            "--method",
            method,
            "--camera",
            shown(&camera),
            "--out",
            shown(&out),
        ]
    };
    for method in ["plane", "blend", "auto", "simulated"] {
        json(&render(method));
        assert_eq!(image::open(&out).unwrap().into_rgb8().dimensions(), (200, 120), "{method}");
    }
    assert_fails(&render("nearest"), &["200 x 120"]);
}
