//! `calibrate`: bodies, packed or relaxed ([`method::is_of_packing`]) -> the strength of the
//! tension on this arrangement.

use coronet::method;
use coronet::pipeline::{Context, Identity, Output, Stage, StageError, Work};
use coronet::record::{Checkpoint, checkpoint};
use coronet::scene::input::CalibrateInput;

use crate::body::read_body;
use crate::settings::Forecast;

const FILE: &str = "strength.checkpoint";
const STRENGTH: &str = "strength";

pub struct Calibrate<'a> {
    pub input: CalibrateInput,
    /// Jobs of the bodies that it reads, in the order of the scene.
    pub bodies: Vec<usize>,
    pub forecast: Forecast<'a>,
    pub identity: Identity,
}

impl Stage for Calibrate<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn inputs(&self) -> Vec<usize> {
        self.bodies.clone()
    }

    fn work(&self) -> Option<Work> {
        (self.forecast)()
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        let bodies: Result<Vec<_>, _> = (0..self.bodies.len())
            .map(|body| read_body(context, body, body))
            .collect();
        let calibration =
            method::calibrate(&self.input.bodies, &bodies?).map_err(StageError::failed)?;
        context.note(format!("alpha = {}", calibration.strength));
        let mut scalars = vec![(STRENGTH.to_string(), calibration.strength)];
        for (index, (name, area, ratio)) in calibration.bodies.iter().enumerate() {
            context.note(format!(
                "{name}: sigma_eff / sigma at alpha = 1 is {ratio:.6}"
            ));
            scalars.push((format!("area/{index}"), *area));
            scalars.push((format!("ratio/{index}"), *ratio));
        }
        let checkpoint = Checkpoint {
            kind: "calibration".into(),
            scalars,
            ..Checkpoint::default()
        };
        let path = context.output().join(FILE);
        checkpoint
            .write(&path, checkpoint::LEVEL)
            .map_err(StageError::failed)?;
        Ok(vec![Output::counted(FILE)])
    }
}

/// The strength from input `index`.
pub fn read(context: &Context, index: usize) -> Result<f64, StageError> {
    let checkpoint = context.checkpoint(index, FILE)?;
    checkpoint
        .scalar(STRENGTH)
        .ok_or_else(|| StageError::Input {
            index,
            file: context.inputs[index].folder.join(FILE),
            what: "it contains no strength".into(),
        })
}
