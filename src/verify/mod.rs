//! Fresh solves against known answers: what `mpjr verify` runs.
//!
//! A case is a few subjects, each a scene that is solved like any other, and a comparison of what came out with
//! [`crate::oracle`], which shares no code with the finite elements. A tolerance is what the stated reason allows at
//! that resolution: an error of discretisation that a coarser mesh predicts, the spacing of nodes at a contact's edge,
//! the memory's error at that step, or the tolerance of the solver. It is not what happened to be found.

mod adhesion;
mod appendix_a;
mod curve;
mod half_space;
mod heat;
mod kernel;
mod load;
mod mount;
mod relaxation;
mod setting;
mod sliding;
mod steady;
mod tangential;
mod wear;

use std::fmt;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::error::{Error, Result};
use crate::parallel::agree;
use crate::scene::Scene;
use crate::solution::{self, Solution};

pub use setting::Setting;

/// A scene, or several that belong together, with a known answer.
pub struct Case {
    /// Its name.
    pub name: String,
    /// Where the answer comes from.
    pub source: &'static str,
    /// What is solved.
    pub subjects: Vec<Subject>,
    /// Compares the solutions, in the order of the subjects, with the answer.
    pub compare: Compare,
}

/// Something to be solved.
pub enum Subject {
    /// A layer by its numbers.
    Layer(Box<Setting>),
    /// A scene and the .msh file that it names.
    Scene(Box<Scene>, &'static [u8]),
}

impl From<Setting> for Subject {
    fn from(setting: Setting) -> Self {
        Self::Layer(Box::new(setting))
    }
}

impl Subject {
    fn solve(&self, comm: &SimpleCommunicator) -> Result<Solution> {
        match self {
            Self::Layer(setting) => solution::solve(comm, &setting.scene()?),
            Self::Scene(scene, mesh) => solution::solve_on_mesh(comm, scene, mesh),
        }
    }
}

/// See [`Case::compare`].
pub type Compare = Box<dyn Fn(&[Solution]) -> Result<Vec<Row>>>;

/// One quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What it is, with its unit.
    pub quantity: String,
    /// By the finite elements.
    pub computed: f64,
    /// By the oracle.
    pub exact: f64,
    /// The largest difference that passes, in the quantity's unit.
    pub tolerance: f64,
    /// What the tolerance is for.
    pub reason: &'static str,
}

impl Row {
    /// A comparison with a tolerance in the unit of the quantity.
    pub fn new(quantity: impl Into<String>, [computed, exact]: [f64; 2], tolerance: f64, reason: &'static str) -> Self {
        Self { quantity: quantity.into(), computed, exact, tolerance, reason }
    }

    /// A comparison with a tolerance relative to the exact value.
    pub fn relative(quantity: impl Into<String>, values: [f64; 2], tolerance: f64, reason: &'static str) -> Self {
        Self::new(quantity, values, tolerance * values[1].abs(), reason)
    }

    /// A quantity on a mesh, on one of half the cells, and exactly, where the error is of second order: the coarser
    /// mesh predicts an error of a third of the difference; twice that passes.
    pub fn refined(quantity: impl Into<String>, [fine, coarse]: [f64; 2], exact: f64) -> Self {
        let predicted = (fine - coarse).abs() / 3.0;
        Self::new(quantity, [fine, exact], 2.0 * predicted, "mesh: twice the error that half the cells predict")
    }

    /// A quantity with steps and cells, with twice as long ones, and exactly, where the error is of first order: the coarser answer
    /// predicts an error of the whole difference; twice that passes.
    pub fn halved(quantity: impl Into<String>, [fine, coarse]: [f64; 2], exact: f64) -> Self {
        Self::new(
            quantity,
            [fine, exact],
            2.0 * (fine - coarse).abs(),
            "steps: twice the error that half of them predict",
        )
    }

    /// The order of convergence of a quantity that two meshes, one of half the cells of the other, approximate.
    pub fn order(quantity: impl Into<String>, [fine, coarse]: [f64; 2], exact: f64) -> Self {
        let order = ((coarse - exact) / (fine - exact)).abs().log2();
        Self::new(quantity, [order, 2.0], 0.2, "not yet asymptotic")
    }

    /// A comparison limited by how well the mesh resolves: see [`resolution`].
    pub fn resolved(quantity: impl Into<String>, values: [f64; 2], resolution: f64) -> Self {
        Self::relative(quantity, values, resolution, MESH)
    }

    /// Computed less exact.
    pub fn difference(&self) -> f64 {
        self.computed - self.exact
    }

    /// Whether the difference is within the tolerance; never for what is not a number.
    pub fn passes(&self) -> bool {
        self.difference().abs() <= self.tolerance
    }
}

/// The reason of a tolerance by [`resolution`].
pub const MESH: &str = "mesh: (k h)^2/6, k = pi/contact width";

/// The relative error that bilinear elements of size h make of a pressure over a contact of a given width, taken for
/// half a wave: (k h)^2/6.
///
/// The cases of the bonded layer measure, for k h = 2 pi/64, errors of the compliances from (k h)^2/40 to (k h)^2/5 (the
/// largest for C_xx, next to incompressible) of that of the normal one.
pub fn resolution(h: f64, width: f64) -> f64 {
    (std::f64::consts::PI * h / width).powi(2) / 6.0
}

/// How many passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Rows within their tolerance.
    pub passed: usize,
    /// Rows outside.
    pub failed: usize,
}

impl Tally {
    /// Counts rows in.
    pub fn add(&mut self, rows: &[Row]) {
        let passed = rows.iter().filter(|row| row.passes()).count();
        self.passed += passed;
        self.failed += rows.len() - passed;
    }

    /// An error if anything failed, or nothing was compared.
    pub fn verdict(&self) -> Result<()> {
        match (self.passed, self.failed) {
            (0, 0) => Err(Error::Mismatch("nothing was compared".into())),
            (_, 0) => Ok(()),
            (_, failed) => Err(Error::Mismatch(format!("{failed} quantities differ by more than their tolerance"))),
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed", self.passed, self.failed)
    }
}

/// All cases, or those that take little time.
pub fn cases(quick: bool) -> Result<Vec<Case>> {
    let mut list = kernel::cases(quick);
    list.extend(half_space::cases(quick));
    list.extend(tangential::cases(quick));
    if !quick {
        list.extend(appendix_a::cases()?);
    }
    list.extend(relaxation::cases(quick));
    list.extend(steady::cases(quick));
    list.extend(curve::cases(quick));
    list.extend(sliding::cases(quick));
    list.extend(load::cases(quick));
    list.extend(mount::cases(quick));
    list.extend(wear::cases(quick));
    list.extend(adhesion::cases());
    list.extend(heat::cases(quick)?);
    Ok(list)
}

/// Solves a case on all ranks and compares; all ranks get the same rows. A scene that does not converge is a row that
/// fails.
pub fn solve(comm: &SimpleCommunicator, case: &Case) -> Result<Vec<Row>> {
    let rows = match case.subjects.iter().map(|subject| subject.solve(comm)).collect::<Result<Vec<_>>>() {
        Ok(solutions) if comm.rank() == 0 => (case.compare)(&solutions),
        Ok(_) => Ok(Vec::new()),
        Err(error) => Err(error),
    };
    match agree(comm, rows) {
        Ok(rows) => share(comm, rows),
        Err(Error::Solver(text) | Error::Domain(text)) => Ok(vec![Row::new(text, [f64::NAN; 2], 0.0, "")]),
        Err(other) => Err(other),
    }
}

/// Gives all ranks the numbers of rank 0's rows.
fn share(comm: &SimpleCommunicator, mut rows: Vec<Row>) -> Result<Vec<Row>> {
    use mpi::traits::Root;
    let root = comm.process_at_rank(0);
    let mut numbers: Vec<f64> = rows.iter().flat_map(|row| [row.computed, row.exact, row.tolerance]).collect();
    let mut length = numbers.len();
    root.broadcast_into(&mut length);
    numbers.resize(length, 0.0);
    root.broadcast_into(&mut numbers[..]);
    if comm.rank() != 0 {
        let row = |n: &[f64]| Row::new("", [n[0], n[1]], n[2], "");
        rows = numbers.chunks_exact(3).map(row).collect();
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_beyond_the_tolerance_fails() {
        let row = |computed, tolerance| Row::new("N_z", [computed, 1.0], tolerance, "");
        assert!(row(1.01, 0.011).passes() && row(0.99, 0.011).passes() && row(1.0, 0.0).passes());
        assert!(!row(1.01, 0.009).passes() && !row(0.99, 0.009).passes());
        assert!(!row(f64::NAN, 1.0).passes() && !row(1.0, f64::NAN).passes() && !row(f64::INFINITY, 1.0).passes());
        assert!(Row::relative("Q_x", [-2.0, -2.1], 0.05, "").passes());
        assert!(!Row::relative("Q_x", [2.0, -2.0], 0.05, "").passes());
    }

    /// Twice the predicted error passes, three times does not; the order of a first-order answer is not two.
    #[test]
    fn a_coarser_mesh_predicts_the_tolerance() {
        assert!(Row::refined("C", [1.01, 1.04], 1.0).passes());
        assert!(!Row::refined("C", [1.01, 1.04], 0.98).passes());
        assert!(Row::order("C", [1.01, 1.04], 1.0).passes());
        assert!(!Row::order("C", [1.01, 1.02], 1.0).passes());
    }

    #[test]
    fn one_failure_is_an_error_and_so_is_an_empty_table() {
        let mut tally = Tally::default();
        assert!(tally.verdict().is_err());
        tally.add(&[Row::new("a", [1.0, 1.0], 0.0, "")]);
        assert_eq!(tally.verdict(), Ok(()));
        tally.add(&[Row::new("b", [1.0, 2.0], 0.5, ""), Row::new("c", [1.0, 1.0], 0.5, "")]);
        assert_eq!(tally, Tally { passed: 2, failed: 1 });
        assert_eq!(tally.verdict().map_err(|error| error.exit_code()), Err(1));
    }
}
