//! The far field on a GPU: kernels, devices that run them, and an evaluation of the split method from tables.
//!
//! [`Cuda`] runs the kernels of `gpu/kernels` on a card, by libraries that are opened when a scene asks for it;
//! [`Emulator`] runs the same kernels on the host, for tests; [`Counted`] counts what a device does.
//! [`SplitFarField`] has the order of an evaluation, and the vectors of an iteration with near pairs or without. It
//! knows arrays and tables, but neither plans nor units: those are the concern of the crate `fcm`.

mod arrangement;
mod assembly;
mod buffers;
mod change;
mod contact_buffers;
mod contacts;
mod copies;
mod counted;
mod coupled;
mod cuda;
mod device;
mod displace;
mod drawn;
mod emulator;
mod evaluation;
mod exchange;
mod far_field;
mod groups;
mod history;
mod images;
mod known;
mod krylov;
mod krylov_state;
mod lists;
mod memory;
mod near;
mod near_tables;
mod numbers;
mod overlaps;
mod pair_noise;
mod pair_rows;
mod predicted;
mod present;
mod repeated;
mod replay;
mod scans;
mod share;
mod steps;
mod strain;
mod surface;
mod surface_laws;
mod tables;
mod task;
mod vectors;

pub use assembly::NearInput;
pub use contacts::{CONTACT_NUMBERS, ContactInput, ContactLaw, ContactLoads, contact_bytes};
pub use counted::{Counted, DeviceCounts, SharedCounts};
pub use coupled::{
    CoupledDirection, CoupledSums, CoupledVectors, KnownInput, LoadFactors, RESIDUALS, StartInput, UNKNOWNS,
};
pub use cuda::Cuda;
pub use device::{Device, DeviceError, DeviceInfo, KernelLaunch, TransformPart, TransformTask};
pub use displace::{DisplacementInput, MOST_COLUMNS, MovedParticles};
pub use drawn::DrawnLists;
pub use emulator::Emulator;
pub use far_field::{DeviceLoads, DeviceMotion, Orders, PlacedParticles, SplitFarField, StageSeconds};
pub use history::{
    AmbientLists, COLUMN_WIDTHS, COLUMNS, ColumnUnits, FoundLists, GUESSED, GuessedVectors, MovingLists, PAST,
    PastLists, StoredResult,
};
pub use images::ImageLists;
pub use known::{ChangeColumns, KnownLists};
pub use krylov::{KrylovOperator, ParticleDraw};
pub use krylov_state::MOST_VECTORS;
pub use lists::{DeviceList, MotionLists};
pub use memory::{
    DIFFERENCE_BYTES, EvaluationBytes, EvaluationSize, HISTORY_BYTES, NearSize, SUBSTEP_BYTES, SolveKind,
    bytes_of_contacts,
};
pub use near::{PairLimits, PairSolve, PairVectors};
pub use near_tables::{NearKind, NearTables};
pub use overlaps::{CloseSpheres, OverlapLimits};
pub use pair_noise::{PairDraw, PeriodicPlaces};
pub use pair_rows::{IN_FLOW, OWN_NUMBERS, PAIR_NUMBERS, PairRows, PairSet, WALL_NUMBERS};
pub use predicted::PredictedMotion;
pub use share::{GridShare, Peers, StencilSums};
pub use steps::{STEP_COLUMNS, StepInput, StepMeasures};
pub use strain::{StrainSums, StrainVectors};
pub use surface_laws::{SurfaceKind, SurfaceLaws, SurfacePair};
pub use tables::{
    COLUMN_NUMBERS, ChannelColumns, DevicePairTable, GridSolve, LatticeShape, NumberFormat, SplitTables,
    WindowPolynomials,
};
pub use task::KernelTask;
