//! From neighbour lists to the resistance of near pairs.

use super::lanes::{LANES, Lanes, turn};
use super::pair_matrix::{Group, MomentGroup, Part, ROWS, Slice};
use super::row_sums::{InStrain, Sums};
use super::row_view::RowView;
use super::screw::Screw;
use super::springs::Springs;
use super::stiffness::Stiffness;
use super::touching::Touching;
use domain::{Neighbour, Neighbours, PeriodicBox, Traceless, Vector};
use lubrication::{Arithmetic, Coefficients, PairForce, RECORD};
use solver::simd::{Vector as Width, Work};

/// The particles present and who is near whom.
pub struct Arrangement<'a> {
    pub lubrication: Option<(&'a PairForce, &'a Stiffness)>,
    pub springs: Option<&'a Springs<'a>>,
    /// Radii by species.
    pub radii: &'a [f64],
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    pub ids: &'a [u64],
    pub species: &'a [u32],
    pub neighbours: &'a Neighbours,
    /// The ambient rate of strain at `z = 0`, and by how much its xz component grows with z.
    pub ambient: Traceless,
    pub slope: f64,
}

/// Rows of a rank's particles: their stiff pairs, the others, and their loads and moments by all of them in the ambient
/// flow if they do not move relative to it.
pub struct Assembled {
    pub stiff: Part,
    pub soft: Part,
    pub loads: Vec<Screw>,
    pub moments: Vec<Traceless>,
}

/// The rows of one part, from `first` on, of so many particles.
pub struct Assembly<'a> {
    pub arrangement: &'a Arrangement<'a>,
    pub first: usize,
    pub rows: usize,
}

/// The pairs of one kind of the rows of a part, row by row.
struct Listed {
    pairs: Vec<NearPair>,
    /// What springs resist between them, if there are any: along, across, and to rolling.
    springs: Vec<[f64; 3]>,
    /// Where each row's pairs end.
    ends: Vec<usize>,
}

/// A pair of a row: from its particle to the other.
struct NearPair {
    separation: Vector,
    distance: f64,
    /// The height half-way between them.
    height: f64,
    other: u32,
    species: [u32; 2],
    is_lubricated: bool,
}

/// Numbers of a pair: those of its coefficients, 1 where the row's particle is the larger one, and the resistance of its
/// spring along the axis.
const NUMBERS: usize = 48;
const IS_LARGER: usize = RECORD;
const SPRING: usize = RECORD + 1;

/// Pairs of several rows, a lane each.
struct Packed {
    records: [[f64; NUMBERS]; LANES],
    /// Unit vectors from the smaller sphere to the larger.
    axis: [[f64; LANES]; 3],
    /// By how much the xz component of the ambient rate of strain is larger between them.
    sloping: [f64; LANES],
    others: [u32; LANES],
    touching: Touching,
    /// Whether any of them touch.
    touch: bool,
}

impl Work<f64> for Assembly<'_> {
    type Output = Assembled;

    #[inline(always)]
    fn run<V: Width<f64>>(self) -> Assembled {
        let [stiff, soft] = self.listed();
        let mut assembled = Assembled {
            stiff: Part::default(),
            soft: Part::default(),
            loads: vec![Screw::default(); self.rows],
            moments: vec![Traceless::ZERO; self.rows],
        };
        assembled.stiff = self.part::<V>(&stiff, &mut assembled);
        assembled.soft = self.part::<V>(&soft, &mut assembled);
        assembled
    }
}

impl Assembly<'_> {
    /// All rows, in parts.
    pub fn parts(owned: usize) -> usize {
        owned.div_ceil(ROWS)
    }

    /// The stiff pairs and the others.
    #[inline(always)]
    fn listed(&self) -> [Listed; 2] {
        let rows = self.first..self.first + self.rows;
        let most: usize = rows.clone().map(|row| self.arrangement.neighbours.of(row).len()).sum();
        let mut listed = [Listed::with_room(self.rows, most / 4), Listed::with_room(self.rows, most)];
        for row in rows {
            for neighbour in self.arrangement.neighbours.of(row) {
                self.list(row, *neighbour, &mut listed);
            }
            for list in &mut listed {
                list.ends.push(list.pairs.len());
            }
        }
        listed
    }

    /// Appends a row's pair with a neighbour to the stiff ones or the others, if anything acts between them.
    #[inline(always)]
    fn list(&self, row: usize, neighbour: Neighbour, [stiff, soft]: &mut [Listed; 2]) {
        let Arrangement { lubrication, springs, radii, cell, positions, ids, species, .. } = *self.arrangement;
        let other = neighbour.row as usize;
        let mut separation = positions[other] - positions[row];
        if neighbour.steps != [0; 3] {
            separation += cell.lattice(neighbour.steps.map(i32::from));
        }
        let (pair, distance) = ([species[row], species[other]], separation.length());
        let gap = lubrication.and_then(|(force, _)| force.gap(distance, pair));
        let between = |springs: &Springs| springs.between((row, ids[other]), distance, pair.map(|s| radii[s as usize]));
        let resisted = springs.map(between);
        let spring = resisted.map_or(0.0, |[along, ..]| along);
        if gap.is_none() && spring == 0.0 {
            return;
        }
        let holds = |(_, stiffness): (&PairForce, &Stiffness)| gap.is_some_and(|gap| stiffness.holds(pair, gap));
        let list = if spring > 0.0 || lubrication.is_some_and(holds) { stiff } else { soft };
        let (other, is_lubricated) = (neighbour.row, gap.is_some());
        let height = positions[row].z + 0.5 * separation.z;
        list.pairs.push(NearPair { separation, distance, height, other, species: pair, is_lubricated });
        list.springs.extend(resisted);
    }

    /// Makes rows of pairs of one kind, and adds their loads and moments in the ambient flow.
    #[inline(always)]
    fn part<V: Width<f64>>(&self, listed: &Listed, assembled: &mut Assembled) -> Part {
        let order = listed.order();
        let groups = order.chunks(LANES).map(|rows| listed.of(rows[0]).len()).sum();
        let mut part = Part::with_room(self.rows, groups);
        for rows in order.chunks(LANES) {
            let slice = Slice::new(rows);
            let (mut sums, mut strained) = (Sums::<V>::zero(), InStrain::zero());
            for place in 0..listed.of(rows[0]).len() {
                let packed = self.packed::<V>((listed, rows), place);
                packed.assemble(part.group(), (&mut sums, &mut strained), self.arrangement.ambient);
            }
            part.end_slice(slice, &sums.totals());
            let (loads, moments) = strained.totals();
            for (lane, &row) in rows.iter().enumerate() {
                assembled.loads[row as usize] += loads[lane];
                assembled.moments[row as usize] += moments[lane];
            }
        }
        part
    }

    /// The pairs in a place of the rows' lists.
    #[inline(always)]
    fn packed<V: Width<f64>>(&self, (listed, rows): (&Listed, &[u32]), place: usize) -> Packed {
        let mut packed = Packed::empty((self.first + rows[0] as usize) as u32);
        for (lane, &row) in rows.iter().enumerate() {
            let range = listed.of(row);
            if place < range.len() {
                self.pack::<V>((listed, range.start + place), lane, &mut packed);
            }
        }
        packed
    }

    #[inline(always)]
    fn pack<V: Width<f64>>(&self, (listed, pair): (&Listed, usize), lane: usize, packed: &mut Packed) {
        let NearPair { separation, distance, height, other, species, is_lubricated } = listed.pairs[pair];
        let [own, others] = [self.arrangement.radii[species[0] as usize], self.arrangement.radii[species[1] as usize]];
        let is_larger = own > others;
        let numbers = &mut packed.records[lane];
        if let Some((force, _)) = self.arrangement.lubrication.filter(|_| is_lubricated) {
            let record = numbers.first_chunk_mut().expect("numbers begin with a record");
            force.record::<Lanes<V>>(distance, species, record);
        }
        numbers[IS_LARGER] = f64::from(u8::from(is_larger));
        packed.others[lane] = other;
        packed.sloping[lane] = self.arrangement.slope * height;
        let axis = separation * (if is_larger { -1.0 } else { 1.0 } / distance);
        for k in 0..3 {
            packed.axis[k][lane] = axis[k];
        }
        if let Some(&[along, slip, rolling]) = listed.springs.get(pair) {
            numbers[SPRING] = along;
            packed.touching.set(lane, [slip, rolling], distance, [own, others]);
            packed.touch |= slip + rolling > 0.0;
        }
    }
}

impl Listed {
    fn with_room(rows: usize, pairs: usize) -> Self {
        Self { pairs: Vec::with_capacity(pairs), springs: Vec::new(), ends: Vec::with_capacity(rows) }
    }

    /// The pairs of a row.
    #[inline(always)]
    fn of(&self, row: u32) -> std::ops::Range<usize> {
        let row = row as usize;
        (if row == 0 { 0 } else { self.ends[row - 1] })..self.ends[row]
    }

    /// The rows that have pairs, those with the most first.
    fn order(&self) -> Vec<u32> {
        let mut rows: Vec<u32> = (0..self.ends.len() as u32).filter(|&row| !self.of(row).is_empty()).collect();
        rows.sort_by_key(|&row| std::cmp::Reverse(self.of(row).len()));
        rows
    }
}

impl Packed {
    /// No pairs, in lanes that stand for any row.
    #[inline(always)]
    fn empty(row: u32) -> Self {
        Self {
            records: [[0.0; NUMBERS]; LANES],
            axis: [[0.0; LANES]; 3],
            sloping: [0.0; LANES],
            others: [row; LANES],
            touching: Touching::default(),
            touch: false,
        }
    }

    /// Makes a group of the pairs.
    #[inline(always)]
    fn assemble<V: Width<f64>>(
        &self,
        (group, moments): (&mut Group, &mut MomentGroup),
        (sums, strained): (&mut Sums<V>, &mut InStrain<V>),
        ambient: Traceless,
    ) {
        let mut numbers = [[0.0; LANES]; NUMBERS];
        for (k, lanes) in numbers.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            turn::<V, NUMBERS>(&self.records, k * LANES, lanes);
        }
        let mut record = [Lanes::<V>::constant(0.0); RECORD];
        for k in 0..RECORD {
            record[k] = Lanes::read(&numbers[k]);
        }
        let mut coefficients = Coefficients::of(&record);
        let spring = Lanes::read(&numbers[SPRING]);
        for k in 0..2 {
            coefficients.along[k][k] = coefficients.along[k][k] + spring;
            coefficients.along[k][1 - k] = coefficients.along[k][1 - k] - spring;
        }
        if self.touch {
            self.touching.add_to(&mut coefficients);
        }
        let mut z = [Lanes::constant(0.0); 3];
        for k in 0..3 {
            z[k] = Lanes::read(&self.axis[k]);
        }
        let is_larger = Lanes::read(&numbers[IS_LARGER]);
        let view = RowView::new(is_larger);
        sums.add(&coefficients, &view, z);
        strained.add(&coefficients, &view, z, (ambient, Lanes::read(&self.sloping)));
        group.others = self.others;
        group.axis = self.axis;
        group.set(&coefficients, &view);
        moments.set(&coefficients, &view);
    }
}
