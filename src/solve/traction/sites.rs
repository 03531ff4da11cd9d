//! All points of the contact during a step, on this rank.

use std::ops::Deref;
use std::rc::Rc;

use super::Site;
use crate::parallel::Team;

/// The points of this rank, and what they come to with those of the others.
#[derive(Clone)]
pub struct Sites<const D: usize> {
    all: Vec<Site<D>>,
    team: Rc<Team>,
    area: f64,
    modulus: f64,
    count: f64,
}

impl<const D: usize> Sites<D> {
    /// The points that the ranks of a team share. Collective.
    pub fn new(all: Vec<Site<D>>, team: Rc<Team>) -> Self {
        let area = all.iter().map(|site| site.weight).sum();
        let moduli = all.iter().map(|site| site.moduli.normal).sum();
        let [area, moduli, count] = team.sum([area, moduli, all.len() as f64]);
        Self { all, team, area, modulus: moduli / count.max(1.0), count }
    }

    /// None.
    pub fn none() -> Self {
        Self::new(Vec::new(), Team::alone())
    }

    /// Each of this rank, to change what no total depends on.
    pub fn each(&mut self) -> std::slice::IterMut<'_, Site<D>> {
        self.all.iter_mut()
    }

    /// The ranks that share them.
    pub fn team(&self) -> &Team {
        &self.team
    }

    /// Length, or area, of the face.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// kappa: the mean of the points' own moduli.
    pub fn modulus(&self) -> f64 {
        self.modulus
    }

    /// How many there are on all ranks.
    pub fn everywhere(&self) -> f64 {
        self.count
    }
}

impl<const D: usize> From<Vec<Site<D>>> for Sites<D> {
    fn from(all: Vec<Site<D>>) -> Self {
        Self::new(all, Team::alone())
    }
}

impl<'a, const D: usize> IntoIterator for &'a Sites<D> {
    type Item = &'a Site<D>;
    type IntoIter = std::slice::Iter<'a, Site<D>>;

    fn into_iter(self) -> Self::IntoIter {
        self.all.iter()
    }
}

impl<const D: usize> Deref for Sites<D> {
    type Target = [Site<D>];

    fn deref(&self) -> &[Site<D>] {
        &self.all
    }
}
