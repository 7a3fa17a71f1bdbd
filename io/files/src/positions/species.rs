//! Assignment of the species in a file to those of a scene.

use scene::document::excerpt;
use suspension::Species;

/// Species of particles as a file specifies them.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SpeciesColumn {
    /// Numbers from 0, in the order of the scene.
    Indices(Vec<u32>),
    /// Numbers from 1, in the order of the scene.
    Types(Vec<u32>),
    /// Names.
    Names(SpeciesNames),
    /// Numbers from 0 in a run of this program, and the names of its species.
    Recorded { numbers: Vec<u32>, names: Vec<String> },
}

/// Distinct names of species, and the index of each particle's name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SpeciesNames {
    pub(super) list: Vec<String>,
    pub(super) of: Vec<u32>,
    /// Whether they may be arbitrary symbols, as in the first column of plain XYZ.
    pub(super) are_symbols: bool,
}

/// Name that other programs give to particles without a species.
const NOTHING: &str = "X";

/// Species of a scene for each sphere, if the file determines them; and a note on the
/// assignment, if the user should know.
pub(super) type Assignment = (Option<Vec<u32>>, Option<String>);

impl SpeciesColumn {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Indices(numbers) | Self::Types(numbers) | Self::Recorded { numbers, .. } => numbers.len(),
            Self::Names(names) => names.of.len(),
        }
    }

    /// Number of each particle.
    pub(super) fn numbers_mut(&mut self) -> &mut [u32] {
        match self {
            Self::Indices(numbers) | Self::Types(numbers) | Self::Recorded { numbers, .. } => numbers,
            Self::Names(names) => &mut names.of,
        }
    }

    /// Species of the scene for each particle.
    pub(super) fn assigned(self, species: &[Species]) -> Result<Assignment, String> {
        match self {
            Self::Indices(numbers) => indices(numbers, species.len()).map(|numbers| (Some(numbers), None)),
            Self::Types(numbers) => types(numbers, species.len()).map(|numbers| (Some(numbers), None)),
            Self::Names(names) => names.assigned(species),
            Self::Recorded { numbers, names } => recorded(numbers, names, species).map(|numbers| (Some(numbers), None)),
        }
    }

    /// Numbers from 0, where species are mere labels: names are numbered in the order of their first appearance.
    pub(super) fn labels(self) -> Result<Vec<u32>, String> {
        match self {
            Self::Indices(numbers) | Self::Recorded { numbers, .. } => Ok(numbers),
            Self::Types(numbers) => types(numbers, u32::MAX as usize),
            Self::Names(names) => Ok(names.of),
        }
    }
}

fn indices(numbers: Vec<u32>, count: usize) -> Result<Vec<u32>, String> {
    let Some(unknown) = numbers.iter().find(|&&number| number as usize >= count) else { return Ok(numbers) };
    let counts_from_one = if numbers.contains(&0) { "" } else { "; numbers from 1 belong into a column `type`" };
    Err(format!("it has a particle of species {unknown}; the scene has {count} species, from 0{counts_from_one}"))
}

/// Species of a former run by name, if the scene has these names; by number if it has none of them.
fn recorded(numbers: Vec<u32>, names: Vec<String>, species: &[Species]) -> Result<Vec<u32>, String> {
    if names.iter().all(|name| species.iter().all(|s| s.name != *name)) {
        return indices(numbers, species.len());
    }
    let known = SpeciesNames { of: numbers, list: names, are_symbols: false };
    let used = |place: usize| known.of.iter().any(|&number| number as usize == place);
    let place = |name: &String| species.iter().position(|s| s.name == *name).map(|place| place as u32);
    let places: Vec<Option<u32>> = known.list.iter().map(place).collect();
    if places.iter().enumerate().any(|(old, new)| new.is_none() && used(old)) {
        return Err(known.unknown(species));
    }
    let found = known.of.iter().map(|&number| places.get(number as usize).copied().flatten());
    found.collect::<Option<_>>().ok_or_else(|| "it has a particle of a species that its scene does not have".to_owned())
}

fn types(numbers: Vec<u32>, count: usize) -> Result<Vec<u32>, String> {
    match numbers.iter().find(|&&number| number == 0 || number as usize > count) {
        Some(unknown) => Err(format!(
            "it has a particle of type {unknown}; the scene has {count} species, whose types are from 1 on"
        )),
        None => Ok(numbers.into_iter().map(|number| number - 1).collect()),
    }
}

impl SpeciesNames {
    fn assigned(self, species: &[Species]) -> Result<Assignment, String> {
        let place = |name: &String| species.iter().position(|s| s.name == *name).map(|place| place as u32);
        let places: Vec<Option<u32>> = self.list.iter().map(place).collect();
        if let Some(places) = places.iter().copied().collect::<Option<Vec<u32>>>() {
            return Ok((Some(self.of.iter().map(|&name| places[name as usize]).collect()), None));
        }
        if places.iter().any(Option::is_some) {
            return Err(self.unknown(species));
        }
        if let Some(numbers) = self.list.iter().map(|name| name.parse().ok()).collect::<Option<Vec<u32>>>() {
            let found = types(self.of.iter().map(|&name| numbers[name as usize]).collect(), species.len());
            let found = found.map_err(|_| self.unknown(species))?;
            return Ok((
                Some(found),
                Some("its species are numbers from 1 on, in the order of the scene's".to_owned()),
            ));
        }
        self.by_order(species)
    }

    /// Assigns species by the order of rows if the names are unknown to the scene but consistent with that: rows of
    /// one name must be of one species.
    fn by_order(self, species: &[Species]) -> Result<Assignment, String> {
        let is_unnamed = species.iter().enumerate().all(|(index, s)| s.name == format!("{}", index + 1));
        let may_be_symbols = self.are_symbols || is_unnamed || self.list == [NOTHING];
        if !may_be_symbols || !self.fits_order(species) {
            return Err(self.unknown(species));
        }
        let (found, named) = (excerpt(&self.list.join(", ")), names(species));
        let note = match species.len() {
            1 => format!("its name {found} is taken for the scene's species {named}"),
            _ => format!("its names {found} are not those of the scene; rows are of {named} by their order and counts"),
        };
        Ok((None, Some(note)))
    }

    /// Whether rows of one name are of one species and vice versa, if there are several names; rows are assigned to
    /// species by the counts of the scene.
    fn fits_order(&self, species: &[Species]) -> bool {
        if self.list.len() == 1 {
            return true;
        }
        let counts = species.iter().map(|s| s.count).collect::<Option<Vec<u64>>>().unwrap_or_default();
        let ends: Vec<u64> = counts.iter().scan(0, |end, &count| Some(end_after(end, count))).collect();
        if self.list.len() != species.len() || ends.last() != Some(&(self.of.len() as u64)) {
            return false;
        }
        let mut kinds = vec![None; species.len()];
        (0..).zip(&self.of).all(|(row, &name)| {
            let kind = ends.partition_point(|&end| end <= row);
            *kinds[kind].get_or_insert(name) == name
        }) && (0..kinds.len()).all(|kind| !kinds[..kind].contains(&kinds[kind]))
    }

    fn unknown(&self, species: &[Species]) -> String {
        format!(
            "it has particles of the species {}, but those of the scene are {}; give them the same names",
            excerpt(&self.list.join(", ")),
            names(species)
        )
    }
}

fn end_after(end: &mut u64, count: u64) -> u64 {
    *end = end.saturating_add(count);
    *end
}

fn names(species: &[Species]) -> String {
    excerpt(&species.iter().map(|s| s.name.as_str()).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(names: &[&str]) -> Vec<Species> {
        names.iter().map(|name| Species::new(name, 1.0, 2)).collect()
    }

    fn named(rows: &[&str], are_symbols: bool) -> SpeciesColumn {
        let mut list: Vec<String> = Vec::new();
        let mut place = |row: &&str| {
            list.iter().position(|name| name == row).unwrap_or_else(|| {
                list.push((*row).to_owned());
                list.len() - 1
            }) as u32
        };
        let of = rows.iter().map(&mut place).collect();
        SpeciesColumn::Names(SpeciesNames { list, of, are_symbols })
    }

    fn found(rows: &[&str], are_symbols: bool, names: &[&str]) -> Result<Option<Vec<u32>>, String> {
        named(rows, are_symbols).assigned(&scene(names)).map(|(species, _)| species)
    }

    #[test]
    fn names_are_found_whatever_the_order_of_rows() {
        for are_symbols in [true, false] {
            assert_eq!(found(&["B", "A", "B", "A"], are_symbols, &["A", "B"]), Ok(Some(vec![1, 0, 1, 0])));
            assert_eq!(found(&["B", "B"], are_symbols, &["A", "B"]), Ok(Some(vec![1, 1])));
            let message = found(&["A", "C", "A", "C"], are_symbols, &["A", "B"]).unwrap_err();
            assert!(message.contains("species A, C, but those of the scene are A, B"), "{message}");
        }
    }

    /// Symbols that the scene does not have are ignored only if they do not contradict the order of rows.
    #[test]
    fn unknown_symbols_go_by_order_if_that_is_possible() {
        assert_eq!(found(&["C", "C", "O", "O"], true, &["A", "B"]), Ok(None));
        assert_eq!(found(&["X", "X", "X", "X"], false, &["A", "B"]), Ok(None));
        assert_eq!(found(&["Ar"], false, &["1"]), Ok(None));
        assert!(found(&["C", "O", "C", "O"], true, &["A", "B"]).is_err());
        assert!(found(&["C", "C", "C", "O"], true, &["A", "B"]).is_err());
        assert!(found(&["C", "C", "O", "N"], true, &["A", "B"]).is_err());
        assert!(found(&["C", "C", "O", "O", "C", "C"], true, &["A", "B", "D"]).is_err());
        assert!(found(&["C", "O"], true, &["A"]).is_err());
        assert!(found(&["C", "C", "O", "O"], false, &["A", "B"]).is_err());
        assert!(found(&["C", "C"], false, &["A"]).is_err());
    }

    #[test]
    fn numbers_as_names_are_types() {
        assert_eq!(found(&["2", "1"], false, &["A", "B"]), Ok(Some(vec![1, 0])));
        assert_eq!(found(&["2", "1"], false, &["2", "1"]), Ok(Some(vec![0, 1])), "names come first");
        assert!(found(&["0", "1"], false, &["A", "B"]).is_err());
    }

    #[test]
    fn species_of_a_former_run_keep_their_names_or_else_their_numbers() {
        let names = ["A", "B", "gone"].map(str::to_owned).to_vec();
        let of = |numbers: &[u32], scene: &[Species]| {
            let kinds = SpeciesColumn::Recorded { numbers: numbers.to_vec(), names: names.clone() };
            kinds.assigned(scene).map(|(species, _)| species.unwrap())
        };
        assert_eq!(of(&[0, 1, 0], &scene(&["B", "A"])), Ok(vec![1, 0, 1]));
        assert_eq!(of(&[0, 1, 0], &scene(&["C", "D"])), Ok(vec![0, 1, 0]));
        assert!(of(&[0, 1, 0], &scene(&["A", "D"])).unwrap_err().contains("of the species A, B, gone"));
        assert!(of(&[0, 3], &scene(&["A", "B"])).unwrap_err().contains("does not have"));
        assert!(of(&[0, 2], &scene(&["C", "D"])).unwrap_err().contains("species 2"));
    }

    #[test]
    fn numbers_beyond_the_species_are_refused() {
        let species = scene(&["A", "B"]);
        let of = |kinds: SpeciesColumn| kinds.assigned(&species).map(|(species, _)| species.unwrap());
        assert_eq!(of(SpeciesColumn::Indices(vec![1, 0])), Ok(vec![1, 0]));
        assert_eq!(of(SpeciesColumn::Types(vec![2, 1])), Ok(vec![1, 0]));
        let message = of(SpeciesColumn::Indices(vec![1, 2])).unwrap_err();
        assert!(message.contains("species 2; the scene has 2 species, from 0; numbers from 1"), "{message}");
        assert!(of(SpeciesColumn::Types(vec![1, 3])).unwrap_err().contains("type 3"));
        assert!(of(SpeciesColumn::Types(vec![0])).is_err());
        assert_eq!(SpeciesColumn::Types(vec![3, 1]).labels(), Ok(vec![2, 0]));
    }
}
