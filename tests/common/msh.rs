//! Layers as Gmsh files.

use std::fmt::Write;
use std::path::Path;

use mpjr::mesh::Mesh;

/// Writes the mesh of a layer of so many cells in format 2.2, its upper face as "top", the lower one as "base", both sides
/// as "sides", and the regions by `names`.
pub fn write_msh(mesh: &Mesh<2>, [nx, nz]: [usize; 2], names: &[&str], file: &Path) {
    let rows = nz + 1;
    let column = |x: usize| (1..rows).map(move |j| [x * rows + j - 1, x * rows + j]);
    let row = |j: usize| (1..=nx).map(move |i| [(i - 1) * rows + j, i * rows + j]);
    let lines: Vec<(usize, [usize; 2])> = (row(0).map(|ends| (1, ends)))
        .chain(row(rows - 1).map(|ends| (2, ends)))
        .chain(column(0).chain(column(nx)).map(|ends| (3, ends)))
        .collect();
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n".to_owned();
    writeln!(text, "{}\n1 1 \"top\"\n1 2 \"base\"\n1 3 \"sides\"", 3 + names.len()).unwrap();
    for (i, name) in names.iter().enumerate() {
        writeln!(text, "2 {} \"{name}\"", 4 + i).unwrap();
    }
    writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", mesh.nodes.len()).unwrap();
    for (i, node) in mesh.nodes.iter().enumerate() {
        writeln!(text, "{} {:?} {:?} 0", i + 1, node.x, node.y).unwrap();
    }
    writeln!(text, "$EndNodes\n$Elements\n{}", lines.len() + mesh.cells.len()).unwrap();
    for (i, (tag, [a, b])) in lines.iter().enumerate() {
        writeln!(text, "{} 1 2 {tag} {tag} {} {}", i + 1, a + 1, b + 1).unwrap();
    }
    for (i, cell) in mesh.cells.iter().enumerate() {
        let (number, tag) = (lines.len() + i + 1, 4 + mesh.regions[i]);
        let corners: Vec<String> = cell.corners().iter().map(|corner| (corner + 1).to_string()).collect();
        writeln!(text, "{number} 3 2 {tag} {tag} {}", corners.join(" ")).unwrap();
    }
    std::fs::write(file, text + "$EndElements\n").unwrap();
}
