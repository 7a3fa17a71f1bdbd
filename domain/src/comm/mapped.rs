//! Anonymous shared memory, which other processes of the machine map through the process that allocated it. It is
//! freed however the processes end, and limits on `/dev/shm` do not apply.

use rustix::fs::{FallocateFlags, MemfdFlags, Mode, OFlags};
use rustix::io::Errno;
use rustix::mm::{MapFlags, ProtFlags};
use rustix::process::Resource;
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::os::fd::{AsFd, AsRawFd, OwnedFd};

/// A mapped region of memory.
pub(super) struct SharedMapping {
    start: *mut u8,
    bytes: usize,
}

/// A page in front of the memory that identifies it.
const HEADER: usize = 4096;

/// Address by which other processes map it.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Address {
    process: u64,
    descriptor: u64,
    bytes: u64,
    /// Identification in the header, since another process can have the same number in another container.
    token: u64,
}

impl SharedMapping {
    /// Allocates memory; other processes can map it as long as the descriptor is open.
    pub fn create(bytes: usize) -> rustix::io::Result<(Self, OwnedFd, Address)> {
        let size = (HEADER + bytes) as u64;
        // Beyond the limit on file sizes the system would kill the process.
        if rustix::process::getrlimit(Resource::Fsize).current.is_some_and(|limit| limit < size) {
            return Err(Errno::FBIG);
        }
        let token = RandomState::new().build_hasher().finish();
        let descriptor = rustix::fs::memfd_create("fcm-solve", MemfdFlags::CLOEXEC)?;
        rustix::fs::ftruncate(&descriptor, size)?;
        // Missing memory is reported here rather than at the first access.
        rustix::fs::fallocate(&descriptor, FallocateFlags::empty(), 0, size)?;
        let memory = Self::map(&descriptor, bytes)?;
        // SAFETY: the header has room for the token, and no other process knows it yet.
        unsafe { memory.header().write(token) };
        let process = rustix::process::getpid().as_raw_nonzero().get() as u64;
        let address = Address { process, descriptor: descriptor.as_raw_fd() as u64, bytes: bytes as u64, token };
        Ok((memory, descriptor, address))
    }

    /// Maps memory that another process allocated.
    pub fn open(address: Address) -> rustix::io::Result<Self> {
        let path = format!("/proc/{}/fd/{}", address.process, address.descriptor);
        let descriptor = rustix::fs::open(path, OFlags::RDWR | OFlags::CLOEXEC, Mode::empty())?;
        if rustix::fs::fstat(&descriptor)?.st_size as u64 != HEADER as u64 + address.bytes {
            return Err(Errno::NXIO);
        }
        let memory = Self::map(&descriptor, address.bytes as usize)?;
        // SAFETY: the header exists, and was written before its address was sent.
        let token = unsafe { memory.header().read() };
        if token == address.token { Ok(memory) } else { Err(Errno::NXIO) }
    }

    fn map(descriptor: impl AsFd, bytes: usize) -> rustix::io::Result<Self> {
        let (place, all) = (std::ptr::null_mut(), HEADER + bytes);
        // SAFETY: the kernel chooses an unused address range.
        let start = unsafe {
            rustix::mm::mmap(place, all, ProtFlags::READ | ProtFlags::WRITE, MapFlags::SHARED, descriptor, 0)?
        };
        Ok(Self { start: start.cast(), bytes })
    }

    fn header(&self) -> *mut u64 {
        self.start.cast()
    }

    pub fn start(&self) -> *mut u8 {
        // SAFETY: the memory begins after the header.
        unsafe { self.start.add(HEADER) }
    }
}

impl Drop for SharedMapping {
    fn drop(&mut self) {
        // SAFETY: it was mapped with this size, and its user does not outlive it.
        let _ = unsafe { rustix::mm::munmap(self.start.cast(), HEADER + self.bytes) };
    }
}
