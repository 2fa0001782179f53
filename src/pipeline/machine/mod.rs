//! The machine that made a result, and the time that it took.

mod limit;

use std::time::{Instant, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// The machine, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Host name.
    pub host: String,
    /// Model of the processor.
    pub processor: String,
    /// Threads that the machine runs at once.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        Machine {
            host: host(),
            processor: processor(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

/// Memory that this process may use, bytes: that of the machine, or of a container that permits
/// less; infinite if unknown.
pub fn memory() -> f64 {
    let allowed = limit::here().map_or(f64::INFINITY, |bytes| bytes as f64);
    physical_memory().min(allowed)
}

fn physical_memory() -> f64 {
    #[cfg(unix)]
    {
        // SAFETY: reads two numbers.
        let ask = |name| unsafe { libc::sysconf(name) } as f64;
        let bytes = ask(libc::_SC_PHYS_PAGES) * ask(libc::_SC_PAGESIZE);
        if bytes > 0.0 {
            return bytes;
        }
    }
    f64::INFINITY
}

/// Space that a user may still fill on the disk of `path`, which need not exist yet, bytes;
/// infinite if unknown.
pub fn free_disk(path: &std::path::Path) -> f64 {
    #[cfg(unix)]
    if let Some(path) = path.ancestors().find(|path| path.exists())
        && let Ok(path) = std::ffi::CString::new(path.as_os_str().as_encoded_bytes())
    {
        // SAFETY: all zeros are a valid `statvfs`.
        let mut disk: libc::statvfs = unsafe { std::mem::zeroed() };
        // SAFETY: `statvfs` reads a text that ends with a zero and only fills `disk`.
        if unsafe { libc::statvfs(path.as_ptr(), &mut disk) } == 0 {
            return disk.f_bavail as f64 * disk.f_frsize as f64;
        }
    }
    f64::INFINITY
}

/// Maps each array of 128 KiB or more separately, so that freed memory returns to the system at
/// once. By default glibc raises this limit when the first such array is freed, and growing rows
/// leave holes: a tenth of the memory of ISPH at a million particles.
pub fn map_large_arrays() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: sets a number, before there are other threads.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 128 * 1024);
    }
}

/// Name of this host, or empty.
pub fn host() -> String {
    let file = std::fs::read_to_string("/proc/sys/kernel/hostname");
    let name = file.or_else(|_| std::env::var("HOSTNAME"));
    name.unwrap_or_default().trim().to_string()
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split_once(':'));
    name.map_or(String::new(), |(_, name)| name.trim().to_string())
}

/// CPU time of this process, all threads, s; 0 if unknown.
pub fn cpu_seconds() -> f64 {
    #[cfg(unix)]
    if let Some(usage) = usage() {
        let seconds = |time: libc::timeval| time.tv_sec as f64 + time.tv_usec as f64 * 1e-6;
        return seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
    0.0
}

/// Peak memory of this process, bytes.
pub fn peak_memory() -> Option<u64> {
    #[cfg(unix)]
    return usage().map(|usage| {
        // In KiB, except on one system.
        let unit = if cfg!(target_os = "macos") { 1 } else { 1024 };
        usage.ru_maxrss as u64 * unit
    });
    #[cfg(not(unix))]
    None
}

#[cfg(unix)]
fn usage() -> Option<libc::rusage> {
    // SAFETY: all zeros are a valid `rusage`.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: `getrusage` only fills it.
    (unsafe { libc::getrusage(libc::RUSAGE_SELF, &mut usage) } == 0).then_some(usage)
}

/// Now, UTC, as `2026-11-21T04:05:06Z`.
pub fn now() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    utc(since.map_or(0, |since| since.as_secs()))
}

/// UTC of `seconds` since 1970 (civil calendar after Howard Hinnant, "chrono-compatible low-level
/// date algorithms").
fn utc(seconds: u64) -> String {
    let days = seconds / 86_400 + 719_468;
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Wall and CPU time since it was started.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    wall: Instant,
    cpu: f64,
}

impl Clock {
    /// Starts at the present wall and CPU time.
    pub fn start() -> Self {
        Clock {
            wall: Instant::now(),
            cpu: cpu_seconds(),
        }
    }

    /// Wall seconds, CPU seconds.
    pub fn read(&self) -> (f64, f64) {
        (self.wall.elapsed().as_secs_f64(), cpu_seconds() - self.cpu)
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn utc_of_known_instants() {
        assert_eq!(super::utc(0), "1970-01-01T00:00:00Z");
        assert_eq!(super::utc(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(super::utc(1_795_233_906), "2026-11-21T04:05:06Z");
    }
}
