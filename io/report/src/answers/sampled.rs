//! Diffusivities, from the statistics that a run has taken.

use super::RunAnswer;
use domain::{Boundaries, Vector};
use files::FileError;
use simulation::csv_words;
use statistics::{SteadyMean, Verdict};
use std::f64::consts::PI;
use std::path::Path;
use suspension::{Flow, Model, Species};

/// Volume fractions up to which the viscosity of a suspension is that of its fluid, for the correction for the box.
const DILUTE: f64 = 0.05;

/// `2.837297 = -L` times the sum over the images of a simple cubic lattice in `D = D_L + 2.837297 kT / (6 pi mu L)`
/// (Hasimoto, J. Fluid Mech. 5, 317, 1959; Yeh & Hummer, J. Phys. Chem. B 108, 15873, 2004).
const CUBIC: f64 = 2.837_297;

/// The error over the value that is asked for.
const RELATIVE_ERROR: f64 = 0.05;

/// The summary of statistics.
pub(super) struct StatisticsSummary(Vec<SummaryRow>);

struct SummaryRow {
    quantity: String,
    species: String,
    value: f64,
    error: f64,
    is_converged: bool,
}

impl StatisticsSummary {
    /// Reads the summary of the statistics in the folder of a run; `None` if the run has taken none.
    pub(super) fn read(folder: &Path) -> Result<Option<Self>, FileError> {
        let path = folder.join("statistics/summary.csv");
        if !path.is_file() {
            return Ok(None);
        }
        let csv = std::fs::read_to_string(&path).map_err(|e| FileError::read(&path, &e))?;
        Ok(Some(Self(csv.lines().skip(1).filter_map(SummaryRow::of).collect())))
    }

    fn get(&self, quantity: &str, species: &str) -> Option<&SummaryRow> {
        self.0.iter().find(|row| row.quantity == quantity && row.species == species)
    }

    /// The diffusivities of each species by half the slope of its mean square displacement, at long times.
    pub(super) fn diffusivities(&self, model: &Model) -> Vec<RunAnswer> {
        let mut answers = Vec::new();
        for species in &model.species {
            for (name, axes) in directions(model) {
                let Some(mean) = self.diffusivity(&species.name, &axes) else { continue };
                let answer = |quantity: &str, mean, unit: &str| answer(species, quantity, mean, unit);
                answers.push(answer(name, mean, "length^2/time"));
                let rate = model.shear_rates().largest() * species.radius.powi(2);
                if matches!(model.flow, Flow::Shear { .. }) && rate > 0.0 {
                    answers.push(answer(&format!("reduced_{name}"), mean.times(1.0 / rate), ""));
                }
                if let Some(correction) = self.correction(model) {
                    let corrected = mean.mapped(|value| value + correction, 1.0);
                    answers.push(answer(&format!("{name}_in_infinite_box"), corrected, "length^2/time"));
                }
            }
        }
        answers.extend(self.rotational_diffusivities(model));
        answers
    }

    /// The rotational diffusivities of species with orientations, and with Brownian motion those over that of an
    /// isolated sphere, `kT / (8 pi mu a^3)`.
    fn rotational_diffusivities(&self, model: &Model) -> Vec<RunAnswer> {
        let mut answers = Vec::new();
        for species in &model.species {
            let Some(row) = self.get("rotational_diffusivity", &species.name) else { continue };
            let mean = self.mean(&[row]);
            answers.push(answer(species, "rotational_diffusivity", mean, "1/time"));
            if let Some(energy) = model.thermal_energy {
                let isolated = energy / (8.0 * PI * model.viscosity * species.radius.powi(3));
                answers.push(answer(species, "reduced_rotational_diffusivity", mean.times(1.0 / isolated), ""));
            }
        }
        answers
    }

    /// The mean over some axes.
    fn diffusivity(&self, species: &str, axes: &[usize]) -> Option<SteadyMean> {
        let letter = |axis: usize| ["x", "y", "z"][axis];
        let rows: Vec<&SummaryRow> =
            axes.iter().map(|&axis| self.get(&format!("D_slope_{}", letter(axis)), species)).collect::<Option<_>>()?;
        Some(self.mean(&rows))
    }

    /// The mean of some rows.
    fn mean(&self, rows: &[&SummaryRow]) -> SteadyMean {
        let count = rows.len() as f64;
        let value = rows.iter().map(|row| row.value).sum::<f64>() / count;
        let error = rows.iter().map(|row| row.error * row.error).sum::<f64>().sqrt() / count;
        let transient = self.get("first_time", "all").map_or(f64::NAN, |row| row.value);
        let longer = (error / (RELATIVE_ERROR * value)).powi(2);
        let is_converged = rows.iter().all(|row| row.is_converged);
        let verdict = match longer {
            _ if !(value > error && error.is_finite()) => Verdict::Meaningless,
            longer if !is_converged => Verdict::TooShort { longer: longer.max(LEAST_LONGER) },
            longer if longer > 1.0 => Verdict::TooShort { longer },
            _ => Verdict::Converged,
        };
        let [value, error] = if verdict == Verdict::Meaningless { [f64::NAN; 2] } else { [value, error] };
        SteadyMean { value, error, samples: f64::NAN, transient, verdict }
    }

    /// By how much the fluid that goes with a sphere slows it down in a cubic box that repeats, in dilute suspensions
    /// at rest.
    fn correction(&self, model: &Model) -> Option<f64> {
        let energy = model.thermal_energy.filter(|_| model.flow == Flow::None)?;
        let (cell, edges) = (&model.cell, model.cell.edges());
        let is_cubic =
            cell.boundaries() == Boundaries::Periodic && edges == Vector::splat(edges.x) && cell.strain() == 0.0;
        let fractions = self.0.iter().filter(|row| row.quantity == "volume_fraction");
        let is_dilute = fractions.map(|row| row.value).sum::<f64>() <= DILUTE;
        (is_cubic && is_dilute).then(|| CUBIC * energy / (6.0 * PI * model.viscosity * edges.x))
    }
}

fn answer(species: &Species, quantity: &str, mean: SteadyMean, unit: &str) -> RunAnswer {
    RunAnswer { quantity: quantity.to_owned(), species: species.name.clone(), mean, unit: unit.to_owned() }
}

/// The factor by which a run is at least too short whose error is a lower bound.
const LEAST_LONGER: f64 = 4.0;

/// Directions along which spheres diffuse, with the axes that they are the mean of.
fn directions(model: &Model) -> Vec<(&'static str, Vec<usize>)> {
    let axes = model.user_axes();
    let axis = |of_box: usize| axes.axis(of_box);
    let is_periodic = model.cell.boundaries() == Boundaries::Periodic;
    match (model.flow, model.force_axis()) {
        (Flow::Shear { .. }, _) if is_periodic => {
            vec![("diffusivity_along_gradient", vec![axis(1)]), ("diffusivity_along_vorticity", vec![axis(2)])]
        }
        (Flow::None, None) if is_periodic => vec![("diffusivity", vec![0, 1, 2])],
        (Flow::None, Some(along)) if is_periodic => {
            let across = (0..3).filter(|&other| other != along).map(axis).collect();
            vec![("diffusivity_parallel", vec![axis(along)]), ("diffusivity_perpendicular", across)]
        }
        (Flow::None, None | Some(2)) => vec![("diffusivity_along_walls", vec![axis(0), axis(1)])],
        _ => Vec::new(),
    }
}

impl SummaryRow {
    fn of(line: &str) -> Option<Self> {
        let words: [String; 6] = csv_words(line).try_into().ok()?;
        let [quantity, species, _, value, error, converged] = words;
        let is_converged = converged.parse::<f64>().ok()? > 0.5;
        Some(Self { quantity, species, value: value.parse().ok()?, error: error.parse().ok()?, is_converged })
    }
}
