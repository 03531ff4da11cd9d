//! `mpjr new`: a first scene, with what its keys mean beside them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::terminal::tell;
use crate::error::{Error, Result};
use crate::scene::schema::{self, File};

/// The schema beside the scene, by which editors complete and check it.
const SCHEMA: &str = "mpjr.schema.json";

/// The arguments of `mpjr new`.
#[derive(Args)]
pub struct NewArguments {
    /// The scene to be written
    #[arg(value_name = "NAME.toml")]
    file: PathBuf,
    /// What it is like
    #[arg(long, value_enum, default_value_t = Like::Layer)]
    like: Like,
}

#[derive(Clone, Copy, ValueEnum)]
enum Like {
    /// A periodic layer under a wavy indenter: one arm, Coulomb's law
    Layer,
    /// A wheel on a strip of rubber, pressed and dragged
    Wheel,
    /// A rough surface on a periodic layer, held by a force
    Rough,
    /// Strata of glass and a polymer under a round indenter
    Laminate,
    /// A ball on a block, in three dimensions
    Space,
}

impl Like {
    fn text(self) -> &'static str {
        match self {
            Self::Layer => include_str!("new/layer.toml"),
            Self::Wheel => include_str!("new/wheel.toml"),
            Self::Rough => include_str!("new/rough.toml"),
            Self::Laminate => include_str!("new/laminate.toml"),
            Self::Space => include_str!("new/space.toml"),
        }
    }
}

/// Writes the scene and, beside it, the schema.
pub fn run(arguments: &NewArguments) -> Result<()> {
    let file = &arguments.file;
    if file.extension().is_none_or(|end| end != "toml") {
        return Err(Error::Usage(format!("{}: must be the name of a file that ends in .toml", file.display())));
    }
    let schema = file.with_file_name(SCHEMA);
    write(file, &format!("#:schema ./{SCHEMA}\n{}", arguments.like.text()))?;
    let json = serde_json::to_string_pretty(&schema::schema(File::Any));
    // One that is there may be of a version that the other scenes beside it were written for.
    if !schema.exists() {
        write(&schema, &json.map_err(|error| Error::Internal(error.to_string()))?)?;
    }
    tell(format_args!("{}: look at it by mpjr check, solve it by mpjr run; {SCHEMA} is for editors", file.display()));
    Ok(())
}

/// Writes a file that is not there yet.
fn write(file: &Path, text: &str) -> Result<()> {
    use std::io::Write;
    let made = std::fs::File::options().write(true).create_new(true).open(file);
    made.and_then(|mut made| made.write_all(text.as_bytes())).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => Error::file(file, "exists; give another name"),
        _ => Error::file(file, error),
    })
}
