//! `pack`: the shape of a body -> its particles, about the body's own origin.

use coronet::particle;
use coronet::pipeline::{Context, Output, Setting, Stage, StageError};
use coronet::record::{Checkpoint, checkpoint};
use coronet::scene::file::Loaded;

use crate::BODY;

pub struct Pack<'a> {
    pub loaded: &'a Loaded,
    /// Place in the scene.
    pub body: usize,
    pub settings: Vec<Setting>,
    /// VERSION, see [`crate::jobs::version`].
    pub version: u32,
}

impl Stage for Pack<'_> {
    fn name(&self) -> &str {
        "pack"
    }

    fn part(&self) -> &str {
        &self.loaded.scene.bodies[self.body].name
    }

    fn version(&self) -> u32 {
        self.version
    }

    fn settings(&self) -> Vec<Setting> {
        self.settings.clone()
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        let scene = &self.loaded.scene;
        let region = particle::shape::Region::new(scene, self.body);
        let position = particle::lattice::fill(&region, scene.pack.spacing);
        let n = position[0].len();
        let mut body = particle::Particles {
            id: (0..n as u32).collect(),
            body: vec![0; n],
            velocity: std::array::from_fn(|_| vec![0.0; n]),
            density: vec![scene.density; n],
            mass: 1.0,
            position,
        };
        let report = n;
        // Which place a scene gives to a body is no part of the body.
        body.body.fill(0);
        let path = context.output().join(BODY);
        Checkpoint::from(body)
            .write(&path, checkpoint::LEVEL)
            .map_err(StageError::failed)?;
        context.note(report.to_string());
        Ok(vec![Output::counted(BODY)])
    }
}
