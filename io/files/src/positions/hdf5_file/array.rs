//! Arrays of HDF5 files, read strictly: numbers, shapes and names are as stored, or refused.

use crate::frames::one_of;
use crate::positions::species::{SpeciesColumn, SpeciesNames};
use crate::{claimed_size, verified};
use domain::{Quaternion, Vector};
use hdf5::types::{EnumType, FixedAscii, FixedUnicode, FloatSize, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{Dataset, H5Type, Selection};
use ndarray::IxDyn;
use std::collections::HashMap;

/// Largest number of letters of a fixed-length name.
const LONGEST_NAME: usize = 256;
/// Whole numbers up to this one are exact in double precision.
const LARGEST_EXACT: f64 = 9_007_199_254_740_992.0;

/// A dataset, or the value of one frame in it.
pub(super) struct Array {
    pub(super) dataset: Dataset,
    /// The frame, if the dataset has frames.
    pub(super) frame: Option<usize>,
}

impl Array {
    /// A dataset that is the same for all frames.
    pub(super) fn fixed(dataset: Dataset) -> Result<Self, String> {
        claimed_size::check(&dataset).and_then(|()| verified::verify(&dataset)).map_err(words)?;
        Ok(Self { dataset, frame: None })
    }

    /// The value of a frame.
    pub(super) fn of_frame(dataset: Dataset, frame: usize) -> Result<Self, String> {
        claimed_size::check(&dataset).map_err(words)?;
        Ok(Self { dataset, frame: Some(frame) })
    }

    pub(super) fn name(&self) -> String {
        self.dataset.name().trim_start_matches('/').to_owned()
    }

    /// Shape, without the dimension of frames.
    pub(super) fn shape(&self) -> Vec<usize> {
        let shape = self.dataset.shape();
        if self.frame.is_some() { shape.get(1..).unwrap_or_default().to_vec() } else { shape }
    }

    /// Real numbers, which may be stored as integers.
    pub(super) fn numbers(&self) -> Result<Vec<f64>, String> {
        let kind = self.kind()?;
        if !matches!(kind, TypeDescriptor::Float(_) | TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_)) {
            return Err(format!("{} has {}, where numbers are needed", self.name(), in_words(&kind)));
        }
        let numbers = self.raw::<f64>()?;
        if !matches!(kind, TypeDescriptor::Float(_)) && numbers.iter().any(|number| number.abs() > LARGEST_EXACT) {
            return Err(format!(
                "{} has whole numbers beyond 2^53, which are not exact; store it as floats",
                self.name()
            ));
        }
        Ok(numbers)
    }

    /// Numbers in rows of three, one row per particle.
    pub(super) fn vectors(&self) -> Result<Vec<Vector>, String> {
        let shape = self.shape();
        let [_, 3] = shape[..] else { return Err(self.refused_shape(&shape)) };
        Ok(self.numbers()?.chunks_exact(3).map(Vector::from_slice).collect())
    }

    fn refused_shape(&self, shape: &[usize]) -> String {
        let found = format!("{} has the shape {}, but positions need (N, 3)", self.name(), shape_in_words(shape));
        let advice = match shape {
            [3, n] => format!(
                ": it is likely (3, N), as Julia, MATLAB and Fortran write arrays of {n} x 3; transpose it before it \
                 is written"
            ),
            [2, _] | [_, 2] => ": it has two coordinates; add a third".to_owned(),
            [n] if n % 3 == 0 => ": it is a flat list; write it with a row for each particle".to_owned(),
            [_, _, 3] => ": frames belong into the H5MD format, or write one of them alone".to_owned(),
            [_, 3, _] => {
                ": it is likely (3, N) for each frame, as Julia, MATLAB and Fortran write arrays; transpose it"
                    .to_owned()
            }
            _ => String::new(),
        };
        found + &advice
    }

    /// One number per particle, or one for all `count`.
    pub(super) fn one_each(&self, count: usize) -> Result<Vec<f64>, String> {
        match self.shape()[..] {
            [] | [1] => match self.numbers()?[..] {
                [only] => Ok(vec![only; count]),
                _ => Err(format!("{} has no number", self.name())),
            },
            [n] if n == count => self.numbers(),
            _ => Err(self.not_one_each(count)),
        }
    }

    fn not_one_each(&self, count: usize) -> String {
        let shape = shape_in_words(&self.shape());
        format!("{} has the shape {shape}; it needs ({count},), one for each of {count} positions", self.name())
    }

    /// Lattice steps in rows of three.
    pub(super) fn steps(&self, count: usize) -> Result<Vec<[i32; 3]>, String> {
        let shape = self.shape();
        if shape != [count, 3] {
            return Err(format!("{} has the shape {}; it needs ({count}, 3)", self.name(), shape_in_words(&shape)));
        }
        let whole = |number: f64| {
            let found = number as i32;
            f64::from(found).total_cmp(&(number + 0.0)).is_eq().then_some(found)
        };
        let steps: Option<Vec<i32>> = self.numbers()?.into_iter().map(whole).collect();
        let steps = steps.ok_or_else(|| format!("{} has numbers that are not whole", self.name()))?;
        Ok(steps.chunks_exact(3).map(|row| [row[0], row[1], row[2]]).collect())
    }

    /// Quaternions `w, x, y, z`, one per particle.
    pub(super) fn orientations(&self, count: usize) -> Result<Vec<Quaternion>, String> {
        let shape = self.shape();
        if shape != [count, 4] {
            return Err(format!("{} has the shape {}; it needs ({count}, 4)", self.name(), shape_in_words(&shape)));
        }
        Ok(self.numbers()?.chunks_exact(4).map(|q| Quaternion::from_array([q[0], q[1], q[2], q[3]])).collect())
    }

    /// Non-negative integers, one per particle.
    pub(super) fn ids(&self, count: usize) -> Result<Vec<u64>, String> {
        let whole = |number: f64| (number >= 0.0 && number.fract() == 0.0).then_some(number as u64);
        if self.shape() != [count] {
            return Err(self.not_one_each(count));
        }
        let ids: Option<Vec<u64>> = self.numbers()?.into_iter().map(whole).collect();
        ids.ok_or_else(|| format!("{} has numbers that are not whole, or below 0", self.name()))
    }

    /// Species, as non-negative integers or by name: one per particle, or one for all `count`.
    pub(super) fn kinds(&self, count: usize) -> Result<SpeciesColumn, String> {
        let kinds = match self.kind()? {
            TypeDescriptor::Enum(names) => self.enumerated(&names)?,
            TypeDescriptor::VarLenUnicode => named(&self.raw::<VarLenUnicode>()?),
            TypeDescriptor::VarLenAscii => named(&self.raw::<VarLenAscii>()?),
            TypeDescriptor::FixedAscii(_) => named(&self.raw::<FixedAscii<LONGEST_NAME>>()?),
            TypeDescriptor::FixedUnicode(_) => named(&self.raw::<FixedUnicode<LONGEST_NAME>>()?),
            _ => {
                let whole = |number: f64| {
                    let found = number as u32;
                    (number >= 0.0 && f64::from(found).total_cmp(&(number + 0.0)).is_eq()).then_some(found)
                };
                let numbers: Option<Vec<u32>> = self.numbers()?.into_iter().map(whole).collect();
                let wrong = || format!("{} has numbers that are no species; these are whole, from 0 on", self.name());
                SpeciesColumn::Indices(numbers.ok_or_else(wrong)?)
            }
        };
        self.for_each(kinds, count)
    }

    /// The same species for each of `count` particles if there is only one.
    fn for_each(&self, mut kinds: SpeciesColumn, count: usize) -> Result<SpeciesColumn, String> {
        match (self.shape().as_slice(), kinds.numbers_mut()) {
            ([] | [1], [only]) => {
                let all = vec![*only; count];
                match &mut kinds {
                    SpeciesColumn::Indices(numbers)
                    | SpeciesColumn::Types(numbers)
                    | SpeciesColumn::Recorded { numbers, .. } => *numbers = all,
                    SpeciesColumn::Names(names) => names.of = all,
                }
                Ok(kinds)
            }
            ([n], _) if *n == count => Ok(kinds),
            _ => Err(self.not_one_each(count)),
        }
    }

    /// Names of an enumeration.
    fn enumerated(&self, names: &EnumType) -> Result<SpeciesColumn, String> {
        let place = |value: i64| names.members.iter().position(|member| member.value as i64 == value);
        let of: Option<Vec<u32>> = self.raw::<i64>()?.into_iter().map(|value| Some(place(value)? as u32)).collect();
        let of = of.ok_or_else(|| format!("{} has a number that its enumeration does not name", self.name()))?;
        let mut used = vec![false; names.members.len()];
        for &place in &of {
            used[place as usize] = true;
        }
        let mut numbers = vec![0; used.len()];
        let mut list = Vec::new();
        for (place, member) in names.members.iter().enumerate().filter(|(place, _)| used[*place]) {
            numbers[place] = list.len() as u32;
            list.push(member.name.clone());
        }
        let of = of.into_iter().map(|place| numbers[place as usize]).collect();
        Ok(SpeciesColumn::Names(SpeciesNames { list, of, are_symbols: false }))
    }

    fn kind(&self) -> Result<TypeDescriptor, String> {
        let kind = self.dataset.dtype().and_then(|kind| kind.to_descriptor());
        kind.map_err(|e| format!("{} has values of a type that is not known here: {e}", self.name()))
    }

    fn raw<T: H5Type>(&self) -> Result<Vec<T>, String> {
        let chosen = self.frame.map_or_else(|| Selection::from(..), |frame| one_of(frame, self.dataset.ndim()));
        let read = if self.dataset.ndim() == 0 {
            self.dataset.read_raw::<T>()
        } else {
            self.dataset.read_slice::<T, _, IxDyn>(chosen).map(|values| values.into_raw_vec_and_offset().0)
        };
        read.map_err(|e| format!("{}: {e}", self.name()))
    }
}

#[expect(clippy::needless_pass_by_value, reason = "results pass their errors on")]
pub(super) fn words(error: hdf5::Error) -> String {
    error.to_string()
}

fn shape_in_words(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Distinct names, and the index of each particle's name.
fn named<T: AsRef<str>>(rows: &[T]) -> SpeciesColumn {
    let (mut list, mut of, mut places) = (Vec::new(), Vec::new(), HashMap::new());
    for row in rows {
        let name = row.as_ref().trim_end_matches('\0');
        of.push(*places.entry(name).or_insert_with(|| {
            list.push(name.to_owned());
            list.len() as u32 - 1
        }));
    }
    SpeciesColumn::Names(SpeciesNames { list, of, are_symbols: false })
}

fn in_words(kind: &TypeDescriptor) -> &'static str {
    match kind {
        TypeDescriptor::Compound(fields) if fields.fields.len() == 2 && is_float(&fields.fields[0].ty) => {
            "complex numbers, or pairs of them"
        }
        TypeDescriptor::Boolean => "values true or false",
        TypeDescriptor::Enum(_) => "names of an enumeration",
        TypeDescriptor::FixedAscii(_)
        | TypeDescriptor::FixedUnicode(_)
        | TypeDescriptor::VarLenAscii
        | TypeDescriptor::VarLenUnicode => "text",
        _ => "values of several parts",
    }
}

fn is_float(kind: &TypeDescriptor) -> bool {
    matches!(kind, TypeDescriptor::Float(FloatSize::U4 | FloatSize::U8))
}
