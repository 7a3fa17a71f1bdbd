//! The manifest of a results folder: the names of all files and folders that the program has made there. Anything
//! that it does not list belongs to the user, and is neither replaced nor removed.
//!
//! The manifest is a text file. A name is added and is on the disk before the file of that name is made. So a program
//! that is killed at any time leaves no file of its own that is not listed.

mod entry;
mod names;
mod obstacles;
mod older;
#[cfg(test)]
mod tests;

use crate::watched_file::WatchedFile;
use crate::{FileError, atomic_file, checksum};
use entry::{Entries, Entry};
pub use names::SCENE;
pub(crate) use names::{is_checkpoint, is_numbered};
pub use obstacles::Obstacles;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Name of the manifest in the results folder.
pub const MANIFEST: &str = "manifest.jsonl";

/// Largest size of a manifest that is read: some two million names.
const MOST: u64 = 1 << 26;

/// The files that the program has made in a results folder.
pub struct Manifest {
    folder: PathBuf,
    /// `None` if the folder has no manifest: then nothing is entered or removed.
    listed: Option<Mutex<Listed>>,
}

/// Entries of a manifest, and its file.
struct Listed {
    entries: Entries,
    /// The manifest file, once this process has written to it.
    file: Option<WatchedFile>,
    /// Whether the file has these entries; a manifest of files of an older version is not written until it is needed.
    is_written: bool,
}

impl Manifest {
    /// A folder without a manifest, such as one that a user names for an export.
    pub fn none(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), listed: None }
    }

    /// Manifest of a folder; [`Self::none`] if it has none.
    pub fn of(folder: &Path) -> Result<Self, FileError> {
        Ok(Self::open(folder)?.unwrap_or_else(|| Self::none(folder)))
    }

    /// Manifest of a folder, if it has one. Nothing is written.
    pub fn open(folder: &Path) -> Result<Option<Self>, FileError> {
        let path = folder.join(MANIFEST);
        let Some(found) = found(&path) else { return Ok(None) };
        if !found.is_file() || found.len() > MOST {
            return Err(FileError::damaged(&path, &"it is no file that this program wrote"));
        }
        let mut text = Vec::new();
        let read = File::open(&path).and_then(|file| file.take(MOST).read_to_end(&mut text));
        read.map_err(|e| FileError::read(&path, &e))?;
        let text = String::from_utf8_lossy(&text);
        let entries = Entries::parse(&text).map_err(|reason| FileError::damaged(&path, &reason))?;
        Ok(Some(Self::with(folder, entries, true)))
    }

    /// Manifest for the results of an older version, which wrote none: the files that are recognised by their
    /// content; `None` if there are none.
    pub fn of_older_version(folder: &Path) -> Result<Option<Self>, FileError> {
        let entries = older::entries(folder)?;
        Ok(entries.map(|entries| Self::with(folder, entries, false)))
    }

    fn with(folder: &Path, entries: Entries, is_written: bool) -> Self {
        let listed = Listed { entries, file: None, is_written };
        Self { folder: folder.to_owned(), listed: Some(Mutex::new(listed)) }
    }

    /// A new manifest for a run of this scene. It replaces a former one, of which it keeps the
    /// folders that still exist.
    pub fn begin(folder: &Path, scene: &str, former: Option<&Self>) -> Result<Self, FileError> {
        let listed = former.and_then(Self::listed);
        let is_left = |name: &&String| found(&folder.join(name)).is_some_and(|found| found.is_dir());
        let folders = listed.iter().flat_map(|listed| &listed.entries.folders).filter(is_left).cloned().collect();
        let entries = Entries { folders, scene: Some(checksum::of_text(scene)), ..Entries::default() };
        drop(listed);
        let manifest = Self::with(folder, entries, false);
        if let Some(mut listed) = manifest.listed() {
            listed.prepare(folder)?;
        }
        Ok(manifest)
    }

    /// The manifest of a folder, or a new one.
    #[cfg(test)]
    pub fn of_test(folder: &Path) -> Self {
        Self::open(folder).unwrap().unwrap_or_else(|| Self::begin(folder, "", None).unwrap())
    }

    /// Path of the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Records a new scene of the folder.
    pub fn note_scene(&self, scene: &str) -> Result<(), FileError> {
        let Some(mut listed) = self.listed() else { return Ok(()) };
        let digest = checksum::of_text(scene);
        if listed.entries.scene.as_ref() == Some(&digest) {
            return Ok(());
        }
        listed.prepare(&self.folder)?;
        listed.entries.scene = Some(digest.clone());
        listed.add(&self.folder, &[Entry::Scene(digest)])
    }

    /// Enters a file that is about to be made, changed or replaced. `Err` if a file of that name exists and is not
    /// listed. Paths outside of the folder of the manifest are not checked.
    pub fn enter(&self, path: &Path) -> Result<(), FileError> {
        let (Some(mut listed), Some(name)) = (self.listed(), self.name(path)) else { return Ok(()) };
        self.check_parents(&name, path)?;
        if listed.entries.files.contains(&name) {
            return listed.prepare(&self.folder);
        }
        if found(path).is_some() {
            return Err(in_the_way(path));
        }
        listed.prepare(&self.folder)?;
        listed.entries.files.insert(name.clone());
        listed.add(&self.folder, &[Entry::File(name)])
    }

    /// Like [`Self::enter`], for a folder that may have no manifest: there, an existing file is
    /// replaced only if `is_ours`.
    pub fn enter_known(&self, path: &Path, is_ours: impl Fn(&Path) -> bool) -> Result<(), FileError> {
        let is_of_folder = path.parent() == Some(&self.folder);
        if self.listed.is_none() && is_of_folder && found(path).is_some_and(|found| found.is_file()) && !is_ours(path) {
            return Err(in_the_way(path));
        }
        self.enter(path)
    }

    /// Creates a folder and its parents and enters it; an existing folder must be listed.
    pub fn make_folder(&self, path: &Path) -> Result<(), FileError> {
        if let (Some(mut listed), Some(name)) = (self.listed(), self.name(path)) {
            self.check_parents(&name, path)?;
            let is_there = found(path);
            if is_there.as_ref().is_some_and(|found| !found.is_dir() || !listed.entries.folders.contains(&name)) {
                return Err(in_the_way(path));
            }
            listed.prepare(&self.folder)?;
            if listed.entries.folders.insert(name.clone()) {
                listed.add(&self.folder, &[Entry::Folder(name)])?;
            }
        }
        std::fs::create_dir_all(path).map_err(|e| FileError::write(path, &e))
    }

    /// Creates folders, and enters them and files that will be made in them, with a single sync to the disk. `Err`
    /// for anything that exists and is not listed.
    pub fn make_folders(&self, folders: &[String], files: &[String]) -> Result<(), FileError> {
        let Some(mut listed) = self.listed() else { return Ok(()) };
        listed.prepare(&self.folder)?;
        let Entries { folders: known_folders, files: known_files, .. } = &listed.entries;
        let folders: Vec<&String> = folders.iter().filter(|name| !known_folders.contains(*name)).collect();
        let files: Vec<&String> = files.iter().filter(|name| !known_files.contains(*name)).collect();
        let is_in_the_way = |name: &&&String| found(&self.folder.join(name)).is_some();
        if let Some(name) = folders.iter().chain(&files).find(is_in_the_way) {
            return Err(in_the_way(&self.folder.join(name)));
        }
        let of_folders = folders.iter().map(|name| Entry::Folder((*name).clone()));
        let entries: Vec<Entry> = of_folders.chain(files.iter().map(|name| Entry::File((*name).clone()))).collect();
        let [folders, files] = [folders, files].map(|names| names.into_iter().cloned().collect::<Vec<_>>());
        if !entries.is_empty() {
            listed.add(&self.folder, &entries)?;
        }
        listed.entries.folders.extend(folders);
        listed.entries.files.extend(files);
        let all: Vec<String> = listed.entries.folders.iter().cloned().collect();
        drop(listed);
        all.iter().try_for_each(|name| {
            let path = self.folder.join(name);
            self.check_parents(&format!("{name}/x"), &path)?;
            std::fs::create_dir_all(&path).map_err(|e| FileError::write(&path, &e))
        })
    }

    /// Listed folders.
    pub fn folders(&self) -> Vec<PathBuf> {
        self.listed().iter().flat_map(|listed| &listed.entries.folders).map(|name| self.folder.join(name)).collect()
    }

    /// Removes the manifest itself, once everything that it lists is gone.
    pub fn discard(self) -> Result<(), FileError> {
        let path = self.folder.join(MANIFEST);
        if self.listed.is_none() || found(&path).is_none() {
            return Ok(());
        }
        std::fs::remove_file(&path).map_err(|e| FileError::write(&path, &e))
    }

    /// Whether a file is listed.
    pub fn lists(&self, path: &Path) -> bool {
        let name = self.name(path);
        self.listed().zip(name).is_some_and(|(listed, name)| listed.entries.files.contains(&name))
    }

    /// Removes a listed file, if it exists. `Err` if it is not listed, or is not a file.
    pub fn remove(&self, path: &Path) -> Result<(), FileError> {
        let Some(is_there) = found(path) else { return Ok(()) };
        let name = self.name(path).filter(|_| self.lists(path) && is_there.is_file());
        let (Some(mut listed), Some(name)) = (self.listed(), name) else { return Err(in_the_way(path)) };
        self.check_parents(&name, path)?;
        listed.prepare(&self.folder)?;
        std::fs::remove_file(path).map_err(|e| FileError::write(path, &e))?;
        listed.entries.files.remove(&name);
        listed.add(&self.folder, &[Entry::Removed(name)])
    }

    /// Listed files.
    pub fn files(&self) -> Vec<PathBuf> {
        let listed = self.listed();
        listed.iter().flat_map(|listed| &listed.entries.files).map(|name| self.folder.join(name)).collect()
    }

    /// Removes everything that is listed; folders only if they are empty then. The scene, which identifies a folder
    /// as that of a run, is the last file.
    pub fn remove_all(&self) -> Result<(), FileError> {
        let scene = self.folder.join(SCENE);
        let mut files = self.files();
        files.sort_by_key(|path| (path == &scene, !is_numbered(path, "checkpoint-", ".bin")));
        files.iter().try_for_each(|path| self.remove(path))?;
        let folders: Vec<String> = self.listed().iter().flat_map(|listed| listed.entries.folders.clone()).collect();
        for name in folders.iter().rev() {
            let path = self.folder.join(name);
            self.check_parents(name, &path)?;
            // A folder with files of the user stays.
            if found(&path).is_some_and(|found| found.is_dir()) {
                let _ = std::fs::remove_dir(&path);
            }
        }
        Ok(())
    }

    /// Removes temporary files of processes that were killed while writing here.
    pub fn remove_temporary_files(&self) {
        let Some(listed) = self.listed() else { return };
        let folders = listed.entries.folders.iter().map(|name| (name.as_str(), self.folder.join(name)));
        for (name, folder) in [("", self.folder.clone())].into_iter().chain(folders) {
            let is_real = name.is_empty() || self.check_parents(&format!("{name}/x"), &folder).is_ok();
            let Ok(files) = std::fs::read_dir(folder) else { continue };
            for path in files.filter_map(|file| Some(file.ok()?.path())).filter(|_| is_real) {
                let mark = atomic_file::writer_of(&path);
                let is_one = mark.is_some_and(|mark| listed.entries.writers.contains(mark));
                if (is_one || is_unplaced(&path)) && found(&path).is_some_and(|found| found.is_file()) {
                    // A file that cannot be removed now will be removed at the next start.
                    let _ = std::fs::remove_file(path);
                }
            }
        }
    }

    fn listed(&self) -> Option<MutexGuard<'_, Listed>> {
        Some(self.listed.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Name relative to the folder, if the path is inside it.
    fn name(&self, path: &Path) -> Option<String> {
        let inside = |folder: &Path, path: &Path| Some(path.strip_prefix(folder).ok()?.to_str()?.to_owned());
        let name = inside(&self.folder, path).or_else(|| {
            let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
            inside(&self.folder.canonicalize().ok()?, &parent.canonicalize().ok()?.join(path.file_name()?))
        });
        name.filter(|name| !name.is_empty())
    }

    /// `Err` if a folder between that of the manifest and a path is a symbolic link, which could lead elsewhere.
    fn check_parents(&self, name: &str, path: &Path) -> Result<(), FileError> {
        let mut parents = Path::new(name).ancestors().skip(1).filter(|parent| !parent.as_os_str().is_empty());
        let is_link = |parent: &Path| found(&self.folder.join(parent)).is_some_and(|found| found.is_symlink());
        match parents.find(|parent| is_link(parent)) {
            Some(parent) => {
                let link = format!(
                    "{} is a symbolic link now; put the folder itself there",
                    self.folder.join(parent).display()
                );
                Err(FileError::write(path, &link))
            }
            None => Ok(()),
        }
    }
}

impl Listed {
    /// Opens the file for writing by this process, and adds the mark of the process.
    fn prepare(&mut self, folder: &Path) -> Result<(), FileError> {
        if self.file.is_some() {
            return Ok(());
        }
        let path = folder.join(MANIFEST);
        let failed = |e: std::io::Error| FileError::write(&path, &e);
        let mark = atomic_file::mark().to_owned();
        if !self.is_written {
            self.entries.writers.insert(mark);
            atomic_file::replace(&path, self.entries.text().as_bytes())?;
            self.is_written = true;
            let file = OpenOptions::new().append(true).open(&path);
            self.file = Some(file.and_then(|file| WatchedFile::new(&path, file)).map_err(failed)?);
            return Ok(());
        }
        self.file = Some(whole_lines(&path).and_then(|file| WatchedFile::new(&path, file)).map_err(failed)?);
        if self.entries.writers.insert(mark.clone()) { self.add(folder, &[Entry::Writer(mark)]) } else { Ok(()) }
    }

    /// Adds lines, which are on the disk when this returns.
    fn add(&mut self, folder: &Path, entries: &[Entry]) -> Result<(), FileError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        file.check()?;
        let lines: String = entries.iter().map(Entry::line).collect();
        let written = file.file().write_all(lines.as_bytes()).and_then(|()| match entries {
            // Names of removed files do no harm.
            [Entry::Removed(_)] => Ok(()),
            _ => atomic_file::sync(file.file()),
        });
        written.map_err(|e| FileError::write(&folder.join(MANIFEST), &e))?;
        file.note_length()
    }
}

/// Whether a file is a manifest under its temporary name, left by a killed process whose mark no manifest lists yet.
fn is_unplaced(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let is_named = name.starts_with(MANIFEST) && atomic_file::writer_of(path).is_some_and(|mark| mark.len() == 16);
    let (expected, mut start) = (Entry::first().line().into_bytes(), Vec::new());
    let read = File::open(path).and_then(|file| file.take(expected.len() as u64).read_to_end(&mut start));
    is_named && read.is_ok() && expected.starts_with(&start)
}

/// Opens a manifest for appending, without a last line that was cut short.
fn whole_lines(path: &Path) -> std::io::Result<File> {
    let mut file = OpenOptions::new().read(true).append(true).open(path)?;
    let mut text = Vec::new();
    (&mut file).take(MOST).read_to_end(&mut text)?;
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
    if whole < text.len() {
        file.set_len(whole as u64)?;
    }
    Ok(file)
}

/// Metadata of a path, not following a symbolic link.
fn found(path: &Path) -> Option<Metadata> {
    std::fs::symlink_metadata(path).ok()
}

fn in_the_way(path: &Path) -> FileError {
    let reason = format!(
        "something of this name is there that no run is known to have made, for {MANIFEST} does not list it; move it \
         away"
    );
    FileError::write(path, &reason)
}
