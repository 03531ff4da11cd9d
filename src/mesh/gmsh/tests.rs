//! Both versions of one mesh, and what is made of it.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::*;
use crate::mesh::{Cell, Mesh};

/// A mesh in the plane.
fn build(contents: &Contents, roles: &Roles) -> Outcome<Mesh<2>> {
    super::build(contents, roles).map(|built| match built {
        Built::Plane(mesh) => mesh,
        Built::Space(_) => panic!("a mesh in space"),
    })
}

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
        let area = |cell: &Cell<2>| {
            let corner = |node: u32| mesh.nodes[node as usize];
            cell.sides().map(|side| corner(side[0]).perp(&corner(side[1])) / 2.0).sum::<f64>()
        };
        assert!(mesh.cells.iter().all(|cell| area(cell) > 0.2));
        assert!((mesh.cells.iter().map(area).sum::<f64>() - 2.1).abs() < 1e-14);
        // The face runs along +x, its middle on top.
        assert_eq!(
            mesh.face.places.iter().map(|place| [place.x, -place.y]).collect::<Vec<_>>(),
            [[0.0, 0.1], [1.0, 0.0], [2.0, 0.1]]
        );
        assert_eq!(mesh.face.facets[1].nodes, [1, 2]);
        // The base is fixed, the left side is held along x only.
        assert_eq!(mesh.held.iter().filter(|held| **held == [true, true]).count(), 3);
        assert_eq!(mesh.held.iter().filter(|held| **held == [true, false]).count(), 2);
    }
}

/// Versions 2, 2.0 and 2.1 have the layout of 2.2; comments and a byte order mark may stand before the format, names of
/// one word without quotes.
#[test]
fn what_other_programs_write_is_read_as_well() {
    let legacy = LEGACY.replace("$Elements\n11", "$Elements\n12");
    let expected = build(&read(legacy.as_bytes()).unwrap(), &roles()).unwrap();
    for version in ["2", "2.0", "2.1"] {
        let older = legacy.replacen("2.2 0 8", &format!("{version} 0 8"), 1);
        assert_eq!(build(&read(older.as_bytes()).unwrap(), &roles()).unwrap(), expected);
    }
    for other in [
        format!("\u{feff}{legacy}"),
        format!("$Comments\nmade by hand\n$EndComments\n{legacy}"),
        legacy.replace('\n', "\r\n"),
        legacy.replace("\"contact\"", "contact").replace("\"left\"", "left"),
    ] {
        assert_eq!(build(&read(other.as_bytes()).unwrap(), &roles()).unwrap(), expected, "{other}");
    }
    let unnamed = legacy.replace("1 1 \"contact\"", "1 1 contact face");
    assert_eq!(read(unnamed.as_bytes()), Err(Flaw::File("line 9: must be a name in double quotes".into())));
}

/// A group is found by its name or by its number, names first; the error has both.
#[test]
fn groups_have_numbers() {
    let legacy = LEGACY.replace("$Elements\n11", "$Elements\n12");
    let start = legacy.find("$PhysicalNames").unwrap()..legacy.find("$Nodes").unwrap();
    let mut unnamed = legacy.clone();
    unnamed.replace_range(start, "");
    let text = |name: &str| name.to_owned();
    let numbers = Roles {
        contact: text("1"),
        fixed: vec![text("2")],
        roller: vec![text("7")],
        regions: vec![text("3"), text("4")],
    };
    let expected = build(&read(legacy.as_bytes()).unwrap(), &roles()).unwrap();
    for file in [&unnamed, &legacy] {
        assert_eq!(build(&read(file.as_bytes()).unwrap(), &numbers).unwrap(), expected);
    }
    // A curve that is called "7" goes before the curve number 7.
    let misleading = legacy.replace("\"contact\"", "\"7\"").replace("\"left\"", "\"contact\"");
    let named = Roles { contact: text("7"), roller: vec![text("contact")], ..roles() };
    assert_eq!(build(&read(misleading.as_bytes()).unwrap(), &named).unwrap(), expected);

    let partly = legacy.replace("$PhysicalNames\n5", "$PhysicalNames\n4").replace("1 7 \"left\"\n", "");
    let wrong = Roles { contact: text("top"), ..roles() };
    let known = vec![(1, Some(text("contact"))), (2, Some(text("base of it"))), (7, None)];
    assert_eq!(build(&read(partly.as_bytes()).unwrap(), &wrong), Err(Flaw::Unknown(Role::Contact, 1, known)));
}

/// Gmsh writes no groups into version 2.2 when it saves everything.
#[test]
fn a_file_that_lost_its_groups_is_explained() {
    let mut lost = String::new();
    for line in LEGACY.replace("$Elements\n11", "$Elements\n12").lines() {
        let words: Vec<&str> = line.split(' ').collect();
        lost += &match words[..] {
            [number, kind, "2", _, ref rest @ ..] if rest.len() > 1 => {
                format!("{number} {kind} 2 0 {}\n", rest.join(" "))
            }
            _ => format!("{line}\n"),
        };
    }
    let Err(Flaw::File(reason)) = build(&read(lost.as_bytes()).unwrap(), &roles()) else { panic!("{lost}") };
    assert!(reason.contains("-save_all"), "{reason}");
}

/// Files by Gmsh 4.15 of a square of 1 m with the curves "contact" (1) and 3 and the surface "body" (7): version 2.2 and
/// 4.1 in binary, little-endian as they are and with every number turned round, against its text.
#[test]
fn binary_files_give_the_same_mesh() {
    const TEXT: &[u8] = include_bytes!("../../../tests/scenes/data/gmsh-text-4.1.msh");
    const LEGACY: &[u8] = include_bytes!("../../../tests/scenes/data/gmsh-binary-2.2.msh");
    const MODERN: &[u8] = include_bytes!("../../../tests/scenes/data/gmsh-binary-4.1.msh");

    let roles = Roles { contact: "contact".into(), fixed: vec!["3".into()], regions: vec!["body".into()], ..roles() };
    let roles = Roles { roller: Vec::new(), ..roles };
    let expected = build(&read(TEXT).unwrap(), &roles).unwrap();
    assert_eq!((expected.cells.len(), expected.face.count()), (14, 3));
    for file in [LEGACY.to_vec(), MODERN.to_vec(), turned_2(LEGACY), turned_4(MODERN)] {
        let mesh = build(&read(&file).unwrap(), &roles).unwrap();
        assert_eq!(mesh.cells, expected.cells);
        // Text has fewer digits.
        let off = mesh.nodes.iter().zip(&expected.nodes).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(off < 1e-15, "{off}");
        assert_eq!((&mesh.held, &mesh.face.unknown), (&expected.held, &expected.face.unknown));
        // Cut short anywhere, it is refused or, where only an end is missing, read.
        for length in 0..file.len() {
            if let Err(flaw) = read(&file[..length]) {
                assert!(matches!(&flaw, Flaw::File(reason) if !reason.contains('\n')), "{flaw:?}");
            }
        }
    }
}

/// Copies bytes, turning numbers round.
struct Turning<'a> {
    from: &'a [u8],
    to: Vec<u8>,
}

impl Turning<'_> {
    fn text_until(&mut self, mark: &str) {
        let end = self.from.windows(mark.len()).position(|window| window == mark.as_bytes()).unwrap() + mark.len();
        self.to.extend(&self.from[..end]);
        self.from = &self.from[end..];
    }

    fn turn<const N: usize>(&mut self) -> u64 {
        let (number, rest) = self.from.split_at(N);
        self.to.extend(number.iter().rev());
        self.from = rest;
        number.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
    }

    fn done(mut self) -> Vec<u8> {
        self.to.extend(self.from);
        self.to
    }
}

/// A little-endian file of version 2.2 as a big-endian machine would write it.
fn turned_2(file: &[u8]) -> Vec<u8> {
    let mut turning = Turning { from: file, to: Vec::new() };
    turning.text_until("2.2 1 8\n");
    turning.turn::<4>();
    turning.text_until("$Nodes\n12\n");
    for _ in 0..12 {
        turning.turn::<4>();
        (0..3).for_each(|_| _ = turning.turn::<8>());
    }
    turning.text_until("$Elements\n18\n");
    let mut left = 18;
    while left > 0 {
        let (kind, count, tags) = (turning.turn::<4>(), turning.turn::<4>(), turning.turn::<4>());
        let nodes = if kind == 1 { 2 } else { 3 };
        (0..count * (1 + tags + nodes)).for_each(|_| _ = turning.turn::<4>());
        left -= count;
    }
    turning.done()
}

/// The same of version 4.1.
fn turned_4(file: &[u8]) -> Vec<u8> {
    let mut turning = Turning { from: file, to: Vec::new() };
    turning.text_until("4.1 1 8\n");
    turning.turn::<4>();
    turning.text_until("$Entities\n");
    let counts = [0; 4].map(|_| turning.turn::<8>());
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            turning.turn::<4>();
            (0..if dimension == 0 { 3 } else { 6 }).for_each(|_| _ = turning.turn::<8>());
            for _ in 0..if dimension == 0 { 1 } else { 2 } {
                let tags = turning.turn::<8>();
                (0..tags).for_each(|_| _ = turning.turn::<4>());
            }
        }
    }
    turning.text_until("$Nodes\n");
    let [blocks, ..] = [0; 4].map(|_| turning.turn::<8>());
    for _ in 0..blocks {
        (0..3).for_each(|_| _ = turning.turn::<4>());
        let count = turning.turn::<8>();
        (0..4 * count).for_each(|_| _ = turning.turn::<8>());
    }
    turning.text_until("$Elements\n");
    let [blocks, ..] = [0; 4].map(|_| turning.turn::<8>());
    for _ in 0..blocks {
        let [_, _, kind] = [0; 3].map(|_| turning.turn::<4>());
        let count = turning.turn::<8>();
        (0..count * if kind == 1 { 3 } else { 4 }).for_each(|_| _ = turning.turn::<8>());
    }
    turning.done()
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

/// Files by Gmsh 4.15 of a box of 1 x 1 x 0.5 m in tetrahedra, with the surfaces "contact" (1), "base" (2) and "left" (3) and the volume
/// "body" (7): both versions, text and binary.
#[test]
fn boxes_of_tetrahedra() {
    const FILES: [&[u8]; 4] = [
        include_bytes!("../../../tests/scenes/data/box-text-4.1.msh"),
        include_bytes!("../../../tests/scenes/data/box.msh"),
        include_bytes!("../../../tests/scenes/data/box-binary-2.2.msh"),
        include_bytes!("../../../tests/scenes/data/box-binary-4.1.msh"),
    ];
    let text = |name: &str| name.to_owned();
    let roles = Roles {
        contact: text("contact"),
        fixed: vec![text("base")],
        roller: vec![text("left")],
        regions: vec![text("body")],
    };
    let meshes = FILES.map(|file| match super::build(&read(file).unwrap(), &roles).unwrap() {
        Built::Space(mesh) => mesh,
        Built::Plane(_) => panic!("a box in the plane"),
    });
    let mesh = &meshes[0];
    let volume = |cell: &Cell<3>| {
        let dilatation = crate::element::solid::Dilatation::Pointwise;
        crate::element::solid::Placed { shape: cell.shape(), corners: &mesh.places(cell), dilatation }.volume()
    };
    assert!(mesh.cells.iter().all(|cell| volume(cell) > 0.0));
    assert!((mesh.cells.iter().map(volume).sum::<f64>() - 0.5).abs() < 1e-14);
    let up: nalgebra::Vector3<f64> =
        mesh.face.facets.iter().flat_map(|facet| facet.at_nodes()).map(|point| point.area).sum();
    assert!((up - nalgebra::Vector3::new(0.0, 0.0, 1.0)).norm() < 1e-14 && mesh.face.grid.is_none());
    let held = |held: [bool; 3]| mesh.held.iter().filter(|other| **other == held).count();
    let at = |is: &dyn Fn(&nalgebra::Vector3<f64>) -> bool| mesh.nodes.iter().filter(|node| is(node)).count();
    assert_eq!(held([true; 3]), at(&|node| node.z == -0.5));
    assert_eq!(held([true, false, false]), at(&|node| node.x == 0.0 && node.z > -0.5));
    for other in &meshes[1..] {
        assert_eq!((&other.cells, &other.held, &other.face.unknown), (&mesh.cells, &mesh.held, &mesh.face.unknown));
        let off = other.nodes.iter().zip(&mesh.nodes).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(off < 1e-15, "{off}");
    }
}

/// Two hexahedra, one of them mirrored, over two more: the face is a grid, in whatever order it is numbered; torn or turned over it is refused.
#[test]
fn faces_of_hexahedra() {
    let nodes = [[2.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]];
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"top\"\n2 2 \"base\"\n3 3 \"body\"\n\
                    $EndPhysicalNames\n$Nodes\n12\n"
        .to_owned();
    for (i, [x, y]) in nodes.iter().enumerate() {
        text += &format!("{} {x} {y} 0\n{} {x} {y} {}\n", i + 1, i + 7, -1.0 - 0.1 * x);
    }
    text += "$EndNodes\n$Elements\n6\n1 3 2 1 1 2 3 5 4\n2 3 2 1 1 1 3 5 6\n3 3 2 2 2 8 9 11 10\n4 3 2 2 2 7 9 11 12\n\
             5 5 2 3 3 8 9 11 10 2 3 5 4\n6 5 2 3 3 3 1 6 5 9 7 12 11\n$EndElements\n";
    let roles = |contact: &str, roller: &[&str]| Roles {
        contact: contact.into(),
        fixed: vec!["base".into()],
        roller: roller.iter().map(|name| (*name).to_owned()).collect(),
        regions: Vec::new(),
    };
    let built = |text: &str, roles: &Roles| super::build(&read(text.as_bytes()).unwrap(), roles);
    let Ok(Built::Space(mesh)) = built(&text, &roles("top", &["top"])) else { panic!("no mesh in space") };
    let grid = mesh.face.grid.as_ref().unwrap();
    assert_eq!(
        grid.axes.iter().map(|axis| axis.places.clone()).collect::<Vec<_>>(),
        [vec![0.0, 1.0, 2.0], vec![0.0, 1.0]]
    );
    let places: Vec<[f64; 3]> = mesh.face.places.iter().map(|place| (*place).into()).collect();
    assert_eq!(places[..3], [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    assert!(mesh.face.unknown.iter().all(|&node| mesh.held[node as usize] == [false, false, true]));
    let refused = |text: &str, roles: &Roles| match built(text, roles) {
        Err(Flaw::Unfit(_, reason) | Flaw::File(reason)) => reason,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&text, &roles("top", &["base"])), "must be plane, across x, y or z, to be held across only");
    // The two parts of the face meet at no edge once a part is missing, and at a node that moved they are no sides of cells.
    let torn = text.replace("1 3 2 1 1 2 3 5 4\n", "1 3 2 1 1 2 3 5 9\n");
    assert_eq!(refused(&torn, &roles("top", &[])), "its surface element 1 is no facet of the outline of the body");
    let folded = text.replace("5 5 2 3 3 8 9 11 10 2 3 5 4", "5 5 2 3 3 8 9 11 10 2 5 3 4");
    assert!(
        refused(&folded, &roles("top", &[]))
            .contains("element 5 at (5.0000e-1, 5.0000e-1, -5.2500e-1) m is degenerate")
    );
    let inverted = text.replace("5 5 2 3 3", "5 5 2 2 3").replace("3 3 \"body\"", "3 2 \"body\"");
    assert!(built(&inverted, &roles("top", &[])).is_ok());
}
