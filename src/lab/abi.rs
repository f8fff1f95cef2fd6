//! The functions that the module exports: memory, and a call for each name.
//!
//! An argument is memory of [`allocate`]; a reply is a little-endian u32 and that many bytes. The page releases both.
#![allow(unsafe_code)]

use super::Lab;
use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};
use std::cell::RefCell;
use std::sync::{Mutex, Once, PoisonError};

/// Bytes in front of a reply.
const HEAD: usize = 4;

/// What the last panic has said.
static PANIC: Mutex<String> = Mutex::new(String::new());
static HOOK: Once = Once::new();

thread_local! {
    static LAB: RefCell<Option<Lab>> = const { RefCell::new(None) };
}

fn layout(length: usize) -> Layout {
    Layout::array::<u8>(length.max(1)).expect("the memory of the module is smaller")
}

/// Memory of a length.
#[unsafe(no_mangle)]
extern "C" fn allocate(length: usize) -> *mut u8 {
    // SAFETY: the layout is of one byte at least.
    let pointer = unsafe { alloc(layout(length)) };
    if pointer.is_null() { handle_alloc_error(layout(length)) } else { pointer }
}

/// Gives memory of [`allocate`] of that length, or a reply with its head, back.
#[unsafe(no_mangle)]
extern "C" fn release(pointer: *mut u8, length: usize) {
    // SAFETY: the page gives what it got, once, with its length; replies are of the same layout.
    unsafe { dealloc(pointer, layout(length)) }
}

/// A reply in memory of its own.
fn sent(reply: &[u8]) -> *mut u8 {
    let pointer = allocate(HEAD + reply.len());
    let head = (reply.len() as u32).to_le_bytes();
    // SAFETY: the memory was allocated for head and reply, and nothing else refers to it.
    unsafe {
        pointer.copy_from_nonoverlapping(head.as_ptr(), HEAD);
        pointer.add(HEAD).copy_from_nonoverlapping(reply.as_ptr(), reply.len());
    }
    pointer
}

fn called(name: &str, pointer: *const u8, length: usize) -> *mut u8 {
    HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = panic.to_string();
        }));
    });
    // SAFETY: the page has written that many bytes there, and releases them after the call.
    let argument = unsafe { std::slice::from_raw_parts(pointer, length) };
    LAB.with_borrow_mut(|lab| {
        let lab = lab.get_or_insert_with(|| Lab::new(1).expect("the caller's thread is there"));
        sent(&lab.call(name, argument))
    })
}

/// What the panic has said by which the module ended.
#[unsafe(no_mangle)]
extern "C" fn failure(_pointer: *const u8, _length: usize) -> *mut u8 {
    sent(PANIC.lock().unwrap_or_else(PoisonError::into_inner).as_bytes())
}

/// A function for each call.
macro_rules! calls {
    ($($name:ident),+) => {$(
        #[doc = concat!("The call `", stringify!($name), "`.")]
        #[unsafe(no_mangle)]
        extern "C" fn $name(pointer: *const u8, length: usize) -> *mut u8 {
            called(stringify!($name), pointer, length)
        }
    )+};
}

calls!(version, materials, template, edit, describe, map, prepare, integral, compute, merge, results);
