//! Dimension scales: which dataset holds the coordinates of each dimension of another ("HDF5 Dimension Scale
//! Specification and Design Notes"), so that xarray, netCDF and h5py's `dims` know them.

use hdf5::types::VarLenArray;
use hdf5::{Dataset, H5Type, ObjectReference1};

use crate::petsc::fixed_text::fixed_text;

/// A dimension of a dataset, as a scale lists it.
#[derive(H5Type, Clone, Copy)]
#[repr(C)]
struct Use {
    dataset: ObjectReference1,
    dimension: i32,
}

/// Attaches to each dataset the scales of its dimensions, named from the root. A dataset that is its own scale is one
/// that others are measured by.
pub(super) fn attach<'a>(
    file: &hdf5::File,
    sets: impl Iterator<Item = (&'a Dataset, &'a [String])> + Clone,
) -> hdf5::Result<()> {
    let is_scale = |set: &Dataset, scales: &[String]| {
        scales.len() == 1 && set.name().strip_prefix('/') == scales.first().map(String::as_str)
    };
    let measured = || sets.clone().filter(|(set, scales)| !is_scale(set, scales));
    for (scale, names) in sets.clone().filter(|(set, scales)| is_scale(set, scales)) {
        let Some(name) = names.first() else { continue };
        fixed_text(scale, "CLASS", "DIMENSION_SCALE")?;
        fixed_text(scale, "NAME", name.rsplit('/').next().unwrap_or_default())?;
        let mut uses = Vec::new();
        for (set, scales) in measured() {
            for dimension in (0..scales.len()).filter(|&dimension| scales.get(dimension) == Some(name)) {
                uses.push(Use { dataset: file.reference(&set.name())?, dimension: dimension as i32 });
            }
        }
        if !uses.is_empty() {
            scale.new_attr::<Use>().shape(uses.len()).create("REFERENCE_LIST")?.write_raw(&uses)?;
        }
    }
    for (set, scales) in measured() {
        let references = |name: &String| Ok(VarLenArray::from_slice(&[file.reference::<ObjectReference1>(name)?]));
        let list = scales.iter().map(references).collect::<hdf5::Result<Vec<VarLenArray<ObjectReference1>>>>()?;
        set.new_attr::<VarLenArray<ObjectReference1>>().shape(list.len()).create("DIMENSION_LIST")?.write_raw(&list)?;
    }
    Ok(())
}
