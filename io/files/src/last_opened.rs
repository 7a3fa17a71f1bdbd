//! The HDF5 file that was opened last, for a message should the HDF5 library crash on it.

use std::collections::HashSet;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{Mutex, PoisonError};

type Name = Box<[u8]>;

static LAST: AtomicPtr<Name> = AtomicPtr::new(std::ptr::null_mut());

/// Names, each stored once for as long as the program runs: a signal handler may read them at any time.
static NAMES: Mutex<Option<HashSet<&'static Name>>> = Mutex::new(None);

/// Bytes of the path of the HDF5 file that was last opened for reading, if there was one. For signal handlers: it only
/// loads an address.
pub fn last_opened() -> Option<&'static [u8]> {
    // SAFETY: the pointer is null, or that of a name that is never freed nor changed.
    unsafe { LAST.load(Ordering::Acquire).as_ref() }.map(|name| &**name)
}

/// Stores the path of a file that is about to be read.
pub(crate) fn note(path: &Path) {
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    let names = names.get_or_insert_default();
    let name: Name = path.as_os_str().as_bytes().into();
    let known = names.get(&name).copied();
    let stored = known.unwrap_or_else(|| Box::leak(Box::new(name)));
    names.insert(stored);
    LAST.store(std::ptr::from_ref(stored).cast_mut(), Ordering::Release);
}
