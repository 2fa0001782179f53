//! Runs a program and stops it at each of its file-system calls below one folder, by `seccomp` and
//! `ptrace`: what is seen is what the kernel is asked, whichever library asks. At each call a
//! [`Watch`] decides what becomes of it.

use std::collections::HashSet;
use std::fs;
use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc;
use std::time::Duration;

use crate::syscalls::{self, Where};

/// A file-system call that the program is about to make.
pub struct Call {
    pub name: &'static str,
    /// The file or folder that it is about.
    pub path: PathBuf,
    /// The second one of a rename or a link.
    pub to: Option<PathBuf>,
    pub arguments: [u64; 6],
    /// Of the program that was started.
    pub process: libc::pid_t,
    thread: libc::pid_t,
}

/// What becomes of a call.
pub enum Action {
    Pass,
    /// It passes, and [`Watch::after`] is called with its result.
    Follow,
    /// It is not made; the program sees this error.
    Fail(i32),
    /// It is not made; the program is killed.
    Kill,
}

/// Decides about calls.
pub trait Watch {
    fn before(&mut self, call: &Call) -> Action;

    fn after(&mut self, _call: &Call, _result: i64) {}
}

/// How the program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Code(i32),
    Signal(i32),
    /// It was still there when the time was up.
    Hang,
}

impl Call {
    /// Where an open file of the program can be opened again, under any name or none.
    pub fn open_file(&self, descriptor: u64) -> PathBuf {
        format!("/proc/{}/fd/{}", self.thread, descriptor as i32).into()
    }

    /// Position of an open file.
    pub fn position(&self, descriptor: u64) -> u64 {
        let path = format!("/proc/{}/fdinfo/{}", self.thread, descriptor as i32);
        let text = fs::read_to_string(path).expect("the file is open");
        let line = text.lines().find_map(|line| line.strip_prefix("pos:"));
        line.and_then(|line| line.trim().parse().ok())
            .expect("the kernel reports positions")
    }
}

/// Runs `command`, whose calls below `folder` go to `watch`, for `limit` at most.
pub fn run(mut command: Command, folder: &Path, limit: Duration, watch: &mut dyn Watch) -> End {
    let filter = syscalls::filter();
    // SAFETY: the closure makes system calls only, as it must between fork and exec; `filter` was
    // allocated before.
    unsafe { command.pre_exec(move || be_traced(&filter)) };
    // A group of its own, so that its children die with it.
    command.process_group(0);
    let mut child = command.spawn().expect("the program starts");
    let main = libc::pid_t::try_from(child.id()).expect("a process id");
    let (done, wait) = mpsc::channel::<()>();
    let watchdog = std::thread::spawn(move || {
        let late = wait.recv_timeout(limit) == Err(mpsc::RecvTimeoutError::Timeout);
        if late {
            kill(main);
        }
        late
    });
    let tracer = Tracer {
        main,
        folder,
        known: HashSet::from([main]),
        following: Vec::new(),
    };
    let end = tracer.run(watch);
    drop(done);
    // The tracer has waited for it already.
    let _ = child.wait();
    match watchdog.join().expect("it only waits") {
        true => End::Hang,
        false => end,
    }
}

fn be_traced(filter: &[libc::sock_filter]) -> io::Result<()> {
    let program = libc::sock_fprog {
        len: filter.len() as u16,
        filter: filter.as_ptr().cast_mut(),
    };
    // SAFETY: plain system calls; `program` lives until the last of them has ended.
    let failed = unsafe {
        libc::prctl(libc::PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0
            || libc::prctl(libc::PR_SET_SECCOMP, libc::SECCOMP_MODE_FILTER, &program) != 0
            || libc::ptrace(libc::PTRACE_TRACEME, 0, 0, 0) != 0
    };
    match failed {
        true => Err(io::Error::last_os_error()),
        false => Ok(()),
    }
}

/// Kills the program and its children. Its number is not given to others as long as one of them is
/// there.
fn kill(process: libc::pid_t) {
    // SAFETY: a plain system call; `process` leads a group of its own.
    unsafe { libc::kill(-process, libc::SIGKILL) };
}

struct Tracer<'a> {
    main: libc::pid_t,
    folder: &'a Path,
    /// Threads and processes seen.
    known: HashSet<libc::pid_t>,
    /// Calls whose results are waited for.
    following: Vec<Call>,
}

impl Tracer<'_> {
    fn run(mut self, watch: &mut dyn Watch) -> End {
        let mut end = End::Hang;
        loop {
            let mut status = 0;
            // SAFETY: waits for a child of this thread; `status` is ours.
            let thread =
                unsafe { libc::waitpid(-1, &mut status, libc::__WALL | libc::__WNOTHREAD) };
            if thread < 0 {
                return end;
            }
            if libc::WIFEXITED(status) || libc::WIFSIGNALED(status) {
                if thread == self.main {
                    end = match libc::WIFEXITED(status) {
                        true => End::Code(libc::WEXITSTATUS(status)),
                        false => End::Signal(libc::WTERMSIG(status)),
                    };
                }
                continue;
            }
            self.stopped(thread, status, watch);
        }
    }

    /// Handles a stop and lets the thread go on.
    fn stopped(&mut self, thread: libc::pid_t, status: i32, watch: &mut dyn Watch) {
        let signal = libc::WSTOPSIG(status);
        let event = status >> 16;
        let mut request = libc::PTRACE_CONT;
        let mut delivered = 0;
        if event == libc::PTRACE_EVENT_SECCOMP {
            if self.call(thread, watch) {
                request = libc::PTRACE_SYSCALL;
            }
        } else if signal == libc::SIGTRAP | 0x80 {
            self.result(thread, watch);
        } else if signal == libc::SIGTRAP {
            if thread == self.main && event == 0 {
                set_options(thread);
            }
        } else if self.known.insert(thread) && signal == libc::SIGSTOP {
            // So begins each new thread.
        } else if event == 0 {
            delivered = signal;
        }
        ptrace(request, thread, 0, delivered as u64);
    }

    /// Before a call; returns whether its result is wanted.
    fn call(&mut self, thread: libc::pid_t, watch: &mut dyn Watch) -> bool {
        let Some(mut registers) = registers(thread) else {
            return false;
        };
        let Some(call) = self.describe(thread, &registers) else {
            return false;
        };
        match watch.before(&call) {
            Action::Pass => {}
            Action::Follow => {
                self.following.push(call);
                return true;
            }
            Action::Kill => kill(self.main),
            Action::Fail(error) => {
                // Number -1 skips the call, and the program finds this result.
                registers.orig_rax = u64::MAX;
                registers.rax = i64::from(-error) as u64;
                let address = &raw const registers as u64;
                ptrace(libc::PTRACE_SETREGS, thread, 0, address);
            }
        }
        false
    }

    fn result(&mut self, thread: libc::pid_t, watch: &mut dyn Watch) {
        let place = self.following.iter().position(|call| call.thread == thread);
        if let (Some(place), Some(registers)) = (place, registers(thread)) {
            let call = self.following.swap_remove(place);
            watch.after(&call, registers.rax as i64);
        }
    }

    /// The call, if it is about something below the folder.
    fn describe(&self, thread: libc::pid_t, registers: &libc::user_regs_struct) -> Option<Call> {
        let r = registers;
        let arguments = [r.rdi, r.rsi, r.rdx, r.r10, r.r8, r.r9];
        let (name, place) = syscalls::look_up(r.orig_rax)?;
        // Only builds with assertions ask whether a file is open.
        if name == "fcntl" && arguments[1] == libc::F_GETFD as u64 {
            return None;
        }
        let at = |folder: Option<usize>, path: usize| {
            path_of(thread, folder.map(|f| arguments[f]), arguments[path])
        };
        let (path, to) = match place {
            Where::Open(d) => (open_file(thread, arguments[d])?, None),
            Where::Path(p) => (at(None, p)?, None),
            Where::At(f, p) => (at(Some(f), p)?, None),
            Where::Paths(p, q) => (at(None, p)?, at(None, q)),
            Where::Ats(f, p, g, q) => (at(Some(f), p)?, at(Some(g), q)),
        };
        let inside = |path: &PathBuf| path.starts_with(self.folder);
        (inside(&path) || to.as_ref().is_some_and(inside)).then_some(Call {
            name,
            path,
            to,
            arguments,
            process: self.main,
            thread,
        })
    }
}

fn set_options(thread: libc::pid_t) {
    let options = libc::PTRACE_O_TRACESECCOMP
        | libc::PTRACE_O_TRACESYSGOOD
        | libc::PTRACE_O_TRACECLONE
        | libc::PTRACE_O_TRACEFORK
        | libc::PTRACE_O_TRACEVFORK
        | libc::PTRACE_O_EXITKILL;
    ptrace(libc::PTRACE_SETOPTIONS, thread, 0, options as u64);
}

/// Errors mean that the thread was killed meanwhile, which the next wait reports.
fn ptrace(request: libc::c_uint, thread: libc::pid_t, address: u64, data: u64) -> bool {
    // SAFETY: `thread` is traced by us; requests that take an address get one of a live value.
    unsafe { libc::ptrace(request, thread, address, data) == 0 }
}

fn registers(thread: libc::pid_t) -> Option<libc::user_regs_struct> {
    // SAFETY: all zeros are valid registers.
    let mut registers: libc::user_regs_struct = unsafe { std::mem::zeroed() };
    let address = &raw mut registers as u64;
    ptrace(libc::PTRACE_GETREGS, thread, 0, address).then_some(registers)
}

/// A path argument, made absolute; an empty one means the folder's descriptor itself.
fn path_of(thread: libc::pid_t, folder: Option<u64>, address: u64) -> Option<PathBuf> {
    let text = read_text(thread, address);
    if text.as_ref().is_some_and(|text| text.starts_with('/')) {
        return text.map(PathBuf::from);
    }
    let base = match folder {
        Some(folder) if folder as i32 != libc::AT_FDCWD => open_file(thread, folder)?,
        _ => fs::read_link(format!("/proc/{thread}/cwd")).ok()?,
    };
    match text {
        Some(text) if !text.is_empty() => Some(base.join(text)),
        _ => Some(base),
    }
}

/// Path of an open file.
fn open_file(thread: libc::pid_t, descriptor: u64) -> Option<PathBuf> {
    fs::read_link(format!("/proc/{thread}/fd/{}", descriptor as i32)).ok()
}

/// Text that ends with a zero, in pieces that stay within a page.
fn read_text(thread: libc::pid_t, address: u64) -> Option<String> {
    const PIECE: u64 = 256;
    let mut bytes = Vec::new();
    let mut at = address;
    loop {
        let piece = PIECE - at % PIECE;
        let read = read_memory(thread, at, piece as usize)?;
        if let Some(end) = read.iter().position(|byte| *byte == 0) {
            bytes.extend(&read[..end]);
            return Some(String::from_utf8_lossy(&bytes).into_owned());
        }
        bytes.extend(read);
        at += piece;
    }
}

fn read_memory(thread: libc::pid_t, address: u64, length: usize) -> Option<Vec<u8>> {
    let mut bytes = vec![0u8; length];
    let ours = libc::iovec {
        iov_base: bytes.as_mut_ptr().cast(),
        iov_len: length,
    };
    let theirs = libc::iovec {
        iov_base: address as *mut libc::c_void,
        iov_len: length,
    };
    // SAFETY: `ours` is the buffer above; the kernel checks `theirs`.
    let read = unsafe { libc::process_vm_readv(thread, &ours, 1, &theirs, 1, 0) };
    (read == length as isize).then_some(bytes)
}
