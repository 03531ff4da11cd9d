//! A contact that wears: the points of a body recede, the profile of an indenter rises in its own frame.

use nalgebra::Vector2;

use super::{Interface, Laws, Point, State};
use crate::error::Result;
use crate::loading::Placement;
use crate::mesh::Grid;
use crate::profile::{Height, Surface};
use crate::snapshot::Snapshot;
use crate::wear::{Part, Wear, Worn};

/// What has worn off, at the face's nodes; off the indenter at the same x in its own frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WornFields {
    /// m
    pub depth: Vec<f64>,
    /// h with what has worn off it, m; only of an indenter.
    pub profile: Option<Vec<f64>>,
}

impl Laws {
    /// Nothing, off an indenter that is to wear over a face whose nodes make a grid.
    pub(super) fn worn(&self, grid: Option<&Grid>) -> Option<Worn> {
        self.wear.filter(|wear| wear.of == Part::Indenter)?;
        grid.map(Worn::new)
    }

    /// With `worn` off the profile.
    pub(super) fn surface<'a>(&'a self, worn: Option<&'a Worn>) -> WornSurface<'a> {
        WornSurface { profile: self.profile.as_ref(), worn }
    }
}

/// The profile, and what has worn off it.
pub(super) struct WornSurface<'a> {
    profile: &'a dyn Surface,
    worn: Option<&'a Worn>,
}

impl Surface for WornSurface<'_> {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let Height { height, gradient } = self.profile.at(place)?;
        let Some(worn) = self.worn else { return Ok(Height { height, gradient }) };
        let depth = worn.at(place);
        Ok(Height { height: height + depth.height, gradient: gradient + depth.gradient })
    }
}

impl<const D: usize> Interface<D> {
    /// The law of wear.
    pub fn wear(&self) -> Option<Wear> {
        self.laws.wear
    }

    /// What has worn off the body at a point up to the accepted state, m.
    pub fn recession(&self, i: usize) -> f64 {
        if self.worn.is_none() { self.accepted[i].worn } else { 0.0 }
    }

    /// Whether the profile changes as it wears.
    pub fn reshapes(&self) -> bool {
        self.worn.is_some()
    }

    /// The integral of the worn depth, m^2 (m^3 in space). Collective.
    pub(super) fn worn_volume(&self) -> f64 {
        let of_body = || -> f64 {
            let worn = self.points.all().iter().zip(&self.accepted).map(|(point, state)| point.weight * state.worn);
            let [volume] = self.team().sum([worn.sum()]);
            volume
        };
        self.worn.as_ref().map_or_else(of_body, Worn::volume)
    }

    /// Takes off the indenter what a step to `states` has worn. Collective.
    pub(super) fn wear_off(&mut self, placement: Placement, states: &[State<D>]) {
        let Some(worn) = &mut self.worn else { return };
        let mut taken = Vec::new();
        for ((point, before), after) in self.points.all().iter().zip(&self.accepted).zip(states) {
            if after.worn > before.worn {
                let place = point.along() - placement.sliding;
                taken.extend([place.x, place.y, point.weight * (after.worn - before.worn)]);
            }
        }
        // Every rank knows the whole indenter, and takes off it what all have worn, in the same order.
        let all = self.points.team().shared(taken);
        all.as_chunks().0.iter().for_each(|&[x, y, volume]| worn.take(Vector2::new(x, y), volume));
        // Its shape is another one.
        self.points.forget();
    }

    /// See [`Fields::worn`]; points are nodes where something wears.
    pub(super) fn worn_fields(&self) -> Option<WornFields> {
        self.laws.wear?;
        let Some(worn) = &self.worn else {
            return Some(WornFields { depth: self.accepted.iter().map(|state| state.worn).collect(), profile: None });
        };
        let own = |point: &Point<D>| worn.at(point.along()).height;
        let depth: Vec<f64> = self.points.all().iter().map(own).collect();
        // A profile that is not known there has no height.
        let height = |point: &Point<D>| self.laws.profile.at(point.along()).map_or(f64::NAN, |height| height.height);
        let profile = self.points.all().iter().zip(&depth).map(|(point, depth)| height(point) + depth).collect();
        Some(WornFields { depth, profile: Some(profile) })
    }

    /// Adds what has worn off the indenter to a snapshot.
    pub(super) fn save_worn(&self, snapshot: &mut Snapshot) {
        if let Some(worn) = &self.worn {
            snapshot.put("worn", worn.numbers());
        }
    }

    /// Takes it from a snapshot.
    pub(super) fn restore_worn(&mut self, snapshot: &Snapshot) -> Result<()> {
        let Some(worn) = &mut self.worn else { return Ok(()) };
        self.points.forget();
        worn.restore(snapshot.get("worn")?)
    }
}
