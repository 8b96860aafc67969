//! How well a ball that is added to a picture looks like one that was there, and what each stage of its way into the picture
//! is worth:
//!
//! `cargo run --release --example composed_ball -- DATABASE EMPTY_PROBES BALL_PROBES [model.toml [PICTURES_FOLDER]]`
//!
//! The two folders hold pictures at the same poses, without and with a ball whose place `balls.json` tells. The ball's
//! colour, the blur and the noise are found on the probes with even numbers; the figures are those of the odd ones.

#[path = "composed_ball/compared.rs"]
mod compared;
#[path = "composed_ball/hard_edges.rs"]
mod hard_edges;
#[path = "composed_ball/probes.rs"]
mod probes;

use std::{
    io::Write,
    path::{Path, PathBuf},
    sync::Arc,
    time::Instant,
};

use anyhow::{Context, bail};
use glam::{DVec2, Vec3};
use reality_sim::{
    Archive, Synthesizer,
    evaluation::percentile,
    pose::Motion2,
    sensor::{Model, effect},
    simulator::{Ball, Camera, Frame, Humanoid, Layer, LayerSettings},
    synthesis::MethodKind,
};

use crate::{
    compared::{Compared, Mean},
    hard_edges::HardEdges,
    probes::{Probe, read_probes},
};

/// Standard deviations of the blur that are tried, pixels.
const SIGMAS_PX: [f64; 9] = [0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4];
/// Reflectance that the search for the ball's starts from, and the number of its steps: each brings the ball's mean colour to
/// the true one.
const START: Vec3 = Vec3::new(0.6, 0.3, 0.05);
const STEPS: usize = 4;
/// Shares of mirrored light that are tried.
const GLOSSES: [f32; 6] = [0.0, 0.2, 0.3, 0.4, 0.5, 0.6];
/// Shot noise that the search for the pictures' starts from.
const START_SHOT: f64 = 0.0007;

/// Stages on the way of a ball into a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stages {
    smooth_edges: bool,
    blur: bool,
    vignetting: bool,
    noise: bool,
    light: bool,
    shadow: bool,
}

impl Stages {
    const ALL: Self =
        Self { smooth_edges: true, blur: true, vignetting: true, noise: true, light: true, shadow: true };

    /// Lists what is compared: all stages, each of them left out, none.
    fn listed() -> [(&'static str, Self); 8] {
        let all = Self::ALL;
        let none = Self {
            smooth_edges: false,
            blur: false,
            vignetting: false,
            noise: false,
            light: false,
            shadow: false,
        };
        [
            ("all stages", all),
            ("without smooth edges", Self { smooth_edges: false, ..all }),
            ("without blur", Self { blur: false, ..all }),
            ("without vignetting", Self { vignetting: false, ..all }),
            ("without noise", Self { noise: false, ..all }),
            ("without matched light", Self { light: false, ..all }),
            ("without shadow", Self { shadow: false, ..all }),
            ("without all of them", none),
        ]
    }
}

/// What is developed on the even probes.
#[derive(Debug, Clone)]
struct Developed {
    vignetting: Option<Vec<f64>>,
    sigma_px: f64,
    noise_shot: f64,
    reflectance: Vec3,
    gloss: f32,
}

struct Study {
    synthesizer: Arc<Synthesizer>,
    probes: Vec<Probe>,
    /// Folder into which composed pictures are written.
    pictures: Option<PathBuf>,
}

impl Study {
    fn camera(&self, stages: Stages, developed: &Developed) -> anyhow::Result<Camera> {
        let mut model = Model::default();
        let known = |id: &str| effect(id).with_context(|| format!("no effect {id}"));
        if let Some(values) = developed.vignetting.as_ref().filter(|_| stages.vignetting) {
            model = model.with(known("vignetting")?, values.clone());
        }
        if stages.blur && developed.sigma_px > 0.0 {
            model = model.with(known("defocus")?, [developed.sigma_px]);
        }
        if stages.noise {
            model = model.with(known("sensor_noise")?, [developed.noise_shot]);
        }
        let settings = LayerSettings::default()
            .with_matched_light(stages.light)
            .with_shadows(stages.shadow)
            .with_noise_seed(stages.noise.then_some(1));
        let camera = Camera::with(self.synthesizer.clone(), MethodKind::Blend);
        Ok(camera.with_model(&model)?.with_layer_settings(settings))
    }

    /// Compares the composed ball of every second probe, from this one on, with the true one: over the true empty picture, or
    /// over the reconstructed one.
    fn compared(
        &self,
        first: usize,
        stages: Stages,
        developed: &Developed,
        over_truth: bool,
    ) -> anyhow::Result<Vec<Compared>> {
        let mut camera = self.camera(stages, developed)?;
        let mut compared = Vec::new();
        for probe in self.probes.iter().filter(|probe| probe.number % 2 == first) {
            let [x, y, z] = probe.ball;
            let ball = Ball::on_ground(x, y, z, developed.reflectance).glossy(developed.gloss);
            let hard = HardEdges { layer: &ball };
            let layer: &dyn Layer = if stages.smooth_edges { &ball } else { &hard };
            let (without, with) = if over_truth {
                (probe.empty.clone(), camera.compose(probe.pose, &[layer], probe.empty.clone()).picture)
            } else {
                let (mut without, mut with) = (Frame::default(), Frame::default());
                camera.look(probe.pose, &[], &mut without)?;
                camera.look(probe.pose, &[layer], &mut with)?;
                (without.picture, with.picture)
            };
            if let Some(folder) = self.pictures.as_ref().filter(|_| stages == Stages::ALL && first == 1) {
                let name = format!("{:02}-{}.png", probe.number, if over_truth { "truth" } else { "blend" });
                with.save(folder.join(name))?;
            }
            compared.extend(probe.compare(camera.chain().camera(), &without, &with));
        }
        Ok(compared)
    }

    /// Finds colour, blur and noise of the balls in the even probes.
    fn develop(&self, vignetting: Option<Vec<f64>>) -> anyhow::Result<Developed> {
        let quiet = Stages { noise: false, ..Stages::ALL };
        let mut developed =
            Developed { vignetting, sigma_px: 0.5, noise_shot: 0.0, reflectance: START, gloss: 0.0 };
        let mut best = f64::INFINITY;
        for gloss in GLOSSES {
            let mut tried = Developed { gloss, reflectance: START, ..developed.clone() };
            for _ in 0..STEPS {
                let ratio = Mean::color_ratio(&self.compared(0, quiet, &tried, true)?);
                tried.reflectance = (tried.reflectance * ratio).clamp(Vec3::ZERO, Vec3::splat(2.0));
            }
            let error = Mean::of(&self.compared(0, quiet, &tried, true)?, |compared| compared.inner_error);
            if error < best {
                (best, developed) = (error, tried);
            }
        }
        best = f64::INFINITY;
        for sigma_px in SIGMAS_PX {
            let tried = Developed { sigma_px, ..developed.clone() };
            let error = Mean::of(&self.compared(0, quiet, &tried, true)?, |compared| compared.edge_error);
            if error < best {
                (best, developed.sigma_px) = (error, sigma_px);
            }
        }
        developed.noise_shot = START_SHOT;
        for _ in 0..STEPS {
            let noise =
                Mean::of(&self.compared(0, Stages::ALL, &developed, true)?, |compared| compared.noise);
            developed.noise_shot /= noise * noise;
        }
        Ok(developed)
    }
}

/// Returns the median time that a ball and three robots before the camera take, milliseconds.
fn milliseconds(study: &Study, developed: &Developed) -> anyhow::Result<f64> {
    let mut camera = study.camera(Stages::ALL, developed)?;
    let mut times = Vec::new();
    for probe in &study.probes {
        let ahead = |distance_m: f64, left_m: f64| {
            probe.pose.planar().moved(Motion2 {
                forward_m: distance_m,
                left_m,
                turn_rad: std::f64::consts::PI,
            })
        };
        let place = ahead(1.0, 0.1);
        let ball = Ball::on_ground(place.x_m, place.y_m, 0.065, developed.reflectance);
        let robots = [(1.2, -0.4), (1.8, 0.5), (2.5, -0.9)].map(|(x, y)| {
            Humanoid::standing(ahead(x, y), 0.55, Vec3::new(0.1, 0.2, 0.6)).walking(x, DVec2::ZERO)
        });
        let layers: [&dyn Layer; 4] = [&ball, &robots[0], &robots[1], &robots[2]];
        let picture = probe.empty.clone();
        let start = Instant::now();
        let frame = camera.compose(probe.pose, &layers, picture);
        times.push(1e3 * start.elapsed().as_secs_f64());
        if let Some(folder) = &study.pictures {
            frame.picture.save(folder.join(format!("{:02}-robots.png", probe.number)))?;
        }
    }
    times.sort_by(f64::total_cmp);
    percentile(&times, 0.5).context("there are no probes")
}

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [database, empty, balls, rest @ ..] = arguments.as_slice() else {
        bail!("give DATABASE EMPTY_PROBES BALL_PROBES [model.toml [PICTURES_FOLDER]]");
    };
    let model = rest.first().map_or(Ok(Model::default()), |file| Model::read(Path::new(file)))?;
    let pictures = rest.get(1).map(PathBuf::from);
    if let Some(folder) = &pictures {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let archive = Arc::new(Archive::open(Path::new(database), 512 << 20)?);
    let synthesizer = Arc::new(Synthesizer::new(archive));
    let probes = read_probes(Path::new(empty), Path::new(balls))?;
    let study = Study { synthesizer, probes, pictures };
    let developed = study.develop(model.values("vignetting").map(<[f64]>::to_vec))?;
    let mut out = std::io::stdout();
    writeln!(
        out,
        "found on even probes: reflectance {:.3} {:.3} {:.3}, gloss {}, blur {} px, shot noise {:.5}",
        developed.reflectance.x,
        developed.reflectance.y,
        developed.reflectance.z,
        developed.gloss,
        developed.sigma_px,
        developed.noise_shot
    )?;
    for (over_truth, name) in
        [(true, "over the true empty picture"), (false, "over the reconstruction (blend)")]
    {
        writeln!(out, "\n{name}, odd probes\n\n{}", Mean::HEADER)?;
        for (stage, stages) in Stages::listed() {
            let all = study.compared(1, stages, &developed, over_truth)?;
            writeln!(out, "{}", Mean::new(&all).row(stage))?;
        }
    }
    writeln!(out, "\na ball and three robots at 1 to 2.5 m: {:.2} ms", milliseconds(&study, &developed)?)?;
    Ok(())
}
