//! Along the lines of nodes, and the exchange of columns among the ranks that share them.

use std::ops::Range;

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

    /// Along each line, of the last `S` components to a node.
    pub(super) fn lines_there<const S: usize>(
        &self,
        values: &[f64],
        (from, passing): (&[bool; D], &Passing),
        room: &mut Room<D>,
    ) -> Result<()> {
        self.count(from);
        let (width, parted) = (self.own().len(), self.team.is_parted());
        let Room { spectra, others, row, spectrum, scratch, .. } = room;
        let scratch = &mut scratch[..self.forward.get_scratch_len()];
        let [columns, lines] = if parted { self.parts(passing) } else { Default::default() };
        for (line, nodes) in values.chunks_exact(S * self.columns).enumerate() {
            for component in (0..D).filter(|&component| from[component]) {
                let place = component + S - D;
                row.iter_mut().zip(nodes.chunks_exact(S)).for_each(|(row, node)| *row = node[place]);
                let own = ((self.here.start + line) * passing.count() + passing.place(component)) * width;
                let own = &mut spectra[own..][..width];
                if !parted {
                    self.forward.process_with_scratch(row, own, scratch).map_err(transform_failed)?;
                    continue;
                }
                self.forward.process_with_scratch(row, spectrum, scratch).map_err(transform_failed)?;
                for (range, at) in self.pieces((line, component), passing, &columns) {
                    let to = at.map_or(&mut own[..], |at| &mut others[at..][..range.len()]);
                    to.copy_from_slice(&spectrum[range]);
                }
            }
        }
        self.team.exchange((others, &columns), (spectra, &lines));
        Ok(())
    }

    /// Back along each line.
    pub(super) fn lines_back<const S: usize>(
        &self,
        values: &mut [f64],
        (to, passing): (&[bool; D], &Passing),
        room: &mut Room<D>,
    ) -> Result<()> {
        self.count(to);
        let (half, share) = (self.half(), 1.0 / self.nodes() as f64);
        let (width, parted) = (self.own().len(), self.team.is_parted());
        let Room { spectra, others, row, spectrum, scratch, .. } = room;
        let scratch = &mut scratch[..self.inverse.get_scratch_len()];
        let [columns, lines] = if parted { self.parts(passing) } else { Default::default() };
        self.team.exchange((spectra, &lines), (others, &columns));
        for (line, nodes) in values.chunks_exact_mut(S * self.columns).enumerate() {
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
                let place = component + S - D;
                nodes.chunks_exact_mut(S).zip(row.iter()).for_each(|(node, row)| node[place] = row * share);
            }
        }
        Ok(())
    }
}
