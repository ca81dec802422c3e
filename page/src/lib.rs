//! What `verify.html` runs: the checker of bundles as a WebAssembly module that a worker of the page, or Node, calls.
//!
//! One function, [`answer`], takes a request and gives an answer; both are a number of bytes of JSON (four bytes, the lowest first),
//! the JSON, and bytes that belong to it. What a request may ask is the enum [`session::Request`]. A module is called by one thread, and
//! a call that panics or runs out of memory ends it: the page tells that, and starts another.
//!
//! All that is unsafe lies here: bytes that are handed over the border of the module.

mod session;
mod study;

use session::Session;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::RefCell;

// What the page gives.
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Takes the states of the levels judged so far, as JSON.
    safe fn judged(at: usize, length: usize);
    /// Takes the message of a panic, which ends the module.
    safe fn panicked(at: usize, length: usize);
    /// Is told that memory ran out, which ends the module.
    safe fn exhausted();
    /// Returns seconds since some instant.
    safe fn seconds() -> f64;
}

/// Hands `text` to one of the functions that the page gives.
fn tell(take: extern "C" fn(usize, usize), text: &str) {
    take(text.as_ptr() as usize, text.len());
}

/// The system's allocator, which says when there is no more: what follows ends the module without a word.
struct Telling;

// SAFETY: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Telling {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps to the contract of `GlobalAlloc`.
        or_told(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps to the contract of `GlobalAlloc`.
        or_told(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller keeps to the contract of `GlobalAlloc`.
        or_told(unsafe { System.realloc(at, layout, size) })
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps to the contract of `GlobalAlloc`.
        unsafe { System.dealloc(at, layout) }
    }
}

fn or_told(at: *mut u8) -> *mut u8 {
    if at.is_null() {
        exhausted();
    }
    at
}

#[global_allocator]
static ALLOCATOR: Telling = Telling;

thread_local! {
    static SESSION: RefCell<Session> = RefCell::new(Session::begin(&|text| tell(judged, text), &|| seconds()));
}

/// Returns where a request of `length` bytes is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn allocate(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Answers the request of `length` bytes at `at`, which [`allocate`] returned; returns where the answer is (the upper 32 bits) and its
/// length (the lower ones). The answer is given back by [`release`].
///
/// # Safety
/// `at` is what [`allocate`] returned for `length`, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn answer(at: *mut u8, length: usize) -> u64 {
    std::panic::set_hook(Box::new(|panic| tell(panicked, &panic.to_string())));
    // SAFETY: as the caller promises, this is a boxed slice of that length, which nobody else has.
    let request = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, length)) };
    let answer = SESSION.with_borrow_mut(|session| session.answer(&request));
    let length = answer.len() as u64;
    let at = Box::into_raw(answer.into_boxed_slice()).cast::<u8>();
    (at as u64) << 32 | length
}

/// Gives the answer of `length` bytes at `at` back.
///
/// # Safety
/// Both are what [`answer`] returned, once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn release(at: *mut u8, length: usize) {
    // SAFETY: as the caller promises, this is the boxed slice that `answer` made.
    drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, length)) });
}
