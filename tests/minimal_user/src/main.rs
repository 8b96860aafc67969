//! Makes a picture at a pose: `minimal-user RECORDING DATABASE` makes the database of the recording's first frames.

use std::{env, error::Error, path::PathBuf, sync::Arc};

use reality_sim::{
    Archive, Camera, FieldDimensions, Pose2, Sequence, Synthesizer,
    camera::Distortion,
    db::{Database, PoseEstimate, PoseSource},
    glam::DVec2,
    synthesis::{Auto, SynthesisConfig},
    warp::CpuWarper,
};

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [recording, database] = paths.as_slice() else { return Err("two paths are needed".into()) };

    let mut walk = Sequence::open(recording)?;
    walk.frames.truncate(6);
    let field: &FieldDimensions = &walk.field;
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    Database::create_or_open(database)?.ingest(&walk, &poses, &PoseSource::GroundTruth)?;

    // The camera is a simulator's own, without distortion.
    let camera = Camera::new([160, 120], [80.0, 80.0, 79.5, 59.5], Distortion::Pinhole)?;
    let archive = Arc::new(Archive::open(database, 64 << 20)?);
    let config = SynthesisConfig::new(&archive);
    let near = archive.images()[3].pose;
    let pose = near.with_planar(Pose2::new(near.x_m + 0.02, near.y_m, near.yaw_rad + 0.03));
    let simulator = Synthesizer::with(archive.clone(), camera, Arc::new(CpuWarper), config);
    let seen = simulator.image_at(pose, &Auto)?;

    let center: DVec2 = pose.planar().position_in_world();
    let (width, height) = seen.picture.dimensions();
    println!("{width} x {height} pixels from {center} on a field of {} m", field.length_m);
    println!("{:.2} recorded", seen.covered());
    Ok(())
}
