//! Check that HDF5 input files are self-contained.
//!
//! A dataset may have its numbers in any other file of the machine (external storage, virtual datasets), and a name
//! may refer to an object of another HDF5 file (external links). A file from elsewhere could thus make the program
//! read, or write to, the user's own files.

use crate::last_opened;
use hdf5::plist::dataset_create::Layout;
use hdf5::{Dataset, File, Group, LinkType, Result};
use std::path::Path;

/// Opens a file for reading; `Err` if anything in it is stored in another file.
pub(crate) fn open(path: &Path) -> Result<File> {
    last_opened::note(path);
    let file = File::open(path)?;
    check(&file)?;
    Ok(file)
}

/// `Err` if anything in a file is stored in another file.
pub(crate) fn check(file: &File) -> Result<()> {
    last_opened::note(Path::new(&file.filename()));
    let (mut waiting, mut seen) = (vec![file.as_group()?], Vec::new());
    while let Some(group) = waiting.pop() {
        let place = group.loc_info()?;
        if seen.contains(&place.token) {
            continue;
        }
        seen.push(place.token);
        waiting.extend(check_members(&group)?);
    }
    Ok(())
}

/// Checks the members of a group; returns the groups among them.
fn check_members(group: &Group) -> Result<Vec<Group>> {
    let mut names = Vec::new();
    group.iter_visit_default(|name, link| {
        if link.link_type == LinkType::External {
            return Err(format!("`{}` is a link to another file; {REMEDY}", inside(group, name)).into());
        }
        names.extend((link.link_type == LinkType::Hard).then(|| name.to_owned()));
        Ok(())
    })?;
    let mut groups = Vec::new();
    for name in names {
        match group.group(&name) {
            Ok(member) => groups.push(member),
            Err(_) => group.dataset(&name).map_or(Ok(()), |dataset| check_dataset(&dataset))?,
        }
    }
    Ok(groups)
}

fn check_dataset(dataset: &Dataset) -> Result<()> {
    let (created, name) = (dataset.dcpl()?, inside_file(&dataset.name()));
    let is_virtual = created.get_layout().is_ok_and(|layout| layout == Layout::Virtual);
    let mut others: Vec<String> = created.get_external()?.into_iter().map(|file| file.name).collect();
    if is_virtual && !OF_FIELDS.contains(&name.as_str()) {
        let unclear = |_| format!("`{name}` is a virtual dataset; {REMEDY}");
        let sources = created.get_virtual_map().map_err(unclear)?.into_iter().map(|map| map.src_filename);
        others.extend(sources.filter(|source| source != "."));
    }
    match others.first() {
        Some(other) => Err(format!("`{name}` is stored in another file, `{other}`; {REMEDY}").into()),
        None => Ok(()),
    }
}

/// Virtual datasets of the program's own fields, for visualisation programs: the program does not read them.
const OF_FIELDS: [&str; 3] = ["position", "repeated/velocity", "repeated/position"];

const REMEDY: &str = "copy all that it needs into the file itself, for example by h5copy";

fn inside(group: &Group, name: &str) -> String {
    inside_file(&format!("{}/{name}", group.name().trim_end_matches('/')))
}

fn inside_file(path: &str) -> String {
    path.trim_start_matches('/').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5::Selection;

    fn refused(fill: impl FnOnce(&File, &Path)) -> String {
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("other.h5");
        let secret = File::create(&other).unwrap();
        secret.new_dataset_builder().with_data(&[1.0, 2.0, 3.0]).create("positions").unwrap();
        drop(secret);
        let path = folder.path().join("a.h5");
        let file = File::create(&path).unwrap();
        file.new_dataset_builder().with_data(&[1.0, 2.0, 3.0]).create("radii").unwrap();
        fill(&file, &other);
        drop(file);
        open(&path).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn numbers_and_names_of_other_files_are_refused() {
        let external = refused(|file, other| {
            let name = other.display().to_string();
            let group = file.create_group("particles").unwrap();
            group.new_dataset::<f64>().shape([3]).external(&name, 0, 24).create("positions").unwrap();
        });
        assert!(external.contains("`particles/positions` is stored in another file, `/"), "{external}");
        let mapped = refused(|file, other| {
            let name = other.display().to_string();
            let all = Selection::All;
            let new = file.new_dataset::<f64>().shape([3]);
            new.virtual_map(name, "positions", [3], all.clone(), [3], all).create("positions").unwrap();
        });
        assert!(mapped.contains("`positions` is stored in another file, `/"), "{mapped}");
        let linked = refused(|file, other| {
            file.link_external(&other.display().to_string(), "positions", "positions").unwrap();
        });
        assert!(linked.contains("`positions` is a link to another file"), "{linked}");
    }

    #[test]
    fn what_is_in_the_file_is_read() {
        let own = refused(|file, _| {
            let group = file.create_group("a").unwrap();
            file.link_hard("/", "a/all").unwrap();
            file.link_soft("/radii", "b").unwrap();
            let all = Selection::All;
            let new = group.new_dataset::<f64>().shape([3]);
            new.virtual_map(".", "/radii", [3], all.clone(), [3], all).create("shown").unwrap();
        });
        assert_eq!(own, "");
    }
}
