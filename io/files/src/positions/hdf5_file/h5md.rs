//! Frames of H5MD files (de Buyl, Colberg & Höfling, Comput. Phys. Commun. 185, 1546, 2014).

use super::array::words;
use super::element::H5mdElement;
use crate::Provenance;
use crate::frames::FrameChecksums;
use crate::positions::run_folder::recorded;
use crate::positions::species::SpeciesColumn;
use crate::positions::{FileBox, StartFile, TakenFrame, frame};
use domain::Vector;
use hdf5::types::{FixedAscii, VarLenAscii, VarLenUnicode};
use hdf5::{Attribute, File, Group};
use scene::document::excerpt;
use scene::{Scene, StartSource};

/// Reads a frame of a group of particles, by default the last one.
pub(super) fn read(file: &File, source: &StartSource) -> Result<StartFile, String> {
    let group = group(file, source.group.as_deref())?;
    let open = |name: &str| H5mdElement::open(&group, name);
    let position = open("position")?.ok_or_else(|| format!("{} has no position", short(&group)))?;
    let count = position.frames()?.unwrap_or(1);
    let number = frame::pick(source.frame, count)?;
    if let Some(damage) = FrameChecksums::open(file).map_err(words)?.and_then(|sums| sums.damage(number)) {
        return Err(format!("{damage}; restore the file from a copy, or name another particles.frame"));
    }
    let (step, time) = position.clock(number);
    let positions = position.value(number)?.vectors()?;
    let value = |name: &str| open(name)?.map(|element| element.at_step(step)).transpose();
    let n = positions.len();
    Ok(StartFile {
        radii: value("radius")?.map(|array| array.one_each(n)).transpose()?,
        species: value("species")?.map(|array| array.kinds(n)).transpose()?.map(|kinds| with_names(kinds, file)),
        ids: value("id")?.map(|array| array.ids(n)).transpose()?,
        orientations: value("orientation")?.map(|array| array.orientations(n)).transpose()?,
        images: value("image")?.map(|array| array.steps(n)).transpose()?,
        cell: cell(&group, step)?,
        frame: TakenFrame { number, count, step: step.map(|step| step as i64), time },
        positions,
    })
}

/// Adds the species names of the scene, if the file is from a run of this program. Species numbers of other programs
/// are taken to start from 1 if none is 0: otherwise the first species would have no particle.
fn with_names(kinds: SpeciesColumn, file: &File) -> SpeciesColumn {
    let text = Provenance::read(file).map(|provenance| provenance.scene).unwrap_or_default();
    match (kinds, Scene::parse(&text, "the scene of the run", &[]).ok()) {
        (SpeciesColumn::Indices(numbers), Some(scene)) => recorded(numbers, &scene),
        (SpeciesColumn::Indices(numbers), None) if !numbers.contains(&0) => SpeciesColumn::Types(numbers),
        (kinds, _) => kinds,
    }
}

fn short(group: &Group) -> String {
    group.name().trim_start_matches('/').to_owned()
}

/// The group of this name, or the only one.
fn group(file: &File, name: Option<&str>) -> Result<Group, String> {
    let all = file.group("particles").map_err(words)?;
    let names = all.member_names().map_err(words)?;
    let are_groups = names.into_iter().filter(|name| all.group(name).is_ok()).collect::<Vec<_>>();
    match (name, &are_groups[..]) {
        (Some(name), _) if are_groups.iter().any(|one| one == name) => all.group(name).map_err(words),
        (Some(name), _) => Err(format!(
            "particles.group is \"{name}\", but its groups of particles are {}",
            excerpt(&are_groups.join(", "))
        )),
        (None, [only]) => all.group(only).map_err(words),
        (None, []) => Err("its group particles has no group of particles in it".to_owned()),
        (None, _) => Err(format!(
            "it has several groups of particles, {}; name one by particles.group",
            excerpt(&are_groups.join(", "))
        )),
    }
}

/// Box at a step, if the group has its edges.
fn cell(group: &Group, step: Option<f64>) -> Result<Option<FileBox>, String> {
    let Ok(cell) = group.group("box") else { return Ok(None) };
    let Some(edges) = H5mdElement::open(&cell, "edges")? else { return Ok(None) };
    let edges = edges.at_step(step)?;
    let (shape, numbers) = (edges.shape(), edges.numbers()?);
    let straight = match shape[..] {
        [3] => FileBox::straight(Vector::from_slice(&numbers)),
        [3, 3] => FileBox::lattice([0, 3, 6].map(|first| Vector::from_slice(&numbers[first..]))),
        _ => return Err(format!("{} has the shape {shape:?}; a box has 3 edges, as numbers or vectors", edges.name())),
    };
    let strain = H5mdElement::open(&cell, "strain")?.map(|strain| strain.at_step(step)).transpose()?;
    let strain = strain.map(|strain| strain.numbers()).transpose()?.and_then(|numbers| numbers.first().copied());
    // A lattice that is not along x, y and z is determined by its vectors alone.
    let strain = strain.filter(|strain| is_that_of(&straight, *strain));
    let periodic = cell.attr("boundary").ok().map_or(Ok([true; 3]), |boundary| periodic(&boundary))?;
    FileBox { periodic, strain, ..straight }.checked().map(Some)
}

/// Whether a strain is consistent with the vectors.
fn is_that_of(cell: &FileBox, strain: f64) -> bool {
    let [a, b, _] = cell.vectors;
    a.y == 0.0 && a.z == 0.0 && (b.x - strain * b.y).abs() <= 1e-9 * (a.x.abs() + b.y.abs())
}

/// Whether a box is periodic along each edge.
fn periodic(boundary: &Attribute) -> Result<[bool; 3], String> {
    let axes = strings(boundary)?;
    let axes: Vec<bool> = axes.iter().map(|axis| axis == "periodic").collect();
    axes.try_into().map_err(|axes: Vec<bool>| format!("its box has {} boundaries; it needs 3", axes.len()))
}

/// Strings of any length and encoding.
fn strings(attribute: &Attribute) -> Result<Vec<String>, String> {
    fn owned<T: AsRef<str>>(list: &[T]) -> Vec<String> {
        list.iter().map(|text| text.as_ref().trim_end_matches('\0').to_owned()).collect()
    }
    let fixed = attribute.read_raw::<FixedAscii<64>>().map(|list| owned(&list));
    let ascii = || attribute.read_raw::<VarLenAscii>().map(|list| owned(&list));
    let unicode = || attribute.read_raw::<VarLenUnicode>().map(|list| owned(&list));
    fixed.or_else(|_| ascii()).or_else(|_| unicode()).map_err(|e| format!("its box has no boundary: {e}"))
}

/// A box in a file of this program has a strain in addition.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strain_belongs_to_vectors_along_x() {
        let vectors = [[8.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 5.0]].map(Vector::from_array);
        let cell = FileBox::lattice(vectors);
        assert!(is_that_of(&cell, 0.25) && !is_that_of(&cell, 0.0));
        assert!(!is_that_of(&FileBox::lattice([vectors[1], vectors[0], vectors[2]]), 0.25));
    }
}
