//! The memory that a container may use: the smallest limit of the process's control group and its
//! ancestors, for both versions of control groups (Linux, cgroups(7)).

use std::path::{Path, PathBuf};

/// A hierarchy of control groups: where it is mounted, which group is the root of the mount, and
/// the file that holds the limit.
struct Hierarchy {
    mount: PathBuf,
    root: PathBuf,
    file: &'static str,
    /// The controller in `/proc/self/cgroup`; empty for version 2.
    controller: &'static str,
}

/// The limit of this process, bytes; `None` where there is none.
pub fn here() -> Option<u64> {
    let text = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let [groups, mounts] = ["/proc/self/cgroup", "/proc/self/mountinfo"].map(text);
    limit(&groups, &mounts, |path| std::fs::read_to_string(path).ok())
}

/// From the texts of `/proc/self/cgroup` and `/proc/self/mountinfo`; `read` reads a file.
fn limit(groups: &str, mounts: &str, read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
    let hierarchies = mounts.lines().filter_map(hierarchy);
    let limits = hierarchies.flat_map(|hierarchy| {
        let group = group(groups, hierarchy.controller).unwrap_or_default();
        // A group outside the mount is that of another namespace: its root is what is visible.
        let inside = Path::new(group).strip_prefix(&hierarchy.root);
        let folder = hierarchy.mount.join(inside.unwrap_or(Path::new("")));
        let above = folder.ancestors();
        let own = above.take_while(|folder| folder.starts_with(&hierarchy.mount));
        let values = own.filter_map(|folder| read(&folder.join(hierarchy.file)));
        // Version 2 writes `max` for no limit.
        let numbers = values.filter_map(|text| text.trim().parse::<u64>().ok());
        numbers.collect::<Vec<u64>>()
    });
    limits.min()
}

/// A line of mountinfo: `id parent device root mount options [tags] - type source options`.
fn hierarchy(line: &str) -> Option<Hierarchy> {
    let (place, kind) = line.split_once(" - ")?;
    let place: Vec<&str> = place.split(' ').collect();
    let kind: Vec<&str> = kind.split(' ').collect();
    let path = |field: usize| Some(PathBuf::from(place.get(field)?.replace("\\040", " ")));
    let (file, controller) = match *kind.first()? {
        "cgroup2" => ("memory.max", ""),
        "cgroup" if kind.get(2)?.split(',').any(|option| option == "memory") => {
            ("memory.limit_in_bytes", "memory")
        }
        _ => return None,
    };
    Some(Hierarchy {
        mount: path(4)?,
        root: path(3)?,
        file,
        controller,
    })
}

/// The group of a controller from lines `id:controllers:path`.
fn group<'a>(groups: &'a str, controller: &str) -> Option<&'a str> {
    groups.lines().find_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let has = parts.next()?.split(',').any(|name| name == controller);
        parts.next().filter(|_| has)
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    const MOUNTS_2: &str = "\
22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw
30 22 0:26 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate
";
    const MOUNTS_1: &str = "\
33 32 0:29 / /sys/fs/cgroup/cpu rw shared:10 - cgroup cgroup rw,cpu
34 32 0:30 /docker/ab /sys/fs/cgroup/memory rw shared:11 - cgroup cgroup rw,memory
";

    fn limit(groups: &str, mounts: &str, files: &[(&str, &str)]) -> Option<u64> {
        super::limit(groups, mounts, |path| {
            let found = files.iter().find(|(name, _)| Path::new(name) == path);
            found.map(|(_, text)| text.to_string())
        })
    }

    #[test]
    fn the_least_limit_of_a_group_and_those_above_it() {
        let files = [
            ("/sys/fs/cgroup/user.slice/app/memory.max", "max\n"),
            ("/sys/fs/cgroup/user.slice/memory.max", "1073741824\n"),
            ("/sys/fs/cgroup/memory.max", "4294967296\n"),
            ("/sys/fs/cgroup/other/memory.max", "7\n"),
            ("/memory.max", "5\n"),
        ];
        let group = "0::/user.slice/app\n";
        assert_eq!(limit(group, MOUNTS_2, &files), Some(1 << 30));
        assert_eq!(limit("0::/\n", MOUNTS_2, &files), Some(4 << 30));
        // Outside the namespace that is mounted.
        assert_eq!(limit("0::/../x\n", MOUNTS_2, &files), Some(4 << 30));
        assert_eq!(limit(group, MOUNTS_2, &files[..1]), None);
        assert_eq!(limit(group, "", &files), None);
    }

    #[test]
    fn version_one_counts_from_the_root_of_its_mount() {
        let groups = "5:cpu,cpuacct:/docker/ab/y\n4:memory,hugetlb:/docker/ab/x\n0::/\n";
        let files = [
            ("/sys/fs/cgroup/memory/x/memory.limit_in_bytes", "300\n"),
            ("/sys/fs/cgroup/memory/y/memory.limit_in_bytes", "100\n"),
            ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "200\n"),
        ];
        assert_eq!(limit(groups, MOUNTS_1, &files), Some(200));
        assert_eq!(limit(groups, MOUNTS_1, &files[..1]), Some(300));
    }

    #[test]
    fn lines_that_make_no_sense_give_no_limit() {
        for text in [
            "",
            "::",
            "nonsense",
            "4:memory",
            " - cgroup2",
            "1 2 3 - cgroup x",
        ] {
            assert_eq!(limit(text, text, &[("/memory.max", "1")]), None);
        }
    }
}
