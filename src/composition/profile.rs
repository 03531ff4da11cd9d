//! The indenter's profile: the file it is in, what the face will ask of it, and what it looks like.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::pressed::{PressedEnd, pressed_end};
use super::{Outline, Stretch, course, map, surface};
use crate::error::{Error, Result};
use crate::expression::Expression;
use crate::input;
use crate::profile::{
    BLEND, Circle, Extruded, Formula, Harmonic, Parabola, Point, Profile, Repeated, Rms, Rough, Roughness, Sampled,
    Surface, Survey, Wedge,
    profilometer::{self, Layout, Measured},
};
use crate::scene::{self, Detrend, Extend, Indenter, Reading, Scene, Seam};
use crate::table::Unit;

/// A profile made ready, and what is known of it.
pub struct Shape {
    /// What the points of the contact see of it.
    pub surface: Rc<dyn Surface>,
    /// Along x: all of it in the plane, in space where it is lowest.
    pub profile: Rc<dyn Profile>,
    /// What decides how fine a mesh must be to see all of it.
    pub finest: Option<Finest>,
    /// What the scene does not say: "1024 points, ...".
    pub detail: Option<String>,
    /// What unit a file read as m looks like, in words.
    pub unit: Option<String>,
    /// What is doubtful of a file that repeats: see [`seam_doubt`].
    pub seam: Option<(&'static str, String)>,
    /// The profile over the face before it slides.
    pub survey: Survey,
    /// Where the indenter first presses on what cannot give way.
    pub pressed: Option<PressedEnd>,
}

/// The finest detail of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finest {
    /// Its shortest wave, m.
    Wavelength(f64),
    /// The mean distance of its sampling points, m.
    Spacing(f64),
}

/// What the file of a measured profile has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Elevations {
    /// Of points x, h of each, m; of a map what [`crate::heightmap::Heights::into_numbers`] gives; of a profile without a file
    /// nothing.
    pub numbers: Vec<f64>,
    /// What a reader of the scene cannot see of it.
    pub note: Option<String>,
}

/// What the profile of the scene in `file` needs of its own file, made h as the scene says.
///
/// # Errors
/// [`Error::File`] when it cannot be read, [`Error::Scene`] with its line when its content is wrong.
pub fn measured(scene: &Scene, file: &Path) -> Result<Elevations> {
    match &scene.indenter {
        Indenter::Sampled { file: name, reading, .. } => {
            let measured = points((name, reading), file)?;
            Ok(Elevations { note: Some(measured.note()), numbers: numbers(&measured) })
        }
        Indenter::Map { .. } => map::measured(scene, file),
        _ => Ok(Elevations::default()),
    }
}

fn points((name, reading): (&str, &Reading), file: &Path) -> Result<Measured> {
    let unit = |name: Option<&str>| name.and_then(Unit::parse);
    let layout = Layout { columns: reading.columns.clone(), units: [unit(reading.x_unit), unit(reading.z_unit)] };
    let mut measured = profilometer::read(&bytes(name, file)?, &layout)
        .map_err(|reason| Error::scene(file, "indenter.file", format!("{name:?}: {reason}")))?;
    if reading.invert {
        measured.invert();
    }
    match reading.detrend {
        Detrend::None => {}
        Detrend::Mean => measured.take_off_mean(),
        Detrend::Line | Detrend::Plane => measured.take_off_line(),
    }
    measured.shift(reading.offset);
    Ok(measured)
}

/// The numbers of [`measured`].
///
/// # Errors
/// Those of [`measured`].
pub fn elevations(scene: &Scene, file: &Path) -> Result<Vec<f64>> {
    Ok(measured(scene, file)?.numbers)
}

/// x, h of each point, m.
fn numbers(measured: &Measured) -> Vec<f64> {
    measured.points.iter().flat_map(|point| [point.x, point.height]).collect()
}

/// The content of the file `name` of elevations, beside the scene in `file`.
pub(super) fn bytes(name: &str, file: &Path) -> Result<Vec<u8>> {
    input::bytes(&beside(name, file)).map_err(|error| of_the_indenter(error, file))
}

/// The path of the file `name` of the scene in `file`.
pub(super) fn beside(name: &str, file: &Path) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(name)
}

/// An error of the indenter's file, which says whose it is.
pub(super) fn of_the_indenter(error: Error, file: &Path) -> Error {
    match error {
        Error::File { file: path, reason } => {
            Error::File { file: path, reason: format!("{reason}; it is indenter.file of {}", file.display()) }
        }
        other => other,
    }
}

/// The profile of the scene in `file` over the contact face of its body, with the [`elevations`] it needs. Under periodic sides
/// every profile repeats with the layer's period.
///
/// # Errors
/// [`Error::Scene`] when the profile is not known everywhere that the loading history takes the face, or presses on a
/// clamped end of it where no penetration is to be left.
pub fn shape(scene: &Scene, file: &Path, elevations: &[f64], outline: &Outline) -> Result<Shape> {
    let face = outline.face;
    if let Some(across) = outline.across
        && let Some(shape) = surface::shape((scene, file), elevations, [face, across], outline)?
    {
        return Ok(shape);
    }
    let repeat = |profile: Box<dyn Profile>, centre: f64| match face.periodic {
        true => Box::new(Repeated { profile, centre, period: face.width() }),
        false => profile,
    };
    let wrong = |key: &str, reason: String| Error::scene(file, format!("indenter.{key}"), reason);
    let (mut finest, mut detail, mut unit, mut seam) = (None, None, None, None);
    let profile: Box<dyn Profile> = match scene.indenter {
        Indenter::Harmonic { amplitude, wavelength } => {
            finest = Some(Finest::Wavelength(wavelength));
            Box::new(Harmonic { amplitude, wavelength })
        }
        Indenter::Parabola { radius, centre } => repeat(Box::new(Parabola { radius, centre }), centre),
        Indenter::Circle { radius, centre } => repeat(Box::new(Circle { radius, centre }), centre),
        Indenter::Wedge { slope, centre } => repeat(Box::new(Wedge { slope, centre }), centre),
        Indenter::Paraboloid { .. }
        | Indenter::Sphere { .. }
        | Indenter::Cone { .. }
        | Indenter::Waves { .. }
        | Indenter::Map { .. } => {
            return Err(wrong("profile", "is for scenes in space".to_owned()));
        }
        Indenter::Expression { ref formula } => {
            let expression = Expression::parse(formula, &["x"])
                .map_err(|fault| wrong("formula", format!("{formula:?}, {fault}")))?;
            let profile = Formula { expression };
            check_formula(&profile, scene, face).map_err(|reason| wrong("formula", format!("{formula:?} {reason}")))?;
            repeat(Box::new(profile), 0.5 * face.width())
        }
        Indenter::Sampled { .. } => {
            let points: Vec<Point> =
                elevations.chunks_exact(2).map(|pair| Point { x: pair[0], height: pair[1] }).collect();
            let (count, span) = (points.len(), points[points.len() - 1].x - points[0].x);
            let profile = sampled(points, (scene, file), face)?;
            finest = Some(Finest::Spacing(span / (count - 1) as f64));
            unit = looks_like(scene, span, face);
            seam = seam_doubt(scene, elevations);
            detail = Some(format!("{count} points over {span:?} m{}", repetition(&profile, scene)));
            Box::new(profile)
        }
        Indenter::Rough { hurst, rms, shortest, longest, period, seed } => {
            let roughness = Roughness { hurst, rms: rms.into(), shortest, longest, period, seed };
            let waves = waves(&roughness).map_err(|(key, reason)| wrong(key, reason))?;
            finest = Some(Finest::Wavelength(shortest));
            detail = Some(format!("{waves} waves, repeating after {period:?} m"));
            Box::new(Rough::new(roughness))
        }
    };
    let survey = survey(&*profile, face).map_err(|error| wrong("profile", error.to_string()))?;
    let profile: Rc<dyn Profile> = Rc::from(profile);
    let surface = Rc::new(Extruded(profile.clone()));
    let pressed = pressed_end(&*surface, (scene, file), outline)?;
    Ok(Shape { surface, profile, finest, detail, unit, seam, survey, pressed })
}

/// Points on every cell of the face for what is checked or measured by sampling, and the most of them.
const POINTS_PER_CELL: usize = 8;
const MOST_POINTS: usize = 200_000;

pub(super) fn survey(profile: &dyn Profile, face: Stretch) -> Result<Survey> {
    let pieces = (POINTS_PER_CELL * face.edges).clamp(512, MOST_POINTS);
    Survey::new(profile, [face.from, face.to], pieces)
}

/// The stretch of the profile, m, that the face meets over the whole history; under periodic sides one period is all
/// there is.
pub fn reach(scene: &Scene, face: Stretch) -> [f64; 2] {
    reach_along(0, scene, face)
}

/// As [`reach`], along an axis.
pub(super) fn reach_along(axis: usize, scene: &Scene, face: Stretch) -> [f64; 2] {
    if face.periodic {
        return [face.from, face.to];
    }
    let ranges = course(scene).into_iter().map(|phase| phase.sliding_range(axis));
    let [least, greatest] = ranges.fold([0.0_f64; 2], |[a, b], [c, d]| [a.min(c), b.max(d)]);
    [face.from - greatest, face.to - least]
}

/// A formula is finite wherever the face meets it, as far as sampling can tell, and has no jump where it repeats.
fn check_formula(profile: &Formula, scene: &Scene, face: Stretch) -> std::result::Result<(), String> {
    let [from, to] = reach(scene, face);
    let pieces = ((to - from) / face.width() * (POINTS_PER_CELL * face.edges) as f64) as usize;
    let survey = Survey::new(profile, [from, to], pieces.clamp(512, MOST_POINTS)).map_err(|error| error.to_string())?;
    let heights = [survey.points[0].height, survey.points[survey.points.len() - 1].height];
    let [low, high] = survey.range();
    if face.periodic && (heights[1] - heights[0]).abs() > 1e-6 * (high - low) {
        return Err(format!(
            "must be the same at both sides of a periodic layer, got {:e} m at x = 0 and {:e} m at x = {:?} m",
            heights[0],
            heights[1],
            face.width()
        ));
    }
    Ok(())
}

/// After what a sampled profile repeats, how its ends meet, and the periodic layers that it fits on.
fn repetition(profile: &Sampled, scene: &Scene) -> String {
    let Some(period) = profile.period() else { return String::new() };
    let blended = match &scene.indenter {
        Indenter::Sampled { reading: Reading { seam: Seam::Blend, .. }, .. } => {
            format!(", its ends blended over {:.3e} m each", BLEND * period)
        }
        _ => String::new(),
    };
    format!(", repeating after {period:?} m{blended}; periodic layers: {period:?} m wide, or a multiple")
}

/// What is doubtful of a repeating sampled profile, as the key and the reason: a wall where its ends meet.
pub fn seam_doubt(scene: &Scene, elevations: &[f64]) -> Option<(&'static str, String)> {
    let Indenter::Sampled { extend: Extend::Periodic, reading, period, .. } = &scene.indenter else { return None };
    let points: Vec<Point> = elevations.chunks_exact(2).map(|pair| Point { x: pair[0], height: pair[1] }).collect();
    let wall = Sampled::wall(&points).filter(|_| reading.seam == Seam::None)?;
    let length = BLEND * period.or_else(|| Sampled::natural_period(&points))?;
    Some((
        "indenter.seam",
        format!(
            "where the profile repeats its ends are {wall:.3e} m apart in elevation: a wall that no point beside it has; \
             seam = \"blend\" closes it over {length:.3e} m at each end, detrend = \"line\" takes off a tilt"
        ),
    ))
}

/// The unit that a file read as m looks like: one in which `span` is some `face` widths, not thousands of them.
pub(super) fn looks_like(scene: &Scene, span: f64, face: Stretch) -> Option<String> {
    let (Indenter::Sampled { reading: Reading { x_unit: None, .. }, .. }
    | Indenter::Map { reading: Reading { x_unit: None, .. }, spacing: None, .. }) = &scene.indenter
    else {
        return None;
    };
    let ratio = span / face.width();
    let unit = ["mm", "um", "nm"].into_iter().filter_map(Unit::parse).find(|unit| unit.to_si(ratio) <= 100.0)?;
    let name = unit.name;
    (ratio > 1e3).then(|| {
        format!(
            "the file looks like {name} read as m: it is {span:?} m long, {ratio:.0e} times the face; say unit = \"{name}\" \
             (or x_unit and z_unit)"
        )
    })
}

/// The profile through the points of a file, repeating as the scene says.
fn sampled(mut points: Vec<Point>, (scene, file): (&Scene, &Path), face: Stretch) -> Result<Sampled> {
    let wrong = |key: &str, reason: String| Error::scene(file, key, reason);
    let Indenter::Sampled { extend: Extend::Periodic, period, ref reading, .. } = scene.indenter else {
        return bounded(points, scene, face).map_err(|reason| wrong("indenter.file", reason));
    };
    let blend = reading.seam == Seam::Blend;
    let period = sampled_period(&points, period, blend).map_err(|reason| wrong("indenter.period", reason))?;
    if face.periodic {
        let hint = looks_like(scene, period, face).map_or_else(String::new, |hint| format!("; {hint}"));
        scene::whole_periods(face.width(), "periods of the profile", period)
            .map_err(|reason| wrong("layer.width", format!("{reason}; or give indenter.period{hint}")))?;
    }
    if blend {
        Sampled::blend(&mut points, period);
    }
    Ok(Sampled::new(points, Some(period)))
}

/// The period of a repeating sampled profile: what the scene says, or what the points say by themselves.
fn sampled_period(points: &[Point], said: Option<f64>, blend: bool) -> std::result::Result<f64, String> {
    let (first, last) = (points[0], points[points.len() - 1]);
    let span = last.x - first.x;
    let Some(period) = said else {
        return Sampled::natural_period(points).ok_or_else(|| {
            "missing, and required where the file's spacing is not uniform and its last elevation is not \
                          its first: give the distance in m after which the profile repeats"
                .to_owned()
        });
    };
    if period < span * (1.0 - 1e-12) {
        return Err(format!("must be at least the length of the file ({span:?} m), got {period:?}"));
    }
    if period <= span * (1.0 + 1e-12) && first.height != last.height && !blend {
        return Err(format!(
            "is the length of the file, whose ends must then have the same elevation, got {:?} and {:?} m; or say seam = \
             \"blend\"",
            first.height, last.height
        ));
    }
    Ok(period)
}

/// The bounded profile through `points`, which covers what the face meets.
fn bounded(points: Vec<Point>, scene: &Scene, face: Stretch) -> std::result::Result<Sampled, String> {
    let (first, last) = (points[0].x, points[points.len() - 1].x);
    let [from, to] = reach(scene, face);
    let profile = Sampled::new(points, None);
    if profile.at(from).is_ok() && profile.at(to).is_ok() {
        return Ok(profile);
    }
    let wide = looks_like(scene, last - first, face).map_or_else(String::new, |hint| format!("{hint}; "));
    Err(format!(
        "{wide}its x must cover {from:?} to {to:?} m (a face of {:?} m, and the sliding of all phases), got {first:?} to \
         {last:?} m; give a longer profile, slide less, or say extend = \"periodic\"",
        face.width()
    ))
}

impl From<scene::Rms> for Rms {
    fn from(rms: scene::Rms) -> Self {
        match rms {
            scene::Rms::RmsSlope(slope) => Self::Slope(slope),
            scene::Rms::RmsHeight(height) => Self::Height(height),
        }
    }
}

/// A rough profile has waves, and not too many to be added up; how many.
fn waves(roughness: &Roughness) -> std::result::Result<usize, (&'static str, String)> {
    const MOST: usize = 10_000;
    let numbers = roughness.waves();
    let Roughness { shortest, longest, period, .. } = *roughness;
    if numbers.is_empty() {
        let reason = format!(
            "must have a wave of a whole fraction of it between shortest ({shortest:?} m) and longest ({longest:?} m), got {period:?}"
        );
        return Err(("period", reason));
    }
    if *numbers.end() > MOST {
        let reason = format!("makes {} waves in a period of {period:?} m; at most {MOST} are added up", numbers.end());
        return Err(("shortest", reason));
    }
    Ok(numbers.count())
}
