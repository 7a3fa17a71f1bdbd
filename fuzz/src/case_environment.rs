//! A case: a separate folder, random choices determined by its number, and the program.

use crate::pool::InputPool;
use crate::program::{Ended, Program};
use crate::surroundings::{Permit, Surroundings};
use crate::verdict::{Names, ProcessEnd, judge, of_hdf5, of_table, of_text};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A failure of the program in a case.
#[derive(Debug)]
pub struct Fault {
    /// Description of the failure.
    pub what: String,
    /// The command.
    pub command: Vec<OsString>,
    /// Standard error of the command.
    pub stderr: String,
}

/// A mistake of the harness itself counts as a fault, so that it is noticed.
impl<E: std::error::Error> From<E> for Fault {
    fn from(error: E) -> Self {
        Self::new(&format!("the harness failed: {error}"))
    }
}

impl Fault {
    /// A fault without a command.
    pub fn new(what: &str) -> Self {
        Self { what: what.to_owned(), command: vec![], stderr: String::new() }
    }
}

/// Environment of a case.
pub struct CaseEnvironment<'a> {
    /// The program.
    pub program: &'a Program,
    /// Valid files.
    pub pool: &'a InputPool,
    /// Folder of the case.
    pub folder: PathBuf,
    random: TestRunner,
}

impl<'a> CaseEnvironment<'a> {
    /// Environment of the case with this number.
    pub fn new(program: &'a Program, pool: &'a InputPool, folder: &Path, [seed, number]: [u64; 2]) -> Self {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[8..16].copy_from_slice(&number.to_le_bytes());
        let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
        let random = TestRunner::new_with_rng(Config::default(), rng);
        Self { program, pool, folder: folder.to_owned(), random }
    }

    /// Draws a random value.
    pub fn draw<S: Strategy>(&mut self, strategy: S) -> S::Value {
        strategy.new_tree(&mut self.random).expect("no strategy here rejects values").current()
    }

    /// Draws an item of a list.
    pub fn one_of<'b, T>(&mut self, list: &'b [T]) -> &'b T {
        &list[self.draw(0..list.len())]
    }

    /// Writes a file to the case's folder.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> std::io::Result<()> {
        std::fs::write(self.folder.join(name), content)
    }

    /// Copies a folder of valid results to the case's folder, under the same name.
    pub fn copy_results(&self, name: &str) -> std::io::Result<PathBuf> {
        let to = self.folder.join(name);
        copy(&self.pool.folder.join(name), &to)?;
        Ok(to)
    }

    /// Runs the program and judges its reaction.
    pub fn run(&self, arguments: &[&str]) -> Result<ProcessEnd, Fault> {
        let arguments: Vec<OsString> = arguments.iter().map(OsString::from).collect();
        self.run_os(&arguments)
    }

    /// Like [`Self::run`], with arguments that need not be text.
    pub fn run_os(&self, arguments: &[OsString]) -> Result<ProcessEnd, Fault> {
        let ended = self.program.run(&self.folder, arguments).map_err(|error| Fault {
            what: format!("it does not start: {error}"),
            command: arguments.to_vec(),
            stderr: String::new(),
        })?;
        judge(&ended, &self.names(arguments)).map_err(|what| fault(ended, what))
    }

    /// Like [`Self::run`], but requires that only permitted paths in the case's folder are changed.
    pub fn run_within(&self, arguments: &[&str], permit: &Permit) -> Result<ProcessEnd, Fault> {
        let before = Surroundings::of(&self.folder)?;
        let end = self.run(arguments)?;
        match before.touched(&Surroundings::of(&self.folder)?, permit) {
            None => Ok(end),
            Some(what) => Err(self.fault_of(arguments, &format!("a file that the run did not make: {what}"))),
        }
    }

    /// Requires that an invalid input is refused with an error that contains `word`.
    pub fn run_refused(&self, arguments: &[&str], word: &str) -> Result<ProcessEnd, Fault> {
        if self.run(arguments)? != ProcessEnd::Refused {
            return Err(self.fault_of(arguments, "it accepted what it can't have read whole"));
        }
        if !self.stderr().contains(word) {
            return Err(self.fault_of(arguments, &format!("an error that does not name {word}")));
        }
        Ok(ProcessEnd::Refused)
    }

    /// A fault of the last command.
    pub fn fault_of(&self, arguments: &[&str], what: &str) -> Fault {
        let command = arguments.iter().map(OsString::from).collect();
        Fault { what: what.to_owned(), command, stderr: self.stderr() }
    }

    /// Errors and warnings of the last command.
    pub fn stderr(&self) -> String {
        String::from_utf8_lossy(&std::fs::read(self.folder.join("stderr")).unwrap_or_default()).into_owned()
    }

    /// Requires that the tables and HDF5 files in a folder of results have no NaN or infinity, except
    /// where values may be undefined.
    pub fn results_are_numbers(&self, folder: &str) -> Result<(), Fault> {
        files(&self.folder.join(folder)).iter().try_for_each(|path| self.is_numbers(path))
    }

    /// The same requirement for one file.
    pub fn is_numbers(&self, path: &Path) -> Result<(), Fault> {
        let judged = match path.extension().and_then(|extension| extension.to_str()) {
            Some("csv") => of_table(&String::from_utf8_lossy(&std::fs::read(path)?)),
            Some("h5") => of_hdf5(path),
            Some("json") => of_text(&std::fs::read_to_string(path)?),
            _ => Ok(()),
        };
        let name = path.strip_prefix(&self.folder).unwrap_or(path).display();
        judged.map_err(|what| Fault::new(&format!("{name}: {what}")))
    }

    /// Names that an error message may refer to.
    fn names(&self, arguments: &[OsString]) -> Names {
        let words = arguments.iter().skip(1).map(|word| word.to_string_lossy().into_owned());
        let entries = std::fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let entries = entries.filter_map(|entry| entry.file_name().into_string().ok());
        let files = words.chain(entries).filter(|name| !name.is_empty()).collect();
        Names { files, keys: self.pool.keys.to_vec() }
    }
}

fn fault(ended: Ended, what: String) -> Fault {
    Fault { what, command: ended.arguments, stderr: ended.stderr }
}

/// All files in a folder and its subfolders, sorted by name. Links are listed and not followed: several that lead
/// upwards would make a tree of endless size.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    let is_folder = |path: &Path| path.is_dir() && !path.is_symlink();
    entries.into_iter().flat_map(|path| if is_folder(&path) { files(&path) } else { vec![path] }).collect()
}

fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    if !from.is_dir() {
        return std::fs::copy(from, to).map(drop);
    }
    std::fs::create_dir_all(to)?;
    std::fs::read_dir(from)?.flatten().try_for_each(|entry| copy(&entry.path(), &to.join(entry.file_name())))
}
