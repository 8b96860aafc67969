//! Words for what went wrong.

use std::{
    cell::RefCell,
    ffi::{CString, c_char},
};

thread_local! {
    static LAST: RefCell<CString> = RefCell::new(CString::default());
}

/// Keeps the message of the last failure of this thread.
pub fn remember(message: String) {
    // Texts of C end at the first zero.
    let bytes: Vec<u8> = message.into_bytes().into_iter().filter(|byte| *byte != 0).collect();
    LAST.set(CString::new(bytes).unwrap_or_default());
}

/// Returns what the last function of this thread that failed could not do, and the remedy, in UTF-8; an empty text if none failed. It is valid
/// until the next one fails.
#[unsafe(no_mangle)]
pub extern "C" fn rs_message() -> *const c_char {
    LAST.with_borrow(|message| message.as_ptr())
}

/// Returns the version of the library.
#[unsafe(no_mangle)]
pub extern "C" fn rs_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
