//! `coronet render`: pictures, films and meshes of the liquid surface.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use coronet::draw::film::{self, Film};
use coronet::draw::render::Material;
use coronet::draw::render::artist::{Artist, Style, Survey};
use coronet::draw::render::camera::View;
use coronet::particle::Frame;
use coronet::record::{atomic, mark, mesh};
use coronet::scene::{Dimension, Scene};
use serde_json::json;

use super::footage::Footage;
use super::place::keep_results;
use crate::arguments::{self, RenderArguments};
use crate::fault::Usage;
use crate::print::{note, out, shown};

pub const EXAMPLES: &str = "\
Examples:
  coronet render pipeline --at \"10 ms\"
  coronet render pipeline --output splash.mp4 --clock
  coronet render pipeline --output splash.gif --size 480x270 --until \"20 ms\"
  coronet render pipeline --output frames/a.png --every \"2 ms\" --material milk
  coronet render pipeline --at \"10 ms\" --output crater.glb

The frames are those of the log: `frames.interval` of the scene decides which there are.";

/// Options that only a film heeds, and those that a mesh does not.
const OF_FILMS: [&str; 1] = ["rate"];
const OF_PICTURES: [&str; 11] = [
    "size",
    "background",
    "azimuth",
    "elevation",
    "zoom",
    "target",
    "samples",
    "no_shadows",
    "scale_bar",
    "clock",
    "caption",
];

/// Time between two lines about the progress.
const BETWEEN: Duration = Duration::from_secs(10);

/// What a file ending means.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Picture,
    Film(film::Format),
    Mesh(mesh::Format),
}

/// An error if an option was `given`, by its name, that changes nothing in the file.
pub fn check(arguments: &RenderArguments, given: impl Fn(&str) -> bool) -> Result<()> {
    let format = format(&arguments.output)?;
    let is_idle = |name: &str| match format {
        Format::Picture => OF_FILMS.contains(&name),
        Format::Film(_) => false,
        Format::Mesh(_) => true,
    };
    let mut all = OF_FILMS.iter().chain(&OF_PICTURES);
    match all.find(|name| is_idle(name) && given(name)) {
        Some(name) => {
            let (option, file) = (name.replace('_', "-"), shown(&arguments.output));
            let text = format!("--{option} changes nothing in {file}; leave it out");
            Err(Usage(text).into())
        }
        None => Ok(()),
    }
}

pub fn render(arguments: &RenderArguments) -> Result<()> {
    let format = format(&arguments.output)?;
    if let Format::Film(film::Format::Mp4) = format
        && arguments.size.iter().any(|length| length % 2 == 1)
    {
        bail!(Usage(
            "an MP4 film needs an even width and height; change --size".into()
        ));
    }
    keep_results(&arguments.output, &arguments.store.artifacts)?;
    let threads = arguments.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().context("cannot start the threads")?;
    pool.install(|| {
        let footage = Footage::find(arguments)?;
        let scene = footage.scene()?;
        let is_flat = scene.solid().dimension == Dimension::Two;
        if is_flat && matches!(format, Format::Mesh(_)) {
            let text = "a scene in two dimensions has no surface of triangles; render a picture";
            bail!(Usage(text.into()));
        }
        let is_one = !matches!(format, Format::Film(_)) && !is_series(arguments);
        let made = if arguments.at.is_some() || is_one {
            one(arguments, &footage, &scene, format)?
        } else {
            many(arguments, &footage, &scene, format)?
        };
        print(arguments, &made);
        Ok(())
    })
}

/// An error if a file that would be replaced or removed is not of this program.
fn keep_others(paths: impl IntoIterator<Item = PathBuf>) -> Result<()> {
    for path in paths {
        if !mark::may_replace(&path)? {
            let text = format!(
                "{} is not of this program and stays as it is; give another --output",
                path.display()
            );
            bail!(Usage(text));
        }
    }
    Ok(())
}

fn is_series(arguments: &RenderArguments) -> bool {
    arguments.from.is_some() || arguments.until.is_some() || arguments.every.is_some()
}

fn format(path: &Path) -> Result<Format> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_lowercase();
    let format = match extension.as_str() {
        "png" => Some(Format::Picture),
        "gif" => Some(Format::Film(film::Format::Gif)),
        "mp4" => Some(Format::Film(film::Format::Mp4)),
        other => mesh::Format::of(other).map(Format::Mesh),
    };
    format.ok_or_else(|| {
        let endings = ".png, .gif, .mp4, .ply, .obj, .glb or .vtp";
        let text = format!(
            "{} has no known format; end it in {endings}",
            path.display()
        );
        Usage(text).into()
    })
}

fn style(arguments: &RenderArguments) -> Style {
    Style {
        material: match arguments.material {
            arguments::Material::Water => Material::Water,
            arguments::Material::Milk => Material::Milk,
            arguments::Material::Body => Material::Body,
            arguments::Material::Speed => Material::Speed,
            arguments::Material::Pressure => Material::Pressure,
        },
        size: arguments.size,
        view: View {
            azimuth: arguments.azimuth.to_radians() as f32,
            elevation: arguments.elevation.to_radians() as f32,
            zoom: arguments.zoom as f32,
        },
        target: arguments.target,
        background: arguments.background,
        has_shadows: !arguments.no_shadows,
        has_scale: arguments.scale_bar,
        has_clock: arguments.clock,
        caption: arguments.caption.clone(),
        samples: usize::from(arguments.samples),
    }
}

/// The new files, and the times of their frames, s.
#[derive(Default)]
struct Made {
    files: Vec<PathBuf>,
    times: Vec<f64>,
}

fn new_film(kind: film::Format, arguments: &RenderArguments) -> Result<Film> {
    let path = &arguments.output;
    let film = Film::new(kind, path, arguments.size, arguments.rate);
    film.with_context(|| format!("cannot make {}", shown(path)))
}

/// A file of one frame.
fn one(
    arguments: &RenderArguments,
    footage: &Footage,
    scene: &Scene,
    format: Format,
) -> Result<Made> {
    let frame = footage.one(arguments.at, scene)?;
    let mut survey = Survey::default();
    survey.add(scene, &frame);
    let artist = Artist::new(scene, &survey, style(arguments));
    let path = &arguments.output;
    keep_others([path.clone()])?;
    path.parent().map_or(Ok(()), atomic::create_folder)?;
    match format {
        Format::Film(kind) => {
            let mut film = new_film(kind, arguments)?;
            film.add(&artist.picture(&frame))?;
            film.finish()?;
        }
        _ => still(&artist, &frame, format, path)?,
    }
    Ok(Made {
        files: vec![path.clone()],
        times: vec![frame.time],
    })
}

fn still(artist: &Artist, frame: &Frame, format: Format, path: &Path) -> Result<()> {
    if let Format::Mesh(format) = format {
        let mesh = artist.mesh(frame).context("no surface in two dimensions")?;
        return Ok(mesh.write(format, path)?);
    }
    Ok(atomic::write_file(path, &artist.picture(frame).png()?)?)
}

/// A film, or numbered files.
fn many(
    arguments: &RenderArguments,
    footage: &Footage,
    scene: &Scene,
    format: Format,
) -> Result<Made> {
    let mut survey = Survey::default();
    let mut count = 0;
    for frame in footage.chosen()? {
        survey.add(scene, &frame?);
        count += 1;
    }
    if count == 0 {
        bail!(footage.none_chosen()?);
    }
    let artist = Artist::new(scene, &survey, style(arguments));
    let path = &arguments.output;
    if let Format::Film(_) = format {
        keep_others([path.clone()])?;
    } else {
        // What is written, and what `clear` removes.
        let rest = (count..).map(|number| numbered(path, number));
        let rest = rest.take_while(|path| path.exists());
        keep_others((0..count).map(|number| numbered(path, number)).chain(rest))?;
    }
    path.parent().map_or(Ok(()), atomic::create_folder)?;
    let mut film = match format {
        Format::Film(kind) => Some(new_film(kind, arguments)?),
        _ => None,
    };
    let mut made = Made::default();
    let mut told = Instant::now();
    // A run under way may have gone on since.
    for frame in footage.chosen()?.take(count) {
        let frame = frame?;
        if told.elapsed() >= BETWEEN {
            told = Instant::now();
            note!(
                "frame {} of {count}, {:.2} ms",
                made.times.len() + 1,
                1e3 * frame.time
            );
        }
        match &mut film {
            Some(film) => film.add(&artist.picture(&frame))?,
            None => {
                let path = numbered(path, made.files.len());
                still(&artist, &frame, format, &path)?;
                made.files.push(path);
            }
        }
        made.times.push(frame.time);
    }
    match film {
        Some(film) => {
            film.finish()?;
            made.files.push(path.clone());
        }
        None => clear(path, made.files.len())?,
    }
    Ok(made)
}

/// `a-00007.png` of `a.png`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{number:05}.{extension}"))
}

/// Removes what is left of a longer series of this name behind the first `count` files.
fn clear(path: &Path, count: usize) -> Result<()> {
    for number in count.. {
        match fs::remove_file(numbered(path, number)) {
            Ok(()) => {}
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => break,
            Err(error) => {
                let path = numbered(path, number);
                return Err(error).with_context(|| format!("cannot remove {}", path.display()));
            }
        }
    }
    Ok(())
}

fn print(arguments: &RenderArguments, made: &Made) {
    if arguments.store.json {
        let files: Vec<_> = made.files.iter().map(|file| shown(file)).collect();
        out!("{}", json!({"files": files, "times_s": made.times}));
        return;
    }
    let Some(first) = made.files.first() else {
        return;
    };
    let (start, end) = (made.times.first(), made.times.last());
    let [start, end] = [start, end].map(|time| 1e3 * time.copied().unwrap_or_default());
    let more = match made.files.len() {
        1 => String::new(),
        count => format!(" and {} more", count - 1),
    };
    match made.times.len() {
        1 => out!("{}{more}: t = {start:.3} ms", shown(first)),
        count => out!(
            "{}{more}: {count} frames, t = {start:.3} to {end:.3} ms",
            shown(first)
        ),
    }
}
