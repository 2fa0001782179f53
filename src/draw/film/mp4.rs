//! H.264 in MP4: what every browser and presentation plays. OpenH264 (Cisco) encodes, on one
//! thread.

use muxide::api::{MuxerBuilder, VideoCodec};
use openh264::OpenH264API;
use openh264::encoder::{
    BitRate, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange, RateControlMode,
};
use openh264::formats::{RgbSliceU8, YUVBuffer};

use super::{Encoder, FilmError, failed};
use crate::draw::canvas::Canvas;
use crate::record::mark;

/// Quantisation, 0 (best) to 51: one that the eye does not see.
const QUANTISER: QpRange = QpRange::new(14, 24);

pub struct Mp4 {
    encoder: openh264::encoder::Encoder,
    size: [usize; 2],
    rate: f64,
    /// Encoded pictures; whether each stands alone.
    packets: Vec<(Vec<u8>, bool)>,
}

impl Mp4 {
    pub fn new(size: [usize; 2], rate: f64) -> Result<Mp4, FilmError> {
        // A tenth of a byte for each pixel of each picture at most.
        let bits = 0.8 * (size[0] * size[1]) as f64 * rate;
        let config = EncoderConfig::new()
            .bitrate(BitRate::from_bps(bits as u32))
            .max_frame_rate(FrameRate::from_hz(rate as f32))
            .rate_control_mode(RateControlMode::Off)
            .qp(QUANTISER)
            .intra_frame_period(IntraFramePeriod::from_num_frames(50))
            .num_threads(1);
        let api = OpenH264API::from_source();
        Ok(Mp4 {
            encoder: openh264::encoder::Encoder::with_api_config(api, config).map_err(failed)?,
            size,
            rate,
            packets: Vec::new(),
        })
    }
}

impl Encoder for Mp4 {
    fn add(&mut self, picture: &Canvas) -> Result<(), FilmError> {
        let pixels = picture.pixels().as_flattened();
        let rgb = RgbSliceU8::new(pixels, (picture.width, picture.height));
        let stream = self.encoder.encode(&YUVBuffer::from_rgb8_source(rgb));
        let stream = stream.map_err(failed)?;
        let is_alone = matches!(stream.frame_type(), FrameType::IDR | FrameType::I);
        self.packets.push((stream.to_vec(), is_alone));
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<u8>, FilmError> {
        let mut bytes = Vec::new();
        let [width, height] = self.size.map(|s| s as u32);
        let muxer = MuxerBuilder::new(&mut bytes);
        let muxer = muxer.video(VideoCodec::H264, width, height, self.rate);
        let mut muxer = muxer.build().map_err(failed)?;
        for (n, (packet, is_alone)) in self.packets.iter().enumerate() {
            let time = n as f64 / self.rate;
            muxer.write_video(time, packet, *is_alone).map_err(failed)?;
        }
        muxer.finish().map_err(failed)?;
        bytes.extend(mark::tail());
        Ok(bytes)
    }
}
