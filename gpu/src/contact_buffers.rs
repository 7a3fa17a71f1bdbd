//! Memory of contacts on a device.

use crate::buffers::{Buffer, KnownBuffer};
use crate::task::DeviceAddress;

/// Memory of contacts.
#[derive(Default)]
pub(crate) struct ContactBuffers {
    pub arguments: KnownBuffer,
    pub radii: KnownBuffer,
    /// Numbers of contacts, and by slots the others and packed steps.
    pub lists: [Buffer; 3],
    pub resistances: Buffer,
    pub sums: Buffer,
}

impl ContactBuffers {
    /// Address of the contacts that were found last; 0 if none were sought.
    pub fn address(&self) -> DeviceAddress {
        self.arguments.address()
    }
}
