//! The table's rows.

use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::{FrameRecord, one_line},
};

use super::{
    mapping::{Entry, Mapping},
    target::Target,
};
use crate::{
    file::{MAX_TABLE_BYTES, is_inside_folder, read_text},
    model_error::{ModelError, ModelFault, excerpt},
};

/// Returns the table's frames. The images are the table's names.
pub(super) fn frames(
    path: &Path,
    mapping: &Mapping,
    mount_height_m: f64,
) -> Result<Vec<FrameRecord>, ModelError> {
    let text = read_text(path, MAX_TABLE_BYTES)?;
    let mut reader =
        ReaderBuilder::new().delimiter(mapping.delimiter as u8).trim(Trim::All).from_reader(text.as_bytes());
    let syntax = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line) as usize;
        ModelError::at(path, line, ModelFault::Syntax { message: one_line(&error) })
    };
    let header = reader.headers().map_err(syntax)?.clone();
    let mut frames = Vec::new();
    for record in reader.records() {
        let record = record.map_err(syntax)?;
        let line = record.position().map_or(1, csv::Position::line) as usize;
        let row = Row { header: &header, record: &record, mapping };
        frames.push(row.frame(mount_height_m).map_err(|fault| ModelError::at(path, line, fault))?);
    }
    if frames.is_empty() {
        return Err(ModelError::of_file(path, ModelFault::NothingThere { what: "rows" }));
    }
    Ok(frames)
}

/// Row of the table.
struct Row<'a> {
    header: &'a StringRecord,
    record: &'a StringRecord,
    mapping: &'a Mapping,
}

impl Row<'_> {
    fn frame(&self, mount_height_m: f64) -> Result<FrameRecord, ModelFault> {
        let (pitch_rad, roll_rad) = (self.number(Target::Pitch)?, self.number(Target::Roll)?);
        let odometry = self.planar([Target::OdometryX, Target::OdometryY, Target::OdometryYaw])?;
        let reference = self.planar([Target::ReferenceX, Target::ReferenceY, Target::ReferenceYaw])?;
        let or = |target, default| if self.has(target) { self.number(target) } else { Ok(default) };
        let reference_pose = match reference {
            Some(planar) => Some(CameraPose::new(
                planar,
                or(Target::ReferenceHeight, mount_height_m)?,
                or(Target::ReferencePitch, pitch_rad)?,
                or(Target::ReferenceRoll, roll_rad)?,
            )),
            None => None,
        };
        Ok(FrameRecord {
            timestamp_s: self.number(Target::Timestamp)?,
            image: self.image()?,
            odometry,
            pitch_rad,
            roll_rad,
            reference_pose,
        })
    }

    fn has(&self, target: Target) -> bool {
        self.mapping.columns.contains_key(&target)
    }

    fn planar(&self, targets: [Target; 3]) -> Result<Option<Pose2>, ModelFault> {
        if !self.has(targets[0]) {
            return Ok(None);
        }
        let [x, y, yaw] = targets;
        Ok(Some(Pose2::new(self.number(x)?, self.number(y)?, self.number(yaw)?)))
    }

    fn field(&self, column: &str) -> Result<&str, ModelFault> {
        let place = self.header.iter().position(|name| name == column);
        let field = place.and_then(|place| self.record.get(place));
        field.ok_or_else(|| ModelFault::MissingValue { key: column.to_owned() })
    }

    fn number(&self, target: Target) -> Result<f64, ModelFault> {
        let Some(entry) = self.mapping.columns.get(&target) else {
            return Err(ModelFault::MissingValue { key: target.name().to_owned() });
        };
        let (column, unit, sign, offset) = match entry {
            Entry::Constant(constant) => return Ok(constant.value),
            Entry::Name(column) => (column, None, 1.0, 0.0),
            Entry::Converted(converted) => {
                (&converted.column, converted.unit, converted.sign, converted.offset)
            }
        };
        let field = self.field(column)?;
        let value = field.parse::<f64>().ok().filter(|value| value.is_finite());
        let value = value.ok_or_else(|| ModelFault::BadValue {
            key: column.clone(),
            value: excerpt(field),
            rule: "a finite number",
        })?;
        let value = sign * value + offset;
        Ok(unit.map_or(value, |unit| unit.to_si(value)))
    }

    fn image(&self) -> Result<PathBuf, ModelFault> {
        let column = match self.mapping.columns.get(&Target::Image) {
            Some(Entry::Name(column)) => column,
            Some(Entry::Converted(converted)) => &converted.column,
            _ => return Err(ModelFault::MissingValue { key: Target::Image.name().to_owned() }),
        };
        let name = self.field(column)?;
        let image = PathBuf::from(name);
        if is_inside_folder(&image) {
            Ok(image)
        } else {
            Err(ModelFault::PathLeavesFolder { name: excerpt(name) })
        }
    }
}
