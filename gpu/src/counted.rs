//! A device whose commands are counted.

use crate::device::{Device, DeviceError, DeviceInfo, KernelLaunch, TransformTask};
use crate::task::{DeviceAddress, KernelTask};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// Commands that a device has run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DeviceCounts {
    /// Runs of each kernel, from recordings too, and of the transforms, as `transform`.
    pub runs: BTreeMap<String, u64>,
    /// Commands from the host: launches and transforms that are not from a recording, and recordings that were run.
    pub launches: u64,
    /// Recordings that were run.
    pub replays: u64,
    /// Copies to the device, and their bytes.
    pub uploads: [u64; 2],
    /// Copies from the device, and their bytes.
    pub downloads: [u64; 2],
    /// Times that the host waited for the device.
    pub waits: u64,
    /// Bytes of its memory that each kernel has read and written, see [`Device::moved`].
    pub moved: BTreeMap<String, u64>,
    /// Bytes of the memory that is allocated at present, and the most at any time.
    pub memory: [u64; 2],
}

/// Counts that a device and its user share.
pub type SharedCounts = Rc<RefCell<DeviceCounts>>;

/// A device that counts what another runs.
pub struct Counted {
    device: Box<dyn Device>,
    counts: SharedCounts,
    sizes: HashMap<DeviceAddress, u64>,
    /// Kernels of the recording that has begun, and of others by number.
    begun: Option<Vec<String>>,
    recordings: HashMap<usize, Vec<String>>,
}

impl Counted {
    /// Counts the commands of a device from now on.
    pub fn new(device: Box<dyn Device>) -> (Self, SharedCounts) {
        let counts = SharedCounts::default();
        let (shared, sizes) = (Rc::clone(&counts), HashMap::new());
        (Self { device, counts, sizes, begun: None, recordings: HashMap::new() }, shared)
    }

    fn note(&mut self, name: &str) {
        if let Some(begun) = &mut self.begun {
            begun.push(name.to_owned());
            return;
        }
        let counts = &mut *self.counts.borrow_mut();
        counts.launches += 1;
        *counts.runs.entry(name.to_owned()).or_default() += 1;
    }
}

impl Device for Counted {
    fn info(&self) -> Result<DeviceInfo, DeviceError> {
        self.device.info()
    }

    fn allocate(&mut self, bytes: usize) -> Result<DeviceAddress, DeviceError> {
        let address = self.device.allocate(bytes)?;
        self.sizes.insert(address, bytes as u64);
        let [now, most] = &mut self.counts.borrow_mut().memory;
        *now += bytes as u64;
        *most = (*most).max(*now);
        Ok(address)
    }

    fn release(&mut self, address: DeviceAddress) {
        self.counts.borrow_mut().memory[0] -= self.sizes.remove(&address).unwrap_or_default();
        self.device.release(address);
    }

    fn zero(&mut self, address: DeviceAddress, bytes: usize) -> Result<(), DeviceError> {
        self.device.zero(address, bytes)
    }

    fn upload(&mut self, address: DeviceAddress, bytes: &[u8]) -> Result<(), DeviceError> {
        let [copies, copied] = &mut self.counts.borrow_mut().uploads;
        (*copies, *copied) = (*copies + 1, *copied + bytes.len() as u64);
        self.device.upload(address, bytes)
    }

    fn download_all(&mut self, parts: &mut [(DeviceAddress, &mut [u8])]) -> Result<(), DeviceError> {
        let counts = &mut *self.counts.borrow_mut();
        let ([copies, copied], all) = (&mut counts.downloads, parts.iter().map(|(_, bytes)| bytes.len() as u64));
        (*copies, *copied) = (*copies + parts.len() as u64, *copied + all.sum::<u64>());
        counts.waits += 1;
        self.device.download_all(parts)
    }

    fn launch(&mut self, launch: &KernelLaunch, task: &KernelTask) -> Result<(), DeviceError> {
        self.note(launch.kernel);
        self.device.launch(launch, task)?;
        self.counts.borrow_mut().moved = self.device.moved();
        Ok(())
    }

    fn transform(&mut self, task: &TransformTask) -> Result<(), DeviceError> {
        self.note("transform");
        self.device.transform(task)
    }

    fn begin_recording(&mut self) -> Result<bool, DeviceError> {
        let begins = self.device.begin_recording()?;
        self.begun = begins.then(Vec::new);
        Ok(begins)
    }

    fn end_recording(&mut self, number: usize) -> Result<bool, DeviceError> {
        self.recordings.insert(number, self.begun.take().unwrap_or_default());
        self.device.end_recording(number)
    }

    fn replay(&mut self, number: usize) -> Result<(), DeviceError> {
        let counts = &mut *self.counts.borrow_mut();
        counts.launches += 1;
        counts.replays += 1;
        for name in &self.recordings[&number] {
            *counts.runs.entry(name.clone()).or_default() += 1;
        }
        self.device.replay(number)?;
        counts.moved = self.device.moved();
        Ok(())
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.counts.borrow_mut().waits += 1;
        self.device.finish()
    }
}
