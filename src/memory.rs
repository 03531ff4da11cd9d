//! How much memory this process can still have.

use std::path::Path;

use crate::error::{Error, Result};

/// Memory that can be had, and what bounds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Available {
    /// bytes
    pub bytes: f64,
    /// In words.
    pub bound: &'static str,
}

/// What OpenBLAS takes for itself when it is first used, bytes: it asks for it again and again until it gets it.
const BLAS_BUFFER: f64 = 134_217_728.0;

/// Refuses to start MPI and PETSc where that would take what is left: they fail by a crash.
pub fn refuse_to_start() -> Result<()> {
    match available() {
        Some(found) if found.bytes < SESSION => Err(Error::Usage(format!(
            "{} leaves {:.2} GB beside what the BLAS takes for itself, and MPI and PETSc need {:.2} GB to start; raise that",
            found.bound,
            found.bytes.max(0.0) / 1e9,
            SESSION / 1e9
        ))),
        _ => Ok(()),
    }
}

/// Of MPI and PETSc, bytes.
const SESSION: f64 = 6e7;

/// The least of what the limits of this process, of its control groups and of the machine leave (Linux); none where the
/// system says nothing.
pub fn available() -> Option<Available> {
    let status = read("/proc/self/status");
    let limits = read("/proc/self/limits");
    let of_process = |limit: &str, used: &str, bound| {
        let limit: f64 =
            limits.lines().find_map(|line| line.strip_prefix(limit))?.split_whitespace().next()?.parse().ok()?;
        Some(Available { bytes: limit - kilobytes(&status, used)? - BLAS_BUFFER, bound })
    };
    let machine = || {
        let about = read("/proc/meminfo");
        let bytes = kilobytes(&about, "MemAvailable:")? + kilobytes(&about, "SwapFree:").unwrap_or(0.0);
        Some(Available { bytes, bound: "what is free of the machine's memory" })
    };
    let all = [
        of_process("Max address space", "VmSize:", "the limit of this process (ulimit -v)"),
        of_process("Max data size", "VmData:", "the limit of this process (ulimit -d)"),
        group("0::", "/sys/fs/cgroup", ["memory.max", "memory.current"], "inactive_file "),
        group(
            "memory:",
            "/sys/fs/cgroup/memory",
            ["memory.limit_in_bytes", "memory.usage_in_bytes"],
            "total_inactive_file ",
        ),
        machine(),
    ];
    all.into_iter().flatten().min_by(|a, b| a.bytes.total_cmp(&b.bytes))
}

/// What the control group of this process and those around it leave. `mark` stands in /proc/self/cgroup before its path,
/// `root` is where the groups are mounted; pages of files that can be dropped count as free.
fn group(mark: &str, root: &str, [limit, used]: [&str; 2], droppable: &str) -> Option<Available> {
    let groups = read("/proc/self/cgroup");
    let path = groups.lines().find_map(|line| line.split_once(mark).map(|(_, path)| path.trim_start_matches('/')))?;
    let left = |group: &Path| {
        let number = |name: &str| read(group.join(name)).trim().parse::<f64>().ok();
        let about = read(group.join("memory.stat"));
        let cached = about.lines().find_map(|line| line.strip_prefix(droppable)?.trim().parse::<f64>().ok());
        Some(number(limit)? - number(used)? + cached.unwrap_or(0.0))
    };
    let around = Path::new(path).ancestors().map(|group| Path::new(root).join(group));
    let bytes = around.filter_map(|group| left(&group)).min_by(f64::total_cmp)?;
    Some(Available { bytes, bound: "the limit of its control group" })
}

/// A line `name number kB` of a file of /proc, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let number = text.lines().find_map(|line| line.strip_prefix(name))?.trim().strip_suffix("kB")?;
    number.trim().parse::<f64>().ok().map(|kilobytes| 1024.0 * kilobytes)
}

/// The text of a file that the system makes; none of it where it makes none.
fn read(file: impl AsRef<Path>) -> String {
    std::fs::read_to_string(file).unwrap_or_default()
}
