//! Ladders: settings of one kind, from coarse to fine.

use toml::{Table, Value};

use super::Subject;
use super::softness::Softness;
use crate::error::{Error, Result};
use crate::scene::{self, Penalty, Quadrature, Scene, Stepping};

/// Settings of one kind, coarse to fine.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// What it varies.
    pub name: String,
    /// At least one.
    pub rungs: Vec<Setting>,
    /// By how much each rung is finer than the one before, above 1; none where they do not converge to a limit.
    pub ratio: Option<f64>,
    /// Whether the last rung is that limit itself, a law without the parameter, and no step of the ratio.
    pub exact: bool,
}

/// One setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// What tells it from the others of its ladder.
    pub label: String,
    /// `key=value`, as after `--set`.
    pub changes: Vec<String>,
}

impl Setting {
    fn new(label: impl Into<String>, changes: Vec<String>) -> Self {
        Self { label: label.into(), changes }
    }
}

/// The ladders that a scene suggests: cells and steps at a quarter to twice what it says; penalty and regularisation at a
/// tenth to ten times; arms of a power law; the two memories and, where no law is exact, the two quadratures.
pub fn default(subject: &Subject, scene: &Scene) -> Result<Vec<Ladder>> {
    let table = scene::parse(&subject.text, &subject.source.file)?;
    let all = [
        cells(scene),
        Some(steps(scene)),
        penalty(subject, scene, &table),
        regularisation(scene),
        arms(&table),
        memory(scene),
        quadrature(scene),
    ];
    Ok(all.into_iter().flatten().filter(|ladder| ladder.rungs.len() > 1).collect())
}

const HALVINGS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const DECADES: [f64; 3] = [0.1, 1.0, 10.0];

fn cells(scene: &Scene) -> Option<Ladder> {
    let layer = scene.layer()?;
    let counts: Vec<usize> = layer.spans.iter().map(|span| span.cells).chain([layer.rows]).collect();
    let least: Vec<usize> = layer.spans.iter().map(|_| 4).chain([scene.materials.len().max(2)]).collect();
    let scaled = |factor: f64| counts.iter().map(move |&count| count as f64 * factor);
    let fits = |factor: &f64| scaled(*factor).all(|count| count.fract() == 0.0);
    let enough = |factor: &f64| scaled(*factor).zip(&least).all(|(count, least)| count.round() >= *least as f64);
    let rung = |factor: f64| {
        let text = format!("[{}]", scaled(factor).map(|count| format!("{count:.0}")).collect::<Vec<_>>().join(","));
        Setting::new(text.clone(), vec![format!("layer.cells={text}")])
    };
    let rungs = HALVINGS.into_iter().filter(fits).filter(enough).map(rung).collect();
    Some(Ladder { name: "cells".into(), rungs, ratio: Some(2.0), exact: false })
}

/// Equal steps of all phases, or their tolerances, together.
fn steps(scene: &Scene) -> Ladder {
    let rung = |factor: f64| {
        let change = |(index, phase): (usize, &scene::Phase)| {
            let place = addressed(index, &phase.name);
            match phase.stepping {
                Stepping::Steps(steps) => {
                    format!("phase.{place}.steps={}", (steps as f64 * factor).round().max(1.0) as usize)
                }
                // Their number goes with the root.
                Stepping::Tolerance(tolerance) => {
                    format!("phase.{place}.tolerance={:e}", (tolerance / (factor * factor)).min(0.5))
                }
            }
        };
        Setting::new(format!("{factor} times as many"), scene.phases.iter().enumerate().map(change).collect())
    };
    Ladder { name: "steps".into(), rungs: HALVINGS.into_iter().map(rung).collect(), ratio: Some(2.0), exact: false }
}

/// A phase in the path of a key: by its name where that is a plain word, else by its index.
fn addressed(index: usize, name: &str) -> String {
    let plain = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    if plain { name.to_owned() } else { index.to_string() }
}

/// By the key that the file gives; none where that is overridden as well.
fn penalty(subject: &Subject, scene: &Scene, table: &Table) -> Option<Ladder> {
    const TOLERANCE: &str = "contact.tolerance";
    let overridden = subject.source.overrides.iter().any(|typed| typed.starts_with(TOLERANCE));
    let rung = |factor: f64| match (scene::get(table, TOLERANCE).and_then(Value::as_float), scene.contact.penalty) {
        _ if overridden => None,
        (Some(tolerance), _) => Some(one(TOLERANCE, format!("{:e}", tolerance / factor))),
        (None, Some(Penalty::Stiffness(penalty))) => Some(one("contact.penalty", format!("{:e}", penalty * factor))),
        (None, Some(Penalty::Tolerance(_)) | None) => None,
    };
    let rungs = DECADES.into_iter().map(rung).collect::<Option<_>>()?;
    Some(Ladder { name: "penalty".into(), rungs, ratio: Some(10.0), exact: false })
}

/// Of whatever law has one.
fn regularisation(scene: &Scene) -> Option<Ladder> {
    const KEY: &str = "friction.regularisation";
    let table: Table = scene.to_toml().parse().ok()?;
    let value = scene::get(&table, KEY)?.as_float()?;
    let rungs = DECADES.into_iter().map(|factor| one(KEY, format!("{:e}", value / factor))).collect();
    Some(Ladder { name: "regularisation".into(), rungs, ratio: Some(10.0), exact: false })
}

/// The arms that stand for a power law: half of them, as they are, half more.
fn arms(table: &Table) -> Option<Ladder> {
    const KEY: &str = "material.fractional.arms";
    let count = scene::get(table, KEY)?.as_integer()?;
    let counts = [count / 2, count, count + (count + 1) / 2];
    let rungs = counts.into_iter().filter(|count| (1..=50).contains(count)).map(|count| one(KEY, count.to_string()));
    // Their error falls exponentially: twice as fine at least.
    Some(Ladder { name: "arms".into(), rungs: rungs.collect(), ratio: Some(2.0), exact: false })
}

/// Both have the same limit, and the exponential one is closer to it.
fn memory(scene: &Scene) -> Option<Ladder> {
    if scene.is_adaptive() || scene.materials.iter().all(scene::Material::is_elastic) {
        return None;
    }
    let key = |index: usize| match scene.materials.len() {
        1 => "material.memory".to_owned(),
        _ => format!("material.{index}.memory"),
    };
    let relaxing = || (0..scene.materials.len()).filter(|&index| !scene.materials[index].is_elastic());
    let rung = |word: &str| Setting::new(word, relaxing().map(|index| format!("{}={word}", key(index))).collect());
    Some(Ladder {
        name: "memory".into(),
        rungs: ["backward_euler", "exponential"].map(rung).to_vec(),
        ratio: None,
        exact: false,
    })
}

/// That of the scene is what the other one is held against. Exact laws have no other.
fn quadrature(scene: &Scene) -> Option<Ladder> {
    if Softness::lacks(scene) {
        return None;
    }
    let words = match scene.contact.quadrature {
        Quadrature::Nodal => ["gauss", "nodal"],
        Quadrature::Gauss => ["nodal", "gauss"],
    };
    let rungs = words.into_iter().map(|word| one("contact.quadrature", word.to_owned())).collect();
    Some(Ladder { name: "quadrature".into(), rungs, ratio: None, exact: false })
}

fn one(key: &str, value: String) -> Setting {
    Setting::new(value.clone(), vec![format!("{key}={value}")])
}

/// The ladder of `--vary key=a,b,c`, from coarse to fine; commas inside brackets and braces do not separate. A penalty or a
/// regularisation may end with `none`, the law itself; where the scene has that, it ends there anyway.
pub fn parse(typed: &str, scene: &Scene) -> Result<Ladder> {
    let wrong = || {
        let example = "for example --vary layer.cells=[32,32],[64,64],[128,128]";
        Error::Usage(format!("--vary {typed}: must be key=value,value, from coarse to fine, {example}"))
    };
    let (key, list) = typed.split_once('=').ok_or_else(wrong)?;
    let key = key.trim();
    let (mut depth, mut values) = (0_i32, vec![String::new()]);
    for c in list.chars() {
        depth += i32::from("[{".contains(c)) - i32::from("]}".contains(c));
        match values.last_mut() {
            Some(_) if c == ',' && depth == 0 => values.push(String::new()),
            Some(last) => last.push(c),
            None => {}
        }
    }
    if key.is_empty() || values.len() < 2 || values.iter().any(|value| value.trim().is_empty()) {
        return Err(wrong());
    }
    let softness = Softness::of(key);
    let limit = softness.and_then(|softness| match values.last() {
        _ if softness.is_none(scene) => Some(Vec::new()),
        Some(last) if last.trim() == NONE => Some(softness.taken_out()),
        _ => None,
    });
    values.retain(|value| limit.is_none() || value.trim() != NONE);
    let ratio = ratio(&values);
    let rung = |value: String| {
        let law = softness.and_then(|softness| softness.law(scene));
        Setting::new(value.trim(), law.into_iter().chain([format!("{key}={}", value.trim())]).collect())
    };
    let exact = limit.is_some();
    let limit = limit.map(|changes| Setting::new(NONE, changes));
    Ok(Ladder { name: key.into(), rungs: values.into_iter().map(rung).chain(limit).collect(), ratio, exact })
}

const NONE: &str = "none";

/// The ratio of successive numbers, where it is one; of arrays the first entry counts.
fn ratio(values: &[String]) -> Option<f64> {
    let number =
        |text: &String| text.trim().trim_start_matches('[').split([',', ']']).next()?.trim().parse::<f64>().ok();
    let numbers: Vec<f64> = values.iter().map(number).collect::<Option<_>>()?;
    let ratios: Vec<f64> = numbers.windows(2).map(|pair| pair[1] / pair[0]).collect();
    let first = *ratios.first()?;
    let same = ratios.iter().all(|ratio| (ratio / first - 1.0).abs() < 1e-9);
    let finer = first.max(1.0 / first);
    (same && first > 0.0 && finer > 1.0).then_some(finer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(changes: &[&str]) -> Result<Scene> {
        let overrides = changes.iter().map(|&change| change.to_owned()).collect();
        let text = include_str!("../../tests/scenes/sliding.toml");
        scene::read(text, &scene::Source { file: "sliding.toml".into(), overrides })
    }

    /// Values are split at commas outside brackets, and a constant ratio is found whichever way they go.
    #[test]
    fn vary_is_read() -> Result<()> {
        let scene = scene(&[])?;
        let parse = |typed| parse(typed, &scene);
        let ladder = parse("layer.cells=[8,4],[16,8],[32,16]")?;
        assert_eq!(ladder.rungs[1].changes, ["layer.cells=[16,8]"]);
        assert_eq!((ladder.rungs.len(), ladder.ratio, ladder.exact), (3, Some(2.0), false));
        assert_eq!(parse("phase.slide.tolerance=1e-2,1e-3")?.ratio.map(f64::round), Some(10.0));
        assert_eq!(parse("material.memory=backward_euler,exponential")?.ratio, None);
        assert!(parse("layer.cells").is_err() && parse("a=1").is_err() && parse("a=1,,2").is_err());
        Ok(())
    }

    /// A softness ends in the law itself: where the ladder says so, by taking the key out, and where the scene has that law, which
    /// is then the scene as it is.
    #[test]
    fn a_softness_ends_in_the_law_itself() -> Result<()> {
        let soft = scene(&[])?;
        let ladder = parse("contact.penalty=1e4,1e5,none", &soft)?;
        assert_eq!((ladder.rungs.len(), ladder.ratio.map(f64::round), ladder.exact), (3, Some(10.0), true));
        assert_eq!(ladder.rungs[2].changes, ["contact.penalty=", "contact.tolerance=", "contact.method="]);
        assert!(!parse("contact.penalty=1e4,1e5", &soft)?.exact);
        let exact = scene(&["contact.penalty=", "friction.law=coulomb", "friction.regularisation="])?;
        let ladder = parse("friction.elastic_slip=1e-6,1e-7", &exact)?;
        assert_eq!(ladder.rungs[1].changes, ["friction.law=coulomb_elastic_slip", "friction.elastic_slip=1e-7"]);
        assert_eq!((ladder.rungs[2].label.as_str(), ladder.rungs[2].changes.len(), ladder.exact), ("none", 0, true));
        assert!(quadrature(&exact).is_none() && quadrature(&soft).is_some());
        Ok(())
    }
}
