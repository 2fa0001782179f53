//! Moving pictures: GIF, and MP4 where the program was built with the feature `video`.

mod gif;
#[cfg(feature = "video")]
mod mp4;

use std::path::{Path, PathBuf};

use super::canvas::Canvas;
use crate::file::FileError;
use crate::record::atomic;

/// A film that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The encoder refuses a picture.
    #[error("cannot encode the film: {0}")]
    Encoder(String),
    /// The program was built without the encoder.
    #[error("this program has no MP4: write .gif or .png, or build it with `--features video`")]
    Absent,
}

/// A format of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A loop that every program shows; 256 colours a picture.
    Gif,
    /// H.264 in MP4.
    Mp4,
}

/// A film of pictures of one size, kept in memory until it is complete.
pub struct Film {
    path: PathBuf,
    encoder: Box<dyn Encoder>,
}

/// Takes pictures, returns the file.
trait Encoder: Send {
    fn add(&mut self, picture: &Canvas) -> Result<(), FilmError>;
    fn finish(self: Box<Self>) -> Result<Vec<u8>, FilmError>;
}

impl Film {
    /// A film with `rate` pictures a second, to be written to `path`; `size`: width and height,
    /// pixels, even for MP4.
    ///
    /// # Errors
    /// If the encoder cannot be made.
    pub fn new(
        format: Format,
        path: &Path,
        size: [usize; 2],
        rate: f64,
    ) -> Result<Film, FilmError> {
        let encoder: Box<dyn Encoder> = match format {
            Format::Gif => Box::new(gif::Gif::new(size, rate)?),
            #[cfg(feature = "video")]
            Format::Mp4 => Box::new(mp4::Mp4::new(size, rate)?),
            #[cfg(not(feature = "video"))]
            Format::Mp4 => return Err(FilmError::Absent),
        };
        let path = path.to_path_buf();
        Ok(Film { path, encoder })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// If it cannot be encoded.
    pub fn add(&mut self, picture: &Canvas) -> Result<(), FilmError> {
        self.encoder.add(picture)
    }

    /// Writes the file, atomically.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self) -> Result<(), FilmError> {
        let bytes = self.encoder.finish()?;
        Ok(atomic::write_file(&self.path, &bytes)?)
    }
}

/// For an error of an encoder.
fn failed(error: impl std::fmt::Display) -> FilmError {
    FilmError::Encoder(error.to_string())
}
