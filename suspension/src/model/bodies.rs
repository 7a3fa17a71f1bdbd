//! Rigid bodies made of spheres.

use super::{BrownianScheme, Flow, Integrator, MultipoleOrder, Orientation, Parameters, Species, Start};
use domain::{BodySphere, Number, ParameterError, Quaternion, Vector, sphere};
use hydrodynamics::GivenMotion;
use hydrodynamics::lengths::check_radius;
use lubrication::LubricationRange;

/// Rigid bodies of one kind. Their spheres are particles of species of their own, one for each radius, which
/// [`Parameters::with_bodies`] adds.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    /// Name in tables, by which the species are named.
    pub name: String,
    /// Spheres of one body, whose centre of volume is at zero in its own axes, see [`BodySphere::centred`].
    pub spheres: Vec<BodySphere>,
    /// Number of bodies.
    pub count: u64,
    /// Positions of the centres at the start, one for each body; random without.
    pub positions: Option<Vec<Vector>>,
    /// Orientations at the start.
    pub orientation: BodyOrientation,
    /// Density of the spheres minus that of the fluid.
    pub density_difference: f64,
    /// Steady force on each body at its centre, in addition to its weight.
    pub force: Vector,
    /// Steady torque on each body about its centre.
    pub torque: Vector,
    /// Components of the motion of each body that are given, in the frame of the box. Loads on the body along these
    /// have no effect.
    pub motion: GivenMotion,
}

/// Orientations of bodies at the start: rotations of their own axes, the third of which is the axis of their symmetry.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyOrientation {
    /// All rotations are equally likely.
    Random,
    /// The third axis is along this vector, of any length.
    Aligned(Vector),
    /// One for each body.
    Each(Vec<Quaternion>),
}

/// A sphere of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BodyMember {
    /// Index of the kind of bodies.
    pub kind: usize,
    /// Number of the body among those of its kind.
    pub number: u64,
    /// Number of the body among all.
    pub body: u64,
    /// Index of the sphere in its body.
    pub sphere: usize,
}

impl Bodies {
    /// Bodies without loads at random positions with random orientations.
    pub fn new(name: &str, spheres: Vec<BodySphere>, count: u64) -> Self {
        Self {
            name: name.to_owned(),
            spheres: BodySphere::centred(spheres),
            count,
            positions: None,
            orientation: BodyOrientation::Random,
            density_difference: 0.0,
            force: Vector::ZERO,
            torque: Vector::ZERO,
            motion: GivenMotion::default(),
        }
    }

    /// Radii of the spheres in the order of their first occurrence.
    fn radii(&self) -> Vec<f64> {
        let mut radii = Vec::new();
        for sphere in &self.spheres {
            if !radii.contains(&sphere.radius) {
                radii.push(sphere.radius);
            }
        }
        radii
    }

    /// Volume of the spheres of a body.
    fn volume(&self) -> f64 {
        self.spheres.iter().map(|one| sphere::volume(one.radius)).sum()
    }

    /// Species of the spheres. Each sphere bears a share of the force in proportion to its volume, so that the force
    /// acts at the centre, and the same share of the torque.
    pub(super) fn species(&self) -> Vec<Species> {
        let radii = self.radii();
        let of_radius = |(index, &radius): (usize, &f64)| {
            let name = if radii.len() == 1 { self.name.clone() } else { format!("{} {}", self.name, index + 1) };
            let each = self.spheres.iter().filter(|one| one.radius.total_cmp(&radius).is_eq()).count() as u64;
            Species {
                density_difference: self.density_difference,
                force: self.force * (sphere::volume(radius) / self.volume()),
                torque: self.torque / self.spheres.len() as f64,
                orientation: Some(Orientation::OfBody),
                ..Species::new(&name, radius, each * self.count)
            }
        };
        radii.iter().enumerate().map(of_radius).collect()
    }

    /// Checks those of a section, as `bodies[0]`.
    pub(super) fn check(&self, section: &str, p: &Parameters) -> Result<(), ParameterError> {
        let fault = |name: &str, message: String| Err(ParameterError::new(format!("{section}{name}"), message));
        if self.count == 0 {
            return fault(".count", "is 0; take at least 1, or leave the section out".to_owned());
        }
        if let Some(message) = self.spheres.iter().find_map(|one| check_radius(one.radius, &p.cell).err()) {
            return fault(".radius", message);
        }
        if self.spheres.is_empty() || !self.spheres.iter().all(|one| one.position.length().is_finite()) {
            return fault(".spheres", "needs one sphere at least, and finite numbers".to_owned());
        }
        let (diameter, shortest) = (2.0 * BodySphere::extent(&self.spheres), p.shortest_vector());
        let apart = p.image_gap() * self.spheres.iter().map(|one| one.radius).fold(0.0, f64::max);
        let is_periodic = (0..3).any(|axis| p.cell.is_periodic(axis));
        if is_periodic && diameter + apart > shortest {
            let [diameter, apart, shortest] = [diameter, apart, shortest].map(Number);
            let message = format!(
                "has a diameter of {diameter}, and needs a gap of {apart} to its own images; the shortest edge of the \
                 box is {shortest}"
            );
            return fault("", message);
        }
        let axes = p.user_axes();
        for (row, &place) in self.positions.iter().flatten().enumerate() {
            let key = format!("{section}.positions[{row}]");
            ParameterError::require_finite_vector(&key, axes.place(place))?;
        }
        if let Some(places) = self.positions.as_ref().filter(|places| places.len() as u64 != self.count) {
            return fault(".positions", format!("has {} positions for a count of {}", places.len(), self.count));
        }
        self.check_orientation(section, p)?;
        if p.start == Start::Given {
            let message =
                "is set, but bodies and filaments are where the file of particles.path has them; leave it out";
            match (&self.positions, &self.orientation) {
                (Some(_), _) => return fault(".positions", message.to_owned()),
                (None, BodyOrientation::Aligned(_)) => return fault(".orientation", message.to_owned()),
                (None, BodyOrientation::Each(_)) => return fault(".orientations", message.to_owned()),
                (None, BodyOrientation::Random) => {}
            }
        }
        let key = |name: &str| format!("{section}.{name}");
        ParameterError::require_finite(&key("density_difference"), self.density_difference)?;
        ParameterError::require_finite_vector(&key("force"), axes.vector(self.force))?;
        ParameterError::require_finite_vector(&key("torque"), axes.vector(self.torque))?;
        self.check_motion(section, p)
    }

    fn check_motion(&self, section: &str, p: &Parameters) -> Result<(), ParameterError> {
        let back = p.turn.inverse();
        let GivenMotion { velocity, angular_velocity } = self.motion;
        for (name, given) in [("velocity", velocity), ("angular_velocity", angular_velocity)] {
            for (axis, component) in back.components(given).into_iter().enumerate() {
                let key = format!("{section}.{name}[{axis}]");
                ParameterError::require_finite(&key, component.unwrap_or(0.0))?;
            }
        }
        let name = if velocity == [None; 3] { "angular_velocity" } else { "velocity" };
        let refused = |message: &str| Err(ParameterError::new(format!("{section}.{name}"), message));
        if matches!(p.flow, Flow::Shear { .. }) && p.cell.is_periodic(2) && velocity[0].is_some() {
            return refused(
                "is given along x, but the images of a body in a periodic shear flow have other velocities along x; \
                 write \"free\" for x, or put walls across the gradient",
            );
        }
        Ok(())
    }

    fn check_orientation(&self, section: &str, p: &Parameters) -> Result<(), ParameterError> {
        match &self.orientation {
            BodyOrientation::Random => Ok(()),
            BodyOrientation::Aligned(axis) => {
                let (key, axis) = (format!("{section}.orientation_axis"), p.user_axes().vector(*axis));
                ParameterError::require_finite_vector(&key, axis)?;
                if axis.normalize_or_zero() == Vector::ZERO {
                    let message = "has no direction; one of its numbers needs to be other than 0";
                    return Err(ParameterError::new(key, message));
                }
                Ok(())
            }
            BodyOrientation::Each(list) => {
                let key = format!("{section}.orientations");
                if list.len() as u64 != self.count {
                    let message = format!("has {} orientations for a count of {}", list.len(), self.count);
                    return Err(ParameterError::new(key, message));
                }
                match list.iter().position(|q| !(q.length() > 0.0 && q.length().is_finite())) {
                    Some(row) => {
                        let message = "is no rotation; write w, x, y, z of a quaternion, not all of them 0";
                        Err(ParameterError::new(format!("{key}[{row}]"), message))
                    }
                    None => Ok(()),
                }
            }
        }
    }
}

impl Parameters {
    /// These parameters with rigid bodies in addition, and with the species of their spheres. It is called once, when
    /// the other species are complete.
    #[must_use]
    pub fn with_bodies(mut self, bodies: Vec<Bodies>) -> Self {
        self.species.extend(bodies.iter().flat_map(Bodies::species));
        Self { bodies, ..self }
    }

    /// Kinds of bodies of whose motion some components are given.
    pub(crate) fn kinds_with_given_motion(&self) -> impl Iterator<Item = usize> {
        (0..self.bodies.len()).filter(|&kind| !self.bodies[kind].motion.is_none())
    }

    /// Kinds of groups of spheres that are placed together: bodies, or filaments, which are straight at the start.
    pub(crate) fn placed_together(&self) -> Vec<&Bodies> {
        self.bodies.iter().chain(self.filaments.iter().map(|filaments| &filaments.rods)).collect()
    }

    /// Number of species of spheres that belong to no body or filament. They are the first ones.
    pub(crate) fn free_species(&self) -> usize {
        self.species.len() - self.placed_together().iter().map(|kind| kind.radii().len()).sum::<usize>()
    }

    /// The species of each sphere of a kind of bodies or filaments, by its index in [`Self::placed_together`].
    pub(crate) fn species_of_body(&self, kind: usize) -> Vec<u32> {
        let kinds = self.placed_together();
        let before = kinds[..kind].iter().map(|kind| kind.radii().len()).sum::<usize>();
        let (first, radii) = (self.free_species() + before, kinds[kind].radii());
        let is_its = |one: &BodySphere, radius: &f64| one.radius.total_cmp(radius).is_eq();
        let place = |one| radii.iter().position(|radius| is_its(one, radius)).expect("one of the radii");
        kinds[kind].spheres.iter().map(|one| (first + place(one)) as u32).collect()
    }

    /// Number of spheres that belong to no body or filament. Their ids come first, and those of bodies follow, body by
    /// body.
    pub(crate) fn free_spheres(&self) -> u64 {
        self.species[..self.free_species()].iter().map(|species| species.count.unwrap_or(0)).sum()
    }

    /// The place in bodies of the sphere of an id; `None` for one that belongs to none.
    pub(crate) fn member(&self, id: u64) -> Option<BodyMember> {
        let (mut rest, mut before) = (id.checked_sub(self.free_spheres())?, 0);
        for (kind, bodies) in self.bodies.iter().enumerate() {
            let each = bodies.spheres.len() as u64;
            if rest < each * bodies.count {
                let number = rest / each;
                return Some(BodyMember { kind, number, body: before + number, sphere: (rest % each) as usize });
            }
            (rest, before) = (rest - each * bodies.count, before + bodies.count);
        }
        None
    }

    /// Smallest gap between a body and its own images, over the largest radius: they have no forces on each other.
    fn image_gap(&self) -> f64 {
        let cutoff = self.hydrodynamics.lubrication_cutoff.unwrap_or(LubricationRange::WIDE);
        if self.hydrodynamics.lubrication { cutoff } else { 1.0 }
    }
}

/// Checks all bodies.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    if p.bodies.is_empty() {
        return Ok(());
    }
    check_methods(p)?;
    p.bodies.iter().enumerate().try_for_each(|(index, bodies)| bodies.check(&format!("bodies[{index}]"), p))
}

/// Refuses what bodies can't be together with.
fn check_methods(p: &Parameters) -> Result<(), ParameterError> {
    let two_evaluations = Integrator::Brownian(BrownianScheme::TwoEvaluations);
    let is_straight = matches!(p.flow, Flow::Shear { lees_edwards: false, .. }) && p.cell.is_periodic(2);
    let refusals = [
        (is_straight, "flow.lees_edwards", "is false"),
        (p.hydrodynamics.multipoles == MultipoleOrder::Monopole, "hydrodynamics.multipoles", "is \"monopole\""),
        (p.integrator == two_evaluations, "time.brownian", "is \"random-finite-difference\""),
        (p.flow.keeps_flux(), "flow.mean_velocity", "is set"),
        (p.repulsion.is_some_and(|repulsion| repulsion.calibrate), "repulsion.calibrate", "is true"),
        (!p.bonds.is_empty(), "bonds", "is set"),
        (!p.traps.is_empty(), "traps", "is set"),
    ];
    match refusals.into_iter().find(|(is_refused, ..)| *is_refused) {
        Some((_, key, words)) => {
            Err(ParameterError::new(key, format!("{words}, which can't be with [[bodies]] yet; leave one of them out")))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{BodyShape, EqualSpheres, PeriodicBox};

    fn pair(radii: [f64; 2]) -> Vec<BodySphere> {
        let at = |x: f64, radius: f64| BodySphere { position: Vector::X * x, radius };
        vec![at(0.0, radii[0]), at(radii[0] + radii[1], radii[1])]
    }

    fn model(bodies: Vec<Bodies>) -> Parameters {
        let cell = PeriodicBox::new(Vector::splat(30.0)).unwrap();
        Parameters::new(cell, 1.0, vec![Species::new("free", 1.0, 5)], 0.1, 1).with_bodies(bodies)
    }

    #[test]
    fn spheres_of_bodies_are_numbered_after_the_others() {
        let rod = BodyShape::Rod(EqualSpheres { number: 3, radius: 0.5, gap: 0.0 }).spheres();
        let p = model(vec![Bodies::new("pairs", pair([1.0, 2.0]), 2), Bodies::new("rods", rod, 3)]);
        let names: Vec<&str> = p.species.iter().map(|species| species.name.as_str()).collect();
        assert_eq!(names, ["free", "pairs 1", "pairs 2", "rods"]);
        assert_eq!(p.species.iter().map(|species| species.count.unwrap()).collect::<Vec<_>>(), [5, 2, 2, 9]);
        assert_eq!((p.free_spheres(), p.member(4)), (5, None));
        assert_eq!(p.member(7), Some(BodyMember { kind: 0, number: 1, body: 1, sphere: 0 }));
        assert_eq!(p.member(14), Some(BodyMember { kind: 1, number: 1, body: 3, sphere: 2 }));
        assert_eq!((p.member(17).map(|one| one.body), p.member(18)), (Some(4), None));
        assert_eq!((p.species_of_body(0), p.species_of_body(1)), (vec![1, 2], vec![3; 3]));
        assert_eq!(check(&p), Ok(()));
    }

    /// The loads of the spheres add up to those of the body, without another torque about its centre.
    #[test]
    fn loads_act_at_the_centre() {
        let [force, torque] = [Vector::new(1.0, 2.0, 3.0), Vector::new(0.0, -1.0, 4.0)];
        let p = model(vec![Bodies { force, torque, ..Bodies::new("pairs", pair([1.0, 2.0]), 2) }]);
        let of_spheres = || p.species[1..].iter().zip(&p.bodies[0].spheres);
        assert!((of_spheres().map(|(one, _)| one.force).sum::<Vector>() - force).length() < 1e-14);
        assert!((of_spheres().map(|(one, _)| one.torque).sum::<Vector>() - torque).length() < 1e-14);
        let moment = of_spheres().map(|(one, sphere)| sphere.position.cross(one.force)).sum::<Vector>();
        assert!(moment.length() < 1e-14, "{moment}");
    }

    #[test]
    fn bodies_out_of_range_are_named() {
        let said = |change: &dyn Fn(&mut Bodies)| {
            let mut bodies = Bodies::new("pairs", pair([1.0, 1.0]), 2);
            change(&mut bodies);
            check(&model(vec![bodies])).unwrap_err().to_string()
        };
        assert!(said(&|bodies| bodies.count = 0).starts_with("bodies[0].count is 0; "));
        assert!(said(&|bodies| bodies.spheres.clear()).starts_with("bodies[0].spheres needs"));
        assert!(said(&|bodies| bodies.spheres[0].position.x = 40.0).starts_with("bodies[0] has a diameter of 82"));
        assert!(said(&|bodies| bodies.positions = Some(Vec::new())).starts_with("bodies[0].positions has 0 "));
        assert!(said(&|bodies| bodies.force.x = f64::NAN).starts_with("bodies[0].force"));
        let each = |bodies: &mut Bodies| bodies.orientation = BodyOrientation::Each(vec![Quaternion::NONE; 2]);
        assert!(said(&each).starts_with("bodies[0].orientations[0] is no rotation"));
        let along = |bodies: &mut Bodies| bodies.orientation = BodyOrientation::Aligned(Vector::ZERO);
        assert!(said(&along).starts_with("bodies[0].orientation_axis has no direction"));
    }
}
