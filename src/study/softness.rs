//! What keeps a law from being exact: the penalty, and what friction is regularised by.

use crate::friction::{KINDS, Kind};
use crate::scene::Scene;

/// A softness, which has an exact law for its limit.
#[derive(Debug, Clone, Copy)]
pub enum Softness {
    /// Of the contact: a penalty.
    Penalty,
    /// Of friction: what this law is softened by.
    Friction(&'static Kind),
}

impl Softness {
    /// Which one a key of a scene is of.
    pub fn of(key: &str) -> Option<Self> {
        if matches!(key, "contact.penalty" | "contact.tolerance") {
            return Some(Self::Penalty);
        }
        let kind = KINDS.into_iter().find(|kind| Some(key) == key_of(kind).as_deref())?;
        Some(Self::Friction(kind))
    }

    /// Whether the law of a scene is exact where it would be.
    pub fn is_none(self, scene: &Scene) -> bool {
        match self {
            Self::Penalty => scene.contact.penalty.is_none(),
            Self::Friction(_) => scene.friction.as_ref().is_some_and(|friction| friction.law.is_exact()),
        }
    }

    /// Whether any law of a scene is exact.
    pub fn lacks(scene: &Scene) -> bool {
        let friction = scene.friction.as_ref().is_some_and(|friction| friction.law.is_exact());
        Self::Penalty.is_none(scene) || friction
    }

    /// The change of a scene, `key=value` as after `--set`, that its key needs beside it.
    pub fn law(self, scene: &Scene) -> Option<String> {
        match self {
            Self::Penalty => None,
            Self::Friction(kind) => self.is_none(scene).then(|| format!("friction.law={}", kind.name)),
        }
    }

    /// The changes that leave the law itself.
    pub fn taken_out(self) -> Vec<String> {
        match self {
            Self::Penalty => ["contact.penalty=", "contact.tolerance=", "contact.method="].map(str::to_owned).to_vec(),
            Self::Friction(kind) => {
                let exact = KINDS.into_iter().filter(|kind| kind.softness.is_none());
                let law = exact.map(|kind| format!("friction.law={}", kind.name));
                law.chain(key_of(kind).map(|key| format!("{key}="))).collect()
            }
        }
    }
}

/// The key of what a law is softened by, in a scene.
fn key_of(kind: &Kind) -> Option<String> {
    kind.softness.as_ref().map(|softness| format!("friction.{}", softness.key))
}
