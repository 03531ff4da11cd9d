//! Stress in the bulk: what Figure 5 of the paper shows.

use super::{Run, Unit};
use crate::error::{Error, Result};
use crate::output::reader::Field;
use crate::plot::numbers::short;
use crate::plot::{Axis, Colouring, Map, Panel, Ramp, Raster, Sheet};

/// Fields of a map along its longer side.
const FINE: usize = 480;
/// Bands of colour between the least and the largest stress.
const BANDS: usize = 16;
/// A part of the body that is flatter than this has a row of its own.
const FLAT: f64 = 0.35;

/// A component of `/bulk/stress`: its index, its symbol, its colours.
const COMPONENTS: [(usize, &str, Ramp); 2] = [(1, "σ_{zz}", Ramp::Sequential), (3, "τ_{xz}", Ramp::Diverging)];

/// Normal stress and shear stress, side by side where there is room: at the end of the approach, then while sliding.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let bulk = Bulk::of(run)?;
    let frames = frames(run, &bulk.time);
    let unit = Unit::of(run);
    let grids: Vec<Grid> = bulk.windows(&frames, run).into_iter().map(|window| Grid::new(&bulk, window)).collect();
    let ratio = grids.iter().map(Grid::ratio).fold(0.0, f64::max);
    let maps = COMPONENTS.map(|(component, symbol, ramp)| {
        let raster = |(frame, grid): (&usize, &Grid)| {
            let stress = bulk.component(*frame, component).map(|stress| stress / unit.value);
            grid.raster(&bulk, &stress.collect::<Vec<_>>())
        };
        let rasters: Vec<Vec<f64>> = frames.iter().zip(&grids).map(raster).collect();
        // The same levels at all times, so that they can be compared.
        let all = rasters.iter().flatten().filter(|value| !value.is_nan());
        let ends = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        (symbol, rasters, Colouring::bands(unit.over(symbol), ends, ramp, BANDS))
    });
    let mut panels = Vec::new();
    for (i, (&frame, grid)) in frames.iter().zip(&grids).enumerate() {
        for (symbol, rasters, colouring) in &maps {
            panels.push(Panel::Map(Map {
                title: format!("{symbol} at {}", moment(run, bulk.time[frame])),
                x: Axis::linear("x, m"),
                y: Axis::linear("z, m"),
                raster: Raster { x: grid.x, y: grid.z, columns: grid.columns, values: rasters[i].clone() },
                colouring: colouring.clone(),
                equal: true,
            }));
        }
    }
    let (columns, width) = if ratio < FLAT { (1, 1080) } else { (2, 540) };
    // What the frame of such a width takes, and what is around it.
    let height = f64::from(width - 190) * ratio.min(1.4) + 106.0;
    Ok(Sheet { panels, columns, size: (width, height as u32), note: unit.note(run) })
}

/// t = 10 s, or s/λ = 0.5 while sliding.
fn moment(run: &Run, time: f64) -> String {
    match (run.slid(time), run.period()) {
        (0.0, _) => format!("t = {} s", short(time, 4)),
        (slid, Some(period)) => format!("s = {} λ", short(slid / period, 3)),
        (slid, None) => format!("s = {} m", short(slid, 3)),
    }
}

/// The frame at the end of the approach and the last one of sliding, as far as they were written.
fn frames(run: &Run, time: &[f64]) -> Vec<usize> {
    let t0 = run.approach_time();
    let before = time.iter().rposition(|t| *t <= t0 * (1.0 + 1e-9));
    let after = time.iter().rposition(|t| *t > t0 * (1.0 + 1e-9));
    before.into_iter().chain(after).collect()
}

/// The mesh and the stress in it.
struct Bulk {
    time: Vec<f64>,
    nodes: Vec<[f64; 2]>,
    cells: Vec<[usize; 4]>,
    stress: Field,
    /// After which the body is itself again along x, m; none = it does not.
    period: Option<f64>,
}

impl Bulk {
    fn of(run: &Run) -> Result<Self> {
        let field = |name: &str| run.results.bulk(name);
        let read = |name: &str, columns: usize| {
            let found = field(name)?;
            let rows = found.rows;
            run.checked(&format!("bulk/{name}"), found, (rows, columns))
        };
        let (time, coordinates, cells) = (read("time", 1)?, read("coordinates", 2)?, read("cells", 4)?);
        let count = coordinates.rows;
        let stress = run.checked("bulk/stress", field("stress")?, (time.rows, 4 * count))?;
        let known = |node: &&f64| **node >= 0.0 && **node < count as f64 && node.fract() == 0.0;
        if let Some(node) = cells.values.iter().find(|node| !known(node)) {
            let reason = format!("is damaged: /bulk/cells names node {node} of {count}");
            return Err(Error::file(&run.path, reason));
        }
        Ok(Self {
            time: time.values,
            nodes: coordinates.values.chunks_exact(2).map(|node| [node[0], node[1]]).collect(),
            cells: cells.values.chunks_exact(4).map(|c| [0, 1, 2, 3].map(|i| c[i] as usize)).collect(),
            stress,
            period: run.scene.period(),
        })
    }

    /// A component of the stress at each node, Pa.
    fn component(&self, frame: usize, component: usize) -> impl Iterator<Item = f64> {
        self.stress.row(frame).iter().skip(component).step_by(4).copied()
    }

    /// The least and the largest coordinate.
    fn ends(&self, i: usize) -> (f64, f64) {
        let of = |(low, high): (f64, f64), node: &[f64; 2]| (low.min(node[i]), high.max(node[i]));
        self.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), of)
    }

    /// What is shown along x of each frame: a period about the middle of the way of the contact; of another body the part
    /// that is pressed, and its depth on either side.
    fn windows(&self, frames: &[usize], run: &Run) -> Vec<(f64, f64)> {
        if let Some(period) = self.period {
            let slid = frames.iter().map(|&frame| run.slid(self.time[frame]));
            let (low, high) = slid.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
            // Quarters of a period, so that the ticks of the axis stay where they are expected.
            let middle = (2.0 * (low + high) / period).round() * 0.25 * period;
            return vec![(middle - 0.5 * period, middle + 0.5 * period); frames.len()];
        }
        let (x, z) = (self.ends(0), self.ends(1));
        let window = |&frame: &usize| {
            let least = 0.1 * self.component(frame, 1).fold(0.0f64, f64::min);
            let pressed = self.nodes.iter().zip(self.component(frame, 1)).filter(|(_, s)| *s < least);
            let ends = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
            let (low, high) = pressed.map(|(node, _)| node[0]).fold((f64::INFINITY, f64::NEG_INFINITY), ends);
            let depth = z.1 - z.0;
            if low <= high { ((low - depth).max(x.0), (high + depth).min(x.1)) } else { x }
        };
        frames.iter().map(window).collect()
    }
}

/// The regular grid that the nodal values are taken to.
struct Grid {
    x: (f64, f64),
    z: (f64, f64),
    columns: usize,
    rows: usize,
}

impl Grid {
    fn new(bulk: &Bulk, x: (f64, f64)) -> Self {
        let z = bulk.ends(1);
        let (wide, high) = (x.1 - x.0, z.1 - z.0);
        let fields = |length: f64| ((FINE as f64 * length / wide.max(high)).round() as usize).clamp(2, FINE);
        Self { x, z, columns: fields(wide), rows: fields(high) }
    }

    /// Height over width.
    fn ratio(&self) -> f64 {
        (self.z.1 - self.z.0) / (self.x.1 - self.x.0)
    }

    /// Linear over the two halves of each cell, and of its images in a body that repeats itself.
    fn raster(&self, bulk: &Bulk, values: &[f64]) -> Vec<f64> {
        let mut raster = vec![f64::NAN; self.columns * self.rows];
        for cell in &bulk.cells {
            for half in [[0, 1, 2], [0, 2, 3]] {
                let corners = half.map(|i| cell[i]);
                let at = corners.map(|node| bulk.nodes[node]);
                for offset in self.offsets(bulk.period, at[0][0]) {
                    let image = at.map(|[x, z]| [x + offset, z]);
                    self.fill(&mut raster, image, corners.map(|node| values[node]));
                }
            }
        }
        raster
    }

    /// By how much what is at x is shifted to be seen.
    fn offsets(&self, period: Option<f64>, x: f64) -> Vec<f64> {
        let Some(period) = period else { return vec![0.0] };
        // The image inside, and that beyond either end, which may reach in.
        let inside = ((self.x.0 - x) / period).ceil();
        [-1.0, 0.0, 1.0].map(|image| (inside + image) * period).to_vec()
    }

    /// The fields whose middle lies in a triangle.
    fn fill(&self, raster: &mut [f64], at: [[f64; 2]; 3], values: [f64; 3]) {
        let step = [(self.x.1 - self.x.0) / self.columns as f64, (self.z.1 - self.z.0) / self.rows as f64];
        let span = |i: usize, start: f64, count: usize| {
            let (low, high) = at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |e, c| (e.0.min(c[i]), e.1.max(c[i])));
            let first = ((low - start) / step[i] - 0.5).floor().max(0.0) as usize;
            let end = (((high - start) / step[i] + 1.5).floor().max(0.0) as usize).min(count);
            first..end
        };
        let [a, b, c] = at;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0.0 {
            return;
        }
        for row in span(1, self.z.0, self.rows) {
            for column in span(0, self.x.0, self.columns) {
                let x = self.x.0 + (column as f64 + 0.5) * step[0];
                let z = self.z.0 + (row as f64 + 0.5) * step[1];
                let second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (z - a[1])) / area;
                let third = ((b[0] - a[0]) * (z - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
                let parts = [1.0 - second - third, second, third];
                if parts.iter().all(|part| *part >= -1e-9) {
                    raster[row * self.columns + column] = parts.iter().zip(values).map(|(part, v)| part * v).sum();
                }
            }
        }
    }
}
