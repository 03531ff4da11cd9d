//! `mpjr schema`: what an editor needs to complete and check scenes.

use clap::{Args, ValueEnum};

use super::terminal::answer;
use crate::error::{Error, Result};
use crate::scene::schema::{self, File};

/// The arguments of `mpjr schema`.
#[derive(Args)]
pub struct SchemaArguments {
    /// Of which files
    #[arg(value_enum, default_value_t = Of::Any)]
    of: Of,
}

#[derive(Clone, Copy, ValueEnum)]
enum Of {
    /// Scenes, sweeps and material files, told apart by their keys
    Any,
    /// Scenes
    Scene,
    /// Sweeps
    Sweep,
    /// Files of a material
    Material,
}

/// Prints the schema.
pub fn run(arguments: &SchemaArguments) -> Result<()> {
    let schema = schema::schema(match arguments.of {
        Of::Any => File::Any,
        Of::Scene => File::Scene,
        Of::Sweep => File::Sweep,
        Of::Material => File::Material,
    });
    answer(serde_json::to_string_pretty(&schema).map_err(|error| Error::Internal(error.to_string()))?);
    Ok(())
}
