//! Parts that scenes of many tests are put together from.

use std::sync::LazyLock;

/// A scene of parts, made when it is first asked for.
pub type Text = LazyLock<String>;

/// A periodic layer: "width" and "depth", m, and [cells]; the keys that follow are still of its table.
pub fn layer(width: &str, depth: &str, cells: &str) -> String {
    format!("[layer]\nwidth = {width}\ndepth = {depth}\ncells = {cells}\nsides = \"periodic\"\n")
}

/// The material of the paper with one arm.
pub const ONE_ARM: &str = r#"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ { weight = 0.579, time = 0.817 } ]
poisson_rule = "constant_ratio"
"#;

/// One with a fast arm and a slow one.
pub const TWO_ARMS: &str = r#"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ { weight = 0.3, time = 0.2 }, { weight = 0.4, time = 2.0 } ]
poisson_rule = "constant_ratio"
"#;

/// One without arms.
pub fn elastic(shear_modulus: &str, poisson_ratio: &str) -> String {
    format!("[material]\nshear_modulus = {shear_modulus}\npoisson_ratio = {poisson_ratio}\n")
}

/// The indenter of the paper.
pub const COSINE: &str = "[indenter]\nprofile = \"harmonic\"\namplitude = 5e-4\nwavelength = 1.0\n";

/// A paraboloid of 2 m.
pub fn paraboloid(centre: &str) -> String {
    format!("[indenter]\nprofile = \"paraboloid\"\nradius = 2.0\ncentre = {centre}\n")
}

/// Coulomb's law itself, without penetration.
pub fn coulomb(coefficient: &str) -> String {
    format!("[contact]\n[friction]\nlaw = \"coulomb\"\ncoefficient = {coefficient}\n")
}

/// The law of the paper, with a penalty, Pa/m; the keys that follow are still of the friction.
pub fn regularised(penalty: &str, coefficient: &str) -> String {
    let law = "law = \"coulomb_tanh\"\nregularisation = 1e-3";
    format!("[contact]\npenalty = {penalty}\n[friction]\n{law}\ncoefficient = {coefficient}\n")
}

/// A phase of so many steps; the keys that follow are still its own.
pub fn phase(name: &str, steps: usize) -> String {
    format!("[[phase]]\nname = \"{name}\"\nsteps = {steps}\n")
}

/// A cosine is pressed beyond full contact of its middle, slid, and lifted again.
pub const WAVE: &str = r#"
[[phase]]
name = "indent"
duration = 1.0
steps = 4
approach = 1e-3
[[phase]]
name = "slide"
velocity = 0.1
distance = 0.4
steps = 6
[[phase]]
name = "lift"
duration = 1.0
steps = 3
approach = -1e-4
"#;

/// A paraboloid is pressed in and dragged obliquely.
pub const DRAG: &str = r#"
[[phase]]
name = "press"
duration = 1.0
steps = 4
approach = 0.03
[[phase]]
name = "drag"
velocity = [0.1, 0.05]
distance = 0.2
steps = 5
"#;

/// A thin layer of rubber that knows heat, under a parabola that is pressed in and slid over it, in two parts: what follows the first is
/// still of the material.
pub const RUBBER: [&str; 2] = [
    r#"
[layer]
width = 0.02
depth = 4e-3
cells = [40, 8]
grading = 3.0
sides = "periodic"
[material]
young_modulus = 1e7
poisson_ratio = 0.3
arms = [ { weight = 0.3, time = 0.01 }, { weight = 0.3, time = 0.1 } ]
poisson_rule = "constant_ratio"
conductivity = 0.2
"#,
    r#"
[indenter]
profile = "parabola"
radius = 0.02
centre = 0.01
[contact]
[friction]
law = "coulomb"
coefficient = 0.4
[[phase]]
name = "press"
duration = 0.1
steps = 5
approach = 2e-4
[[phase]]
name = "slide"
velocity = 0.02
duration = 0.5
steps = 25
"#,
];
