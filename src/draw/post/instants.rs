//! Instants at which a scene asks for pictures.

/// Instants still to come, s, the earliest last.
pub(super) struct Instants {
    pub(super) left: Vec<f64>,
    half: f64,
}

impl Instants {
    pub(super) fn new(wanted: &[f64], interval: f64) -> Instants {
        let mut left = wanted.to_vec();
        left.sort_by(|a, b| b.total_cmp(a));
        Instants {
            left,
            half: 0.5 * interval,
        }
    }

    /// Whether the frame at `time` is the nearest to an instant; each frame serves once.
    pub(super) fn take(&mut self, time: f64) -> bool {
        let before = self.left.len();
        while self.left.last().is_some_and(|t| *t <= time + self.half) {
            self.left.pop();
        }
        self.left.len() < before
    }
}
