//! The quantities that suspensions are run for.

use super::course::Course;
use domain::{Boundaries, Vector, sphere};
use files::Observables;
use statistics::Moduli;
use suspension::{Flow, Model};

const STRESS: &str = "force/length^2";
const VELOCITY: &str = "length/time";
const FORCES: [&str; 3] = ["driving_force_x", "driving_force_y", "driving_force_z"];
const TORQUES: [&str; 3] = ["driving_torque_x", "driving_torque_y", "driving_torque_z"];

/// A suspension and its time series.
pub(super) struct RecordedSuspension<'a> {
    pub(super) model: &'a Model,
    pub(super) series: &'a Observables,
}

impl RecordedSuspension<'_> {
    /// The columns of the series that quantities are made of.
    pub(super) const COLUMNS: [&'static str; 26] = [
        "relative_viscosity",
        "first_normal_stress_difference",
        "second_normal_stress_difference",
        "particle_pressure",
        "shear_rate",
        "extension_rate",
        "shear_stress",
        "osmotic_pressure",
        "mean_velocity",
        "velocity_variance",
        "height",
        "particle_flux",
        "migration",
        "pressure_gradient",
        "wall_shear_stress",
        "contacts_per_particle",
        "segregation",
        "bond_energy",
        "bending_energy",
        "filaments",
        "orientation",
        "driving_force",
        "driving_torque",
        "swimming",
        "close_neighbours",
        "largest_cluster",
    ];

    /// The quantities that a suspension of this kind is run for, the first ones first.
    pub(super) fn courses(&self) -> Vec<Course> {
        let lists = [
            self.oscillation(),
            self.stress(),
            self.osmotic_pressure(),
            self.settling(),
            self.heights(),
            self.channel(),
            self.structure(),
            self.orientations(),
            self.driving_loads(),
            self.swimmers(),
        ];
        lists.into_iter().flatten().collect()
    }

    /// The time from which the flow is the last one.
    pub(super) fn begins(&self) -> f64 {
        let (_, step) = self.model.shear_rates().before(self.last_step());
        step as f64 * self.model.time_step
    }

    fn last_step(&self) -> u64 {
        self.series.last_step.unwrap_or(0)
    }

    /// In a shear flow or an extension at a steady rate or stress.
    fn stress(&self) -> Vec<Course> {
        let rates = self.model.shear_rates();
        // In a box that stays straight the flow jumps at its faces, and the stress is not that of a shear flow.
        let is_periodic = self.model.cell.boundaries() == Boundaries::Periodic;
        let jumps = is_periodic && matches!(self.model.flow, Flow::Shear { lees_edwards: false, .. });
        if jumps || rates.frequency().is_some() {
            return Vec::new();
        }
        let viscosity = self.model.viscosity;
        let (last_rate, _) = rates.before(self.last_step());
        let of_fluid = rates.stress().map_or(viscosity * last_rate, |_| viscosity * self.mean("shear_rate").abs());
        let name =
            if self.model.flow.extension().is_some() { "relative_extensional_viscosity" } else { "relative_viscosity" };
        let mut courses = Vec::new();
        if let (Some(stress), Some(found)) = (rates.stress(), self.number("shear_rate")) {
            courses.push(Course::new("shear_rate", "1/time", found.clone()));
            courses.push(Course::new(name, "", found).inverse(stress / viscosity));
        } else {
            courses.extend(self.number("relative_viscosity").map(|values| Course::new(name, "", values)));
        }
        let scale = self.mean("relative_viscosity").abs() * of_fluid.abs();
        for (column, reduced) in [
            ("first_normal_stress_difference", "reduced_first_normal_stress_difference"),
            ("second_normal_stress_difference", "reduced_second_normal_stress_difference"),
            ("particle_pressure", "reduced_particle_pressure"),
        ] {
            let course = |values| Course::new(column, STRESS, values).beside(scale).also_over(reduced, of_fluid.abs());
            courses.extend(self.number(column).map(course));
        }
        courses.into_iter().map(Course::of_stress).collect()
    }

    /// The moduli of a suspension that is strained to and fro, a value for each whole period.
    fn oscillation(&self) -> Vec<Course> {
        let rates = self.model.shear_rates();
        let (Some(frequency), Some(stress)) = (rates.frequency(), self.number("shear_stress")) else {
            return Vec::new();
        };
        let mut moduli = Moduli::new(rates.largest() / frequency, frequency);
        let (mut storage, mut loss) = (Vec::new(), Vec::new());
        for (&time, stress) in self.series.times.iter().zip(stress) {
            let [elastic, viscous] = moduli.add(time, stress).unwrap_or([f64::NAN; 2]);
            storage.push(elastic);
            loss.push(viscous);
        }
        let size = loss.iter().filter(|loss| loss.is_finite()).fold(0.0, |most: f64, loss| most.max(loss.abs()));
        [("storage_modulus", storage), ("loss_modulus", loss)]
            .map(|(name, values)| Course::new(name, STRESS, values).beside(size).of_means().of_stress())
            .into()
    }

    fn osmotic_pressure(&self) -> Vec<Course> {
        let course = |values| Course::new("osmotic_pressure", STRESS, values);
        self.number("osmotic_pressure").map(course).into_iter().collect()
    }

    /// Settling velocities of the spheres along the forces on them, in a box without a bottom, and the variances of
    /// their velocities.
    fn settling(&self) -> Vec<Course> {
        let total: Vector = self.forces().iter().sum();
        if self.is_stopped(total) {
            return Vec::new();
        }
        let (viscosity, forces) = (self.model.viscosity, self.forces());
        let stokes = |index: usize| forces[index].length() / sphere::drag(viscosity, self.model.species[index].radius);
        let fastest = (0..forces.len()).map(stokes).fold(0.0, f64::max);
        let mut courses = Vec::new();
        for (index, species) in self.model.species.iter().enumerate() {
            let along = if forces[index] == Vector::ZERO { total } else { forces[index] }.normalize_or_zero();
            let Some(velocity) = self.along("mean_velocity", index, along).filter(|_| along != Vector::ZERO) else {
                continue;
            };
            let scale = if forces[index] == Vector::ZERO { fastest } else { 0.0 };
            let course = Course::new("settling_velocity", VELOCITY, velocity).beside(scale).of_species(&species.name);
            courses.push(course.also_over("hindered_settling_function", stokes(index)));
            courses.extend(self.fluctuations(index, along));
        }
        courses
    }

    /// Root mean square fluctuations along the direction of settling and, of one component, across it.
    fn fluctuations(&self, index: usize, along: Vector) -> Vec<Course> {
        // Velocities of Brownian spheres are those of the noise.
        let squares = along * along;
        let components = [0, 1, 2].map(|axis| self.component("velocity_variance", index, axis));
        let ([Some(x), Some(y), Some(z)], None) = (components, self.model.thermal_energy) else { return Vec::new() };
        if [&x, &y, &z].iter().all(|values| values.iter().all(|&value| value == 0.0)) {
            return Vec::new();
        }
        let weighted = |weights: Vector| -> Vec<f64> {
            let rows = x.iter().zip(&y).zip(&z);
            rows.map(|((x, y), z)| weights.dot(Vector::new(*x, *y, *z))).collect()
        };
        let directions = [
            ("velocity_fluctuation_parallel", squares),
            ("velocity_fluctuation_perpendicular", 0.5 * (Vector::ONE - squares)),
        ];
        let name = &self.model.species[index].name;
        directions
            .map(|(quantity, weights)| Course::new(quantity, VELOCITY, weighted(weights)).root().of_species(name))
            .into()
    }

    /// Heights of the spheres above a bottom towards which they settle.
    fn heights(&self) -> Vec<Course> {
        let total: Vector = self.forces().iter().sum();
        let is_settled = self.is_stopped(total);
        let columns = [("mean_height", 0), ("height_deviation", 1)];
        let of_species = |(index, species): (usize, &suspension::Species)| {
            let course = move |(name, column)| {
                Some(Course::new(name, "length", self.component("height", index, column)?).of_species(&species.name))
            };
            columns.into_iter().filter_map(course).collect::<Vec<_>>()
        };
        self.model.species.iter().enumerate().filter(|_| is_settled).flat_map(of_species).collect()
    }

    /// Between walls along which the suspension flows.
    fn channel(&self) -> Vec<Course> {
        let (flow, boundaries) = (self.model.flow, self.model.cell.boundaries());
        if boundaries != Boundaries::Walls || flow == Flow::None {
            return Vec::new();
        }
        let (height, axes) = (self.model.cell.edges().z, self.model.user_axes());
        let of_parabola =
            flow.curvature(self.model.viscosity, height).map(|curvature| curvature * height * height / 12.0);
        let mean_speed = of_parabola.unwrap_or(0.5 * flow.rate() * height).abs();
        let mut courses: Vec<Course> = self
            .number("pressure_gradient")
            .map(|values| Course::new("pressure_gradient", "force/length^3", values))
            .into_iter()
            .collect();
        for (index, species) in self.model.species.iter().enumerate() {
            let slip = self.component("mean_velocity", index, axes.axis(0));
            let of_flow = [
                self.component("particle_flux", index, 0)
                    .filter(|_| of_parabola.is_some())
                    .map(|v| Course::new("particle_flux", VELOCITY, v)),
                slip.map(|values| Course::new("slip_velocity", VELOCITY, values).beside(mean_speed)),
                self.component("migration", index, 0).map(|values| Course::new("migration", "", values)),
            ];
            courses.extend(of_flow.into_iter().flatten().map(|course| course.of_species(&species.name)));
        }
        if of_parabola.is_none() {
            for (row, name) in ["lower_wall_shear_stress", "upper_wall_shear_stress"].into_iter().enumerate() {
                courses.extend(
                    self.component("wall_shear_stress", row, 0)
                        .map(|values| Course::new(name, STRESS, values).of_stress()),
                );
            }
        }
        courses
    }

    /// Contacts per sphere, segregation, energies of bonds, and the extent of filaments.
    fn structure(&self) -> Vec<Course> {
        let columns = [
            (("contacts_per_particle", ""), 1.0),
            (("segregation", ""), 1.0),
            (("bond_energy", "force*length"), 0.0),
            (("bending_energy", "force*length"), 0.0),
        ];
        let course = |(what, scale): ((&'static str, &'static str), f64)| {
            Some(Course::new(what.0, what.1, self.number(what.0)?).beside(scale))
        };
        let extent = |(row, filaments): (usize, &suspension::Filaments)| {
            let course = Course::new("end_to_end_distance", "", self.component("filaments", row, 0)?);
            Some(course.of_species(&filaments.rods.name).beside(1.0))
        };
        let extents = self.model.filaments.iter().enumerate().filter_map(extent);
        columns.into_iter().filter_map(course).chain(extents).collect()
    }

    /// Polar and nematic order of the species with orientations.
    fn orientations(&self) -> Vec<Course> {
        let oriented = self.model.species.iter().filter(|species| species.orientation.is_some()).enumerate();
        let orders = [("polar_order", 3), ("nematic_order", 4)];
        let of_species = |(row, species): (usize, &suspension::Species)| {
            let course = |(name, column)| {
                Some(
                    Course::new(name, "", self.component("orientation", row, column)?)
                        .of_species(&species.name)
                        .beside(1.0),
                )
            };
            orders.map(course)
        };
        oriented.flat_map(of_species).flatten().collect()
    }

    /// Mean loads that the given motions of bodies take, along the components that are given.
    fn driving_loads(&self) -> Vec<Course> {
        let back = self.model.turn.inverse();
        let driven = self.model.bodies.iter().filter(|kind| !kind.motion.is_none()).enumerate();
        let of_kind = |(row, kind): (usize, &suspension::Bodies)| {
            let forces = ("driving_force", "force", FORCES, back.components(kind.motion.velocity));
            let torques = ("driving_torque", "force*length", TORQUES, back.components(kind.motion.angular_velocity));
            [forces, torques]
                .into_iter()
                .flat_map(|(column, unit, names, given)| {
                    let course = |axis: usize| {
                        let values = self.component(column, row, axis).filter(|_| given[axis].is_some())?;
                        Some(Course::new(names[axis], unit, values).of_species(&kind.name))
                    };
                    (0..3).filter_map(course).collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        };
        driven.flat_map(of_kind).collect()
    }

    /// Mean speed of each species that swims along its axes, also over that of one alone, and clusters.
    fn swimmers(&self) -> Vec<Course> {
        let swimming =
            self.model.species.iter().filter_map(|species| Some((&species.name, species.swimming.as_ref()?)));
        let speed = |(row, (name, swimming)): (usize, (&String, &suspension::Swimming))| {
            let course = Course::new("swimming_speed", VELOCITY, self.component("swimming", row, 0)?).of_species(name);
            Some(course.beside(swimming.speed).also_over("reduced_swimming_speed", swimming.speed))
        };
        let cluster = |name| Some(Course::new(name, "", self.number(name)?).beside(1.0));
        let clusters = ["close_neighbours", "largest_cluster"].into_iter().filter_map(cluster);
        swimming.enumerate().filter_map(speed).chain(clusters).collect()
    }

    /// The steady force on a sphere of each species, in the axes of the user.
    fn forces(&self) -> Vec<Vector> {
        let axes = self.model.user_axes();
        self.model.species.iter().map(|s| axes.vector(s.force_on(s.radius, self.model.gravity))).collect()
    }

    /// Whether spheres on which a force acts come to a wall.
    fn is_stopped(&self, force: Vector) -> bool {
        let walls = self.model.cell.boundaries().walls() > 0;
        let across = self.model.user_axes().vector_in(force).z.abs();
        walls && across > 1e-3 * force.length()
    }

    fn number(&self, name: &str) -> Option<Vec<f64>> {
        self.component(name, 0, 0)
    }

    /// The numbers of a row and a column of a quantity.
    fn component(&self, name: &str, row: usize, column: usize) -> Option<Vec<f64>> {
        let quantity = self.series.get(name)?;
        let is_there = row < quantity.rows.len().max(1) && column < quantity.columns.len().max(1);
        is_there.then(|| quantity.column(row, column).collect())
    }

    /// The component of a vector along a direction.
    fn along(&self, name: &str, row: usize, direction: Vector) -> Option<Vec<f64>> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.component(name, row, axis));
        let (x, y, z) = (x?, y?, z?);
        let rows = x.iter().zip(&y).zip(&z);
        Some(rows.map(|((x, y), z)| direction.dot(Vector::new(*x, *y, *z))).collect())
    }

    /// The mean of what is finite of a quantity; 0 of nothing.
    fn mean(&self, name: &str) -> f64 {
        let values: Vec<f64> = self.number(name).into_iter().flatten().filter(|value| value.is_finite()).collect();
        values.iter().sum::<f64>() / values.len().max(1) as f64
    }
}
