//! The Fourier transform of the nodes of a periodic face.
//!
//! Along the last axis it is that of real numbers, line by line; across the lines that of complex ones, in tiles of a few columns that
//! stay in the cache: gathered, transformed, multiplied by whatever acts on waves, transformed back and put where they came from.
//! So a product with a kernel passes four times over what it transforms, and nothing is held twice.
//!
//! Of a face that is parted among ranks each has some of the lines of nodes, and some of the columns of waves with all their lines: between
//! both stands one exchange of all components there, and one back. What acts on waves never leaves the rank that has them.

mod lines;
mod patch;

use std::cell::{Cell, RefCell};
use std::f64::consts::PI;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::SMatrix;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::error::{Error, Result};
use crate::mesh::apart;
use crate::parallel::{Team, parted};
use lines::{of_all, to_all};
pub use patch::Patch;

/// w of a row of nodes at one wave vector: (v, u_z) by (real, imaginary) part. Fields of a layer hold, for each wave vector,
/// one of them per row from the face down.
pub type Wave<const D: usize> = SMatrix<f64, D, 2>;

/// (v, u_z) of one wave vector.
type Components<const D: usize> = [Complex<f64>; D];

/// Columns that are transformed across the lines together: whole cache lines of each line.
const TILE: usize = 8;
/// Numbers between one column of a tile and the next beyond their length: powers of two would share their places in the cache.
const APART: usize = 4;

/// The transform of a row of nodes: along its last axis that of real numbers, along the one before it that of complex ones.
///
/// Wave (k, l), l = 0 to columns/2 of the last axis and k = 0 to lines - 1 of the other (1 in the plane), is at l times the lines
/// plus k, counted from the first l of this rank; what is left out is the complex conjugate of what there is. Clones count together and
/// share their room.
#[derive(Clone)]
pub struct Transform<const D: usize> {
    /// Axes of the face.
    axes: usize,
    lines: usize,
    columns: usize,
    /// The lines of nodes of this rank, and the columns of waves of each.
    here: Range<usize>,
    starts: Vec<usize>,
    team: Rc<Team>,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Across the lines, there and back.
    across: [Arc<dyn Fft<f64>>; 2],
    counted: Rc<Cell<usize>>,
    room: Rc<RefCell<Room<D>>>,
}

/// Where it is done, kept from one time to the next: memory that is asked for anew is cleared page by page, which takes as long.
struct Room<const D: usize> {
    /// Line by line, and in each component by component, the columns of this rank.
    spectra: Vec<Complex<f64>>,
    /// Rank by rank the columns of the others, of the lines of this one, in the same order.
    others: Vec<Complex<f64>>,
    /// Of each component.
    tile: [Vec<Complex<f64>>; D],
    row: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

/// The components that pass through the room together.
#[derive(Clone)]
struct Passing(Range<usize>);

/// Which components come from somewhere, which go somewhere, and all that pass.
struct Passage<const D: usize> {
    from: [bool; D],
    to: [bool; D],
    passing: Passing,
}

impl Passing {
    fn count(&self) -> usize {
        self.0.len()
    }

    /// Where a component stands among them.
    fn place(&self, component: usize) -> usize {
        component - self.0.start
    }
}

impl<const D: usize> Transform<D> {
    /// For faces with so many nodes along each axis, all on this rank.
    pub fn new(counts: &[usize]) -> Self {
        Self::among(counts, Team::alone())
    }

    /// The same where the lines of nodes are parted among the ranks of a team.
    pub fn among(counts: &[usize], team: Rc<Team>) -> Self {
        let columns = counts.last().copied().unwrap_or(1);
        let lines: usize = counts.iter().rev().skip(1).product();
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let (forward, inverse) = (real.plan_fft_forward(columns), real.plan_fft_inverse(columns));
        let across = [complex.plan_fft_forward(lines), complex.plan_fft_inverse(lines)];
        let room = Room {
            spectra: Vec::new(),
            others: Vec::new(),
            tile: [const { Vec::new() }; D],
            row: Vec::new(),
            spectrum: Vec::new(),
            scratch: Vec::new(),
        };
        Self {
            axes: counts.len(),
            lines,
            columns,
            here: team.lines().unwrap_or(0..lines),
            starts: parted(columns / 2 + 1, team.ranks()[0]),
            team,
            forward,
            inverse,
            across,
            counted: Rc::new(Cell::new(0)),
            room: Rc::new(RefCell::new(room)),
        }
    }

    /// The ranks that share the face.
    pub fn team(&self) -> &Rc<Team> {
        &self.team
    }

    /// How many nodes there are.
    pub fn nodes(&self) -> usize {
        self.lines * self.columns
    }

    /// How many of them are on this rank.
    pub fn nodes_here(&self) -> usize {
        self.here.len() * self.columns
    }

    /// How many wave vectors there are on this rank.
    pub fn waves(&self) -> usize {
        self.lines * self.own().len()
    }

    /// How many there are on all ranks.
    pub fn all_waves(&self) -> usize {
        self.lines * self.half()
    }

    /// Which of them is the first of this rank.
    pub fn first_wave(&self) -> usize {
        self.lines * self.own().start
    }

    /// How many transforms of one component, there or back, were made.
    pub fn counted(&self) -> usize {
        self.counted.get()
    }

    /// The node that is as far from the first as node i is from node j, of a face that is not parted.
    pub fn apart(&self, i: usize, j: usize) -> usize {
        apart(&[self.lines, self.columns], i, j)
    }

    /// By what a wave leads from one node to the next along each axis of the face, in the order of the axes.
    pub fn angles(&self, wave: usize) -> [f64; 2] {
        let angle = |k: usize, count: usize| 2.0 * PI * k as f64 / count as f64;
        let last = angle(self.column(wave), self.columns);
        if self.axes == 1 { [last, 0.0] } else { [angle(wave % self.lines, self.lines), last] }
    }

    /// For how many waves one stands: itself, and its conjugate where that is left out.
    pub fn stands_for(&self, wave: usize) -> f64 {
        let l = self.column(wave);
        if l == 0 || 2 * l == self.columns { 1.0 } else { 2.0 }
    }

    /// Whether a wave is the uniform one.
    pub fn is_uniform(&self, wave: usize) -> bool {
        wave == 0 && self.own().start == 0
    }

    /// The waves of the components of each node; a component that is nothing costs nothing.
    pub fn forward(&self, values: &[f64]) -> Result<Vec<Wave<D>>> {
        let mut waves = vec![Wave::zeros(); self.waves()];
        let passing = Passing(0..D);
        let mut room = self.room(&passing);
        let from = self.some_of(values, 0..D);
        self.lines_there((&from, &passing), &mut room, of_all::<D, D>(values, self.columns))?;
        self.across_lines((&mut room, &passing), (&from, &[false; D]), |k, w| {
            for (component, c) in w.iter().enumerate() {
                (waves[k][(component, 0)], waves[k][(component, 1)]) = (c.re, c.im);
            }
        });
        Ok(waves)
    }

    /// The components of each node.
    pub fn inverse<'a>(&self, mut waves: impl FnMut(usize) -> &'a Wave<D>) -> Result<Vec<f64>> {
        let mut values = vec![0.0; D * self.nodes_here()];
        let passing = Passing(0..D);
        let mut room = self.room(&passing);
        let all = [true; D];
        self.across_lines((&mut room, &passing), (&[false; D], &all), |k, w| {
            let wave = waves(k);
            for (component, c) in w.iter_mut().enumerate() {
                *c = Complex::new(wave[(component, 0)], wave[(component, 1)]);
            }
        });
        self.lines_back(
            (&all, &passing),
            &mut room,
            |_| true,
            to_all::<D, D>(&mut values, (self.columns, self.share())),
        )?;
        Ok(values)
    }

    /// The components `to` of each node become those of waves that `act` made of the waves of the components `from`, of which it is
    /// given the number and the values; the other components are left as they are. Components that are nothing cost nothing, and of
    /// nothing comes nothing.
    pub fn filter(
        &self,
        values: &mut [f64],
        (from, to): (Range<usize>, Range<usize>),
        act: impl Fn(usize, &mut Components<D>),
    ) -> Result<()> {
        let Some(passage) = self.passage(values, (from, to.clone())) else { return cleared::<D>(values, to) };
        let mut room = self.acted(&passage, of_all::<D, D>(values, self.columns), act)?;
        let back = to_all::<D, D>(values, (self.columns, self.share()));
        self.lines_back((&passage.to, &passage.passing), &mut room, |_| true, back)
    }

    /// The same from and to the nodes of a patch alone, whose components `values` are; elsewhere there is nothing, and nothing is asked.
    pub fn filter_patch(
        &self,
        patch: &Patch,
        values: &mut [f64],
        (from, to): (Range<usize>, Range<usize>),
        act: impl Fn(usize, &mut Components<D>),
    ) -> Result<()> {
        let Some(passage) = self.passage(values, (from, to.clone())) else { return cleared::<D>(values, to) };
        let put = |line: usize, component: usize, row: &mut [f64]| patch.put::<D>(values, (line, component), row);
        let (mut room, share) = (self.acted(&passage, put, act)?, self.share());
        self.lines_back(
            (&passage.to, &passage.passing),
            &mut room,
            |line| patch.is_on(line),
            |line, component, row| patch.take::<D>(row, (line, component, share), values),
        )
    }

    /// Of what the nodes of a patch have to all nodes of this rank, which have nothing where nothing comes from.
    pub fn filter_from(
        &self,
        (patch, values): (&Patch, &[f64]),
        all: &mut [f64],
        to: Range<usize>,
        act: impl Fn(usize, &mut Components<D>),
    ) -> Result<()> {
        let Some(passage) = self.passage(values, (0..D, to)) else { return cleared::<D>(all, 0..D) };
        let put = |line: usize, component: usize, row: &mut [f64]| patch.put::<D>(values, (line, component), row);
        let mut room = self.acted(&passage, put, act)?;
        let back = to_all::<D, D>(all, (self.columns, self.share()));
        self.lines_back((&passage.to, &passage.passing), &mut room, |_| true, back)
    }

    /// How components of values pass from and to; none where all that they come from is nothing. Collective.
    fn passage(&self, values: &[f64], (from, to): (Range<usize>, Range<usize>)) -> Option<Passage<D>> {
        let passing = Passing(from.start.min(to.start)..from.end.max(to.end));
        let from = self.some_of(values, from);
        let to = std::array::from_fn(|component| to.contains(&component));
        (from != [false; D]).then_some(Passage { from, to, passing })
    }

    /// The room with the waves of what is put on the lines, after what acts on them. Collective.
    fn acted(
        &self,
        Passage { from, to, passing }: &Passage<D>,
        put: impl Fn(usize, usize, &mut [f64]) -> bool,
        act: impl Fn(usize, &mut Components<D>),
    ) -> Result<std::cell::RefMut<'_, Room<D>>> {
        let mut room = self.room(passing);
        self.lines_there((from, passing), &mut room, put)?;
        self.across_lines((&mut room, passing), (from, to), act);
        Ok(room)
    }

    /// Some of the nodes of this rank.
    pub fn patch(&self, nodes: Vec<usize>) -> Patch {
        Patch::new(nodes, (self.here.len(), self.columns))
    }

    /// What the sums of a transform there and back are to be taken times.
    fn share(&self) -> f64 {
        1.0 / self.nodes() as f64
    }

    /// The same of a list of last components alone: each wave times a number.
    pub fn filter_last(&self, values: &mut [f64], factor: impl Fn(usize) -> f64) -> Result<()> {
        if !self.team.any(values.iter().any(|value| *value != 0.0)) {
            return Ok(());
        }
        let last = std::array::from_fn(|component| component + 1 == D);
        let passing = Passing(D - 1..D);
        let mut room = self.room(&passing);
        self.lines_there((&last, &passing), &mut room, of_all::<D, 1>(values, self.columns))?;
        self.across_lines((&mut room, &passing), (&last, &last), |wave, w| w[D - 1] *= factor(wave));
        self.lines_back((&last, &passing), &mut room, |_| true, to_all::<D, 1>(values, (self.columns, self.share())))
    }

    /// The columns of waves of this rank.
    fn own(&self) -> Range<usize> {
        let [_, rank] = self.team.ranks();
        self.starts[rank]..self.starts[rank + 1]
    }

    /// The column of a wave among those of all ranks.
    fn column(&self, wave: usize) -> usize {
        self.own().start + wave / self.lines
    }

    fn half(&self) -> usize {
        self.columns / 2 + 1
    }

    /// Of one column of a tile to the next.
    fn stride(&self) -> usize {
        if self.lines > 1 { self.lines + APART } else { 1 }
    }

    /// Which of these components are not nothing, on any rank.
    fn some_of(&self, values: &[f64], components: Range<usize>) -> [bool; D] {
        let some = |component: usize| values.iter().skip(component).step_by(D).any(|value| *value != 0.0);
        let mine: [bool; D] = std::array::from_fn(|component| components.contains(&component) && some(component));
        match self.team.is_parted() {
            true => self.team.sum(mine.map(|some| f64::from(u8::from(some)))).map(|count| count > 0.0),
            false => mine,
        }
    }

    /// The room, with places for the components.
    fn room(&self, passing: &Passing) -> std::cell::RefMut<'_, Room<D>> {
        let mut room = self.room.borrow_mut();
        let nothing = Complex::default();
        let grow = |list: &mut Vec<Complex<f64>>, length: usize| {
            if list.len() < length {
                list.resize(length, nothing);
            }
        };
        grow(&mut room.spectra, passing.count() * self.waves());
        if self.team.is_parted() {
            grow(&mut room.others, passing.count() * self.here.len() * (self.half() - self.own().len()));
            grow(&mut room.spectrum, self.half());
        }
        passing.0.clone().for_each(|component| grow(&mut room.tile[component], TILE * self.stride()));
        let scratch = [self.forward.get_scratch_len(), self.inverse.get_scratch_len()]
            .into_iter()
            .chain(self.across.iter().map(|across| across.get_inplace_scratch_len()))
            .max()
            .unwrap_or(0);
        grow(&mut room.scratch, scratch);
        room.row.resize(self.columns, 0.0);
        room
    }

    /// Counts a transform of each of these components.
    fn count(&self, components: &[bool; D]) {
        self.counted.set(self.counted.get() + components.iter().filter(|component| **component).count());
    }

    /// Across the lines, there with the components `from` and back with those of `to`, and between that what acts on each wave; of
    /// components that do not come from anywhere it is given nothing.
    fn across_lines(
        &self,
        (room, passing): (&mut Room<D>, &Passing),
        (from, to): (&[bool; D], &[bool; D]),
        mut act: impl FnMut(usize, &mut Components<D>),
    ) {
        let (lines, own, stride) = (self.lines, self.own().len(), self.stride());
        let Room { spectra, tile, scratch, .. } = room;
        let [there, back] = &self.across;
        let length = passing.count() * own;
        for first in (0..own).step_by(TILE) {
            let width = TILE.min(own - first);
            for component in (0..D).filter(|&component| from[component]) {
                let (tile, at) = (&mut tile[component], passing.place(component) * own + first);
                for (line, spectrum) in spectra.chunks_exact(length).take(lines).enumerate() {
                    let places = tile[line..].iter_mut().step_by(stride);
                    places.zip(&spectrum[at..][..width]).for_each(|(place, c)| *place = *c);
                }
                if lines > 1 {
                    let scratch = &mut scratch[..there.get_inplace_scratch_len()];
                    let columns = tile.chunks_mut(stride).take(width);
                    columns.for_each(|column| there.process_with_scratch(&mut column[..lines], scratch));
                }
            }
            for (column, line) in (0..width).flat_map(|column| (0..lines).map(move |line| (column, line))) {
                let place = column * stride + line;
                let mut w: Components<D> =
                    std::array::from_fn(|i| if from[i] { wave(i + 1 < D, tile[i][place]) } else { Complex::default() });
                act((first + column) * lines + line, &mut w);
                for i in (0..D).filter(|&i| to[i]) {
                    tile[i][place] = node(i + 1 < D, w[i]);
                }
            }
            for component in (0..D).filter(|&component| to[component]) {
                let (tile, at) = (&mut tile[component], passing.place(component) * own + first);
                if lines > 1 {
                    let scratch = &mut scratch[..back.get_inplace_scratch_len()];
                    let columns = tile.chunks_mut(stride).take(width);
                    columns.for_each(|column| back.process_with_scratch(&mut column[..lines], scratch));
                }
                for (line, spectrum) in spectra.chunks_exact_mut(length).take(lines).enumerate() {
                    let places = tile[line..].iter().step_by(stride);
                    spectrum[at..][..width].iter_mut().zip(places).for_each(|(c, place)| *c = *place);
                }
            }
        }
    }
}

/// Makes these components of each node nothing.
fn cleared<const D: usize>(values: &mut [f64], components: Range<usize>) -> Result<()> {
    values.chunks_exact_mut(D).for_each(|node| node[components.clone()].fill(0.0));
    Ok(())
}

/// v = -i u along the face.
fn wave(along: bool, c: Complex<f64>) -> Complex<f64> {
    if along { Complex::new(c.im, -c.re) } else { c }
}

/// u = i v.
fn node(along: bool, c: Complex<f64>) -> Complex<f64> {
    if along { Complex::new(-c.im, c.re) } else { c }
}

fn transform_failed(error: realfft::FftError) -> Error {
    Error::Internal(format!("Fourier transform: {error}"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
