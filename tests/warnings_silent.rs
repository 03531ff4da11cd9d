//! Sound scenes, of every kind of body, material, friction law, loading and profile, as fine as one likes and as coarse as is
//! still sound, give no warning: neither before they are solved nor after.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::directory;
use common::program::Run;

const BLOCK: &str = include_str!("scenes/block.toml");
const WAVE: &str = include_str!("scenes/wave.toml");

const TANH: &str = r#"friction={law="coulomb_tanh",coefficient=0.3,regularisation=1e-6}"#;
const SLIP: &str = r#"friction={law="coulomb_elastic_slip",coefficient=0.3,elastic_slip=1e-7}"#;
const ARMS: &str = "material.arms=[{weight=0.3,time=0.01},{weight=0.3,time=0.1}]";
const TABLE_1: &str = "material.arms=[{weight=0.309,time=0.102},{weight=0.226,time=0.545},{weight=0.210,time=4.104}]";
const RATIO: &str = r#"material.poisson_rule="constant_ratio""#;
const BULK: &str = r#"material.poisson_rule="constant_bulk_modulus""#;
const SLIDE: &str = r#"phase=[{name="press",duration=0.5,steps=10,approach=2e-4},{name="slide",velocity=0.01,distance=0.005,steps=60}]"#;
const FRET: &str = r#"phase=[{name="press",duration=0.5,steps=10,approach=2e-4},{name="fret",duration=1.0,steps=40,tangential={amplitude=2e-5,cycles=2}}]"#;
const EIGHT: &str = r#"phase=[{name="press",duration=0.5,steps=10,approach=2e-4},{name="fret",duration=1.0,steps=40,tangential={amplitude=2e-5,cycles=5}}]"#;
const CYCLE: &str = r#"phase=[{name="in",duration=0.5,steps=10,approach=2e-4},{name="hold",duration=10.0,steps=10},{name="out",duration=0.5,steps=10,approach=0.0},{name="again",duration=0.5,steps=10,approach=3e-4}]"#;
const ADAPTIVE: &str = r#"phase=[{name="press",duration=0.5,tolerance=1e-2,approach=2e-4},{name="slide",velocity=0.01,distance=0.005,tolerance=1e-2}]"#;
const TRAVEL: &str =
    r#"phase=[{name="press",duration=10.0,steps=20,approach=1e-3},{name="slide",velocity=0.02,distance=1.0,steps=60}]"#;
const FAST: &str =
    r#"phase=[{name="press",duration=10.0,steps=20,approach=1e-3},{name="slide",velocity=1.0,distance=2.0,steps=200}]"#;
const WARM: &str = "heat={initial=293.0,base=293.0,arms=true}";
const CONDUCTS: &str = "material.conductivity=0.4";
const LIGHT: &str = r#"phase=[{name="press",duration=10.0,steps=20,approach=1e-4}]"#;
const FULL: &str = r#"phase=[{name="press",duration=10.0,steps=20,approach=5e-3}]"#;

/// What is sound: a base and what is changed of it.
#[rustfmt::skip]
const SOUND: &[(&str, &str, &[&str])] = &[
    // Bodies and meshes.
    ("block", BLOCK, &[]),
    ("block, coarse", BLOCK, &["layer.cells=[48,6]"]),
    ("block, fine", BLOCK, &["layer.cells=[320,40]"]),
    ("block, rollers", BLOCK, &[r#"layer.sides="roller""#]),
    ("block, fixed", BLOCK, &[r#"layer.sides="fixed""#]),
    ("block, periodic", BLOCK, &[r#"layer.sides="periodic""#]),
    ("half a block", BLOCK, &[r#"layer.sides="roller""#, "indenter.centre=0"]),
    ("thin block", BLOCK, &["layer.depth=2.5e-3", "layer.cells=[160,8]"]),
    ("block by all unknowns", BLOCK, &[r#"solver.strategy="monolithic""#, TANH, SLIDE]),
    ("wave", WAVE, &[]),
    ("wave, coarse", WAVE, &["layer.cells=[16,8]"]),
    ("wave, fine", WAVE, &["layer.cells=[128,64]"]),
    ("wave, lightly", WAVE, &[LIGHT, "layer.cells=[64,16]", "contact.penalty=1e7"]),
    ("wave, whole face in contact", WAVE, &[FULL]),
    ("two waves", WAVE, &["layer.width=2.0", "layer.cells=[64,16]"]),
    ("a kilometre", WAVE, &["layer.width=1e3", "layer.depth=1e3", "indenter.amplitude=0.5", "indenter.wavelength=1e3", "contact.penalty=1e3", "phase.press.approach=1.0"]),
    ("micrometres", BLOCK, &["layer.width=4e-5", "layer.depth=1e-5", "indenter.radius=2e-5", "indenter.centre=1.5e-5", "phase.press.approach=2e-7"]),
    ("dimensionless", WAVE, &["material.shear_modulus=1.0", "contact.penalty=2e3"]),
    // Materials.
    ("steel", BLOCK, &["material.young_modulus=2.1e11", "phase.press.approach=2e-5", "layer.cells=[160,16]"]),
    ("gel", BLOCK, &["material.young_modulus=500"]),
    ("cork", BLOCK, &["material.poisson_ratio=0.0"]),
    ("auxetic", BLOCK, &["material.poisson_ratio=-0.5"]),
    ("rubber, Poisson ratio 0.45", BLOCK, &["material.poisson_ratio=0.45"]),
    ("rubber, B-bar", BLOCK, &["material.poisson_ratio=0.4999", r#"layer.element="q4_bbar""#]),
    ("thin rubber, B-bar", BLOCK, &["material.poisson_ratio=0.499", r#"layer.element="q4_bbar""#, "layer.depth=2.5e-3", "layer.cells=[160,12]"]),
    ("two arms", BLOCK, &[ARMS, RATIO]),
    ("two arms, backward Euler", BLOCK, &[ARMS, RATIO, r#"material.memory="backward_euler""#]),
    ("two arms, constant bulk modulus", BLOCK, &[ARMS, BULK, "material.poisson_ratio=0.2"]),
    ("bulk arms", BLOCK, &[ARMS, r#"material.poisson_rule="bulk_arms""#, "material.bulk_arms=[{weight=0.2,time=0.05}]"]),
    ("a fluid", BLOCK, &["material.arms=[{weight=1.0,time=0.5}]", RATIO]),
    ("arms of 20 decades", BLOCK, &["material.arms=[{weight=0.3,time=1e-10},{weight=0.3,time=0.3},{weight=0.2,time=1e10}]", RATIO]),
    ("glassy, relaxed a thousand times", BLOCK, &["material.arms=[{weight=0.999,time=1e-6}]", RATIO]),
    ("warm", BLOCK, &[ARMS, RATIO, r#"material.shift="arrhenius""#, "material.activation_energy=5e4", "material.temperature=300", "material.reference_temperature=293"]),
    ("three arms", WAVE, &[TABLE_1, RATIO]),
    ("a power law", WAVE, &[r#"material={poisson_ratio=0.0,poisson_rule="constant_ratio",fractional={modulus=814.7,order=0.226,arms=8}}"#]),
    ("coated", BLOCK, &["material=[{thickness=1e-3,young_modulus=2e6,poisson_ratio=0.3},{young_modulus=2e9,poisson_ratio=0.3}]"]),
    ("hard coat", BLOCK, &["material=[{thickness=1e-3,young_modulus=1e7,poisson_ratio=0.3},{young_modulus=2e6,poisson_ratio=0.3}]"]),
    // Contact.
    ("penalty", BLOCK, &["contact={penalty=1e11}"]),
    ("stiff penalty", BLOCK, &["contact={penalty=1e16}"]),
    ("tolerance of 5 %", BLOCK, &["contact.tolerance=0.05"]),
    ("multipliers from a soft penalty", BLOCK, &[r#"contact={penalty=1e9,method="augmented"}"#]),
    ("Gauss points", BLOCK, &[r#"contact.quadrature="gauss""#, TANH, SLIDE]),
    // Profiles.
    ("circle", BLOCK, &[r#"indenter={profile="circle",radius=0.02,centre=0.015}"#]),
    ("sharp circle", BLOCK, &[r#"indenter={profile="circle",radius=0.005,centre=0.015}"#, "layer.cells=[160,16]", "phase.press.approach=1e-4"]),
    ("wedge", BLOCK, &[r#"indenter={profile="wedge",slope=0.1,centre=0.015}"#]),
    ("wedge between nodes", BLOCK, &[r#"indenter={profile="wedge",slope=0.1,centre=0.01524}"#]),
    ("steep wedge", BLOCK, &[r#"indenter={profile="wedge",slope=0.3,centre=0.015}"#, "layer.cells=[320,24]"]),
    ("formula", BLOCK, &[r#"indenter={profile="expression",formula="25*(x-0.02)^2"}"#]),
    ("raised formula", BLOCK, &[r#"indenter={profile="expression",formula="5e-5+25*(x-0.02)^2"}"#]),
    ("lowered formula", BLOCK, &[r#"indenter={profile="expression",formula="25*(x-0.02)^2-5e-5"}"#]),
    ("flat punch", BLOCK, &[r#"indenter={profile="expression",formula="max(0,abs(x-0.02)-0.005)"}"#]),
    ("flat", BLOCK, &[r#"indenter={profile="expression",formula="0*x"}"#, r#"layer.sides="roller""#, "layer.cells=[3,3]", "layer.grading=1", "phase.press.approach=1e-5"]),
    ("measured", BLOCK, &[r#"indenter={profile="sampled",file="measured.txt",extend="error"}"#]),
    ("measured finely", BLOCK, &[r#"indenter={profile="sampled",file="fine.txt",extend="error"}"#]),
    ("measured wave", WAVE, &[r#"indenter={profile="sampled",file="wave.txt",extend="periodic"}"#]),
    ("rough", WAVE, &[r#"indenter={profile="rough",hurst=0.8,rms_slope=0.01,shortest=0.125,longest=1.0,seed=7}"#, "layer.cells=[128,32]", "contact.penalty=1e7", "phase.press.approach=2e-3"]),
    ("rough and steep", WAVE, &[r#"indenter={profile="rough",hurst=0.8,rms_slope=0.1,shortest=0.125,longest=1.0,seed=3}"#, "layer.cells=[128,32]", "contact.penalty=1e7", "phase.press.approach=2e-2"]),
    ("rough, on a block", BLOCK, &[r#"indenter={profile="rough",hurst=0.8,rms_height=1e-5,shortest=4e-3,longest=4e-2,seed=2}"#, "phase.press.approach=5e-5"]),
    // Friction and loading.
    ("pressed with friction", BLOCK, &[TANH]),
    ("pressed with elastic slip", BLOCK, &[SLIP]),
    ("slides without friction", BLOCK, &[SLIDE]),
    ("slides", BLOCK, &[TANH, SLIDE]),
    ("slides, elastic slip", BLOCK, &[SLIP, SLIDE]),
    ("slides with arms", BLOCK, &[TANH, SLIDE, ARMS, RATIO]),
    ("slides with arms, constant bulk modulus", BLOCK, &[TANH, SLIDE, ARMS, BULK, "material.poisson_ratio=0.2"]),
    ("slides back", BLOCK, &[TANH, SLIDE, "phase.slide.velocity=-0.01"]),
    ("slides in coarse steps", BLOCK, &[TANH, SLIDE, "phase.slide.steps=20"]),
    ("slides at once", BLOCK, &[TANH, r#"phase=[{duration=0.5,steps=40,approach=2e-4,velocity=0.01}]"#]),
    ("coefficient 1", BLOCK, &[TANH, SLIDE, "friction.coefficient=1.0"]),
    ("coefficient 0", BLOCK, &["friction={law=\"coulomb_tanh\",coefficient=0.0,regularisation=1.0}", SLIDE]),
    ("frets", BLOCK, &[TANH, FRET]),
    ("frets, elastic slip", BLOCK, &[SLIP, FRET]),
    ("frets in eight steps", BLOCK, &[SLIP, EIGHT]),
    ("frets with arms", BLOCK, &[SLIP, FRET, ARMS, RATIO]),
    ("in, held, out, in again", BLOCK, &[SLIP, CYCLE]),
    ("in, held, out, in again, with arms", BLOCK, &[CYCLE, ARMS, RATIO]),
    ("chosen steps", BLOCK, &[TANH, ADAPTIVE, ARMS, RATIO]),
    ("warmed by friction", BLOCK, &[TANH, SLIDE, ARMS, RATIO, WARM, CONDUCTS, "material.heat_capacity=5e5"]),
    ("warmed, coupled", BLOCK, &[TANH, SLIDE, ARMS, RATIO, WARM, CONDUCTS, "material.heat_capacity=5e5", "heat.coupled=true", "material.shift=\"wlf\"", "material.c1=5.94", "material.c2=151.6", "material.reference_temperature=293", "material.temperature=293"]),
    ("wave slides", WAVE, &[TRAVEL, TANH, TABLE_1, RATIO]),
    ("wave slides fast", WAVE, &[FAST, TANH, TABLE_1, RATIO]),
    ("wave slides, elastic slip", WAVE, &[TRAVEL, SLIP, TABLE_1, RATIO]),
    ("wave slides, elastic", WAVE, &[TRAVEL, TANH]),
    ("rough slides", WAVE, &[TRAVEL, TANH, r#"indenter={profile="rough",hurst=0.8,rms_slope=0.01,shortest=0.125,longest=1.0,seed=7}"#, "layer.cells=[128,32]", "contact.penalty=1e7"]),
];

/// Of Gmsh meshes: the file and what is changed of a scene in `runs/`.
const MESHES: &[(&str, &str, &[&str])] = &[
    ("appendix-a-bbar", "half_disk.msh", &["phase.oscillate.steps=50"]),
    ("appendix-a-coupled", "half_disk.msh", &[]),
    ("laminate-cells", "laminate.msh", &["phase.hold.steps=20"]),
    ("laminate-strata", "", &["phase.hold.steps=20"]),
    ("laminate-textured", "", &["layer.cells=[16,16,12]"]),
    ("dome", "dome.msh", &[]),
];

fn prepared(scene: &str, changes: &[&str]) -> Run {
    let run = Run::new(scene).argument("-q");
    let table = |count: usize, point: &dyn Fn(f64) -> [f64; 2]| {
        let line = |i: usize| point(i as f64 / count as f64).map(|number| format!("{number:e}")).join(" ") + "\n";
        (0..=count).map(line).collect::<String>()
    };
    let parabola = |t: f64| [0.06 * t - 0.01, 25.0 * (0.06 * t - 0.03).powi(2)];
    let ripple = |t: f64| [0.06 * t - 0.01, 25.0 * (0.06 * t - 0.03).powi(2) + 2e-6 * (900.0 * t).sin()];
    let wave = |t: f64| [t, 5e-4 * (1.0 - (std::f64::consts::TAU * t).cos())];
    for (name, text) in
        [("measured", table(150, &parabola)), ("fine", table(4000, &ripple)), ("wave", table(64, &wave))]
    {
        std::fs::write(run.directory().join(name.to_owned() + ".txt"), text).unwrap();
    }
    changes.iter().fold(run, |run, change| run.set(*change))
}

#[test]
fn sound_scenes_are_silent() {
    assert!(SOUND.len() + MESHES.len() >= 80);
    let mut alarms = Vec::new();
    let mut solve = |name: &str, run: Run| {
        let outcome = run.run();
        if outcome.code != 0 || !outcome.stderr.is_empty() {
            alarms.push(format!("{name}: exit code {}, {}", outcome.code, outcome.stderr));
            return;
        }
        assert_eq!(outcome.stdout, "", "{name}");
        assert!(
            outcome.last("normal_force") >= 0.0 && outcome.history("normal_force").iter().any(|n| *n > 0.0),
            "{name}"
        );
        assert_eq!(outcome.results().warnings().unwrap(), Vec::<String>::new(), "{name}");
    };
    for (name, scene, changes) in SOUND {
        solve(name, prepared(scene, changes));
    }
    for (name, mesh, changes) in MESHES {
        let scene = std::fs::read_to_string(directory("runs").join(format!("{name}.toml"))).unwrap();
        let mut run = prepared(&scene, changes);
        if !mesh.is_empty() {
            run = run.set(format!("mesh.file={:?}", directory("meshes").join(mesh)));
        }
        solve(name, run);
    }
    assert!(alarms.is_empty(), "{} false alarms:\n{}", alarms.len(), alarms.join("\n"));
}
