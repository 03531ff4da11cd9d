//! The `mpjr` command.

fn main() {
    std::process::exit(mpjr::cli::main());
}
