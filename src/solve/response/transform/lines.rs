//! Along the lines of nodes, and the exchange of columns among the ranks that share them.

use std::ops::Range;

use rustfft::num_complex::Complex;

use super::{Passing, Room, Transform, transform_failed};
use crate::error::Result;

impl<const D: usize> Transform<D> {
    /// Where in `others` the columns of each rank stand, and in `spectra` the lines of each.
    fn parts(&self, passing: &Passing) -> [Vec<Range<usize>>; 2] {
        let [ranks, rank] = self.team.ranks();
        let (count, own) = (passing.count(), self.own().len());
        let mut first = 0;
        let columns = (0..ranks).map(|other| {
            let width = if other == rank { 0 } else { self.starts[other + 1] - self.starts[other] };
            let begins = first;
            first += width * count * self.here.len();
            begins..first
        });
        let columns = columns.collect();
        let lines = |other: usize| {
            let lines = self.team.lines_of(other);
            lines.start * count * own..lines.end * count * own
        };
        [columns, (0..ranks).map(lines).collect()]
    }

    /// The pieces of a line of waves, rank by rank: which columns, and where they stand in `others`; none of this rank, whose stand in
    /// `spectra`.
    fn pieces<'a>(
        &'a self,
        (line, component): (usize, usize),
        passing: &'a Passing,
        columns: &'a [Range<usize>],
    ) -> impl Iterator<Item = (Range<usize>, Option<usize>)> + 'a {
        let [_, rank] = self.team.ranks();
        columns.iter().enumerate().map(move |(other, place)| {
            let range = self.starts[other]..self.starts[other + 1];
            let at = (line * passing.count() + passing.place(component)) * range.len();
            (range, (other != rank).then_some(place.start + at))
        })
    }

    /// Along each line: `put` writes what it has of a component on a line, and says whether that is not nothing, which is not
    /// transformed.
    pub(super) fn lines_there(
        &self,
        (from, passing): (&[bool; D], &Passing),
        room: &mut Room<D>,
        put: impl Fn(usize, usize, &mut [f64]) -> bool,
    ) -> Result<()> {
        self.count(from);
        let (width, parted) = (self.own().len(), self.team.is_parted());
        let Room { spectra, others, row, spectrum, scratch, .. } = room;
        let scratch = &mut scratch[..self.forward.get_scratch_len()];
        let [columns, lines] = if parted { self.parts(passing) } else { Default::default() };
        for line in 0..self.here.len() {
            for component in (0..D).filter(|&component| from[component]) {
                let some = put(line, component, row);
                let own = ((self.here.start + line) * passing.count() + passing.place(component)) * width;
                let own = &mut spectra[own..][..width];
                if !parted {
                    match some {
                        true => self.forward.process_with_scratch(row, own, scratch).map_err(transform_failed)?,
                        false => own.fill(Complex::default()),
                    }
                    continue;
                }
                match some {
                    true => self.forward.process_with_scratch(row, spectrum, scratch).map_err(transform_failed)?,
                    false => spectrum.fill(Complex::default()),
                }
                for (range, at) in self.pieces((line, component), passing, &columns) {
                    let to = at.map_or(&mut own[..], |at| &mut others[at..][..range.len()]);
                    to.copy_from_slice(&spectrum[range]);
                }
            }
        }
        self.team.exchange((others, &columns), (spectra, &lines));
        Ok(())
    }

    /// Back along each line that is `wanted`: `take` is given what is on it of a component, times the number of nodes.
    pub(super) fn lines_back(
        &self,
        (to, passing): (&[bool; D], &Passing),
        room: &mut Room<D>,
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, usize, &[f64]),
    ) -> Result<()> {
        self.count(to);
        let half = self.half();
        let (width, parted) = (self.own().len(), self.team.is_parted());
        let Room { spectra, others, row, spectrum, scratch, .. } = room;
        let scratch = &mut scratch[..self.inverse.get_scratch_len()];
        let [columns, lines] = if parted { self.parts(passing) } else { Default::default() };
        self.team.exchange((spectra, &lines), (others, &columns));
        for line in (0..self.here.len()).filter(|line| wanted(*line)) {
            for component in (0..D).filter(|&component| to[component]) {
                let own = ((self.here.start + line) * passing.count() + passing.place(component)) * width;
                let own = &mut spectra[own..][..width];
                let whole = if parted {
                    for (range, at) in self.pieces((line, component), passing, &columns) {
                        let from = at.map_or(&own[..], |at| &others[at..][..range.len()]);
                        spectrum[range].copy_from_slice(from);
                    }
                    &mut spectrum[..]
                } else {
                    own
                };
                // Real but for round-off.
                whole[0].im = 0.0;
                if self.columns.is_multiple_of(2) {
                    whole[half - 1].im = 0.0;
                }
                self.inverse.process_with_scratch(whole, row, scratch).map_err(transform_failed)?;
                take(line, component, row);
            }
        }
        Ok(())
    }
}

/// What `put` of [`Transform::lines_there`] is for the last `S` of `D` components of every node.
pub(super) fn of_all<const D: usize, const S: usize>(
    values: &[f64],
    columns: usize,
) -> impl Fn(usize, usize, &mut [f64]) -> bool {
    move |line, component, row| {
        let nodes = values[line * S * columns..][..S * columns].chunks_exact(S);
        let mut some = false;
        for (row, node) in row.iter_mut().zip(nodes) {
            *row = node[component + S - D];
            some |= *row != 0.0;
        }
        some
    }
}

/// What `take` of [`Transform::lines_back`] is for them, each times a `share`.
pub(super) fn to_all<const D: usize, const S: usize>(
    values: &mut [f64],
    (columns, share): (usize, f64),
) -> impl FnMut(usize, usize, &[f64]) {
    move |line, component, row| {
        let nodes = values[line * S * columns..][..S * columns].chunks_exact_mut(S);
        nodes.zip(row).for_each(|(node, row)| node[component + S - D] = row * share);
    }
}
