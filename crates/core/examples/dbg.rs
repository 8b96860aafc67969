use reality_sim_core::{field::*, preprocess::*, sequence::*, tag::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = Sequence::open(std::path::Path::new(&a[1])).unwrap();
    let pre = Preprocessor::new(&s.setup.camera, s.field.line_width_m);
    for i in a[2..].iter().map(|x| x.parse::<usize>().unwrap()) {
        let img = s.load_image(i).unwrap();
        let r = recorded(&s, i, &img);
        let p = pre.prepare(&img, r.attitude);
        let gt = s.groundtruth[i].unwrap();
        println!("{i} {:?} evidence {}", p.levels, p.evidence.iter().filter(|v| **v > 0).count());
        let t = Texture::pack(&p.whiteness);
        let mut o = img.clone();
        for (x, y, px) in o.enumerate_pixels_mut() {
            if !p.border.contains(x, y) {
                px.0 = px.0.map(|c| c / 2);
            }
            if p.evidence.get_pixel(x, y).0[0] > 0 {
                px.0 = [255, 0, 255];
            }
        }
        let lw = s.field.line_width_m;
        for q in sample_lines(&s.field, lw) {
            if q.clearance_m < 1.8 * lw {
                continue;
            }
            let pr = |d: f64| {
                s.setup
                    .camera
                    .project(gt.camera_from_world((q.point_in_world + d * q.normal_in_world()).extend(0.0)))
                    .ok()
            };
            if let (Some(c), Some(l), Some(rr)) = (pr(0.0), pr(lw), pr(-lw)) {
                let v = |p: glam::DVec2| t.sample(p.x as f32, p.y as f32);
                let m = (v(c) - v(l).max(v(rr))) / (v(c) + v(l).max(v(rr)) + 16.0) / p.levels.michelson(16.0);
                let k = (m.clamp(0.0, 1.0) * 255.0) as u8;
                let w = (l - rr).length() / 2.0;
                let sz = if w > 3.0 {
                    3
                } else if w > 1.5 {
                    1
                } else {
                    0
                };
                for dx in -sz..=sz {
                    for dy in -sz..=sz {
                        let (x, y) =
                            ((c.x as i32 + dx).clamp(0, 607) as u32, (c.y as i32 + dy).clamp(0, 799) as u32);
                        o.put_pixel(x, y, image::Rgb([255 - k, k, 0]));
                    }
                }
            }
        }
        o.save(format!("/tmp/v/d{i}.png")).unwrap();
    }
}
