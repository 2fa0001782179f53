//! Where a picture is taken from.

use super::trace::V;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye, m.
    pub eye: V,
    /// Unit vectors to the right, up, and into the picture.
    pub frame: [V; 3],
    /// Half of the width of the picture at unit distance.
    pub aperture: f32,
    /// Width and height, pixels.
    pub size: [usize; 2],
}

/// Direction of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Angle about the vertical, rad.
    pub azimuth: f32,
    /// Angle above the horizon, rad.
    pub elevation: f32,
    /// Enlarges the picture.
    pub zoom: f32,
}

impl Default for View {
    fn default() -> View {
        View {
            azimuth: 28f32.to_radians(),
            elevation: 20f32.to_radians(),
            zoom: 1.0,
        }
    }
}

impl Camera {
    /// A camera that looks at `target` and sees a box of liquid as a whole.
    pub fn fitted(corners: [V; 2], target: V, view: &View, size: [usize; 2]) -> Camera {
        let (se, ce) = view.elevation.sin_cos();
        let (sa, ca) = view.azimuth.sin_cos();
        let frame = [
            V::new(ca, sa, 0.0),
            V::new(-sa * se, ca * se, ce),
            V::new(-sa * ce, ca * ce, -se),
        ];
        let aperture = 0.26;
        let upright = aperture * size[1] as f32 / size[0] as f32;
        // The smallest distance from which each corner is inside the picture.
        let mut distance = 0.0f32;
        for corner in 0..8 {
            let p = V::from([0, 1, 2].map(|a| corners[corner >> a & 1][a])) - target;
            let [x, y, depth] = frame.map(|axis| p.dot(&axis));
            distance = distance.max(x.abs() / aperture - depth);
            distance = distance.max(y.abs() / upright - depth);
        }
        Camera {
            eye: target - frame[2] * (1.04 * distance),
            frame,
            aperture: aperture / view.zoom,
            size,
        }
    }

    /// The ray through a point of the picture, in pixels from the upper left corner.
    pub fn ray(&self, at: [f32; 2]) -> (V, V) {
        let half = 0.5 * self.size[0] as f32;
        let x = (at[0] - half) / half * self.aperture;
        let y = (0.5 * self.size[1] as f32 - at[1]) / half * self.aperture;
        let along = self.frame[2] + self.frame[0] * x + self.frame[1] * y;
        (self.eye, along.normalize())
    }

    /// Metres that a pixel covers at a point.
    pub fn pixel(&self, at: &V) -> f32 {
        let depth = (at - self.eye).dot(&self.frame[2]);
        2.0 * self.aperture * depth / self.size[0] as f32
    }
}
