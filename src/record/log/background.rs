//! The log of a running simulation, written by its own thread.

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::output::{self, Output};
use super::{LogError, LogSetup, Tap, merge};
use crate::measure::series::Row;
use crate::particle::Frame;
use crate::record::atomic::{self, FileError};

/// Largest number of queued frames; then the solver waits.
const QUEUE: usize = 2;

enum Order {
    Frame(Box<Frame>, Row),
    /// Make all earlier frames durable, record the time of the checkpoint, answer.
    Flush(f64, SyncSender<()>),
}

/// Writes one segment of a log in the background. The next call returns an error.
pub struct LogWriter {
    orders: Option<SyncSender<Order>>,
    thread: Option<JoinHandle<Result<u64, LogError>>>,
    path: PathBuf,
}

/// A flush in progress.
#[must_use = "frames are durable only after `wait`"]
pub struct Flush(Receiver<()>);

impl Flush {
    /// Returns when every frame written before the flush is on disk.
    ///
    /// # Errors
    /// If the log failed.
    pub fn wait(self) -> Result<(), LogError> {
        self.0.recv().map_err(|_| LogError::Closed)
    }
}

impl LogWriter {
    /// Starts segment number `segment` in `folder`; a file of that number must not exist.
    /// `resumed_from` is the simulated time, s, of the checkpoint from which the run continues.
    ///
    /// # Errors
    /// If the file cannot be created or written.
    pub fn create(
        folder: &Path,
        segment: u32,
        resumed_from: Option<f64>,
        setup: &LogSetup,
    ) -> Result<Self, LogError> {
        LogWriter::tapped(folder, segment, resumed_from, setup, None)
    }

    /// [`create`](Self::create), with `tap` for who looks on.
    ///
    /// # Errors
    /// If the file cannot be created or written.
    pub fn tapped(
        folder: &Path,
        segment: u32,
        resumed_from: Option<f64>,
        setup: &LogSetup,
        tap: Option<Tap>,
    ) -> Result<Self, LogError> {
        let path = merge::segment_path(folder, segment);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)
            .map_err(FileError::new(&path, "create"))?;
        atomic::sync_folder_of(&path)?;
        let mut output = Output::new(file, &path, tap)?;
        let facts = resumed_from.map(|time| ("resumed_from_s".to_string(), time.to_string()));
        output.metadata(merge::SEGMENT, facts.into_iter().collect())?;
        output::write_setup(&mut output, setup)?;
        // So that even a log that is cut off early identifies its segment.
        output.sync()?;
        let (orders, queue) = sync_channel(QUEUE);
        // The frame includes the wall particles, which can be many.
        let setup = LogSetup {
            wall: Default::default(),
            ..setup.clone()
        };
        let spawned = std::thread::Builder::new()
            .name("log".into())
            .spawn(move || write_all(output, &setup, &queue));
        let thread = spawned.map_err(FileError::new(&path, "start a thread for"))?;
        Ok(LogWriter {
            orders: Some(orders),
            thread: Some(thread),
            path,
        })
    }

    /// The segment's file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a frame. Waits only if the disk is slower than the solver.
    ///
    /// # Errors
    /// If the frame does not fit the log, or an earlier write failed.
    pub fn frame(&mut self, frame: Frame) -> Result<(), LogError> {
        self.measured(frame, Row::new())
    }

    /// Adds a frame with figures of the shape of the liquid: names and values, the same names in
    /// every frame. Waits only if the disk is slower than the solver.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub fn measured(&mut self, frame: Frame, figures: Row) -> Result<(), LogError> {
        self.send(Order::Frame(Box::new(frame), figures))
    }

    /// Starts to make all frames so far durable. A checkpoint of simulated time `time`, s, must not
    /// become visible before the flush has ended.
    ///
    /// # Errors
    /// If an earlier write failed.
    pub fn flush(&mut self, time: f64) -> Result<Flush, LogError> {
        let (done, answer) = sync_channel(1);
        self.send(Order::Flush(time, done))?;
        Ok(Flush(answer))
    }

    /// Writes the queued frames, ends the file, makes it durable. Returns the number of frames.
    ///
    /// # Errors
    /// If a frame cannot be written.
    pub fn finish(mut self) -> Result<u64, LogError> {
        self.orders = None;
        self.join()
    }

    fn send(&mut self, order: Order) -> Result<(), LogError> {
        let orders = self.orders.as_ref().ok_or(LogError::Closed)?;
        if orders.send(order).is_ok() {
            return Ok(());
        }
        // The thread has ended early, so it has an error.
        self.orders = None;
        Err(self.join().err().unwrap_or(LogError::Closed))
    }

    fn join(&mut self) -> Result<u64, LogError> {
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(panic)) => std::panic::resume_unwind(panic),
            None => Err(LogError::Closed),
        }
    }
}

impl Drop for LogWriter {
    /// Without [`finish`](Self::finish): writes queued frames and ends the segment, ignoring
    /// errors.
    fn drop(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn write_all(
    mut output: Output,
    setup: &LogSetup,
    queue: &Receiver<Order>,
) -> Result<u64, LogError> {
    let mut schemas = output::Schemas::default();
    let mut frames = 0;
    for order in queue {
        match order {
            Order::Frame(frame, figures) => {
                output::write_frame(&mut output, setup, &mut schemas, &frame, &figures)?;
                frames += 1;
            }
            Order::Flush(time, done) => {
                let facts = BTreeMap::from([("time_s".to_string(), time.to_string())]);
                output.metadata(merge::DURABLE, facts)?;
                output.sync()?;
                // The receiver may be gone.
                let _ = done.send(());
            }
        }
    }
    output.finish()?;
    Ok(frames)
}
