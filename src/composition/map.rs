//! A measured surface: its file, what the face will ask of it, and what is doubtful of it.

use std::path::Path;

use nalgebra::Vector2;

use super::Stretch;
use super::profile::{Elevations, Finest, beside, bytes, looks_like, of_the_indenter, reach_along};
use crate::error::{Error, Result};
use crate::heightmap::{self, Format, Heights};
use crate::input;
use crate::profile::{BLEND, HeightMap, Surface, map};
use crate::scene::{self, Detrend, Extend, Indenter, Scene, Seam};
use crate::table::Unit;

/// A map made ready, and what is known of it: see [`super::Shape`].
pub(super) struct Known {
    pub surface: HeightMap,
    pub finest: Finest,
    pub detail: String,
    pub unit: Option<String>,
    pub seam: Option<(&'static str, String)>,
}

/// The heights of the scene in `file`, made h as it says.
///
/// # Errors
/// [`Error::File`] when they cannot be read, [`Error::Scene`] when the content of their file is wrong.
pub(super) fn measured(scene: &Scene, file: &Path) -> Result<Elevations> {
    let Indenter::Map { file: name, dataset, spacing, origin, reading, .. } = &scene.indenter else {
        return Ok(Elevations::default());
    };
    let wrong = |reason: String| Error::scene(file, "indenter.file", format!("{name:?}: {reason}"));
    let said = [reading.x_unit, reading.z_unit].map(|unit| unit.and_then(Unit::parse));
    let read = match (Format::of(name).map_err(wrong)?, dataset) {
        (Format::Hdf5, Some(dataset)) => {
            let path = beside(name, file);
            // The system's words on a file that is missing or may not be read are plainer than the library's.
            input::regular(&path)
                .and_then(|()| std::fs::File::open(&path).map(drop).map_err(|error| Error::file(&path, error)))
                .map_err(|error| of_the_indenter(error, file))?;
            heightmap::dataset(&path, dataset, said[1])
        }
        (format, _) => format.parse(&bytes(name, file)?, said),
    };
    let mut heights = read.map_err(wrong)?;
    if reading.invert {
        heights.invert();
    }
    match reading.detrend {
        Detrend::None => {}
        Detrend::Mean => heights.take_off_mean(),
        Detrend::Line | Detrend::Plane => heights.take_off_plane(),
    }
    heights.shift(reading.offset);
    let note = Some(heights.note());
    let spacing = spacing.map(<[f64; 2]>::from).or(heights.spacing);
    let spacing = spacing.ok_or_else(|| Error::Internal("a map without a spacing was let through".to_owned()))?;
    let origin = origin.map(<[f64; 2]>::from).or(heights.origin).unwrap_or_default();
    Ok(Elevations { numbers: heights.into_numbers(spacing, origin), note })
}

/// The surface of the scene in `file` over a face, with the numbers of [`measured`].
///
/// # Errors
/// [`Error::Scene`] where it does not cover what the face meets, or does not fit on a periodic layer.
pub(super) fn surface((scene, file): (&Scene, &Path), numbers: &[f64], face: [Stretch; 2]) -> Result<Known> {
    let lost = || Error::Internal("the heights of a map were lost".to_owned());
    let Indenter::Map { extend, reading, .. } = &scene.indenter else { return Err(lost()) };
    let mut heights = Heights::from_numbers(numbers).ok_or_else(lost)?;
    let layout = [heights.spacing, heights.origin].map(Option::unwrap_or_default);
    let [spacing, _] = layout;
    let [columns, rows] = heights.counts;
    let spans = [0, 1].map(|axis| spacing[axis] * (heights.counts[axis] - 1) as f64);
    let unit = looks_like(scene, spans[0].max(spans[1]), face[0]);
    let finest = Finest::Spacing(spacing[0].max(spacing[1]));
    let mut detail = format!("{columns} x {rows} points over {:?} x {:?} m", spans[0], spans[1]);
    if *extend == Extend::Error {
        let surface = HeightMap::new(heights, layout, None);
        covers(&surface, scene, face).map_err(|reason| Error::scene(file, "indenter.file", reason))?;
        return Ok(Known { surface, finest, detail, unit, seam: None });
    }
    let periods = periods((scene, file), &heights, spacing)?;
    fits(file, periods, face, unit.as_deref())?;
    let seam = seam_doubt(&heights, periods).filter(|_| reading.seam == Seam::None);
    detail += &format!(", repeating after {:?} x {:?} m", periods[0], periods[1]);
    if reading.seam == Seam::Blend {
        (0..2).for_each(|axis| map::blend(&mut heights, axis, [spacing[axis], periods[axis]]));
        detail += &format!(", its edges blended over {:.3e} and {:.3e} m each", BLEND * periods[0], BLEND * periods[1]);
    }
    Ok(Known { surface: HeightMap::new(heights, layout, Some(periods)), finest, detail, unit, seam })
}

/// The distances after which a map repeats: what the scene says, or what the points say by themselves.
fn periods((scene, file): (&Scene, &Path), heights: &Heights, spacing: [f64; 2]) -> Result<[f64; 2]> {
    let Indenter::Map { period, reading, .. } = &scene.indenter else { return Ok([0.0; 2]) };
    let wrong = |reason: String| Error::scene(file, "indenter.period", reason);
    let Some(said) = period else {
        return Ok([0, 1].map(|axis| map::natural_period(heights, axis, spacing[axis])));
    };
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        let span = spacing[axis] * (heights.counts[axis] - 1) as f64;
        if said[axis] < span * (1.0 - 1e-12) {
            return Err(wrong(format!(
                "must be at least the extent of the map along {name} ({span:?} m), got {:?}",
                said[axis]
            )));
        }
        let closed = map::meets(heights, axis) || reading.seam == Seam::Blend;
        if said[axis] <= span * (1.0 + 1e-12) && !closed {
            return Err(wrong(format!(
                "is the extent of the map along {name}, whose edges must then have the same heights; or say seam = \"blend\""
            )));
        }
    }
    Ok([said.x, said.y])
}

/// Periodic sides are a whole number of periods apart.
fn fits(file: &Path, periods: [f64; 2], face: [Stretch; 2], hint: Option<&str>) -> Result<()> {
    for (along, period) in face.into_iter().zip(periods).filter(|(along, _)| along.periodic) {
        scene::whole_periods(along.width(), "periods of the profile", period).map_err(|reason| {
            let hint = hint.map_or_else(String::new, |hint| format!("; {hint}"));
            Error::scene(file, "layer.width", format!("{reason}; or give indenter.period{hint}"))
        })?;
    }
    Ok(())
}

/// A bounded map covers what the face meets.
fn covers(surface: &HeightMap, scene: &Scene, face: [Stretch; 2]) -> std::result::Result<(), String> {
    let extent = surface.extent();
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        let [from, to] = reach_along(axis, scene, face[axis]);
        let [first, last] = extent[axis];
        let known = |at: f64| {
            let mut place = Vector2::new(extent[0][0], extent[1][0]);
            place[axis] = at;
            surface.at(place).is_ok()
        };
        if !(known(from) && known(to)) {
            return Err(format!(
                "its {name} must cover {from:?} to {to:?} m (a face of {:?} m, and the sliding of all phases), got {first:?} to {last:?} \
                 m; give a larger map or an origin, slide less, or say extend = \"periodic\"",
                face[axis].width()
            ));
        }
    }
    Ok(())
}

/// What is doubtful of a map that repeats, as the key and the reason: a wall where two edges meet.
fn seam_doubt(heights: &Heights, periods: [f64; 2]) -> Option<(&'static str, String)> {
    let (axis, wall) = (0..2).find_map(|axis| Some((axis, map::wall(heights, axis)?)))?;
    Some((
        "indenter.seam",
        format!(
            "where the map repeats along {} its edges are {wall:.3e} m (rms) apart in elevation: a wall that no point beside it has; \
             seam = \"blend\" closes it over {:.3e} m at each edge, detrend = \"plane\" takes off a tilt",
            ["x", "y"][axis],
            BLEND * periods[axis]
        ),
    ))
}
