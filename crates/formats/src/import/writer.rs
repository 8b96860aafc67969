//! Picture files, written by several threads while the log is read. At most two pictures a thread wait.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread::{self, JoinHandle},
};

use image::{
    DynamicImage, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};
use tempfile::TempDir;

use crate::message::RawPicture;

/// Name of the folder of pictures.
pub const IMAGES: &str = "images";

/// Picture that is to be written.
pub enum Job {
    /// File as it is.
    File(Vec<u8>),
    /// Pixels, which become PNG.
    Raw(RawPicture<'static>),
}

impl Job {
    /// Returns the ending of the file's name.
    fn ending(&self) -> &'static str {
        match self {
            Self::File(bytes) if bytes.starts_with(&[0xff, 0xd8]) => "jpg",
            _ => "png",
        }
    }
}

/// Writer of pictures into a temporary folder, which is gone if the import fails.
pub struct PictureWriter {
    folder: TempDir,
    jobs: Option<SyncSender<(PathBuf, Job)>>,
    threads: Vec<JoinHandle<()>>,
    error: Arc<Mutex<Option<io::Error>>>,
}

impl PictureWriter {
    /// Starts the threads. Fails if the folder cannot be written into.
    pub fn start(out: &Path) -> io::Result<Self> {
        fs::create_dir_all(out)?;
        let folder = tempfile::Builder::new().prefix(".unfinished-").tempdir_in(out)?;
        let count = thread::available_parallelism().map_or(2, usize::from).min(16);
        let (sender, receiver) = sync_channel(2 * count);
        let (receiver, error) = (Arc::new(Mutex::new(receiver)), Arc::new(Mutex::new(None)));
        let start = |_| {
            let (receiver, error) = (receiver.clone(), error.clone());
            thread::spawn(move || work(&receiver, &error))
        };
        let threads = (0..count).map(start).collect();
        Ok(Self { folder, jobs: Some(sender), threads, error })
    }

    /// Hands over a picture, and waits while too many are waiting. Returns the name of its file within the sequence, or nothing
    /// if writing has failed.
    pub fn write(&self, number: usize, job: Job) -> Option<PathBuf> {
        let name = file_name(number, job.ending());
        let path = self.folder.path().join(&name);
        self.jobs.as_ref()?.send((path, job)).ok()?;
        (!self.has_failed()).then(|| Path::new(IMAGES).join(name))
    }

    fn has_failed(&self) -> bool {
        self.error.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Waits until all pictures are written. Fails if one could not be.
    pub fn finish(mut self) -> io::Result<WrittenPictures> {
        drop(self.jobs.take());
        for thread in self.threads.drain(..) {
            thread.join().map_err(|_| io::Error::other("a thread that writes pictures has failed"))?;
        }
        match self.error.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(error) => Err(error),
            None => Ok(WrittenPictures { folder: self.folder }),
        }
    }
}

/// Pictures that are written, but not yet in their place.
pub struct WrittenPictures {
    folder: TempDir,
}

impl WrittenPictures {
    /// Puts pictures into their place in the sequence's folder; the others are removed.
    pub fn keep<'a>(self, out: &Path, names: impl Iterator<Item = &'a Path>) -> io::Result<()> {
        fs::create_dir_all(out.join(IMAGES))?;
        for name in names {
            let file = name.file_name().unwrap_or_default();
            fs::rename(self.folder.path().join(file), out.join(name))?;
        }
        self.folder.close()
    }
}

fn file_name(number: usize, ending: &str) -> String {
    format!("{number:06}.{ending}")
}

fn work(jobs: &Mutex<Receiver<(PathBuf, Job)>>, failed: &Mutex<Option<io::Error>>) {
    loop {
        let next = jobs.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok((path, job)) = next else { return };
        if let Err(error) = write(&path, job) {
            // The first is reported; those behind it have the same cause.
            failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
    }
}

fn write(path: &Path, job: Job) -> io::Result<()> {
    match job {
        Job::File(bytes) => fs::write(path, bytes),
        Job::Raw(raw) => {
            let picture = raw.picture().map_err(io::Error::other)?;
            drop(raw);
            fs::write(path, png(&picture).map_err(io::Error::other)?)
        }
    }
}

/// Encodes a picture with the fastest compression: disks are faster than better ones.
fn png(picture: &DynamicImage) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Vec::with_capacity(picture.as_bytes().len() / 2);
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up);
    encoder.write_image(picture.as_bytes(), picture.width(), picture.height(), picture.color().into())?;
    Ok(bytes)
}
