//! A history in which forces and approaches take turns.

/// Not yet in touch, pressed, slid, held by its approach, by a force again, let go and left alone.
pub const PHASES: &str = r#"
[[phase]]
name = "near"
approach = 5e-4
duration = 1.0
steps = 2
[[phase]]
name = "load"
duration = 2.0
steps = 20
normal_force = 0.5
[[phase]]
name = "slide"
velocity = 0.02
distance = 0.3
steps = 60
[[phase]]
name = "sink"
approach = 2.4e-3
duration = 1.0
steps = 10
[[phase]]
name = "back"
normal_force = 0.2
velocity = -0.02
duration = 1.0
steps = 20
[[phase]]
name = "off"
normal_force = 0.0
duration = 1.0
steps = 10
[[phase]]
name = "rest"
duration = 3.0
steps = 10
"#;
