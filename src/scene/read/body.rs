//! The deformable body: the `[layer]` or `[mesh]` table, and which material fills what of it.

use std::path::Path;

use super::material;
use crate::error::Result;
use crate::rheology::Loading;
use crate::scene::keys::tables::{ELEMENTS, IN_PLANE, IN_SPACE, SIDES};
use crate::scene::keys::{Section, label};
use crate::scene::{Body, Element, Layer, Material, MeshFile, Sides, Span};

/// One of the two tables; `file` is the scene's.
pub(super) fn read(root: &Section, file: &Path) -> Result<Body> {
    match (root.optional_section("layer")?, root.optional_section("mesh")?) {
        (Some(_), Some(_)) => Err(root.error("mesh", "give [layer] or [mesh], not both")),
        (Some(section), None) => Ok(Body::Layer(layer(&section)?)),
        (None, Some(section)) => Ok(Body::Mesh(mesh(&section, file)?)),
        (None, None) => Err(root.missing("layer", "the [layer] table, or [mesh]")),
    }
}

fn layer(section: &Section) -> Result<Layer> {
    section.only_known()?;
    let widths = section.one_or_two("width")?.ok_or_else(|| section.missing("width", section.what("width")))?;
    let directions = widths.len();
    let depth = section.number("depth")?;
    let cells = section.cells("cells", directions)?;
    let grading = section.optional_number("grading")?.unwrap_or(1.0);
    let sides = sides(section, directions)?;
    let spans = widths.iter().zip(&cells).zip(sides);
    Ok(Layer {
        spans: spans.map(|((&width, &cells), sides)| Span { width, cells, sides }).collect(),
        depth,
        rows: cells[directions],
        grading,
        element: match directions {
            1 => section.optional_choice("element", &IN_PLANE, &[])?.unwrap_or(Element::Quad4),
            _ => section.optional_choice("element", &IN_SPACE, &[])?.unwrap_or(Element::Hex8),
        },
    })
}

/// Of all directions, or of each.
fn sides(section: &Section, directions: usize) -> Result<Vec<Sides>> {
    if !section.table().get("sides").is_some_and(toml::Value::is_array) {
        return Ok(vec![section.choice("sides", &SIDES, &[])?; directions]);
    }
    let known = |value: &toml::Value| SIDES.into_iter().find(|(name, _)| value.as_str() == Some(name));
    let sides: Option<Vec<Sides>> =
        section.values("sides")?.iter().map(|value| known(value).map(|(_, sides)| sides)).collect();
    match sides.filter(|sides| sides.len() == directions && directions == 2) {
        Some(sides) => Ok(sides),
        None => {
            let names: Vec<&str> = SIDES.iter().map(|(name, _)| *name).collect();
            let many = if directions == 2 { "two of" } else { "one of" };
            Err(section.error("sides", format!("must be {many} {}", names.join(", "))))
        }
    }
}

fn mesh(section: &Section, scene: &Path) -> Result<MeshFile> {
    section.later(&[("sides", "name the curves, or surfaces, that are held: fixed, roller")])?;
    section.only_known()?;
    let relative = section.optional_text("file")?.ok_or_else(|| section.missing("file", section.what("file")))?;
    let joined = scene.parent().unwrap_or(Path::new("")).join(relative);
    // Only an empty path has no absolute form, or a directory that is gone.
    let file = std::path::absolute(&joined)
        .map_err(|error| section.error("file", format!("must be {}: {error}", section.what("file"))))?;
    let contact =
        section.optional_label("contact")?.ok_or_else(|| section.missing("contact", section.what("contact")))?;
    let fixed = names(section, "fixed")?;
    if fixed.is_empty() {
        let wrong = if section.has("fixed") { "empty" } else { "missing" };
        let reason = format!(
            "{wrong}; give the names or numbers of what is held (physical curves, in space surfaces), so that the body stays"
        );
        return Err(section.error("fixed", reason));
    }
    let element = section.optional_choice("element", &ELEMENTS, &[])?;
    Ok(MeshFile { file, contact, fixed, roller: names(section, "roller")?, element })
}

/// An array of names or numbers of physical curves or surfaces, each once; empty when absent.
fn names(section: &Section, key: &str) -> Result<Vec<String>> {
    let mut names: Vec<String> = Vec::new();
    for (index, value) in section.values(key)?.iter().enumerate() {
        let at = format!("{key}.{index}");
        match value.as_str().map(str::to_owned).or_else(|| label(value)) {
            Some(name) if names.contains(&name) => {
                return Err(section.error(&at, format!("{name:?} is in the list already")));
            }
            Some(name) => names.push(name),
            None => {
                return Err(section.must_be(
                    &at,
                    "the name or number of a physical curve, in space of a surface",
                    value,
                ));
            }
        }
    }
    Ok(names)
}

/// `[material]`, or one `[[material]]` for each stratum of a layer or region of a mesh, in a loading history.
pub(super) fn materials(root: &Section, body: &Body, loading: Option<&Loading>) -> Result<Vec<Material>> {
    let Ok(sections) = root.sections("material") else {
        return Ok(vec![filling(&root.section("material")?, (body, true), loading)?]);
    };
    let count = sections.len();
    let mut list: Vec<Material> = Vec::new();
    for (index, section) in sections.into_iter().enumerate() {
        let region = section.optional_label("region")?;
        let known = list.iter().position(|other| region.is_some() && other.region == region);
        if let Some(first) = known {
            return Err(section.error("region", format!("is the region of material {first} too; give another")));
        }
        let section = match &region {
            Some(name) => section.called(format!("material.{name}")),
            None => section,
        };
        let material = filling(&section, (body, index + 1 == count), loading)?;
        if matches!(body, Body::Mesh(_)) && region.is_none() && count > 1 {
            return Err(section.missing("region", section.what("region")));
        }
        list.push(material);
    }
    if list.is_empty() { Err(root.missing("material", "the [material] table")) } else { Ok(list) }
}

/// A material and what it fills of the body; `last` if none follows.
fn filling(section: &Section, (body, last): (&Body, bool), loading: Option<&Loading>) -> Result<Material> {
    let material = material::read(section, loading)?;
    let (region, thickness) = (section.optional_label("region")?, thickness(section, body, last)?);
    Ok(Material { region, thickness, ..material })
}

/// The thickness of a stratum, m: of all but the lowest.
fn thickness(section: &Section, body: &Body, last: bool) -> Result<Option<f64>> {
    match body {
        Body::Mesh(_) if section.has("thickness") => Err(section
            .error("thickness", "is for the strata of a [layer]; give region, a physical surface (in space, volume)")),
        Body::Layer(_) if section.has("region") => {
            Err(section.error("region", "is for a [mesh]; give thickness, that of a stratum of the layer"))
        }
        Body::Layer(_) if last && section.has("thickness") => {
            Err(section.error("thickness", "remove it: the last material fills the rest of the layer"))
        }
        Body::Layer(_) if !last => section.number("thickness").map(Some),
        _ => Ok(None),
    }
}
