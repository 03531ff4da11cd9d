//! Results: the HDF5 file and the XDMF file beside it.
//!
//! # A file that is valid at every moment
//!
//! A run may be killed while it writes, and the file must still open. The HDF5 library gives no such promise: its
//! flush is a series of writes, and between two of them the file can refer to what is not there yet. So the library
//! only makes the file, under another name: every dataset at its planned number of rows, in one chunk, with its room
//! set aside but not filled (`skeleton.rs`). Then the number of rows is set to what is really there (one row of the
//! history), and the file is renamed to its place.
//!
//! After that the library is not used any more. Adding rows is (1) writing numbers into room that no extent covers
//! yet and (2) one write of the few kilobytes that hold all extents, which stand close together because metadata
//! has a block of its own. The system takes pages whole, so that each extent is old or new, never a mixture, and the
//! rows it uncovers are there. Between two pages of that write a kill can leave one dataset ahead of another by the
//! rows of one flush; `time` is the last of its group, so that every row it counts is complete.
//!
//! Bulk fields follow the same rule: all ranks write their numbers, agree that all went well, and then one rank makes
//! the frame visible.
//!
//! The file is at all times one that the library itself could have written. No handle stays open and no lock is
//! held, so it can be read while the run goes on.
//!
//! When more rows come than were planned, the file is copied, extended and renamed into place. So it is when the history gives
//! warnings at the end of a run.
//!
//! A run that is complete has its fields compressed: the library writes all anew under another name, which is renamed to
//! its place (`pack.rs`).

pub mod bulk;
pub mod checkpoint;
pub mod clock;
pub mod reader;

mod columns;
mod locate;
pub mod ours;
mod pack;
mod recorder;
mod resume;
mod scales;
pub mod scratch;
mod skeleton;
mod state;
pub mod steady;
mod store;
mod xdmf;

use std::time::SystemTime;

pub use columns::{Across, Extra, HeatRow, HistoryRow, InterfaceFrame, is_vector};
pub use recorder::Recorder;
pub use resume::{Left, intact, left};

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All phases were solved.
    Complete,
    /// A signal, a kill or an error ended the run early.
    Stopped,
    /// The solver gave up.
    NotConverged,
}

impl Status {
    /// Every status, in the order of the root attribute `status_values`.
    pub const ALL: [Self; 3] = [Self::Complete, Self::Stopped, Self::NotConverged];

    /// The text of the root attribute `status`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Stopped => "stopped",
            Self::NotConverged => "not converged",
        }
    }
}

/// What the root attributes say about a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Metadata {
    /// The scene's title.
    pub title: String,
    /// The resolved scene, whole, as TOML.
    pub scene: String,
    /// The content of the files that the scene names; see [`crate::composition::inputs`].
    pub inputs: String,
    /// Version of this program.
    pub version: String,
    /// The commit it was built from.
    pub git_commit: String,
    /// Version of PETSc.
    pub petsc_version: String,
    /// MPI ranks of the run.
    pub ranks: usize,
    /// When the run started; `wall_seconds` counts from here.
    pub started: SystemTime,
    /// What is doubtful before it, each as `KEY: text`.
    pub warnings: Vec<String>,
}

/// What is going to be recorded. Numbers of rows are estimates: generous ones cost no disk space, short ones cost a
/// copy of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plan {
    /// Rows of the history, row 0 included.
    pub history_rows: usize,
    /// Names of the phases.
    pub phase_names: Vec<String>,
    /// Which columns the history has besides those that all have.
    pub extra: Extra,
    /// Rows of the interface fields.
    pub interface_rows: usize,
    /// The nodes of the contact face; m of them.
    pub face: FacePlan,
    /// Bulk fields; none = no group `/bulk` and no XDMF file.
    pub bulk: Option<BulkPlan>,
}

/// The nodes of a contact face.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FacePlan {
    /// Whether it has two directions, x and y, rather than x alone.
    pub in_space: bool,
    /// Undeformed x, in space x and y, m, node after node.
    pub coordinates: Vec<f64>,
    /// In space, how many nodes there are along x and y where they make a grid, y fastest; else empty.
    pub grid: Vec<usize>,
}

impl FacePlan {
    /// Along x.
    pub fn along_x(coordinates: Vec<f64>) -> Self {
        Self { coordinates, ..Self::default() }
    }

    /// How many nodes there are.
    pub fn nodes(&self) -> usize {
        self.coordinates.len() / (self.axes() - 1)
    }

    /// Components of the displacement of a node.
    fn axes(&self) -> usize {
        if self.in_space { 3 } else { 2 }
    }
}

/// Rows of a result file that are there to stay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rows {
    /// Of the history.
    pub history: usize,
    /// Of the interface fields.
    pub interface: usize,
    /// Bulk frames.
    pub bulk: usize,
    /// Sums of their numbers, which tell whether a file still is what was written.
    pub sums: [u64; 3],
}

impl Rows {
    /// Of the history, of the interface fields, bulk frames.
    fn counts(&self) -> [usize; 3] {
        [self.history, self.interface, self.bulk]
    }
}

/// The mesh and the number of the bulk fields to come.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BulkPlan {
    /// Frames.
    pub frames: usize,
    /// Coordinates of a node, and components of a displacement: 2 (x, z) or 3 (x, y, z).
    pub axes: usize,
    /// Undeformed coordinates of all nodes, m, node after node.
    pub coordinates: Vec<f64>,
    /// Nodes of a cell: 4, or in space 8, or 4 where all are tetrahedra.
    pub corners: usize,
    /// The nodes of each cell, from 0, cell after cell; those of a quadrilateral counter-clockwise.
    pub cells: Vec<i64>,
}
