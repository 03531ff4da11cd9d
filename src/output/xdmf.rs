//! The XDMF file beside the results, by which ParaView and VTK read the bulk fields.

use std::fmt::Write as _;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::columns::{self, Components};
use super::scratch::scratch;
use super::{BulkPlan, Extra};
use crate::error::{Error, Result};

/// How a file begins that this program wrote.
pub(super) const BEGIN: &[u8] =
    b"<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<!-- Written by mpjr";

/// Numbers of nodes and cells, and of what belongs to one of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshSize {
    pub nodes: usize,
    pub cells: usize,
    pub axes: usize,
    pub corners: usize,
}

impl MeshSize {
    pub fn of(plan: &BulkPlan) -> Self {
        let BulkPlan { axes, corners, .. } = *plan;
        let nodes = plan.coordinates.len().checked_div(axes).unwrap_or(0);
        let cells = plan.cells.len().checked_div(corners).unwrap_or(0);
        Self { nodes, cells, axes, corners }
    }
}

/// The XDMF file that belongs to a result file.
pub(super) fn beside(results: &Path) -> PathBuf {
    results.with_extension("xdmf")
}

/// The results must not take this file's name.
pub(super) fn refuse_same_name(results: &Path) -> Result<()> {
    match beside(results) == results {
        true => Err(Error::file(results, "is the name of the XDMF file; end the name of the results in .h5")),
        false => Ok(()),
    }
}

/// Removes what an earlier run left: it does not describe the new results.
pub(super) fn remove_stale(results: &Path) -> Result<()> {
    let path = beside(results);
    match std::fs::remove_file(&path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::file(&path, error)),
        _ => Ok(()),
    }
}

/// Writes the file anew with one grid for each of `times`, s; readers see the old one or the new one.
pub(super) fn write(results: &Path, version: &str, (mesh, extra): (MeshSize, Extra), times: &[f64]) -> Result<()> {
    let path = beside(results);
    let scratch = scratch(&path);
    let name = results.file_name().unwrap_or_default().to_string_lossy();
    let document = text(&escape(&name), version, (mesh, extra), times);
    let outcome = std::fs::write(&scratch, document).and_then(|()| std::fs::rename(&scratch, &path));
    if outcome.is_err() {
        // The error at hand says more than one about a leftover.
        let _ = std::fs::remove_file(&scratch);
    }
    outcome.map_err(|error| super::store::failed(&path, error))
}

/// The document. x and z of a plane layer are ParaView's X and Y, and its displacement gets a zero third component; the
/// components of the stress are scalars.
fn text(name: &str, version: &str, (mesh, extra): (MeshSize, Extra), times: &[f64]) -> String {
    let MeshSize { nodes, cells, axes, corners } = mesh;
    let (topology, geometry) = match (axes, corners) {
        (3, 4) => ("Tetrahedron", "XYZ"),
        (3, _) => ("Hexahedron", "XYZ"),
        _ => ("Quadrilateral", "XY"),
    };
    let frames = times.len();
    let mut out = format!(
        r#"{} {version}; the fields are in the HDF5 file of the same name. -->
<Xdmf Version="3.0">
  <Domain>
    <Grid Name="bulk" GridType="Collection" CollectionType="Temporal">
"#,
        String::from_utf8_lossy(BEGIN)
    );
    for (frame, time) in times.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            r#"      <Grid Name="frame {frame}" GridType="Uniform">
        <Time Value="{time:?}"/>
        <Topology TopologyType="{topology}" NumberOfElements="{cells}">
          <DataItem Format="HDF" NumberType="Int" Precision="8" Dimensions="{cells} {corners}">{name}:/bulk/cells</DataItem>
        </Topology>
        <Geometry GeometryType="{geometry}">
          <DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{nodes} {axes}">{name}:/bulk/coordinates</DataItem>
        </Geometry>
"#
        );
        for field in columns::bulk(extra) {
            attributes(&mut out, (name, mesh), (frame, frames), field);
        }
        out.push_str("      </Grid>\n");
    }
    out.push_str("    </Grid>\n  </Domain>\n</Xdmf>\n");
    out
}

/// One field of one frame: a vector, or a scalar for each component.
fn attributes(
    out: &mut String,
    (name, mesh): (&str, MeshSize),
    (frame, frames): (usize, usize),
    field: &columns::BulkField,
) {
    let (label, nodes) = (field.name, mesh.nodes);
    let components = field.components.names(mesh.axes);
    let width = components.len();
    // `count` components from `first` on.
    let slab = |first: usize, count: usize| {
        format!(
            r#"<DataItem ItemType="HyperSlab" NumberType="Float" Precision="8" Dimensions="{nodes} {count}">
              <DataItem Dimensions="3 3" Format="XML">{frame} 0 {first} 1 1 1 1 {nodes} {count}</DataItem>
              <DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{frames} {nodes} {width}">{name}:/bulk/{label}</DataItem>
            </DataItem>"#
        )
    };
    let mut attribute = |label: &str, kind: &str, data: &str| {
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            r#"        <Attribute Name="{label}" AttributeType="{kind}" Center="Node">
            {data}
        </Attribute>
"#
        );
    };
    match (field.components, width) {
        (Components::Axes, 2) => {
            let (x, z) = (slab(0, 1), slab(1, 1));
            let join = format!(
                r#"<DataItem ItemType="Function" Function="JOIN($0, $1, 0 * $1)" Dimensions="{nodes} 3">
            {x}
            {z}
          </DataItem>"#
            );
            attribute(label, "Vector", &join);
        }
        (Components::Scalar, _) => {
            let data = format!(
                r#"<DataItem ItemType="HyperSlab" NumberType="Float" Precision="8" Dimensions="{nodes}">
              <DataItem Dimensions="3 2" Format="XML">{frame} 0 1 1 1 {nodes}</DataItem>
              <DataItem Format="HDF" NumberType="Float" Precision="8" Dimensions="{frames} {nodes}">{name}:/bulk/{label}</DataItem>
            </DataItem>"#
            );
            attribute(label, "Scalar", &data);
        }
        (Components::Axes, _) => attribute(label, "Vector", &slab(0, width)),
        _ => {
            for (index, component) in components.iter().enumerate() {
                attribute(&format!("{label}_{component}"), "Scalar", &slab(index, 1));
            }
        }
    }
}

/// A file name as XML text.
fn escape(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
