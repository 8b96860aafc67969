//! Cache of the most recently used decoded pictures, with bounded memory.

use std::{
    collections::{BTreeMap, HashMap},
    sync::{Arc, Mutex, PoisonError},
};

use reality_sim_core::warp::Picture;
use reality_sim_db::index::ImageIndex;

/// Decoded picture of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct PictureKey {
    /// The image.
    pub image: ImageIndex,
    /// Whether the things that it shows are hidden.
    pub is_masked: bool,
}

/// Cache of decoded pictures. Threads share one.
#[derive(Debug)]
pub(crate) struct PictureCache {
    limit_bytes: usize,
    held: Mutex<Held>,
}

#[derive(Debug, Default)]
struct Held {
    bytes: usize,
    /// Number of uses so far.
    clock: u64,
    pictures: HashMap<PictureKey, (Arc<Picture>, u64)>,
    /// Pictures by the time of their last use.
    order: BTreeMap<u64, PictureKey>,
}

impl PictureCache {
    pub(crate) fn new(limit_bytes: usize) -> Self {
        Self { limit_bytes, held: Mutex::default() }
    }

    /// Largest size of the pictures held, bytes.
    pub(crate) fn limit_bytes(&self) -> usize {
        self.limit_bytes
    }

    /// Returns a picture, decoded by `decode` if it is not held. Two threads may decode the same picture at once; one of
    /// the two results is kept.
    pub(crate) fn get<E>(
        &self,
        key: PictureKey,
        decode: impl FnOnce() -> Result<Picture, E>,
    ) -> Result<Arc<Picture>, E> {
        if let Some(picture) = self.lock().used(key) {
            return Ok(picture);
        }
        let picture = Arc::new(decode()?);
        self.lock().insert(key, picture.clone(), self.limit_bytes);
        Ok(picture)
    }

    /// Size of the pictures held, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.lock().bytes
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Held> {
        // Nothing panics while the lock is held, and one picture more or less does no harm.
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Held {
    fn used(&mut self, key: PictureKey) -> Option<Arc<Picture>> {
        self.clock += 1;
        let (picture, last) = self.pictures.get_mut(&key)?;
        self.order.remove(last);
        self.order.insert(self.clock, key);
        *last = self.clock;
        Some(picture.clone())
    }

    fn insert(&mut self, key: PictureKey, picture: Arc<Picture>, limit_bytes: usize) {
        self.clock += 1;
        self.bytes += picture.bytes();
        self.order.insert(self.clock, key);
        if let Some((other, last)) = self.pictures.insert(key, (picture, self.clock)) {
            self.bytes -= other.bytes();
            self.order.remove(&last);
        }
        while self.bytes > limit_bytes
            && let Some((_, oldest)) = self.order.pop_first()
        {
            self.bytes -= self.pictures.remove(&oldest).map_or(0, |(picture, _)| picture.bytes());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        Picture { width: 4, height: 4, pixels: vec![0; 16] }
    }

    fn get(cache: &PictureCache, image: ImageIndex, decoded: &mut usize) {
        cache
            .get(PictureKey { image, is_masked: false }, || {
                *decoded += 1;
                Ok::<_, ()>(picture())
            })
            .unwrap();
    }

    #[test]
    fn what_was_used_longest_ago_goes_first() {
        let cache = PictureCache::new(2 * picture().bytes());
        let mut decoded = 0;
        for image in [1, 2, 1, 3, 1] {
            get(&cache, image, &mut decoded);
        }
        assert_eq!(decoded, 3, "1 was used again and again and stays");
        get(&cache, 2, &mut decoded);
        assert_eq!(decoded, 4, "2 had to go for 3");
        assert_eq!(cache.bytes(), 2 * picture().bytes());
    }

    #[test]
    fn a_bound_below_one_picture_holds_none() {
        let cache = PictureCache::new(1);
        let mut decoded = 0;
        get(&cache, 1, &mut decoded);
        get(&cache, 1, &mut decoded);
        assert_eq!((decoded, cache.bytes()), (2, 0));
    }

    #[test]
    fn threads_share_a_cache_within_its_bound() {
        let cache = PictureCache::new(5 * picture().bytes());
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let cache = &cache;
                scope.spawn(move || (0..500).for_each(|i| get(cache, (i * (thread + 3)) % 17, &mut 0)));
            }
        });
        assert_eq!(cache.bytes(), 5 * picture().bytes());
    }
}
