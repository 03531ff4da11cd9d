//! Some nodes of a face: what is nothing elsewhere, and is asked for nowhere else.

use std::ops::Range;

/// Nodes of a rank, in their order, and which of them are on each of its lines.
#[derive(Clone, Default)]
pub struct Patch {
    nodes: Vec<usize>,
    lines: Vec<Range<usize>>,
    columns: usize,
}

impl Patch {
    /// Of these nodes, in their order, on so many lines of so many nodes each.
    pub(super) fn new(nodes: Vec<usize>, (lines, columns): (usize, usize)) -> Self {
        let begins = |line: usize| nodes.partition_point(|node| *node < line * columns);
        let lines = (0..lines).map(|line| begins(line)..begins(line + 1)).collect();
        Self { nodes, lines, columns }
    }

    /// Which nodes these are.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Whether any is on a line.
    pub(super) fn is_on(&self, line: usize) -> bool {
        !self.lines[line].is_empty()
    }

    /// Where each node of a line is on it, and its place in a list of the patch.
    fn on(&self, line: usize) -> impl Iterator<Item = (usize, usize)> {
        let first = line * self.columns;
        self.lines[line].clone().map(move |place| (self.nodes[place] - first, place))
    }

    /// Writes a component to a line; whether there is any.
    pub(super) fn put<const D: usize>(
        &self,
        values: &[f64],
        (line, component): (usize, usize),
        row: &mut [f64],
    ) -> bool {
        if !self.is_on(line) {
            return false;
        }
        row.fill(0.0);
        self.on(line).for_each(|(at, place)| row[at] = values[D * place + component]);
        true
    }

    /// Takes it from there, times a share.
    pub(super) fn take<const D: usize>(
        &self,
        row: &[f64],
        (line, component, share): (usize, usize, f64),
        values: &mut [f64],
    ) {
        self.on(line).for_each(|(at, place)| values[D * place + component] = row[at] * share);
    }
}
