//! Report of `render` on its pictures.

use serde::Serialize;

use reality_sim::{Archive, Reconstruction, synthesis::UsedImage};

use crate::commands::output::aligned;

/// Report that `--json` prints.
#[derive(Serialize)]
pub struct Report {
    pub method: &'static str,
    pub pictures: usize,
    /// Time of one picture with its neighbours decoded; along a path the median, decoding included. Writing is excluded.
    pub milliseconds: f64,
    /// Share of the pixels that some recorded picture shows, averaged over the pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covered: Option<f64>,
    /// Pictures that a single picture was made from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub used: Vec<UsedReport>,
    pub out: String,
}

/// Recorded picture that another was made from.
#[derive(Serialize)]
pub struct UsedReport {
    sequence: String,
    frame: usize,
    distance_px: f64,
    share: f64,
}

/// Lists the pictures that a reconstruction was made from.
pub fn used(archive: &Archive, reconstruction: &Reconstruction) -> anyhow::Result<Vec<UsedReport>> {
    let names = archive.database().sequences()?;
    let report = |used: &UsedImage| {
        let record = &archive.images()[used.image as usize];
        UsedReport {
            sequence: names.get(&record.sequence_id).cloned().unwrap_or_default(),
            frame: record.frame_index,
            distance_px: used.distance_px,
            share: used.share,
        }
    };
    Ok(reconstruction.used.iter().map(report).collect())
}

impl Report {
    /// Formats the report for people.
    pub fn text(&self) -> String {
        let mut lines = vec![("method", self.method.to_owned())];
        if self.pictures > 1 {
            lines.push(("pictures", self.pictures.to_string()));
        }
        for used in &self.used {
            let UsedReport { sequence, frame, distance_px, share } = used;
            let percent = 100.0 * share;
            lines.push((
                "from",
                format!("{sequence} frame {frame}, {distance_px:.0} px away, {percent:.0} % of the pixels"),
            ));
        }
        if let Some(covered) = self.covered {
            lines.push(("recorded", format!("{:.0} % of the pixels; the rest is filled", 100.0 * covered)));
        }
        lines.push(("time", format!("{:.1} ms a picture", self.milliseconds)));
        lines.push(("picture", self.out.clone()));
        aligned(&lines)
    }
}
