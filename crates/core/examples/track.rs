use reality_sim_core::{observation::*, pose::*, sequence::*, tag::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut s = Sequence::open(std::path::Path::new(&a[1])).unwrap();
    let kind = match a[2].as_str() {
        "gauss" => ObservationKind::Gauss,
        "distance" => ObservationKind::Distance,
        _ => ObservationKind::Contrast,
    };
    let mut c = TagConfig::new(kind);
    let ev = |k: &str| std::env::var(k).ok();
    if let Some(v) = ev("SEED") {
        c.filter.seed = v.parse().unwrap();
    }
    if ev("NOODO").is_some() {
        c.odometry = false;
    }
    if let Some(v) = ev("SPACING") {
        c.observation.spacing_m = v.parse().unwrap();
    }
    if let Some(v) = ev("ALPHA") {
        c.observation.alpha = v.parse().unwrap();
    }
    if let Some(v) = ev("BLUR") {
        c.observation.blur_sigma_px = v.parse().unwrap();
    }
    if let Some(v) = ev("GAIN") {
        c.observation.contrast_gain = v.parse().unwrap();
    }
    if let Some(v) = ev("NEUTRAL") {
        c.observation.contrast_neutral = v.parse().unwrap();
    }
    if let Some(v) = ev("AT") {
        c.tolerance.angle_rad = v.parse().unwrap();
        if let Some(t) = &mut c.filter.attitude_tolerance {
            t.angle_rad = c.tolerance.angle_rad;
        }
    }
    if let Some(v) = ev("HT") {
        c.tolerance.height_m = v.parse().unwrap();
        if let Some(t) = &mut c.filter.attitude_tolerance {
            t.height_m = c.tolerance.height_m;
        }
    }
    if ev("NORECOVER").is_some() {
        c.recovery = false;
    }
    if let Some(v) = ev("CUT") {
        // drop frames a..b, odometry reset
        let k: Vec<usize> = v.split(',').map(|x| x.parse().unwrap()).collect();
        let o = s.frames[k[1]].odometry.unwrap();
        for f in &mut s.frames[k[1]..] {
            let m = o.motion_to(f.odometry.unwrap());
            f.odometry = Some(Pose2::default().moved(m));
        }
        s.frames.drain(k[0]..k[1]);
        s.groundtruth.drain(k[0]..k[1]);
    }
    if let Some(v) = ev("FROM") {
        let k: usize = v.parse().unwrap();
        s.frames.drain(..k);
        s.groundtruth.drain(..k);
    }
    if let Some(v) = ev("N") {
        let k: usize = v.parse().unwrap();
        s.frames.truncate(k);
        s.groundtruth.truncate(k);
    }
    let start = if ev("NOSTART").is_some() { None } else { s.start };
    let sym = ev("NOSTART").is_some() || ev("CUT").is_some();
    let mut t = Tagger::new(&s.setup.camera, &s.field, start, c);
    let v = a.len() > 3;
    let mut e = vec![];
    let (mut sw, mut searched) = (0, 0);
    let mut nz = vec![];
    let out = tag_sequence(&s, &mut t, |i, f, _, _| {
        let g = s.groundtruth[i].unwrap();
        let mut p = f.pose;
        if sym
            && (p.x_m - g.x_m).hypot(p.y_m - g.y_m)
                > (p.mirrored().x_m - g.x_m).hypot(p.mirrored().y_m - g.y_m)
        {
            p = p.mirrored();
        }
        let d = (p.x_m - g.x_m).hypot(p.y_m - g.y_m);
        let y = wrap_angle(p.yaw_rad - g.yaw_rad).abs();
        e.push((d, y));
        let wrong = d > 0.5 || y > 0.5;
        if wrong && f.sure {
            sw += 1;
        }
        if f.searched {
            searched += 1;
        }
        if let Some(fit) = f.fit {
            let v3 = nalgebra::Vector3::new(p.x_m - g.x_m, p.y_m - g.y_m, wrap_angle(p.yaw_rad - g.yaw_rad));
            nz.push(
                (v3.transpose()
                    * fit.covariance.fixed_view::<3, 3>(0, 0).into_owned().try_inverse().unwrap()
                    * v3)[0],
            );
        }
        if v {
            println!(
                "{i} {d:.3} {y:.3} q {:.2} sure {} searched {} fit {} ess {:.0} mirror {:.2} {:.1} ms",
                f.line_fraction,
                f.sure,
                f.searched,
                f.fit.is_some(),
                f.filter.effective_sample_size,
                f.mirror_probability,
                f.seconds * 1e3
            );
        }
        Ok(())
    })
    .unwrap();
    let n = e.len();
    let lost = e.iter().filter(|x| x.0 > 0.5 || x.1 > 0.5).count();
    let mut d: Vec<f64> = e.iter().map(|x| x.0).collect();
    d.sort_by(f64::total_cmp);
    let mut ms: Vec<f64> = out.iter().map(|f| f.seconds * 1e3).collect();
    ms.sort_by(f64::total_cmp);
    nz.sort_by(f64::total_cmp);
    let cov = |q: f64| nz.iter().filter(|v| **v < q).count() as f64 / nz.len().max(1) as f64;
    println!(
        "{:40} {:9} n {n} mean {:.2} cm med {:.2} p95 {:.2} max {:.1} yaw {:.3}° lost {lost} sure-wrong {sw} unsure {} searched {searched} {:.1} ms fits {} cover {:.2} {:.2} {:.2}",
        a[1].rsplit("data/").next().unwrap(),
        a[2],
        100.0 * d.iter().sum::<f64>() / n as f64,
        100.0 * d[n / 2],
        100.0 * d[n * 95 / 100],
        100.0 * d[n - 1],
        e.iter().map(|x| x.1).sum::<f64>().to_degrees() / n as f64,
        out.iter().filter(|f| !f.sure).count(),
        ms[n / 2],
        nz.len(),
        cov(2.366),
        cov(6.251),
        cov(7.815)
    );
}
