//! Species and initial positions of the spheres.

use super::{Orientation, Parameters, SphereMoment, Swimming};
use domain::{Boundaries, Number, ParameterError, PeriodicBox, Vector, sphere};
use hydrodynamics::lengths::check_radius;

/// Upper bound of the total volume fraction of the spheres.
pub const MAX_FRACTION: f64 = 0.64;

/// Largest number of spheres: rows of particles are numbered in 32 bits.
pub const MAX_SPHERES: f64 = u32::MAX as f64;

/// A species of spheres.
#[derive(Debug, Clone, PartialEq)]
pub struct Species {
    /// Name in tables.
    pub name: String,
    /// Radius.
    pub radius: f64,
    /// Number of spheres; `None` if it follows from positions that are provided later.
    pub count: Option<u64>,
    /// Density of the spheres minus that of the fluid.
    pub density_difference: f64,
    /// Steady force on each sphere, in addition to its weight.
    pub force: Vector,
    /// Steady torque on each sphere.
    pub torque: Vector,
    /// Orientations at the start; `None` for spheres without orientations.
    pub orientation: Option<Orientation>,
    /// Swimming along the axes of the orientations; `None` for passive spheres.
    pub swimming: Option<Swimming>,
    /// Magnetic moment.
    pub magnetic: SphereMoment,
    /// Electric moment.
    pub electric: SphereMoment,
}

/// Initial positions of the spheres.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// Random positions without overlap.
    Random {
        /// Smallest gap between surfaces.
        minimum_gap: f64,
    },
    /// Random positions without overlap, with the centres in a ball around the origin, in unbounded fluid.
    Cloud {
        /// Radius of the ball.
        radius: f64,
        /// Smallest gap between surfaces.
        minimum_gap: f64,
    },
    /// Sites of a lattice, with the species mixed at random.
    Lattice(Lattice),
    /// These positions, species by species.
    Positions(Vec<Vector>),
    /// Positions provided by the caller that starts the run.
    Given,
}

/// Cubic lattices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lattice {
    /// One site per cell.
    SimpleCubic,
    /// Four sites per cell.
    FaceCentredCubic,
}

impl Species {
    /// `count` spheres of a radius without loads, orientations and swimming.
    pub fn new(name: &str, radius: f64, count: u64) -> Self {
        let (force, torque) = (Vector::ZERO, Vector::ZERO);
        Self {
            name: name.to_owned(),
            radius,
            count: Some(count),
            density_difference: 0.0,
            force,
            torque,
            orientation: None,
            swimming: None,
            magnetic: SphereMoment::NONE,
            electric: SphereMoment::NONE,
        }
    }

    /// Steady force on a sphere of this species and of the given radius: its own force plus weight minus buoyancy.
    pub fn force_on(&self, radius: f64, gravity: Vector) -> Vector {
        self.force + gravity * (self.density_difference * volume(radius))
    }

    pub(super) fn check(&self, index: usize, p: &Parameters, shortest: f64) -> Result<(), ParameterError> {
        let (cell, axes) = (&p.cell, p.user_axes());
        let key = |name: &str| format!("species[{index}].{name}");
        check_radius(self.radius, cell).map_err(|message| ParameterError::new(key("radius"), message))?;
        if 2.0 * self.radius >= shortest {
            let (radius, is_height) =
                (Number(self.radius), cell.boundaries().walls() == 2 && cell.edges().z <= shortest);
            let shortest = Number(shortest);
            if is_height {
                let message =
                    format!("is {radius}; a sphere needs to fit between the walls, which are {shortest} apart");
                return Err(ParameterError::new(key("radius"), message));
            }
            let message =
                format!("is {radius}; a sphere needs to be smaller than the box, whose shortest edge is {shortest}");
            return Err(ParameterError::new(key("radius"), message));
        }
        if self.count == Some(0) {
            return Err(ParameterError::new(key("count"), "is 0; a species needs at least one sphere"));
        }
        ParameterError::require_finite(&key("density_difference"), self.density_difference)?;
        ParameterError::require_finite_vector(&key("force"), axes.vector(self.force))?;
        ParameterError::require_finite_vector(&key("torque"), axes.vector(self.torque))?;
        self.swimming.as_ref().map_or(Ok(()), |swimming| swimming.check(index, p))?;
        self.orientation.map_or(Ok(()), |orientation| orientation.check(index, p))
    }
}

/// Checks all species together, in a box whose shortest lattice vector is `shortest`.
pub(super) fn check_species(p: &Parameters, shortest: f64) -> Result<(), ParameterError> {
    let (species, cell) = (&p.species, &p.cell);
    if species.is_empty() {
        return Err(ParameterError::new("species", "is empty; write at least one [[species]] section"));
    }
    species.iter().enumerate().try_for_each(|(index, one)| one.check(index, p, shortest))?;
    for (index, one) in species.iter().enumerate() {
        if species[..index].iter().any(|other| other.name == one.name) {
            let message = format!("is \"{}\", as another species' name; give each its own", one.name);
            return Err(ParameterError::new(format!("species[{index}].name"), message));
        }
    }
    check_filling(species, cell)
}

fn check_filling(species: &[Species], cell: &PeriodicBox) -> Result<(), ParameterError> {
    let count = |s: &Species| s.count.unwrap_or(0) as f64;
    let total: f64 = species.iter().map(count).sum();
    if total > MAX_SPHERES {
        return Err(ParameterError::new("species", format!("is a list of several: {}", too_many(total))));
    }
    let fraction = species.iter().map(|s| count(s) * volume(s.radius)).sum::<f64>() / cell.volume();
    // In unbounded fluid spheres may lie outside of the box; the random placement itself refuses a box that is too
    // full.
    if fraction >= MAX_FRACTION && cell.boundaries() != Boundaries::Open {
        let filled = Number(fraction);
        let message = format!("fill {filled:.3} of the box together; spheres need less than {MAX_FRACTION}");
        return Err(ParameterError::new("species", message));
    }
    Ok(())
}

fn too_many(count: f64) -> String {
    format!(
        "the scene has {count:.1e} spheres, but they are numbered in 32 bits, {MAX_SPHERES:.1e} at most; take fewer, \
         or a smaller box"
    )
}

impl Start {
    pub(super) fn check(&self, p: &Parameters) -> Result<(), ParameterError> {
        match self {
            Self::Random { minimum_gap } if !(*minimum_gap >= 0.0 && minimum_gap.is_finite()) => {
                let message = format!("is {}; it needs to be 0 or more", Number(*minimum_gap));
                Err(ParameterError::new("particles.minimum_gap", message))
            }
            Self::Positions(places) => check_places(places, p),
            Self::Cloud { .. } | Self::Lattice(_) if !p.placed_together().is_empty() => {
                let message = "can't be with [[bodies]] and [[filaments]], whose scenes start from \"random\", \
                    \"positions\" or \"file\"";
                Err(ParameterError::new("particles.initial", message))
            }
            Self::Cloud { radius, minimum_gap } => {
                ParameterError::require_positive("particles.radius", *radius)?;
                Self::Random { minimum_gap: *minimum_gap }.check(p)?;
                check_open(&p.cell)
            }
            Self::Given if p.placed_together().is_empty() => Ok(()),
            _ => check_counts(&p.species),
        }
    }

    /// Radius of the ball in which the spheres of a cloud start.
    pub fn ball(&self) -> Option<f64> {
        if let Self::Cloud { radius, .. } = *self { Some(radius) } else { None }
    }
}

/// Refuses species without a number of spheres.
fn check_counts(species: &[Species]) -> Result<(), ParameterError> {
    match species.iter().position(|species| species.count.is_none()) {
        Some(index) => {
            Err(ParameterError::new(format!("species[{index}].count"), "is missing; say how many spheres there are"))
        }
        None => Ok(()),
    }
}

/// A cloud needs unbounded fluid.
fn check_open(cell: &PeriodicBox) -> Result<(), ParameterError> {
    if cell.boundaries() == Boundaries::Open {
        return Ok(());
    }
    let message = "is \"cloud\", which is in unbounded fluid; set box.boundaries = [\"open\", \"open\", \"open\"], or \
        take \"random\"";
    Err(ParameterError::new("particles.initial", message))
}

fn check_places(places: &[Vector], p: &Parameters) -> Result<(), ParameterError> {
    let (species, cell, axes) = (&p.species[..p.free_species()], &p.cell, p.user_axes());
    let counted: u64 = species.iter().filter_map(|s| s.count).sum();
    if places.len() as u64 != counted {
        let message = format!("has {} positions, but the species count {counted} spheres", places.len());
        return Err(ParameterError::new("particles.positions", message));
    }
    for (row, &place) in places.iter().enumerate() {
        ParameterError::require_finite_vector(&format!("particles.positions[{row}]"), axes.place(place))?;
    }
    let radii = species.iter().flat_map(|s| std::iter::repeat_n(s.radius, s.count.unwrap_or(0) as usize));
    for (row, (&place, radius)) in places.iter().zip(radii).enumerate() {
        if let Some(to) = cell.to_walls(place).find(|to| to.distance < radius * (1.0 - 1e-12)) {
            let wall = if to.wall == 0 { 0.0 } else { cell.edges().z };
            let ([z, radius, wall], axis) = ([place.z, radius, wall].map(Number), axes.name(2));
            let message =
                format!("has {axis} = {z}: a sphere of radius {radius} there reaches into the wall at {axis} = {wall}");
            return Err(ParameterError::new(format!("particles.positions[{row}]"), message));
        }
    }
    Ok(())
}

pub(crate) fn volume(radius: f64) -> f64 {
    sphere::volume(radius)
}
