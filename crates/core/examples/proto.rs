use reality_sim_core::{camera::*, field::*, filter::*, observation::*, pose::*, preprocess::*};
use std::path::Path;
pub struct Seq {
    pub camera: Camera,
    pub field: FieldDimensions,
    pub height: f64,
    pub rows: Vec<(f64, String, Pose2, f64, f64)>,
    pub gt: Vec<CameraPose>,
    pub start: Pose2,
}
pub fn load(dir: &str) -> Seq {
    let rd = |n: &str| std::fs::read_to_string(Path::new(dir).join(n)).unwrap();
    let cam: toml::Table = toml::from_str(&rd("camera.toml")).unwrap();
    let f = |k: &str| cam[k].as_float().unwrap();
    let d: Vec<f64> = cam["distortion"].as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
    let dist = match cam["model"].as_str().unwrap() {
        "OPENCV" => Distortion::Opencv(Opencv { k1: d[0], k2: d[1], p1: d[2], p2: d[3], k3: 0.0 }),
        _ => Distortion::OpencvFisheye(OpencvFisheye { k: [d[0], d[1], d[2], d[3]] }),
    };
    let circle = cam.get("image_circle").map(|v| ImageCircle {
        cx: v["cx"].as_float().unwrap(),
        cy: v["cy"].as_float().unwrap(),
        radius: v["radius"].as_integer().unwrap() as f64,
    });
    let camera = Camera::new(
        [cam["width"].as_integer().unwrap() as u32, cam["height"].as_integer().unwrap() as u32],
        [f("fx"), f("fy"), f("cx"), f("cy")],
        dist,
    )
    .unwrap()
    .with_image_circle(circle);
    let field: FieldDimensions = toml::from_str(&rd("field.toml")).unwrap();
    let height = cam["mount"]["height_m"].as_float().unwrap();
    let rows = rd("frames.csv")
        .lines()
        .skip(1)
        .map(|l| {
            let v: Vec<&str> = l.split(',').collect();
            let n = |i: usize| v[i].parse::<f64>().unwrap();
            (n(0), format!("{dir}/{}", v[1]), Pose2::new(n(2), n(3), n(4)), n(5), n(6))
        })
        .collect();
    let gt = rd("groundtruth.tum")
        .lines()
        .map(|l| {
            let v: Vec<f64> = l.split_whitespace().map(|x| x.parse().unwrap()).collect();
            CameraPose::from_world_from_camera(
                glam::DVec3::new(v[1], v[2], v[3]),
                glam::DQuat::from_xyzw(v[4], v[5], v[6], v[7]),
            )
        })
        .collect();
    let s: toml::Table = toml::from_str(&rd("sequence.toml")).unwrap();
    let g = |k: &str| s["start"][k].as_float().unwrap();
    Seq { camera, field, height, rows, gt, start: Pose2::new(g("x_m"), g("y_m"), g("yaw_rad")) }
}
#[allow(dead_code)]
pub fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = load(&a[1]);
    let pre = Preprocessor::new(&s.camera, s.field.line_width_m);
    if a[2] == "border" {
        for i in a[3..].iter().map(|v| v.parse::<usize>().unwrap()) {
            let r = &s.rows[i];
            let img = image::open(&r.1).unwrap().to_rgb8();
            let t = std::time::Instant::now();
            let p = pre.prepare(&img, Attitude { height_m: s.height, pitch_rad: r.3, roll_rad: r.4 });
            let e = t.elapsed();
            println!("{i} {e:?} {:?} {:?}", p.border.carpet, p.levels);
            let mut o = img.clone();
            for (x, y, px) in o.enumerate_pixels_mut() {
                if !p.border.contains(x, y) {
                    px.0 = [px.0[0] / 3, px.0[1] / 3, px.0[2] / 3];
                }
                if p.evidence.get_pixel(x, y).0[0] > 0 {
                    px.0 = [255, 0, 0];
                }
            }
            o.save(format!("/tmp/v/b{i}.png")).unwrap();
        }
        return;
    }
    let kind = match a[2].as_str() {
        "gauss" => ObservationKind::Gauss,
        "distance" => ObservationKind::Distance,
        _ => ObservationKind::Contrast,
    };
    let mut scorer = CpuScorer::new(&s.camera, &s.field, ObservationConfig::new(kind));
    let n = 800;
    let iters = 5;
    let seed = 0;
    let mut parts: Vec<CameraPose> = (0..n)
        .map(|i| {
            let z = Stream::new(seed, Purpose::Initialise, 0, 0).normals(i);
            Attitude { height_m: s.height, pitch_rad: 0.0, roll_rad: 0.0 }.at(Pose2::new(
                s.start.x_m + 0.05 * z[0],
                s.start.y_m + 0.05 * z[1],
                s.start.yaw_rad + 0.05 * z[2],
            ))
        })
        .collect();
    let refiner = reality_sim_core::refine::Refiner::new(&s.camera, &s.field, Default::default());
    let refine = std::env::var("REFINE").is_ok();
    let fb = std::env::var("FB").is_ok();
    let mut nz = vec![];
    let mut rerr: Vec<(f64, f64, (f64, f64, f64), f64, f64)> = vec![];
    let mut errs = vec![];
    let mut times = vec![];
    for (fi, r) in s.rows.iter().enumerate() {
        let img = image::open(&r.1).unwrap().to_rgb8();
        let t = std::time::Instant::now();
        let att = Attitude { height_m: s.height, pitch_rad: r.3, roll_rad: r.4 };
        let p = pre.prepare(&img, att);
        scorer.load(&p);
        let t1 = t.elapsed();
        let m = if fi > 0 { s.rows[fi - 1].2.motion_to(r.2) } else { Motion2::default() };
        let st = Stream::new(seed, Purpose::Predict, fi as u32, 0);
        let (sx, sa) = (0.02 + 0.15 * m.distance_m(), 0.02 + 0.1 * m.turn_rad.abs());
        for (i, q) in parts.iter_mut().enumerate() {
            let z = st.normals(i as u32);
            let pl = q.planar().moved(m);
            *q = att.at(Pose2::new(pl.x_m + sx * z[0], pl.y_m + sx * z[1], pl.yaw_rad + sa * z[2]));
        }
        let mut best = (f64::MIN, parts[0]);
        for it in 0..iters {
            let k = 0.6f64.powi(it as i32);
            if it > 0 {
                let st = Stream::new(seed, Purpose::Diffuse, fi as u32, it);
                for (i, q) in parts.iter_mut().enumerate() {
                    let z = st.normals(i as u32);
                    q.x_m += k * sx * z[0];
                    q.y_m += k * sx * z[1];
                    q.yaw_rad += k * sa * z[2];
                }
            }
            let lw = scorer.log_weights(&parts);
            let b = best_index(&lw).unwrap();
            if lw[b] > best.0 {
                best = (lw[b], parts[b]);
            }
            let w = normalise(&lw);
            let c = Resampling::Residual.choose(
                &w,
                n as usize,
                Stream::new(seed, Purpose::Resample, fi as u32, it),
            );
            parts = c.iter().map(|&i| parts[i]).collect();
        }
        times.push((t1.as_secs_f64(), t.elapsed().as_secs_f64()));
        let g = s.gt[fi];
        if refine {
            let tex = Texture::pack(if a[2] == "luma" { &p.luma } else { &p.whiteness });
            let from = if std::env::var("GT").is_ok() { g } else { best.1 };
            if let Some(f) = refiner.fit(&tex, from, att, p.levels.contrast() as f64) {
                let d = [
                    f.pose.x_m - g.x_m,
                    f.pose.y_m - g.y_m,
                    wrap_angle(f.pose.yaw_rad - g.yaw_rad),
                    f.pose.height_m - g.height_m,
                    f.pose.pitch_rad - g.pitch_rad,
                    f.pose.roll_rad - g.roll_rad,
                ];
                let v = nalgebra::Vector6::from_row_slice(&d);
                let c3 = f.covariance.fixed_view::<3, 3>(0, 0).into_owned();
                let v3 = nalgebra::Vector3::new(d[0], d[1], d[2]);
                let nees = (v3.transpose() * c3.try_inverse().unwrap() * v3)[0];
                let _ = v;
                nz.push(nees);
                rerr.push((d[0].hypot(d[1]), d[2].abs(), (d[3], d[4], d[5]), f.residual_px, f.found));
                if a.len() > 3 {
                    println!(
                        "   fit {:.4} yaw {:.3} deg res {:.2} px found {:.2} n {} nees {:.1} h {:.3} p {:.4} r {:.4} sd {:.4}",
                        d[0].hypot(d[1]),
                        d[2].to_degrees(),
                        f.residual_px,
                        f.found,
                        f.offsets,
                        nees,
                        d[3],
                        d[4],
                        d[5],
                        f.covariance[(0, 0)].sqrt()
                    );
                }
                best.1 = f.pose;
                if fb {
                    for q in parts.iter_mut() {
                        *q = q.with_planar(f.pose.planar());
                    }
                }
            } else if a.len() > 3 {
                println!("   no fit");
            }
        }
        let e = (best.1.planar().position_in_world() - g.planar().position_in_world()).length();
        let ey = wrap_angle(best.1.yaw_rad - g.yaw_rad).abs();
        if a.len() > 3 {
            println!(
                "{fi} {e:.3} {ey:.4} lw {:.1} gt {:.1}",
                best.0,
                scorer.log_weights(&[att.at(g.planar())])[0]
            );
        }
        errs.push((e, ey));
    }
    let mut e: Vec<f64> = errs.iter().map(|v| v.0).collect();
    e.sort_by(f64::total_cmp);
    let lost = errs.iter().filter(|v| v.0 > 0.5 || v.1 > 0.5).count();
    let k = e.len();
    let mut tt: Vec<f64> = times.iter().map(|t| t.1).collect();
    tt.sort_by(f64::total_cmp);
    let mut t1: Vec<f64> = times.iter().map(|t| t.0).collect();
    t1.sort_by(f64::total_cmp);
    if refine {
        let mut x: Vec<f64> = rerr.iter().map(|v| v.0).collect();
        x.sort_by(f64::total_cmp);
        let n = x.len();
        let m = |f: &dyn Fn(&(f64, f64, (f64, f64, f64), f64, f64)) -> f64| {
            rerr.iter().map(f).sum::<f64>() / n as f64
        };
        let rms = |f: &dyn Fn(&(f64, f64, (f64, f64, f64), f64, f64)) -> f64| m(&|v| f(v).powi(2)).sqrt();
        println!(
            "fits {n} mean {:.2} median {:.2} p95 {:.2} max {:.2} cm yaw {:.3} deg h {:.2}±{:.2} cm p {:.4}±{:.4} r {:.4}±{:.4} res {:.2} found {:.2} nees mean {:.2}",
            100.0 * m(&|v| v.0),
            100.0 * x[n / 2],
            100.0 * x[n * 95 / 100],
            100.0 * x[n - 1],
            m(&|v| v.1).to_degrees(),
            100.0 * m(&|v| v.2.0),
            100.0 * rms(&|v| v.2.0),
            m(&|v| v.2.1),
            rms(&|v| v.2.1),
            m(&|v| v.2.2),
            rms(&|v| v.2.2),
            m(&|v| v.3),
            m(&|v| v.4),
            nz.iter().sum::<f64>() / n as f64
        );
        nz.sort_by(f64::total_cmp);
        let cov = |q: f64| nz.iter().filter(|v| **v < q).count() as f64 / n as f64;
        println!("  coverage 50 {:.2} 90 {:.2} 95 {:.2}", cov(2.366), cov(6.251), cov(7.815));
    }
    println!(
        "{} {}: mean {:.2} cm median {:.2} p95 {:.2} max {:.1} lost {lost} yaw {:.2} deg | {:.2} ms (pre {:.2})",
        a[1],
        a[2],
        100.0 * e.iter().sum::<f64>() / k as f64,
        100.0 * e[k / 2],
        100.0 * e[k * 95 / 100],
        100.0 * e[k - 1],
        errs.iter().map(|v| v.1).sum::<f64>().to_degrees() / k as f64,
        tt[k / 2] * 1e3,
        t1[k / 2] * 1e3
    );
}
