//! The fluid: the grid, fields on it, their Fourier transform over any number of ranks, and the Stokes solve.
//!
//! Example: the velocity of a force density.
//! ```
//! use domain::{Comm, Partition, PeriodicBox, Vector};
//! use solver::{Grid, Stokes, Transform};
//!
//! let cell = PeriodicBox::new(Vector::new(2.0, 1.0, 1.0))?;
//! let grid = Grid::new([32, 16, 16], cell)?;
//! let partition = Partition::new(&Comm::alone(), grid.lines());
//! let mut transform = Transform::<f64>::new(grid.points(), &partition, 8);
//! let mut field = transform.field();
//! field.row_mut(1, 0, 0)[3] = 1.0; // a force along y at the grid point (3, 0, 0)
//! transform.apply(&mut field, &Stokes::new(&grid, 1.0));
//! let velocity = field.row(1, 0, 0)[3];
//! assert!(velocity > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channel;
mod divergence;
mod field;
mod flow;
mod footprint;
mod fourier;
mod free_space_kernel;
mod grid;
mod layout;
mod memory;
mod modes;
mod open_space;
mod shared;
mod stokes;
mod transform;

pub use channel::{Channel, ChannelFaces, ChannelTables, ChannelWeights, ColumnKernel, across_walls};
pub use divergence::divergence;
pub use field::{Field, Physical, Spectral, Tile};
pub use flow::{BackgroundFlow, FlowError};
pub use footprint::GridFootprint;
pub use grid::{Grid, GridError};
pub use memory::AlignedMemory;
pub use modes::{Complexes, MODES};
pub use open_space::OpenSpace;
pub use simd::Real;
pub use stokes::{Multiplier, Poisson, Stokes};
pub use transform::{Draw, Transform};
