//! What is written while the solver goes on.

use coronet::record::background::CheckpointWriter;
use coronet::record::checkpoint::{self, Checkpoint};
use coronet::record::log::{LogError, LogWriter};

use crate::record_log::{frame, setup};

#[test]
fn mistakes_surface_at_the_next_call() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = LogWriter::create(folder.path(), 0, None, &setup()).unwrap();
    let taken = LogWriter::create(folder.path(), 0, None, &setup());
    assert!(matches!(taken, Err(LogError::Io(_))));
    let mut bad = frame(0);
    bad.pressure.pop();
    writer.frame(bad).unwrap();
    let told = (0..10).find_map(|k| writer.frame(frame(k)).err());
    let told = match told {
        Some(error) => error,
        None => writer.finish().unwrap_err(),
    };
    assert!(matches!(told, LogError::Frame(_)), "{told}");

    let mut writer = LogWriter::create(folder.path(), 1, None, &setup()).unwrap();
    let mut other = frame(1);
    other.scalars[0].0 = "momentum_kg_m_s".into();
    writer.frame(frame(0)).unwrap();
    writer.frame(other).unwrap();
    assert!(matches!(writer.finish(), Err(LogError::Frame(_))));
}

#[test]
fn checkpoints_are_written_in_the_background_after_their_frames() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = LogWriter::create(folder.path(), 0, None, &setup()).unwrap();
    let mut writer = CheckpointWriter::new(1).unwrap();
    let at = |step: u64| Checkpoint {
        kind: "state".into(),
        step,
        time: step as f64,
        ..Checkpoint::default()
    };
    let path = |step: u64| folder.path().join(format!("{step}.coronet"));
    let mut written = Vec::new();
    for step in 0..6 {
        log.frame(frame(step as usize)).unwrap();
        let flush = log.flush(step as f64).unwrap();
        writer.submit(at(step), path(step), Some(flush)).unwrap();
        written.extend(writer.written().unwrap());
    }
    written.extend(writer.wait().unwrap());
    assert_eq!(written.len(), 6);
    for (step, written) in (0..).zip(&written) {
        assert_eq!((&written.path, written.time), (&path(step), step as f64));
        assert_eq!(checkpoint::read(&written.path).unwrap(), at(step));
        assert_eq!(written.digest, at(step).digest());
    }
    let nowhere = folder.path().join("no/such/folder/a");
    writer.submit(at(9), nowhere, None).unwrap();
    assert!(writer.wait().is_err());
    assert!(writer.submit(at(9), path(9), None).is_err());
}
