//! Checked parameters of a system of disks.

use super::{DiskFlow, Gear, Law, LengthUnit, Size, Sizes, SpringContact, Stage};
use crate::parameter::{ParameterError, finite, positive, refused, require};
use domain::{Comm, MemoryNeed, Number, Particles, PeriodicBox, Vector};
use std::f64::consts::PI;

/// Preparation of a random start for the shear: almost plastic contacts remove overlaps, then elastic contacts bring
/// the disks near the equilibrium of hard disks. There is no drag and no flow. Times are counted from the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preparation {
    /// Restitution while overlaps are removed.
    pub restitution: f64,
    /// Time at which the removal of overlaps ends.
    pub settled: f64,
    /// Time at which the elastic stage ends.
    pub mixed: f64,
    /// Integrator of both stages. With many contacts of restitution 0.1 the five-value schemes are
    /// unstable at a time step of 0.15.
    pub gear: Gear,
    /// Time step of both stages.
    pub time_step: f64,
}

impl Preparation {
    fn check_times(&self) -> Result<(), ParameterError> {
        let (settled, mixed, key) = (self.settled, self.mixed, "preparation.elastic_until");
        let is_time = settled >= 0.0 && settled.is_finite();
        require(is_time, "preparation.inelastic_until", Number(settled), "a time, not negative")?;
        let is_after = mixed >= settled && mixed.is_finite();
        require(is_after, key, Number(mixed), "a time that is not before preparation.inelastic_until")?;
        let allowed = format_args!("less than {} steps", Number(MOST_STEPS));
        require(mixed / self.time_step < MOST_STEPS, key, Number(mixed), allowed)
    }
}

/// Parameters of a scene. The default is the system of Fig. 4 of Santra, Schwarzer & Herrmann, PRE 54, 5066 (1996).
/// Units: a length according to `length_unit`, the mass of a disk of radius 1, and a time in which an undamped
/// contact lasts `pi`.
#[derive(Debug, Clone, PartialEq)]
pub struct DiskParameters {
    /// Periods along the flow (x) and the gradient (y).
    pub edges: [f64; 2],
    /// Strain of the lattice of images at the start, for disks that come from a sheared box.
    pub strain: f64,
    /// Area fraction of the disks.
    pub area_fraction: f64,
    /// The distribution of radii.
    pub sizes: Sizes,
    /// The radius that is 1.
    pub length_unit: LengthUnit,
    /// Power of the radius to which mass is proportional: 2 for disks, 3 for spheres.
    pub mass_exponent: i32,
    /// Fraction of the normal velocity after a contact.
    pub restitution: f64,
    /// Whether a contact that is about to end may not attract.
    pub clip_attraction: bool,
    /// Viscosity of the liquid in the Stokes drag `6 pi r viscosity`.
    pub viscosity: f64,
    /// Flow of the liquid.
    pub flow: DiskFlow,
    /// Integrator.
    pub gear: Gear,
    /// Time step.
    pub time_step: f64,
    /// Preparation of a random start.
    pub preparation: Preparation,
    /// Seed of the random start.
    pub seed: u64,
    /// Number of steps between measurements of energies and stresses.
    pub measure_every: u64,
}

impl Default for DiskParameters {
    fn default() -> Self {
        let preparation =
            Preparation { restitution: 0.1, settled: 20.0, mixed: 100.0, gear: Gear::FourValue, time_step: 0.15 };
        Self {
            edges: [100.0; 2],
            strain: 0.0,
            area_fraction: 0.6,
            sizes: Sizes::bidisperse(4.0, 0.05),
            length_unit: LengthUnit::Mean,
            mass_exponent: 2,
            restitution: 0.8,
            clip_attraction: false,
            viscosity: 0.01,
            flow: DiskFlow::Shear { rate: 0.01 },
            gear: Gear::FiveValue,
            time_step: 0.15,
            preparation,
            seed: 1,
            measure_every: 5,
        }
    }
}

/// A system of disks with checked parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct DiskModel {
    parameters: DiskParameters,
    sizes: Vec<Size>,
    smallest: f64,
    largest: f64,
}

impl DiskModel {
    /// Model with the disks that the parameters specify.
    pub fn new(parameters: DiskParameters) -> Result<Self, ParameterError> {
        let p = &parameters;
        p.edges.iter().try_for_each(|&edge| positive("box.edges", edge))?;
        finite("box.strain", p.strain)?;
        let covers = p.area_fraction > 0.0 && p.area_fraction <= 0.84;
        let allowed = "0 < area_fraction <= 0.84: disks at random jam there";
        require(covers, "particles.area_fraction", Number(p.area_fraction), allowed)?;
        p.sizes.check()?;
        let area = p.area_fraction * p.edges[0] * p.edges[1];
        Self::check_count(p.sizes.count(area, p.length_unit), p.area_fraction)?;
        let sizes = p.sizes.cover(area, p.length_unit);
        Self::of(parameters, sizes)
    }

    /// Model with the disks of a particle store, whatever sizes and area fraction the parameters specify.
    pub fn with_particles(parameters: DiskParameters, particles: &Particles) -> Result<Self, ParameterError> {
        particles.radii.iter().try_for_each(|&r| positive("particles.radius", r))?;
        let of_row = |(&radius, &species): (&f64, &u32)| Size { radius, species };
        let sizes = particles.radii.iter().zip(&particles.species).map(of_row).collect();
        Self::of(parameters, sizes)
    }

    /// Refuses more disks than row numbers can count, or than there is memory to list.
    fn check_count(count: f64, fraction: f64) -> Result<(), ParameterError> {
        let found = format!("{fraction}, which takes {count:.1e} disks");
        let (key, most) = ("particles.area_fraction", f64::from(u32::MAX));
        let allowed = format_args!("at most {most:.1e} disks: a smaller box.edges, or larger radii");
        require(count <= most, key, &found, allowed)?;
        let need = MemoryNeed { resident: 2.0 * Self::size_bytes(count).most, ..MemoryNeed::default() };
        let fits = Comm::check_memory_of(&[need]);
        fits.map_err(|error| refused(key, &found, format_args!("fewer, or larger radii: {error}")))
    }

    fn of(parameters: DiskParameters, sizes: Vec<Size>) -> Result<Self, ParameterError> {
        let p = &parameters;
        p.edges.iter().try_for_each(|&edge| positive("box.edges", edge))?;
        require(!sizes.is_empty(), "particles.area_fraction", Number(p.area_fraction), "enough for one disk")?;
        check_radii(&p.sizes, &sizes)?;
        require((1..=3).contains(&p.mass_exponent), "particles.mass_exponent", p.mass_exponent, "1, 2 or 3")?;
        check_restitution("contact.restitution", p.restitution)?;
        check_restitution("preparation.restitution", p.preparation.restitution)?;
        check_step("time.step", p.time_step)?;
        check_step("preparation.time_step", p.preparation.time_step)?;
        p.preparation.check_times()?;
        require(p.measure_every > 0, "output.measure_every", p.measure_every, "at least one step")?;
        let radii = || sizes.iter().map(|s| s.radius);
        let (smallest, largest) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max));
        let model = Self { parameters, sizes, smallest, largest };
        model.check_box()?;
        model.check_flow()?;
        Ok(model)
    }

    fn check_box(&self) -> Result<(), ParameterError> {
        let least = 6.0 * self.largest();
        let allowed = format!("at least three of the largest diameters, {:.6}", Number(least));
        self.parameters.edges.iter().try_for_each(|edge| require(*edge >= least, "box.edges", Number(*edge), &allowed))
    }

    fn check_flow(&self) -> Result<(), ParameterError> {
        let p = &self.parameters;
        match p.flow {
            DiskFlow::Still => {}
            DiskFlow::Shear { rate } => finite("flow.rate", rate)?,
            DiskFlow::Poiseuille { peak } => finite("flow.peak", peak)?,
        }
        let turn = p.flow.profile(p.edges[1]).steepest * p.time_step;
        require(turn <= 0.1, "flow", format_args!("{:?}", p.flow), "a velocity gradient of at most 0.1 / time_step")?;
        let bound = if p.gear == Gear::FourValue { 0.5 } else { 0.3 };
        let most = bound / (self.fastest_drag() * p.time_step);
        let stable = p.viscosity >= 0.0 && p.viscosity <= most;
        let allowed = format_args!("0 <= viscosity <= {:.3}, where the integrator is stable", Number(most));
        require(stable, "fluid.viscosity", Number(p.viscosity), allowed)
    }

    /// The parameters.
    pub fn parameters(&self) -> &DiskParameters {
        &self.parameters
    }

    /// Radius and species of each disk.
    pub fn sizes(&self) -> &[Size] {
        &self.sizes
    }

    /// Mass of a disk of the given radius.
    pub fn mass(&self, radius: f64) -> f64 {
        radius.powi(self.parameters.mass_exponent)
    }

    /// The smallest radius.
    pub fn smallest(&self) -> f64 {
        self.smallest
    }

    /// The largest radius.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Whether a radius is above the geometric mean of the smallest and the largest.
    pub fn is_large(&self, radius: f64) -> bool {
        radius * radius > self.smallest() * self.largest() * (1.0 + 1e-9)
    }

    /// Area fraction of the disks.
    pub fn area_fraction(&self) -> f64 {
        let [length, height] = self.parameters.edges;
        PI * self.sizes.iter().map(|s| s.radius * s.radius).sum::<f64>() / (length * height)
    }

    /// The lattice of images at a strain. Its depth is the largest diameter.
    pub fn cell(&self, strain: f64) -> PeriodicBox {
        let [length, height] = self.parameters.edges;
        PeriodicBox::sheared(Vector::new(length, height, 2.0 * self.largest()), strain).expect("edges were checked")
    }

    /// Largest rate at which drag slows a disk, for a viscosity of 1.
    fn fastest_drag(&self) -> f64 {
        self.sizes.iter().map(|s| 6.0 * PI * s.radius / self.mass(s.radius)).fold(0.0, f64::max)
    }

    /// Number of steps that prepare a random start.
    pub fn preparing_steps(&self) -> u64 {
        [Stage::RemoveOverlaps, Stage::Equilibrate].into_iter().filter_map(|stage| self.law(stage).steps).sum()
    }

    pub(super) fn law(&self, stage: Stage) -> Law {
        let (p, prepared) = (&self.parameters, self.parameters.preparation);
        let contact = |restitution| SpringContact::new(restitution, p.clip_attraction);
        let still = Law {
            contact: contact(1.0),
            viscosity: 0.0,
            profile: DiskFlow::Still.profile(p.edges[1]),
            gear: prepared.gear,
            start_strain: 0.0,
            dt: prepared.time_step,
            steps: None,
        };
        let [settled, mixed] = [prepared.settled, prepared.mixed].map(|time| (time / still.dt).round() as u64);
        match stage {
            Stage::RemoveOverlaps => Law { contact: contact(prepared.restitution), steps: Some(settled), ..still },
            Stage::Equilibrate => Law { steps: Some(mixed.saturating_sub(settled)), ..still },
            Stage::Flow => Law {
                contact: contact(p.restitution),
                viscosity: p.viscosity,
                profile: p.flow.profile(p.edges[1]),
                gear: p.gear,
                start_strain: p.strain,
                dt: p.time_step,
                steps: None,
            },
        }
    }
}

/// Largest number of steps of a preparation.
const MOST_STEPS: f64 = 1e12;

/// Refuses radii whose squares are outside the range of floating-point numbers, e.g. from
/// powers of very different radii.
fn check_radii(asked: &Sizes, sizes: &[Size]) -> Result<(), ParameterError> {
    let wrong = sizes.iter().find(|s| !(s.radius * s.radius > 0.0 && (s.radius * s.radius).is_finite()));
    wrong.map_or(Ok(()), |size| {
        let (key, allowed) = match asked {
            Sizes::DiskSpecies(_) => ("species", "radii and shares less far apart"),
            Sizes::Spread { .. } => ("particles.spread", "radii less far apart, or an exponent nearer to 0"),
        };
        Err(refused(key, format_args!("a mixture with a disk of radius {:e}", size.radius), allowed))
    })
}

fn check_restitution(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found <= 1.0, key, Number(found), "0 < restitution <= 1")
}

fn check_step(key: &'static str, found: f64) -> Result<(), ParameterError> {
    require(found > 0.0 && found <= 0.5, key, Number(found), "0 < time_step <= 0.5: a contact lasts pi")?;
    require(found * found >= f64::MIN_POSITIVE, key, Number(found), "a step whose square is a positive number")
}
