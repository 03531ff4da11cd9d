//! Bodies in space as Gmsh files.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

/// Nodes, and hexahedra or tetrahedra.
#[derive(Clone)]
pub struct Body {
    pub nodes: Vec<[f64; 3]>,
    pub cells: Vec<Vec<usize>>,
}

/// A physical surface: its name, and which nodes are on it.
pub type Surface<'a> = (&'a str, &'a dyn Fn(&[f64; 3]) -> bool);

impl Body {
    /// The cells of a layer from 0 to the widths and from 0 down to the depth, as hexahedra.
    pub fn layer([width_x, width_y, depth]: [f64; 3], [nx, ny, nz]: [usize; 3]) -> Self {
        let at = |i: usize, j: usize, k: usize| (i * (ny + 1) + j) * (nz + 1) + k;
        let mut body = Self { nodes: Vec::new(), cells: Vec::new() };
        for i in 0..=nx {
            for j in 0..=ny {
                for k in 0..=nz {
                    let share = |i: usize, n: usize| i as f64 / n as f64;
                    body.nodes.push([width_x * share(i, nx), width_y * share(j, ny), -depth * share(k, nz)]);
                    if i < nx && j < ny && k < nz {
                        let around = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                        let lower = around.iter().map(|[i, j]| at(*i, *j, k + 1));
                        body.cells.push(lower.chain(around.iter().map(|[i, j]| at(*i, *j, k))).collect());
                    }
                }
            }
        }
        body
    }

    /// Each hexahedron as six tetrahedra along its diagonal, which meet those of its neighbours.
    pub fn tetrahedra(mut self) -> Self {
        // From the corner at the origin to the opposite one, an axis after the other; every other way is left-handed.
        const WAYS: [[usize; 4]; 6] =
            [[0, 1, 2, 6], [0, 5, 1, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 4, 5, 6], [0, 7, 4, 6]];
        let split = |cell: &Vec<usize>| WAYS.map(|way| way.map(|corner| cell[corner]).to_vec());
        self.cells = self.cells.iter().flat_map(split).collect();
        self
    }

    /// With each node elsewhere.
    pub fn moved(mut self, to: impl Fn(&[f64; 3]) -> [f64; 3]) -> Self {
        self.nodes.iter_mut().for_each(|node| *node = to(node));
        self
    }

    /// The facets of the outline.
    fn outline(&self) -> Vec<Vec<usize>> {
        const OF_HEXAHEDRON: [&[usize]; 6] =
            [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
        const OF_TETRAHEDRON: [&[usize]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
        let mut known: HashMap<Vec<usize>, (Vec<usize>, usize)> = HashMap::new();
        for cell in &self.cells {
            let sides: &[&[usize]] = if cell.len() == 8 { &OF_HEXAHEDRON } else { &OF_TETRAHEDRON };
            for side in sides {
                let nodes: Vec<usize> = side.iter().map(|&corner| cell[corner]).collect();
                let mut key = nodes.clone();
                key.sort_unstable();
                known.entry(key).or_insert((nodes, 0)).1 += 1;
            }
        }
        let mut outer: Vec<_> = known.into_iter().filter(|(_, (_, count))| *count == 1).collect();
        outer.sort_unstable();
        outer.into_iter().map(|(_, (nodes, _))| nodes).collect()
    }

    /// Writes it in format 2.2, all of its cells in the physical volume "body".
    pub fn write(&self, surfaces: &[Surface<'_>], file: &Path) {
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n".to_owned();
        writeln!(text, "{}\n3 1 \"body\"", 1 + surfaces.len()).unwrap();
        for (i, (name, _)) in surfaces.iter().enumerate() {
            writeln!(text, "2 {} \"{name}\"", 2 + i).unwrap();
        }
        writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", self.nodes.len()).unwrap();
        for (i, [x, y, z]) in self.nodes.iter().enumerate() {
            writeln!(text, "{} {x:?} {y:?} {z:?}", i + 1).unwrap();
        }
        let outline = self.outline();
        let on =
            |is_on: &dyn Fn(&[f64; 3]) -> bool, facet: &[usize]| facet.iter().all(|&node| is_on(&self.nodes[node]));
        let facets = surfaces.iter().enumerate().flat_map(|(i, (_, is_on))| {
            let outline = outline.iter().filter(|facet| on(*is_on, facet));
            outline.map(move |facet| (if facet.len() == 3 { 2 } else { 3 }, 2 + i, facet))
        });
        let cells = self.cells.iter().map(|cell| (if cell.len() == 8 { 5 } else { 4 }, 1, cell));
        let elements: Vec<_> = facets.chain(cells).collect();
        writeln!(text, "$EndNodes\n$Elements\n{}", elements.len()).unwrap();
        for (i, (kind, tag, nodes)) in elements.into_iter().enumerate() {
            let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
            writeln!(text, "{} {kind} 2 {tag} {tag} {}", i + 1, nodes.join(" ")).unwrap();
        }
        std::fs::write(file, text + "$EndElements\n").unwrap();
    }
}
