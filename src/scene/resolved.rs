//! What a scene says of itself.

use nalgebra::Vector2;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::{Body, Layer, Material, MountEnd, Phase, Record, Scene, Sides, Span, Stepping, When, checks};

impl Scene {
    /// The resolved scene as TOML: every default written out, every duration and modulus in its own key. Reading it
    /// again gives an equal scene.
    pub fn to_toml(&self) -> String {
        // Text, numbers and tables all have a form in TOML, so the error has no way to occur; should it, a comment
        // says so without costing the user the results.
        toml::to_string(self).unwrap_or_else(|error| format!("# the scene has no form in TOML: {error}\n"))
    }

    /// The whole loading history, s.
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|phase| phase.duration).sum()
    }

    /// The steps of all phases, those of adaptive ones as [`Phase::expected_steps`] has them.
    pub fn steps(&self) -> usize {
        self.phases.iter().map(Phase::expected_steps).sum()
    }

    /// Whether some phase chooses its steps.
    pub fn is_adaptive(&self) -> bool {
        self.phases.iter().any(|phase| matches!(phase.stepping, Stepping::Tolerance(_)))
    }

    /// The steps up to the time `t`, s, in the phase of this index; of an adaptive phase its share in time.
    pub fn steps_until(&self, index: usize, t: f64) -> usize {
        let (before, rest) = self.phases.split_at(index.min(self.phases.len()));
        let start: f64 = before.iter().map(|phase| phase.duration).sum();
        let steps: usize = before.iter().map(Phase::expected_steps).sum();
        let inside = rest.first().map_or(0.0, |phase| (t - start) / phase.duration * phase.expected_steps() as f64);
        // Round-off in the clock does not hold back a step that is done.
        steps + (inside + 1e-6) as usize
    }

    /// Whether the arms follow the temperature of the body.
    pub fn is_coupled(&self) -> bool {
        self.heat.is_some_and(|heat| heat.coupled)
    }

    /// The layer, where the body is one.
    pub fn layer(&self) -> Option<&Layer> {
        match &self.body {
            Body::Layer(layer) => Some(layer),
            Body::Mesh(_) => None,
        }
    }

    /// Whether it is in space, as far as that is known without the file of a mesh.
    pub fn is_in_space(&self) -> bool {
        self.layer().is_some_and(|layer| layer.spans.len() == 2)
    }

    /// Whether a mesh, in the plane or in space, goes with the rest.
    ///
    /// # Errors
    /// The key and the reason why not.
    pub fn allows_mesh(&self, in_space: bool) -> std::result::Result<(), (String, String)> {
        checks::mesh(self, in_space)
    }

    /// The period along x, m, where the sides are one another's images.
    pub fn period(&self) -> Option<f64> {
        self.layer().map(|layer| layer.spans[0]).filter(|span| span.sides == Sides::Periodic).map(|span| span.width)
    }

    /// The deepest approach of all phases, m; the tolerances of adaptive steps are relative to it.
    pub fn deepest(&self) -> f64 {
        self.phases.iter().flat_map(Phase::approaches).map(|(_, approach)| approach).fold(0.0, f64::max)
    }

    /// The greatest normal force of all phases, N/m.
    pub fn greatest_force(&self) -> f64 {
        self.phases.iter().flat_map(Phase::forces).map(|(_, force)| force).fold(0.0, f64::max)
    }

    /// The greatest force, N/m, that a mount along the approach can press with, and the deepest place, m, that it can bring the indenter to;
    /// none without one.
    pub fn mounted(&self) -> Option<(f64, f64)> {
        let MountEnd { stiffness, damping, load, .. } = self.mount?.normal?;
        let (load, deepest) = (load.unwrap_or(0.0), self.deepest());
        let (mut fastest, mut last): (f64, f64) = (0.0, 0.0);
        for phase in &self.phases {
            let mut before = 0.0;
            for (time, approach) in phase.approaches() {
                if time > before {
                    fastest = fastest.max((approach - last) / (time - before));
                }
                (before, last) = (time, approach);
            }
        }
        let place = match load {
            0.0 => deepest,
            load => deepest + load / stiffness,
        };
        Some((load + stiffness * deepest + damping * fastest, place))
    }

    /// Whether a force, or a mount, holds the indenter along the approach at any time.
    pub fn is_loaded(&self) -> bool {
        self.phases.iter().any(Phase::says_force) || self.mount.is_some_and(|mount| mount.normal.is_some())
    }

    /// The same scene up to the end of its first `count` phases, without a title: what the state there depends on; none
    /// where the steps of these phases also depend on later ones.
    pub fn first_phases(&self, count: usize) -> Option<Self> {
        let phases = self.phases[..count.min(self.phases.len())].to_vec();
        let end: f64 = phases.iter().map(|phase| phase.duration).sum();
        let near = phases.last().map_or(0.0, |last| 1e-9 * last.duration / last.expected_steps() as f64);
        let mut part = Self { title: String::new(), phases, ..self.clone() };
        part.output.checkpoint_every = 0;
        part.output.bulk_at.retain(|moment| match moment {
            When::PhaseEnd(name) => part.phases.iter().any(|phase| phase.name == *name),
            When::Time(time) => *time <= end + near,
        });
        // Under a force, and on a mount, adaptive steps depend on how long it is held, too.
        let held = self.greatest_force() > 0.0 || self.mounted().is_some();
        let same_steps = part.deepest() == self.deepest() && !held;
        (!part.is_adaptive() || same_steps).then_some(part)
    }

    /// Moments that round-off put just after the end of the history are its end.
    pub(super) fn clamp_moments(&mut self) {
        let end = self.duration();
        for moment in &mut self.output.bulk_at {
            if let When::Time(time) = moment {
                *time = time.min(end);
            }
        }
    }
}

impl Phase {
    /// How many steps it has; where they are chosen as it goes, about how many there will be.
    pub fn expected_steps(&self) -> usize {
        match self.stepping {
            Stepping::Steps(steps) => steps,
            // The steps of a method whose local error goes with their square.
            Stepping::Tolerance(tolerance) => {
                (3.0 / tolerance.sqrt()) as usize + 10 + self.record().map_or(0, Record::len)
            }
        }
    }
}

impl Layer {
    /// The displacements to be solved for: one for each direction of a node, without those that the lower face and the sides
    /// hold, and with two sides counted once where they are the same nodes.
    pub fn unknowns(&self) -> usize {
        // The lowest row of nodes is clamped, so that as many rows move as there are cells.
        let direction =
            |held: usize| self.spans.iter().enumerate().map(|(axis, span)| span.free(axis == held)).product::<usize>();
        (0..=self.spans.len()).map(direction).sum::<usize>() * self.rows
    }

    /// How many nodes its contact face has.
    pub fn face_nodes(&self) -> usize {
        self.spans.iter().map(|span| span.cells + usize::from(span.sides != Sides::Periodic)).product()
    }

    /// Whether it repeats in all directions of its face.
    pub fn is_periodic(&self) -> bool {
        self.spans.iter().all(|span| span.sides == Sides::Periodic)
    }

    /// How many cells it has.
    pub fn cells(&self) -> usize {
        self.spans.iter().map(|span| span.cells).product::<usize>() * self.rows
    }

    /// The length of the shortest cell along its face, m.
    pub fn cell(&self) -> f64 {
        self.spans.iter().map(Span::cell).fold(f64::INFINITY, f64::min)
    }
}

impl Span {
    /// The length of a cell, m.
    pub fn cell(&self) -> f64 {
        self.width / self.cells as f64
    }

    /// Of a row of nodes along it, how many are free to move; `across` its sides, or along them.
    fn free(&self, across: bool) -> usize {
        match self.sides {
            Sides::Periodic => self.cells,
            Sides::Free => self.cells + 1,
            Sides::Roller if !across => self.cells + 1,
            Sides::Roller | Sides::Fixed => self.cells - 1,
        }
    }
}

impl Serialize for Layer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut table = serializer.serialize_struct("layer", 6)?;
        let cells: Vec<usize> = self.spans.iter().map(|span| span.cells).chain([self.rows]).collect();
        match self.spans.as_slice() {
            [x] => table.serialize_field("width", &x.width)?,
            several => table.serialize_field("width", &several.iter().map(|span| span.width).collect::<Vec<_>>())?,
        }
        table.serialize_field("depth", &self.depth)?;
        table.serialize_field("cells", &cells)?;
        table.serialize_field("grading", &self.grading)?;
        match self.spans.as_slice() {
            [x, y] if x.sides != y.sides => table.serialize_field("sides", &[x.sides, y.sides])?,
            all => table.serialize_field("sides", &all[0].sides)?,
        }
        table.serialize_field("element", &self.element)?;
        table.end()
    }
}

/// Both components.
pub(super) fn pair<S: Serializer>(vector: &Vector2<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    [vector.x, vector.y].serialize(serializer)
}

/// One number where both components are the same, else both.
pub(super) fn one_or_both<S: Serializer>(vector: &Vector2<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match vector.x == vector.y {
        true => vector.x.serialize(serializer),
        false => [vector.x, vector.y].serialize(serializer),
    }
}

/// As [`pair`], where there is one.
pub(super) fn optional_pair<S: Serializer>(vector: &Option<Vector2<f64>>, serializer: S) -> Result<S::Ok, S::Error> {
    match vector {
        Some(vector) => pair(vector, serializer),
        None => serializer.serialize_none(),
    }
}

/// As [`one_or_both`], where there is one.
pub(super) fn optional_one_or_both<S: Serializer>(
    vector: &Option<Vector2<f64>>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match vector {
        Some(vector) => one_or_both(vector, serializer),
        None => serializer.serialize_none(),
    }
}

/// What is along x alone as a number, else both components.
pub(super) fn number_or_pair<S: Serializer>(vector: &Vector2<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match vector.y {
        0.0 => vector.x.serialize(serializer),
        _ => [vector.x, vector.y].serialize(serializer),
    }
}

/// A `[material]` table where one material is all there is, else `[[material]]` tables.
pub(super) fn materials<S: Serializer>(materials: &[Material], serializer: S) -> Result<S::Ok, S::Error> {
    match materials {
        [only] if only.region.is_none() => only.serialize(serializer),
        several => several.serialize(serializer),
    }
}
