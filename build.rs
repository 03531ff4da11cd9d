//! Finds PETSc by pkg-config and writes the Rust declarations of exactly the PETSc names that `src/petsc` calls.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The PETSc functions that `src/petsc` calls, and no others.
const FUNCTIONS: &str = include_str!("src/petsc/functions.txt");

/// The oldest PETSc that is tried, and the newest.
const VERSIONS: [&str; 2] = ["3.18", "3.24"];

fn main() -> ExitCode {
    match prepare() {
        Ok(()) => ExitCode::SUCCESS,
        Err(text) => {
            text.lines().for_each(|line| println!("cargo::error={line}"));
            ExitCode::FAILURE
        }
    }
}

fn prepare() -> Result<(), String> {
    println!("cargo:rerun-if-changed=src/petsc/functions.txt");
    println!("cargo:rerun-if-changed=src/petsc/wrapper.h");
    for path in ["HEAD", "logs/HEAD"].iter().filter_map(|name| git(&["rev-parse", "--git-path", name])) {
        // A path that is not there would count as changed at every build.
        if Path::new(&path).exists() {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    println!("cargo:rustc-env=MPJR_GIT_COMMIT={}", git_commit());

    let petsc = find_petsc()?;
    let configured = configuration(&petsc.include_paths)?;
    refuse_unfit(&configured)?;
    // Where PETSc is not among the system's libraries the program has to know where it was.
    for path in petsc.link_paths.iter().filter(|path| !path.starts_with("/usr/lib")) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{}", path.display());
    }
    write_declarations(&[petsc.include_paths, find_mpi()?].concat())
}

/// PETSc's libraries and headers: of `PETSC_DIR` (and `PETSC_ARCH`) where these are set, else of pkg-config's `petsc`.
fn find_petsc() -> Result<pkg_config::Library, String> {
    let variables = ["PETSC_DIR", "PETSC_ARCH"];
    variables.iter().for_each(|name| println!("cargo:rerun-if-env-changed={name}"));
    let [directory, arch] = variables.map(|name| std::env::var(name).unwrap_or_default());
    let file = Path::new(&directory).join(arch).join("lib/pkgconfig/petsc.pc");
    let name = if directory.is_empty() { "petsc".into() } else { file.to_string_lossy() };
    pkg_config::Config::new().atleast_version(VERSIONS[0]).probe(&name).map_err(|error| {
        format!(
            "PETSc {} to {} was not found as {name}: on Debian install what ci/packages.txt lists; elsewhere set PETSC_DIR (and \
             PETSC_ARCH, where PETSc was not installed by a prefix), or set PKG_CONFIG_PATH to the directory of petsc.pc\n{error}",
            VERSIONS[0], VERSIONS[1]
        )
    })
}

/// Where MPI's headers are, which petsc.pc does not say: by the search of mpi-sys, so that both see the same MPI.
fn find_mpi() -> Result<Vec<PathBuf>, String> {
    println!("cargo:rerun-if-env-changed=MPI_PKG_CONFIG");
    println!("cargo:rerun-if-env-changed=MPICC");
    build_probe_mpi::probe().map(|library| library.include_paths).map_err(|errors| {
        let reasons: String = errors.iter().map(|error| format!("\n{error}")).collect();
        format!(
            "MPI was not found: on Debian install what ci/packages.txt lists; elsewhere put the mpicc that PETSc was built with on \
             the PATH, or name it by MPICC, or set MPI_PKG_CONFIG to the name of its .pc{reasons}"
        )
    })
}

/// PETSc's own configuration: the text of petscconf.h.
fn configuration(includes: &[PathBuf]) -> Result<String, String> {
    let headers = includes.iter().map(|path| path.join("petscconf.h"));
    headers.filter_map(|header| std::fs::read_to_string(header).ok()).next().ok_or_else(|| {
        format!("petsc.pc leads to no petscconf.h in {includes:?}: it is of a PETSc that is not there any more")
    })
}

/// Refuses a PETSc that this program cannot be built with, and says how it would have to be configured.
fn refuse_unfit(configured: &str) -> Result<(), String> {
    let has = |name: &str| configured.lines().any(|line| line.trim_end() == format!("#define {name} 1"));
    let unfit = [
        (has("PETSC_USE_COMPLEX"), "has complex numbers", "--with-scalar-type=real"),
        (!has("PETSC_USE_REAL_DOUBLE"), "does not calculate in double precision", "--with-precision=double"),
        (!has("PETSC_HAVE_MUMPS"), "lacks MUMPS", "--download-mumps --download-scalapack"),
    ];
    match unfit.iter().find(|(is, _, _)| *is) {
        None => Ok(()),
        Some((_, what, remedy)) => Err(format!(
            "the PETSc that was found {what}; mpjr needs real numbers in double precision and MUMPS: configure PETSc with \
             {remedy}, or let PETSC_DIR or PKG_CONFIG_PATH lead to such a one"
        )),
    }
}

/// Functions that newer versions of PETSc call otherwise, by the names of the oldest.
#[derive(Debug)]
struct OlderNames;

impl bindgen::callbacks::ParseCallbacks for OlderNames {
    fn generated_name_override(&self, function: bindgen::callbacks::ItemInfo<'_>) -> Option<String> {
        (function.name == "SNESLineSearchShellSetApply").then(|| "SNESLineSearchShellSetUserFunc".into())
    }
}

/// The Rust declarations of what `src/petsc` calls.
fn write_declarations(includes: &[PathBuf]) -> Result<(), String> {
    let mut builder = bindgen::Builder::default()
        .header("src/petsc/wrapper.h")
        .parse_callbacks(Box::new(OlderNames))
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
    let declarations = builder.generate().map_err(|error| {
        format!(
            "PETSc's headers cannot be read by libclang: where a header such as stddef.h is missing, install clang's own \
             (Debian: libclang-common-14-dev); where PETSc has another MPI than the mpicc that was found, name its \
             by MPICC or MPI_PKG_CONFIG\n{error}"
        )
    })?;
    let out = std::env::var("OUT_DIR").map_err(|error| error.to_string())?;
    declarations.write_to_file(PathBuf::from(out).join("petsc.rs")).map_err(|error| error.to_string())
}

/// The commit this build was made from: git's, or outside a checkout that of the file COMMIT, which source packages have, or "unknown".
fn git_commit() -> String {
    if let Ok(commit) = std::fs::read_to_string("COMMIT") {
        return commit.trim().to_owned();
    }
    git(&["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]).unwrap_or_else(|| "unknown".into())
}

/// What git says, where there is a git and a checkout.
fn git(arguments: &[&str]) -> Option<String> {
    let output = std::process::Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
