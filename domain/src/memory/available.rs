//! Memory available, and memory in use by a process, as Linux reports them. On other systems they are unknown, and
//! nothing is refused.

use std::fs::read_to_string;
use std::path::{Path, PathBuf};

/// Bytes that can still be allocated, and the limit that determines them.
#[derive(Debug, Clone, PartialEq)]
pub struct AvailableMemory {
    /// Number of bytes.
    pub bytes: f64,
    /// Description of the limit.
    pub limit: String,
}

impl AvailableMemory {
    /// Memory left on the machine and under the limits of this process's control groups, whichever is less.
    pub fn of_machine() -> Option<Self> {
        let machine = read_to_string("/proc/meminfo").ok().and_then(|text| kilobytes(&text, "MemAvailable:"));
        let machine = machine.map(|bytes| Self { bytes, limit: "the machine's memory".to_owned() });
        let groups = read_to_string("/proc/self/cgroup").unwrap_or_default();
        machine
            .into_iter()
            .chain(of_groups(&groups, Path::new("/sys/fs/cgroup")))
            .min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }

    /// Memory left under the limits (`ulimit`) of this process after mapping `mapped` more bytes.
    pub fn of_process(mapped: f64) -> Option<Self> {
        let limits = read_to_string("/proc/self/limits").ok()?;
        let taken = ProcessMemory::now()?;
        let address = soft_limit(&limits, "Max address space")
            .map(|limit| (limit - taken.mapped - mapped, "the limit on address space, ulimit -v"));
        let data =
            soft_limit(&limits, "Max data size").map(|limit| (limit - taken.data, "the limit on data, ulimit -d"));
        let room = |(bytes, limit): (f64, &str)| Self { bytes: bytes.max(0.0), limit: limit.to_owned() };
        address.into_iter().chain(data).map(room).min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }
}

/// Memory in use by this process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProcessMemory {
    /// Resident bytes.
    pub resident: f64,
    /// Bytes of address space.
    pub mapped: f64,
    /// Bytes of writable memory.
    pub data: f64,
}

impl ProcessMemory {
    /// Present values.
    pub fn now() -> Option<Self> {
        let text = read_to_string("/proc/self/status").ok()?;
        let [resident, mapped, data] = ["VmRSS:", "VmSize:", "VmData:"].map(|name| kilobytes(&text, name));
        Some(Self { resident: resident?, mapped: mapped?, data: data? })
    }
}

/// Number of bytes on the line that has it in kB after `name`.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kilobytes| 1024.0 * kilobytes)
}

/// Soft limit on a line of `/proc/self/limits`, if there is one.
fn soft_limit(text: &str, name: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Memory left in each control group of the list in `/proc/self/cgroup`, and in each of their ancestors.
fn of_groups(list: &str, root: &Path) -> Vec<AvailableMemory> {
    let mut rooms = Vec::new();
    for line in list.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (mount, names) = match controllers {
            "" => (root.to_owned(), VERSION_2),
            names if names.split(',').any(|name| name == "memory") => (root.join("memory"), VERSION_1),
            _ => continue,
        };
        // A container may see its own group as the root.
        let group = mount.join(path.trim_start_matches('/'));
        rooms.extend(
            group.ancestors().take_while(|folder| folder.starts_with(&mount)).filter_map(|g| of_group(g, names)),
        );
    }
    rooms
}

/// Files of a group: its limit, its usage, and the name of the part of the usage that is reclaimable file cache.
type GroupFiles = [&'static str; 3];

const VERSION_1: GroupFiles = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"];
const VERSION_2: GroupFiles = ["memory.max", "memory.current", "inactive_file"];

/// Limits above this are treated as unlimited.
const UNLIMITED: f64 = 1e18;

fn of_group(folder: &Path, [limit, used, files]: GroupFiles) -> Option<AvailableMemory> {
    let number = |name: PathBuf| read_to_string(name).ok()?.trim().parse::<f64>().ok();
    let most = number(folder.join(limit)).filter(|&bytes| bytes < UNLIMITED)?;
    let used = number(folder.join(used))?;
    let statistics = read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let cached = statistics.lines().find_map(|line| line.strip_prefix(files)?.trim().parse::<f64>().ok());
    let bytes = (most - used + cached.unwrap_or(0.0)).max(0.0);
    Some(AvailableMemory { bytes, limit: format!("the limit of the control group, {}", folder.join(limit).display()) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{create_dir_all, write};

    /// A temporary folder like `/sys/fs/cgroup`, removed when dropped.
    struct Groups(PathBuf);

    impl Groups {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("fcm-solve-{name}-{}", std::process::id()));
            create_dir_all(&folder).unwrap();
            Self(folder)
        }

        fn group(&self, path: &str, files: [(&str, &str); 3]) {
            create_dir_all(self.0.join(path)).unwrap();
            for (name, text) in files {
                write(self.0.join(path).join(name), text).unwrap();
            }
        }
    }

    impl Drop for Groups {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn groups_of_either_version_have_limits_and_so_have_those_around_them() {
        let groups = Groups::new("groups");
        let two =
            |max| [("memory.max", max), ("memory.current", "300\n"), ("memory.stat", "anon 9\ninactive_file 50\n")];
        groups.group("job", two("1000\n"));
        groups.group("job/step", two("max\n"));
        let one = [
            ("memory.limit_in_bytes", "800\n"),
            ("memory.usage_in_bytes", "500\n"),
            ("memory.stat", "inactive_file 1\ntotal_inactive_file 100\n"),
        ];
        groups.group("memory/batch", one);
        let left = |list: &str| of_groups(list, &groups.0).into_iter().map(|room| room.bytes).collect::<Vec<_>>();
        assert_eq!(left("0::/job/step\n"), [750.0]);
        assert_eq!(left("3:cpu,cpuacct:/job\n4:memory:/batch\n"), [400.0]);
        assert_eq!(left("4:memory:/elsewhere\n0::/\n"), [0.0; 0]);
        assert!(of_groups("0::/job\n", &groups.0)[0].limit.contains("job/memory.max"));
    }

    #[test]
    fn limits_and_sizes_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
                      Max data size             unlimited            unlimited            bytes     \n\
                      Max address space         1024                 unlimited            bytes     \n";
        assert_eq!(soft_limit(limits, "Max address space"), Some(1024.0));
        assert_eq!(soft_limit(limits, "Max data size"), None);
        assert_eq!(kilobytes("VmHWM:\t     3 kB\nVmRSS:\t     2 kB\n", "VmRSS:"), Some(2048.0));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_takes_something_and_this_machine_has_something() {
        let taken = ProcessMemory::now().unwrap();
        assert!(taken.resident > 1e5 && taken.mapped > taken.resident, "{taken:?}");
        assert!(AvailableMemory::of_machine().unwrap().bytes > 1e6);
    }
}
