//! `reality-sim split`: takes the pictures of a database apart, one database a field.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use clap::Args;
use serde::Serialize;

use reality_sim::{db::Database, sequence::counted};

use super::{
    output::{StageProgress, aligned, print, print_json},
    output_folder::OutputFolder,
};

/// Number of letters of a field's name that go into a file's.
const LONGEST_NAME: usize = 60;

/// Options of `split`.
#[derive(Debug, Args)]
pub struct SplitArgs {
    /// Database, as `build` makes it
    database: PathBuf,
    /// Folder of the new databases, one a field, each named after its field
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    database: String,
    parts: Vec<PartReport>,
}

#[derive(Serialize)]
struct PartReport {
    database: String,
    field: String,
    added: usize,
    /// Number of pictures that an earlier call had added.
    already_there: usize,
}

/// Runs the command.
pub fn run(args: &SplitArgs) -> anyhow::Result<()> {
    let database = Database::open(&args.database)?;
    let folder = OutputFolder::check(&args.out, std::slice::from_ref(&args.database))?;
    let (fields, counts) = (database.fields()?, database.images_by_field()?);
    let mut report = Report { database: args.database.display().to_string(), parts: Vec::new() };
    let (mut names, mut progress) = (BTreeSet::new(), StageProgress::default());
    for (field_id, field) in fields.iter().filter(|(id, _)| counts.contains_key(id)) {
        let path = folder.file(file_name(&field.name, &mut names))?;
        progress.begin(counts[field_id])?;
        let added = add_field(&path, &database, *field_id, &progress)?;
        let (database, field) = (path.display().to_string(), field.name.clone());
        report.parts.push(PartReport { database, field, added: added.0, already_there: added.1 });
    }
    progress.finish();
    if args.json { print_json(&report) } else { print(&report.text()) }
}

/// Adds a field's pictures to the database at this path; returns how many, and how many were there.
fn add_field(
    path: &Path,
    database: &Database,
    field_id: i64,
    progress: &StageProgress,
) -> anyhow::Result<(usize, usize)> {
    let mut part = Database::create_or_open(path)?;
    let report = part.copy_from(database, Some(field_id), |done| {
        progress.set(done);
        true
    });
    let report = report.inspect_err(|_| progress.finish())?;
    Ok((report.added + report.replaced, report.already_there))
}

/// Makes a file's name of a field's, with a number if others have the same.
fn file_name(field: &str, taken: &mut BTreeSet<String>) -> String {
    let short: String = field.chars().take(LONGEST_NAME).collect::<String>().to_lowercase();
    let words: Vec<&str> =
        short.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let name = if words.is_empty() { "field".to_owned() } else { words.join("-") };
    let mut file = format!("{name}.db");
    let mut number = 2;
    while !taken.insert(file.clone()) {
        file = format!("{name}-{number}.db");
        number += 1;
    }
    file
}

impl Report {
    fn text(&self) -> String {
        let part = |PartReport { database, field, added, already_there }: &PartReport| {
            let added = counted(*added, "picture");
            ("database", format!("{database}: {added} of {field} added, {already_there} already there"))
        };
        let mut lines = vec![("split", self.database.clone())];
        lines.extend(self.parts.iter().map(part));
        aligned(&lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_files_and_differ() {
        let mut taken = BTreeSet::new();
        let names =
            ["Hall B, 9 × 6 m", "../../etc", "", "hall b, 9 × 6 m"].map(|field| file_name(field, &mut taken));
        assert_eq!(names, ["hall-b-9-6-m.db", "etc.db", "field.db", "hall-b-9-6-m-2.db"]);
    }
}
