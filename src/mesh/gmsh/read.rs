//! A .msh file as it stands: the sections, whatever the version.

use super::text::Words;
use super::{Contents, Element, Flaw, Kind, Outcome, v2, v4};

/// Reads a file.
///
/// # Errors
/// [`Flaw::File`] with the line where it is not a .msh file of version 2.2 or 4.1 in ASCII, or holds elements other
/// than points, lines, triangles and quadrilaterals of first order.
pub fn read(bytes: &[u8]) -> Outcome<Contents> {
    // The header of a binary file is text.
    let header = bytes.split(|&byte| byte == b'\n').take(2).collect::<Vec<_>>().join(&b' ');
    let header = String::from_utf8_lossy(&header);
    let mut words = header.split_whitespace();
    let format = (words.next(), words.next(), words.next());
    let read = match format {
        (Some("$MeshFormat"), Some("2.2" | "4.1"), Some("1")) => Err(BINARY.to_owned()),
        (Some("$MeshFormat"), Some(version @ ("2.2" | "4.1")), Some("0")) => match std::str::from_utf8(bytes) {
            Ok(text) => sections(text, version == "2.2"),
            Err(_) => Err(BINARY.to_owned()),
        },
        (Some("$MeshFormat"), Some(version), _) => Err(format!(
            "line 2: is of version {:?}; save it as 4.1 or 2.2 (gmsh -format msh41)",
            version.chars().take(20).collect::<String>()
        )),
        _ => Err("line 1: is not a Gmsh .msh file, which begins with $MeshFormat".to_owned()),
    };
    read.map_err(Flaw::File)
}

const BINARY: &str = "is binary; save it as text (gmsh -bin 0, or Mesh.Binary = 0)";

fn sections(text: &str, legacy: bool) -> Result<Contents, String> {
    let mut words = Words::new(text);
    let mut contents = Contents::default();
    let mut entities = v4::Entities::default();
    let (mut nodes, mut elements) = (false, false);
    while let Some(word) = words.word() {
        let Some(section) = word.strip_prefix('$') else {
            return Err(words.error("must be the beginning of a section, such as $Nodes"));
        };
        match section {
            "PhysicalNames" => physical_names(&mut words, &mut contents)?,
            "Entities" if !legacy => entities = v4::Entities::read(&mut words, &mut contents)?,
            "PartitionedEntities" => return Err(words.error("is partitioned; save it whole: ranks share it out")),
            "Nodes" if legacy => v2::nodes(&mut words, &mut contents)?,
            "Nodes" => v4::nodes(&mut words, &mut contents)?,
            "Elements" if legacy => v2::elements(&mut words, &mut contents)?,
            "Elements" => v4::elements(&mut words, &mut contents, &entities)?,
            other => {
                words.skip_section(other)?;
                continue;
            }
        }
        nodes |= section == "Nodes";
        elements |= section == "Elements";
        words.end_section(section)?;
    }
    match (nodes, elements) {
        (true, true) => Ok(contents),
        (false, _) => Err("has no $Nodes".to_owned()),
        _ => Err("has no $Elements".to_owned()),
    }
}

/// `dimension number "name"` for each.
fn physical_names(words: &mut Words, contents: &mut Contents) -> Result<(), String> {
    let count: usize = words.number("the number of physical names")?;
    for _ in 0..count {
        let dimension = words.number("the dimension of a physical group")?;
        let tag = words.number("the number of a physical group")?;
        let name = words.rest_of_line();
        match name.strip_prefix('"').and_then(|name| name.strip_suffix('"')) {
            Some(name) => contents.names.push((dimension, tag, name.to_owned())),
            None => return Err(words.error("must be a name in double quotes")),
        }
    }
    Ok(())
}

/// Adds an element of Gmsh's `number` whose nodes come next.
pub(super) fn element(
    words: &mut Words,
    contents: &mut Contents,
    number: u32,
    head: (u64, usize),
) -> Result<(), String> {
    let (tag, group) = head;
    let kind = match number {
        1 => Kind::Line,
        2 => Kind::Triangle,
        3 => Kind::Quadrilateral,
        15 => return words.number::<u64>("the number of a node").map(|_| ()),
        8..=10 | 16 | 20..=28 => {
            return Err(words
                .error(format!("element {tag} is of second or higher order; mesh with first order (gmsh -order 1)")));
        }
        4..=7 | 11..=14 | 17..=19 | 29..=31 => {
            return Err(words.error(format!(
                "element {tag} is three-dimensional; mesh in two dimensions (gmsh -2) and save no volume"
            )));
        }
        _ => {
            let what = "only lines, triangles and quadrilaterals are read";
            return Err(words.error(format!("element {tag} is of Gmsh's type {number}; {what}")));
        }
    };
    let mut nodes = [0; 4];
    for node in &mut nodes[..kind.nodes()] {
        *node = words.number("the number of a node")?;
    }
    contents.elements.push(Element { tag, kind, nodes, group });
    Ok(())
}

/// A coordinate, which must be finite.
pub(super) fn place(words: &mut Words) -> Result<[f64; 3], String> {
    let mut place = [0.0_f64; 3];
    for coordinate in &mut place {
        *coordinate = words.number("a coordinate")?;
        if !coordinate.is_finite() {
            return Err(words.error("a coordinate must be finite"));
        }
    }
    Ok(place)
}
