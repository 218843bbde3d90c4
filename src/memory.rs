//! The memory that a process will need, and the memory still available.

use std::fs;
use std::path::{Path, PathBuf};

/// Bytes of the stack of a thread, the default of the standard library.
const STACK: f64 = (2 << 20) as f64;

/// Bytes that the C library reserves for small allocations of a thread. It has one such arena per
/// thread, up to [`ARENAS_A_CORE`] for each processor.
const ARENA: f64 = (64 << 20) as f64;
const ARENAS_A_CORE: usize = 8;

/// Bytes that a process needs beyond its estimate, for reading and writing files and for the C
/// library, which aborts the process if an allocation fails.
const RESERVE: f64 = 16e6;

/// The memory that a process will need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Need {
    /// Bytes that will be in use.
    pub bytes: f64,
    /// Number of threads.
    pub threads: usize,
}

/// More memory is needed than is available.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Short {
    /// Bytes that are needed.
    pub needed: f64,
    /// Bytes that there are.
    pub free: f64,
    /// The limit that is reached.
    pub limit: &'static str,
}

impl Need {
    /// Check that this much memory is available. If the system does not report it, no limit is
    /// assumed.
    pub fn check(&self) -> Result<(), Short> {
        let short = |(free, needed, limit): (Option<f64>, f64, &'static str)| {
            free.filter(|free| *free < needed).map(|free| Short {
                needed,
                free: free.max(0.0),
                limit,
            })
        };
        let used = self.bytes + RESERVE;
        let limits = [
            (machine(), used, "this machine"),
            (
                container(Path::new("/proc/self/cgroup"), Path::new("/sys/fs/cgroup")),
                used,
                "this container",
            ),
            (
                left("Max address space", "VmSize:"),
                self.addresses(),
                "ulimit -v",
            ),
            (
                left("Max data size", "VmData:"),
                used + self.stacks(),
                "ulimit -d",
            ),
        ];
        limits.into_iter().find_map(short).map_or(Ok(()), Err)
    }

    /// Bytes of address space, which includes what is reserved and never used.
    fn addresses(&self) -> f64 {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        // An arena is reserved at twice its size, and then trimmed.
        let arenas = match self.threads {
            1 => 0,
            threads => threads.min(ARENAS_A_CORE * cores) + 1,
        };
        self.bytes + RESERVE + self.stacks() + arenas as f64 * ARENA
    }

    /// Bytes of the stacks of all threads but the first.
    fn stacks(&self) -> f64 {
        self.threads as f64 * STACK
    }
}

/// The number after a name in a file of `/proc`.
fn number(file: &str, name: &str) -> Option<f64> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Bytes still free on the machine.
fn machine() -> Option<f64> {
    number("/proc/meminfo", "MemAvailable:").map(|kilobytes| kilobytes * 1024.0)
}

/// Bytes left of a limit of this process; none if it is `unlimited`.
fn left(limit: &str, used: &str) -> Option<f64> {
    let limit = number("/proc/self/limits", limit)?;
    Some(limit - number("/proc/self/status", used).unwrap_or(0.0) * 1024.0)
}

/// Bytes that are left in the group of processes to which a container limits this process: in its
/// own group, or in one that contains it. The list of groups has the lines `0::/path` (version 2)
/// or `4:memory:/path` (version 1).
fn container(list: &Path, root: &Path) -> Option<f64> {
    let list = fs::read_to_string(list).ok()?;
    let groups = list.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        match controllers {
            "" => Some((
                root.to_owned(),
                path,
                ["memory.max", "memory.current", "inactive_file"],
            )),
            _ if controllers.split(',').any(|one| one == "memory") => {
                let names = [
                    "memory.limit_in_bytes",
                    "memory.usage_in_bytes",
                    "total_inactive_file",
                ];
                Some((root.join("memory"), path, names))
            }
            _ => None,
        }
    });
    let lefts = groups.flat_map(|(root, path, names)| {
        // In a container the path of the group may not exist, but its root does.
        let folders: Vec<PathBuf> = Path::new(path)
            .ancestors()
            .map(|above| root.join(above))
            .collect();
        folders
            .into_iter()
            .filter_map(move |folder| left_in_group(&folder, names))
    });
    lefts.reduce(f64::min)
}

/// Bytes that are left of the limit of a group. Its inactive file cache is freed when memory is
/// needed.
fn left_in_group(folder: &Path, [limit, used, unread]: [&str; 3]) -> Option<f64> {
    let number = |name: &str| {
        fs::read_to_string(folder.join(name))
            .ok()?
            .trim()
            .parse::<f64>()
            .ok()
    };
    let limit = number(limit)?;
    let text = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let unread = text
        .lines()
        .find_map(|line| line.strip_prefix(unread)?.trim().parse::<f64>().ok());
    Some(limit - number(used).unwrap_or(0.0) + unread.unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tightest_limit_of_the_groups_around_a_process_counts() {
        let here = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = here.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let left = || container(&here.path().join("list"), here.path());
        assert_eq!(left(), None);
        write("list", "0::/job/step\n");
        write("job/step/memory.max", "max\n");
        assert_eq!(left(), None);
        write("job/memory.max", "1000000\n");
        write("job/memory.current", "700000\n");
        write("job/memory.stat", "anon 100000\ninactive_file 200000\n");
        assert_eq!(left(), Some(500_000.0));
        write("job/step/memory.max", "400000\n");
        assert_eq!(left(), Some(400_000.0));
        write("list", "7:cpu,memory:/job\n1:name=systemd:/\n");
        write("memory/memory.limit_in_bytes", "9000\n");
        assert_eq!(left(), Some(9000.0));
    }

    #[test]
    fn every_thread_needs_a_stack_and_the_first_ones_an_arena() {
        let need = |threads| {
            Need {
                bytes: 0.0,
                threads,
            }
            .addresses()
        };
        assert!(need(2) > need(1) + ARENA + STACK);
        assert_eq!(need(1000) - need(999), STACK);
        assert!(
            Need {
                bytes: 1e18,
                threads: 1
            }
            .check()
            .is_err()
        );
    }
}
