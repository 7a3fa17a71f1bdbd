//! First lines of text files of a run, by which they are recognised.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The file of the answers in the folder of a run.
pub const ANSWERS: &str = "summary.csv";

/// First line of the file of answers.
pub const ANSWERS_START: &str = "quantity,species,value,error,samples,transient,verdict,longer,unit\n";

/// First lines of the report of a run. Its content security policy says that it needs nothing from elsewhere, and may
/// not request anything.
pub const REPORT_START: &str = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
    <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; \
    style-src 'unsafe-inline'; img-src data:\">\n";

/// Whether a file begins with some bytes.
pub fn starts_with(path: &Path, start: &[u8]) -> bool {
    let mut found = Vec::new();
    let read = File::open(path).and_then(|file| file.take(start.len() as u64).read_to_end(&mut found));
    read.is_ok() && found == start
}
