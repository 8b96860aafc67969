use reality_sim_core::{filter::*, observation::*, pose::*, preprocess::*, search::*, sequence::*, tag::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = Sequence::open(std::path::Path::new(&a[1])).unwrap();
    let ev = |k: &str| std::env::var(k).ok();
    let mut tol = TagConfig::new(ObservationKind::Contrast).tolerance;
    if let Some(v) = ev("HT") {
        tol.height_m = v.parse().unwrap();
    }
    if let Some(v) = ev("AT") {
        tol.angle_rad = v.parse().unwrap();
    }
    let pre = Preprocessor::new(&s.setup.camera, s.field.line_width_m);
    let mut g = GlobalSearch::new(&s.setup.camera, &s.field, tol);
    let v = ev("V").is_some();
    let (mut ok, mut n) = (0, 0);
    for i in 1..s.frames.len() {
        let img = s.load_image(i).unwrap();
        let r = recorded(&s, i, &img);
        let p = pre.prepare(&img, r.attitude);
        let m = s.frames[i - 1].odometry.unwrap().motion_to(r.odometry.unwrap());
        let gt = s.groundtruth[i].unwrap();
        let prior = Prior {
            pose: s.groundtruth[i - 1].unwrap().planar().moved(m),
            sigma: MotionNoise::default().sigma(Some(m)),
        };
        let modes = g.search(&p, r.attitude, Some(prior), 0);
        let e = |q: CameraPose| {
            ((q.x_m - gt.x_m).hypot(q.y_m - gt.y_m), wrap_angle(q.yaw_rad - gt.yaw_rad).abs())
        };
        let b = e(modes[0].pose);
        let own = g.best_of(&p, &[gt], r.attitude, Some(prior)).unwrap();
        let rank = modes.iter().position(|m| e(m.pose).0 < 0.3 && e(m.pose).1 < 0.15);
        n += 1;
        if b.0 < 0.5 && b.1 < 0.5 {
            ok += 1;
        }
        let pe = e(CameraPose::new(prior.pose, gt.height_m, 0.0, 0.0));
        if v || b.0 > 0.3 {
            println!(
                "{i} best {:.2} {:.2} lw {:.1} | rank {rank:?} | gt-fit err {:.2} lw {:.1} | prior err {:.2} {:.2} sigma {:.2} {:.2}",
                b.0,
                b.1,
                modes[0].log_weight,
                e(own.pose).0,
                own.log_weight,
                pe.0,
                pe.1,
                prior.sigma.position_m,
                prior.sigma.yaw_rad
            );
        }
    }
    println!("{ok}/{n}");
}
