//! Memory that a piece of work takes, by an allocator that counts.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicUsize, Ordering::Relaxed},
};

/// System allocator that counts.
struct Counting;

static HELD_BYTES: AtomicUsize = AtomicUsize::new(0);
static MOST_BYTES: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on to the system allocator; the counters decide nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD_BYTES.fetch_add(layout.size(), Relaxed) + layout.size();
        MOST_BYTES.fetch_max(held, Relaxed);
        // SAFETY: the caller keeps the promises that the system allocator requires.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        HELD_BYTES.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the system allocator returned this pointer for this layout.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns the result of `make`, the bytes that it holds, and the peak while it was made.
pub fn measured<T>(make: impl FnOnce() -> T) -> (T, usize, usize) {
    let before = HELD_BYTES.load(Relaxed);
    MOST_BYTES.store(before, Relaxed);
    let made = make();
    (made, HELD_BYTES.load(Relaxed) - before, MOST_BYTES.load(Relaxed) - before)
}
