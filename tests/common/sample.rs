//! A small run's worth of results, every number of which follows from its row.

use std::time::SystemTime;

use mpjr::energy::{Energy, HeatEnergy, MountEnergy};
use mpjr::output::{Across, BulkPlan, Extra, FacePlan, HeatRow, HistoryRow, InterfaceFrame, Metadata, Plan};

/// Nodes of the contact face.
pub const FACE: usize = 5;

pub fn metadata() -> Metadata {
    Metadata {
        title: "Größe m²".into(),
        // Longer than the 64 KiB that an attribute holds in place.
        scene: "title = \"x\" # ".to_owned() + &"é".repeat(100_000),
        inputs: "mesh.file 0123456789abcdef\n".into(),
        version: "0.1.0".into(),
        git_commit: "abcdef".into(),
        petsc_version: "3.18.5".into(),
        ranks: 3,
        warnings: Vec::new(),
        started: SystemTime::now(),
    }
}

pub fn plan(rows: usize, bulk_frames: usize) -> Plan {
    Plan {
        history_rows: rows,
        phase_names: vec!["indent".into(), "slide".into()],
        extra: Extra::ALL,
        interface_rows: rows,
        face: FacePlan::along_x((0..FACE).map(|i| i as f64 / 4.0).collect()),
        bulk: (bulk_frames > 0).then(|| mesh(6, 4, bulk_frames)),
    }
}

/// A rectangle of `nx` x `nz` cells of the unit square.
pub fn mesh(nx: usize, nz: usize, frames: usize) -> BulkPlan {
    let node = |i: usize, k: usize| (k * (nx + 1) + i) as i64;
    BulkPlan {
        frames,
        axes: 2,
        coordinates: (0..=nz)
            .flat_map(|k| (0..=nx).flat_map(move |i| [i as f64 / nx as f64, k as f64 / nz as f64 - 1.0]))
            .collect(),
        corners: 4,
        cells: (0..nz)
            .flat_map(|k| (0..nx).flat_map(move |i| [node(i, k), node(i + 1, k), node(i + 1, k + 1), node(i, k + 1)]))
            .collect(),
    }
}

/// Row `i` of the history; row 0 is the unloaded state.
pub fn row(i: usize) -> HistoryRow {
    let v = i as f64;
    HistoryRow {
        time: v,
        phase: i % 2,
        approach: 2.0 * v,
        sliding: 3.0 * v,
        normal_force: 4.0 * v,
        tangential_force: 5.0 * v,
        hysteretic_force: 6.0 * v,
        contact_fraction: 7.0 * v,
        stick_fraction: 8.0 * v,
        max_penetration: 9.0 * v,
        stuck_slip: 18.0 * v,
        newton_iterations: 10 * i,
        traction_oscillation: 17.0 * v,
        across: Across::default(),
        mount_normal: 22.0 * v,
        mount_tangential: 23.0 * v,
        worn_volume: 24.0 * v,
        energy: Energy {
            external_work: 11.0 * v,
            stored: 12.0 * v,
            viscoelastic_dissipation: 13.0 * v,
            friction_dissipation: 14.0 * v,
            penalty: 15.0 * v,
            wear: 25.0 * v,
            adhesion: 32.0 * v,
            jumps: 33.0 * v,
            imbalance: 16.0 * v,
            mounts: MountEnergy { spring: 19.0 * v, dashpot: 20.0 * v, kinetic: 21.0 * v },
        },
        heat: HeatRow {
            highest: 26.0 * v,
            mean: 27.0 * v,
            energy: HeatEnergy { entered: 28.0 * v, stored: 29.0 * v, convected: 30.0 * v, conducted: 31.0 * v },
        },
    }
}

/// The real columns of [`row`] other than time, with their factors.
pub const COLUMNS: [(&str, f64); 32] = [
    ("energy/adhesion", 32.0),
    ("energy/jumps", 33.0),
    ("energy/wear", 25.0),
    ("worn_volume", 24.0),
    ("max_temperature", 26.0),
    ("mean_temperature", 27.0),
    ("energy/heat", 28.0),
    ("energy/heat_stored", 29.0),
    ("energy/heat_convected", 30.0),
    ("energy/heat_conducted", 31.0),
    ("energy/mount_spring", 19.0),
    ("energy/mount_dashpot", 20.0),
    ("energy/kinetic", 21.0),
    ("mount_normal", 22.0),
    ("mount_tangential", 23.0),
    ("approach", 2.0),
    ("sliding", 3.0),
    ("normal_force", 4.0),
    ("tangential_force", 5.0),
    ("hysteretic_force", 6.0),
    ("contact_fraction", 7.0),
    ("stick_fraction", 8.0),
    ("max_penetration", 9.0),
    ("newton_iterations", 10.0),
    ("traction_oscillation", 17.0),
    ("stuck_slip", 18.0),
    ("energy/external_work", 11.0),
    ("energy/stored", 12.0),
    ("energy/viscoelastic_dissipation", 13.0),
    ("energy/friction_dissipation", 14.0),
    ("energy/penalty", 15.0),
    ("energy/imbalance", 16.0),
];

/// Row `i` of the interface fields at face nodes 0, 1, ...: field number f (1 to 10) is 1000 f i + node.
pub fn frame(i: usize, face: usize) -> InterfaceFrame {
    let field = |f: usize| (0..face).map(|node| (1000 * f * i + node) as f64).collect();
    InterfaceFrame {
        time: i as f64,
        pressure: field(1),
        shear: field(2),
        gap: field(3),
        slip_rate: field(4),
        displacement_x: field(5),
        displacement_z: field(6),
        displacement: Vec::new(),
        worn_depth: field(7),
        worn_profile: field(8),
        temperature: field(9),
        heat_flux: field(10),
    }
}

/// The fields of [`frame`], in the order of their number f.
pub const FIELDS: [&str; 10] = [
    "pressure",
    "shear",
    "gap",
    "slip_rate",
    "displacement_x",
    "displacement_z",
    "worn_depth",
    "worn_profile",
    "temperature",
    "heat_flux",
];
