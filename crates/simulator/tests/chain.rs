//! Layers against the simulated camera: a white line that is drawn as a layer on a picture without lines must look like the
//! line that the renderer draws, whatever effects the camera has.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{path::Path, sync::Arc};

use glam::{DAffine3, DVec2, DVec3, Vec3};
use image::RgbImage;
use reality_sim_core::{
    camera::Camera as Lens,
    pose::{CameraPose, Pose2},
    sequence::{CameraSetup, Photometry, Sequence},
    warp::CpuWarper,
};
use reality_sim_db::{Database, PoseEstimate, PoseSource};
use reality_sim_sensor::{Chain, Model, Renderer, SceneColors, Trajectory, Twist, effect};
use reality_sim_simulator::{
    Camera, Canvas, Class, Layer, LayerSettings, Light, Mesh, Object, Placed, Shading, View, draw_mesh,
};
use reality_sim_synthesis::{Archive, MethodKind, SynthesisConfig, Synthesizer};

/// Line of the field that is drawn as a layer, from the middle of the field's left side.
const LINE_HALF_LENGTH_M: f32 = 1.4;

/// Piece of a line as a layer of the line's own light.
#[derive(Debug)]
struct LineLayer {
    color: Vec3,
    middle: DVec2,
    half_width_m: f32,
}

impl Layer for LineLayer {
    fn objects(&self) -> Vec<Object<'_>> {
        vec![Object { class: Class::Line, name: "line".into() }]
    }

    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        let mut mesh = Mesh::cuboid(Vec3::new(LINE_HALF_LENGTH_M, self.half_width_m, 1e-5), Vec3::ONE);
        mesh.vertices.iter_mut().for_each(|vertex| vertex.place.z -= 1e-5);
        let placed = Placed::still(DAffine3::from_translation(self.middle.extend(0.0)));
        let light = Light { sky: self.color, ground: self.color };
        draw_mesh(view, canvas, &mesh, &placed, &Shading::matt(light), 0);
    }
}

struct Bench {
    _folder: tempfile::TempDir,
    synthesizer: Arc<Synthesizer>,
    setup: CameraSetup,
    field: reality_sim_core::field::FieldDimensions,
    pose: CameraPose,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("walk.db");
        let mut walk = Sequence::open(Path::new("../../assets/walk")).unwrap();
        walk.frames.truncate(12);
        let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
        // The archive's camera has photometry, and its pictures are a fraction as large.
        let photometry = Photometry {
            line_linear_rgb: Some([0.5, 0.52, 0.48]),
            carpet_linear_rgb: Some([0.05, 0.15, 0.06]),
            ..Photometry::of_gamma(2.2)
        };
        walk.setup.photometry = Some(photometry);
        let [fx, fy, cx, cy] = [walk.setup.camera.fx, walk.setup.camera.fy, 119.5, 89.5];
        let lens =
            Lens::new([240, 180], [0.375 * fx, 0.375 * fy, cx, cy], walk.setup.camera.distortion).unwrap();
        Database::create_or_open(&file).unwrap().ingest(&walk, &poses, &PoseSource::GroundTruth).unwrap();
        let archive = Arc::new(Archive::open(&file, 16 << 20).unwrap());
        let config = SynthesisConfig::new(&archive);
        let synthesizer =
            Arc::new(Synthesizer::with(archive.clone(), lens.clone(), Arc::new(CpuWarper), config));
        let setup = CameraSetup { camera: lens, ..archive.setup().clone() };
        let pose = CameraPose::new(Pose2::new(0.9, 0.9, 0.9), 0.5, 0.1, 0.02);
        Self { field: archive.field().clone(), setup, synthesizer, pose, _folder: folder }
    }

    fn colors(&self, with_lines: bool) -> SceneColors {
        let colors = SceneColors::new(&self.setup, &self.field);
        let line_linear_rgb = if with_lines { colors.line_linear_rgb } else { colors.carpet_linear_rgb };
        SceneColors { line_linear_rgb, ..colors }
    }

    fn rendered(&self, model: &Model, with_lines: bool, twist: Twist) -> RgbImage {
        let colors = self.colors(with_lines);
        let renderer = Renderer::with_model(&self.setup, &self.field, colors, model).unwrap();
        renderer.draw_at(&trajectory(self.pose, twist), 0.0, None).unwrap()
    }

    /// Returns the line as a layer over the renderer's picture without lines.
    fn composed(&self, model: &Model, empty: RgbImage, twist: Twist) -> RgbImage {
        let settings = LayerSettings::default().with_noise_seed(None);
        let camera = Camera::with(self.synthesizer.clone(), MethodKind::Blend);
        let mut camera = camera.with_model(model).unwrap().with_layer_settings(settings);
        camera.set_twist(twist);
        let half_length = self.field.length_m / 2.0;
        let line = LineLayer {
            color: self.colors(true).line_linear_rgb,
            middle: DVec2::new(half_length - 0.7 - f64::from(LINE_HALF_LENGTH_M), self.field.width_m / 2.0),
            half_width_m: 0.5 * self.field.line_width_m as f32,
        };
        camera.compose(self.pose, &[&line], empty).picture
    }

    /// Returns the pixels around the line, away from its ends and from other lines.
    fn window(&self, model: &Model) -> Vec<(u32, u32)> {
        let chain = Chain::new(&self.setup, &self.field, model).unwrap();
        let pixels = (0..180).flat_map(|v| (0..240).map(move |u| (u, v)));
        let is_near = |(u, v): &(u32, u32)| {
            let pixel = DVec2::new(f64::from(*u), f64::from(*v));
            let ground = chain.camera().unproject_to_ground(chain.mounted(self.pose), pixel);
            ground.is_ok_and(|p| (0.4..1.5).contains(&p.x) && (p.y - self.field.width_m / 2.0).abs() < 0.25)
        };
        pixels.filter(is_near).collect()
    }
}

/// Effects by their names, with their values.
type Effects = &'static [(&'static str, &'static [f64])];

/// Returns the trajectory of a camera that moves as a twist says, at a pose at time 0.
fn trajectory(pose: CameraPose, twist: Twist) -> Trajectory {
    if twist == Twist::default() {
        return Trajectory::still(pose);
    }
    let at = |time_s: f64| {
        let turn = glam::DQuat::from_scaled_axis(time_s * twist.angular_velocity_in_camera);
        let rotation = pose.quaternion_world_from_camera() * turn;
        let position = pose.position_in_world() + time_s * twist.velocity_in_world;
        (time_s, CameraPose::from_world_from_camera(position, rotation))
    };
    Trajectory::new(&[-0.2, -0.1, 0.0, 0.1, 0.2].map(at)).unwrap()
}

/// Returns the root mean square and the largest difference of two pictures in some pixels, grey levels.
fn difference(a: &RgbImage, b: &RgbImage, pixels: &[(u32, u32)]) -> (f64, f64) {
    let differences = pixels.iter().flat_map(|(u, v)| {
        let (a, b) = (a.get_pixel(*u, *v).0, b.get_pixel(*u, *v).0);
        (0..3).map(move |channel| f64::from(a[channel].abs_diff(b[channel])))
    });
    let (sum, largest, count) = differences
        .fold((0.0, 0.0_f64, 0.0), |(sum, largest, count), d| (sum + d * d, largest.max(d), count + 1.0));
    ((sum / f64::max(count, 1.0)).sqrt(), largest)
}

#[test]
fn a_layer_goes_through_every_effect_of_the_camera_as_the_scene_does() {
    let bench = Bench::new();
    let still = Twist::default();
    let moving = Twist {
        velocity_in_world: DVec3::new(0.3, 0.1, 0.0),
        angular_velocity_in_camera: DVec3::new(0.5, 0.6, 0.1),
    };
    let effects: [(Effects, Twist); 17] = [
        (&[], still),
        (&[("vignetting", &[0.6])], still),
        (&[("chromatic_aberration", &[0.01, -0.01])], still),
        (&[("defocus", &[1.2])], still),
        (&[("veiling_glare", &[0.3])], still),
        (&[("white_balance", &[0.25, -0.2])], still),
        (&[("black_level", &[0.2])], still),
        (&[("tone_curve", &[0.4])], still),
        (&[("sharpening", &[0.6])], still),
        (&[("focal_length", &[0.03])], still),
        (&[("principal_point", &[3.0, -2.0])], still),
        (&[("radial_distortion", &[0.02])], still),
        (&[("tangential_distortion", &[0.01, 0.01])], still),
        (&[("mount_pitch", &[0.04])], still),
        (&[("camera_height", &[0.05])], still),
        (&[("motion_blur", &[0.08]), ("defocus", &[0.7])], moving),
        (
            &[
                ("defocus", &[0.8]),
                ("vignetting", &[0.5]),
                ("tone_curve", &[0.2]),
                ("rolling_shutter", &[0.05]),
            ],
            moving,
        ),
    ];
    for (effects, twist) in effects {
        let model = effects.iter().fold(Model::default(), |model, (id, values)| {
            model.with(effect(id).unwrap_or_else(|| panic!("{id}")), values.to_vec())
        });
        let [empty, truth] = [false, true].map(|lines| bench.rendered(&model, lines, twist));
        let pixels = bench.window(&model);
        assert!(pixels.len() > 400, "{effects:?}: {}", pixels.len());
        let found = bench.composed(&model, empty.clone(), twist);
        let (rms, largest) = difference(&found, &truth, &pixels);
        // Sixteen parts of a pixel resolve a sharp edge of 130 grey levels to eight of them.
        assert!(rms < 2.2 && largest < 25.0, "{effects:?}: {rms} {largest}");
        let (drawn, _) = difference(&empty, &truth, &pixels);
        assert!(drawn > 15.0, "{effects:?}: {drawn}");
        if !effects.is_empty() {
            let (ignored, _) = difference(&bench.composed(&Model::default(), empty, still), &truth, &pixels);
            assert!(ignored > 2.0 * rms, "{effects:?}: {rms}, without the effect {ignored}");
        }
    }
}

#[test]
fn noise_has_the_variance_of_the_sensor() {
    let bench = Bench::new();
    let noisy = Model::default().with(effect("sensor_noise").unwrap(), [0.004, 2e-5]);
    let empty = bench.rendered(&noisy, false, Twist::default());
    let camera = Camera::with(bench.synthesizer.clone(), MethodKind::Blend).with_model(&noisy).unwrap();
    let patch = LineLayer { color: Vec3::splat(0.3), middle: DVec2::new(0.9, 1.9), half_width_m: 0.5 };
    let settings = LayerSettings::default();
    let composed = |seed: Option<u64>| {
        let mut camera = camera.clone().with_layer_settings(settings.with_noise_seed(seed));
        camera.compose(bench.pose, &[&patch], empty.clone())
    };
    let (quiet, first, second) = (composed(None), composed(Some(1)), composed(Some(2)));
    assert_eq!(composed(Some(1)).picture, first.picture);
    let inside: Vec<usize> = (0..quiet.object_of.len())
        .filter(|index| quiet.object_of[*index] == 0 && quiet.picture.as_raw()[3 * index] > 147)
        .collect();
    assert!(inside.len() > 1000);
    let variance = |frame: &RgbImage| {
        let off = inside
            .iter()
            .map(|index| f64::from(frame.as_raw()[3 * index]) - f64::from(quiet.picture.as_raw()[3 * index]));
        off.map(|off| off * off).sum::<f64>() / inside.len() as f64
    };
    // The slope of the tone curve at 0.3.
    let slope = 255.0 / 2.2 * 0.3_f64.powf(1.0 / 2.2 - 1.0);
    let expected = (0.004 * 0.3 + 2e-5) * slope * slope + 1.0 / 12.0;
    for frame in [&first, &second] {
        let ratio = variance(&frame.picture) / expected;
        assert!((0.85..1.15).contains(&ratio), "{ratio}");
    }
    assert_ne!(first.picture, second.picture);
}
