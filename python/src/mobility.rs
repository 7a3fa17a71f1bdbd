//! The mobility of spheres.

use crate::arrays::{Rows, list_of, rows_of};
use crate::communicator::ranks;
use crate::error::{explained, refused};
use crate::signals::PythonSignals;
use crate::thread_bound::{ThreadBound, without_lock};
use domain::{AxisRotation, Bytes, Comm, Tensor, Traceless, Vector};
use fcm::{Loads, Motion, Multipoles};
use lubrication::LubricationRange;
use numpy::PyArray2;
use pyo3::prelude::*;
use scene::{CaseBoundary, CaseBox, CaseDevice, CaseMethod};
use solver::BackgroundFlow;
use std::time::Instant;
use suspension::{GivenMotion, MobilityError, MobilityParameters, Motions, plan_values};

/// A planned mobility.
#[pyclass(frozen, name = "Mobility", module = "fcm_solve._core")]
pub struct PyMobility {
    planned: ThreadBound<suspension::Mobility>,
    signals: PythonSignals,
    is_first: bool,
}

/// Velocities, angular velocities, strain rates, stresslets, far stresslets; velocities and angular velocities of
/// bodies, forces and torques that given motions take; iterations, residual.
type MobilityAnswer<'py> = ([NumpyMatrix<'py>; 5], [NumpyMatrix<'py>; 4], usize, f64);

/// Velocities, angular velocities, strain rates or stresslets.
type RandomMotions<'py> = (NumpyMatrix<'py>, NumpyMatrix<'py>, NumpyMatrix<'py>);

/// Edges in one row or lattice vectors in three, and the boundary condition along each axis.
type GivenBox = (Vec<[f64; 3]>, [String; 3]);

type NumpyMatrix<'py> = Bound<'py, PyArray2<f64>>;

#[pymethods]
impl PyMobility {
    /// Plans the mobility. `spheres`: the box (edges in one row or lattice vectors in three, and the boundary condition
    /// along each axis), its strain, the radii, and whether the spheres are rigid and may swim. `fluid`: viscosity and
    /// relative tolerance. `terms`: whether there are dipoles, the gap where lubrication ends, the method, the device.
    #[new]
    #[pyo3(signature = (spheres, fluid, terms, comm))]
    fn new(
        py: Python<'_>,
        spheres: (GivenBox, f64, Vec<f64>, [bool; 2]),
        fluid: (f64, f64),
        terms: (bool, Option<f64>, &str, &str),
        comm: Option<(i32, String)>,
    ) -> PyResult<Self> {
        let (
            ((rows, axes), strain, radii, [rigid, swimming]),
            (viscosity, tolerance),
            (dipoles, lubrication, method, device),
        ) = (spheres, fluid, terms);
        let given = (Some(given_box(&rows)), boundaries(&axes)?);
        let (cell, turn) = CaseBox::bounded(given.0, strain, given.1, (&[], &[])).map_err(|cause| refused(&cause))?;
        let comm = ranks(comm)?;
        let lubrication =
            lubrication.map(|cutoff| LubricationRange::new(cutoff, LubricationRange::MINIMUM_GAP)).transpose();
        let (count, device) = (radii.len(), CaseDevice::of_word(device).map_err(|cause| refused(&cause))?.into());
        let parameters = MobilityParameters {
            cell,
            radii,
            viscosity,
            multipoles: if dipoles { Multipoles::Dipole } else { Multipoles::Monopole },
            rigid,
            swimming,
            tolerance,
            lubrication: lubrication.map_err(|cause| refused(&cause))?,
            method: CaseMethod::of_word(method).map_err(|cause| refused(&cause))?.alone(),
            device,
            costs: without_lock(py, || run::kept_costs(device, &comm)).map_err(|cause| explained(&cause))?,
        };
        Self::planned(py, parameters, turn, count, &comm)
    }

    /// Sets the positions `(N, 3)` of the spheres; returns a warning if spheres overlap.
    fn place(&self, py: Python<'_>, positions: Rows<'_>) -> PyResult<Option<String>> {
        let positions: Vec<Vector> = list_of(Some(positions))?;
        let overlaps = self.planned.with(py, |mobility| mobility.place(&positions))?.map_err(|cause| failed(&cause))?;
        Ok(overlaps.map(|overlaps| overlaps.to_string()))
    }

    /// Joins spheres into rigid bodies: the number of the body of each sphere, or `None`.
    fn join(&self, py: Python<'_>, bodies: Vec<Option<u32>>) -> PyResult<()> {
        self.planned.with(py, |mobility| mobility.join(bodies))
    }

    /// Sets velocities and angular velocities `(B, 6)` of bodies in later evaluations; components that are not numbers
    /// are free.
    #[pyo3(signature = (motions))]
    fn move_bodies(&self, py: Python<'_>, motions: Option<Rows<'_>>) -> PyResult<()> {
        let motions: Vec<[f64; 6]> = list_of(motions)?;
        let given = |motion: [f64; 6]| {
            GivenMotion::of_components(motion.map(|component| (!component.is_nan()).then_some(component)))
        };
        let given: Vec<GivenMotion> = motions.into_iter().map(given).collect();
        self.planned.with(py, |mobility| mobility.move_bodies(&given))?.map_err(|cause| failed(&cause))
    }

    /// Sets the velocities `(N, 3)` and the stresslets `(N, 5)` that spheres have alone by their slip, in later
    /// evaluations.
    #[pyo3(signature = (velocities, stresslets))]
    fn swim(&self, py: Python<'_>, velocities: Option<Rows<'_>>, stresslets: Option<Rows<'_>>) -> PyResult<()> {
        let (velocities, stresslets): (Vec<Vector>, Vec<Traceless>) = (list_of(velocities)?, list_of(stresslets)?);
        let swum = |mobility: &mut suspension::Mobility| mobility.swim(&velocities, &stresslets);
        self.planned.with(py, swum)?.map_err(|cause| failed(&cause))
    }

    /// Sets the pressure gradient that drives the fluid between walls in later evaluations.
    fn drive(&self, py: Python<'_>, pressure_gradient: [f64; 3]) -> PyResult<()> {
        let gradient = Vector::from_array(pressure_gradient);
        self.planned.with(py, |mobility| mobility.drive(gradient))?.map_err(|cause| failed(&cause))
    }

    /// The motions under forces `(N, 3)`, torques `(N, 3)`, stresslets `(N, 5)` and a velocity gradient `G[i][j] =
    /// du_i/dx_j`, and the seconds that the evaluation took.
    #[pyo3(signature = (forces, torques, stresslets, gradient))]
    fn apply<'py>(
        &self,
        py: Python<'py>,
        forces: Option<Rows<'py>>,
        torques: Option<Rows<'py>>,
        stresslets: Option<Rows<'py>>,
        gradient: Option<[[f64; 3]; 3]>,
    ) -> PyResult<(MobilityAnswer<'py>, f64)> {
        let loads = Loads { forces: list_of(forces)?, torques: list_of(torques)?, stresslets: list_of(stresslets)? };
        let gradient = Tensor::from_cols_array_2d(&gradient.unwrap_or_default()).transpose();
        let flow = BackgroundFlow::with_gradient(gradient).map_err(|cause| refused(&cause))?;
        let timed = |mobility: &mut suspension::Mobility| {
            let start = Instant::now();
            (mobility.apply(&loads, &flow), start.elapsed().as_secs_f64())
        };
        let (applied, seconds) = self.planned.with(py, timed)?;
        if let Some(raised) = self.signals.take() {
            return Err(raised);
        }
        Ok((answer(py, applied.map_err(|cause| failed(&cause))?)?, seconds))
    }

    /// Random motions whose covariance is the mobility, for `draws` draws from number `first` on: velocities, angular
    /// velocities and rates of strain, draw after draw, and the negative weight that was clipped.
    #[pyo3(signature = (draws, seed, first))]
    fn noise<'py>(&self, py: Python<'py>, draws: u64, seed: u64, first: u64) -> PyResult<(RandomMotions<'py>, f64)> {
        let drawn = self.planned.with(py, |mobility| mobility.noise(seed, first..first + draws))?;
        if let Some(raised) = self.signals.take() {
            return Err(raised);
        }
        let (motions, drawn) = drawn.map_err(|cause| failed(&cause))?;
        let mut all = Motion::default();
        for motion in motions {
            all.velocities.extend(motion.velocities);
            all.angular_velocities.extend(motion.angular_velocities);
            all.strain_rates.extend(motion.strain_rates);
        }
        let random =
            (rows_of(py, all.velocities)?, rows_of(py, all.angular_velocities)?, rows_of(py, all.strain_rates)?);
        Ok((random, drawn.clipped))
    }

    /// Random contributions to the drift, for `draws` draws from number `first` on: velocities, angular velocities and
    /// stresslets, draw after draw.
    #[pyo3(signature = (draws, seed, first))]
    fn drift<'py>(&self, py: Python<'py>, draws: u64, seed: u64, first: u64) -> PyResult<RandomMotions<'py>> {
        let drawn = self.planned.with(py, |mobility| mobility.drift(seed, first..first + draws))?;
        if let Some(raised) = self.signals.take() {
            return Err(raised);
        }
        let (mut velocities, mut angular_velocities, mut stresslets) = (Vec::new(), Vec::new(), Vec::new());
        for drift in drawn.map_err(|cause| failed(&cause))? {
            velocities.extend(drift.velocities);
            angular_velocities.extend(drift.angular_velocities);
            stresslets.extend(drift.stresslets);
        }
        Ok((rows_of(py, velocities)?, rows_of(py, angular_velocities)?, rows_of(py, stresslets)?))
    }

    /// Product of a square root of the mobility, or its transpose, with six numbers a sphere, and the negative weight
    /// that was clipped.
    #[pyo3(signature = (numbers, transposed))]
    fn root<'py>(&self, py: Python<'py>, numbers: Rows<'py>, transposed: bool) -> PyResult<(NumpyMatrix<'py>, f64)> {
        let numbers: Vec<[f64; 6]> = list_of(Some(numbers))?;
        let found = self.planned.with(py, |mobility| mobility.root(&numbers, transposed))?;
        if let Some(raised) = self.signals.take() {
            return Err(raised);
        }
        let (root, drawn) = found.map_err(|cause| failed(&cause))?;
        Ok((rows_of(py, root)?, drawn.clipped))
    }

    /// Whether this is the first rank, which holds all arrays.
    #[getter]
    fn is_first(&self) -> bool {
        self.is_first
    }

    /// Reason why the plan is infeasible, if it is.
    fn burden(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.planned.with(py, |mobility| mobility.infeasible())
    }

    /// The plan as JSON and as text.
    fn plan(&self, py: Python<'_>) -> PyResult<(String, String)> {
        self.planned.with(py, |mobility| {
            let (plan, turn) = (mobility.plan(), mobility.turn());
            (plan_values(plan, turn).to_string(), plan.describe_for(turn))
        })
    }
}

impl PyMobility {
    fn planned(
        py: Python<'_>,
        parameters: MobilityParameters,
        turn: AxisRotation,
        count: usize,
        comm: &Comm,
    ) -> PyResult<Self> {
        let signals = PythonSignals::default();
        let planned = without_lock(py, || suspension::Mobility::new(parameters, array_bytes(count), comm));
        let mut planned = planned.map_err(|cause| failed(&cause))?.turned(turn);
        planned.listen(signals.interrupt());
        Ok(Self { planned: ThreadBound::new(planned), signals, is_first: comm.is_first() })
    }
}

/// Memory for the arrays of a call, 32 numbers a sphere, once in the library and once in Python.
fn array_bytes(count: usize) -> Bytes {
    Bytes::keep((2 * 8 * 32 * count) as f64)
}

/// The exception for an error: `InputError` if the arguments can't be evaluated, else `Error`.
fn failed(cause: &MobilityError) -> PyErr {
    match cause {
        MobilityError::Plan(_)
        | MobilityError::Swimming
        | MobilityError::NotSwimming
        | MobilityError::GivenMotions { .. }
        | MobilityError::Radius(_)
        | MobilityError::Box(_)
        | MobilityError::Overlap(_)
        | MobilityError::Outside(_)
        | MobilityError::Flow(_) => refused(cause),
        _ => explained(cause),
    }
}

fn answer(py: Python<'_>, motions: Motions) -> PyResult<MobilityAnswer<'_>> {
    let Motions { motion, stresslets, stresslets_far, iterations, residual, bodies, driving } = motions;
    let of_spheres = [
        rows_of(py, motion.velocities)?,
        rows_of(py, motion.angular_velocities)?,
        rows_of(py, motion.strain_rates)?,
        rows_of(py, stresslets)?,
        rows_of(py, stresslets_far)?,
    ];
    let of_bodies = [
        rows_of(py, bodies.velocities)?,
        rows_of(py, bodies.angular_velocities)?,
        rows_of(py, driving.forces)?,
        rows_of(py, driving.torques)?,
    ];
    Ok((of_spheres, of_bodies, iterations, residual))
}

/// The boundary condition along each axis, from its name.
fn boundaries(axes: &[String; 3]) -> PyResult<[CaseBoundary; 3]> {
    let word = |word: &String| CaseBoundary::of_word(word).map_err(|cause| refused(&cause));
    Ok([word(&axes[0])?, word(&axes[1])?, word(&axes[2])?])
}

/// The box of edges in one row, or of lattice vectors in three.
fn given_box(rows: &[[f64; 3]]) -> CaseBox {
    match rows {
        &[a, b, c] => CaseBox::Vectors([a, b, c]),
        rows => CaseBox::Edges(rows.first().copied().unwrap_or_default()),
    }
}
