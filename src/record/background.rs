//! Checkpoints that are written while the solver continues.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::JoinHandle;

use super::atomic::FileError;
use super::checkpoint::{Checkpoint, CheckpointError};
use super::digest::Digest;
use super::log::{Flush, LogError};

/// A background write that failed.
#[derive(Debug, thiserror::Error)]
pub enum BackgroundError {
    /// The checkpoint cannot be written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The log cannot be flushed before it.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The writer ended at an earlier error.
    #[error("the writer of checkpoints has stopped after an earlier error")]
    Closed,
}

/// A checkpoint that has reached the disk.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The file.
    pub path: PathBuf,
    /// Digest of its content.
    pub digest: Digest,
    /// Simulated time, s.
    pub time: f64,
}

struct Order {
    checkpoint: Checkpoint,
    path: PathBuf,
    after: Option<Flush>,
}

/// Writes checkpoints in its own thread, one at a time, in order. The next call returns an error.
pub struct CheckpointWriter {
    orders: Option<SyncSender<Order>>,
    written: Receiver<Written>,
    thread: Option<JoinHandle<Result<(), BackgroundError>>>,
    waiting: usize,
}

impl CheckpointWriter {
    /// Writer at zstd level `level`. It compresses on one thread, beside the solver's.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn new(level: i32) -> Result<Self, BackgroundError> {
        // One is being written, one is queued; a third makes the solver wait.
        let (orders, queue) = sync_channel::<Order>(1);
        let (done, written) = std::sync::mpsc::channel();
        let thread = std::thread::Builder::new()
            .name("checkpoint".into())
            .spawn(move || {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(1)
                    .use_current_thread()
                    .build()
                    .ok();
                for order in queue {
                    if let Some(flush) = order.after {
                        flush.wait()?;
                    }
                    let write = || order.checkpoint.write(&order.path, level);
                    let digest = match &pool {
                        Some(pool) => pool.install(write)?,
                        None => write()?,
                    };
                    let written = Written {
                        path: order.path,
                        digest,
                        time: order.checkpoint.time,
                    };
                    // The receiver may be gone.
                    let _ = done.send(written);
                }
                Ok(())
            })
            .map_err(FileError::new("checkpoints".as_ref(), "start a thread for"))
            .map_err(CheckpointError::Io)?;
        Ok(CheckpointWriter {
            orders: Some(orders),
            written,
            thread: Some(thread),
            waiting: 0,
        })
    }

    /// Queues `checkpoint` for writing to `path` once `after`, the flush of the frames before it,
    /// has ended. Waits if two are queued already.
    ///
    /// # Errors
    /// If an earlier checkpoint failed.
    pub fn submit(
        &mut self,
        checkpoint: Checkpoint,
        path: PathBuf,
        after: Option<Flush>,
    ) -> Result<(), BackgroundError> {
        let order = Order {
            checkpoint,
            path,
            after,
        };
        let orders = self.orders.as_ref().ok_or(BackgroundError::Closed)?;
        if orders.send(order).is_ok() {
            self.waiting += 1;
            return Ok(());
        }
        Err(self.failure())
    }

    /// Checkpoints that have reached the disk since the last call; does not wait.
    ///
    /// # Errors
    /// If a checkpoint failed.
    pub fn written(&mut self) -> Result<Vec<Written>, BackgroundError> {
        let mut all = Vec::new();
        loop {
            match self.written.try_recv() {
                Ok(written) => all.push(written),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) if all.is_empty() => return Err(self.failure()),
                Err(TryRecvError::Disconnected) => break,
            }
        }
        self.waiting -= all.len();
        Ok(all)
    }

    /// Waits until all submitted checkpoints are on disk; returns them as
    /// [`written`](Self::written) does.
    ///
    /// # Errors
    /// If a checkpoint failed.
    pub fn wait(&mut self) -> Result<Vec<Written>, BackgroundError> {
        let mut all = Vec::new();
        while self.waiting > 0 {
            match self.written.recv() {
                Ok(written) => all.push(written),
                Err(_) => return Err(self.failure()),
            }
            self.waiting -= 1;
        }
        Ok(all)
    }

    fn failure(&mut self) -> BackgroundError {
        self.orders = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result.err().unwrap_or(BackgroundError::Closed),
            Some(Err(panic)) => std::panic::resume_unwind(panic),
            None => BackgroundError::Closed,
        }
    }
}

impl Drop for CheckpointWriter {
    /// Finishes the submitted checkpoints.
    fn drop(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
