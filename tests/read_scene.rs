//! Good scenes: what is read, what is resolved, and that what is resolved can be read again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::PathBuf;

use common::smallest::{SMALLEST, assert_round_trip, read_set};
use mpjr::error::{Error, Result};
use mpjr::scene::*;
use nalgebra::Vector2;

fn error_at(result: Result<Scene>) -> String {
    match result {
        Err(Error::Scene { key, .. }) => key,
        other => panic!("not an error of a scene: {other:?}"),
    }
}

fn layer(scene: &Scene) -> &Layer {
    scene.layer().expect("a layer")
}

#[test]
fn what_may_be_absent_has_its_default() {
    let scene = read_set(SMALLEST, &[]).unwrap();
    assert_eq!(scene.title, "smallest");
    assert_eq!((layer(&scene).grading, layer(&scene).element), (1.0, Element::Quad4));
    let [material] = scene.materials.as_slice() else { panic!("one material") };
    assert!((material.shear_modulus - 1.0).abs() < 1e-15);
    assert_eq!((material.arms.len(), material.poisson_rule), (0, None));
    assert_eq!((material.memory, &material.region, material.thickness), (Memory::Exponential, &None, None));
    assert_eq!(scene.contact.quadrature, Quadrature::Nodal);
    assert_eq!(scene.friction, None);
    assert_eq!(scene.solver, Solver { strategy: Strategy::Auto, tolerance: 1e-8 });
    assert_eq!(scene.output, Output { interface_every: 1, bulk_at: vec![], checkpoint_every: 0, energy: true });
    let [first, second] = scene.phases.as_slice() else { panic!("two phases") };
    assert_eq!((first.name.as_str(), second.name.as_str()), ("phase-1", "phase-2"));
    assert_eq!((first.approach, &first.motion), (None, &Motion::Velocity(Vector2::zeros())));
    // The distance is the length of the way, whichever way.
    assert_eq!((second.duration, &second.motion), (2.0, &Motion::Velocity([-0.5, 0.0].into())));
}

#[test]
fn the_paper_s_scene_is_read_as_written() {
    let file = common::directory("runs/eva-one-arm.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let scene = read(&text, &Source { file, overrides: vec![] }).unwrap();
    assert_eq!(layer(&scene).spans, [Span { width: 1.0, cells: 128, sides: Sides::Periodic }]);
    assert_eq!(layer(&scene).rows, 128);
    assert_eq!(scene.materials[0].arms, [Arm { weight: 0.579, time: 0.817 }]);
    assert_eq!(scene.materials[0].poisson_rule, Some(PoissonRule::ConstantRatio));
    assert_eq!(scene.indenter, Indenter::Harmonic { amplitude: 5e-4, wavelength: 1.0 });
    assert_eq!(scene.friction, Some(Friction::constant(Law::elastic_slip(1e-8), 0.2)));
    assert_eq!(scene.phases[0].approach, Some(1e-3));
    assert_eq!(scene.phases[1].duration, 2.0 / 0.02154);
    assert_eq!(scene.duration(), 10.0 + 2.0 / 0.02154);
    assert_eq!(scene.steps(), 450);
    assert_eq!(layer(&scene).unknowns(), 2 * 128 * 128);
    assert_eq!(scene.output.bulk_at, ["indent", "slide"].map(|name| When::PhaseEnd(name.to_owned())));
}

/// The penalty from a tolerance: that of a half-plane under the wave of two cells, or of the layer under the mean
/// pressure where it hardly changes its volume; both by hand.
#[test]
fn a_tolerance_is_a_penalty() {
    let penalty = |overrides: &[&str]| match read_set(SMALLEST, overrides).unwrap().contact.penalty {
        Some(Penalty::Stiffness(stiffness)) => stiffness,
        other => panic!("{other:?}"),
    };
    let tolerance = "contact={ tolerance = 1e-2 }";
    // G = 1 Pa, dx = 0.5 m: C = 0.7 * 0.5 / pi m/Pa.
    let wave = std::f64::consts::PI / (0.7 * 0.5) / 1e-2;
    let set = [tolerance, "material={ shear_modulus = 1, poisson_ratio = 0.3 }"];
    assert!((penalty(&set) / wave - 1.0).abs() < 1e-14);
    // nu = 0.49, depth 1 m: C = 0.02 / (2 * 0.51) m/Pa.
    let set = [tolerance, "material={ shear_modulus = 1, poisson_ratio = 0.49 }"];
    assert!((penalty(&set) * 1e-2 * 0.02 / 1.02 - 1.0).abs() < 1e-12);
    let scene = read_set(SMALLEST, &set).unwrap();
    assert!(
        (added_compliance(penalty(&set), layer(&scene), &scene.materials, shortest_step(&scene.phases)) - 1e-2).abs()
            < 1e-15
    );
}

#[test]
fn unknowns_are_the_displacements_that_nothing_holds() {
    for (sides, unknowns) in [("free", 30), ("roller", 24), ("fixed", 18), ("periodic", 24)] {
        let scene = read_set(SMALLEST, &[&format!("layer.sides={sides}")]).unwrap();
        assert_eq!(layer(&scene).unknowns(), unknowns, "{sides}");
    }
}

#[test]
fn overrides_are_applied_in_order_by_name_and_by_index() {
    let scene = read_set(
        SMALLEST,
        &[
            "title=two words",
            "layer.cells.1 = 7",
            "layer.sides=roller",
            "layer.grading=\"3\"",
            "layer.grading=3",
            "solver.tolerance=1e-6",
            "phase.phase-2.name=\"fast, 1.5 m/s\"",
            "phase.\"fast, 1.5 m/s\".velocity=1.5",
            "phase.0.steps=9",
            "output.bulk_at=[\"fast, 1.5 m/s\", 1]",
        ],
    )
    .unwrap();
    assert_eq!(scene.title, "two words");
    assert_eq!((layer(&scene).spans[0].cells, layer(&scene).rows), (4, 7));
    assert_eq!((layer(&scene).spans[0].sides, layer(&scene).grading), (Sides::Roller, 3.0));
    assert_eq!(scene.solver.tolerance, 1e-6);
    assert_eq!(
        (scene.phases[1].name.as_str(), &scene.phases[1].motion),
        ("fast, 1.5 m/s", &Motion::Velocity([1.5, 0.0].into()))
    );
    assert_eq!(scene.phases[0].stepping, Stepping::Steps(9));
    assert_eq!(scene.output.bulk_at[1], When::Time(1.0));
}

/// A whole phase, which may name a file and so acts early, leaves nothing of what was set in it before.
#[test]
fn a_whole_phase_replaces_what_was_set_before() {
    let phase = "phase.phase-2={ name = \"phase-2\", velocity = 2.0, duration = 1.0, steps = 3 }";
    let scene = read_set(SMALLEST, &["phase.phase-2.tolerance=1e-3", phase]).unwrap();
    assert_eq!(scene.phases[1].stepping, Stepping::Steps(3));
    let scene = read_set(SMALLEST, &[phase, "phase.phase-2.steps=5"]).unwrap();
    assert_eq!(scene.phases[1].stepping, Stepping::Steps(5));
}

#[test]
fn a_whole_table_can_be_set() {
    let file = PathBuf::from("sweep.toml");
    let mut table = parse(SMALLEST, &file).unwrap();
    let material = parse("shear_modulus = 3.0\npoisson_ratio = 0.0", &file).unwrap();
    set(&mut table, "material", material.into(), &file).unwrap();
    assert_eq!(from_table(&table, &file).unwrap().materials[0].shear_modulus, 3.0);
}

/// Each key, set to what it cannot be, is the key of the error: none is known but not looked at.
#[test]
fn no_key_is_ignored() {
    let parabola = [
        "title layer.width layer.depth layer.cells layer.grading layer.sides layer.element",
        "material.shear_modulus material.young_modulus material.poisson_ratio material.arms material.poisson_rule",
        "material.memory material.file material.fractional material.bulk_arms material.shift material.notes",
        "material.temperature material.reference_temperature material.c1 material.c2 material.activation_energy",
        "indenter.profile indenter.radius indenter.centre contact.penalty contact.quadrature",
        "phase phase.phase-2.name phase.phase-2.duration phase.phase-2.steps phase.phase-2.approach",
        "phase.phase-2.velocity phase.phase-2.distance phase.phase-2.tangential friction.law",
        "solver.strategy solver.tolerance output.interface_every output.bulk_at output.checkpoint_every",
        "layer material indenter contact friction solver output",
    ]
    .join(" ");
    for key in parabola.split(' ') {
        let at = error_at(read_set(SMALLEST, &[&format!("{key}=true")]));
        // A phase whose name is wrong can only be numbered.
        assert_eq!(at.replace("phase.1.name", "phase.phase-2.name"), key);
    }
    let table = |key: &str, fields: &str| format!("{key}={{ {fields} }}");
    for (key, fields, wrong) in [
        ("friction", "law = \"coulomb_tanh\", coefficient = true, regularisation = 1", "coefficient"),
        ("friction", "law = \"coulomb_tanh\", coefficient = 1, regularisation = true", "regularisation"),
        ("indenter", "profile = \"harmonic\", amplitude = true, wavelength = 1", "amplitude"),
        ("indenter", "profile = \"harmonic\", amplitude = 1, wavelength = true", "wavelength"),
        ("indenter", "profile = \"wedge\", slope = true, centre = 1", "slope"),
        ("indenter", "profile = \"wedge\", slope = 1, centre = true", "centre"),
        ("indenter", "profile = \"circle\", radius = true, centre = 1", "radius"),
        ("indenter", "profile = \"circle\", radius = 1, centre = true", "centre"),
        ("indenter", "profile = \"expression\", formula = true", "formula"),
        ("indenter", "profile = \"sampled\", file = true, extend = \"error\"", "file"),
        ("indenter", "profile = \"sampled\", file = \"a\", extend = true", "extend"),
        ("indenter", "profile = \"sampled\", file = \"a\", extend = \"periodic\", period = true", "period"),
        ("indenter", "profile = \"rough\", hurst = true", "hurst"),
        ("indenter", "profile = \"rough\", hurst = 1, rms_slope = true", "rms_slope"),
        ("indenter", "profile = \"rough\", hurst = 1, rms_height = true", "rms_height"),
        ("indenter", "profile = \"rough\", hurst = 1, rms_slope = 1, shortest = true", "shortest"),
        ("indenter", "profile = \"rough\", hurst = 1, rms_slope = 1, shortest = 1, longest = true", "longest"),
        (
            "indenter",
            "profile = \"rough\", hurst = 1, rms_slope = 1, shortest = 1, longest = 1, period = true",
            "period",
        ),
        ("indenter", "profile = \"rough\", hurst = 1, rms_slope = 1, shortest = 1, longest = 1, seed = true", "seed"),
        ("contact", "tolerance = true", "tolerance"),
        ("phase.phase-1.tangential", "amplitude = true, cycles = 1", "amplitude"),
        ("phase.phase-1.tangential", "amplitude = 1, cycles = true", "cycles"),
    ] {
        assert_eq!(error_at(read_set(SMALLEST, &[&table(key, fields)])), format!("{key}.{wrong}"));
    }
}

#[test]
fn numbers_at_their_limits_are_accepted() {
    let arms = "material.arms=[{ weight = 0.7, time = 1 }, { weight = 0.2, time = 2 }, { weight = 0.1, time = 3 }]";
    for overrides in [
        // A Maxwell fluid, whose weights sum to 1 but for round-off.
        vec![arms, "material.poisson_rule=constant_ratio"],
        vec!["material.poisson_rule=constant_ratio"],
        vec!["material.poisson_ratio=0.49999"],
        vec!["material.poisson_ratio=-0.9"],
        vec!["phase.0.approach=-3"],
        vec!["layer.width=1.5", "layer.sides=periodic"],
        vec!["indenter={ profile = \"harmonic\", amplitude = 1, wavelength = 0.1 }", "layer.sides=periodic"],
        // 0.1 + 0.7 is below 0.8 by round-off.
        vec!["phase.0.duration=0.1", "phase.1={ duration = 0.7, steps = 1 }", "output.bulk_at=[0.8]"],
        vec!["output.checkpoint_every=0", "output.interface_every=0"],
        vec!["friction={ law = \"coulomb_tanh\", coefficient = 0, regularisation = 1 }"],
    ] {
        let scene = read_set(SMALLEST, &overrides).unwrap_or_else(|error| panic!("{overrides:?}: {error}"));
        for moment in &scene.output.bulk_at {
            assert!(!matches!(moment, When::Time(time) if *time > scene.duration()));
        }
    }
}

#[test]
fn the_scenes_of_runs_are_read_and_resolved() {
    let files = common::scenes("runs");
    assert!(files.len() >= 5);
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        // A sweep is no scene.
        if text.contains("\n[vary]") || text.contains("\n[[vary]]") {
            continue;
        }
        assert_round_trip(&read(&text, &Source { file, overrides: vec![] }).unwrap_or_else(|error| panic!("{error}")));
    }
}

/// A small generator (xorshift), so that a failure can be repeated.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % n
    }

    fn unit(&mut self) -> f64 {
        (self.below(1 << 53) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Between 1e-4 and 1e4, and on every order between.
    fn positive(&mut self) -> f64 {
        10f64.powf(8.0 * self.unit() - 4.0)
    }

    fn of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize].clone()
    }

    /// Weights that sum to less than 1.
    fn arms(&mut self, count: u64) -> Vec<Arm> {
        (0..count).map(|_| Arm { weight: 0.999 * self.unit() / count as f64, time: self.positive() }).collect()
    }

    fn scene(&mut self) -> Scene {
        let wavelength = self.positive();
        let count = 1 + self.below(4) as usize;
        let space = self.below(3) == 0;
        let phases: Vec<Phase> = (0..count).map(|index| self.phase(index, space)).collect();
        let radius = self.positive();
        let centre = self.unit() - 0.5;
        let [hurst, seed] = [self.unit(), self.unit()];
        let rms = self.of(&[Rms::RmsSlope(radius), Rms::RmsHeight(radius)]);
        let file = self.of(&["a.txt", "../é \"b\"/c.csv", "/abs/d"]).to_owned();
        let period = self.of(&[None, Some(wavelength)]);
        let [coefficient, small] = [10.0 * self.unit(), 1e-12 * self.positive()];
        let law = self.of(&[Law::tanh(small), Law::elastic_slip(small)]);
        let quadrature = self.of(&[Quadrature::Nodal, Quadrature::Gauss]);
        let adaptive = phases.iter().any(|phase| matches!(phase.stepping, Stepping::Tolerance(_)));
        // Exact laws are for nodes.
        let penalty = Some(Penalty::Stiffness(1e200 * self.positive()));
        let strategy = self.of(&[Strategy::Auto, Strategy::Condensed, Strategy::Monolithic]);
        let exact = quadrature == Quadrature::Nodal && strategy != Strategy::Monolithic;
        let law = if exact && self.below(3) == 0 { Law::exact() } else { law };
        let formula = Coefficient::Formula("0.1 + table(\"é.csv\", v)*exp(-s)".to_owned());
        let friction = Friction {
            law,
            coefficient: self.of(&[Coefficient::Number(coefficient), formula]),
            shear_limit: self.of(&[None, Some(radius)]),
            tables: [("é.csv".to_owned(), vec![[0.0, small], [wavelength, coefficient]])].into(),
            checksums: Vec::new(),
        };
        let penalty = if exact { self.of(&[None, penalty]) } else { penalty };
        let ends = phases.iter().take(2).map(|phase| When::PhaseEnd(phase.name.clone()));
        let times = [When::Time(phases[0].duration * self.unit())];
        let body = match space {
            false if self.below(4) == 0 => self.mesh_file(),
            _ => self.layer(wavelength, space),
        };
        let mut materials = self.materials(&body);
        if adaptive {
            materials.iter_mut().for_each(|material| material.memory = Memory::Exponential);
        }
        let solid = self.solid(wavelength);
        let heat = self.heat(&mut materials);
        let friction = self.of(&[None, Some(friction)]);
        let wear = self.wear(exact, matches!(body, Body::Layer(_)), friction.is_some());
        let adhesion = self.adhesion(exact && wear.is_none(), friction.is_some());
        Scene {
            title: self.of(&["", "plain", "é \"quoted\" \\ # = [layer]", "'''"]).to_owned(),
            body,
            materials,
            indenter: if space && self.below(2) == 0 {
                solid
            } else {
                self.of(&[
                    Indenter::Harmonic { amplitude: 1e-9 * radius, wavelength },
                    Indenter::Parabola { radius, centre },
                    Indenter::Circle { radius, centre },
                    Indenter::Wedge { slope: radius, centre },
                    Indenter::Expression { formula: "5e-4*(1-cos(2*pi*x))".to_owned() },
                    Indenter::Sampled { file, reading: Reading::default(), extend: Extend::Periodic, period },
                    Indenter::Rough {
                        hurst,
                        rms,
                        shortest: 0.1 * wavelength,
                        longest: 0.5 * wavelength,
                        period: wavelength,
                        seed: (seed * 1e18) as u64,
                    },
                ][..7 - usize::from(space)])
            },
            contact: Contact { penalty, quadrature },
            friction,
            heat,
            mount: None,
            wear,
            adhesion,
            output: Output {
                interface_every: self.below(3) as usize,
                bulk_at: if self.below(2) == 0 { vec![] } else { ends.chain(times).collect() },
                checkpoint_every: self.below(3) as usize,
                energy: self.below(2) == 0,
            },
            phases,
            solver: Solver { strategy, tolerance: 1e-6 * self.unit() },
        }
    }

    /// An indenter that has no y of its own only in space.
    fn solid(&mut self, wavelength: f64) -> Indenter {
        let (radius, centre) = (self.positive(), Vector2::new(self.unit(), self.unit()));
        let both = Vector2::new(radius, self.of(&[radius, 2.0 * radius]));
        self.of(&[
            Indenter::Paraboloid { radius: both, centre },
            Indenter::Sphere { radius, centre },
            Indenter::Cone { slope: radius, centre },
            Indenter::Waves { amplitude: both, wavelength: Vector2::repeat(wavelength) },
        ])
    }

    fn layer(&mut self, wavelength: f64, space: bool) -> Body {
        let span = |random: &mut Self| Span {
            width: wavelength * (1 + random.below(9)) as f64,
            cells: 2 + random.below(300) as usize,
            sides: random.of(&[Sides::Periodic, Sides::Free, Sides::Roller, Sides::Fixed]),
        };
        let spans = (0..1 + usize::from(space)).map(|_| span(self)).collect();
        let elements = if space { [Element::Hex8, Element::Hex8Bbar] } else { [Element::Quad4, Element::Quad4Bbar] };
        Body::Layer(Layer {
            spans,
            depth: self.positive(),
            rows: 4 + self.below(300) as usize,
            grading: self.positive(),
            element: self.of(&elements),
        })
    }

    fn mesh_file(&mut self) -> Body {
        Body::Mesh(MeshFile {
            file: PathBuf::from("/meshes/a b.msh"),
            contact: "contact".to_owned(),
            fixed: vec!["base".to_owned(), "left \"1\"".to_owned()],
            roller: self.of(&[vec![], vec!["side".to_owned()]]),
            element: self.of(&[None, Some(Element::Quad4), Some(Element::Quad4Bbar), Some(Element::Hex8Bbar)]),
        })
    }

    /// None, or one with the numbers that the materials need for it.
    fn heat(&mut self, materials: &mut [Material]) -> Option<Heat> {
        let convection = Convection { coefficient: self.positive(), temperature: 300.0 * self.unit() };
        let heat = Heat {
            initial: 300.0 * self.unit(),
            base: self.of(&[Base::Insulated, Base::Held(293.15)]),
            convection: self.of(&[None, Some(convection)]),
            share: self.unit(),
            arms: materials.iter().any(|material| !material.is_elastic()) && self.below(2) == 0,
            coupled: false,
        };
        if self.below(2) == 0 {
            return None;
        }
        for material in materials {
            (material.conductivity, material.heat_capacity) = (Some(self.positive()), Some(1e6 * self.positive()));
        }
        Some(heat)
    }

    /// Of what is solved at nodes; an indenter wears over a layer, by the energy with friction.
    fn wear(&mut self, nodal: bool, layer: bool, friction: bool) -> Option<Wear> {
        let wear = Wear {
            of: self.of(&[Wearing::Body, Wearing::Indenter][..1 + usize::from(layer)]),
            law: self.of(&[WearLaw::Archard, WearLaw::Energy][..1 + usize::from(friction)]),
            coefficient: self.positive(),
        };
        (self.below(4) == 0 && nodal).then_some(wear)
    }

    /// The same; a shear strength is part of friction.
    fn adhesion(&mut self, nodal: bool, friction: bool) -> Option<Adhesion> {
        let bonds = [Bond::None, Bond::ShearStrength(self.positive())];
        let adhesion = Adhesion {
            law: self.of(&[AdhesionLaw::Exponential, AdhesionLaw::Bilinear, AdhesionLaw::Dugdale]),
            work: self.positive(),
            range: 1e-9 * self.positive(),
            friction: self.of(&bonds[..1 + usize::from(friction)]),
        };
        (self.below(3) == 0 && nodal).then_some(adhesion)
    }

    /// One material, or several: strata of a layer, regions of a mesh.
    fn materials(&mut self, body: &Body) -> Vec<Material> {
        let count = 1 + self.below(3) as usize;
        let memory = self.of(&[Memory::Exponential, Memory::BackwardEuler]);
        (0..count)
            .map(|index| {
                let arms = self.below(4);
                let poisson_rule =
                    self.of(&[PoissonRule::ConstantRatio, PoissonRule::ConstantBulkModulus, PoissonRule::BulkArms]);
                let bulk_arms = if poisson_rule == PoissonRule::BulkArms { 1 + self.below(3) } else { 0 };
                let (region, thickness) = match body {
                    Body::Mesh(_) => (Some(format!("part.{index}")), None),
                    Body::Layer(layer) => (None, (index + 1 < count).then_some(layer.depth / 7.0)),
                };
                Material {
                    region,
                    thickness,
                    shear_modulus: 1e9 * self.positive(),
                    poisson_ratio: 1.4 * self.unit() - 0.9,
                    arms: self.arms(arms),
                    poisson_rule: Some(poisson_rule),
                    bulk_arms: self.arms(bulk_arms),
                    notes: self.of(&[vec![], vec!["read from \"a\"".to_owned(), "é".to_owned()]]),
                    memory,
                    conductivity: self.of(&[None, Some(0.2)]),
                    heat_capacity: self.of(&[None, Some(2e6)]),
                    shift: None,
                }
            })
            .collect()
    }

    fn phase(&mut self, index: usize, space: bool) -> Phase {
        let mut along = || Vector2::new(self.unit() - 0.5, if space { self.unit() - 0.5 } else { 0.0 });
        let [amplitude, velocity, phase] = [along(), along(), along() * 90.0];
        let tangential = Motion::Tangential { amplitude, cycles: self.positive(), phase };
        let velocity = Motion::Velocity(velocity);
        Phase {
            name: format!("{} {index}", self.of(&["a", "b.c", "\"", "7"])),
            duration: self.positive(),
            stepping: self.of(&[Stepping::Steps(3), Stepping::Steps(1000), Stepping::Tolerance(1e-3)]),
            approach: self.of(&[None, Some(-1.0), Some(9e-5)]),
            normal_force: None,
            motion: self.of(&[Motion::Velocity(Vector2::zeros()), velocity, tangential]),
        }
    }
}

#[test]
fn resolved_scenes_read_back_equal() {
    let mut random = Random(20200107);
    for _ in 0..2000 {
        assert_round_trip(&random.scene());
    }
}

/// What a slip of the hand or a broken disk leaves is an error or a scene, on one line, never a panic.
#[test]
fn damaged_files_are_errors_of_one_line() {
    let mut random = Random(8);
    let damage =
        ["", "[", "]", "{", "=", "\"", ".", ",", "-", "e", "0", "\n", "\r", "\0", "é", "#", "nan", "9999999999"];
    for _ in 0..5000 {
        let mut letters: Vec<String> = SMALLEST.chars().map(String::from).collect();
        for _ in 0..1 + random.below(3) {
            let at = random.below(letters.len() as u64) as usize;
            letters[at] = random.of(&damage).to_owned();
        }
        if let Err(error) = read_set(&letters.concat(), &[]) {
            let message = error.to_string();
            assert!(!message.chars().any(char::is_control), "{message:?}");
            assert_eq!(error.exit_code(), 2);
        }
    }
    for nested in ["[".repeat(100_000), format!("a = {}", "[".repeat(100_000)), "a.".repeat(100_000) + "a = 1"] {
        assert!(read_set(&nested, &[]).is_err());
        assert!(read_set(SMALLEST, &[&nested]).is_err());
    }
}

/// A preset says the steps of phases that say none and the tolerance of Newton's method; what the scene says goes first.
#[test]
fn presets_resolve() {
    let text = include_str!("scenes/sliding.toml").replace("steps = 100\n", "");
    let with = |preset: &str, set: &[&str]| {
        let overrides = set.iter().map(|set| (*set).to_owned()).chain([format!("solver.preset={preset}")]).collect();
        read(&text, &Source { file: "sliding.toml".into(), overrides })
    };
    for (preset, steps, newton) in [("fast", 1e-2, 1e-6), ("balanced", 1e-3, 1e-8), ("reference", 1e-4, 1e-10)] {
        let scene = with(preset, &[]).unwrap();
        assert_eq!(scene.phases[0].stepping, Stepping::Steps(50));
        assert_eq!(scene.phases[1].stepping, Stepping::Tolerance(steps));
        assert_eq!(scene.solver.tolerance, newton);
        assert_round_trip(&scene);
    }
    let scene = with("fast", &["solver.tolerance=1e-9", "phase.slide.tolerance=0.1"]).unwrap();
    assert_eq!((scene.solver.tolerance, scene.phases[1].stepping), (1e-9, Stepping::Tolerance(0.1)));
}
