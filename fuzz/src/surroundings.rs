//! Digests of everything in a folder, for finding the files that a process has changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// Contents of a folder and its subfolders. Links are not followed.
#[derive(Debug)]
pub struct Surroundings(BTreeMap<PathBuf, FileEntry>);

#[derive(Debug, PartialEq, Eq)]
enum FileEntry {
    File(u64),
    Link(PathBuf),
    Folder,
}

/// Paths, relative to the folder, that a process may change.
#[derive(Debug, Default)]
pub struct Permit {
    /// Files and folders that a run has made: they may be changed and removed.
    pub made: BTreeSet<PathBuf>,
    /// Folder in which new files may be created.
    pub into: Option<PathBuf>,
}

/// Output of a process, and the costs of the machine.
const ITS_OWN: [&str; 3] = ["stdout", "stderr", "fcm-solve"];

impl Surroundings {
    /// The present contents.
    pub fn of(folder: &Path) -> std::io::Result<Self> {
        let mut entries = BTreeMap::new();
        collect(folder, Path::new(""), &mut entries)?;
        Ok(Self(entries))
    }

    /// The first change from `self` to `after` that is not permitted.
    pub fn touched(&self, after: &Self, permit: &Permit) -> Option<String> {
        let is_own = |path: &Path| ITS_OWN.iter().any(|own| path.starts_with(own));
        let changed = self.0.iter().filter(|(path, _)| !is_own(path) && !permit.made.contains(*path));
        let changed = changed.filter_map(|(path, entry)| match after.0.get(path) {
            None => Some(format!("{} is gone", path.display())),
            Some(now) if now != entry => Some(format!("{} is another one", path.display())),
            Some(_) => None,
        });
        let may_appear = |path: &Path| permit.into.as_ref().is_some_and(|into| path.starts_with(into));
        let new = after.0.keys().filter(|path| !self.0.contains_key(*path) && !is_own(path) && !may_appear(path));
        changed.chain(new.map(|path| format!("{} was not there", path.display()))).next()
    }
}

fn collect(folder: &Path, under: &Path, entries: &mut BTreeMap<PathBuf, FileEntry>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let (path, kind) = (under.join(entry.file_name()), entry.file_type()?);
        let found = if kind.is_symlink() {
            FileEntry::Link(std::fs::read_link(entry.path())?)
        } else if kind.is_dir() {
            collect(&entry.path(), &path, entries)?;
            FileEntry::Folder
        } else {
            FileEntry::File(xxh3_64(&std::fs::read(entry.path())?))
        };
        entries.insert(path, found);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    /// The change that is found after `change` in a folder with files inside and outside of `out`.
    fn found(change: impl FnOnce(&Path) -> std::io::Result<()>) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path();
        std::fs::create_dir_all(place.join("out/cases")).unwrap();
        for name in ["kept.txt", "out/made.csv", "out/cases/strange.csv"] {
            std::fs::write(place.join(name), name).unwrap();
        }
        symlink("kept.txt", place.join("link")).unwrap();
        let permit = Permit { made: [PathBuf::from("out/made.csv")].into(), into: Some("out".into()) };
        let before = Surroundings::of(place).unwrap();
        change(place).unwrap();
        before.touched(&Surroundings::of(place).unwrap(), &permit)
    }

    #[test]
    fn what_a_run_may_do_is_passed() {
        assert_eq!(found(|_| Ok(())), None);
        assert_eq!(found(|place| std::fs::write(place.join("out/new.csv"), "")), None);
        assert_eq!(found(|place| std::fs::remove_file(place.join("out/made.csv"))), None);
        assert_eq!(found(|place| std::fs::write(place.join("stdout"), "an answer")), None);
    }

    #[test]
    fn everything_else_is_found() {
        let gone = |name: &'static str| found(move |place| std::fs::remove_file(place.join(name))).unwrap();
        assert_eq!(gone("kept.txt"), "kept.txt is gone");
        assert_eq!(gone("link"), "link is gone");
        assert_eq!(gone("out/cases/strange.csv"), "out/cases/strange.csv is gone");
        let folder = found(|place| std::fs::remove_dir_all(place.join("out/cases"))).unwrap();
        assert_eq!(folder, "out/cases is gone");
        let through = found(|place| std::fs::write(place.join("link"), "x")).unwrap();
        assert_eq!(through, "kept.txt is another one");
        assert_eq!(found(|place| std::fs::write(place.join("new"), "")).unwrap(), "new was not there");
        let linked = |place: &Path| {
            std::fs::remove_file(place.join("link"))?;
            symlink("out", place.join("link"))
        };
        assert_eq!(found(linked).unwrap(), "link is another one");
    }
}
