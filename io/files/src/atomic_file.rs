//! Atomic replacement of files: a file is either complete or unchanged.

use crate::FileError;
use std::ffi::OsString;
use std::fs::{File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Replaces a file atomically: the content is written to a temporary file in the same folder, which is synced and
/// renamed, and the folder is synced. If anything fails, the former file is intact. A path that is not a regular
/// file, such as a pipe, is written to directly.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), FileError> {
    if path.exists() && !path.is_file() {
        return std::fs::write(path, content).map_err(|e| FileError::write(path, &e));
    }
    write_with(path, |file, _| file.write_all(content))
}

/// Like [`replace`], with content that `write` writes to the handle or the path of the temporary file.
pub(crate) fn write_with<E: std::fmt::Display>(
    path: &Path,
    write: impl FnOnce(&mut File, &Path) -> Result<(), E>,
) -> Result<(), FileError> {
    let mut file = create_temporary(path).map_err(|e| FileError::write(path, &e))?;
    let attempt = || {
        write(&mut file, &temporary(path)).map_err(|e| e.to_string())?;
        place(&file, path).map_err(|e| e.to_string())
    };
    attempt().map_err(|reason: String| {
        remove_temporary(path);
        FileError::write(path, &reason)
    })
}

/// Creates the temporary file of a path. Fails if anything of that name exists, including a symbolic link.
pub(crate) fn create_temporary(path: &Path) -> std::io::Result<File> {
    let (name, mut options) = (temporary(path), OpenOptions::new());
    options.read(true).write(true).create_new(true);
    options.open(&name).or_else(|error| {
        // Only this process uses the name, so the file is one that it could not remove after a failure.
        let is_left = std::fs::symlink_metadata(&name).is_ok_and(|found| found.is_file());
        if is_left && std::fs::remove_file(&name).is_ok() { options.open(&name) } else { Err(error) }
    })
}

/// Syncs the temporary file with this handle and renames it to its final name.
pub(crate) fn place(file: &File, path: &Path) -> std::io::Result<()> {
    sync(file)?;
    std::fs::rename(temporary(path), path)?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    ignore_unsupported(File::open(folder).and_then(|folder| folder.sync_all()))
}

/// Waits until a file is on the disk, where the file system supports that.
pub(crate) fn sync(file: &File) -> std::io::Result<()> {
    ignore_unsupported(file.sync_all())
}

/// Ignores errors of file systems that do not support syncing, which the program can do without. Disk
/// failures have other error codes.
fn ignore_unsupported(synced: std::io::Result<()>) -> std::io::Result<()> {
    synced.or_else(|error| match error.raw_os_error() {
        Some(number) if CANNOT.contains(&number) => Ok(()),
        _ => Err(error),
    })
}

/// Error codes of file systems that cannot sync a file or a folder, or open a folder for that.
const CANNOT: [i32; 8] =
    [libc::EINVAL, libc::EBADF, libc::ENOTSUP, libc::ENOSYS, libc::ENOTTY, libc::EISDIR, libc::EPERM, libc::EACCES];

/// Name of the temporary file, which includes the mark of this process.
pub(crate) fn temporary(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(format!(".{}{END}", mark()));
    name.into()
}

const END: &str = ".tmp";

/// Mark of this process: 16 digits, unique to it.
pub(crate) fn mark() -> &'static str {
    static MARK: OnceLock<String> = OnceLock::new();
    MARK.get_or_init(|| {
        let now = std::time::SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
        format!("{:016x}", RandomState::new().hash_one((std::process::id(), now)))
    })
}

/// Mark in the name of a temporary file.
pub(crate) fn writer_of(path: &Path) -> Option<&str> {
    let (_, mark) = path.file_name()?.to_str()?.strip_suffix(END)?.rsplit_once('.')?;
    Some(mark)
}

/// Removes the temporary file after a failure. That failure is reported; an error of the removal is not.
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

    #[test]
    fn symbolic_links_of_temporary_names_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (path, victim) = (folder.path().join("a"), folder.path().join("victim"));
        std::fs::write(&victim, b"mine").unwrap();
        let plain = folder.path().join("a.tmp");
        for name in [&temporary(&path), &plain] {
            std::os::unix::fs::symlink(&victim, name).unwrap();
        }
        let error = replace(&path, b"new").unwrap_err().to_string();
        assert!(error.contains("a: ") && error.contains("exists"), "{error}");
        assert_eq!(std::fs::read(&victim).unwrap(), b"mine");
        std::fs::remove_file(temporary(&path)).unwrap();
        std::fs::write(temporary(&path), b"left of a failure").unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(std::fs::symlink_metadata(&plain).unwrap().is_symlink());
    }

    #[test]
    fn what_a_file_system_cannot_do_is_borne_and_errors_of_a_disk_are_not() {
        let after = |number| ignore_unsupported(Err(std::io::Error::from_raw_os_error(number)));
        assert!([libc::EINVAL, libc::EBADF, libc::EOPNOTSUPP, libc::ENOSYS].into_iter().all(|n| after(n).is_ok()));
        assert!([libc::EIO, libc::ENOSPC, libc::EDQUOT, libc::ENOENT].into_iter().all(|n| after(n).is_err()));
    }

    #[test]
    fn temporary_files_are_known_by_the_mark_of_their_writer() {
        assert_eq!(writer_of(&temporary(Path::new("a/fields.xdmf"))), Some(mark()));
        assert_eq!(writer_of(Path::new("a/notes.txt.tmp")), Some("txt"));
        assert_eq!(writer_of(Path::new("a/notes.tmp")), None);
    }
}
