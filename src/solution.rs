//! A scene solved in memory: its history and its contact face at the end of each phase. Nothing is written.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use nalgebra::Vector2;

use crate::composition::{self, Compliances, Outline, Parts, Problem};
use crate::error::{Error, Result};
use crate::interface::WornFields;
use crate::output::{Across, HeatRow, HistoryRow, InterfaceFrame};
use crate::scene::Scene;
use crate::solve::{BulkFields, Counts, Driver, Observer, Report, Thermal, TransientProblem};
use crate::warnings::{Doubts, Warning};

/// What a scene came to; the same on all ranks.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Undeformed x (in space x, y) of the nodes of the contact face, m.
    pub x: Vec<f64>,
    /// The unloaded state and each accepted step.
    pub history: Vec<HistoryRow>,
    /// The contact face at the end of each phase.
    pub ends: Vec<InterfaceFrame>,
    /// Bulk fields of this rank at the moments that the scene asks for them.
    pub bulk: Vec<BulkFields>,
    /// What it took.
    pub counts: Counts,
    /// What is doubtful about it.
    pub warnings: Vec<Warning>,
}

/// Solves a scene that needs no other files, on all ranks of `comm`.
pub fn solve(comm: &SimpleCommunicator, scene: &Scene) -> Result<Solution> {
    solve_beside(comm, scene, Path::new(""))
}

/// Solves the scene of `file`, beside which its other files are, on all ranks of `comm`.
pub fn solve_beside(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Solution> {
    solve_parts(comm, scene, composition::prepare(comm, scene, file)?)
}

/// Solves a scene on all ranks of `comm`, with the bytes of the .msh file that it names instead of the file.
pub fn solve_on_mesh(comm: &SimpleCommunicator, scene: &Scene, mesh: &[u8]) -> Result<Solution> {
    solve_parts(comm, scene, composition::prepare_on_mesh(scene, mesh)?)
}

fn solve_parts(comm: &SimpleCommunicator, scene: &Scene, Parts { mesh, shape }: Parts) -> Result<Solution> {
    let doubts = Doubts::of(scene, &Outline::of(scene, &mesh), &shape);
    let problem = composition::assemble(comm, scene, (mesh, shape.surface), &Compliances::default())?;
    let Problem { mut strategy, mut tangent, mut u, phases, mut integrator, mesh } = problem;
    let mut collected = Collected { history: vec![first_row(strategy.as_ref())], ends: Vec::new(), bulk: Vec::new() };
    let mut driver = Driver::new(strategy.as_mut(), &mut collected, &phases);
    driver.run(&mut integrator, &mut tangent, &mut u)?;
    let counts = driver.counts();
    let Collected { history, ends, bulk } = collected;
    let after = doubts.after(scene, &history);
    let warnings = doubts.before.into_iter().chain(after).collect();
    Ok(Solution { x: mesh.face().coordinates, history, ends, bulk, counts, warnings })
}

impl Solution {
    /// The last row of the history.
    pub fn last(&self) -> HistoryRow {
        self.history.last().copied().unwrap_or_default()
    }

    /// The row of the history at the end of a phase.
    pub fn end_of(&self, phase: usize) -> HistoryRow {
        self.history.iter().skip(1).rev().find(|row| row.phase == phase).copied().unwrap_or_default()
    }
}

/// The row of the history of a problem at rest, at t = 0.
pub fn first_row(problem: &dyn TransientProblem) -> HistoryRow {
    HistoryRow { heat: heat_row(problem), ..HistoryRow::default() }
}

/// What there is to say of the temperature.
fn heat_row(problem: &dyn TransientProblem) -> HeatRow {
    let of = |&Thermal { highest, mean, energy, .. }: &Thermal| HeatRow { highest, mean, energy };
    problem.thermal().map(of).unwrap_or_default()
}

/// The row of the history that says where a run is. Collective.
pub fn row(report: &mut Report<'_>) -> Result<HistoryRow> {
    let heat = heat_row(report.problem);
    let energy = report.problem.energy().unwrap_or_default();
    let mut contact = report.problem.contact()?;
    let (totals, placement) = (contact.totals()?, contact.placement());
    let [sliding, shear, hysteretic] = [placement.sliding, totals.tangential_force, totals.hysteretic_force];
    let row = HistoryRow {
        time: report.time,
        phase: report.phase,
        approach: placement.approach,
        sliding: sliding.x,
        normal_force: totals.normal_force,
        tangential_force: shear.x,
        hysteretic_force: hysteretic.x,
        contact_fraction: totals.contact_fraction,
        stick_fraction: totals.stick_fraction,
        max_penetration: totals.max_penetration,
        stuck_slip: totals.stuck_slip,
        traction_oscillation: totals.traction_oscillation,
        newton_iterations: report.newton,
        across: Across {
            sliding: sliding.y,
            tangential_force: shear.y,
            hysteretic_force: hysteretic.y,
            mount_tangential: placement.far[2],
        },
        mount_normal: placement.far[0],
        mount_tangential: placement.far[1],
        worn_volume: totals.worn_volume,
        energy,
        heat,
    };
    row.not_finite().map_or(Ok(row), |name| Err(not_finite("history", name, report.time)))
}

/// Who is to have the contact face whole, where each rank has a part of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whole {
    /// The first rank; the others have nothing then.
    OnFirst,
    /// All.
    OnAll,
}

/// The contact face as it is. Collective.
pub fn frame(report: &mut Report<'_>, whole: Whole) -> Result<InterfaceFrame> {
    let thermal = report.problem.thermal();
    let [temperature, heat_flux] =
        thermal.map_or_else(Default::default, |thermal| [thermal.face.clone(), thermal.flux.clone()]);
    let contact = report.problem.contact()?;
    let fields = contact.fields();
    let axes = contact.displacement.len() / fields.pressure.len().max(1);
    let along = |vectors: &[Vector2<f64>]| -> Vec<f64> {
        vectors.iter().flat_map(|vector| vector.iter().take(axes - 1)).copied().collect()
    };
    let component = |i: usize| contact.displacement.iter().skip(i).step_by(axes).copied().collect();
    let team = contact.team();
    let whole = |list: Vec<f64>| match whole {
        Whole::OnFirst => team.collected(list),
        Whole::OnAll => team.shared(list),
    };
    let WornFields { depth, profile } = fields.worn.unwrap_or_default();
    let [displacement_x, displacement_z] = if axes == 2 { [component(0), component(1)] } else { Default::default() };
    let frame = InterfaceFrame {
        time: report.time,
        shear: whole(along(&fields.shear)),
        slip_rate: whole(along(&fields.slip_rate)),
        pressure: whole(fields.pressure),
        gap: whole(fields.gap),
        displacement_x,
        displacement_z,
        displacement: whole(if axes == 3 { contact.displacement.to_vec() } else { Vec::new() }),
        worn_depth: whole(depth),
        worn_profile: whole(profile.unwrap_or_default()),
        temperature,
        heat_flux,
    };
    frame.not_finite().map_or(Ok(()), |name| Err(not_finite("interface", name, report.time)))?;
    Ok(frame)
}

/// The components of displacement and stress that the results have, node by node.
pub fn components(fields: &BulkFields) -> (Vec<f64>, Vec<f64>) {
    if fields.in_space {
        return (fields.displacement.as_flattened().to_vec(), fields.stress.as_flattened().to_vec());
    }
    let displacement = fields.displacement.iter().flat_map(|[x, _, z]| [*x, *z]);
    let stress = fields.stress.iter().flat_map(|[xx, yy, zz, _, _, xz]| [*xx, *zz, *yy, *xz]);
    (displacement.collect(), stress.collect())
}

/// The fields of the bulk as they are, of this rank's nodes.
pub fn bulk(report: &mut Report<'_>) -> Result<BulkFields> {
    let fields = report.problem.bulk_fields(report.u)?;
    let of = |name, values: &[f64]| values.iter().any(|value| !value.is_finite()).then_some(name);
    let bad = of("displacement", fields.displacement.as_flattened()).or(of("stress", fields.stress.as_flattened()));
    let bad = bad.or(of("temperature", &fields.temperature));
    bad.map_or(Ok(fields), |name| Err(not_finite("bulk", name, report.time)))
}

fn not_finite(group: &str, name: &str, time: f64) -> Error {
    Error::Solver(format!(
        "/{group}/{name} is not a finite number at t = {time:.6e} s: the numbers of the scene are too large or too small for \
         what is computed from them"
    ))
}

/// The observer that keeps everything.
struct Collected {
    history: Vec<HistoryRow>,
    ends: Vec<InterfaceFrame>,
    bulk: Vec<BulkFields>,
}

impl Observer for Collected {
    fn observe(&mut self, mut report: Report<'_>) -> Result<()> {
        self.history.push(row(&mut report)?);
        if report.phase_end {
            self.ends.push(frame(&mut report, Whole::OnAll)?);
        }
        if report.bulk_output {
            self.bulk.push(bulk(&mut report)?);
        }
        Ok(())
    }
}
