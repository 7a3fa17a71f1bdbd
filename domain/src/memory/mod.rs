//! Memory: forecasts of what computations need, measured parts of a process, and what is available.

mod available;
mod bytes;
mod expected_counts;
mod need;
mod process;
mod stores;

pub use available::{AvailableMemory, ProcessMemory};
pub use bytes::{Bytes, GROWING, readable_bytes};
pub use expected_counts::ExpectedCounts;
pub use need::{MemoryNeed, NotEnoughMemory};
pub use process::Process;
pub use stores::{packing_bytes, shared_pairs_bytes};
