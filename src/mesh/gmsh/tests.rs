//! Both versions of one mesh, and what is made of it.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::*;
use crate::mesh::Cell;

/// A plate over a layer of two surfaces that are oriented oppositely, with a triangle pair, an unused node, an arched
/// face, and two groups; version 2.2. Numbers have gaps.
const LEGACY: &str = r#"$MeshFormat
2.2 0 8
$EndMeshFormat
$Comments
any $thing
$EndComments
$PhysicalNames
5
1 1 "contact"
1 2 "base of it"
1 7 "left"
2 3 "plate"
2 4 "layer"
$EndPhysicalNames
$Nodes
10
1 0 -1 0
2 1 -1 0
3 2 -1 0
14 0 -0.5 0
5 1 -0.5 0
6 2 -0.5 0
7 0 0 0
8 1 0.1 0
9 2 0 0
99 5 5 0
$EndNodes
$Elements
11
1 15 2 0 1 1
2 1 2 1 1 9 8
3 1 2 1 1 8 7
4 1 2 2 2 1 2
5 1 2 2 2 2 3
6 1 2 7 3 7 14
7 1 2 7 3 14 1
20 3 2 4 1 1 2 5 14
21 3 2 4 1 2 3 6 5
22 3 2 3 2 14 7 8 5
23 2 2 3 2 5 8 6
24 2 2 3 2 6 8 9
$EndElements
"#;

fn roles() -> Roles {
    Roles {
        contact: "contact".into(),
        fixed: vec!["base of it".into()],
        roller: vec!["left".into()],
        regions: vec!["plate".into(), "layer".into()],
    }
}

/// The same in version 4.1.
fn modern() -> String {
    let head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    let names = LEGACY.split("$PhysicalNames").nth(1).unwrap().split("$EndPhysicalNames").next().unwrap();
    let entities = "$Entities\n1 3 2 0\n1 0 0 0 0\n1 0 0 0 2 0 0 1 1 0\n2 0 -1 0 2 -1 0 1 2 2 1 -1\n\
                    3 0 -1 0 0 0 0 1 -7 0\n1 0 -1 0 2 -.5 0 1 4 3 1 2 3\n2 0 -.5 0 2 0.1 0 1 3 0\n$EndEntities\n";
    let nodes = "$Nodes\n2 10 1 99\n1 1 1 3\n7\n8\n9\n0 0 0 0.5\n1 0.1 0 0.5\n2 0 0 0.5\n\
                 2 1 0 7\n1\n2\n3\n14\n5\n6\n99\n0 -1 0\n1 -1 0\n2 -1 0\n0 -0.5 0\n1 -0.5 0\n2 -0.5 0\n5 5 0\n$EndNodes\n";
    let elements = "$Elements\n7 12 1 24\n0 1 15 1\n1 1\n1 1 1 2\n2 9 8\n3 8 7\n1 2 1 2\n4 1 2\n5 2 3\n1 3 1 2\n6 7 14\n7 14 1\n\
                    2 1 3 2\n20 1 2 5 14\n21 2 3 6 5\n2 2 3 1\n22 14 7 8 5\n2 2 2 2\n23 5 8 6\n24 6 8 9\n$EndElements\n";
    format!("{head}$PhysicalNames{names}$EndPhysicalNames\n{entities}{nodes}{elements}")
}

#[test]
fn both_versions_give_the_same_mesh() {
    // Eleven in the header, twelve in the list.
    let legacy = LEGACY.replace("$Elements\n11", "$Elements\n12");
    for text in [legacy, modern()] {
        let mesh = build(&read(text.as_bytes()).unwrap(), &roles()).unwrap();
        assert_eq!((mesh.nodes.len(), mesh.cells.len()), (9, 5));
        assert_eq!(mesh.regions, [1, 1, 0, 0, 0]);
        // All cells run counter-clockwise, whatever their surface does.
        let area = |cell: &Cell| {
            let corner = |node: u32| mesh.nodes[node as usize];
            cell.edges().map(|(a, b)| corner(a).perp(&corner(b)) / 2.0).sum::<f64>()
        };
        assert!(mesh.cells.iter().all(|cell| area(cell) > 0.2));
        assert!((mesh.cells.iter().map(area).sum::<f64>() - 2.1).abs() < 1e-14);
        // The face runs along +x, its middle on top.
        assert_eq!(mesh.face.x, [0.0, 1.0, 2.0]);
        assert_eq!(mesh.face.recess, [0.1, 0.0, 0.1]);
        assert!((mesh.face.edges[0].tangent.y * mesh.face.edges[0].length - 0.1).abs() < 1e-15);
        assert_eq!(mesh.face.edges[1].ends, [1, 2]);
        // The base is fixed, the left side is held along x only.
        assert_eq!(mesh.held.iter().filter(|held| **held == [true, true]).count(), 3);
        assert_eq!(mesh.held.iter().filter(|held| **held == [true, false]).count(), 2);
    }
}

/// A file drawn in x and z.
#[test]
fn the_plane_may_be_upright() {
    let legacy = LEGACY.replace("$Elements\n11", "$Elements\n12");
    let upright: String = legacy
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            [tag, x, y, "0"] if line != "2.2 0 8" => format!("{tag} {x} 0 {y}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let flat = build(&read(legacy.as_bytes()).unwrap(), &roles()).unwrap();
    assert_eq!(build(&read(upright.as_bytes()).unwrap(), &roles()).unwrap(), flat);
}

/// Whatever line of a file is lost or doubled, there is a reason on one line, or a mesh.
#[test]
fn damaged_files_are_refused() {
    for text in [LEGACY.replace("$Elements\n11", "$Elements\n12"), modern()] {
        let lines: Vec<&str> = text.lines().collect();
        for damaged in 0..lines.len() {
            for copies in [0, 2] {
                let copy = |(i, line): (usize, &&str)| {
                    if i == damaged { [*line, "\n"].concat().repeat(copies) } else { [*line, "\n"].concat() }
                };
                let text: String = lines.iter().enumerate().map(copy).collect();
                match read(text.as_bytes()).and_then(|contents| build(&contents, &roles())) {
                    Err(Flaw::File(reason) | Flaw::Unfit(_, reason)) => assert!(!reason.contains('\n'), "{reason}"),
                    Err(Flaw::Unknown(..)) | Ok(_) => {}
                }
            }
        }
    }
}
