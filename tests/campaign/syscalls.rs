//! The system calls that are about files, and where each has its paths.

use libc::{c_long, sock_filter};

/// Which arguments of a call lead to its file.
#[derive(Clone, Copy)]
pub enum Where {
    /// An open file.
    Open(usize),
    Path(usize),
    Paths(usize, usize),
    /// An open folder and a path from there.
    At(usize, usize),
    Ats(usize, usize, usize, usize),
}

use Where::{At, Ats, Open, Path, Paths};

/// All but `close`, which cannot fail in a way that matters.
const TABLE: &[(c_long, &str, Where)] = &[
    (libc::SYS_open, "open", Path(0)),
    (libc::SYS_creat, "creat", Path(0)),
    (libc::SYS_openat, "openat", At(0, 1)),
    (libc::SYS_openat2, "openat2", At(0, 1)),
    (libc::SYS_read, "read", Open(0)),
    (libc::SYS_pread64, "pread64", Open(0)),
    (libc::SYS_readv, "readv", Open(0)),
    (libc::SYS_preadv, "preadv", Open(0)),
    (libc::SYS_preadv2, "preadv2", Open(0)),
    (libc::SYS_write, "write", Open(0)),
    (libc::SYS_pwrite64, "pwrite64", Open(0)),
    (libc::SYS_writev, "writev", Open(0)),
    (libc::SYS_pwritev, "pwritev", Open(0)),
    (libc::SYS_pwritev2, "pwritev2", Open(0)),
    (libc::SYS_lseek, "lseek", Open(0)),
    (libc::SYS_mmap, "mmap", Open(4)),
    (libc::SYS_sendfile, "sendfile", Open(0)),
    (libc::SYS_copy_file_range, "copy_file_range", Open(2)),
    (libc::SYS_fsync, "fsync", Open(0)),
    (libc::SYS_fdatasync, "fdatasync", Open(0)),
    (libc::SYS_sync_file_range, "sync_file_range", Open(0)),
    (libc::SYS_truncate, "truncate", Path(0)),
    (libc::SYS_ftruncate, "ftruncate", Open(0)),
    (libc::SYS_fallocate, "fallocate", Open(0)),
    (libc::SYS_flock, "flock", Open(0)),
    (libc::SYS_fcntl, "fcntl", Open(0)),
    (libc::SYS_stat, "stat", Path(0)),
    (libc::SYS_lstat, "lstat", Path(0)),
    (libc::SYS_fstat, "fstat", Open(0)),
    (libc::SYS_newfstatat, "newfstatat", At(0, 1)),
    (libc::SYS_statx, "statx", At(0, 1)),
    (libc::SYS_statfs, "statfs", Path(0)),
    (libc::SYS_fstatfs, "fstatfs", Open(0)),
    (libc::SYS_access, "access", Path(0)),
    (libc::SYS_faccessat, "faccessat", At(0, 1)),
    (libc::SYS_faccessat2, "faccessat2", At(0, 1)),
    (libc::SYS_readlink, "readlink", Path(0)),
    (libc::SYS_readlinkat, "readlinkat", At(0, 1)),
    (libc::SYS_getdents64, "getdents64", Open(0)),
    (libc::SYS_mkdir, "mkdir", Path(0)),
    (libc::SYS_mkdirat, "mkdirat", At(0, 1)),
    (libc::SYS_rmdir, "rmdir", Path(0)),
    (libc::SYS_unlink, "unlink", Path(0)),
    (libc::SYS_unlinkat, "unlinkat", At(0, 1)),
    (libc::SYS_symlink, "symlink", Path(1)),
    (libc::SYS_symlinkat, "symlinkat", At(1, 2)),
    (libc::SYS_link, "link", Paths(0, 1)),
    (libc::SYS_linkat, "linkat", Ats(0, 1, 2, 3)),
    (libc::SYS_rename, "rename", Paths(0, 1)),
    (libc::SYS_renameat, "renameat", Ats(0, 1, 2, 3)),
    (libc::SYS_renameat2, "renameat2", Ats(0, 1, 2, 3)),
    (libc::SYS_chmod, "chmod", Path(0)),
    (libc::SYS_fchmod, "fchmod", Open(0)),
    (libc::SYS_fchmodat, "fchmodat", At(0, 1)),
    (libc::SYS_utimensat, "utimensat", At(0, 1)),
];

/// Name and paths of the call of that number, if it is about files.
pub fn look_up(number: u64) -> Option<(&'static str, Where)> {
    let mut rows = TABLE.iter();
    let row = rows.find(|row| row.0 as u64 == number)?;
    Some((row.1, row.2))
}

/// A program for the kernel: stop at the calls of the table, let all others pass.
pub fn filter() -> Vec<sock_filter> {
    let statement = |code: u32, k: u32| sock_filter {
        code: code as u16,
        jt: 0,
        jf: 0,
        k,
    };
    let stop = statement(libc::BPF_RET | libc::BPF_K, libc::SECCOMP_RET_TRACE);
    let pass = statement(libc::BPF_RET | libc::BPF_K, libc::SECCOMP_RET_ALLOW);
    // The number of the call is the first thing in what the program is given.
    let mut filter = vec![statement(libc::BPF_LD | libc::BPF_W | libc::BPF_ABS, 0)];
    for (number, ..) in TABLE {
        let unequal = sock_filter {
            jf: 1,
            ..statement(libc::BPF_JMP | libc::BPF_JEQ | libc::BPF_K, *number as u32)
        };
        filter.extend([unequal, stop]);
    }
    filter.push(pass);
    filter
}
