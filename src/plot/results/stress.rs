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

/// A component of the stress: its symbol, its colours.
const COMPONENTS: [(&str, Ramp); 2] = [("σ_{zz}", Ramp::Sequential), ("τ_{xz}", Ramp::Diverging)];
/// Where they are among the components of `/bulk/stress` in the plane and in space, and how many these are.
const PLANE: ([usize; 2], usize) = ([1, 3], 4);
const SPACE: ([usize; 2], usize) = ([2, 5], 6);

/// Normal stress and shear stress, side by side where there is room: at the end of the approach, then while sliding.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let bulk = Bulk::of(run)?;
    let frames = frames(run, &bulk.time);
    let unit = Unit::of(run);
    let sections = frames.iter().map(|&frame| bulk.section(run, frame)).collect::<Result<Vec<_>>>()?;
    let windows = bulk.windows(&frames, &sections, run);
    let grids: Vec<Grid> = sections.iter().zip(windows).map(|(section, window)| Grid::new(section, window)).collect();
    let ratio = grids.iter().map(Grid::ratio).fold(0.0, f64::max);
    let maps = [0, 1].map(|component| {
        let (symbol, ramp) = COMPONENTS[component];
        let raster = |((frame, section), grid): ((&usize, &Section), &Grid)| {
            let stress = bulk.component(section, *frame, component).map(|stress| stress / unit.value);
            grid.raster(section, &stress.collect::<Vec<_>>(), bulk.period)
        };
        let rasters: Vec<Vec<f64>> = frames.iter().zip(&sections).zip(&grids).map(raster).collect();
        // The same levels at all times, so that they can be compared.
        let all = rasters.iter().flatten().filter(|value| !value.is_nan());
        let ends = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        (symbol, rasters, Colouring::bands(unit.over(symbol), ends, ramp, BANDS))
    });
    let mut panels = Vec::new();
    for (i, (&frame, grid)) in frames.iter().zip(&grids).enumerate() {
        for (symbol, rasters, colouring) in &maps {
            panels.push(Panel::Map(Map {
                title: format!("{symbol} at {}{}", moment(run, bulk.time[frame]), sections[i].place),
                x: Axis::linear("x, m"),
                y: Axis::linear("z, m"),
                raster: Raster { x: grid.x, y: grid.z, columns: grid.columns, values: rasters[i].clone() },
                colouring: colouring.clone(),
                equal: true,
                arrows: Vec::new(),
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
    match (run.slid(time), run.period().filter(|_| !run.is_in_space())) {
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
    /// x, z of each node, in space x, y, z, m.
    coordinates: Field,
    /// Nodes of each cell.
    cells: Field,
    stress: Field,
    /// Where the components of the stress are, and how many there are.
    components: ([usize; 2], usize),
    /// After which the body is itself again along x, m; none = it does not.
    period: Option<f64>,
}

/// A plane of x and z: all of a plane body, the sides of cells in it of one in space.
struct Section {
    /// x and z, m.
    nodes: Vec<[f64; 2]>,
    /// Which node of the file each is.
    named: Vec<usize>,
    cells: Vec<[usize; 4]>,
    /// In space, where the contact is deepest along x, m.
    centre: Option<f64>,
    /// Where it is, for a title; empty in the plane.
    place: String,
}

impl Bulk {
    fn of(run: &Run) -> Result<Self> {
        let field = |name: &str| run.results.bulk(name);
        let read = |name: &str, columns: usize| {
            let found = field(name)?;
            let rows = found.rows;
            run.checked(&format!("bulk/{name}"), found, (rows, columns))
        };
        let (axes, corners, components) = if run.is_in_space() { (3, 8, SPACE) } else { (2, 4, PLANE) };
        let (time, coordinates, cells) = (read("time", 1)?, read("coordinates", axes)?, read("cells", corners)?);
        let count = coordinates.rows;
        let stress = run.checked("bulk/stress", field("stress")?, (time.rows, components.1 * count))?;
        let known = |node: &&f64| **node >= 0.0 && **node < count as f64 && node.fract() == 0.0;
        if let Some(node) = cells.values.iter().find(|node| !known(node)) {
            let reason = format!("is damaged: /bulk/cells names node {node} of {count}");
            return Err(Error::file(&run.path, reason));
        }
        Ok(Self { time: time.values, coordinates, cells, stress, components, period: run.scene.period() })
    }

    /// What is shown at a frame: in space the plane of nodes nearest to where the contact is deepest then.
    fn section(&self, run: &Run, frame: usize) -> Result<Section> {
        let nodes = (0..self.coordinates.rows).map(|node| {
            let row = self.coordinates.row(node);
            [row[0], row[row.len() - 1]]
        });
        let nodes: Vec<[f64; 2]> = nodes.collect();
        let cells = self.cells.values.chunks_exact(self.cells.columns.max(1));
        if !run.is_in_space() {
            let cells = cells.map(|c| [0, 1, 2, 3].map(|i| c[i] as usize)).collect();
            let named = (0..nodes.len()).collect();
            return Ok(Section { nodes, named, cells, centre: None, place: String::new() });
        }
        let [x, y] = super::space::Plain::of(run)?.deepest_at(self.time[frame]);
        let across: Vec<f64> = self.coordinates.values.chunks_exact(3).map(|node| node[1]).collect();
        let at = across[super::nearest(&across, y)];
        let mut section = Section {
            nodes: Vec::new(),
            named: Vec::new(),
            cells: Vec::new(),
            centre: Some(x),
            place: format!(", y = {} m", short(at, 3)),
        };
        let mut shown = vec![None; across.len()];
        for cell in cells {
            let side = cell.iter().map(|node| *node as usize).filter(|node| across[*node] == at);
            let Some(side) = around(side.collect(), &nodes) else { continue };
            let corners = side.map(|node| {
                *shown[node].get_or_insert_with(|| {
                    section.nodes.push(nodes[node]);
                    section.named.push(node);
                    section.nodes.len() - 1
                })
            });
            section.cells.push(corners);
        }
        Ok(section)
    }

    /// Of [`COMPONENTS`], the stress at each node of a section, Pa.
    fn component(&self, section: &Section, frame: usize, component: usize) -> impl Iterator<Item = f64> {
        let (row, (at, count)) = (self.stress.row(frame), self.components);
        section.named.iter().map(move |node| row[count * node + at[component]])
    }

    /// What is shown along x of each frame: a period about the middle of the way of the contact, in space about the contact; of
    /// another body the part that is pressed, and its depth on either side.
    fn windows(&self, frames: &[usize], sections: &[Section], run: &Run) -> Vec<(f64, f64)> {
        if let Some(period) = self.period {
            let slid = frames.iter().map(|&frame| run.slid(self.time[frame]));
            let (low, high) = slid.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
            // Quarters of a period, so that the ticks of the axis stay where they are expected.
            let quarters = |middle: f64| (4.0 * middle / period).round() * 0.25 * period;
            let middle = |section: &Section| quarters(section.centre.unwrap_or(0.5 * (low + high)));
            let window = |section: &Section| (middle(section) - 0.5 * period, middle(section) + 0.5 * period);
            return sections.iter().map(window).collect();
        }
        let window = |(&frame, section): (&usize, &Section)| {
            let (x, z) = (section.ends(0), section.ends(1));
            let least = 0.1 * self.component(section, frame, 0).fold(0.0f64, f64::min);
            let pressed = section.nodes.iter().zip(self.component(section, frame, 0)).filter(|(_, s)| *s < least);
            let ends = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
            let (low, high) = pressed.map(|(node, _)| node[0]).fold((f64::INFINITY, f64::NEG_INFINITY), ends);
            let depth = z.1 - z.0;
            if low <= high { ((low - depth).max(x.0), (high + depth).min(x.1)) } else { x }
        };
        frames.iter().zip(sections).map(window).collect()
    }
}

/// The four corners of a side, one after the other around its middle; none of what has not four.
fn around(mut side: Vec<usize>, nodes: &[[f64; 2]]) -> Option<[usize; 4]> {
    if side.len() != 4 {
        return None;
    }
    let middle = [0, 1].map(|i| side.iter().map(|node| nodes[*node][i]).sum::<f64>() / 4.0);
    let angle = |node: &usize| (nodes[*node][1] - middle[1]).atan2(nodes[*node][0] - middle[0]);
    side.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    side.first_chunk().copied()
}

impl Section {
    /// The least and the largest coordinate.
    fn ends(&self, i: usize) -> (f64, f64) {
        let of = |(low, high): (f64, f64), node: &[f64; 2]| (low.min(node[i]), high.max(node[i]));
        self.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), of)
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
    fn new(section: &Section, x: (f64, f64)) -> Self {
        let z = section.ends(1);
        let (wide, high) = (x.1 - x.0, z.1 - z.0);
        let fields = |length: f64| ((FINE as f64 * length / wide.max(high)).round() as usize).clamp(2, FINE);
        Self { x, z, columns: fields(wide), rows: fields(high) }
    }

    /// Height over width.
    fn ratio(&self) -> f64 {
        (self.z.1 - self.z.0) / (self.x.1 - self.x.0)
    }

    /// Linear over the two halves of each cell, and of its images in a body that repeats itself.
    fn raster(&self, section: &Section, values: &[f64], period: Option<f64>) -> Vec<f64> {
        let mut raster = vec![f64::NAN; self.columns * self.rows];
        for cell in &section.cells {
            for half in [[0, 1, 2], [0, 2, 3]] {
                let corners = half.map(|i| cell[i]);
                let at = corners.map(|node| section.nodes[node]);
                for offset in self.offsets(period, at[0][0]) {
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
