//! Finds PETSc by pkg-config and writes the Rust declarations of exactly the PETSc names that `src/petsc` calls.

use std::path::PathBuf;

/// The PETSc functions that `src/petsc` calls, and no others.
const FUNCTIONS: &str = include_str!("src/petsc/functions.txt");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=src/petsc/functions.txt");
    println!("cargo:rerun-if-changed=src/petsc/wrapper.h");
    for path in ["HEAD", "logs/HEAD"].iter().filter_map(|name| git(&["rev-parse", "--git-path", name])) {
        // A path that is not there would count as changed at every build.
        if std::path::Path::new(&path).exists() {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    println!("cargo:rustc-env=MPJR_GIT_COMMIT={}", git_commit());

    let petsc = pkg_config::Config::new().atleast_version("3.15").probe("petsc").map_err(|error| {
        format!(
            "PETSc was not found; ci/packages.txt lists the Debian packages; elsewhere set PKG_CONFIG_PATH to the \
                 directory of petsc.pc ($PETSC_DIR/$PETSC_ARCH/lib/pkgconfig)\n{error}"
        )
    })?;
    refuse_complex(&petsc.include_paths)?;
    // petsc.pc names neither MPI's headers nor HDF5's.
    let include_only = |name: &str| {
        let library = pkg_config::Config::new().cargo_metadata(false).probe(name);
        library.map(|library| library.include_paths).map_err(|error| {
            format!(
                "{name} was not found; ci/packages.txt lists the Debian packages; elsewhere set PKG_CONFIG_PATH to \
                     the directory of {name}.pc\n{error}"
            )
        })
    };
    let includes = [petsc.include_paths, include_only("mpi-c")?, include_only("hdf5-openmpi")?].concat();

    let mut builder = bindgen::Builder::default()
        .header("src/petsc/wrapper.h")
        .clang_args(includes.iter().map(|path| format!("-I{}", path.display())))
        .allowlist_recursively(true)
        // MPI's types come from mpi-sys, so that a communicator of the `mpi` crate goes straight into PETSc.
        .blocklist_type("MPI_.*")
        .blocklist_type("ompi_.*")
        .opaque_type("FILE")
        .opaque_type("_IO_.*")
        .default_enum_style(bindgen::EnumVariation::Consts)
        .default_macro_constant_type(bindgen::MacroTypeVariation::Signed)
        .layout_tests(false)
        .generate_comments(false);
    for name in FUNCTIONS.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        builder = if name.chars().next().is_some_and(char::is_uppercase) && name.contains('_') {
            builder.allowlist_var(name)
        } else {
            builder.allowlist_function(name)
        };
    }
    // Reading the headers needs libclang1-14 and libclang-common-14-dev.
    builder.generate()?.write_to_file(PathBuf::from(std::env::var("OUT_DIR")?).join("petsc.rs"))?;
    Ok(())
}

/// Refuses a PETSc whose numbers are complex: its headers say so.
fn refuse_complex(includes: &[PathBuf]) -> Result<(), String> {
    for header in includes.iter().map(|path| path.join("petscconf.h")) {
        let text = std::fs::read_to_string(&header).unwrap_or_default();
        if text.lines().any(|line| line.trim_end() == "#define PETSC_USE_COMPLEX 1") {
            return Err(format!(
                "{} is of a PETSc with complex numbers; mpjr needs one with real numbers (configure PETSc with \
                 --with-scalar-type=real, or let PKG_CONFIG_PATH lead to such a one)",
                header.display()
            ));
        }
    }
    Ok(())
}

/// The commit this build was made from, or "unknown" outside a checkout.
fn git_commit() -> String {
    git(&["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]).unwrap_or_else(|| "unknown".into())
}

/// What git says, where there is a git and a checkout.
fn git(arguments: &[&str]) -> Option<String> {
    let output = std::process::Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
