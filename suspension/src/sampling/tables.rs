//! Statistics as tables.

use super::Statistics;
use super::channel::ChannelSampling;
use super::rotations;
use super::vectors::VectorMoments;
use simulation::Table;
use statistics::{
    Angle, Diffusivity, Estimate, LagSums, Moduli, PairDistribution, Profile, StretchedExponential, global_coefficient,
    mean_coefficient,
};

const AXES: [&str; 3] = ["x", "y", "z"];
const COMPONENTS: [&str; 6] = ["xx", "xy", "xz", "yy", "yz", "zz"];
/// Name of all particles together, used like that of a species.
const ALL: &str = "all";

/// Unknown diffusivity.
const UNKNOWN: Estimate = Estimate { mean: f64::NAN, error: f64::NAN, converged: false };

/// The diffusivity, or unknown if its error is unknown or exceeds its value.
fn known(diffusivity: Estimate) -> Estimate {
    let is_known = diffusivity.error.is_finite() && diffusivity.mean > diffusivity.error;
    if is_known { diffusivity } else { UNKNOWN }
}

/// Results of all samples, with the sums over all blocks.
struct Results<'a> {
    of: &'a Statistics,
    lags: LagSums,
    /// Sums of rotations, if some species has orientations.
    rotations: Option<LagSums>,
    /// Profile, in a fully periodic box.
    profile: Option<Profile>,
}

impl Statistics {
    /// All tables on the first rank, the summary first; empty before the first sample. Collective.
    pub fn tables(&mut self) -> Vec<Table> {
        if self.times[2] == 0.0 {
            return Vec::new();
        }
        self.settle();
        let lags: Vec<_> = self.kept.iter().map(|kept| kept.lagrangian.sums().into_numbers()).collect();
        let lags = LagSums::of_numbers(self.about.names.len(), self.blocks.total(&lags));
        let (rotations, profile) = (self.total_rotations(), self.total_profile());
        let tables = || Results { of: self, lags, rotations, profile }.tables();
        if self.blocks.comm().is_first() { tables() } else { Vec::new() }
    }

    /// Collective.
    fn total_rotations(&self) -> Option<LagSums> {
        if self.about.oriented.is_empty() {
            return None;
        }
        let sums = self.kept.iter().flat_map(|kept| &kept.rotations).map(|rotations| rotations.sums().into_numbers());
        Some(LagSums::of_numbers(self.about.names.len(), self.blocks.total(&sums.collect::<Vec<_>>())))
    }

    fn total_profile(&self) -> Option<Profile> {
        let volumes = self.kept.iter().map(|kept| kept.profile.iter().flat_map(Profile::volumes).copied().collect());
        let total = self.blocks.total(&volumes.collect::<Vec<_>>());
        self.kept.first()?.profile.as_ref().map(|profile| profile.with_volumes(total))
    }
}

impl Results<'_> {
    fn tables(&self) -> Vec<Table> {
        let mut tables = vec![
            self.summary(),
            densities("velocity_density", &self.of.about.names, &self.of.velocities),
            densities("angular_velocity_density", &self.of.about.names, &self.of.angular_velocities),
            self.lags(),
        ];
        tables.extend(self.rotations.iter().map(|lags| rotations::table(lags, &self.of.about.oriented)));
        tables.extend(self.of.pairs.iter().flat_map(|pairs| [self.radial(pairs), self.by_angle(pairs)]));
        tables.extend(self.profile.iter().map(|profile| self.concentration(profile)));
        tables.extend(self.of.channel.iter().map(|channel| self.across(channel)));
        tables.extend(self.measured_moduli().map(harmonics));
        tables
    }

    /// Moduli, once a whole period was sampled.
    fn measured_moduli(&self) -> Option<&Moduli> {
        self.of.moduli.as_ref().filter(|moduli| moduli.periods() > 0)
    }

    /// Table of single numbers with their errors.
    fn summary(&self) -> Table {
        let columns = [("value", ""), ("error", ""), ("converged", "")];
        let mut summary = Summary(Table::new("summary", &["quantity", "species", "unit"], &columns));
        let [first, last, samples] = self.of.times.map(|mean| Estimate { mean, error: 0.0, converged: true });
        summary.add("first_time", ALL, "time", first);
        summary.add("last_time", ALL, "time", last);
        summary.add("samples", ALL, "", samples);
        for (name, (&(radius, fraction), vectors)) in
            self.of.about.names.iter().zip(self.of.about.species.iter().zip(&self.of.velocities))
        {
            let exact = |mean| Estimate { mean, error: 0.0, converged: true };
            summary.add("radius", name, "length", exact(radius));
            summary.add("volume_fraction", name, "", exact(fraction));
            summary.add_moments(name, ["mean_velocity", "T"], ["length/time", "length^2/time^2"], vectors);
        }
        for (name, vectors) in
            self.of.about.names.iter().zip(&self.of.angular_velocities).filter(|_| self.of.about.rigid)
        {
            summary.add_moments(name, ["mean_angular_velocity", "w"], ["1/time", "1/time^2"], vectors);
        }
        if let Some((_, moduli)) = self.measured_moduli().and_then(|moduli| moduli.estimates().next()) {
            for (name, found) in ["storage_modulus", "loss_modulus"].into_iter().zip(moduli) {
                summary.add(name, ALL, "force/length^2", found);
            }
        }
        // Not known from a trajectory.
        if let Some(pressure) = self.of.pressure.as_ref().filter(|pressure| pressure.count() > 0) {
            summary.add("pressure_gradient", ALL, "force/length^3", pressure.estimate());
        }
        self.add_diffusivities(&mut summary);
        self.add_rotational_diffusivities(&mut summary);
        if let Some(channel) = &self.of.channel {
            summary.add("volume_outside", ALL, "", channel.profile.outside());
        }
        if self.of.about.names.len() > 1 {
            summary.add("segregation", ALL, "", self.of.segregation.estimate());
        }
        summary.0
    }

    /// Window of time lags in which motion is diffusive.
    fn diffusive(&self) -> [f64; 2] {
        let span = self.of.times[1] - self.of.times[0];
        [self.of.about.wanted.diffusive_from.unwrap_or(0.25 * span), 0.5 * span]
    }

    fn add_rotational_diffusivities(&self, summary: &mut Summary) {
        let Some(lags) = &self.rotations else { return };
        for (index, name) in &self.of.about.oriented {
            let found = rotations::diffusivity(lags, *index, self.diffusive());
            summary.add("rotational_diffusivity", name, "1/time", known(found));
        }
    }

    fn add_diffusivities(&self, summary: &mut Summary) {
        let window = self.diffusive();
        let unit = "length^2/time";
        let mut by_species = Vec::new();
        for (index, name) in self.of.about.names.iter().map(String::as_str).chain([ALL]).enumerate() {
            let species = (name != ALL).then_some(index);
            let found = Diffusivity::of(&self.lags, species, window);
            for (axis, letter) in AXES.iter().enumerate() {
                // With Brownian motion, velocities are displacements over the step and depend on its length.
                let by_integral = if self.of.about.is_brownian { UNKNOWN } else { known(found.by_integral[axis]) };
                summary.add(&format!("D_integral_{letter}"), name, unit, by_integral);
                summary.add(&format!("D_slope_{letter}"), name, unit, known(found.by_slope[axis]));
            }
            by_species.push(known(found.by_slope[1]));
        }
        if let (Some(all), true) = (by_species.pop(), self.of.about.flow.shear_rate() != 0.0) {
            self.add_bidisperse(summary, all, &by_species);
        }
    }

    /// Adds [`global_coefficient`] and [`mean_coefficient`], eqs. (18) and (19), along the gradient.
    fn add_bidisperse(&self, summary: &mut Summary, all: Estimate, by_species: &[Estimate]) {
        let (species, rate) = (&self.of.about.species, self.of.about.flow.shear_rate());
        let scaled = by_species.iter().zip(species).map(|(d, (a, _))| d.mean / (a * a * rate.abs()));
        let own: Vec<f64> = scaled.collect();
        let global = |d: f64| global_coefficient(d, species, rate);
        let mean = |d: f64| mean_coefficient(global(d), species, &own);
        let scaled = |by: &dyn Fn(f64) -> f64| Estimate { mean: by(all.mean), error: by(all.error), ..all };
        summary.add("D_global_y", ALL, "", scaled(&global));
        summary.add("D_mean_y", ALL, "", scaled(&mean));
    }

    fn lags(&self) -> Table {
        let mut columns = vec![("time".to_owned(), "time")];
        for (name, unit) in
            [("correlation", "length^2/time^2"), ("displacement", "length^2"), ("integral", "length^2/time")]
        {
            columns.extend(AXES.map(|axis| (format!("{name}_{axis}"), unit)));
        }
        let mut table = Table { columns, ..Table::new("lags", &["species"], &[]) };
        for (index, name) in self.of.about.names.iter().map(String::as_str).chain([ALL]).enumerate() {
            for lag in self.lags.lags((name != ALL).then_some(index)) {
                let vectors =
                    [lag.correlation, lag.mean_square_displacement, lag.correlation_integral].map(|v| v.to_array());
                let numbers: Vec<f64> = std::iter::once(lag.time).chain(vectors.concat()).collect();
                table.add(&[name], &numbers);
            }
        }
        table
    }

    fn radial(&self, pairs: &PairDistribution) -> Table {
        let mut table = Table::new("pairs", &["first", "second"], &[("distance", "length"), ("g", "")]);
        for [a, b] in pairs.species_pairs() {
            for (r, g) in pairs.radial([a, b]) {
                table.add(&[&self.of.about.names[a], &self.of.about.names[b]], &[r, g]);
            }
        }
        table
    }

    fn by_angle(&self, pairs: &PairDistribution) -> Table {
        let angle = if self.of.about.angle == Angle::Azimuth { "azimuth" } else { "cosine" };
        let columns = [("distance", "length"), (angle, ""), ("g", "")];
        let mut table = Table::new("pairs_by_angle", &["first", "second"], &columns);
        for [a, b] in pairs.species_pairs() {
            for (r, angle, g) in pairs.angular([a, b]) {
                table.add(&[&self.of.about.names[a], &self.of.about.names[b]], &[r, angle, g]);
            }
        }
        table
    }

    fn concentration(&self, profile: &Profile) -> Table {
        let columns = [(AXES[self.of.about.axis], "length"), ("volume_fraction", "")];
        let mut table = Table::new("concentration", &["species"], &columns);
        for (index, name) in self.of.about.names.iter().enumerate() {
            for (place, fraction) in profile.fractions(index) {
                table.add(&[name], &[place, fraction]);
            }
        }
        table
    }
}

/// Quantities of a profile across a channel, with the components that have columns, and units.
const ACROSS: [(&str, &[&str], &str); 6] = [
    ("velocity", &AXES, "length/time"),
    ("slip", &AXES, "length/time"),
    ("T", &COMPONENTS, "length^2/time^2"),
    ("angular_velocity", &AXES, "1/time"),
    ("stress", &COMPONENTS, "force/length^2"),
    ("pair_stress", &COMPONENTS, "force/length^2"),
];

impl Results<'_> {
    /// Averages in bins across the channel.
    fn across(&self, ChannelSampling { profile, axis, .. }: &ChannelSampling) -> Table {
        let scalars = [("volume_fraction".to_owned(), ""), ("number_density".to_owned(), "1/length^3")];
        let component = |(name, of, unit): &(&str, &[&str], &'static str)| -> Vec<(String, &'static str)> {
            of.iter().map(|component| (format!("{name}_{component}"), *unit)).collect()
        };
        // A trajectory has no forces between spheres.
        let known = if profile.has_pair_stress() { &ACROSS[..] } else { &ACROSS[..ACROSS.len() - 1] };
        let quantities = scalars.into_iter().chain(known.iter().flat_map(component));
        let mut columns = vec![(AXES[*axis].to_owned(), "length")];
        columns.extend(quantities.flat_map(|(name, unit)| [(name.clone(), unit), (name + "_error", unit)]));
        let mut table = Table { columns, ..Table::new("profile", &["species"], &[]) };
        for (index, name) in self.of.about.names.iter().map(String::as_str).chain([ALL]).enumerate() {
            for row in profile.rows((name != ALL).then_some(index)) {
                let scalars = [row.volume_fraction, row.number_density].into_iter().chain(row.velocity).chain(row.slip);
                let all = scalars.chain(row.fluctuations).chain(row.angular_velocity).chain(row.stress);
                let pairs = row.pair_stress.into_iter().filter(|_| profile.has_pair_stress());
                let numbers = all.chain(pairs).flat_map(|found| [found.mean, found.error]);
                table.add(&[name], &std::iter::once(row.height).chain(numbers).collect::<Vec<_>>());
            }
        }
        table
    }
}

fn harmonics(moduli: &Moduli) -> Table {
    let unit = "force/length^2";
    let columns = [
        ("harmonic", ""),
        ("storage_modulus", unit),
        ("storage_modulus_error", unit),
        ("loss_modulus", unit),
        ("loss_modulus_error", unit),
    ];
    let mut table = Table::new("harmonics", &[], &columns);
    for (n, [storage, loss]) in moduli.estimates() {
        table.add(&[], &[f64::from(n), storage.mean, storage.error, loss.mean, loss.error]);
    }
    table
}

/// The table of single numbers.
struct Summary(Table);

impl Summary {
    fn add(&mut self, quantity: &str, species: &str, unit: &str, found: Estimate) {
        let converged = f64::from(u8::from(found.converged));
        self.0.add(&[quantity, species, unit], &[found.mean, found.error, converged]);
    }

    fn add_moments(&mut self, species: &str, [mean, tensor]: [&str; 2], units: [&str; 2], vectors: &VectorMoments) {
        let times = |found: Estimate, unit| Estimate { mean: found.mean * unit, error: found.error * unit, ..found };
        for (axis, found) in AXES.iter().zip(vectors.moments.mean()) {
            self.add(&format!("{mean}_{axis}"), species, units[0], times(found, vectors.unit));
        }
        for (component, found) in COMPONENTS.iter().zip(vectors.moments.components()) {
            self.add(&format!("{tensor}_{component}"), species, units[1], times(found, vectors.unit.powi(2)));
        }
        for (axis, density) in AXES.iter().zip(&vectors.densities) {
            if let Some(fit) = StretchedExponential::fitted(density) {
                let exact = |mean| Estimate { mean, error: f64::NAN, converged: true };
                self.add(&format!("{tensor}_{axis}_tail_exponent"), species, "", exact(fit.exponent));
                self.add(&format!("{tensor}_{axis}_tail_scale"), species, "", exact(fit.scale));
            }
        }
    }
}

/// Probability densities of fluctuations in units of the standard deviation, with the best fit by a stretched
/// exponential.
fn densities(name: &'static str, species: &[String], vectors: &[VectorMoments]) -> Table {
    let columns = [("deviations", ""), ("density", ""), ("stretched_exponential", "")];
    let mut table = Table::new(name, &["species", "axis"], &columns);
    for (species, vectors) in species.iter().zip(vectors) {
        for (axis, density) in AXES.iter().zip(&vectors.densities) {
            let Some(fit) = StretchedExponential::fitted(density) else { continue };
            for (x, p) in density.normalised() {
                table.add(&[species, axis], &[x, p, fit.density(x)]);
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diffusivities_that_may_be_none_have_no_value() {
        let of = |mean, error| known(Estimate { mean, error, converged: true });
        for unknown in [of(-0.008, 0.034), of(-0.17, 0.01), of(0.03, 0.034), of(0.35, f64::INFINITY), of(f64::NAN, 0.1)]
        {
            assert!(unknown.mean.is_nan() && unknown.error.is_nan() && !unknown.converged);
        }
        assert_eq!(of(0.35, 0.03), Estimate { mean: 0.35, error: 0.03, converged: true });
    }
}
