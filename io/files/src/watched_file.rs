//! A file that is being written, which must keep its name.

use crate::FileError;
use std::fs::{File, Metadata};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// A file that is open for writing. Each write checks whether it still has its name: a file that was removed or
/// replaced would take all later writes with it, without an error of the operating system.
pub(crate) struct WatchedFile {
    path: PathBuf,
    file: File,
    /// Device and inode number of the file.
    identity: (u64, u64),
    /// Smallest possible length.
    length: u64,
}

impl WatchedFile {
    /// A file that is open under this name, or will have it.
    pub(crate) fn new(path: &Path, file: File) -> std::io::Result<Self> {
        let found = file.metadata()?;
        Ok(Self { path: path.to_owned(), file, identity: identity(&found), length: found.len() })
    }

    /// The file.
    pub(crate) fn file(&self) -> &File {
        &self.file
    }

    /// `Err` if the name now refers to no file or to another one, or the file has become shorter.
    pub(crate) fn check(&self) -> Result<(), FileError> {
        let what = match std::fs::metadata(&self.path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => "was removed or renamed".to_owned(),
            Err(error) => return Err(FileError::write(&self.path, &error)),
            Ok(found) if identity(&found) != self.identity => "was replaced by another file".to_owned(),
            Ok(found) if found.len() < self.length => {
                format!("was cut from {} to {} bytes", self.length, found.len())
            }
            Ok(_) => return Ok(()),
        };
        Err(FileError::Lost { path: self.path.clone(), what })
    }

    /// Records the length after a write, which can only have made the file longer.
    pub(crate) fn note_growth(&mut self) -> Result<(), FileError> {
        self.check()?;
        self.note_length()
    }

    /// Records the length after a change of any kind.
    pub(crate) fn note_length(&mut self) -> Result<(), FileError> {
        let found = self.file.metadata().map_err(|e| FileError::write(&self.path, &e))?;
        self.length = found.len();
        Ok(())
    }
}

fn identity(found: &Metadata) -> (u64, u64) {
    (found.dev(), found.ino())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn what_becomes_of_the_name_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let (path, aside) = (folder.path().join("a.csv"), folder.path().join("b.csv"));
        let mut watched = WatchedFile::new(&path, File::create(&path).unwrap()).unwrap();
        watched.file().write_all(b"0123456789").unwrap();
        watched.note_length().unwrap();
        assert!(watched.check().is_ok());
        let said = |watched: &WatchedFile| watched.check().unwrap_err().to_string();
        std::fs::rename(&path, &aside).unwrap();
        assert!(said(&watched).contains("a.csv was removed or renamed while"), "{}", said(&watched));
        std::fs::write(&path, "another, and longer than before").unwrap();
        assert!(said(&watched).contains("a.csv was replaced by another file"));
        std::fs::rename(&aside, &path).unwrap();
        assert!(watched.check().is_ok());
        watched.file().set_len(4).unwrap();
        assert!(said(&watched).contains("a.csv was cut from 10 to 4 bytes"));
    }
}
