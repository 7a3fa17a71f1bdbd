//! A card, by libraries that are opened when a scene asks for it.

use crate::device::{Device, DeviceError, DeviceInfo, KernelLaunch, TransformPart, TransformTask};
use crate::task::{DeviceAddress, KernelTask};
use cudarc::cufft::result::CufftError;
use cudarc::cufft::sys::{cufftHandle, cufftType};
use cudarc::cufft::{CudaFft, result as cufft};
use cudarc::driver::result::{device, memcpy_dtoh_async};
use cudarc::driver::sys::{CUdevice_attribute, CUgraphInstantiate_flags, CUstreamCaptureMode};
use cudarc::driver::{
    CudaContext, CudaFunction, CudaGraph, CudaModule, CudaSlice, CudaStream, CudaViewMut, DevicePtr, DeviceRepr,
    DriverError, LaunchConfig, PinnedHostSlice, PushKernelArg,
};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Kernels as PTX, made by `scripts/kernels`.
const PTX: &str = include_str!("../kernels/far_field.ptx");

// SAFETY: plain numbers in the layout of C.
unsafe impl DeviceRepr for KernelTask {}

/// Least compute capability of a card, for which the kernels are compiled.
const LEAST_CAPABILITY: [i32; 2] = [7, 0];

/// An NVIDIA card.
pub struct Cuda {
    context: Arc<CudaContext>,
    stream: Arc<CudaStream>,
    module: Arc<CudaModule>,
    functions: HashMap<String, CudaFunction>,
    memory: BTreeMap<DeviceAddress, CudaSlice<u8>>,
    transforms: Vec<(TransformKind, CudaFft)>,
    recordings: HashMap<usize, CudaGraph>,
    /// Memory of the host that the card writes to.
    staging: Option<PinnedHostSlice<u8>>,
}

/// Values on which a plan of a transform depends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct TransformKind {
    is_forward: bool,
    is_single: bool,
    part: TransformPart,
    points: [usize; 3],
}

impl TransformKind {
    /// Kind of a transform along z: both directions have one plan.
    fn along_z(is_single: bool, points: [usize; 3]) -> Self {
        Self { is_forward: true, is_single, part: TransformPart::AlongZ, points }
    }

    /// A plan of three components, which are one after the other; of one component along z.
    fn plan(&self, stream: Arc<CudaStream>) -> Result<CudaFft, CufftError> {
        let [x, y, z] = self.points.map(|n| n as i32);
        let columns = x / 2 + 1;
        if self.part == TransformPart::AlongZ {
            let kind = if self.is_single { cufftType::CUFFT_C2C } else { cufftType::CUFFT_Z2Z };
            let (line, stride) = ([z], columns * y);
            return CudaFft::plan_many(&line, Some(&line), stride, 1, Some(&line), stride, 1, kind, stride, stream);
        }
        let all = [z, y, x];
        let of_modes = [z, y, columns];
        let (axes, batch) = if self.part == TransformPart::Planes { (1, 3 * z) } else { (0, 3) };
        let (points, modes) = (&all[axes..], &of_modes[axes..]);
        let (field, spectrum): (i32, i32) = (points.iter().product(), modes.iter().product());
        let kind = match (self.is_forward, self.is_single) {
            (true, true) => cufftType::CUFFT_R2C,
            (true, false) => cufftType::CUFFT_D2Z,
            (false, true) => cufftType::CUFFT_C2R,
            (false, false) => cufftType::CUFFT_Z2D,
        };
        let ((from, from_size), (to, to_size)) =
            if self.is_forward { ((points, field), (modes, spectrum)) } else { ((modes, spectrum), (points, field)) };
        CudaFft::plan_many(points, Some(from), 1, from_size, Some(to), 1, to_size, kind, batch, stream)
    }
}

fn failed(error: impl std::fmt::Display) -> DeviceError {
    DeviceError(format!("the GPU: {error}"))
}

fn capability_of(number: usize) -> Result<[i32; 2], DriverError> {
    let card = device::get(number as i32)?;
    let of = |attribute| {
        // SAFETY: the card is one that the driver named.
        unsafe { device::get_attribute(card, attribute) }
    };
    Ok([
        of(CUdevice_attribute::CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR)?,
        of(CUdevice_attribute::CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR)?,
    ])
}

/// Refuses a card for which the kernels are not compiled.
fn check_capability(found: [i32; 2]) -> Result<(), DeviceError> {
    if found >= LEAST_CAPABILITY {
        return Ok(());
    }
    let ([major, minor], [least, least_minor]) = (found, LEAST_CAPABILITY);
    Err(DeviceError(format!(
        "the GPU has compute capability {major}.{minor}, and the kernels need {least}.{least_minor}"
    )))
}

fn info_of(context: &CudaContext) -> Result<DeviceInfo, DeviceError> {
    let (free, total) = context.mem_get_info().map_err(failed)?;
    let name = context.name().map_err(failed)?;
    let identity = context.uuid().map_err(failed)?.bytes.map(|byte| byte as u8);
    Ok(DeviceInfo { name, identity, total_bytes: total as f64, free_bytes: free as f64 })
}

impl Cuda {
    /// Whether a card can be used on this machine, with the reason if not: what follows a key in a message.
    pub fn check() -> Result<(), DeviceError> {
        // SAFETY: libraries are opened, and closed again.
        let [driver, cufft] =
            unsafe { [cudarc::driver::sys::is_culib_present(), cudarc::cufft::sys::is_culib_present()] };
        if !driver {
            return Err(DeviceError("this machine has no CUDA driver (libcuda.so)".to_owned()));
        }
        if !cufft {
            return Err(DeviceError("this machine has no cuFFT (libcufft.so)".to_owned()));
        }
        match CudaContext::device_count() {
            Ok(count) if count > 0 => check_capability(capability_of(0).map_err(failed)?),
            Ok(_) => Err(DeviceError("the CUDA driver finds no GPU".to_owned())),
            Err(error) => Err(DeviceError(format!("the CUDA driver finds no GPU: {error}"))),
        }
    }

    /// Compute capability of the first card.
    pub fn capability() -> Result<[i32; 2], DeviceError> {
        Self::check()?;
        capability_of(0).map_err(failed)
    }

    /// Number of cards of this machine that the process may use, at least one.
    pub fn count() -> Result<usize, DeviceError> {
        Self::check()?;
        CudaContext::device_count().map(|count| count as usize).map_err(failed)
    }

    /// Properties of a card by its number.
    pub fn properties(number: usize) -> Result<DeviceInfo, DeviceError> {
        Self::check()?;
        info_of(&*CudaContext::new(number).map_err(failed)?)
    }

    /// Opens a card by its number.
    pub fn open(number: usize) -> Result<Self, DeviceError> {
        Self::check()?;
        check_capability(capability_of(number).map_err(failed)?)?;
        let context = CudaContext::new(number).map_err(failed)?;
        let module = context.load_module(PTX.into()).map_err(failed)?;
        let stream = context.new_stream().map_err(failed)?;
        let (functions, memory) = (HashMap::new(), BTreeMap::new());
        let (transforms, recordings, staging) = (Vec::new(), HashMap::new(), None);
        Ok(Self { context, stream, module, functions, memory, transforms, recordings, staging })
    }

    /// Bytes from an address within memory that was allocated.
    fn memory(&mut self, address: DeviceAddress, bytes: usize) -> CudaViewMut<'_, u8> {
        let (start, memory) = self.memory.range_mut(..=address).next_back().expect("memory that was allocated");
        let first = (address - start) as usize;
        memory.slice_mut(first..first + bytes)
    }

    fn function(&mut self, kernel: &str) -> Result<&CudaFunction, DeviceError> {
        if !self.functions.contains_key(kernel) {
            let function = self.module.load_function(kernel).map_err(failed)?;
            self.functions.insert(kernel.to_owned(), function);
        }
        Ok(&self.functions[kernel])
    }

    /// Copies parts of memory, of this many bytes together, to the staging memory one after the other, and waits.
    fn copy_to_staging(&mut self, parts: &[(DeviceAddress, &mut [u8])], bytes: usize) -> Result<(), DriverError> {
        if self.staging.as_ref().is_none_or(|staging| staging.len() < bytes) {
            // SAFETY: what is read is copied there before.
            self.staging = Some(unsafe { self.context.alloc_pinned_with_flags(bytes.max(1), 0) }?);
        }
        let Some(staging) = &mut self.staging else { return Ok(()) };
        let mut rest = staging.as_mut_slice()?;
        for (address, bytes) in parts.iter().filter(|(_, bytes)| !bytes.is_empty()) {
            let (to, after) = rest.split_at_mut(bytes.len());
            // SAFETY: both memories have these bytes, and the staging memory is not used before the stream has ended.
            unsafe { memcpy_dtoh_async(to, *address, self.stream.cu_stream()) }?;
            rest = after;
        }
        self.stream.synchronize()
    }

    /// Plan of a transform.
    fn transform_plan(&mut self, kind: TransformKind) -> Result<cufftHandle, DeviceError> {
        if let Some((_, plan)) = self.transforms.iter().find(|(other, _)| *other == kind) {
            return Ok(plan.handle());
        }
        let plan = kind.plan(self.stream.clone()).map_err(of_cufft)?;
        let handle = plan.handle();
        self.transforms.push((kind, plan));
        Ok(handle)
    }

    /// Transforms the modes of planes of three components along z.
    fn transform_along_z(&mut self, task: &TransformTask) -> Result<(), DeviceError> {
        let &TransformTask { is_forward, is_single, points, spectrum, .. } = task;
        let plan = self.transform_plan(TransformKind::along_z(is_single, points))?;
        // CUFFT_FORWARD and CUFFT_INVERSE.
        let direction = if is_forward { -1 } else { 1 };
        let bytes = (points[0] / 2 + 1) * points[1] * points[2] * if is_single { 8 } else { 16 };
        for component in 0..3 {
            let at = spectrum + (component * bytes) as u64;
            // SAFETY: the list has the size of the plan.
            let done = unsafe {
                if is_single {
                    cufft::exec_c2c(plan, at as *mut _, at as *mut _, direction)
                } else {
                    cufft::exec_z2z(plan, at as *mut _, at as *mut _, direction)
                }
            };
            done.map_err(of_cufft)?;
        }
        Ok(())
    }
}

fn of_cufft(error: CufftError) -> DeviceError {
    DeviceError(format!("cuFFT: {error:?}"))
}

impl Device for Cuda {
    fn info(&self) -> Result<DeviceInfo, DeviceError> {
        info_of(&self.context)
    }

    fn allocate(&mut self, bytes: usize) -> Result<DeviceAddress, DeviceError> {
        // SAFETY: kernels and copies write all that is read.
        let memory = unsafe { self.stream.alloc::<u8>(bytes.max(1)) }.map_err(failed)?;
        let (address, guard) = memory.device_ptr(&self.stream);
        drop(guard);
        self.memory.insert(address, memory);
        Ok(address)
    }

    fn release(&mut self, address: DeviceAddress) {
        self.memory.remove(&address);
    }

    fn zero(&mut self, address: DeviceAddress, bytes: usize) -> Result<(), DeviceError> {
        if bytes == 0 {
            return Ok(());
        }
        let stream = self.stream.clone();
        stream.memset_zeros(&mut self.memory(address, bytes)).map_err(failed)
    }

    fn upload(&mut self, address: DeviceAddress, bytes: &[u8]) -> Result<(), DeviceError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let stream = self.stream.clone();
        stream.memcpy_htod(bytes, &mut self.memory(address, bytes.len())).map_err(failed)
    }

    fn download_all(&mut self, parts: &mut [(DeviceAddress, &mut [u8])]) -> Result<(), DeviceError> {
        let bytes = parts.iter().map(|(_, bytes)| bytes.len()).sum();
        self.copy_to_staging(parts, bytes).map_err(failed)?;
        let mut staged =
            self.staging.as_mut().map_or(Ok(&mut [][..]), PinnedHostSlice::as_mut_slice).map_err(failed)?;
        for (_, bytes) in parts {
            let (own, rest) = staged.split_at_mut(bytes.len());
            bytes.copy_from_slice(own);
            staged = rest;
        }
        Ok(())
    }

    fn launch(&mut self, launch: &KernelLaunch, task: &KernelTask) -> Result<(), DeviceError> {
        let (blocks, threads) = (launch.blocks as u32, launch.threads as u32);
        let shape = LaunchConfig { grid_dim: (blocks, 1, 1), block_dim: (threads, 1, 1), shared_mem_bytes: 0 };
        let stream = self.stream.clone();
        let function = self.function(launch.kernel)?;
        let mut call = stream.launch_builder(function);
        call.arg(task);
        // SAFETY: a kernel takes a task, whose lists are as long as its numbers say.
        unsafe { call.launch(shape) }.map(drop).map_err(failed)
    }

    fn transform(&mut self, task: &TransformTask) -> Result<(), DeviceError> {
        let &TransformTask { is_forward, is_single, part, points, field, spectrum } = task;
        if part == TransformPart::AlongZ {
            return self.transform_along_z(task);
        }
        let plan = self.transform_plan(TransformKind { is_forward, is_single, part, points })?;
        // SAFETY: both lists have the sizes of the plan.
        let done = unsafe {
            match (is_forward, is_single) {
                (true, true) => cufft::exec_r2c(plan, field as *mut _, spectrum as *mut _),
                (true, false) => cufft::exec_d2z(plan, field as *mut _, spectrum as *mut _),
                (false, true) => cufft::exec_c2r(plan, spectrum as *mut _, field as *mut _),
                (false, false) => cufft::exec_z2d(plan, spectrum as *mut _, field as *mut _),
            }
        };
        done.map_err(of_cufft)
    }

    fn begin_recording(&mut self) -> Result<bool, DeviceError> {
        Ok(self.stream.begin_capture(CUstreamCaptureMode::CU_STREAM_CAPTURE_MODE_THREAD_LOCAL).is_ok())
    }

    fn end_recording(&mut self, number: usize) -> Result<bool, DeviceError> {
        self.recordings.remove(&number);
        let graph = self.stream.end_capture(CUgraphInstantiate_flags(0)).ok().flatten();
        let is_kept = graph.is_some();
        self.recordings.extend(graph.map(|graph| (number, graph)));
        Ok(is_kept)
    }

    fn replay(&mut self, number: usize) -> Result<(), DeviceError> {
        let none = || DeviceError("the GPU has no recording to replay".to_owned());
        self.recordings.get(&number).ok_or_else(none)?.launch().map_err(failed)
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.stream.synchronize().map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_cards_are_refused() {
        for found in [[7, 0], [7, 5], [9, 0], [12, 1]] {
            assert_eq!(check_capability(found), Ok(()));
        }
        let refusal = check_capability([6, 1]).unwrap_err().to_string();
        assert_eq!(refusal, "the GPU has compute capability 6.1, and the kernels need 7.0");
    }

    /// With a card: its memory. Without one: the reason that a scene is refused with.
    #[test]
    fn a_card_has_memory_or_is_not_there() {
        match Cuda::properties(0) {
            Ok(card) => assert!(card.free_bytes > 0.0 && card.free_bytes <= card.total_bytes, "{card:?}"),
            Err(reason) => assert_eq!(Cuda::check(), Err(reason)),
        }
    }
}
