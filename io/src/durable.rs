//! Files that are there whole or not at all.

use crate::FileError;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Puts a file in place of another at once: written to a temporary file in the same folder, synced, renamed, and the
/// folder synced. Whatever goes wrong, the former file is intact.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let temporary = path.with_extension("tmp");
    let write = || {
        let mut file = File::create(&temporary)?;
        file.write_all(content)?;
        file.sync_all()?;
        std::fs::rename(&temporary, path)?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        File::open(folder)?.sync_all()
    };
    write().map_err(|e| {
        // Its content is worthless, and its room may be needed; the first error is the one to report.
        let _ = std::fs::remove_file(&temporary);
        FileError::write(path, &e)
    })
}
