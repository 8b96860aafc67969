//! Development: verdicts of several recordings.
#![allow(clippy::unwrap_used)]
use reality_sim_core::sequence::Sequence;
use reality_sim_gap::{Options, Recording, ReferenceSource, analyse};
use reality_sim_sensor::Model;
use std::time::Instant;
fn main() {
    let mut without = Vec::new();
    let mut blind = false;
    for arg in std::env::args().skip(1) {
        if let Some(id) = arg.strip_prefix("--without=") {
            without.push(id.to_owned());
            continue;
        }
        if arg == "--blind" {
            blind = true;
            continue;
        }
        let start = Instant::now();
        let mut sequence = Sequence::open(std::path::Path::new(&arg)).unwrap();
        if blind && let Some(p) = sequence.setup.photometry.as_mut() {
            p.line_linear_rgb = None;
            p.carpet_linear_rgb = None;
            p.noise_shot = None;
            p.noise_read = None;
            p.psf_sigma_px = None;
        }
        let poses: Vec<_> = sequence.reference_poses().collect();
        let recording = match Recording::new(&sequence, &poses, ReferenceSource::Measured, None) {
            Ok(r) => r,
            Err(e) => {
                println!("{arg}: {e}");
                continue;
            }
        };
        let options = Options { without: without.clone(), ..Options::default() };
        let analysis = match analyse(&recording, &Model::default(), &options, &|_| ()) {
            Ok(a) => a,
            Err(e) => {
                println!("{arg}: {e}");
                continue;
            }
        };
        let r = &analysis.report;
        let name: String = std::path::Path::new(&arg)
            .components()
            .rev()
            .take(2)
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
            .collect::<Vec<_>>()
            .join("/");
        println!(
            "{name}: {:?} {:.1}s gap {:.2}->{:.2}",
            r.verdict,
            start.elapsed().as_secs_f64(),
            r.gap.before,
            r.gap.after
        );
        for e in &r.effects {
            let p: Vec<String> =
                e.parameters.iter().map(|(k, v)| format!("{k}={:.4}±{:.4}", v.value, v.sigma)).collect();
            println!(
                "    {} p={:.1e} gain={:.0}±{:.0} conf={:?} closes={:?} {}",
                e.id,
                e.p_value,
                e.held_out_gain.value,
                e.held_out_gain.sigma,
                e.confusable_with,
                e.closes.iter().map(|(c, v)| format!("{c:?}:{v:.2}")).collect::<Vec<_>>(),
                p.join(" ")
            );
        }
        for u in &r.unexplained {
            println!("    ? {u:?}");
        }
        let ch: Vec<String> = r
            .gap
            .channels
            .iter()
            .map(|(c, g)| format!("{c:?} {:.3}>{:.3}({:.3})", g.before, g.after, g.floor))
            .collect();
        println!("    {}", ch.join("  "));
        if std::env::var("LIMITS").is_ok() {
            for n in &r.not_found {
                println!(
                    "      {} {} {:.4}{} p={:.2e} gain={:.1}±{:.1}",
                    n.id,
                    n.parameter,
                    n.detection_limit.value,
                    n.detection_limit.unit,
                    n.p_value,
                    n.held_out_gain.value,
                    n.held_out_gain.sigma
                );
            }
            for u in &r.unobservable {
                println!("      - {} {:?}", u.id, u.cause);
            }
        }
    }
}
