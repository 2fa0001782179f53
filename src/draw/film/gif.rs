//! GIF89a, without end.

use gif::{Frame, Repeat};

use super::{Encoder, FilmError, failed};
use crate::draw::canvas::Canvas;
use crate::record::mark::MARK;

/// Speed of the choice of colours, 1 (best) to 30.
const SPEED: i32 = 10;

pub struct Gif {
    encoder: gif::Encoder<Vec<u8>>,
    /// Time of a picture, hundredths of a second.
    delay: f64,
    /// Pictures so far, and the time of them that their delays have.
    count: f64,
    shown: f64,
}

impl Gif {
    pub fn new(size: [usize; 2], rate: f64) -> Result<Gif, FilmError> {
        let [width, height] = size.map(|s| s as u16);
        let mut encoder = gif::Encoder::new(Vec::new(), width, height, &[]).map_err(failed)?;
        encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
        let comment = gif::AnyExtension::from(gif::Extension::Comment);
        let mark = encoder.write_raw_extension(comment, &[MARK.as_bytes()]);
        mark.map_err(failed)?;
        // Viewers slow down what is faster than 50 pictures a second.
        let delay = (100.0 / rate).clamp(2.0, 1000.0);
        let (count, shown) = (0.0, 0.0);
        Ok(Gif {
            encoder,
            delay,
            count,
            shown,
        })
    }
}

impl Encoder for Gif {
    fn add(&mut self, picture: &Canvas) -> Result<(), FilmError> {
        let [width, height] = [picture.width, picture.height].map(|s| s as u16);
        let pixels = picture.pixels().as_flattened();
        let mut frame = Frame::from_rgb_speed(width, height, pixels, SPEED);
        // Whole hundredths, so that none is late by more than a half.
        self.count += 1.0;
        let until = (self.count * self.delay).round();
        frame.delay = (until - self.shown) as u16;
        self.shown = until;
        self.encoder.write_frame(&frame).map_err(failed)
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FilmError> {
        self.encoder.into_inner().map_err(failed)
    }
}
