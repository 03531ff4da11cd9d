//! What keeps a law from being exact: the penalty, and what friction is regularised by.

use crate::scene::{Law, Scene};

/// A softness, which has an exact law for its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Softness {
    /// Of the contact: a penalty.
    Penalty,
    /// Of friction: a slip rate.
    Regularisation,
    /// Of friction: a slip.
    ElasticSlip,
}

impl Softness {
    /// All.
    pub const ALL: [Self; 3] = [Self::Penalty, Self::Regularisation, Self::ElasticSlip];

    /// Which one a key of a scene is of.
    pub fn of(key: &str) -> Option<Self> {
        match key {
            "contact.penalty" | "contact.tolerance" => Some(Self::Penalty),
            "friction.regularisation" => Some(Self::Regularisation),
            "friction.elastic_slip" => Some(Self::ElasticSlip),
            _ => None,
        }
    }

    /// Whether the law of a scene is exact where it would be.
    pub fn is_none(self, scene: &Scene) -> bool {
        match self {
            Self::Penalty => scene.contact.penalty.is_none(),
            Self::Regularisation | Self::ElasticSlip => {
                scene.friction.as_ref().is_some_and(|friction| friction.law == Law::Coulomb)
            }
        }
    }

    /// The change of a scene, `key=value` as after `--set`, that its key needs beside it.
    pub fn law(self, scene: &Scene) -> Option<String> {
        let law = match self {
            Self::Penalty => return None,
            Self::Regularisation => "coulomb_tanh",
            Self::ElasticSlip => "coulomb_elastic_slip",
        };
        self.is_none(scene).then(|| format!("friction.law={law}"))
    }

    /// The changes that leave the law itself.
    pub fn taken_out(self) -> Vec<String> {
        let changes = match self {
            Self::Penalty => vec!["contact.penalty=", "contact.tolerance=", "contact.method="],
            Self::Regularisation => vec!["friction.law=coulomb", "friction.regularisation="],
            Self::ElasticSlip => vec!["friction.law=coulomb", "friction.elastic_slip="],
        };
        changes.into_iter().map(str::to_owned).collect()
    }
}
