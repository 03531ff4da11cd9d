//! The indenter's profile in space.

use std::f64::consts::PI;
use std::path::Path;
use std::rc::Rc;

use nalgebra::Vector2;

use super::pressed::pressed_end;
use super::profile::{Finest, Shape, reach_along, survey};
use super::{Outline, Stretch, map};
use crate::error::{Error, Result};
use crate::expression::Expression;
use crate::profile::{
    Cone, Paraboloid, Profile, RepeatedSurface, RoughSurface, Roughness, Section, Sphere, Surface, SurfaceFormula,
    Waves,
};
use crate::scene::{Indenter, Scene};

/// The profile of the scene in `file` over a face of two directions; none where it is the same for every y. Along periodic sides
/// every profile repeats with the layer's period.
///
/// # Errors
/// [`Error::Scene`] where a formula is none, or not finite over the face, or has a jump where it repeats.
pub(super) fn shape(
    (scene, file): (&Scene, &Path),
    elevations: &[f64],
    face: [Stretch; 2],
    outline: &Outline,
) -> Result<Option<Shape>> {
    let periods = face.map(|along| along.periodic.then_some(along.width()));
    let middle = Vector2::from(face.map(|along| 0.5 * (along.from + along.to)));
    let wrong = |key: &str, reason: String| Error::scene(file, format!("indenter.{key}"), reason);
    let repeated = |surface: Box<dyn Surface>, centre| -> Rc<dyn Surface> {
        Rc::new(RepeatedSurface { surface, centre, periods })
    };
    let (mut finest, mut detail, mut unit, mut seam) = (None, None, None, None);
    let surface = match scene.indenter {
        Indenter::Paraboloid { radius, centre } => repeated(Box::new(Paraboloid { radii: radius, centre }), centre),
        Indenter::Sphere { radius, centre } => repeated(Box::new(Sphere { radius, centre }), centre),
        Indenter::Cone { slope, centre } => repeated(Box::new(Cone { slope, centre }), centre),
        Indenter::Waves { amplitude, wavelength } => {
            finest = Some(Finest::Wavelength(wavelength.min()));
            Rc::new(Waves { amplitudes: amplitude, wavelengths: wavelength })
        }
        Indenter::Expression { ref formula } => {
            let expression = Expression::parse(formula, &["x", "y"])
                .map_err(|fault| wrong("formula", format!("{formula:?}, {fault}")))?;
            let surface = SurfaceFormula { expression };
            check(&surface, scene, face).map_err(|reason| wrong("formula", format!("{formula:?} {reason}")))?;
            repeated(Box::new(surface), middle)
        }
        Indenter::Rough { hurst, rms, shortest, longest, period, seed } => {
            let roughness = Roughness { hurst, rms: rms.into(), shortest, longest, period, seed };
            let waves = waves(&roughness).map_err(|(key, reason)| wrong(key, reason))?;
            finest = Some(Finest::Wavelength(shortest));
            detail = Some(format!("{waves} waves, repeating after {period:?} m along x and along y"));
            Rc::new(RoughSurface::new(roughness, period))
        }
        Indenter::Map { .. } => {
            let map = map::surface((scene, file), elevations, face)?;
            (finest, detail, unit, seam) = (Some(map.finest), Some(map.detail), map.unit, map.seam);
            Rc::new(map.surface)
        }
        _ => return Ok(None),
    };
    let pressed = pressed_end(&*surface, (scene, file), outline)?;
    let lowest = match outline.nearest(&*surface) {
        Ok(Some(nearest)) => Ok(nearest),
        Ok(None) => lowest(&*surface, face),
        Err(error) => Err(error),
    };
    let lowest = lowest.map_err(|error| wrong("profile", error.to_string()))?;
    let profile: Rc<dyn Profile> = Rc::new(Section { surface: surface.clone(), y: lowest.y });
    let survey = survey(&profile, face[0]).map_err(|error| wrong("profile", error.to_string()))?;
    Ok(Some(Shape { surface, profile, finest, detail, unit, seam, survey, pressed }))
}

/// Points along each direction of a face at which a surface is looked at: its nodes, or so many.
const MOST: usize = 256;

/// Places over a face, m.
fn places([x, y]: [Stretch; 2]) -> impl Iterator<Item = Vector2<f64>> {
    let [columns, rows] = [x, y].map(|along| along.edges.min(MOST));
    let at = |along: Stretch, i: usize, count: usize| along.from + along.width() * i as f64 / count as f64;
    (0..=columns).flat_map(move |i| (0..=rows).map(move |j| Vector2::new(at(x, i, columns), at(y, j, rows))))
}

/// A rough surface has waves, and not too many to be added up; how many.
fn waves(roughness: &Roughness) -> std::result::Result<usize, (&'static str, String)> {
    const MOST: usize = 120_000;
    let Roughness { shortest, longest, period, .. } = *roughness;
    // Half of the disc of wave vectors, before they are counted one by one.
    let disc = 0.5 * PI * (period / shortest).powi(2);
    let count = if disc > 2.0 * MOST as f64 { disc as usize } else { RoughSurface::count(roughness, period) };
    match count {
        0 => Err((
            "period",
            format!(
                "must have a wave vector of its lattice between shortest ({shortest:?} m) and longest ({longest:?} m), got \
                 {period:?}"
            ),
        )),
        1..=MOST => Ok(count),
        _ => Err(("shortest", format!("makes {count} waves in a period of {period:?} m; at most {MOST} are added up"))),
    }
}

/// Where a surface is lowest over the face, m.
fn lowest(surface: &dyn Surface, face: [Stretch; 2]) -> Result<Vector2<f64>> {
    let mut lowest = (f64::INFINITY, Vector2::zeros());
    for place in places(face) {
        let height = surface.at(place)?.height;
        if height < lowest.0 {
            lowest = (height, place);
        }
    }
    Ok(lowest.1)
}

/// A formula is finite wherever the face meets it, as far as sampling can tell, and has no jump where it repeats.
fn check(surface: &SurfaceFormula, scene: &Scene, face: [Stretch; 2]) -> std::result::Result<(), String> {
    const ALIKE: f64 = 1e-6;
    let mut reached = face;
    for (axis, along) in reached.iter_mut().enumerate() {
        [along.from, along.to] = reach_along(axis, scene, *along);
    }
    let at = |place| surface.at(place).map(|height| height.height).map_err(|error| error.to_string());
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for place in places(reached) {
        let height = at(place)?;
        (low, high) = (low.min(height), high.max(height));
    }
    for (axis, along) in face.iter().enumerate().filter(|(_, along)| along.periodic) {
        for place in places(face).filter(|place| place[axis] == along.from) {
            let ends = [at(place)?, at(place + Vector2::ith(axis, along.width()))?];
            if (ends[1] - ends[0]).abs() > ALIKE * (high - low) {
                return Err(format!(
                    "must be the same at both sides of a periodic layer, got {:e} m at x = {:?}, y = {:?} m and {:e} m a \
                     period of {:?} m further",
                    ends[0],
                    place.x,
                    place.y,
                    ends[1],
                    along.width()
                ));
            }
        }
    }
    Ok(())
}
