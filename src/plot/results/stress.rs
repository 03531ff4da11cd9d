//! Stress in the bulk: what Figure 5 of the paper shows.

use super::{Run, nearest, short};
use crate::error::Result;
use crate::plot::{Axis, Colouring, Map, Panel, Ramp, Raster, Sheet};
use crate::scene::Material;

/// Fields of a map along its longer side.
const FINE: usize = 360;
/// Bands of colour between the least and the largest stress.
const BANDS: usize = 14;

/// A component of `/bulk/stress`: its index, its symbol, its colours.
const COMPONENTS: [(usize, &str, Ramp); 2] = [(1, "σ_zz", Ramp::Sequential), (3, "τ_xz", Ramp::Diverging)];

/// Normal stress on the left and shear stress on the right: at the end of the approach, then while sliding.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let time = run.results.bulk("time")?.values;
    let stress = run.results.bulk("stress")?;
    let grid = Grid::new(run)?;
    let frames = frames(run, &time);
    let modulus = young(run);
    let letters: Vec<char> = ('a'..='z').collect();
    let mut panels = Vec::new();
    let rasters: Vec<Vec<Vec<f64>>> = COMPONENTS
        .iter()
        .map(|(component, ..)| {
            let values = |frame: &usize| {
                let nodes: Vec<f64> =
                    stress.row(*frame).iter().skip(*component).step_by(4).map(|s| s / modulus).collect();
                grid.raster(&nodes)
            };
            frames.iter().map(values).collect()
        })
        .collect();
    for (i, &frame) in frames.iter().enumerate() {
        let row = nearest(&run.history.time, time[frame]);
        let when = match run.history.sliding[row] {
            0.0 => format!("t = {} s", short(time[frame], 4)),
            sliding => format!("t = {} s, s = {} m", short(time[frame], 4), short(sliding, 3)),
        };
        for (j, (_, symbol, ramp)) in COMPONENTS.iter().enumerate() {
            // The same levels at all times, so that they can be compared.
            let all = rasters[j].iter().flatten().filter(|value| !value.is_nan());
            let ends = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
            panels.push(Panel::Map(Map {
                title: format!("({}) {symbol}, {when}", letters[(2 * i + j) % 26]),
                x: Axis::linear(if grid.shift > 0.0 { "x, m (shifted by half a period)" } else { "x, m" }),
                y: Axis::linear("z, m"),
                raster: Raster { x: grid.x, y: grid.z, columns: grid.columns, values: rasters[j][i].clone() },
                colouring: Colouring::bands(format!("{symbol} / E(0)"), ends, *ramp, BANDS),
                curves: Vec::new(),
                equal: true,
            }));
        }
    }
    Ok(Sheet { panels, columns: 2, size: panel_size(&grid) })
}

/// E(0) = 2 G(0) (1 + nu), Pa: the instantaneous Young's modulus, of several materials the largest.
fn young(run: &Run) -> f64 {
    let of = |material: &Material| 2.0 * material.shear_modulus * (1.0 + material.poisson_ratio);
    run.scene.materials.iter().map(of).fold(0.0, f64::max)
}

/// The frame at the end of the approach and the last one of sliding, as far as they were written.
fn frames(run: &Run, time: &[f64]) -> Vec<usize> {
    let t0 = run.approach_time();
    let before = time.iter().rposition(|t| *t <= t0 * (1.0 + 1e-9));
    let after = time.iter().rposition(|t| *t > t0 * (1.0 + 1e-9));
    before.into_iter().chain(after).collect()
}

/// As wide as two panels may be, and no higher than the layer needs.
fn panel_size(grid: &Grid) -> (u32, u32) {
    let (wide, high) = (grid.x.1 - grid.x.0, grid.z.1 - grid.z.0);
    let plot = 480.0 * (high / wide).clamp(0.3, 1.5);
    (720, (plot + 130.0) as u32)
}

/// The regular grid that the nodal values are taken to.
struct Grid {
    x: (f64, f64),
    z: (f64, f64),
    columns: usize,
    rows: usize,
    shift: f64,
    nodes: Vec<[f64; 2]>,
    cells: Vec<[usize; 4]>,
    period: f64,
}

impl Grid {
    fn new(run: &Run) -> Result<Self> {
        let coordinates = run.results.bulk("coordinates")?;
        let cells = run.results.bulk("cells")?;
        let nodes: Vec<[f64; 2]> = coordinates.values.chunks_exact(2).map(|node| [node[0], node[1]]).collect();
        let cells = cells.values.chunks_exact(4).map(|c| [0, 1, 2, 3].map(|i| c[i] as usize)).collect();
        let ends = |i: usize| {
            let of = |(low, high): (f64, f64), node: &[f64; 2]| (low.min(node[i]), high.max(node[i]));
            nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), of)
        };
        let (x, z) = (ends(0), ends(1));
        let shift = run.shift();
        let (wide, high) = (x.1 - x.0, z.1 - z.0);
        let fields = |length: f64| ((FINE as f64 * length / wide.max(high)).round() as usize).max(2);
        Ok(Self {
            x: (x.0 - shift, x.1 - shift),
            z,
            columns: fields(wide),
            rows: fields(high),
            shift,
            nodes,
            cells,
            period: wide,
        })
    }

    /// Linear over the two halves of each cell; cells left of the grid are also taken a period to the right, and
    /// those right of it to the left.
    fn raster(&self, values: &[f64]) -> Vec<f64> {
        let mut raster = vec![f64::NAN; self.columns * self.rows];
        let offsets: &[f64] = if self.shift > 0.0 { &[0.0, -self.period] } else { &[0.0] };
        for cell in &self.cells {
            for half in [[0, 1, 2], [0, 2, 3]] {
                let corners = half.map(|i| cell[i]);
                for offset in offsets {
                    let at = corners.map(|node| [self.nodes[node][0] + offset, self.nodes[node][1]]);
                    self.fill(&mut raster, at, corners.map(|node| values[node]));
                }
            }
        }
        raster
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
