//! The memory that this process may use, according to the machine and the control groups of the process.

use std::fs;
use std::path::Path;

/// Memory outside the budget, in bytes: code, threads, buffers of the system's calls, and what an allocator leaves
/// between its blocks, see docs/limits.md. Half of it would let the system end the process under load; twice of it
/// would leave memory unused.
const UNBUDGETED_BYTES: u64 = 512 << 20;

/// Returns the maximum memory of this process in bytes, if the system tells.
pub fn available() -> Option<u64> {
    within(Path::new("/"))
}

/// Returns the default budget: the usual one, or less if less memory is available, but at least `least`.
pub(super) fn budget(usual: u64, least: u64, available: Option<u64>) -> u64 {
    available.map_or(usual, |bytes| usual.min(bytes.saturating_sub(UNBUDGETED_BYTES.min(bytes / 4)).max(least)))
}

/// As [`available`], with the system's files below `root`.
fn within(root: &Path) -> Option<u64> {
    let machine = fs::read_to_string(root.join("proc/meminfo")).ok().and_then(|text| total(&text));
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    let limits = groups.lines().filter_map(|line| of_group(root, line));
    machine.into_iter().chain(limits).min()
}

/// Reads the memory of the machine in bytes.
fn total(meminfo: &str) -> Option<u64> {
    let kibibytes = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    kibibytes.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// Returns the smallest limit of a control group and its ancestors. A line is `0::/path` for version 2,
/// `n:memory:/path` for version 1; within a container the path may be that of the host, and then the limit is at the
/// root.
fn of_group(root: &Path, line: &str) -> Option<u64> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (controllers, path) = (parts.next()?, parts.next()?);
    let (mount, file) = match controllers {
        "" => ("sys/fs/cgroup", "memory.max"),
        names if names.split(',').any(|name| name == "memory") => ("sys/fs/cgroup/memory", "memory.limit_in_bytes"),
        _ => return None,
    };
    let mount = root.join(mount);
    let group = mount.join(path.trim_start_matches('/'));
    let read = |folder: &Path| fs::read_to_string(folder.join(file)).ok()?.trim().parse().ok();
    group.ancestors().take_while(|folder| folder.starts_with(&mount)).filter_map(read).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the memory available on a system with these files.
    fn system(name: &str, files: &[(&str, &str)]) -> Option<u64> {
        let root = std::env::temp_dir().join(format!("planish-memory-{}-{name}", std::process::id()));
        for (path, text) in files {
            let path = root.join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("it can be made");
            fs::write(path, text).expect("it can be written");
        }
        let found = within(&root);
        fs::remove_dir_all(&root).expect("it was made");
        found
    }

    #[test]
    fn the_least_of_machine_and_groups_counts() {
        let machine = ("proc/meminfo", "MemFree: 1 kB\nMemTotal:       8388608 kB\n");
        assert_eq!(system("alone", &[machine]), Some(8 << 30));
        let v2 = ("proc/self/cgroup", "0::/a/b\n");
        let found = system(
            "v2",
            &[machine, v2, ("sys/fs/cgroup/a/memory.max", "2147483648\n"), ("sys/fs/cgroup/a/b/memory.max", "max\n")],
        );
        assert_eq!(found, Some(2 << 30), "the group above holds, too");
        let v1 = ("proc/self/cgroup", "5:cpu,cpuacct:/x\n4:memory:/docker/77\n");
        let found = system("v1", &[machine, v1, ("sys/fs/cgroup/memory/memory.limit_in_bytes", "1073741824\n")]);
        assert_eq!(found, Some(1 << 30), "a container sees its own group at the root");
        let endless = ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
        assert_eq!(system("none", &[machine, v1, endless]), Some(8 << 30), "no limit is a large number");
        assert_eq!(system("silent", &[("proc/meminfo", "nothing\n")]), None);
    }

    #[test]
    fn the_budget_leaves_room_beside_it_and_is_never_too_small_to_start() {
        let of = |available| budget(12 << 30, 256 << 20, available);
        assert_eq!(of(None), 12 << 30);
        assert_eq!(of(Some(64 << 30)), 12 << 30);
        assert_eq!(of(Some(4 << 30)), (4 << 30) - (512 << 20));
        assert_eq!(of(Some(1 << 30)), 768 << 20);
        assert_eq!(of(Some(128 << 20)), 256 << 20);
    }
}
