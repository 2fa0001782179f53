//! `coronet._core`: what the Python package takes from the engine. Users import `coronet`.

use std::path::{Path, PathBuf};

use coronet::measure::answer::{Answer, Figures};
use coronet::measure::kind::contact_time;
use coronet::measure::series::{Row, Series};
use coronet::particle;
use coronet::record::checkpoint::{self, Array};
use coronet::record::log;
use coronet::scene::{Scene, file};
use coronet::simulate::{self, Simulation};
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

create_exception!(
    coronet,
    CoronetError,
    PyValueError,
    "A scene, a result or a simulation that is wrong; the message tells what, and what to do."
);

fn wrong(error: impl std::fmt::Display) -> PyErr {
    CoronetError::new_err(error.to_string())
}

fn log_error(error: log::LogError) -> PyErr {
    match error {
        log::LogError::Io(error) => PyOSError::new_err(error.to_string()),
        other => wrong(other),
    }
}

/// Three columns as the rows of one array of shape (n, 3).
fn rows<'py>(py: Python<'py>, [x, y, z]: &[Vec<f32>; 3]) -> Bound<'py, PyArray2<f32>> {
    let all = x.iter().zip(y).zip(z);
    let flat: Vec<f32> = all.flat_map(|((x, y), z)| [*x, *y, *z]).collect();
    let array = numpy::ndarray::Array2::from_shape_vec((x.len(), 3), flat);
    array.expect("three values a row").into_pyarray(py)
}

/// One frame of the liquid, SI units; particles sorted by `id`.
#[pyclass(frozen, module = "coronet")]
struct Frame(particle::Frame);

#[pymethods]
impl Frame {
    /// Simulated time, s.
    #[getter]
    fn time(&self) -> f64 {
        self.0.time
    }

    /// Scalars of the frame by name, each with its unit: `kinetic_energy_J`, `mass_kg` ...
    #[getter]
    fn scalars(&self) -> std::collections::BTreeMap<String, f64> {
        self.0.scalars.iter().cloned().collect()
    }

    /// Identities, shape (n,): those of the same particle are equal in all frames.
    #[getter]
    fn id<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_slice(py, &self.0.id)
    }

    /// Indices of bodies in the order of the scene, shape (n,).
    #[getter]
    fn body<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.0.body)
    }

    /// Positions, m, shape (n, 3); z is up.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        rows(py, &self.0.position)
    }

    /// Velocities, m/s, shape (n, 3).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        rows(py, &self.0.velocity)
    }

    /// Pressures, Pa, shape (n,).
    #[getter]
    fn pressure<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.0.pressure)
    }

    /// Densities, kg/m^3, shape (n,).
    #[getter]
    fn density<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.0.density)
    }

    /// Whether particles are at the free surface, shape (n,).
    #[getter]
    fn is_surface<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let all: Vec<bool> = self.0.surface.iter().map(|s| *s != 0).collect();
        all.into_pyarray(py)
    }

    /// Masses of rings, kg, shape (n,); None where all particles have `particle_mass`.
    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f32>>> {
        let is_own = !self.0.mass.is_empty();
        is_own.then(|| PyArray1::from_slice(py, &self.0.mass))
    }

    /// Mass of each particle, kg; None of rings, which have a `mass` each.
    #[getter]
    fn particle_mass(&self) -> Option<f64> {
        if !self.0.mass.is_empty() {
            return None;
        }
        let mut scalars = self.0.scalars.iter();
        let (_, mass) = scalars.find(|(name, _)| name == "mass_kg")?;
        Some(mass / self.0.id.len() as f64)
    }

    fn __len__(&self) -> usize {
        self.0.id.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<Frame at {:.6} s, {} particles>",
            self.0.time,
            self.0.id.len()
        )
    }
}

/// Frames of a log, one after the other.
#[pyclass(module = "coronet")]
struct Frames(std::sync::Mutex<log::Frames>);

#[pymethods]
impl Frames {
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let frames = log::read_frames(&path).map_err(log_error)?;
        Ok(Frames(std::sync::Mutex::new(frames)))
    }

    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        let next = py.detach(|| self.0.lock().expect("not poisoned").next());
        next.transpose().map_err(log_error).map(|f| f.map(Frame))
    }
}

/// Facts of a log: bodies, spacing in m, dimension, text of the scene, provenance.
#[pyfunction]
fn log_info(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let info = log::info(&path).map_err(log_error)?;
    let bodies: Vec<String> = info.bodies.into_iter().map(|body| body.name).collect();
    let facts = PyDict::new(py);
    facts.set_item("bodies", bodies)?;
    facts.set_item("spacing", info.spacing)?;
    facts.set_item("dimension", info.dimension.count())?;
    facts.set_item("scene", info.scene_text)?;
    facts.set_item("provenance", info.provenance)?;
    Ok(facts)
}

/// A checkpoint: kind, time in s, step, scalars, texts, and arrays by name.
#[pyfunction]
fn read_checkpoint(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = py.detach(|| checkpoint::read(&path)).map_err(|error| {
        if error.is_damage() {
            wrong(error)
        } else {
            PyOSError::new_err(error.to_string())
        }
    })?;
    let arrays = PyDict::new(py);
    for (name, array) in read.arrays {
        match array {
            Array::F64(values) => arrays.set_item(name, values.into_pyarray(py))?,
            Array::F32(values) => arrays.set_item(name, values.into_pyarray(py))?,
            Array::U64(values) => arrays.set_item(name, values.into_pyarray(py))?,
            Array::U32(values) => arrays.set_item(name, values.into_pyarray(py))?,
            Array::U8(values) => arrays.set_item(name, values.into_pyarray(py))?,
        }
    }
    let found = PyDict::new(py);
    found.set_item("kind", read.kind)?;
    found.set_item("time", read.time)?;
    found.set_item("step", read.step)?;
    found.set_item(
        "scalars",
        PyDict::from_sequence(&read.scalars.into_pyobject(py)?)?,
    )?;
    found.set_item(
        "texts",
        PyDict::from_sequence(&read.texts.into_pyobject(py)?)?,
    )?;
    found.set_item("arrays", arrays)?;
    Ok(found)
}

/// Name, value, unit, and times in s from the start and from contact, of what a run is about.
type Figure = (String, f64, String, Option<f64>, Option<f64>);

fn figures_of(figures: &Figures) -> Vec<Figure> {
    let figure = |answer: &Answer| {
        let (name, unit) = (answer.name.to_string(), answer.quantity.si().to_string());
        let after = figures.after_contact(answer);
        (name, answer.value, unit, answer.time, after)
    };
    figures.answers.iter().map(figure).collect()
}

/// The scene of a log.
fn scene_of(log: &Path) -> PyResult<Scene> {
    log::info(log).map_err(log_error)?.scene(log).map_err(wrong)
}

/// Figures of a run: of the scene in its log, from its table of measures.
#[pyfunction]
fn figures(log: PathBuf, measures: PathBuf) -> PyResult<Vec<Figure>> {
    let measures = Series::read(&measures).map_err(wrong)?;
    Ok(figures_of(&Figures::new(&scene_of(&log)?, measures)))
}

/// Time at which the falling drop meets pool or wall, s from the start; 0 if it never does.
#[pyfunction]
fn contact(log: PathBuf) -> PyResult<f64> {
    Ok(contact_time(&scene_of(&log)?.whole()))
}

/// Columns of measures by name, and figures.
type Simulated = (Vec<(String, Vec<f64>)>, Vec<Figure>);

/// Simulates the scene of a file or of a text; `each` gets every frame and its measures, and stops
/// the simulation by returning False.
#[pyfunction]
#[pyo3(signature = (path, text, sets, each))]
fn simulate_scene(
    py: Python<'_>,
    path: Option<PathBuf>,
    text: Option<String>,
    sets: Vec<String>,
    each: Option<Py<PyAny>>,
) -> PyResult<Simulated> {
    let scene = match (&path, &text) {
        (Some(path), _) => file::load(path, &sets).map_err(wrong)?.scene,
        (None, text) => {
            let text = text.as_deref().unwrap_or_default();
            let name = Path::new("scene");
            file::read(text, name, &sets).map_err(wrong)?.scene
        }
    };
    let mut fault = None;
    let ended = py.detach(|| -> Result<Series, simulate::Error> {
        let mut simulation = Simulation::new(&scene)?;
        let measures = simulation.run_while(|frame, row| {
            Python::attach(|py| match tell(py, each.as_ref(), frame, row) {
                Ok(goes_on) => goes_on,
                Err(error) => {
                    fault = Some(error);
                    false
                }
            })
        })?;
        Ok(measures.clone())
    });
    if let Some(fault) = fault {
        return Err(fault);
    }
    let found = Figures::new(&scene, ended.map_err(wrong)?);
    let figures = figures_of(&found);
    let Series { names, columns } = found.measures;
    Ok((names.into_iter().zip(columns).collect(), figures))
}

/// Calls `each`; whether the simulation goes on.
fn tell(
    py: Python<'_>,
    each: Option<&Py<PyAny>>,
    frame: &particle::Frame,
    row: &Row,
) -> PyResult<bool> {
    // Ctrl-C raises KeyboardInterrupt here.
    py.check_signals()?;
    let Some(each) = each else {
        return Ok(true);
    };
    let measures = PyDict::new(py);
    for (name, value) in row {
        measures.set_item(name, value)?;
    }
    let answer = each.call1(py, (Frame(frame.clone()), measures))?;
    Ok(answer.is_none(py) || answer.is_truthy(py)?)
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("CoronetError", module.py().get_type::<CoronetError>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Frame>()?;
    module.add_class::<Frames>()?;
    module.add_function(wrap_pyfunction!(log_info, module)?)?;
    module.add_function(wrap_pyfunction!(read_checkpoint, module)?)?;
    module.add_function(wrap_pyfunction!(figures, module)?)?;
    module.add_function(wrap_pyfunction!(contact, module)?)?;
    module.add_function(wrap_pyfunction!(simulate_scene, module)?)?;
    Ok(())
}
