//! The cases of a sweep in order: one key along the axis, a model for each combination of the others.

use super::table::Table;
use super::{Case, Model};
use crate::plot::material::Solid;
use crate::plot::numbers::{scientific, short};
use crate::plot::{Axis, PALETTE};
use crate::scene::{Material, PoissonRule};

/// The key along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Abscissa {
    key: String,
    /// Its values where they are no numbers.
    names: Vec<String>,
    /// Whether they span decades.
    decades: bool,
}

impl Abscissa {
    /// Whether it is the velocity of the indenter.
    pub fn is_velocity(&self) -> bool {
        is_velocity(&self.key)
    }

    /// The quantity and its unit.
    pub fn label(&self) -> String {
        if self.is_velocity() { "velocity v, m/s".into() } else { self.key.clone() }
    }

    /// The axis of a figure.
    pub fn axis(&self) -> Axis {
        let axis = if self.decades { Axis::log(self.label()) } else { Axis::linear(self.label()) };
        match self.names.len() {
            0 => axis,
            count => Axis { names: self.names.clone(), ..axis }.over(0.5, count as f64 + 0.5),
        }
    }

    /// What is called by `key`, with its values.
    fn of(key: &str, values: &[&str]) -> Self {
        let numbers: Option<Vec<f64>> = values.iter().map(|value| number(value)).collect();
        let mut names: Vec<String> = Vec::new();
        let mut decades = false;
        match numbers {
            Some(numbers) => {
                let low = numbers.iter().fold(f64::INFINITY, |low, value| low.min(*value));
                let high = numbers.iter().fold(f64::NEG_INFINITY, |high, value| high.max(*value));
                decades = low > 0.0 && high > 20.0 * low;
            }
            None => values.iter().for_each(|value| {
                if !names.iter().any(|name| name == value) {
                    names.push((*value).to_owned());
                }
            }),
        }
        Self { key: key.to_owned(), names, decades }
    }

    /// Where a value stands, and what it is called.
    fn place(&self, value: &str) -> (f64, String) {
        match (self.names.iter().position(|name| name == value), number(value)) {
            (None, Some(number)) if self.decades => (number, scientific(number, 4)),
            (None, Some(number)) => (number, short(number, 4)),
            (index, _) => (index.unwrap_or_default() as f64 + 1.0, value.to_owned()),
        }
    }
}

fn is_velocity(key: &str) -> bool {
    key == "velocity" || key.ends_with(".velocity")
}

fn number(value: &str) -> Option<f64> {
    value.parse().ok().filter(|number: &f64| number.is_finite())
}

/// What a sweep without a table varied, as far as its scenes say it: the material and the velocity.
pub fn guessed(cases: &[(usize, Case)]) -> Table {
    let mut materials: Vec<&[Material]> = Vec::new();
    let values = cases.iter().map(|(number, case)| {
        let index = materials.iter().position(|other| *other == case.materials).unwrap_or_else(|| {
            materials.push(&case.materials);
            materials.len() - 1
        });
        (*number, vec![index.to_string(), format!("{:?}", case.velocity)])
    });
    let values = values.collect();
    Table { keys: vec!["material".into(), "velocity".into()], values }
}

/// The models of the cases, and what their curves are drawn against.
pub fn models(table: &Table, cases: Vec<(usize, Case)>) -> (Abscissa, Vec<Model>) {
    let values = |key: usize| -> Vec<&str> {
        cases.iter().filter_map(|(number, _)| table.values.get(number)).map(|row| row[key].as_str()).collect()
    };
    let varies = |key: &usize| values(*key).windows(2).any(|pair| pair[0] != pair[1]);
    let numeric = |key: &usize| values(*key).iter().all(|value| number(value).is_some());
    let keys: Vec<usize> = (0..table.keys.len()).filter(varies).collect();
    let table_key = |key: &usize| table.keys[*key] == "material";
    let along = None
        .or_else(|| keys.iter().rfind(|key| is_velocity(&table.keys[**key]) && numeric(key)))
        .or_else(|| keys.iter().rfind(|key| numeric(key) && !table_key(key)))
        .or_else(|| keys.iter().rfind(|key| !table_key(key)));
    let abscissa = match along {
        Some(&key) => Abscissa::of(&table.keys[key], &values(key)),
        None => Abscissa::of("velocity", &[]),
    };
    let others: Vec<usize> = keys.iter().copied().filter(|key| Some(key) != along).collect();

    let mut groups: Vec<Group> = Vec::new();
    for (number, mut case) in cases {
        let row = table.values.get(&number);
        let velocity = format!("{:?}", case.velocity);
        (case.at, case.name) = abscissa.place(match (row, along) {
            (Some(row), Some(&key)) => &row[key],
            _ => &velocity,
        });
        let told = others.iter().filter_map(|&key| Some((table.keys[key].clone(), row?[key].clone()))).collect();
        match groups.iter_mut().find(|group| group.values == told) {
            Some(group) => group.cases.push(case),
            None => groups.push(Group { values: told, cases: vec![case] }),
        }
    }
    groups.iter_mut().for_each(|group| group.cases.sort_by(|a, b| a.at.total_cmp(&b.at)));
    let relaxes = |group: &Group| !group.cases[0].material().is_elastic();
    let elastic: Vec<Group> =
        if groups.iter().any(relaxes) { groups.extract_if(.., |group| !relaxes(group)).collect() } else { Vec::new() };
    let labels = labels(&groups);
    let model = |(i, (group, label)): (usize, (Group, String))| Model {
        label,
        colour: PALETTE[i % PALETTE.len()],
        instantaneous: group.bound(&elastic, 0.0),
        long_term: group.bound(&elastic, f64::INFINITY),
        cases: group.cases,
    };
    (abscissa, groups.into_iter().zip(labels).enumerate().map(model).collect())
}

/// The cases that differ in the key along the axis only.
struct Group {
    /// Of the other keys.
    values: Vec<(String, String)>,
    cases: Vec<Case>,
}

impl Group {
    /// The elastic cases with the moduli that the material has at `time`, all other keys being equal.
    fn bound(&self, elastic: &[Self], time: f64) -> Vec<Case> {
        let first = &self.cases[0];
        let material = first.material();
        let left = if time > 0.0 { 1.0 - material.arms.iter().map(|arm| arm.weight).sum::<f64>() } else { 1.0 };
        let (modulus, nu) = (left * material.shear_modulus, material.poisson().at(time));
        let of_material = |key: &str| key == "material" || key.starts_with("material.");
        let rest = |group: &Self| -> Vec<(String, String)> {
            group.values.iter().filter(|(key, _)| !of_material(key)).cloned().collect()
        };
        let close = |other: &&Self| {
            let case = &other.cases[0];
            case.materials.len() == first.materials.len()
                && (case.material().shear_modulus / modulus - 1.0).abs() < 1e-3
                && (case.material().poisson_ratio - nu).abs() < 1e-3
                && rest(other) == rest(self)
        };
        elastic.iter().find(close).map_or_else(Vec::new, |group| group.cases.clone())
    }
}

/// What sets the groups apart: of a material as little as tells it from the others, of another key its value.
fn labels(groups: &[Group]) -> Vec<String> {
    let features: [fn(&Material) -> String; 4] = [
        |material| Solid::of(material, "").label().to_owned(),
        |material| match material.poisson_rule {
            Some(PoissonRule::ConstantRatio) => "constant ν".into(),
            Some(PoissonRule::ConstantBulkModulus) => "constant K".into(),
            Some(PoissonRule::BulkArms) => "arms of K".into(),
            None => String::new(),
        },
        |material| format!("ν(0) = {}", short(material.poisson_ratio, 4)),
        |material| format!("G(0) = {} Pa", short(material.shear_modulus, 4)),
    ];
    let keys = |group: &Group| {
        let told = group.values.iter().filter(|(key, _)| key != "material");
        told.map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
    };
    let materials: Vec<&Material> = groups.iter().map(|group| group.cases[0].material()).collect();
    let mut labels: Vec<Vec<String>> = groups.iter().map(|group| vec![keys(group)]).collect();
    let same = |labels: &[Vec<String>]| (1..labels.len()).any(|i| labels[..i].contains(&labels[i]));
    for (i, feature) in features.iter().enumerate() {
        let told: Vec<String> = materials.iter().map(|material| feature(material)).collect();
        // The number of arms is said in any case where no key is.
        let wanted =
            if i == 0 { told.windows(2).any(|pair| pair[0] != pair[1]) || groups.len() == 1 } else { same(&labels) };
        if wanted && (i == 0 || told.windows(2).any(|pair| pair[0] != pair[1])) {
            labels.iter_mut().zip(told).for_each(|(label, told)| label.push(told));
        }
    }
    let joined = |parts: Vec<String>| {
        let (keys, material) = parts.split_at(1);
        let all = material.iter().chain(keys).filter(|part| !part.is_empty()).cloned();
        all.collect::<Vec<_>>().join(", ")
    };
    labels.into_iter().map(joined).collect()
}
