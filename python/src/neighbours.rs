//! Neighbour lists whose arrays are views of the library's list.

use numpy::ndarray::{ArrayView1, ArrayView2, Dimension};
use numpy::{Element, PyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use simulation::NeighbourList;

/// Pairs of particles whose centres are nearer than a cutoff. Immutable.
#[pyclass(frozen, name = "Neighbours", module = "fcm_solve._core")]
pub struct PyNeighbours {
    list: NeighbourList,
}

impl PyNeighbours {
    /// The pairs of a neighbour list.
    pub fn of(list: NeighbourList) -> Self {
        Self { list }
    }
}

#[pymethods]
impl PyNeighbours {
    /// The number of pairs.
    fn __len__(&self) -> usize {
        self.list.pairs.len()
    }

    /// `(P, 2)`: indices of both particles.
    #[getter]
    fn pairs<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        table(slf, slf.get().list.pairs.as_flattened(), 2)
    }

    /// `(P, 3)`: vectors from the centre of the first particle to that of the second.
    #[getter]
    fn separations<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(slf, bytemuck::cast_slice(&slf.get().list.separations), 3)
    }

    /// `(P,)`: gaps between the surfaces.
    #[getter]
    fn gaps<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let view = ArrayView1::from(&slf.get().list.gaps[..]);
        // SAFETY: the list is never changed, and lives as long as the object that the array holds.
        let array = unsafe { PyArray1::borrow_from_array(&view, slf.clone().into_any()) };
        read_only(array)
    }
}

/// A view of the owner's numbers as rows of a width.
fn table<'py, T: Element>(
    owner: &Bound<'py, PyNeighbours>,
    numbers: &[T],
    width: usize,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let view = ArrayView2::from_shape((numbers.len() / width, width), numbers).expect("rows are whole");
    // SAFETY: the list is never changed, and lives as long as the object that the array holds.
    let array = unsafe { PyArray2::borrow_from_array(&view, owner.clone().into_any()) };
    read_only(array)
}

fn read_only<T: Element, D: Dimension>(array: Bound<'_, PyArray<T, D>>) -> PyResult<Bound<'_, PyArray<T, D>>> {
    array.getattr("flags")?.setattr("writeable", false)?;
    Ok(array)
}
