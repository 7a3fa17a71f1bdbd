//! Positions in text.

use domain::GivenPositions;
use domain::Vector;

/// Comma-separated values under a line of names; lines that start with # are skipped.
pub(super) fn csv(text: &str) -> Result<GivenPositions, String> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let names: Vec<&str> = lines.next().ok_or("it is empty")?.1.split(',').map(str::trim).collect();
    let place = |name: &str| names.iter().position(|n| *n == name);
    let required = |name: &str| place(name).ok_or(format!("it has no column {name}; its first line names x, y, z"));
    let columns = Columns {
        position: [required("x")?, required("y")?, required("z")?],
        radius: place("radius"),
        species: place("species"),
    };
    columns.read(lines.map(|(number, line)| (number + 1, line.split(',').map(str::trim).collect())))
}

/// Extended XYZ: the number of particles, a line with `Properties=name:type:columns:...`, and a line for each.
pub(super) fn extended_xyz(text: &str) -> Result<GivenPositions, String> {
    let mut lines = text.lines().enumerate();
    let count = lines.next().and_then(|(_, line)| line.trim().parse::<usize>().ok());
    let count = count.ok_or("its first line is not the number of particles")?;
    let header = lines.next().map(|(_, line)| line).unwrap_or_default();
    let columns = properties(header)?;
    let rows = lines.take(count).map(|(number, line)| (number + 1, line.split_whitespace().collect()));
    let placed = columns.read(rows)?;
    let found = placed.positions.len();
    if found == count { Ok(placed) } else { Err(format!("it has {found} particles, its first line says {count}")) }
}

/// Where each property stands; plain XYZ has a name and three coordinates.
fn properties(header: &str) -> Result<Columns, String> {
    let Some((_, list)) = header.split_once("Properties=") else {
        return Ok(Columns { position: [1, 2, 3], radius: None, species: None });
    };
    let list = list.trim_start_matches('"').split([' ', '"']).next().unwrap_or_default();
    let parts: Vec<&str> = list.split(':').collect();
    let (mut column, mut position, mut radius, mut species) = (0, None, None, None);
    for property in parts.chunks_exact(3) {
        match property[0] {
            "pos" => position = Some([column, column + 1, column + 2]),
            "radius" => radius = Some(column),
            "species" if property[1] == "I" => species = Some(column),
            _ => {}
        }
        let wide =
            property[2].parse::<u16>().map_err(|_| format!("its Properties {list} are not name:type:columns"))?;
        column += usize::from(wide);
    }
    Ok(Columns { position: position.ok_or("its Properties have no pos:R:3")?, radius, species })
}

/// A species as a table writes it, perhaps as 1.0.
fn species_of(number: f64) -> Option<u32> {
    let species = number as u32;
    (f64::from(species).total_cmp(&number).is_eq() || number == 0.0).then_some(species)
}

struct Columns {
    position: [usize; 3],
    radius: Option<usize>,
    species: Option<usize>,
}

impl Columns {
    fn read<'a>(&self, rows: impl Iterator<Item = (usize, Vec<&'a str>)>) -> Result<GivenPositions, String> {
        let mut placed = GivenPositions {
            radii: self.radius.map(|_| vec![]),
            species: self.species.map(|_| vec![]),
            ..GivenPositions::default()
        };
        for (line, cells) in rows {
            let number = |column: usize| {
                let cell = cells.get(column).copied().unwrap_or("nothing");
                cell.parse::<f64>().map_err(|_| format!("line {line} has {cell} where a number should be"))
            };
            let [x, y, z] = self.position;
            placed.positions.push(Vector::new(number(x)?, number(y)?, number(z)?));
            if let (Some(radii), Some(column)) = (&mut placed.radii, self.radius) {
                radii.push(number(column)?);
            }
            if let (Some(species), Some(column)) = (&mut placed.species, self.species) {
                species.push(species_of(number(column)?).ok_or_else(|| {
                    format!("line {line} has species {}; species are whole numbers from 0", cells[column])
                })?);
            }
        }
        Ok(placed)
    }
}
