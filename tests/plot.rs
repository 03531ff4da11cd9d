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
    let small = [
        "layer.cells=[24,12]",
        "material.poisson_rule=constant_ratio",
        "phase.indent.steps=10",
        "phase.onset.steps=10",
        "phase.slide.steps=40",
    ];
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
        assert!(image.info().width >= 1000 && bytes.len() > 10_000, "{}", file.display());
    }
    let svgs = files.iter().skip(1).step_by(2).map(|file| std::fs::read_to_string(file).unwrap());
    svgs.inspect(|svg| assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains(">inf"))).collect()
}

/// The texts of a figure in drawing order, a subscript as one of its own.
fn texts(svg: &str) -> Vec<&str> {
    let lines: Vec<&str> = svg.lines().collect();
    lines.windows(2).filter(|pair| pair[0].starts_with("<text")).map(|pair| pair[1]).collect()
}

/// The left and right ends of the frames of a figure, in drawing order.
fn frames(svg: &str) -> Vec<(f64, f64)> {
    let closed = |line: &str| {
        let points: Vec<&str> = line.split_once("points=\"")?.1.split_once('"')?.0.split_whitespace().collect();
        let x = |point: &str| point.split_once(',').and_then(|(x, _)| x.parse::<f64>().ok());
        (points.len() == 5 && points[0] == points[4]).then(|| Some((x(points[0])?, x(points[2])?)))?
    };
    svg.lines().filter(|line| line.contains("stroke=\"#282828\"")).filter_map(closed).collect()
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
    for (svg, wanted) in svgs.iter().zip([
        &["(a) Normal force", "N, N/m", "f N", "end of indent and onset"][..],
        // The indenter slides hundreds of times as far as it is pressed in.
        &[
            "(a) Imposed approach",
            "approach D",
            "(b) Imposed sliding",
            "sliding s",
            "(d) Tangential force",
            "time t, s",
        ],
        &[
            "work of the indenter",
            "dissipated by friction",
            "work less friction",
            "stored in the layer",
            "(c) What does not balance",
        ],
        &[
            "(a) Approach",
            "(b) From stick to slip",
            "(c) Gross sliding",
            "slid\u{a0}distance s, mm",
            "s/λ",
            "q/(f E(0))",
        ],
        &["zz", "\u{a0}at\u{a0}t\u{a0}=\u{a0}10\u{a0}s", "/E(0),\u{a0}10⁻⁴", "x, m"],
        &["no contact", "stick", "slip", "time t, s"],
        &["indenter", "face of the body"],
        &["E(t), Pa", "1 arm", "(b) Loss modulus", "(c) Storage modulus", "(d) Loss tangent"],
    ]) {
        let found = texts(svg);
        for text in wanted {
            assert!(
                found.iter().any(|found| found.replace('\u{a0}', " ").contains(&text.replace('\u{a0}', " "))),
                "{text}: {found:?}"
            );
        }
        // No letter stands for two panels, and no mark of a subscript is left.
        let mut letters: Vec<&str> = found.iter().filter(|text| text.starts_with('(')).map(|text| &text[..3]).collect();
        letters.retain(|text| text.ends_with(')'));
        let all = letters.len();
        letters.dedup();
        assert!(all > 1 && letters.len() == all && !svg.contains("_{"), "{letters:?}");
    }
    // The time axes of a column begin and end at the same places.
    for (svg, panels) in [(&svgs[0], 3), (&svgs[1], 4), (&svgs[2], 3), (&svgs[5], 3)] {
        let frames = frames(svg);
        assert!(frames.len() == panels && frames.iter().all(|frame| *frame == frames[0]), "{frames:?}");
    }
    // The power law that the material was fitted to is the unit of tractions and stresses.
    let law = ["plot", "layer.h5", "tractions", "stress", "--fractional", "814.7,0.226", "--out", "law"];
    let svgs = check(at, &succeed(at, &law), &["layer-tractions", "layer-stress"]);
    for svg in &svgs {
        assert!(texts(svg).contains(&"f,0") && svg.contains("814.7") && !svg.contains("E(0)"));
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
    let (text, _) = fail(at, &["plot", "plain.h5", "wear"]);
    assert!(text.contains("the figure wear cannot be drawn: no wear (the scene's [wear] asks for it)"), "{text}");
    let (text, code) = fail(at, &["plot", "plain.h5", "figure7"]);
    assert!(
        text.contains("no figure figure7; a result file has: history, reactions, energy, temperature, tractions")
            && code == 2,
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
    for text in [
        "(a) Imposed displacements",
        "disk fixed along its arc",
        "half-plane, Eq. (A4)",
        "computed",
        "±f N",
        "approach D",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    let ends = ["run", &scene, "--out", "ends.h5", "--set", "output.interface_every=0"];
    succeed(at, &[&ends[..], &few[..]].concat());
    let (text, code) = fail(at, &["plot", "ends.h5", "reactions", "--half-plane", "5"]);
    assert!(text.contains("needs the face at every step for this: output.interface_every = 1") && code == 4, "{text}");
    succeed(at, &[&["run", &scene, "--out", "disk.h5"], &few[..]].concat());
    let printed = succeed(at, &["plot", "disk.h5", "reactions", "--half-plane", "3"]);
    let svg = &check(at, &printed, &["disk-reactions"])[0];
    assert!(svg.contains("beyond the face at 3 m") && svg.contains("Eq. (A4)") && !svg.contains("its arc"));
    run(at, "layer.h5", &[]);
    let (text, code) = fail(at, &["plot", "layer.h5", "reactions", "--half-disk", "5"]);
    assert!(text.contains("for one material and a parabola") && code == 4, "{text}");
    let (text, code) = fail(at, &["plot", "disk.h5", "--half-disk", "0"]);
    assert!(text.contains("--half-disk: must be a positive length in m") && code == 2, "{text}");
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
        for (j, velocity) in ["0.004642", "0.1"].iter().enumerate() {
            let mut changes =
                vec![format!("phase.slide.velocity={velocity}"), format!("phase.onset.velocity={velocity}")];
            changes.extend(material.clone());
            let changes: Vec<&str> = changes.iter().map(String::as_str).collect();
            run(at, &format!("study/case-{:04}.h5", 2 * i + j), &changes);
        }
    }
    let printed = succeed(at, &["plot", "study", "--out", "figures"]);
    let svgs = check(at, &printed, &["figure7", "onset", "friction", "material"]);
    for text in ["(a) 1 arm", "elastic, G(0)", "elastic, G(∞)", "4.642·10⁻³", "10⁻¹", "(b) ", "velocity v, m/s"]
    {
        assert!(texts(&svgs[0]).iter().any(|found| found.contains(text)), "{text}");
    }
    // Steady is said of what is steady; how steady, in any case.
    assert!(svgs[0].contains("in which N varies by up to"));
    for text in ["(c) Total friction", "(d) Peak", "share of the work, %", "stored energy at the end"] {
        assert!(svgs[2].contains(text), "{text}");
    }
    check(at, &succeed(at, &["plot", "study", "figure7"]), &["figure7"]);

    std::fs::create_dir(at.join("empty")).unwrap();
    let (text, code) = fail(at, &["plot", "empty"]);
    assert!(text.contains("empty: has no finished case") && code == 4, "{text}");
    let (text, code) = fail(at, &["plot", "study", "stress"]);
    assert!(text.contains("the directory of a sweep has: figure7, onset, friction, material") && code == 2, "{text}");
}

/// Each value of another key than the velocity has its own name; a second key has panels of its own.
#[test]
fn a_sweep_of_other_keys_is_told_apart_by_them() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let scene = format!("scene = {:?}\n[vary]\n", at.join("small.toml"));
    let small = std::fs::read_to_string(repository("runs/paper-layer.toml")).unwrap();
    let small = small.replace("cells  = [128, 128]", "cells = [16, 8]").replace("steps = 100", "steps = 10");
    let end = small.rfind("\nsteps = ").unwrap();
    let rest = small[end + 1..].split_once('\n').unwrap().1;
    std::fs::write(at.join("small.toml"), format!("{}\nsteps = 40\n{rest}", &small[..end])).unwrap();
    let sweep = |name: &str, keys: &str| {
        std::fs::write(at.join(format!("{name}.toml")), format!("{scene}{keys}")).unwrap();
        succeed(at, &["sweep", &format!("{name}.toml"), "--out", name]);
        let printed = succeed(at, &["plot", name, "figure7", "--out", &format!("{name}-figures")]);
        check(at, &printed, &["figure7"]).remove(0)
    };
    let values = ["0.05", "0.1", "0.15", "0.25", "0.3", "0.45"];
    let svg = sweep("one", &format!("\"friction.coefficient\" = [{}]\n", values.join(", ")));
    let found = texts(&svg);
    assert!(values.iter().all(|value| found.contains(value)), "{found:?}");
    assert_eq!(found.iter().filter(|text| **text == "friction.coefficient").count(), 2, "{found:?}");
    assert!(!svg.contains("velocity"));

    let keys = "\"material.poisson_ratio\" = [0.1, 0.3]\n\"friction.coefficient\" = [0.1, 0.2]\n";
    let svg = sweep("two", keys);
    for text in ["(a) material.poisson_ratio = 0.1", "(b) material.poisson_ratio = 0.3", "(c) "] {
        assert!(texts(&svg).iter().any(|found| found.starts_with(text)), "{text}");
    }
    // Without the summary nothing says what tells the cases apart.
    std::fs::remove_file(at.join("one/summary.csv")).unwrap();
    let (text, code) = fail(at, &["plot", "one"]);
    assert!(text.contains("one: has no summary.csv, which says what was varied") && code == 4, "{text}");
}

/// The figure to draw, a name, what is said, and what is done to the file.
type Damage = (&'static str, &'static str, &'static str, fn(&hdf5::File));

/// Numbers in a file that cannot be are named; nothing panics.
#[test]
fn a_damaged_result_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let small = ["output.bulk_at=[\"indent\"]", "layer.cells=[8,4]"];
    let damages: [Damage; 4] = [
        ("stress", "cells", "/bulk/cells names node", |file| {
            let cells = file.dataset("bulk/cells").unwrap();
            let mut values = cells.read_raw::<i64>().unwrap();
            values[5] = 1_000_000_000;
            cells.write_raw(&values).unwrap();
        }),
        ("stress", "negative", "/bulk/cells names node", |file| {
            let cells = file.dataset("bulk/cells").unwrap();
            let mut values = cells.read_raw::<i64>().unwrap();
            values[0] = -1;
            cells.write_raw(&values).unwrap();
        }),
        ("tractions", "pressure", "/interface/pressure", |file| {
            let pressure = file.dataset("interface/pressure").unwrap();
            let mut values = pressure.read_raw::<f64>().unwrap();
            values[3] = f64::NAN;
            pressure.write_raw(&values).unwrap();
        }),
        ("history", "time", "/history/time", |file| {
            let time = file.dataset("history/time").unwrap();
            let mut values = time.read_raw::<f64>().unwrap();
            values[2] = f64::INFINITY;
            time.write_raw(&values).unwrap();
        }),
    ];
    for (figure, name, reason, damage) in damages {
        let file = format!("{name}.h5");
        run(at, &file, &small);
        damage(&hdf5::File::open_rw(at.join(&file)).unwrap());
        let (text, code) = fail(at, &["plot", &file, figure]);
        assert!(text.contains(&format!("{file}: is damaged: {reason}")) && code == 4, "{text}");
    }
}

/// A PNG without its SVG is not left where the disk is full: here files end at 300 kB, which the PNG is below.
#[test]
fn both_files_are_written_or_none() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    run(at, "layer.h5", &["output.bulk_at=[\"indent\", \"slide\"]"]);
    let script =
        format!("trap '' XFSZ; ulimit -f 300; exec {} plot layer.h5 stress --out full", env!("CARGO_BIN_EXE_mpjr"));
    let mut command = Command::new("bash");
    command.current_dir(at).args(["-c", &script]);
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(4) && text.contains("layer-stress.svg"), "{text}");
    assert_eq!(std::fs::read_dir(at.join("full")).unwrap().count(), 0);
    succeed(at, &["plot", "layer.h5", "stress", "--out", "full"]);
}

#[test]
fn materials_are_drawn_beside_each_other_and_beside_the_power_law() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let [one, two, three] = [1, 2, 3].map(|arms| repository(&format!("runs/materials/eva-{arms}.toml")));
    let printed = succeed(at, &["plot", &one, &two, &three, "--fractional", "814.7,0.226"]);
    let svgs = check(at, &printed, &["eva-1-material"]);
    for text in [
        "1 arm",
        "2 arms",
        "3 arms",
        "power law",
        "(a) Relaxation modulus",
        "(b) Loss modulus",
        "(c) Storage modulus",
        "(d) Loss tangent",
    ] {
        assert!(svgs[0].contains(text), "{text}");
    }
    let stays = "[material]\nshear_modulus = 500.0\npoisson_ratio = 0.3\npoisson_rule = \"constant_bulk_modulus\"\n\
                 arms = [{ weight = 0.5, time = 1.0 }]\n";
    std::fs::write(at.join("stays.toml"), stays).unwrap();
    let svgs = check(at, &succeed(at, &["plot", "stays.toml"]), &["stays-material"]);
    assert!(svgs[0].contains("Poisson ratio"));
    // Materials with as many arms go by their files.
    let svgs = check(at, &succeed(at, &["plot", "stays.toml", &one]), &["stays-material"]);
    assert!(["stays", "eva-1"].iter().all(|name| texts(&svgs[0]).contains(name)));

    std::fs::write(at.join("wrong.toml"), "[material]\nshear_modulus = -1.0\npoisson_ratio = 0.3\n").unwrap();
    let (text, code) = fail(at, &["plot", "wrong.toml"]);
    assert!(text.contains("wrong.toml: material.shear_modulus: must be a positive modulus") && code == 2, "{text}");
    let (text, code) = fail(at, &["plot", "missing.h5"]);
    assert!(text.contains("missing.h5") && code == 4, "{text}");
    let (text, code) = fail(at, &["plot", &one, "history"]);
    assert!(text.contains("no figure history; a material has: material") && code == 2, "{text}");
}

/// A run in space is drawn from above and along both directions, with forces in N; in the plane that is refused.
#[test]
fn a_run_in_space_has_eleven_figures() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    succeed(at, &["new", "ball.toml", "--like", "space"]);
    let bulk = "output.bulk_at=[\"press\", \"drag\"]";
    succeed(
        at,
        &["run", "ball.toml", "-q", "--set", "layer.cells=[12,10,4]", "--set", "phase.drag.steps=5", "--set", bulk],
    );
    let printed = succeed(at, &["plot", "ball.h5"]);
    let names = [
        "history",
        "reactions",
        "energy",
        "tractions",
        "stress",
        "stick-slip",
        "profile",
        "pressure",
        "shear",
        "gap",
        "material",
    ]
    .map(|name| format!("ball-{name}"));
    let svgs = check(at, &printed, &names.each_ref().map(String::as_str));
    for (svg, wanted) in svgs.iter().zip([
        &["N, N", "along x", "along y"][..],
        &["N, N"],
        &["energy, 10", " J\n"],
        &["(a) Along x at y = ", "(b) Along y at x = ", "y, m"],
        &["zz", ", y = 0.0"],
        &["no contact", "stick", "slip", "y, m"],
        &["(d) Along y at x = ", "face of the body"],
        &["p/E(0)", "y, m"],
        &["|q|/E(0)", "arrows: "],
        &["gap, 10", "white: contact"],
        &["E(t), Pa"],
    ]) {
        let found = texts(svg).join("\n").replace('\u{a0}', " ");
        assert!(wanted.iter().all(|text| found.contains(text)), "{wanted:?}: {found}");
    }
    // Both moments over the same part of the face: a frame and a bar each.
    let pressure = frames(&svgs[7]);
    let width = |frame: usize| pressure[frame].1 - pressure[frame].0;
    assert!(pressure.len() == 4 && (width(0) - width(2)).abs() < 1.0 && width(0) > 4.0 * width(1), "{pressure:?}");
    run(at, "plane.h5", &[]);
    for figure in ["pressure", "shear", "gap"] {
        let (message, code) = fail(at, &["plot", "plane.h5", figure]);
        assert!(code == 4 && message.contains("it is for runs in space"), "{message}");
    }
}
