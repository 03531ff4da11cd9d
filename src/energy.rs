//! The energy balance of a run.
//!
//! ```text
//! work of what moves the indenter = stored + dissipated in the arms + dissipated by friction + worn off + penalty + adhesion
//!                                   + dissipated in jumps + mounts + imbalance
//! ```
//!
//! Each term is computed for itself, so that the imbalance says how well the steps resolve the history. The contact forces
//! are known at the ends of steps, and their work over a step is that of their mean. What the dashpots dissipate is
//!
//! - with the exponential memory, that of a displacement which is linear over the step: the imbalance is of second order in
//!   dt, and of first order only from steps within which a motion sets in;
//! - with backward Euler, that of the rate which they have at the end of the step: it is of first order.

/// The energy balance, J/m, cumulative from t = 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Supplied by the indenter: integral of p (dD - dh) + q.V dt over the face; by the far end and the dead load of a mount.
    pub external_work: f64,
    /// Stored in the springs of the layer.
    pub stored: f64,
    /// Dissipated in the Prony arms.
    pub viscoelastic_dissipation: f64,
    /// Dissipated by friction.
    pub friction_dissipation: f64,
    /// Stored in the penalty.
    pub penalty: f64,
    /// What the pressure did on what it wore off: integral of p dh_w.
    pub wear: f64,
    /// Stored in the attraction since t = 0; what is in contact has given away its work of adhesion.
    pub adhesion: f64,
    /// What attraction did on the gaps beyond what it stored, at the mean traction of each step: what jumps dissipate.
    pub jumps: f64,
    /// In the mounts.
    pub mounts: MountEnergy,
    /// What the others leave over of the work.
    pub imbalance: f64,
}

/// In the mounts, J/m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MountEnergy {
    /// Stored in their springs.
    pub spring: f64,
    /// Dissipated in their dashpots since t = 0.
    pub dashpot: f64,
    /// Of their masses.
    pub kinetic: f64,
}

/// The balance of heat, J/m, since t = 0: entered = stored + convected + conducted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HeatEnergy {
    /// From friction, and from the arms where these heat.
    pub entered: f64,
    /// What the body holds more than at first.
    pub stored: f64,
    /// Given to the air beside the contact.
    pub convected: f64,
    /// Given to the base.
    pub conducted: f64,
}

/// The share of the body, J/m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyEnergy {
    /// In its springs.
    pub stored: f64,
    /// In its dashpots, since t = 0.
    pub dissipated: f64,
}

/// The share of the contact face, J/m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FaceEnergy {
    /// Supplied by the indenter since t = 0.
    pub work: f64,
    /// Dissipated by friction since t = 0.
    pub friction: f64,
    /// In the penalty.
    pub penalty: f64,
    /// What the pressure did on what it wore off since t = 0.
    pub wear: f64,
    /// See [`Energy::adhesion`].
    pub adhesion: f64,
    /// See [`Energy::jumps`].
    pub jumps: f64,
    /// In the mounts.
    pub mounts: MountEnergy,
}

impl Energy {
    /// The balance of the two shares.
    pub fn new(face: FaceEnergy, body: BodyEnergy) -> Self {
        let FaceEnergy { work, friction, penalty, wear, adhesion, jumps, mounts } = face;
        let MountEnergy { spring, dashpot, kinetic } = mounts;
        let BodyEnergy { stored, dissipated } = body;
        Self {
            external_work: work,
            stored,
            viscoelastic_dissipation: dissipated,
            friction_dissipation: friction,
            penalty,
            wear,
            adhesion,
            jumps,
            mounts,
            imbalance: work
                - stored
                - dissipated
                - friction
                - penalty
                - wear
                - adhesion
                - jumps
                - spring
                - dashpot
                - kinetic,
        }
    }
}
