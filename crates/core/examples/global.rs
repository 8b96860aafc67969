mod proto;
use proto::load;
use reality_sim_core::{observation::*, pose::*, preprocess::*, search::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = load(&a[1]);
    let pre = Preprocessor::new(&s.camera, s.field.line_width_m);
    let mut g = GlobalSearch::new(&s.camera, &s.field, Default::default());
    let mut chk = CpuScorer::new(&s.camera, &s.field, ObservationConfig::new(ObservationKind::Contrast));
    let step: usize = a[2].parse().unwrap();
    let (mut ok, mut n) = (0, 0);
    for (i, r) in s.rows.iter().enumerate().step_by(step) {
        let img = image::open(&r.1).unwrap().to_rgb8();
        let att = Attitude { height_m: s.height, pitch_rad: r.3, roll_rad: r.4 };
        let p = pre.prepare(&img, att);
        chk.load(&p);
        let t = std::time::Instant::now();
        let m = g.search(&p, att, None, 0);
        let dt = t.elapsed().as_secs_f64();
        let gt = s.gt[i];
        let err = |q: CameraPose| {
            let d = |q: Pose2| (q.position_in_world() - gt.planar().position_in_world()).length();
            let e = |q: Pose2| wrap_angle(q.yaw_rad - gt.yaw_rad).abs();
            let (x, y) = (q.planar(), q.planar().mirrored());
            if d(x) + e(x) < d(y) + e(y) { (d(x), e(x)) } else { (d(y), e(y)) }
        };
        let rank = m.iter().position(|q| {
            let e = err(q.pose);
            e.0 < 0.3 && e.1 < 0.2
        });
        let e = err(m[0].pose);
        n += 1;
        if e.0 < 0.5 && e.1 < 0.5 {
            ok += 1;
        }
        println!(
            "{i} {dt:.2}s modes {} rank {rank:?} best err {:.2} {:.2} lw {:.1} p {:.3} q {:.2} | 2nd lw {:.1} q {:.2} | gt q {:.2}",
            m.len(),
            e.0,
            e.1,
            m[0].log_weight,
            m[0].probability,
            chk.line_fraction(m[0].pose).unwrap_or(-9.0),
            m.get(1).map_or(0.0, |q| q.log_weight),
            m.get(1).map_or(0.0, |q| chk.line_fraction(q.pose).unwrap_or(-9.0)),
            chk.line_fraction(gt).unwrap_or(-9.0)
        );
    }
    println!("{ok}/{n}");
}
