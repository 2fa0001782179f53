//! Arguments of the commands that write files for other programs: `export` and `render`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{StoreArguments, parse};

#[derive(Debug, Args)]
pub struct ExportArguments {
    /// A name in `latest/`, a log, a checkpoint, or the folder of a run; the run may be under way
    #[arg(value_name = "RUN")]
    pub path: PathBuf,
    /// Format
    #[arg(long, value_name = "FORMAT")]
    pub to: Format,
    /// Folder for the files; those of an earlier export there are removed, whatever their format
    #[arg(long, value_name = "DIR", default_value = "export")]
    pub output: PathBuf,
    /// Only the frame nearest to this time from the start, as "10 ms"; repeatable, or several
    /// with commas. The times that were found are printed
    #[arg(long, value_name = "TIME", value_parser = parse::time, value_delimiter = ',',
          allow_hyphen_values = true,
          conflicts_with = "every")]
    pub at: Vec<f64>,
    /// Only the frames nearest to the multiples of this time
    #[arg(long, value_name = "TIME", value_parser = parse::step, allow_hyphen_values = true)]
    pub every: Option<f64>,
    /// Only the particles of this body; repeatable
    #[arg(long, value_name = "NAME")]
    pub body: Vec<String>,
    /// Of a scene with an axis: each ring as points about it that share its mass, a spacing apart,
    /// at most N
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true,
          default_missing_value = "64", value_parser = parse::points)]
    pub revolve: Option<usize>,
    #[command(flatten)]
    pub store: StoreArguments,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Format {
    /// ParaView: `.vtp` files and a `.pvd` time index
    Vtk,
    /// Tables
    Csv,
    /// Point clouds
    Ply,
    /// NumPy: an archive of arrays for each frame
    Npz,
}

#[derive(Debug, Args)]
pub struct RenderArguments {
    /// A name in `latest/`, a log, or the folder of a result; the run may be under way
    pub run: String,
    /// The new file; its ending is the format: .png, .gif, .mp4, .ply, .obj, .glb, .vtp
    #[arg(long, short, value_name = "FILE", default_value = "render.png")]
    pub output: PathBuf,
    /// The frame nearest to this time from the start [default: all in a film, else the last]
    #[arg(long, value_name = "TIME", value_parser = parse::time, allow_hyphen_values = true,
          conflicts_with_all = ["from", "until", "every"])]
    pub at: Option<f64>,
    /// First time of a film or of a series of numbered files
    #[arg(long, value_name = "TIME", value_parser = parse::time, allow_hyphen_values = true)]
    pub from: Option<f64>,
    /// Last time
    #[arg(long, value_name = "TIME", value_parser = parse::time, allow_hyphen_values = true)]
    pub until: Option<f64>,
    /// Least time between two frames
    #[arg(long, value_name = "TIME", value_parser = parse::step, allow_hyphen_values = true)]
    pub every: Option<f64>,
    /// Pictures a second of a film
    #[arg(long, value_name = "N", default_value_t = 25.0, value_parser = parse::rate)]
    pub rate: f64,
    /// Pixels of a picture
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    pub size: [usize; 2],
    /// What the liquid is, or what its colour shows
    #[arg(long, value_enum, default_value_t)]
    pub material: Material,
    /// Colour behind the liquid and of the floor
    #[arg(long, value_name = "#RRGGBB", default_value = "#e2e6ec", value_parser = parse::colour)]
    pub background: [u8; 3],
    /// Direction of the camera about the vertical
    #[arg(long, value_name = "ANGLE", default_value = "28 deg", value_parser = parse::angle,
          allow_hyphen_values = true)]
    pub azimuth: f64,
    /// Direction of the camera above the horizon
    #[arg(long, value_name = "ANGLE", default_value = "20 deg", value_parser = parse::angle,
          allow_hyphen_values = true)]
    pub elevation: f64,
    /// Enlarges what is in the middle of the picture
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = parse::zoom,
          allow_hyphen_values = true)]
    pub zoom: f64,
    /// Point in the middle of the picture, as "20 mm, 20 mm, 10 mm" [default: of the liquid]
    #[arg(long, value_name = "X, Y, Z", value_parser = parse::point,
          allow_hyphen_values = true)]
    pub target: Option<[f64; 3]>,
    /// Rays a pixel along each side: 1 for a draft, 4 for print
    #[arg(long, value_name = "N", default_value_t = 2,
          value_parser = clap::value_parser!(u8).range(1..=16))]
    pub samples: u8,
    /// No light and shadow on the floor
    #[arg(long)]
    pub no_shadows: bool,
    /// Show a bar of a round length
    #[arg(long)]
    pub scale_bar: bool,
    /// Show the time, from the contact of the drop
    #[arg(long)]
    pub clock: bool,
    /// A text below the liquid
    #[arg(long, value_name = "TEXT")]
    pub caption: Option<String>,
    /// Threads; pictures do not depend on their number [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub store: StoreArguments,
}

/// What the liquid looks like.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum Material {
    /// Clear and a little blue
    #[default]
    Water,
    /// White
    Milk,
    /// The colours of the bodies
    Body,
    /// Coloured by speed
    Speed,
    /// Coloured by pressure
    Pressure,
}
