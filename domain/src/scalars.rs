//! Scalars of a state: numbers of a run as a whole, beside the columns of its particles.

use crate::Comm;

/// Named numbers that belong to a state as a whole, such as the strain of a flow or the length of the next step. All
/// ranks hold the same values. Checkpoints store them bit for bit.
///
/// ```
/// let mut scalars = domain::Scalars::default();
/// scalars.set("pump strokes", &[3.0]);
/// assert_eq!(scalars.numbers("pump strokes"), Some([3.0]));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scalars {
    /// In the order of the names.
    list: Vec<Scalar>,
}

/// A name with its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// Name in checkpoints.
    pub name: String,
    /// Numbers.
    pub values: Vec<f64>,
}

impl Scalars {
    /// The numbers of a name.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        self.place(name).ok().map(|place| &self.list[place].values[..])
    }

    /// The numbers of a name, if there are `N` of them.
    pub fn numbers<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        self.get(name)?.try_into().ok()
    }

    /// Sets the numbers of a name. Every rank sets the same.
    pub fn set(&mut self, name: &str, values: &[f64]) {
        match self.place(name) {
            Ok(place) => self.list[place].values = values.to_vec(),
            Err(place) => self.list.insert(place, Scalar { name: name.to_owned(), values: values.to_vec() }),
        }
    }

    /// Place of a name in the list, or the one at which it would be.
    fn place(&self, name: &str) -> Result<usize, usize> {
        self.list.binary_search_by(|scalar| scalar.name.as_str().cmp(name))
    }

    /// Removes all scalars except those whose names are wanted.
    pub fn retain(&mut self, wanted: impl Fn(&str) -> bool) {
        self.list.retain(|scalar| wanted(&scalar.name));
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All scalars, in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = &Scalar> {
        self.list.iter()
    }

    /// Gives all ranks the scalars of the first one. Collective.
    pub fn share(&mut self, comm: &Comm) {
        let names: Vec<String> = self.list.iter().map(|s| format!("{} {}", s.values.len(), s.name)).collect();
        let names = comm.broadcast_text(&names.join("\n"));
        let mut values: Vec<f64> = self.list.iter().flat_map(|scalar| scalar.values.iter().copied()).collect();
        comm.broadcast(&mut values);
        let mut rest = values.into_iter();
        let of_line = |line: &str| {
            let (count, name) = line.split_once(' ').expect("written above");
            let count = count.parse().expect("written above");
            Scalar { name: name.to_owned(), values: rest.by_ref().take(count).collect() }
        };
        self.list = names.lines().map(of_line).collect();
    }
}

impl FromIterator<Scalar> for Scalars {
    fn from_iter<I: IntoIterator<Item = Scalar>>(scalars: I) -> Self {
        let mut all = Self::default();
        scalars.into_iter().for_each(|scalar| all.set(&scalar.name, &scalar.values));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_rank_shares_its_scalars_bit_for_bit() {
        let mut whole = Scalars::default();
        whole.set("strain", &[1.0 / 3.0, -0.0]);
        whole.set("none", &[]);
        whole.set("a count", &[5e-324]);
        whole.set("a count", &[7.0]);
        for found in Comm::threads(3, |comm| {
            let mut own = if comm.is_first() { whole.clone() } else { Scalars::default() };
            own.set(if comm.is_first() { "more" } else { "of this rank" }, &[f64::from(comm.rank() as u32)]);
            own.share(&comm);
            own
        }) {
            assert_eq!(found.numbers("strain").map(|[_, zero]| f64::to_bits(zero)), Some((-0.0_f64).to_bits()));
            let names: Vec<&str> = found.iter().map(|scalar| &scalar.name[..]).collect();
            assert_eq!(names, ["a count", "more", "none", "strain"]);
            assert_eq!((found.get("none"), found.numbers("more")), (Some(&[][..]), Some([0.0])));
            assert_eq!((found.numbers::<2>("a count"), found.numbers::<1>("a count")), (None, Some([7.0])));
        }
    }
}
