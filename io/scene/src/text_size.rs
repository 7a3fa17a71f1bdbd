//! Limit of the length of a scene's text.

use crate::SceneError;
use domain::{Comm, MemoryNeed, Process};
use std::io::Read;

/// Largest length of a text in bytes. A million rows of a table of three numbers take less.
const MOST: u64 = 32 << 20;

/// Largest memory while reading, in bytes per byte of text, as for lists of one-digit numbers.
const MEMORY: f64 = 100.0;

/// Reads the text of a scene, unless it is too long.
pub(super) fn read(mut from: impl Read, name: &str) -> Result<String, SceneError> {
    let (mut bytes, unreadable) = (Vec::new(), |reason| SceneError::Unreadable { name: name.to_owned(), reason });
    from.by_ref().take(MOST + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MOST {
        let message = format!(
            "is longer than {} MB, the most that a scene may have; bring places of particles by particles.path, and \
             leave out what is no scene",
            MOST >> 20
        );
        return Err(SceneError::TooLong { name: name.to_owned(), message });
    }
    check_memory(bytes.len(), name)?;
    let not_text = |_| std::io::Error::new(std::io::ErrorKind::InvalidData, "stream did not contain valid UTF-8");
    String::from_utf8(bytes).map_err(not_text).map_err(unreadable)
}

fn check_memory(length: usize, name: &str) -> Result<(), SceneError> {
    let need = MemoryNeed { resident: Process::ALONE.resident(MEMORY * length as f64), ..MemoryNeed::default() };
    let too_little = |reason| SceneError::TooLong {
        name: name.to_owned(),
        message: format!("has {length} bytes, and there is too little memory to read them: {reason}"),
    };
    if length < SHORT { Ok(()) } else { Comm::check_memory_of(&[need]).map_err(too_little) }
}

/// Length of a text that is read without checking the available memory.
const SHORT: usize = 1 << 20;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_are_too_long_are_refused() {
        assert_eq!(read(&b"seed = 1"[..], "a.toml").unwrap(), "seed = 1");
        let error = read(std::io::repeat(b'1'), "a.toml").unwrap_err().to_string();
        assert!(error.starts_with("a.toml is longer than 32 MB"), "{error}");
        assert!(
            read(&b"\xff"[..], "a.toml")
                .unwrap_err()
                .to_string()
                .contains("a.toml: stream did not contain valid UTF-8")
        );
    }
}
