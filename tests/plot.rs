//! `mpjr plot`: every figure of a run, of a sweep and of materials, and what it says of what it cannot draw.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn mpjr(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mpjr"));
    command.current_dir(directory).args(arguments);
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command.output().unwrap()
}

fn succeed(directory: &Path, arguments: &[&str]) -> String {
    let output = mpjr(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The one line of an error and the exit code.
fn fail(directory: &Path, arguments: &[&str]) -> (String, i32) {
    let output = mpjr(directory, arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    (text, output.status.code().unwrap())
}

fn repository(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).display().to_string()
}

/// A small run of the study's layer with bulk fields.
fn run(directory: &Path, out: &str, changes: &[&str]) {
    let scene = repository("runs/paper-layer.toml");
    let small = ["layer.cells=[24,12]", "phase.indent.steps=10", "phase.onset.steps=10", "phase.slide.steps=40"];
    let mut arguments = vec!["run", &scene, "--out", out];
    arguments.extend(small.iter().chain(changes).flat_map(|change| ["--set", change]));
    succeed(directory, &arguments);
}

/// Both files of each figure are there, whole, and have text in them; returns the SVGs.
fn check(directory: &Path, printed: &str, names: &[&str]) -> Vec<String> {
    let files: Vec<PathBuf> = printed.lines().map(|line| directory.join(line)).collect();
    let stems: Vec<_> = files.iter().map(|file| file.file_stem().unwrap().to_str().unwrap()).collect();
    let expected: Vec<_> = names.iter().flat_map(|name| [*name, *name]).collect();
    assert_eq!(stems, expected);
    for file in files.iter().step_by(2) {
        let bytes = std::fs::read(file).unwrap();
        let image = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        assert!(image.info().width >= 1400 && bytes.len() > 10_000, "{}", file.display());
    }
    let svgs = files.iter().skip(1).step_by(2).map(|file| std::fs::read_to_string(file).unwrap());
    svgs.inspect(|svg| assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains(">inf"))).collect()
}

#[test]
fn a_run_has_eight_figures() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let all = ["output.interface_every=1", "output.bulk_at=[\"indent\", \"slide\"]"];
    run(at, "layer.h5", &all);
    let printed = succeed(at, &["plot", "layer.h5", "--out", "figures"]);
    let names = ["history", "reactions", "energy", "tractions", "stress", "stick-slip", "profile", "material"]
        .map(|n| format!("layer-{n}"));
    let svgs = check(at, &printed, &names.each_ref().map(String::as_str));
    for (svg, texts) in svgs.iter().zip([
        &["normal force N, N/m", "f N with f = 0.2", "end of indent and onset"][..],
        &["approach D, ", "tangential displacement, ", "computed"],
        &[
            "work of the indenter",
            "dissipated by friction",
            "work less friction",
            "stored in the layer",
            "what does not balance",
        ],
        &["(a) approach: pressure", "(b) from stick to slip: shear traction", "(c) gross sliding", "pressure p, Pa"],
        &["(a) σ_zz, t = 10 s", "(d) τ_xz", "σ_zz / E(0), 10⁻³", "x, m (shifted by half a period)"],
        &["no contact", "stick", "slip", "time t, s"],
        &["indenter", "face of the layer", "after sliding by"],
        &["relaxation modulus G(t), Pa", "1 arm", "angular frequency"],
    ]) {
        for text in texts {
            assert!(svg.contains(text), "{text}");
        }
    }

    // One figure by its name; without bulk fields the others.
    check(at, &succeed(at, &["plot", "layer.h5", "history", "--out", "one"]), &["layer-history"]);
    run(at, "plain.h5", &["output.energy=false"]);
    let printed = succeed(at, &["plot", "plain.h5"]);
    let names =
        ["history", "reactions", "tractions", "stick-slip", "profile", "material"].map(|n| format!("plain-{n}"));
    check(at, &printed, &names.each_ref().map(String::as_str));
    let (text, code) = fail(at, &["plot", "plain.h5", "stress"]);
    assert!(text.contains("plain.h5: the figure stress cannot be drawn: no bulk fields") && code == 4, "{text}");
    let (text, _) = fail(at, &["plot", "plain.h5", "energy"]);
    assert!(text.contains("the figure energy cannot be drawn: no energies (the scene's output.energy"), "{text}");
    let (text, code) = fail(at, &["plot", "plain.h5", "figure7"]);
    assert!(
        text.contains("no figure figure7; a result file has: history, reactions, energy, tractions") && code == 2,
        "{text}"
    );
}

/// Figures A1 to A3, with the closed forms of the half disk; they are for one material under a parabola.
#[test]
fn appendix_a_has_its_closed_forms() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = repository("runs/appendix-a-bbar.toml");
    let few = ["--set", "phase.indent.steps=2", "--set", "phase.oscillate.steps=5"];
    succeed(at, &[&["run", &scene, "--out", "disk.h5"], &few[..]].concat());
    let printed = succeed(at, &["plot", "disk.h5", "reactions", "--half-disk", "5"]);
    let svg = &check(at, &printed, &["disk-reactions"])[0];
    assert!(svg.contains("closed form") && svg.contains("computed"));
    run(at, "layer.h5", &[]);
    let (text, code) = fail(at, &["plot", "layer.h5", "reactions", "--half-disk", "5"]);
    assert!(text.contains("for one material and a parabola") && code == 4, "{text}");
    let (text, code) = fail(at, &["plot", "disk.h5", "--half-disk", "0"]);
    assert!(text.contains("--half-disk: must be a positive radius in m") && code == 2, "{text}");
}

#[test]
fn frictionless_and_elastic_runs_and_those_that_only_indent_or_only_slide_are_drawn() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    run(at, "elastic.h5", &["material={shear_modulus=500.0, poisson_ratio=0.3}", "output.interface_every=1"]);
    run(at, "fixed.h5", &["layer.sides=fixed", "phase=[{approach=1e-3, duration=1.0, steps=3}]"]);
    run(at, "slides.h5", &["phase=[{approach=1e-3, duration=1.0, steps=3, velocity=0.1}]"]);
    for name in ["elastic", "fixed", "slides"] {
        let printed = succeed(at, &["plot", &format!("{name}.h5")]);
        assert_eq!(printed.lines().count(), 14, "{printed}");
    }
}

#[test]
fn a_sweep_has_figure_7_with_its_bounds() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    std::fs::create_dir(at.join("study")).unwrap();
    let elastic = |modulus: f64| format!("material={{shear_modulus={modulus}, poisson_ratio=0.0}}");
    let materials = [None, Some(elastic(568.4977188479645)), Some(elastic(239.20293167970289))];
    for (i, material) in materials.iter().enumerate() {
        for (j, velocity) in ["0.02154", "0.1"].iter().enumerate() {
            let mut changes =
                vec![format!("phase.slide.velocity={velocity}"), format!("phase.onset.velocity={velocity}")];
            changes.extend(material.clone());
            let changes: Vec<&str> = changes.iter().map(String::as_str).collect();
            run(at, &format!("study/case-{:04}.h5", 2 * i + j), &changes);
        }
    }
    let printed = succeed(at, &["plot", "study", "--out", "figures"]);
    let svgs = check(at, &printed, &["figure7", "onset", "friction", "material"]);
    for text in ["(a) 1 arm; v in m/s", "elastic, G(0)", "elastic, G(∞)", "0.02154", "(b) steady value", "t/t₀"] {
        assert!(svgs[0].contains(text), "{text}");
    }
    for text in ["(c) total friction", "(d) peak", "share of the arms in the work, %", "steady stored energy"] {
        assert!(svgs[2].contains(text), "{text}");
    }
    check(at, &succeed(at, &["plot", "study", "figure7"]), &["figure7"]);

    std::fs::create_dir(at.join("empty")).unwrap();
    let (text, code) = fail(at, &["plot", "empty"]);
    assert!(text.contains("empty: has no finished case") && code == 4, "{text}");
    let (text, code) = fail(at, &["plot", "study", "stress"]);
    assert!(text.contains("the directory of a sweep has: figure7, onset, friction, material") && code == 2, "{text}");
}

#[test]
fn materials_are_drawn_beside_each_other_and_beside_the_power_law() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let [one, two, three] = [1, 2, 3].map(|arms| repository(&format!("runs/materials/eva-{arms}.toml")));
    let printed = succeed(at, &["plot", &one, &two, &three, "--fractional", "814.7,0.226"]);
    let svgs = check(at, &printed, &["eva-1-material"]);
    for text in ["eva-1", "eva-2", "eva-3", "power law", "Loss tangent"] {
        assert!(svgs[0].contains(text), "{text}");
    }
    let stays = "[material]\nshear_modulus = 500.0\npoisson_ratio = 0.3\npoisson_rule = \"constant_bulk_modulus\"\n\
                 arms = [{ weight = 0.5, time = 1.0 }]\n";
    std::fs::write(at.join("stays.toml"), stays).unwrap();
    let svgs = check(at, &succeed(at, &["plot", "stays.toml"]), &["stays-material"]);
    assert!(svgs[0].contains("Poisson ratio"));

    std::fs::write(at.join("wrong.toml"), "[material]\nshear_modulus = -1.0\npoisson_ratio = 0.3\n").unwrap();
    let (text, code) = fail(at, &["plot", "wrong.toml"]);
    assert!(text.contains("wrong.toml: material.shear_modulus: must be a positive modulus") && code == 2, "{text}");
    let (text, code) = fail(at, &["plot", "missing.h5"]);
    assert!(text.contains("missing.h5") && code == 4, "{text}");
    let (text, code) = fail(at, &["plot", &one, "history"]);
    assert!(text.contains("no figure history; a material has: material") && code == 2, "{text}");
}
