//! A device without hardware: the kernels, compiled for the host.

use crate::device::{Device, DeviceError, DeviceInfo, KernelLaunch, TransformPart, TransformTask};
use crate::task::{DeviceAddress, KernelTask};
use std::collections::{BTreeMap, HashMap};
use std::fs::DirEntry;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Mutex, PoisonError};

/// Program that runs the kernels on the host, see `gpu/kernels/emulator.cc`. It runs the threads of a block in an order
/// that a seed shuffles, poisons new memory, and checks the bounds of memory if it is built with a sanitizer.
pub struct Emulator {
    child: Child,
    to: BufWriter<ChildStdin>,
    from: BufReader<ChildStdout>,
    /// Bytes of each piece of memory.
    memory: HashMap<DeviceAddress, usize>,
    /// Commands of the recording that has begun, and those of others by number.
    begun: Option<Vec<Recorded>>,
    recordings: HashMap<usize, Vec<Recorded>>,
    /// Bytes that kernels have read and written.
    moved: BTreeMap<String, u64>,
}

/// A command of a recording.
#[derive(Debug, Clone)]
enum Recorded {
    Launch { kernel: String, blocks: usize, threads: usize, task: Box<KernelTask> },
    Transform(TransformTask),
}

/// Bytes of the memory that an emulator serves.
const MEMORY: f64 = 4e9;

/// Commands, in the order of `gpu/kernels/emulator.cc`.
#[derive(Clone, Copy)]
enum Order {
    Allocate,
    Free,
    Zero,
    Upload,
    Download,
    Launch,
    Transform,
}

/// Sources of the emulator.
const KERNELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/kernels");

impl Emulator {
    /// Option by which the memory that kernels read and write is counted, see `gpu/kernels/traffic.cc`.
    pub const COUNTING: &'static str = "-fsanitize=thread";

    /// Starts the emulator in the folder of the present program, compiled with additional options and those of the
    /// environment variable `EMULATOR_FLAGS`. Threads run in an order by a seed.
    pub fn beside_program(options: &[&str], seed: u64) -> Result<Self, DeviceError> {
        let more = std::env::var("EMULATOR_FLAGS").unwrap_or_default();
        let options = [options, &more.split_whitespace().collect::<Vec<_>>()].concat();
        let program = std::env::current_exe().map_err(|error| unreadable(&error))?;
        Self::start(&Self::compile(program.parent().unwrap_or(Path::new("")), &options)?, seed)
    }

    /// The emulator in a folder, compiled by the host's C++ compiler, `CXX` or g++, with additional options, unless the
    /// folder has one of the same sources and options. Returns the path of the program.
    fn compile(folder: &Path, options: &[&str]) -> Result<PathBuf, DeviceError> {
        static COMPILING: Mutex<()> = Mutex::new(());
        let _guard = COMPILING.lock().unwrap_or_else(PoisonError::into_inner);
        let program = folder.join(format!("emulator-{:016x}", digest(options)?));
        if program.exists() {
            return Ok(program);
        }
        let compiler = std::env::var("CXX").unwrap_or_else(|_| "g++".to_owned());
        // Several processes may compile at the same time.
        let own = std::process::id();
        let [unfinished, object] = [format!("{own}"), format!("{own}.o")].map(|ending| program.with_extension(ending));
        let source = |name: &str| Path::new(KERNELS).join(name);
        let [kernels, to_object] = [source("emulator.cc"), object.clone()];
        run(&compiler, options, &[Path::new("-c"), &kernels, Path::new("-o"), &to_object])?;
        // The calls by which accesses are counted are those of this file.
        let others: Vec<&str> = options.iter().copied().filter(|&option| option != Self::COUNTING).collect();
        run(&compiler, &others, &[&object, &source("traffic.cc"), Path::new("-o"), &unfinished])?;
        drop(std::fs::remove_file(&object));
        std::fs::rename(&unfinished, &program).map_err(|error| unreadable(&error))?;
        Ok(program)
    }

    /// Starts a program of [`Self::compile`], whose threads run in the order of this seed.
    fn start(program: &Path, seed: u64) -> Result<Self, DeviceError> {
        let mut command = Command::new(program);
        command.arg(seed.to_string()).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|error| failed(&error))?;
        let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(DeviceError("the emulator has no pipes".to_owned()));
        };
        let (to, from, memory) = (BufWriter::new(to), BufReader::new(from), HashMap::new());
        Ok(Self { child, to, from, memory, begun: None, recordings: HashMap::new(), moved: BTreeMap::new() })
    }

    fn send(&mut self, order: Order, words: &[usize]) -> Result<(), DeviceError> {
        let words: Vec<u64> = std::iter::once(order as u64).chain(words.iter().map(|&word| word as u64)).collect();
        self.to.write_all(bytemuck::cast_slice(&words)).map_err(|error| failed(&error))
    }

    fn send_bytes(&mut self, bytes: &[u8]) -> Result<(), DeviceError> {
        self.to.write_all(bytes).map_err(|error| failed(&error))
    }

    fn receive(&mut self, bytes: &mut [u8]) -> Result<(), DeviceError> {
        self.to.flush().and_then(|()| self.from.read_exact(bytes)).map_err(|error| failed(&error))
    }

    fn receive_word(&mut self) -> Result<u64, DeviceError> {
        let mut word = [0; 8];
        self.receive(&mut word)?;
        Ok(u64::from_ne_bytes(word))
    }
}

/// Runs a compiler with additional options.
fn run(compiler: &str, options: &[&str], files: &[&Path]) -> Result<(), DeviceError> {
    let always = ["-O1", "-g", "-std=c++17", "-Wall", "-Wextra"];
    match Command::new(compiler).args(always).args(options).args(files).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(DeviceError(format!("{compiler} could not compile the emulator: {status}"))),
        Err(error) => Err(DeviceError(format!("{compiler}, which compiles the emulator: {error}"))),
    }
}

/// Bytes that a transform moves if it passes over its data once for each axis: along x between the field and the
/// spectrum, along y and z within the spectrum.
fn moved_by(task: &TransformTask) -> u64 {
    let [x, y, z] = task.points;
    let value = if task.is_single { 4 } else { 8 };
    let (field, spectrum) = (3 * value * x * y * z, 6 * value * (x / 2 + 1) * y * z);
    let bytes = match task.part {
        TransformPart::Whole => field + 5 * spectrum,
        TransformPart::Planes => field + 3 * spectrum,
        TransformPart::AlongZ => 2 * spectrum,
    };
    bytes as u64
}

/// Digest of the sources of the emulator and of options of the compiler.
fn digest(options: &[&str]) -> Result<u64, DeviceError> {
    let entries = std::fs::read_dir(KERNELS).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let mut paths: Vec<PathBuf> = entries.map_err(|error| unreadable(&error))?.iter().map(DirEntry::path).collect();
    paths.retain(|path| path.extension().is_none_or(|extension| extension != "ptx"));
    paths.sort();
    let mut hasher = DefaultHasher::new();
    options.hash(&mut hasher);
    for path in paths {
        std::fs::read(path).map_err(|error| unreadable(&error))?.hash(&mut hasher);
    }
    Ok(hasher.finish())
}

fn unreadable(error: &std::io::Error) -> DeviceError {
    DeviceError(format!("the sources or the program of the emulator: {error}"))
}

fn failed(error: &std::io::Error) -> DeviceError {
    DeviceError(format!("the emulator has ended: {error}"))
}

/// Closes the pipes, whereupon the program ends.
impl Drop for Emulator {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

impl Device for Emulator {
    fn info(&self) -> Result<DeviceInfo, DeviceError> {
        let taken: f64 = self.memory.values().map(|&bytes| bytes as f64).sum();
        Ok(DeviceInfo {
            name: "emulator".to_owned(),
            identity: [0; 16],
            total_bytes: MEMORY,
            free_bytes: MEMORY - taken,
        })
    }

    fn allocate(&mut self, bytes: usize) -> Result<DeviceAddress, DeviceError> {
        self.send(Order::Allocate, &[bytes])?;
        let address = self.receive_word()?;
        self.memory.insert(address, bytes);
        Ok(address)
    }

    fn release(&mut self, address: DeviceAddress) {
        self.memory.remove(&address);
        // If the program has ended, so has its memory.
        drop(self.send(Order::Free, &[address as usize]));
    }

    fn zero(&mut self, address: DeviceAddress, bytes: usize) -> Result<(), DeviceError> {
        self.send(Order::Zero, &[address as usize, bytes])
    }

    fn upload(&mut self, address: DeviceAddress, bytes: &[u8]) -> Result<(), DeviceError> {
        self.send(Order::Upload, &[address as usize, bytes.len()])?;
        self.send_bytes(bytes)
    }

    fn download_all(&mut self, parts: &mut [(DeviceAddress, &mut [u8])]) -> Result<(), DeviceError> {
        parts.iter_mut().try_for_each(|(address, bytes)| {
            self.send(Order::Download, &[*address as usize, bytes.len()])?;
            self.receive(bytes)
        })
    }

    fn launch(&mut self, launch: &KernelLaunch, task: &KernelTask) -> Result<(), DeviceError> {
        if let Some(recorded) = &mut self.begun {
            let (kernel, task) = (launch.kernel.to_owned(), Box::new(*task));
            recorded.push(Recorded::Launch { kernel, blocks: launch.blocks, threads: launch.threads, task });
            return Ok(());
        }
        self.send(Order::Launch, &[launch.kernel.len()])?;
        self.send_bytes(launch.kernel.as_bytes())?;
        let words = [launch.blocks, launch.threads, size_of::<KernelTask>()].map(|word| word as u64);
        self.send_bytes(bytemuck::cast_slice(&words))?;
        self.send_bytes(bytemuck::bytes_of(task))?;
        *self.moved.entry(launch.kernel.to_owned()).or_default() += self.receive_word()?;
        Ok(())
    }

    fn transform(&mut self, task: &TransformTask) -> Result<(), DeviceError> {
        if let Some(recorded) = &mut self.begun {
            recorded.push(Recorded::Transform(*task));
            return Ok(());
        }
        let [x, y, z] = task.points;
        let flags = [usize::from(task.is_forward), usize::from(task.is_single)];
        let words = [flags[0], flags[1], task.part as usize, x, y, z, task.field as usize, task.spectrum as usize];
        self.send(Order::Transform, &words)?;
        *self.moved.entry("transform".to_owned()).or_default() += moved_by(task);
        self.receive_word().map(drop)
    }

    fn begin_recording(&mut self) -> Result<bool, DeviceError> {
        self.begun = Some(Vec::new());
        Ok(true)
    }

    fn end_recording(&mut self, number: usize) -> Result<bool, DeviceError> {
        self.recordings.insert(number, self.begun.take().unwrap_or_default());
        Ok(true)
    }

    fn replay(&mut self, number: usize) -> Result<(), DeviceError> {
        for command in self.recordings[&number].clone() {
            match command {
                Recorded::Transform(task) => self.transform(&task)?,
                Recorded::Launch { kernel, blocks, threads, task } => {
                    self.launch(&KernelLaunch { kernel: &kernel, blocks, threads }, &task)?;
                }
            }
        }
        Ok(())
    }

    fn moved(&self) -> BTreeMap<String, u64> {
        self.moved.clone()
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        self.to.flush().map_err(|error| failed(&error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `z = x - y` the kernel reads two lists and writes one; without the option nothing is counted.
    #[test]
    #[ignore = "heavy"]
    fn bytes_that_a_kernel_moves_are_counted() {
        let (particles, count) = (200, 6 * 200);
        for (options, lists) in [(&[Emulator::COUNTING][..], 3), (&[], 0)] {
            let mut device = Emulator::beside_program(options, 3).unwrap();
            let [residual, preconditioned, image] = [(); 3].map(|()| device.allocate(8 * count).unwrap());
            for (list, factor) in [(residual, 5.0), (preconditioned, 2.0)] {
                let numbers: Vec<f64> = (0..count).map(|i| factor * i as f64).collect();
                device.upload(list, bytemuck::cast_slice(&numbers)).unwrap();
            }
            let task = KernelTask { residual, preconditioned, image, particles, ..KernelTask::default() };
            device.launch(&KernelLaunch { kernel: "remainder_pairs", blocks: 5, threads: 256 }, &task).unwrap();
            let mut difference = vec![0.0_f64; count];
            device.download(image, bytemuck::cast_slice_mut(&mut difference)).unwrap();
            assert!((difference[17] - 51.0).abs() < 1e-12);
            assert_eq!(device.moved()["remainder_pairs"], 8 * count as u64 * lists);
        }
    }

    /// Of two by three by four points, the spectrum has as many numbers as the field in each of three passes.
    #[test]
    fn transforms_pass_once_for_each_axis() {
        let moved = |part| {
            let (field, spectrum) = (0, 0);
            moved_by(&TransformTask { is_forward: true, is_single: true, part, points: [2, 3, 4], field, spectrum })
        };
        let [whole, planes, along_z] = [TransformPart::Whole, TransformPart::Planes, TransformPart::AlongZ].map(moved);
        assert_eq!(whole, 3 * 4 * (24 + 5 * 2 * 24));
        assert_eq!(planes + along_z, whole);
    }
}
