//! A .msh file as it stands: the sections, whatever the version.

use super::input::{Form, Input, short};
use super::{Contents, Element, Flaw, Kind, MOST_CORNERS, Outcome, v2, v4};

/// Reads a file.
///
/// # Errors
/// [`Flaw::File`] with the line (or the byte) where it is not a .msh file of version 2.0 to 2.2 or 4.1, or holds elements
/// other than points, lines, triangles, quadrilaterals, tetrahedra and hexahedra of first order.
pub fn read(bytes: &[u8]) -> Outcome<Contents> {
    sections(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).map_err(Flaw::File)
}

const NOT_GMSH: &str = "is not a Gmsh .msh file, which has $MeshFormat before its mesh";

fn sections(bytes: &[u8]) -> Result<Contents, String> {
    let mut input = Input::new(bytes);
    let mut contents = Contents::default();
    let mut entities = v4::Entities::default();
    let mut legacy = None;
    let (mut nodes, mut elements) = (false, false);
    while let Some(word) = input.word() {
        let Some(section) = word.strip_prefix(b"$").and_then(|name| std::str::from_utf8(name).ok()) else {
            return Err(match legacy {
                None => format!("line 1: {NOT_GMSH}"),
                Some(_) => {
                    input.error(format!("must be the beginning of a section, such as $Nodes, got {:?}", short(word)))
                }
            });
        };
        match (section, legacy) {
            ("MeshFormat", _) => legacy = Some(format(&mut input)?),
            ("PhysicalNames", _) => physical_names(&mut input, &mut contents)?,
            ("Entities", Some(false)) => entities = v4::Entities::read(&mut input, &mut contents)?,
            ("PartitionedEntities", _) => return Err(input.error("is partitioned; save it whole: ranks share it out")),
            ("Nodes" | "Elements", None) => return Err(input.error(NOT_GMSH)),
            ("Nodes", Some(true)) => v2::nodes(&mut input, &mut contents)?,
            ("Nodes", Some(false)) => v4::nodes(&mut input, &mut contents)?,
            ("Elements", Some(true)) => v2::elements(&mut input, &mut contents)?,
            ("Elements", Some(false)) => v4::elements(&mut input, &mut contents, &entities)?,
            (other, _) => {
                input.skip_section(other)?;
                continue;
            }
        }
        nodes |= section == "Nodes";
        elements |= section == "Elements";
        input.end_section(section)?;
    }
    match (legacy, nodes, elements) {
        (None, _, _) => Err(format!("line 1: {NOT_GMSH}")),
        (_, true, true) => Ok(contents),
        (_, false, _) => Err("has no $Nodes".to_owned()),
        _ => Err("has no $Elements".to_owned()),
    }
}

/// `version type size` and, in binary, the integer 1, which tells the order of bytes; whether the version is 2.
fn format(input: &mut Input) -> Result<bool, String> {
    let version = input.word().unwrap_or_default();
    // 2.0 and 2.1 differ from 2.2 in what tags an element may have beyond the first two, which are passed over.
    let legacy = match version {
        b"2" | b"2.0" | b"2.1" | b"2.2" => true,
        b"4.1" => false,
        _ => {
            let version = short(version);
            return Err(input.error(format!("is of version {version:?}; save it as 4.1 or 2.2 (gmsh -format msh41)")));
        }
    };
    let (binary, size): (u8, usize) = (input.written("0 or 1, whether binary")?, input.written("the size of a real")?);
    if binary == 0 {
        return Ok(legacy);
    }
    if size != 8 {
        return Err(input.error(format!("has numbers of {size} bytes; only 8 are read")));
    }
    input.next_line();
    input.set_form(Form::LittleEndian);
    match input.int("the integer 1")? {
        1 => {}
        one if one == i64::from(1_i32.swap_bytes()) => input.set_form(Form::BigEndian),
        other => return Err(input.error(format!("must be the integer 1 in 4 bytes, got {other}"))),
    }
    Ok(legacy)
}

/// `dimension number "name"` for each, as text in every file; a name of one word may stand without quotes.
fn physical_names(input: &mut Input, contents: &mut Contents) -> Result<(), String> {
    let count: usize = input.written("the number of physical names")?;
    for _ in 0..count {
        let dimension = input.written("the dimension of a physical group")?;
        let tag = input.written("the number of a physical group")?;
        let name = input.rest_of_line();
        let quoted = name.strip_prefix('"').and_then(|name| name.strip_suffix('"'));
        let word = (!name.is_empty() && !name.contains(['"', ' ', '\t'])).then_some(name.as_str());
        match quoted.or(word) {
            Some(name) => contents.names.push((dimension, tag, name.to_owned())),
            None => return Err(input.error("must be a name in double quotes")),
        }
    }
    Ok(())
}

/// What an element of Gmsh's `number` is; none for a point.
pub(super) fn kind(input: &Input, number: i64, tag: u64) -> Result<Option<Kind>, String> {
    let what = match number {
        1 => return Ok(Some(Kind::Line)),
        2 => return Ok(Some(Kind::Triangle)),
        3 => return Ok(Some(Kind::Quadrilateral)),
        4 => return Ok(Some(Kind::Tetrahedron)),
        5 => return Ok(Some(Kind::Hexahedron)),
        15 => return Ok(None),
        6 => "is a prism; mesh with tetrahedra or hexahedra alone".to_owned(),
        7 => "is a pyramid; mesh with tetrahedra or hexahedra alone".to_owned(),
        8..=14 | 16..=31 => "is of second or higher order; mesh with first order (gmsh -order 1)".to_owned(),
        _ => format!(
            "is of Gmsh's type {number}; only lines, triangles, quadrilaterals, tetrahedra and hexahedra are read"
        ),
    };
    Err(input.error(format!("element {tag} {what}")))
}

/// Adds an element whose nodes are read by `node`.
pub(super) fn element(
    contents: &mut Contents,
    (kind, tag, group): (Option<Kind>, u64, usize),
    mut node: impl FnMut() -> Result<u64, String>,
) -> Result<(), String> {
    let mut nodes = [0; MOST_CORNERS];
    for place in &mut nodes[..kind.map_or(1, Kind::nodes)] {
        *place = node()?;
    }
    contents.elements.extend(kind.map(|kind| Element { tag, kind, nodes, group }));
    Ok(())
}
