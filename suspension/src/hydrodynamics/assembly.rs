//! From neighbour lists to the resistance of near pairs.

use super::lanes::{LANES, Lanes, turn};
use super::pair_matrix::{Group, MomentGroup, Own, Part, ROWS, add_tensor};
use super::screw::Screw;
use super::springs::Springs;
use super::stiffness::Stiffness;
use domain::{Neighbours, PeriodicBox, Traceless, Vector};
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
    /// The ambient rate of strain.
    pub ambient: Traceless,
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

/// Numbers of a pair: those of its coefficients, its axis, 1 where the row's particle is the larger one, the resistances of
/// its springs along the axis and across, the arms of the smaller and the larger sphere, the resistance to rolling, and
/// zeros.
const NUMBERS: usize = 56;
const AXIS: usize = RECORD;
const IS_LARGER: usize = RECORD + 3;
const SPRING: usize = RECORD + 4;
const SLIP: usize = RECORD + 5;
const ARMS: [usize; 2] = [RECORD + 6, RECORD + 7];
const ROLLING: usize = RECORD + 8;

/// Pairs of one row that wait for a full group.
struct Waiting {
    records: [[f64; NUMBERS]; LANES],
    others: [u32; LANES],
    count: usize,
    /// Whether any of them touch.
    touch: bool,
}

/// Sums over the pairs of a row, lane by lane.
struct Sums<V> {
    force: [Lanes<V>; 6],
    torque: [Lanes<V>; 6],
    coupling: [Lanes<V>; 3],
}

/// Loads and moments of a row in the ambient flow, lane by lane.
struct InStrain<V> {
    force: [Lanes<V>; 3],
    torque: [Lanes<V>; 3],
    moment: [Lanes<V>; 5],
}

impl Work<f64> for Assembly<'_> {
    type Output = Assembled;

    #[inline(always)]
    fn run<V: Width<f64>>(self) -> Assembled {
        let rows = self.first..self.first + self.rows;
        // All pairs of a row may be soft, and nearly all are.
        let groups = rows.clone().map(|row| self.arrangement.neighbours.of(row).len().div_ceil(LANES)).sum();
        let mut assembled = Assembled {
            stiff: Part::default(),
            soft: Part::with_room(groups),
            loads: Vec::with_capacity(self.rows),
            moments: Vec::with_capacity(self.rows),
        };
        let (mut stiff, mut soft) = (Waiting::new(), Waiting::new());
        for row in rows {
            self.assemble::<V>(row, [&mut stiff, &mut soft], &mut assembled);
        }
        assembled
    }
}

impl Assembly<'_> {
    /// All rows, in parts.
    pub fn parts(owned: usize) -> usize {
        owned.div_ceil(ROWS)
    }

    #[inline(always)]
    fn assemble<V: Width<f64>>(&self, row: usize, waiting: [&mut Waiting; 2], assembled: &mut Assembled) {
        let Arrangement { lubrication, springs, radii, cell, positions, ids, species, neighbours, ambient } =
            *self.arrangement;
        let (mut sums, mut strained) = ([Sums::<V>::zero(), Sums::zero()], InStrain::zero());
        for neighbour in neighbours.of(row) {
            let other = neighbour.row as usize;
            let mut separation = positions[other] - positions[row];
            if neighbour.steps != [0; 3] {
                separation += cell.lattice(neighbour.steps.map(i32::from));
            }
            let (pair, distance) = ([species[row], species[other]], separation.length());
            let pair_radii = pair.map(|s| radii[s as usize]);
            let between = |springs: &Springs| springs.between((row, ids[other]), distance, pair_radii);
            let [spring, slip, rolling] = springs.map_or([0.0; 3], between);
            let lubricated =
                lubrication.and_then(|(force, stiffness)| Some((force, stiffness, force.gap(distance, pair)?)));
            if lubricated.is_none() && spring == 0.0 {
                continue;
            }
            let is_stiff = spring > 0.0 || lubricated.is_some_and(|(_, stiffness, gap)| stiffness.holds(pair, gap));
            let list = usize::from(!is_stiff);
            let is_larger = pair_radii[0] > pair_radii[1];
            let axis = separation * (if is_larger { -1.0 } else { 1.0 } / distance);
            let waiting = &mut *waiting[list];
            let numbers = waiting.next(neighbour.row);
            let record = numbers.first_chunk_mut().expect("numbers begin with a record");
            match lubricated {
                Some((force, ..)) => force.record::<Lanes<V>>(distance, pair, record),
                None => *record = [0.0; RECORD],
            }
            numbers[AXIS..AXIS + 3].copy_from_slice(&axis.to_array());
            numbers[IS_LARGER] = f64::from(u8::from(is_larger));
            numbers[SPRING] = spring;
            if springs.is_some() {
                set_contact(numbers, [slip, rolling], distance, pair_radii);
                waiting.touch |= slip + rolling > 0.0;
            }
            if waiting.count == LANES {
                let part = if list == 0 { &mut assembled.stiff } else { &mut assembled.soft };
                waiting.flush::<V>(row, part, (&mut sums[list], &mut strained), ambient);
            }
        }
        for (list, waiting) in waiting.into_iter().enumerate() {
            let part = if list == 0 { &mut assembled.stiff } else { &mut assembled.soft };
            if waiting.count > 0 {
                waiting.flush::<V>(row, part, (&mut sums[list], &mut strained), ambient);
            }
            let mut own = sums[list].totals();
            if list == 0
                && let Some(trap) = springs.and_then(|springs| springs.trap(row))
            {
                own.resist(trap);
            }
            part.end_row(own);
        }
        let (load, moment) = strained.totals();
        assembled.loads.push(load);
        assembled.moments.push(moment);
    }
}

impl Waiting {
    fn new() -> Self {
        Self { records: [[0.0; NUMBERS]; LANES], others: [0; LANES], count: 0, touch: false }
    }

    /// The numbers of one more pair.
    #[inline(always)]
    fn next(&mut self, other: u32) -> &mut [f64; NUMBERS] {
        self.others[self.count] = other;
        self.count += 1;
        &mut self.records[self.count - 1]
    }

    /// Makes a group of the pairs, and forgets them.
    #[inline(always)]
    fn flush<V: Width<f64>>(
        &mut self,
        row: usize,
        part: &mut Part,
        (sums, strained): (&mut Sums<V>, &mut InStrain<V>),
        ambient: Traceless,
    ) {
        for lane in self.count..LANES {
            self.records[lane] = [0.0; NUMBERS];
            self.others[lane] = row as u32;
        }
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
        if std::mem::take(&mut self.touch) {
            add_contacts(&mut coefficients, &numbers);
        }
        let mut z = [Lanes::constant(0.0); 3];
        for k in 0..3 {
            z[k] = Lanes::read(&numbers[AXIS + k]);
        }
        let is_larger = Lanes::read(&numbers[IS_LARGER]);
        let chosen = Chosen { is_larger, is_smaller: Lanes::constant(1.0) - is_larger };
        sums.add(&coefficients, &chosen, z);
        strained.add(&coefficients, &chosen, z, ambient);
        let (group, moments) = part.group();
        group.others = self.others;
        group.axis = [numbers[AXIS], numbers[AXIS + 1], numbers[AXIS + 2]];
        set_group(group, &coefficients, &chosen);
        set_moments(moments, &coefficients, &chosen);
        self.count = 0;
    }
}

/// Notes what a contact resists to slip and to rolling.
#[inline(always)]
fn set_contact(numbers: &mut [f64; NUMBERS], [slip, rolling]: [f64; 2], distance: f64, radii: [f64; 2]) {
    let [smaller, larger] = [radii[0].min(radii[1]), radii[0].max(radii[1])];
    let sum = smaller + larger;
    numbers[SLIP] = slip;
    numbers[ARMS[0]] = distance * smaller / sum;
    numbers[ARMS[1]] = distance * larger / sum;
    numbers[ROLLING] = rolling * (2.0 * smaller * larger / sum).powi(2);
}

/// Adds what contacts resist: with `s = 1` for the smaller sphere and `-1` for the larger, arms `b` and the velocity `v` at
/// which surfaces slip, the rate of work is
///
/// ```text
/// slip v^2 + rolling |(sum s Omega) x z|^2,        v = (sum s U)_across + (sum b Omega) x z
/// ```
#[inline(always)]
fn add_contacts<V: Width<f64>>(coefficients: &mut Coefficients<Lanes<V>>, numbers: &[[f64; LANES]; NUMBERS]) {
    let (slip, rolling) = (Lanes::read(&numbers[SLIP]), Lanes::read(&numbers[ROLLING]));
    let arms = [Lanes::read(&numbers[ARMS[0]]), Lanes::read(&numbers[ARMS[1]])];
    let signs = [Lanes::constant(1.0), Lanes::constant(-1.0)];
    for k in 0..2 {
        for l in 0..2 {
            let sign = signs[k] * signs[l];
            coefficients.across[k][l] = coefficients.across[k][l].plus(slip, sign);
            coefficients.coupling[k][l] = coefficients.coupling[k][l].plus(slip, signs[k] * arms[l]);
            coefficients.roll[k][l] = coefficients.roll[k][l].plus(slip, arms[k] * arms[l]).plus(rolling, sign);
        }
    }
}

/// Which of two spheres is the row's.
struct Chosen<V> {
    is_larger: Lanes<V>,
    is_smaller: Lanes<V>,
}

impl<V: Width<f64>> Chosen<V> {
    /// That of the row's sphere.
    #[inline(always)]
    fn own(&self, [smaller, larger]: [Lanes<V>; 2]) -> Lanes<V> {
        self.is_smaller * smaller + self.is_larger * larger
    }

    /// The row's sphere feels its own motion.
    #[inline(always)]
    fn on_itself(&self, both: [[Lanes<V>; 2]; 2]) -> Lanes<V> {
        self.own([both[0][0], both[1][1]])
    }

    /// The row's sphere feels the motion of the other.
    #[inline(always)]
    fn by_other(&self, both: [[Lanes<V>; 2]; 2]) -> Lanes<V> {
        self.own([both[0][1], both[1][0]])
    }

    /// The other sphere feels the motion of the row's.
    #[inline(always)]
    fn on_other(&self, both: [[Lanes<V>; 2]; 2]) -> Lanes<V> {
        self.own([both[1][0], both[0][1]])
    }
}

#[inline(always)]
fn set_group<V: Width<f64>>(group: &mut Group, c: &Coefficients<Lanes<V>>, chosen: &Chosen<V>) {
    c.across[0][1].write(&mut group.across);
    (c.along[0][1] - c.across[0][1]).write(&mut group.along);
    c.roll[0][1].write(&mut group.roll);
    (c.spin[0][1] - c.roll[0][1]).write(&mut group.spin);
    chosen.by_other(c.coupling).write(&mut group.coupling[0]);
    chosen.on_other(c.coupling).write(&mut group.coupling[1]);
}

#[inline(always)]
fn set_moments<V: Width<f64>>(moments: &mut MomentGroup, c: &Coefficients<Lanes<V>>, chosen: &Chosen<V>) {
    for (both, to) in [(c.pull, &mut moments.pull), (c.drag, &mut moments.drag), (c.turn, &mut moments.turn)] {
        chosen.on_itself(both).write(&mut to[0]);
        chosen.by_other(both).write(&mut to[1]);
    }
}

/// Rows and columns of the components of a symmetric matrix.
const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

impl<V: Width<f64>> Sums<V> {
    #[inline(always)]
    fn zero() -> Self {
        let zero = Lanes::constant(0.0);
        Self { force: [zero; 6], torque: [zero; 6], coupling: [zero; 3] }
    }

    #[inline(always)]
    fn add(&mut self, c: &Coefficients<Lanes<V>>, chosen: &Chosen<V>, z: [Lanes<V>; 3]) {
        let (across, roll) = (chosen.on_itself(c.across), chosen.on_itself(c.roll));
        let (along, spin) = (chosen.on_itself(c.along) - across, chosen.on_itself(c.spin) - roll);
        let coupling = chosen.on_itself(c.coupling);
        for (k, (i, j)) in SYMMETRIC.into_iter().enumerate() {
            self.force[k] = self.force[k].plus(along * z[i], z[j]);
            self.torque[k] = self.torque[k].plus(spin * z[i], z[j]);
            if i == j {
                self.force[k] = self.force[k] + across;
                self.torque[k] = self.torque[k] + roll;
            }
        }
        for k in 0..3 {
            self.coupling[k] = self.coupling[k].plus(coupling, z[k]);
        }
    }

    #[inline(always)]
    fn totals(&self) -> Own {
        let mut own = Own::default();
        for k in 0..6 {
            own.force[k] = self.force[k].sum();
            own.torque[k] = self.torque[k].sum();
        }
        for k in 0..3 {
            own.coupling[k] = self.coupling[k].sum();
        }
        own
    }
}

impl<V: Width<f64>> InStrain<V> {
    #[inline(always)]
    fn zero() -> Self {
        let zero = Lanes::constant(0.0);
        Self { force: [zero; 3], torque: [zero; 3], moment: [zero; 5] }
    }

    #[inline(always)]
    fn add(&mut self, c: &Coefficients<Lanes<V>>, chosen: &Chosen<V>, z: [Lanes<V>; 3], ambient: Traceless) {
        let [xx, xy, xz, yy, yz] = ambient.0;
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, -xx - yy]];
        let mut across = [Lanes::<V>::constant(0.0); 3];
        for i in 0..3 {
            for j in 0..3 {
                across[i] = across[i].plus(Lanes::constant(rows[i][j]), z[j]);
            }
        }
        let along = (z[0] * across[0]).plus(z[1], across[1]).plus(z[2], across[2]);
        for i in 0..3 {
            across[i] = across[i] - along * z[i];
        }
        let (push, slide, twist) = (chosen.own(c.push) * along, chosen.own(c.slide), chosen.own(c.twist));
        let bend = chosen.own(c.bend);
        let mut shear = across;
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.force[i] = self.force[i].plus(push, z[i]).plus(slide, across[i]);
            self.torque[i] = self.torque[i].plus(twist, z[j] * across[k] - z[k] * across[j]);
            shear[i] = bend * across[i];
        }
        add_tensor(chosen.own(c.stretch) * along, shear, z, &mut self.moment);
        let bulk = chosen.own(c.bulk);
        for (k, component) in ambient.0.into_iter().enumerate() {
            self.moment[k] = self.moment[k].plus(bulk, Lanes::constant(component));
        }
    }

    #[inline(always)]
    fn totals(&self) -> (Screw, Traceless) {
        let (mut load, mut moment) = (Screw::default(), Traceless::ZERO);
        for k in 0..3 {
            load.0[k] = self.force[k].sum();
            load.0[3 + k] = self.torque[k].sum();
        }
        for k in 0..5 {
            moment.0[k] = self.moment[k].sum();
        }
        (load, moment)
    }
}
