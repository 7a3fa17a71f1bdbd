//! Atomic replacement of files: they are complete, or as they were before.

use crate::FileError;
use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Replaces a file atomically: the content is written to a temporary file in the same folder, which is synced and
/// renamed, and the folder is synced. If anything fails, the former file is intact. What is not a regular file, such as
/// a pipe, is written to directly.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), FileError> {
    if path.exists() && !path.is_file() {
        return std::fs::write(path, content).map_err(|e| FileError::write(path, &e));
    }
    put(path, |file, _| file.write_all(content))
}

/// The same with content that `write` writes, to the handle or the path of the temporary file.
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

/// The name of the temporary file.
pub(crate) fn temporary(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".tmp");
    name.into()
}

/// Removes the temporary file after a failure. That failure is reported; an error of this removal is not.
pub(crate) fn remove_temporary(path: &Path) {
    let _ = std::fs::remove_file(temporary(path));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_what_is_no_file_is_written_to() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a"), folder.path().join("b"));
        replace(&path, b"former").unwrap();
        std::fs::hard_link(&path, &link).unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read(&link).unwrap(), b"former", "the former file is as it was");
        assert!(!temporary(&path).exists());
        replace(Path::new("/dev/null"), b"nothing").unwrap();
        let error = replace(folder.path(), b"new").unwrap_err().to_string();
        assert!(error.contains(&folder.path().display().to_string()), "{error}");
    }
}
