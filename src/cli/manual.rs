//! `mpjr completions` and `mpjr man`: what shells and `man` know of the command line.

use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Arguments;
use super::terminal::{answer, tell};
use crate::error::{Error, Result};

/// The arguments of `mpjr completions`.
#[derive(Args)]
pub struct CompletionsArguments {
    /// For which shell
    shell: Shell,
}

/// The arguments of `mpjr man`.
#[derive(Args)]
pub struct ManArguments {
    /// Write a page for the program and one for each command into this directory
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Prints the completions.
pub fn completions(arguments: &CompletionsArguments) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "mpjr", &mut script);
    answer(String::from_utf8_lossy(&script));
    Ok(())
}

/// Prints the page of the program, or writes all pages.
pub fn man(arguments: &ManArguments) -> Result<()> {
    let Some(directory) = &arguments.out else {
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(Arguments::command()).render(&mut page);
        rendered.map_err(|error| Error::Internal(error.to_string()))?;
        answer(String::from_utf8_lossy(&page));
        return Ok(());
    };
    let wrong = |error: std::io::Error| Error::file(directory, error);
    std::fs::create_dir_all(directory).map_err(wrong)?;
    clap_mangen::generate_to(Arguments::command(), directory).map_err(wrong)?;
    tell(format_args!("{}: read them by man -l {}/mpjr.1", directory.display(), directory.display()));
    Ok(())
}
