//! What a history tells of its own worth.

use super::{After, Warning, above, cells, phase};
use crate::output::HistoryRow;
use crate::scene::{Motion, Phase, Strategy};

/// The imbalance of energies over the largest work.
pub const MOST_IMBALANCE: f64 = 0.05;
/// The deepest penetration over the deepest approach since first touch.
pub const MOST_PENETRATION: f64 = 0.05;
/// Nodes in contact at most, over the history or a phase that slides.
pub const FEWEST_NODES: f64 = 2.5;
/// How often N falls to zero in a phase that slides, where no more nodes than ...
pub const MOST_FALLS: usize = 2;
/// ... these were in contact.
pub const NODES_OF_A_TIP: f64 = 4.5;
/// The slip of what should stick over the motion.
pub const MOST_STUCK_SLIP: f64 = 0.1;
/// The oscillation of the tractions at the end of a phase.
pub const MOST_OSCILLATION: f64 = 0.1;
/// What round-off leaves of the approach over the penetration, where displacements are the unknowns.
pub const MOST_LOST: f64 = 1e-6;

impl After<'_> {
    fn largest(&self, value: impl Fn(&HistoryRow) -> f64) -> f64 {
        self.history.iter().map(value).fold(0.0, f64::max)
    }

    /// How many nodes in contact there are along the face; in space, across a square with as many.
    fn nodes(&self, row: &HistoryRow) -> f64 {
        let all = row.contact_fraction * self.nodes;
        if self.in_space { all.sqrt() } else { all }
    }

    /// The deepest approach since first touch, m.
    fn overlap(&self) -> f64 {
        self.largest(|row| row.approach - self.touch)
    }

    /// The rows of each phase that slides, with its index.
    fn sliding(&self) -> impl Iterator<Item = (usize, &[HistoryRow])> {
        let rows = self.history.chunk_by(|a, b| a.phase == b.phase);
        rows.filter_map(|rows| {
            let index = rows.first()?.phase;
            (slid(self.scene.phases.get(index)?) > 0.0).then_some((index, rows))
        })
    }
}

/// How far a phase takes the indenter along the face between any two moments at most, m; of what was measured, from where it began.
fn slid(phase: &Phase) -> f64 {
    match &phase.motion {
        Motion::Velocity(velocity) => (velocity * phase.duration).norm(),
        Motion::Tangential { amplitude, .. } => 2.0 * amplitude.norm(),
        Motion::Measured(record) => record.slid().iter().map(|(_, gone)| gone.norm()).fold(0.0, f64::max),
    }
}

/// Above [`MOST_IMBALANCE`].
pub fn imbalance(after: &After<'_>) -> Option<Warning> {
    let work = after.largest(|row| row.energy.external_work.abs());
    let worst = after.history.iter().max_by(|a, b| a.energy.imbalance.abs().total_cmp(&b.energy.imbalance.abs()))?;
    let imbalance = worst.energy.imbalance.abs();
    if !above(imbalance, MOST_IMBALANCE * work) {
        return None;
    }
    let unit = if after.in_space { "J" } else { "J/m" };
    let text = format!(
        "the energies do not balance: {imbalance:.3e} {unit} are left over of {work:.3e} {unit} of work, {:.3} of it (more than \
         {MOST_IMBALANCE}); take more steps, more cells, or a profile without kinks between nodes",
        imbalance / work
    );
    Some(Warning::new(phase(after.scene, worst.phase, "steps"), text))
}

/// Above [`MOST_PENETRATION`].
pub fn penetration(after: &After<'_>) -> Option<Warning> {
    let (deepest, overlap) = (after.largest(|row| row.max_penetration), after.overlap());
    if overlap <= 0.0 || !above(deepest, MOST_PENETRATION * overlap) {
        return None;
    }
    let text = format!(
        "the indenter penetrated the face by {deepest:.3e} m, {:.3} of its approach after touching (more than \
         {MOST_PENETRATION}): the penalty is too soft; give one {:.0} times as high, or tolerance = 0.01 instead",
        deepest / overlap,
        (deepest / (0.2 * MOST_PENETRATION * overlap)).ceil()
    );
    Some(Warning::new("contact.penalty", text))
}

/// Above [`MOST_LOST`] where the penetration is the deepest: a penalty makes forces of what displacements differ by.
pub fn digits(after: &After<'_>) -> Option<Warning> {
    let deepest = after.history.iter().max_by(|a, b| a.max_penetration.total_cmp(&b.max_penetration))?;
    let lost = f64::EPSILON * deepest.approach.abs() / deepest.max_penetration;
    let by_displacements = after.scene.solver.strategy == Strategy::Monolithic;
    if !by_displacements || deepest.max_penetration <= 0.0 || !above(lost, MOST_LOST) {
        return None;
    }
    let text = format!(
        "monolithic has forces from displacements, and penetrations of {:.3e} m under an approach of {:.3e} m have no digits beyond \
         {lost:.1e} (more than {MOST_LOST:e}); use \"condensed\", or a lower penalty",
        deepest.max_penetration, deepest.approach
    );
    Some(Warning::new("solver.strategy", text))
}

/// N stays zero although the indenter overlaps the face.
pub fn no_contact(after: &After<'_>) -> Option<Warning> {
    let overlap = after.overlap();
    if overlap <= 0.0 || after.largest(|row| row.normal_force.abs()) > 0.0 {
        return None;
    }
    let text = format!(
        "N stayed zero although the indenter went {overlap:.3e} m beyond first touch: no node noticed; give more cells along the \
         face, and a penalty and moduli that the digits of numbers carry together"
    );
    Some(Warning::new(cells(after.scene), text))
}

/// Fewer than [`FEWEST_NODES`], where that is not the whole face.
pub fn few_nodes(after: &After<'_>) -> Option<Warning> {
    if after.largest(|row| row.contact_fraction) >= 1.0 {
        return None;
    }
    let most = |rows: &[HistoryRow]| rows.iter().map(|row| after.nodes(row)).fold(0.0, f64::max);
    let whole = std::iter::once(("the run".to_owned(), most(after.history)));
    let slides =
        after.sliding().map(|(index, rows)| (format!("phase {:?}", after.scene.phases[index].name), most(rows)));
    let (place, nodes) = whole.chain(slides).find(|(_, nodes)| *nodes > 0.0 && *nodes < FEWEST_NODES)?;
    let text = format!(
        "at most {nodes:.1} nodes of the face were in contact in {place}: N and Q are those of single nodes; give more cells \
         along the face, or a blunter profile"
    );
    Some(Warning::new(cells(after.scene), text))
}

/// N falls to zero more than once while few nodes touch.
pub fn between_nodes(after: &After<'_>) -> Option<Warning> {
    let falls = |rows: &[HistoryRow]| {
        let fell = |pair: &&[HistoryRow]| {
            pair[0].normal_force > 0.0 && pair[1].normal_force <= 0.0 && after.nodes(&pair[0]) <= NODES_OF_A_TIP
        };
        rows.windows(2).filter(fell).count()
    };
    let (index, count) =
        after.sliding().map(|(index, rows)| (index, falls(rows))).find(|(_, count)| *count >= MOST_FALLS)?;
    let text = format!(
        "N fell to zero {count} times while sliding in phase {:?}, with at most {} nodes in contact: the tip passes between nodes; give \
         more cells along the face, or a blunter profile",
        after.scene.phases[index].name,
        NODES_OF_A_TIP.floor()
    );
    Some(Warning::new(cells(after.scene), text))
}

/// Above [`MOST_STUCK_SLIP`] of what the indenter moves in some phase: along the face, or else towards it.
pub fn stuck_slip(after: &After<'_>) -> Option<Warning> {
    let friction = after.scene.friction.as_ref().filter(|friction| !friction.is_none())?;
    let softness = friction.law.kind.softness.as_ref()?;
    let phases = after.history.chunk_by(|a, b| a.phase == b.phase).filter_map(|rows| {
        let (first, last) = (rows.first()?, rows.last()?);
        let phase = after.scene.phases.get(first.phase)?;
        let slides = slid(phase);
        let motion =
            if slides > 0.0 { slides } else { (last.approach - after.touch).min(last.approach - first.approach) };
        let slip = rows.iter().map(|row| row.stuck_slip).fold(0.0, f64::max);
        (motion > 0.0 && above(slip, MOST_STUCK_SLIP * motion)).then_some((slip, motion))
    });
    let (slip, motion) = phases.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
    let text = format!(
        "what should stick slipped by {slip:.3e} m, {:.3} of the motion of {motion:.3e} m (more than {MOST_STUCK_SLIP}); give \
         one {:.0} times as small",
        slip / motion,
        (slip / (0.1 * MOST_STUCK_SLIP * motion)).ceil()
    );
    Some(Warning::new(format!("friction.{}", softness.key), text))
}

/// Above [`MOST_OSCILLATION`].
pub fn oscillation(after: &After<'_>) -> Option<Warning> {
    let ends = after.history.chunk_by(|a, b| a.phase == b.phase).filter_map(|rows| rows.last());
    let worst = ends.max_by(|a, b| a.traction_oscillation.total_cmp(&b.traction_oscillation))?;
    let value = worst.traction_oscillation;
    if !above(value, MOST_OSCILLATION) {
        return None;
    }
    let text = format!(
        "the tractions oscillate from node to node by {value:.3} of their size at t = {:.4e} s (more than \
         {MOST_OSCILLATION}): they are not resolved; give more cells along the face, or nodal quadrature",
        worst.time
    );
    Some(Warning::new(cells(after.scene), text))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::energy::Energy;
    use crate::scene::{self, Scene, Source};

    /// Pressed by 1 mm, then slid by 10 mm, with friction.
    fn scene() -> Scene {
        let text = r#"
            layer = { width = 1.0, depth = 1.0, cells = [100, 10], sides = "periodic" }
            material = { shear_modulus = 1e3, poisson_ratio = 0.3 }
            indenter = { profile = "parabola", radius = 1.0, centre = 0.5 }
            contact = { penalty = 1e6 }
            friction = { law = "coulomb_tanh", coefficient = 0.2, regularisation = 1e-6 }
            phase = [
                { name = "press", duration = 1.0, steps = 4, approach = 1e-3 },
                { name = "slide", velocity = 1e-2, duration = 1.0, steps = 4 },
            ]
        "#;
        scene::read(text, &Source { file: Path::new("scene.toml").into(), overrides: Vec::new() }).unwrap()
    }

    /// A sound history of that scene, with a change of every row.
    fn history(change: impl Fn(usize, &mut HistoryRow)) -> Vec<HistoryRow> {
        let row = |i: usize| {
            let share = (i as f64 / 4.0).min(1.0);
            let slid = i.saturating_sub(4) as f64 / 4.0;
            let mut row = HistoryRow {
                time: i as f64 / 4.0,
                phase: i.saturating_sub(1) / 4,
                approach: 1e-3 * share,
                sliding: 1e-2 * slid,
                normal_force: share,
                contact_fraction: 0.1 * share,
                energy: Energy { external_work: share + slid, ..Energy::default() },
                ..HistoryRow::default()
            };
            change(i, &mut row);
            row
        };
        (0..9).map(row).collect()
    }

    fn check(what: fn(&After<'_>) -> Option<Warning>, change: impl Fn(usize, &mut HistoryRow)) -> String {
        let (scene, history) = (scene(), history(change));
        let after = After { scene: &scene, nodes: 100.0, in_space: false, touch: 0.0, history: &history };
        what(&after).map_or_else(String::new, |warning| warning.to_string())
    }

    /// Each just beyond its threshold, with its number, and not at it.
    #[test]
    fn histories_at_their_thresholds() {
        // Of a work of 2 J/m.
        let left = |joule: f64| check(imbalance, |i, row| row.energy.imbalance = if i == 6 { -joule } else { 0.0 });
        assert_eq!(left(0.1), "");
        assert!(
            left(0.102).starts_with("phase.slide.steps: the energies do not balance: 1.020e-1 J/m"),
            "{}",
            left(0.102)
        );
        assert!(left(0.102).contains("0.051 of it"));
        let pressing = |newton: f64| check(no_contact, move |_, row| row.normal_force *= newton);
        assert_eq!(pressing(1e-9), "");
        assert!(pressing(0.0).contains("N stayed zero although the indenter went 1.000e-3 m beyond first touch"));
        let sunk = |metre: f64| check(penetration, |_, row| row.max_penetration = metre);
        assert_eq!(sunk(5e-5), "");
        assert!(sunk(5.1e-5).contains("5.100e-5 m, 0.051 of its approach"), "{}", sunk(5.1e-5));
        // Under an approach of 1 mm; with tractions as unknowns there is no such thing.
        let shallow = |metre: f64, strategy| {
            let mut scene = scene();
            scene.solver.strategy = strategy;
            let history = history(|i, row| row.max_penetration = if i < 4 { 0.0 } else { metre });
            let after = After { scene: &scene, nodes: 100.0, in_space: false, touch: 0.0, history: &history };
            digits(&after).map_or_else(String::new, |warning| warning.to_string())
        };
        assert_eq!((shallow(2.3e-13, Strategy::Monolithic), shallow(2e-13, Strategy::Auto)), Default::default());
        assert!(shallow(2.2e-13, Strategy::Monolithic).contains("have no digits beyond 1.0e-6"));
        // A whole face of two nodes is as good as any.
        let touching = |share: f64| check(few_nodes, |i, row| row.contact_fraction = if i > 4 { share } else { 0.1 });
        assert_eq!((touching(0.03), touching(0.0)), (String::new(), String::new()));
        assert!(touching(0.02).contains("at most 2.0 nodes of the face were in contact in phase \"slide\""));
        assert_eq!(check(few_nodes, |_, row| row.contact_fraction = 1.0), "");
        let falls = |at: &'static [usize], nodes: f64| {
            check(between_nodes, move |i, row| {
                row.contact_fraction = nodes / 100.0;
                row.normal_force = if at.contains(&i) { 0.0 } else { 1.0 };
            })
        };
        assert_eq!((falls(&[6], 3.0), falls(&[2, 4], 3.0), falls(&[6, 8], 10.0)), Default::default());
        assert!(falls(&[6, 8], 3.0).contains("N fell to zero 2 times while sliding in phase \"slide\""));
        let crept = |metre: f64| check(stuck_slip, |i, row| row.stuck_slip = if i == 5 { metre } else { 0.0 });
        assert_eq!(crept(1e-3), "");
        assert!(
            crept(1.1e-3).contains("slipped by 1.100e-3 m, 0.110 of the motion of 1.000e-2 m"),
            "{}",
            crept(1.1e-3)
        );
        let rough =
            |value: f64| check(oscillation, |i, row| row.traction_oscillation = if i == 8 { value } else { 0.0 });
        assert_eq!(rough(0.1), "");
        assert!(rough(0.11).contains("by 0.110 of their size at t = 2.0000e0 s"));
    }
}
