//! Columns of a table of particles.

use super::number::{NumberParser, whole};
use crate::positions::StartFile;
use crate::positions::species::{SpeciesColumn, SpeciesNames};
use domain::{Quaternion, Vector};
use scene::document::excerpt;
use std::borrow::Cow;
use std::collections::HashMap;

/// Column numbers of the quantities.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColumnNumbers {
    pub(super) position: [usize; 3],
    pub(super) images: Option<[usize; 3]>,
    /// Column of the size, and the factor from it to the radius.
    pub(super) radius: Option<(usize, f64)>,
    pub(super) species: Option<(usize, Labels)>,
    pub(super) id: Option<usize>,
    /// Columns of the components `w, x, y, z` of orientations.
    pub(super) orientation: Option<[usize; 4]>,
}

/// Names of the components `w, x, y, z` of orientations: in tables, in dumps of LAMMPS, and of a property of XYZ, which
/// has the scalar last.
const ORIENTATIONS: [[&str; 4]; 3] = [
    ["orientation_w", "orientation_x", "orientation_y", "orientation_z"],
    ["quatw", "quati", "quatj", "quatk"],
    ["orientation 3", "orientation 0", "orientation 1", "orientation 2"],
];

/// Meaning of the entries in a species column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Labels {
    /// Whole numbers from 0.
    Indices,
    /// Whole numbers from 1.
    Types,
    /// Names.
    Names,
    /// Names that may be arbitrary symbols.
    Symbols,
    /// Names, or whole numbers from 0 if all are numbers.
    NamesOrIndices,
}

/// A line of a table, and its number from 1.
pub(super) struct TableLine<'a> {
    pub(super) line: usize,
    pub(super) cells: Vec<Cow<'a, str>>,
}

/// The columns `x`, `y`, `z`, `radius` or `diameter`, `species` or `type`, `id` and orientations, from names in lower
/// case.
pub(super) fn named(names: &[String], coordinates: [&str; 3], species: Labels) -> Result<ColumnNumbers, String> {
    let place = |name: &str| unique(names, name);
    let required = |name: &str| place(name)?.ok_or_else(|| format!("it has no column {name}"));
    let scaled = |name: &str, factor: f64| Ok::<_, String>(place(name)?.map(|column| (column, factor)));
    let labelled = |name: &str, labels: Labels| Ok::<_, String>(place(name)?.map(|column| (column, labels)));
    let [x, y, z] = coordinates;
    let image = [place("ix")?, place("iy")?, place("iz")?];
    Ok(ColumnNumbers {
        position: [required(x)?, required(y)?, required(z)?],
        images: if let [Some(x), Some(y), Some(z)] = image { Some([x, y, z]) } else { None },
        radius: scaled("radius", 1.0)?.or(scaled("diameter", 0.5)?),
        species: labelled("species", species)?.or(labelled("type", Labels::Types)?),
        id: place("id")?,
        orientation: orientation(names)?,
    })
}

/// Columns of orientations, if there are all of their components under some names.
fn orientation(names: &[String]) -> Result<Option<[usize; 4]>, String> {
    let mut found = None;
    for components in ORIENTATIONS {
        let [w, x, y, z] = components.map(|name| unique(names, name));
        if let (Some(w), Some(x), Some(y), Some(z)) = (w?, x?, y?, z?) {
            found = found.or(Some([w, x, y, z]));
        }
    }
    Ok(found)
}

/// Column of a name that must not occur twice.
fn unique(names: &[String], name: &str) -> Result<Option<usize>, String> {
    let mut places = (0..names.len()).filter(|&place| names[place] == name);
    let first = places.next();
    match places.next() {
        Some(_) => Err(format!("it has two columns {name}; leave one of them out")),
        None => Ok(first),
    }
}

impl ColumnNumbers {
    /// Reads the particles of rows that have all cells.
    pub(super) fn read<'a>(
        &self,
        rows: impl Iterator<Item = Result<TableLine<'a>, String>>,
        mut numbers: NumberParser,
    ) -> Result<StartFile, String> {
        let mut file = StartFile {
            radii: self.radius.map(|_| vec![]),
            images: self.images.map(|_| vec![]),
            ids: self.id.map(|_| vec![]),
            orientations: self.orientation.map(|_| vec![]),
            ..StartFile::default()
        };
        let mut labels = Labelled::default();
        for row in rows {
            let row = row?;
            let [x, y, z] = self.position.map(|column| numbers.parse(row.line, &row.cells[column]));
            file.positions.push(Vector::new(x?, y?, z?));
            if let (Some(radii), Some((column, factor))) = (&mut file.radii, self.radius) {
                radii.push(factor * numbers.parse(row.line, &row.cells[column])?);
            }
            if let (Some(images), Some(columns)) = (&mut file.images, self.images) {
                let [x, y, z] = columns.map(|column| integer::<i32>(&row, column, "an image"));
                images.push([x?, y?, z?]);
            }
            if let (Some(ids), Some(column)) = (&mut file.ids, self.id) {
                ids.push(integer(&row, column, "an id")?);
            }
            if let (Some(orientations), Some(columns)) = (&mut file.orientations, self.orientation) {
                let [w, x, y, z] = columns.map(|column| numbers.parse(row.line, &row.cells[column]));
                orientations.push(Quaternion::from_array([w?, x?, y?, z?]));
            }
            if let Some((column, _)) = self.species {
                labels.add(&row, column)?;
            }
        }
        file.species = self.species.map(|(_, meaning)| labels.kinds(meaning)).transpose()?;
        Ok(file)
    }
}

fn integer<T: std::str::FromStr>(row: &TableLine, column: usize, what: &str) -> Result<T, String> {
    let cell = &row.cells[column];
    cell.parse().map_err(|_| format!("line {} has {} where {what} should be", row.line, excerpt(cell)))
}

/// Distinct labels with the line of their first appearance, and the index of each particle's label.
#[derive(Default)]
struct Labelled {
    list: Vec<(String, usize)>,
    places: HashMap<String, u32>,
    of: Vec<u32>,
}

impl Labelled {
    fn add(&mut self, row: &TableLine, column: usize) -> Result<(), String> {
        let label = row.cells[column].as_ref();
        if label.is_empty() {
            return Err(format!("line {} has no species; each particle needs one", row.line));
        }
        let place = self.places.get(label).copied().unwrap_or_else(|| {
            self.list.push((label.to_owned(), row.line));
            self.places.insert(label.to_owned(), self.list.len() as u32 - 1);
            self.list.len() as u32 - 1
        });
        self.of.push(place);
        Ok(())
    }

    fn kinds(self, meaning: Labels) -> Result<SpeciesColumn, String> {
        let are_numbers = self.list.iter().all(|(label, _)| label.parse::<f64>().is_ok());
        match meaning {
            Labels::Indices => self.numbers(0).map(SpeciesColumn::Indices),
            Labels::Types => self.numbers(1).map(SpeciesColumn::Types),
            Labels::NamesOrIndices if are_numbers => self.numbers(0).map(SpeciesColumn::Indices),
            _ => {
                let list = self.list.into_iter().map(|(label, _)| label).collect();
                Ok(SpeciesColumn::Names(SpeciesNames { list, of: self.of, are_symbols: meaning == Labels::Symbols }))
            }
        }
    }

    fn numbers(&self, first: u32) -> Result<Vec<u32>, String> {
        let (name, names) = if first == 0 { ("species", "species") } else { ("type", "types") };
        let number = |(label, line): &(String, usize)| {
            let found = label.parse().ok().and_then(whole).filter(|&number| number >= first);
            found.ok_or_else(|| {
                format!("line {line} has {name} {}; {names} are whole numbers from {first}", excerpt(label))
            })
        };
        let numbers: Vec<u32> = self.list.iter().map(number).collect::<Result<_, _>>()?;
        Ok(self.of.iter().map(|&place| numbers[place as usize]).collect())
    }
}
