//! Memory and disk: what a run takes, compared with what can be had.

use crate::estimate::{Choice, Estimate};
use crate::format::bytes;
use std::path::Path;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Files of a control group: its limit and what it uses, bytes, in version 2 and in version 1.
const GROUP_FILES: [(&str, [&str; 2]); 2] = [
    ("/sys/fs/cgroup", ["memory.max", "memory.current"]),
    ("/sys/fs/cgroup/memory", ["memory.limit_in_bytes", "memory.usage_in_bytes"]),
];

/// Refuses a run that would take more memory, or more disk where its output is to be, than can be had.
///
/// # Errors
/// The estimate, what there is, and what would fit.
pub(super) fn require(estimate: &Estimate, output: Option<&Path>) -> Result<(), String> {
    let memory = shortage("memory", estimate, memory(estimate.threads), Estimate::memory);
    let disk = output.and_then(|output| shortage("disk", estimate, disk(output), Estimate::disk));
    memory.or(disk).map_or(Ok(()), Err)
}

/// A shortage, if more is needed than can be had; none where that is not known.
fn shortage(
    what: &str,
    estimate: &Estimate,
    had: Option<f64>,
    needed: fn(&Estimate) -> f64,
) -> Option<String> {
    let limit = had.filter(|had| needed(estimate) > *had)?;
    let fit = |choice: Choice| Some(chosen(choice, choice.most(estimate, limit, needed)?));
    let fitting: Vec<String> = Choice::ALL.into_iter().filter_map(fit).collect();
    let fitting = match fitting.as_slice() {
        [] => "not even the fewest asperities, separations, replicas or threads by themselves would fit"
            .to_owned(),
        fitting => format!("all else the same, {} would fit", fitting.join(", or ")),
    };
    let [needed, limit] = [needed(estimate), limit].map(bytes);
    Some(format!("the run would take about {needed} of {what}, and {limit} can be had; {fitting}"))
}

/// The option or key that chooses this number of a size.
fn chosen(choice: Choice, number: u64) -> String {
    match choice {
        Choice::Asperities => format!("a nominal_area of {number:e} asperities"),
        Choice::Separations => format!("{number} separations"),
        Choice::Replicas => format!("--replicas {number}"),
        Choice::Threads => format!("--threads {number}"),
    }
}

/// Bytes of memory that can be had by this number of threads: what is available, and what limits of this
/// process and of its control groups leave.
fn memory(threads: f64) -> Option<f64> {
    let ram = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let available = System::new_with_specifics(ram).available_memory() as f64;
    let available = Some(available).filter(|available| *available > 0.0);
    [available, address_space(threads), control_groups()].into_iter().flatten().reduce(f64::min)
}

/// Bytes of address space that the program takes by itself.
#[cfg(unix)]
const OWN: f64 = 3e8;
/// Bytes of address space that the allocator of the GNU C library reserves for each thread.
#[cfg(unix)]
const PER_THREAD: f64 = 67_108_864.0;
/// Threads besides the computing ones.
#[cfg(unix)]
const OTHER_THREADS: f64 = 4.0;

/// Bytes of address space that are left of a limit, as by `ulimit -v`: in it counts what is reserved too.
#[cfg(unix)]
fn address_space(threads: f64) -> Option<f64> {
    let limit = rustix::process::getrlimit(rustix::process::Resource::As).current? as f64;
    Some((limit - OWN - PER_THREAD * (threads + OTHER_THREADS)).max(0.0))
}

#[cfg(not(unix))]
fn address_space(_: f64) -> Option<f64> {
    None
}

/// Bytes that the control groups of this process leave it, as containers and batch systems have them.
fn control_groups() -> Option<f64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let left = groups.lines().flat_map(|line| {
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, path) = (fields.next().unwrap_or_default(), fields.next().unwrap_or_default());
        let version = match controllers {
            "" => 0,
            _ => 1,
        };
        let counts = version == 0 || controllers.split(',').any(|controller| controller == "memory");
        // Each group limits those below it.
        let within = Path::new(path).ancestors().filter(move |_| counts);
        let (root, files) = GROUP_FILES[version];
        within.filter_map(move |group| {
            left_in(&Path::new(root).join(group.strip_prefix("/").unwrap_or(group)), files)
        })
    });
    left.reduce(f64::min)
}

/// Bytes that one control group leaves, with what it can give back at once; `None` when it has no limit.
fn left_in(group: &Path, [limit, used]: [&str; 2]) -> Option<f64> {
    let number = |name: &str| std::fs::read_to_string(group.join(name)).ok()?.trim().parse::<f64>().ok();
    let cached = std::fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    let cached = cached.lines().find_map(|line| line.strip_prefix("inactive_file ")?.parse::<f64>().ok());
    Some((number(limit)? - number(used)? + cached.unwrap_or(0.0)).max(0.0))
}

/// Bytes that are free where a file is to be.
fn disk(output: &Path) -> Option<f64> {
    let folder = output.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    #[cfg(windows)]
    return fs4::available_space(folder).ok().map(|bytes| bytes as f64);
    #[cfg(unix)]
    {
        let system = rustix::fs::statvfs(folder).ok()?;
        // What is no disk, as /proc, has no blocks.
        (system.f_blocks > 0).then_some(system.f_bavail as f64 * system.f_frsize as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_control_group_leaves_its_limit_less_what_it_uses() {
        let group = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(group.path().join(name), text).unwrap();
        let [(_, files), _] = GROUP_FILES;
        assert_eq!(left_in(group.path(), files), None);
        write("memory.max", "max\n");
        write("memory.current", "3000\n");
        assert_eq!(left_in(group.path(), files), None);
        write("memory.max", "5000\n");
        assert_eq!(left_in(group.path(), files), Some(2000.0));
        write("memory.stat", "anon 100\ninactive_file 500\n");
        assert_eq!(left_in(group.path(), files), Some(2500.0));
        write("memory.max", "100\n");
        assert_eq!(left_in(group.path(), files), Some(0.0));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_can_be_had_is_known() {
        assert!(memory(2.0).is_some_and(|bytes| bytes > 1e6));
        assert!(disk(Path::new("out.h5")).is_some_and(|bytes| bytes >= 0.0));
        assert_eq!(disk(Path::new("/proc/out.h5")), None);
        assert_eq!(disk(Path::new("/no/such/folder/out.h5")), None);
    }
}
