//! Writers that are killed. The test program starts itself as the writer.

use std::{
    env,
    ffi::OsString,
    fs::{File, OpenOptions},
    io::Write,
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use super::*;
use crate::ingest::BATCH_FRAMES;

/// Environment variable that names the database for the writer.
const DATABASE: &str = "REALITY_SIM_DB_TEST_DATABASE";

const FRAMES: usize = 640;

/// Path of the file that grows by one byte with every batch that a writer has committed.
fn progress_file(database: &Path) -> PathBuf {
    database.with_extension("progress")
}

#[test]
fn the_writer_that_is_killed() {
    let Some(path) = env::var_os(DATABASE).map(PathBuf::from) else { return };
    let mut progress: File = OpenOptions::new().append(true).create(true).open(progress_file(&path)).unwrap();
    let sequence = long_walk(FRAMES);
    let mut database = Database::create_or_open(&path).unwrap();
    let mut is_committed = || progress.write_all(b".").unwrap();
    let note_batches = |done: usize| {
        // Once a batch has its first frame, the batches before it are committed.
        if done > 1 && done % BATCH_FRAMES == 1 {
            is_committed();
        }
        true
    };
    database.ingest_while(&sequence, &estimates(&sequence), &PoseSource::GroundTruth, note_batches).unwrap();
    is_committed();
}

fn start_writer(database: &Path) -> Child {
    Command::new(env::current_exe().unwrap())
        .args(["--exact", "tests::interrupted::the_writer_that_is_killed"])
        .env(DATABASE, database)
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// Number of batches that the writer reports as committed, or as already present.
fn batches(database: &Path) -> usize {
    fs::metadata(progress_file(database)).map_or(0, |metadata| metadata.len() as usize)
}

/// Kills a writer a while after it has committed this many batches. Returns false if it had finished before.
fn kill_after(writer: &mut Child, database: &Path, count: usize, delay: Duration) -> bool {
    while batches(database) < count {
        if writer.try_wait().unwrap().is_some() {
            return false;
        }
        thread::sleep(Duration::from_micros(200));
    }
    thread::sleep(delay);
    writer.kill().unwrap();
    !writer.wait().unwrap().success()
}

#[test]
fn killed_at_any_moment_it_holds_what_was_committed_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.db");
    let (mut held, mut kills) = (0, 0);
    for attempt in 0..12 {
        let _ = fs::remove_file(progress_file(&path));
        let mut writer = start_writer(&path);
        // The batches that are already there are compared first.
        let wanted = (held / BATCH_FRAMES + attempt % 2).min(FRAMES / BATCH_FRAMES);
        kills +=
            usize::from(kill_after(&mut writer, &path, wanted, Duration::from_micros(2700 * attempt as u64)));
        let Ok(database) = Database::open(&path) else {
            assert_eq!(batches(&path), 0, "committed batches are gone");
            continue;
        };
        let count = database.images().unwrap().len();
        assert!(count >= held.max(BATCH_FRAMES * batches(&path)), "{count} images, {held} before");
        let intact: String = database
            .connection
            .lock()
            .unwrap()
            .query_row("PRAGMA integrity_check", [], |row| row.get(0))
            .unwrap();
        assert_eq!(intact, "ok");
        held = count;
    }
    assert!(kills > 0);
    let sequence = long_walk(FRAMES);
    let report = add(&mut Database::create_or_open(&path).unwrap(), &sequence).unwrap();
    assert_eq!((report.added, report.already_there), (FRAMES - held, held));
    let database = Database::open(&path).unwrap();
    for (index, image) in database.images().unwrap().iter().enumerate() {
        assert_eq!(image.frame_index, index);
        assert_eq!(database.image_bytes(image.id).unwrap(), sequence.image_bytes(index).unwrap());
    }
}

/// Makes a database and a journal like those of a writer that dies while it overwrites pages.
fn torn(sequence: &Sequence) -> (TempDir, PathBuf) {
    let (_origin, path) = database_of(sequence);
    let writer = Database::create_or_open(&path).unwrap();
    let connection = writer.connection.lock().unwrap();
    // With so little memory, pages are written before the transaction ends.
    connection.pragma_update(None, "cache_size", 20).unwrap();
    let rewrite = "BEGIN IMMEDIATE; UPDATE images SET x_m = 77.0;
        UPDATE image_bytes SET bytes = zeroblob(length(bytes))";
    connection.execute_batch(rewrite).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let torn = folder.path().join("torn.db");
    fs::copy(&path, &torn).unwrap();
    fs::copy(journal(&path), journal(&torn)).unwrap();
    (folder, torn)
}

fn journal(database: &Path) -> PathBuf {
    let mut name = OsString::from(database);
    name.push("-journal");
    name.into()
}

#[test]
fn a_transaction_that_was_torn_is_undone_by_the_next_reader() {
    let sequence = short_walk(4);
    let (folder, path) = torn(&sequence);
    let raw = fs::read(&path).unwrap();
    let (_whole_folder, whole) = database_of(&sequence);
    assert_ne!(raw, fs::read(whole).unwrap(), "nothing was torn");
    let database = Database::open(&path).unwrap();
    for (index, image) in database.images().unwrap().iter().enumerate() {
        assert_eq!(Some(image.pose), sequence.frames[index].reference_pose);
        assert_eq!(database.image_bytes(image.id).unwrap(), sequence.image_bytes(index).unwrap());
    }
    assert_eq!(names_in(folder.path()), ["torn.db"]);
}

#[cfg(unix)]
mod read_only {
    use std::os::unix::{
        fs::{MetadataExt, PermissionsExt},
        process::CommandExt,
    };

    use super::*;

    /// Environment variable that names the folder of databases for a reader that may not write.
    const FOLDER: &str = "REALITY_SIM_DB_TEST_READ_ONLY";
    const NOBODY: u32 = 65534;

    #[test]
    fn the_reader_that_may_not_write() {
        let Some(folder) = env::var_os(FOLDER).map(PathBuf::from) else { return };
        let whole = folder.join("whole.db");
        assert!(fs::write(folder.join("x"), "").is_err(), "the folder can be written");
        assert_eq!(read_all(&whole).unwrap(), 60);
        let message = ["cannot be written", "permissions"];
        assert_message(&Database::create_or_open(&whole).unwrap_err(), &whole, &message);
        let new = folder.join("new.db");
        assert_message(&Database::create_or_open(&new).unwrap_err(), &new, &["cannot be opened"]);
        let torn = folder.join("torn.db");
        assert_message(&Database::open(&torn).unwrap_err(), &torn, &["left a journal", "copy"]);
    }

    fn set_mode(path: &Path, mode: u32) {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    }

    #[test]
    fn a_read_only_folder_is_read_and_not_written() {
        let (folder, torn) = torn(&short_walk(4));
        let (_origin, whole) = database_of(&walk());
        let program = folder.path().join("program");
        fs::copy(env::current_exe().unwrap(), &program).unwrap();
        fs::copy(whole, folder.path().join("whole.db")).unwrap();
        set_mode(&program, 0o555);
        for path in [&torn, &journal(&torn), &folder.path().join("whole.db")] {
            set_mode(path, 0o444);
        }
        set_mode(folder.path(), 0o555);
        let mut reader = Command::new(&program);
        reader
            .args(["--exact", "tests::interrupted::read_only::the_reader_that_may_not_write"])
            .env(FOLDER, folder.path());
        // Nothing is read-only for root.
        if fs::metadata(folder.path()).unwrap().uid() == 0 {
            reader.uid(NOBODY).gid(NOBODY);
        }
        let output = reader.output();
        set_mode(folder.path(), 0o755);
        // A container may have no user but root.
        let Ok(output) = output else { return };
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
