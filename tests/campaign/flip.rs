//! Each byte of each file of a finished store is changed: `verify` reports it.

use std::fs;
use std::path::{Path, PathBuf};

use coronet::pipeline::{Store, verify};

use crate::place::{Files, Place, RUN};
use crate::report::{Report, side_by_side};
use crate::trace::End;

/// Bytes of one file that are changed by one worker.
struct Piece<'a> {
    file: &'a Path,
    /// All that `verify` needs to see beside it.
    beside: Files,
    bytes: std::ops::Range<usize>,
}

/// Longest piece, bytes.
const PIECE: usize = 4096;

/// Every `stride`-th byte; panics with a table of what was not reported.
pub fn campaign(stride: usize) {
    let place = Place::new();
    // Pictures are the largest files, and one like the other.
    let ended = place.call(&[RUN, &["--set", "post.panels=[]"]].concat());
    assert_eq!(ended.end, End::Code(0), "{ended:?}");
    let files = place.files();
    let store = files
        .iter()
        .filter(|(path, _)| path.starts_with("artifacts"));
    let mut pieces = Vec::new();
    let files_only = store.filter(|(_, bytes)| !bytes.starts_with(b"-> "));
    for (file, bytes) in files_only {
        for start in (0..bytes.len()).step_by(PIECE) {
            pieces.push(Piece {
                file,
                beside: beside(&files, file),
                bytes: start..bytes.len().min(start + PIECE),
            });
        }
    }
    let found = side_by_side(&pieces, |piece| piece.unseen(stride));
    let mut report = Report::new("changed bytes");
    let checks = pieces
        .iter()
        .map(|piece| piece.bytes.clone().step_by(stride).len());
    report.count("verify", pieces.len(), checks.sum());
    for (piece, unseen) in pieces.iter().zip(found) {
        for byte in unseen {
            let what = format!("{} is not checked", piece.file.display());
            report.add("verify", &format!("byte {byte}"), Err(what));
        }
    }
    report.end();
}

/// The folder of a result alone is a store, too; a file that is in none needs the whole.
fn beside(files: &Files, file: &Path) -> Files {
    let result: PathBuf = file.components().take(3).collect();
    let alone = files.contains_key(&result.join("stamp.json"));
    let near = |path: &Path| {
        let in_root = path.components().count() == 2;
        !alone || in_root || path.starts_with(&result)
    };
    let near = files.iter().filter(|(path, _)| near(path));
    near.map(|(path, bytes)| (path.clone(), bytes.clone()))
        .collect()
}

impl Piece<'_> {
    /// The bytes whose change was not reported.
    fn unseen(&self, stride: usize) -> Vec<usize> {
        let place = Place::of(&self.beside);
        assert!(!is_reported(&place), "{}: at first", self.file.display());
        let path = place.path().join(self.file);
        let good = &self.beside[self.file];
        let mut unseen = Vec::new();
        for byte in self.bytes.clone().step_by(stride) {
            let mut bytes = good.clone();
            bytes[byte] ^= 1 << (byte % 8);
            fs::write(&path, bytes).expect("there is space");
            if !is_reported(&place) {
                unseen.push(byte);
            }
            self.restore(&place);
        }
        unseen
    }

    /// Undoes the change and what `verify` made of it.
    fn restore(&self, place: &Place) {
        for aside in place.set_aside() {
            fs::remove_file(place.path().join(aside)).expect("it is there");
        }
        let stamps = self
            .beside
            .iter()
            .filter(|(path, _)| path.ends_with("stamp.json"));
        let changed = [(&self.file.to_path_buf(), &self.beside[self.file])];
        for (path, bytes) in stamps.chain(changed) {
            fs::write(place.path().join(path), bytes).expect("there is space");
        }
    }
}

/// Whether `verify` finds anything wrong.
fn is_reported(place: &Place) -> bool {
    match verify::verify(&Store::new(place.store()), &mut |_| {}) {
        Ok(findings) => findings.iter().any(|finding| !finding.problems.is_empty()),
        Err(_) => true,
    }
}
