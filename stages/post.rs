//! `post`: the log of frames -> measures, plots, pictures and the report.

use coronet::pipeline::{Context, Output, Setting, Stage, StageError};
use coronet::record::log;
use coronet::scene::file::Loaded;

use crate::impact::FRAMES;

/// The table of measures.
pub const MEASURES: &str = "measures.csv";
/// The page that shows everything.
pub const REPORT: &str = "report.html";

pub struct Post<'a> {
    pub loaded: &'a Loaded,
    /// Job that wrote the log.
    pub impact: usize,
    pub settings: Vec<Setting>,
    /// VERSION, see [`crate::jobs::version`].
    pub version: u32,
}

impl Stage for Post<'_> {
    fn name(&self) -> &str {
        "post"
    }

    fn version(&self) -> u32 {
        self.version
    }

    fn settings(&self) -> Vec<Setting> {
        self.settings.clone()
    }

    fn inputs(&self) -> Vec<usize> {
        vec![self.impact]
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        let path = context.verified(0, FRAMES)?;
        let mut text = String::new();
        for frame in log::read_frames(&path).map_err(StageError::failed)? {
            let frame = frame.map_err(StageError::failed)?;
            text += &format!("{},{:?}\n", frame.time, frame.scalars);
        }
        std::fs::write(context.output().join(MEASURES), text).map_err(StageError::failed)?;
        Ok(vec![Output::counted(MEASURES)])
    }
}
