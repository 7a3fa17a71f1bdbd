//! Files that are there whole or not at all.

use crate::FileError;
use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Puts a file in place of another at once: written to a temporary file in the same folder, synced, renamed, and the
/// folder synced. Whatever goes wrong, the former file is intact. What is no file, such as a pipe, is written to.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), FileError> {
    if path.exists() && !path.is_file() {
        return std::fs::write(path, content).map_err(|e| FileError::write(path, &e));
    }
    put(path, |file, _| file.write_all(content))
}

/// The same with a file that `write` fills, by the handle or by the path of the temporary file.
pub(crate) fn put<E: std::fmt::Display>(
    path: &Path,
    write: impl FnOnce(&mut File, &Path) -> Result<(), E>,
) -> Result<(), FileError> {
    let temporary = temporary(path);
    let attempt = || {
        let mut file = File::create(&temporary).map_err(|e| e.to_string())?;
        write(&mut file, &temporary).map_err(|e| e.to_string())?;
        place(&file, path).map_err(|e| e.to_string())
    };
    attempt().map_err(|reason: String| {
        remove_temporary(path);
        FileError::write(path, &reason)
    })
}

/// Gives a temporary file, of which this is a handle, its name once its content is on the disk.
pub(crate) fn place(file: &File, path: &Path) -> std::io::Result<()> {
    file.sync_all()?;
    std::fs::rename(temporary(path), path)?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder)?.sync_all()
}

/// The name of a file until it is whole.
pub(crate) fn temporary(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".tmp");
    name.into()
}

/// After a failure: what the temporary file holds is worthless, and its room may be needed. The failure is what to
/// report, not that this fails too.
pub(crate) fn remove_temporary(path: &Path) {
    let _ = std::fs::remove_file(temporary(path));
}
