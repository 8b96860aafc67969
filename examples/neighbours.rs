//! Memory per image in the index of poses and in the kd-tree that the benchmarks compare it with, and how often the
//! kd-tree finds the truly nearest image, which the index always finds:
//!
//! `cargo run --release --example neighbours`
//!
//! A counting allocator measures the memory: what is allocated once an index is built, and the peak until then.

#[path = "../benches/counting.rs"]
mod counting;
#[path = "../benches/kd_tree.rs"]
mod kd_tree;
#[path = "../benches/poses.rs"]
mod poses;

use std::{io::Write, path::Path};

use anyhow::Context;
use reality_sim::Sequence;
use reality_sim::db::index::PoseIndex;

use crate::{
    counting::measured,
    kd_tree::KdIndex,
    poses::{metric, random_poses},
};

const IMAGES: [usize; 3] = [300, 10_000, 1_000_000];
const QUERIES: usize = 1000;
const CANDIDATES: [usize; 3] = [1, 16, 64];

fn main() -> anyhow::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/walk");
    let metric = metric(&Sequence::open(&folder).context("the demonstration walk")?);
    let queries = random_poses(QUERIES, 1);
    let mut out = std::io::stdout();
    for images in IMAGES {
        let poses = random_poses(images, 0);
        let (index, held, most) = measured(|| PoseIndex::new(metric.clone(), poses.clone()));
        writeln!(out, "{images} images: index {} bytes each, while built {}", held / images, most / images)?;
        let (tree, held, most) = measured(|| KdIndex::new(metric.clone(), poses.clone()));
        writeln!(out, "  kd-tree {} bytes each, while built {}", held / images, most / images)?;
        for candidates in CANDIDATES {
            let mut same = 0;
            for &pose in &queries {
                let truth_px = index.nearest(pose, 1)?[0].distance_px;
                same += usize::from(tree.nearest(pose, 1, candidates)[0].1 <= truth_px + 1e-9);
            }
            writeln!(out, "  the nearest among {candidates} candidates: {same} of {QUERIES}")?;
        }
    }
    Ok(())
}
