//! Python functions that return forces or torques.

use crate::arrays::{list_of, rows_of};
use crate::neighbours::PyNeighbours;
use domain::{Tensor, Vector};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use simulation::{AppliedLoads, NeighbourList};
use std::cell::RefCell;
use std::error::Error;
use std::rc::Rc;
use std::sync::Arc;

/// A Python function, and the loads that it returns.
#[derive(Clone)]
pub struct OwnFunction {
    pub function: Arc<Py<PyAny>>,
    pub gives: LoadKind,
}

/// Kinds of loads that a Python function returns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// `(positions, time) -> (N, 3)`.
    Forces,
    /// `(positions, time) -> (N, 3)`.
    Torques,
    /// `(positions, time) -> (N, 3), (N, 6)`: forces and the contributions of the particles to their first moments.
    ForcesAndMoments,
    /// `(neighbours, time) -> (P, 3)`, for the pairs nearer than this cutoff.
    PairForces(f64),
}

impl LoadKind {
    /// The kind with a name, with the cutoff of pair forces.
    pub fn of(name: &str, cutoff: Option<f64>) -> PyResult<Self> {
        match (name, cutoff) {
            ("forces", None) => Ok(Self::Forces),
            ("torques", None) => Ok(Self::Torques),
            ("moments", None) => Ok(Self::ForcesAndMoments),
            ("pairs", Some(cutoff)) => Ok(Self::PairForces(cutoff)),
            _ => Err(PyValueError::new_err(format!("no loads are called {name}"))),
        }
    }

    /// Whether these loads contribute to the stress.
    pub fn have_stress(self) -> bool {
        matches!(self, Self::ForcesAndMoments | Self::PairForces(_))
    }
}

/// Exception raised by such a function, kept until it is taken.
#[derive(Clone, Default)]
pub struct PendingException(Rc<RefCell<Option<PyErr>>>);

impl PendingException {
    /// Takes the exception that was raised, if any.
    pub fn take(&self) -> Option<PyErr> {
        self.0.borrow_mut().take()
    }

    /// Whether an exception was raised.
    pub fn is_any(&self) -> bool {
        self.0.borrow().is_some()
    }

    /// Loads from a Python function. Its arrays are checked, and an exception is kept here and returned as an error
    /// with the same message.
    pub fn loads(&self, own: OwnFunction) -> simulation::UserLoads {
        let raised = self.clone();
        match own.gives {
            LoadKind::PairForces(cutoff) => simulation::UserLoads::OfPairs {
                cutoff,
                function: Box::new(move |near, time| {
                    let called = Python::attach(|py| of_pairs(py, &own.function, near, time));
                    called.map_err(|error| raised.keep(error))
                }),
            },
            _ => simulation::UserLoads::OfPositions(Box::new(move |positions, time| {
                let called = Python::attach(|py| of_positions(py, &own, positions, time));
                called.map_err(|error| raised.keep(error))
            })),
        }
    }

    fn keep(&self, error: PyErr) -> Box<dyn Error> {
        let message = error.to_string();
        self.0.replace(Some(error));
        message.into()
    }
}

fn of_positions(py: Python<'_>, own: &OwnFunction, positions: &[Vector], time: f64) -> PyResult<AppliedLoads> {
    let given = own.function.bind(py).call1((rows_of::<_, f64>(py, positions.to_vec())?, time))?;
    let mut loads = AppliedLoads::default();
    match own.gives {
        LoadKind::Torques => loads.torques = list_of(Some(given.extract()?))?,
        LoadKind::ForcesAndMoments => {
            let (forces, moments) = given.extract()?;
            loads.forces = list_of(Some(forces))?;
            loads.moments = list_of(Some(moments))?.into_iter().map(tensor).collect();
        }
        _ => loads.forces = list_of(Some(given.extract()?))?,
    }
    Ok(loads)
}

fn of_pairs(py: Python<'_>, function: &Py<PyAny>, near: &NeighbourList, time: f64) -> PyResult<Vec<Vector>> {
    let near = Bound::new(py, PyNeighbours::of(near.clone()))?;
    list_of(Some(function.bind(py).call1((near, time))?.extract()?))
}

/// A symmetric tensor from its components.
fn tensor([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Tensor {
    Tensor::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}
