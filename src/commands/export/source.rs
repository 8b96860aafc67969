//! What is exported: a sequence with its poses, or a database.

use std::{collections::BTreeMap, error::Error, path::PathBuf};

use anyhow::bail;

use reality_sim::{
    Camera, CameraPose, FieldDimensions, Sequence,
    db::{Database, ImageRecord},
    sequence::{counted, match_poses, read_tum},
    tagging::covariance_rows,
};
use reality_sim_formats::{
    PictureFiles, PosedPicture, PosedPictures, frame_table::PictureFacts, posed::CameraIndex,
};

use super::options::ExportArgs;

/// Pictures with their poses, and where their files are.
pub struct Source {
    /// The pictures that have a pose.
    pub posed: PosedPictures,
    /// Number of pictures without one.
    pub without_pose: usize,
    /// Every file that is read.
    pub inputs: Vec<PathBuf>,
    /// What is known of each picture beside its pose.
    pub facts: Vec<PictureFacts>,
    origin: Origin,
}

/// Where the pictures' files are.
enum Origin {
    Sequence(Box<Sequence>),
    /// With the ids of the images, in the order of the pictures.
    Database(Box<Database>, Vec<i64>),
}

impl PictureFiles for Source {
    fn bytes(&self, index: usize) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
        match &self.origin {
            Origin::Sequence(sequence) => Ok(sequence.image_bytes(self.posed.pictures[index].number)?),
            Origin::Database(database, ids) => Ok(database.image_bytes(ids[index])?),
        }
    }
}

impl Source {
    /// Opens what the options name. Fails if nothing in it has a pose.
    pub fn open(args: &ExportArgs) -> anyhow::Result<Self> {
        if args.source.is_file() {
            if args.poses.is_some() || args.details.is_some() {
                let name = args.source.display();
                bail!("{name}: is a database, which has its own poses: leave out --poses and --details");
            }
            Self::of_database(Database::open(&args.source)?)
        } else {
            Self::of_sequence(Sequence::open(&args.source)?, args)
        }
    }

    /// Returns the file of a picture, by its place.
    pub fn picture_bytes(&self, index: usize) -> anyhow::Result<Vec<u8>> {
        self.bytes(index).map_err(anyhow::Error::from_boxed)
    }

    fn of_sequence(sequence: Sequence, args: &ExportArgs) -> anyhow::Result<Self> {
        let folder = sequence.folder.display();
        let mut inputs = sequence.files.clone();
        inputs.extend(sequence.frames.iter().map(|frame| sequence.folder.join(&frame.image)));
        inputs.extend(args.poses.iter().chain(&args.details).cloned());
        let poses: Vec<Option<CameraPose>> = match &args.poses {
            // The table has the poses of its own; here only which pictures there are matters.
            _ if args.details.is_some() => vec![Some(CameraPose::default()); sequence.frames.len()],
            Some(file) => match_poses(file, read_tum(file)?, &sequence.frames)?,
            None if sequence.has_reference_poses() => sequence.reference_poses().collect(),
            None => bail!(
                "{folder}: has no poses: find them with `reality-sim tag {folder} --out poses.tum`, and give them with --poses poses.tum"
            ),
        };
        let pictures =
            sequence.frames.iter().zip(&poses).enumerate().filter_map(|(number, (frame, pose))| {
                Some(PosedPicture {
                    number,
                    timestamp_s: frame.timestamp_s,
                    camera: CameraIndex(0),
                    pose: (*pose)?,
                    file_name: String::new(),
                })
            });
        let pictures: Vec<PosedPicture> = pictures.collect();
        if pictures.is_empty() {
            bail!("{folder}: no frame has a pose: give the poses of this recording with --poses");
        }
        sequence.check_pictures()?;
        let without_pose = poses.len() - pictures.len();
        let facts = pictures.iter().map(|picture| PictureFacts {
            sequence: sequence.name.clone(),
            image: sequence.frames[picture.number].image.clone(),
            ..PictureFacts::default()
        });
        let facts = facts.collect();
        let (cameras, field) = (vec![sequence.setup.camera.clone()], sequence.field.clone());
        let posed = PosedPictures { cameras, field, pictures };
        Ok(Self { posed, without_pose, inputs, facts, origin: Origin::Sequence(Box::new(sequence)) })
    }

    fn of_database(database: Database) -> anyhow::Result<Self> {
        let names = database.sequences()?;
        let (mut records, mut facts) = (Vec::new(), Vec::new());
        database.each_image(|record, details| {
            facts.push(PictureFacts {
                sequence: names.get(&record.sequence_id).cloned().unwrap_or_default(),
                image: PathBuf::from(details.file_name),
                covariance: details.covariance.as_ref().map(covariance_rows),
                quality: None,
            });
            records.push(record);
        })?;
        let field = only_field(&database, &records)?;
        let mut cameras: Vec<Camera> = Vec::new();
        let mut indices = BTreeMap::new();
        for (id, setup) in database.cameras()? {
            if records.iter().any(|record| record.camera_id == id) {
                let known = cameras.iter().position(|camera| *camera == setup.camera);
                indices.insert(id, CameraIndex(known.unwrap_or(cameras.len())));
                if known.is_none() {
                    cameras.push(setup.camera);
                }
            }
        }
        let picture = |(number, record): (usize, &ImageRecord)| PosedPicture {
            number,
            timestamp_s: record.timestamp_s,
            camera: indices[&record.camera_id],
            pose: record.pose,
            file_name: String::new(),
        };
        let pictures = records.iter().enumerate().map(picture).collect();
        let ids = records.iter().map(|record| record.id).collect();
        let inputs = vec![database.path().to_path_buf()];
        let posed = PosedPictures { cameras, field, pictures };
        Ok(Self { posed, without_pose: 0, inputs, facts, origin: Origin::Database(Box::new(database), ids) })
    }
}

/// Returns the one field that all images show.
fn only_field(database: &Database, records: &[ImageRecord]) -> anyhow::Result<FieldDimensions> {
    let name = database.path().display();
    let fields = database.fields()?;
    let shown = fields.iter().filter(|(id, _)| records.iter().any(|record| record.field_id == **id));
    let shown: Vec<&FieldDimensions> = shown.map(|(_, field)| field).collect();
    match shown.as_slice() {
        [field] => Ok((*field).clone()),
        [] => bail!("{name}: has no pictures: add some with `build`"),
        fields => bail!(
            "{name}: shows {}, each with an origin of its own: export a database of one field",
            counted(fields.len(), "field")
        ),
    }
}
