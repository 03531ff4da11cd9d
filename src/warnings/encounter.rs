//! Where the indenter would overlap the undeformed face, from which the size of the contact is estimated.

use std::f64::consts::SQRT_2;

use nalgebra::Vector2;

use crate::composition::{Outline, Shape, course, reach};
use crate::loading::{Motion, Phase};
use crate::profile::Profile;
use crate::scene::Scene;

/// Points to an edge of the face, and the most edges that get as many.
pub const POINTS: usize = 4;
const MOST_EDGES: usize = 4096;
/// Samples of the profile to an edge, and in all.
const SAMPLES: f64 = 8.0;
const MOST_SAMPLES: f64 = 2e5;
/// The most moments that are looked at.
const MOST_MOMENTS: usize = 200;

/// The indenter and the undeformed face over the history.
pub struct Encounters {
    /// The phases, without steps.
    pub course: Vec<Phase>,
    /// At the ends and the turns of the phases, in order; never empty.
    pub list: Vec<Encounter>,
    /// The lowest point of the profile that ever comes over the face, over the depth of the face there, m.
    pub low: f64,
}

/// One moment.
#[derive(Debug, Clone, Default)]
pub struct Encounter {
    /// Index of the phase.
    pub phase: usize,
    /// How much of the face the indenter overlaps, m, and how many of its edges.
    pub width: f64,
    pub edges: f64,
    /// Whether that is all of it.
    pub whole: bool,
    /// The deepest overlap, m; negative where there is none.
    pub overlap: f64,
    /// Where the profile goes on downwards beyond a free end of the face that it overlaps most: x, m.
    pub beyond: Option<f64>,
    /// The slope that all but 5 % of the overlap stay below.
    pub slope: f64,
    /// The mean slope between neighbouring points of which one overlaps.
    pub flank: f64,
    /// The root mean square of what lies between the nodes and off their straight connections, in the overlap, m.
    pub between: f64,
}

impl Encounter {
    /// The width of the contact, m, and its edges, once the face has given way: in a half-plane under a parabola those
    /// of the overlap over sqrt(2) (Hertz), and all of the face where all of it is overlapped.
    pub fn contact(&self) -> [f64; 2] {
        [self.width, self.edges].map(|overlap| if self.whole { overlap } else { overlap / SQRT_2 })
    }
}

impl Encounters {
    /// Of a scene with this body and this indenter.
    pub fn new(scene: &Scene, outline: &Outline, shape: &Shape) -> Self {
        let course = course(scene);
        let relief = Relief::new(scene, outline, shape);
        let sites = Sites::new(outline, shape);
        let moments = moments(&course);
        let list: Vec<Encounter> = moments.iter().map(|moment| sites.meet(&relief, moment)).collect();
        let low = moments.iter().zip(&list).map(|(moment, met)| moment.approach - met.overlap);
        let low = low.fold(f64::INFINITY, f64::min);
        Self { course, list, low }
    }

    /// The deepest moment of the history.
    pub fn deepest(&self) -> &Encounter {
        let mut deepest = &self.list[0];
        for met in &self.list {
            if met.overlap > deepest.overlap {
                deepest = met;
            }
        }
        deepest
    }

    /// The phases that move the indenter while it touches: index, phase, and its deepest moment.
    pub fn moving(&self) -> impl Iterator<Item = (usize, &Phase, &Encounter)> {
        self.course.iter().enumerate().filter_map(|(index, phase)| {
            // Where there are more phases than moments, the last moment before the phase stands for it.
            let upto = self.list.partition_point(|met| met.phase <= index);
            let from = self.list.partition_point(|met| met.phase < index).min(upto - 1);
            let met = self.list[from..upto].iter().max_by(|a, b| a.overlap.total_cmp(&b.overlap))?;
            let moves = phase.turns().iter().any(|turn| turn.0 != phase.approach[0]) || slides(phase);
            (moves && met.overlap > 0.0).then_some((index, phase, met))
        })
    }
}

/// Whether the indenter moves along the face.
pub fn slides(phase: &Phase) -> bool {
    match phase.motion {
        Motion::Velocity(velocity) => velocity.x != 0.0,
        Motion::Sinusoid { amplitude, .. } => amplitude.x != 0.0,
        Motion::Measured(_) => {
            let [least, most] = phase.sliding_range(0);
            most > least
        }
    }
}

/// Where the indenter is.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moment {
    phase: usize,
    approach: f64,
    sliding: f64,
}

/// The ends of each phase and the turns of its sliding, thinned to what can be looked at; the deepest one is kept.
fn moments(course: &[Phase]) -> Vec<Moment> {
    let mut all: Vec<Moment> = Vec::new();
    for (index, phase) in course.iter().enumerate() {
        let moment = |(approach, sliding): (f64, Vector2<f64>)| Moment { phase: index, approach, sliding: sliding.x };
        all.extend(phase.turns().into_iter().map(moment));
    }
    let every = all.len().div_ceil(MOST_MOMENTS);
    let deepest = all.iter().map(|moment| moment.approach).fold(f64::NEG_INFINITY, f64::max);
    let mut kept_deepest = false;
    let keep = |(index, moment): (usize, Moment)| {
        let deep = moment.approach == deepest && !kept_deepest;
        kept_deepest |= deep;
        (deep || index % every == 0).then_some(moment)
    };
    all.into_iter().enumerate().filter_map(keep).collect()
}

/// The profile, sampled where the face meets it; infinitely high where it is not known.
struct Relief {
    from: f64,
    spacing: f64,
    heights: Vec<f64>,
    slopes: Vec<f64>,
    period: Option<f64>,
}

impl Relief {
    fn new(scene: &Scene, outline: &Outline, shape: &Shape) -> Self {
        let (face, cell) = (outline.face, outline.face.cell());
        if face.periodic {
            let (heights, slopes): (Vec<_>, Vec<_>) =
                shape.survey.points.iter().map(|point| (point.height, point.slope)).unzip();
            let spacing = face.width() / (heights.len() - 1) as f64;
            return Self { from: face.from, spacing, heights, slopes, period: Some(face.width()) };
        }
        let [least, most] = reach(scene, face);
        let [from, to] = [least - cell, most + cell];
        let pieces = ((to - from) / cell * SAMPLES).clamp(512.0, MOST_SAMPLES) as usize;
        let spacing = (to - from) / pieces as f64;
        let at = |k: usize| shape.profile.at(from + spacing * k as f64);
        let sample = |k: usize| at(k).map_or((f64::INFINITY, 0.0), |point| (point.height, point.slope));
        let (heights, slopes) = (0..=pieces).map(sample).unzip();
        Self { from, spacing, heights, slopes, period: None }
    }

    /// Where x is among the samples: the one before, and the fraction of the way to the next.
    fn place(&self, x: f64) -> (usize, f64) {
        let mut offset = x - self.from;
        if let Some(period) = self.period {
            offset -= period * (offset / period).floor();
        }
        let last = self.heights.len() - 2;
        let place = (offset / self.spacing).clamp(0.0, last as f64 + 1.0);
        let before = (place as usize).min(last);
        (before, place - before as f64)
    }

    fn height(&self, x: f64) -> f64 {
        let (k, fraction) = self.place(x);
        // A sample itself, without the product of zero and infinity.
        match fraction {
            0.0 => self.heights[k],
            fraction => self.heights[k] + fraction * (self.heights[k + 1] - self.heights[k]),
        }
    }

    fn slope(&self, x: f64) -> f64 {
        let (k, fraction) = self.place(x);
        self.slopes[k + usize::from(fraction > 0.5)].abs()
    }
}

/// Points of the face: x and depth below the highest node, m.
struct Sites {
    points: Vec<[f64; 2]>,
    /// Points to an edge.
    per_edge: usize,
    /// The edges of the face, and their mean length, m.
    edges: f64,
    cell: f64,
    periodic: bool,
}

impl Sites {
    fn new(outline: &Outline, shape: &Shape) -> Self {
        let face = outline.face;
        let (edges, cell, periodic) = (face.edges as f64, face.cell(), face.periodic);
        let nodes = outline.section(&*shape.surface);
        if nodes.is_empty() {
            let per_edge = if face.edges <= MOST_EDGES { POINTS } else { 1 };
            let pieces = face.edges.min(MOST_EDGES) * per_edge;
            let x = |k: usize| face.from + face.width() * (k as f64 / pieces as f64);
            return Self { points: (0..=pieces).map(|k| [x(k), 0.0]).collect(), per_edge, edges, cell, periodic };
        }
        let mix = |[a, b]: [[f64; 2]; 2], t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        let inside = |pair: &[[f64; 2]]| {
            let ends = [pair[0], pair[1]];
            (0..POINTS).map(move |k| mix(ends, k as f64 / POINTS as f64))
        };
        let points = nodes.windows(2).flat_map(inside).chain(nodes.last().copied()).collect();
        Self { points, per_edge: POINTS, edges, cell, periodic }
    }

    fn meet(&self, relief: &Relief, moment: &Moment) -> Encounter {
        let Moment { phase, approach, sliding } = *moment;
        let heights: Vec<f64> = self.points.iter().map(|[x, recess]| relief.height(x - sliding) + recess).collect();
        let overlapped: Vec<bool> = heights.iter().map(|height| *height < approach).collect();
        // Each point stands for half of the way to its neighbours.
        let half = |i: usize| 0.5 * (self.points[i + 1][0] - self.points[i][0]);
        let last = self.points.len() - 1;
        let reach = |i: usize| if i > 0 { half(i - 1) } else { 0.0 } + if i < last { half(i) } else { 0.0 };
        let (mut width, mut halves) = (0.0, 0.0);
        for i in (0..=last).filter(|&i| overlapped[i]) {
            width += reach(i);
            halves += f64::from(u8::from(i > 0) + u8::from(i < last));
        }
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let mut slopes: Vec<f64> = (self.points.iter().zip(&overlapped))
            .filter(|(_, overlaps)| **overlaps)
            .map(|([x, _], _)| relief.slope(x - sliding))
            .collect();
        slopes.sort_by(f64::total_cmp);
        let steepest = slopes.len().saturating_sub(1) as f64;
        Encounter {
            phase,
            width,
            edges: 0.5 * halves / last as f64 * self.edges,
            whole: overlapped.iter().all(|overlaps| *overlaps),
            overlap: approach - lowest,
            beyond: self.beyond(relief, (&heights, lowest), moment),
            slope: slopes.get((0.95 * steepest) as usize).copied().unwrap_or(0.0),
            flank: self.flank(&heights, &overlapped),
            between: self.between(&heights, &overlapped),
        }
    }

    /// See [`Encounter::beyond`].
    fn beyond(&self, relief: &Relief, (heights, lowest): (&[f64], f64), moment: &Moment) -> Option<f64> {
        if self.periodic {
            return None;
        }
        let last = self.points.len() - 1;
        [(0, -self.cell), (last, self.cell)].into_iter().find_map(|(end, outward)| {
            let [x, recess] = self.points[end];
            let next = relief.height(x + outward - moment.sliding) + recess;
            let tiny = 1e-9 * moment.approach.abs();
            (heights[end] == lowest && next < lowest - tiny && next < moment.approach).then_some(x)
        })
    }

    fn flank(&self, heights: &[f64], overlapped: &[bool]) -> f64 {
        let pairs = (0..heights.len() - 1).filter(|&i| overlapped[i] != overlapped[i + 1]);
        let slope = |i: usize| {
            let length = self.points[i + 1][0] - self.points[i][0];
            let rise = (heights[i + 1] - self.points[i + 1][1]) - (heights[i] - self.points[i][1]);
            (rise / length).abs()
        };
        let slopes: Vec<f64> = pairs.map(slope).filter(|slope| slope.is_finite()).collect();
        if slopes.is_empty() { 0.0 } else { slopes.iter().sum::<f64>() / slopes.len() as f64 }
    }

    fn between(&self, heights: &[f64], overlapped: &[bool]) -> f64 {
        let (mut square, mut points) = (0.0, 0);
        if self.per_edge == 1 {
            return 0.0;
        }
        for first in (0..heights.len() - 1).step_by(self.per_edge) {
            let edge = first..=first + self.per_edge;
            if !overlapped[edge.clone()].contains(&true) || !heights[edge.clone()].iter().all(|h| h.is_finite()) {
                continue;
            }
            let (a, b) = (heights[first], heights[first + self.per_edge]);
            for k in 1..self.per_edge {
                let straight = a + (b - a) * (k as f64 / self.per_edge as f64);
                square += (heights[first + k] - straight).powi(2);
                points += 1;
            }
        }
        if points == 0 { 0.0 } else { (square / f64::from(points)).sqrt() }
    }
}
