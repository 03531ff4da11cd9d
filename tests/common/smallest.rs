//! The smallest scene that there is, read with changes.

use std::path::PathBuf;

use mpjr::error::Result;
use mpjr::scene::{Scene, Source, read};

/// A parabola pressed and dragged; all that may be absent is.
pub const SMALLEST: &str = r#"
[layer]
width = 2
depth = 1
cells = [4, 3]
sides = "free"
[material]
young_modulus = 2.6
poisson_ratio = 0.3
[indenter]
profile = "parabola"
radius = 10
centre = -1
[contact]
penalty = 100
[[phase]]
duration = 2
steps = 4
[[phase]]
velocity = -0.5
distance = 1.0
steps = 2
"#;

/// Reads the text with `--set` arguments, as `dir/smallest.toml`.
pub fn read_set(text: &str, overrides: &[&str]) -> Result<Scene> {
    let overrides = overrides.iter().map(|text| text.to_string()).collect();
    read(text, &Source { file: PathBuf::from("dir/smallest.toml"), overrides })
}

/// What the scene resolves to is read as the same scene.
pub fn assert_round_trip(scene: &Scene) {
    let text = scene.to_toml();
    let again = read(&text, &Source { file: PathBuf::from("resolved.toml"), overrides: vec![] });
    assert_eq!(again.as_ref(), Ok(scene), "{text}");
}
