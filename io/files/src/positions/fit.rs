//! Comparison of the particles of a file with those of a scene.

use super::file_box::{BoxAxis, BoxShape, FileBox, SceneBox, is_same_strain};
use super::{StartFile, order};
use domain::{AxisRotation, Boundaries, GivenPositions, Number, Vector};
use granular::disks;
use scene::document::excerpt;
use suspension::{Model, Species};

/// Relative difference at which radii of a file and of a scene count as equal: text may have six digits.
const ROUNDING: f64 = 1e-5;

/// Positions that fit a scene, and notes for the user.
#[derive(Debug)]
pub struct Fitted {
    /// Positions, with radii and species where the file has them.
    pub given: GivenPositions,
    /// Notes.
    pub notes: Vec<String>,
}

/// Strain of the box in a file, if the box is otherwise that of the scene; 0 if the file has no box.
pub fn strain_for_spheres(file: &StartFile, model: &Model) -> Result<f64, String> {
    file.cell.as_ref().map_or(Ok(0.0), |cell| cell.strain_in(&box_of_model(model)))
}

/// Strain of the box in a file of disks, like [`strain_for_spheres`].
pub fn strain_for_disks(file: &StartFile, parameters: &disks::DiskParameters) -> Result<f64, String> {
    file.cell.as_ref().map_or(Ok(0.0), |cell| cell.strain_in(&box_of_disks(parameters)))
}

/// Spheres of a file as those of a model, whose box has the strain of the file's box.
pub fn spheres(mut file: StartFile, model: &Model) -> Result<Fitted, String> {
    let scene = box_of_model(model);
    let mut notes = Vec::new();
    if let Some(cell) = &file.cell {
        check_strain(cell, &scene, model.cell.strain())?;
        notes.extend(without_period(cell, &scene));
        notes.extend(moved(&mut file.positions, cell, &scene));
    }
    add_images(&mut file, &scene);
    notes.extend(order::sort(&mut file)?);
    let species = species(&mut file, &model.species, &mut notes)?;
    let (positions, orientations) = (file.positions, file.orientations);
    Ok(Fitted { given: GivenPositions { positions, species, orientations, ..GivenPositions::default() }, notes })
}

/// Disks of a file, with the radii of the file.
pub fn disks(mut file: StartFile, parameters: &disks::DiskParameters) -> Result<Fitted, String> {
    let scene = box_of_disks(parameters);
    let mut notes = Vec::new();
    if let Some(cell) = &file.cell {
        check_strain(cell, &scene, parameters.strain)?;
        notes.extend(moved(&mut file.positions, cell, &scene));
    }
    notes.extend(order::sort(&mut file)?);
    let species = file.species.take().map(super::SpeciesColumn::labels).transpose()?;
    let given = GivenPositions { positions: file.positions, radii: file.radii, species, ..GivenPositions::default() };
    Ok(Fitted { given, notes })
}

/// Box of the disks; its third edge has no meaning.
fn box_of_disks(parameters: &disks::DiskParameters) -> SceneBox {
    let [length, height] = parameters.edges;
    let shape = BoxShape::Sheared(Vector::new(length, height, 1.0), parameters.strain);
    SceneBox { shape, axes: [BoxAxis::Periodic, BoxAxis::Periodic, BoxAxis::Open] }
}

/// Box of a model in the axes of the user.
fn box_of_model(model: &Model) -> SceneBox {
    let (cell, axes) = (&model.cell, model.user_axes());
    let kinds = [0, 1, 2].map(|axis| match cell.boundaries() {
        _ if cell.is_periodic(axis) => BoxAxis::Periodic,
        Boundaries::Walls => BoxAxis::Walls,
        _ => BoxAxis::Open,
    });
    let edges = Vector::from_array(axes.list(cell.edges().to_array()));
    let shape = match cell.axes() {
        Some(_) => BoxShape::Lattice(cell.lattice_vectors()),
        None if cell.boundaries() == Boundaries::Periodic => BoxShape::Sheared(edges, cell.strain()),
        None => BoxShape::Straight(edges),
    };
    debug_assert!(cell.boundaries() != Boundaries::Periodic || axes.turn() == AxisRotation::default());
    SceneBox { shape, axes: axes.list(kinds) }
}

fn check_strain(cell: &FileBox, scene: &SceneBox, expected: f64) -> Result<(), String> {
    let found = cell.strain_in(scene)?;
    match scene.shape {
        BoxShape::Sheared(edges, _) if !is_same_strain(found, expected, edges) => Err(format!(
            "its box has a strain of {}, but box.strain of the scene is {}; leave box.strain out to take that of the \
             file",
            Number(found),
            Number(expected)
        )),
        _ => Ok(()),
    }
}

/// A note about a box that is not periodic along axes along which that of the scene is.
fn without_period(cell: &FileBox, scene: &SceneBox) -> Option<String> {
    let differs = |&axis: &usize| scene.axes[axis] == BoxAxis::Periodic && !cell.periodic[axis];
    let axes: Vec<&str> = (0..3).filter(differs).map(|axis| ["x", "y", "z"][axis]).collect();
    (!axes.is_empty())
        .then(|| format!("its box does not repeat along {}; there the period is that of the scene", axes.join(" and ")))
}

/// Shifts particles so that their box begins at zero, except along open axes; returns a note if they were shifted.
fn moved(positions: &mut [Vector], cell: &FileBox, scene: &SceneBox) -> Option<String> {
    let part = |axis: usize| if scene.axes[axis] == BoxAxis::Open { 0.0 } else { cell.origin[axis] };
    let origin = Vector::new(part(0), part(1), part(2));
    if origin == Vector::ZERO {
        return None;
    }
    for position in positions {
        *position -= origin;
    }
    let corner = origin.to_array().map(|x| Number(x).to_string()).join(", ");
    Some(format!("positions are counted from the corner of its box, ({corner})"))
}

/// Unwraps the positions along open axes; along the other axes images are equivalent.
fn add_images(file: &mut StartFile, scene: &SceneBox) {
    let (Some(images), Some(cell)) = (&file.images, &file.cell) else { return };
    for axis in (0..3).filter(|&axis| scene.axes[axis] == BoxAxis::Open) {
        for (position, steps) in file.positions.iter_mut().zip(images) {
            *position += cell.vectors[axis] * f64::from(steps[axis]);
        }
    }
}

/// Species of all spheres, from their names or numbers, or from their radii if the file has only these and the radii
/// of all species differ; `None` if they follow from the order of rows.
fn species(file: &mut StartFile, all: &[Species], notes: &mut Vec<String>) -> Result<Option<Vec<u32>>, String> {
    let found = match file.species.take() {
        Some(kinds) => {
            let (found, note) = kinds.assigned(all)?;
            notes.extend(note);
            found
        }
        None if all.len() > 1 => by_radius(file, all, notes)?,
        None => None,
    };
    check_radii(file, all, found.as_deref())?;
    Ok(found)
}

fn is_same_radius(radius: f64, species: &Species) -> bool {
    (radius - species.radius).abs() <= ROUNDING * species.radius
}

fn by_radius(file: &StartFile, all: &[Species], notes: &mut Vec<String>) -> Result<Option<Vec<u32>>, String> {
    let distinct = (0..all.len()).all(|one| !all[..one].iter().any(|s| is_same_radius(s.radius, &all[one])));
    let Some(radii) = file.radii.as_ref().filter(|_| distinct) else {
        notes.push("it has no species; rows are of those of the scene by their order and counts".to_owned());
        return Ok(None);
    };
    notes.push("it has no species; they are told by their radii".to_owned());
    let find = |&radius: &f64| all.iter().position(|s| is_same_radius(radius, s)).map(|place| place as u32);
    let unknown = |radius: &f64| {
        let known = all.iter().map(|s| Number(s.radius).to_string()).collect::<Vec<_>>().join(", ");
        format!(
            "it has a particle of radius {}, but the radii of the scene's species are {}",
            Number(*radius),
            excerpt(&known)
        )
    };
    radii.iter().map(|radius| find(radius).ok_or_else(|| unknown(radius))).collect::<Result<_, _>>().map(Some)
}

/// Radii must be those of the species.
fn check_radii(file: &StartFile, all: &[Species], species: Option<&[u32]>) -> Result<(), String> {
    let Some(radii) = &file.radii else { return Ok(()) };
    let counted =
        || all.iter().flat_map(|s| std::iter::repeat_n(s, s.count.unwrap_or(0) as usize)).take(radii.len()).collect();
    let of_rows: Vec<&Species> = match (species, all) {
        (Some(species), _) => species.iter().map(|&place| &all[place as usize]).collect(),
        (None, [only]) => vec![only; radii.len()],
        // Wrong numbers of spheres are refused elsewhere.
        (None, _) => counted(),
    };
    match radii.iter().zip(of_rows).enumerate().find(|(_, (radius, species))| !is_same_radius(**radius, species)) {
        Some((row, (radius, species))) => Err(format!(
            "particle {row} has the radius {}, but the radius of species \"{}\" is {} in the scene; make them equal",
            Number(*radius),
            species.name,
            Number(species.radius)
        )),
        None => Ok(()),
    }
}
