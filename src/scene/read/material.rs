//! The `[material]` table: what it says, and what that is in the scene's loading history.

use super::super::{Arm, Material, Memory, PoissonRule, checks};
use crate::error::{Error, Result};
use crate::rheology::{Fractional, Loading, Shift};
use crate::scene::keys::Section;
use crate::scene::keys::tables::{MEMORIES, RULES};

/// A material as it is given.
struct Given {
    poisson_ratio: f64,
    series: Series,
    poisson_rule: Option<PoissonRule>,
    bulk_arms: Vec<Arm>,
    memory: Memory,
    /// The law, the temperature (K), and the factor of the times there.
    shift: Option<(Shift, f64, f64)>,
    notes: Vec<String>,
}

/// The instantaneous shear modulus and its arms, or what they are made from.
enum Series {
    Prony {
        modulus: f64,
        arms: Vec<Arm>,
    },
    /// Of so many arms; none = the fewest that will do.
    Fractional {
        law: Fractional,
        arms: Option<usize>,
    },
}

/// Reads the material of a scene with a loading history. What it fills is not read here.
pub(in crate::scene) fn read(section: &Section, loading: Option<&Loading>) -> Result<Material> {
    let material = given(section)?.resolve(section, loading)?;
    if let (Some(loading), Some(rule)) = (loading, material.poisson_rule)
        && let Some((t, nu)) = material.poisson().leaves(loading.band)
    {
        let key = if rule == PoissonRule::BulkArms { "bulk_arms" } else { "arms" };
        let reason = format!(
            "take the Poisson ratio to {nu:.6} at {t:.3e} s, which is not inside (-1, 0.5); let their weights sum to less"
        );
        return Err(section.error(key, reason));
    }
    Ok(material)
}

/// Whether a table is a material, in whatever history.
pub(in crate::scene) fn check(section: &Section) -> Result<()> {
    given(section).map(drop)
}

fn given(section: &Section) -> Result<Given> {
    section.only_known()?;
    let poisson_ratio = section.number("poisson_ratio")?;
    let series = series(section, poisson_ratio)?;
    let relaxes = !matches!(&series, Series::Prony { arms, .. } if arms.is_empty());
    let (poisson_rule, bulk_arms) = bulk(section, relaxes)?;
    Ok(Given {
        poisson_ratio,
        series,
        poisson_rule,
        bulk_arms,
        memory: section.optional_choice("memory", &MEMORIES, &[])?.unwrap_or(Memory::Exponential),
        shift: shift(section)?,
        notes: notes(section)?,
    })
}

fn series(section: &Section, poisson_ratio: f64) -> Result<Series> {
    let Some(fractional) = section.optional_section("fractional")? else {
        return Ok(Series::Prony { modulus: shear_modulus(section, poisson_ratio)?, arms: arms(section, "arms")? });
    };
    if let Some(other) = ["shear_modulus", "young_modulus", "arms"].into_iter().find(|key| section.has(key)) {
        return Err(section.error(other, format!("follows from fractional; give {other} or fractional, not both")));
    }
    fractional.only_known()?;
    let (modulus, order) = (fractional.number("modulus")?, fractional.number("order")?);
    let arms = fractional.optional_count("arms")?;
    let law = Fractional::new(modulus, order).map_err(|error| section.error("fractional", error.to_string()))?;
    Ok(Series::Fractional { law, arms })
}

/// The instantaneous shear modulus, given as itself or as Young's modulus.
fn shear_modulus(section: &Section, poisson_ratio: f64) -> Result<f64> {
    let shear = section.optional_number("shear_modulus")?;
    let young = section.optional_number("young_modulus")?;
    match (shear, young) {
        (Some(_), Some(_)) => Err(section.error("young_modulus", "give shear_modulus or young_modulus, not both")),
        (Some(shear), None) => Ok(shear),
        (None, Some(young)) => Ok(checks::shear_from_young(young, poisson_ratio)),
        (None, None) => Err(section.missing("shear_modulus", "it, or young_modulus, in Pa")),
    }
}

fn arms(section: &Section, key: &str) -> Result<Vec<Arm>> {
    let arm = |section: &Section| {
        section.only_known()?;
        Ok(Arm { weight: section.number("weight")?, time: section.number("time")? })
    };
    let sections = section.sections(key)?;
    let arms: Vec<Arm> = sections.iter().map(arm).collect::<Result<_>>()?;
    checks::weights(&arms).map_err(|reason| section.error(key, reason))?;
    Ok(arms)
}

/// How the bulk modulus relaxes; `relaxes` says whether the shear modulus does.
fn bulk(section: &Section, relaxes: bool) -> Result<(Option<PoissonRule>, Vec<Arm>)> {
    let rule = section.optional_choice("poisson_rule", &RULES, &[])?;
    if relaxes && rule.is_none() {
        let reason = "missing, and required with arms: give \"constant_ratio\" (the bulk modulus relaxes with the \
                      shear modulus), \"constant_bulk_modulus\" (it stays) or \"bulk_arms\" (it has arms of its own)";
        return Err(section.error("poisson_rule", reason));
    }
    match (rule, section.has("bulk_arms")) {
        (Some(PoissonRule::BulkArms), false) => {
            Err(section.missing("bulk_arms", "the Prony arms of the bulk modulus, or another poisson_rule"))
        }
        (Some(PoissonRule::BulkArms), true) => match arms(section, "bulk_arms")? {
            arms if arms.is_empty() => {
                Err(section.error("bulk_arms", "is empty; give arms, or poisson_rule = \"constant_bulk_modulus\""))
            }
            arms => Ok((rule, arms)),
        },
        (_, true) => Err(section.error("bulk_arms", "needs poisson_rule = \"bulk_arms\"")),
        (_, false) => Ok((rule, Vec::new())),
    }
}

/// The law by which the times go with temperature, the temperature, and the factor of the times there.
fn shift(section: &Section) -> Result<Option<(Shift, f64, f64)>> {
    #[derive(Clone, Copy)]
    enum Law {
        Wlf,
        Arrhenius,
    }
    const LAWS: [(&str, Law); 2] = [("wlf", Law::Wlf), ("arrhenius", Law::Arrhenius)];
    const OF_THE_LAWS: [&str; 5] = ["reference_temperature", "temperature", "c1", "c2", "activation_energy"];

    let Some(law) = section.optional_choice("shift", &LAWS, &[])? else {
        return match OF_THE_LAWS.iter().find(|key| section.has(key)) {
            Some(key) => Err(section.error(key, "needs shift = \"wlf\" or shift = \"arrhenius\"")),
            None => Ok(None),
        };
    };
    let (name, foreign): (_, &[&str]) = match law {
        Law::Wlf => ("wlf", &["activation_energy"]),
        Law::Arrhenius => ("arrhenius", &["c1", "c2"]),
    };
    if let Some(key) = foreign.iter().find(|key| section.has(key)) {
        return Err(section.error(key, format!("is not a key of shift = \"{name}\"")));
    }
    let reference = section.number("reference_temperature")?;
    let temperature = section.number("temperature")?;
    let shift = match law {
        Law::Wlf => Shift::Wlf { reference, c1: section.number("c1")?, c2: section.number("c2")? },
        Law::Arrhenius => Shift::Arrhenius { reference, activation_energy: section.number("activation_energy")? },
    };
    let factor = shift.factor(temperature).map_err(|error| section.error("temperature", error.to_string()))?;
    Ok(Some((shift, temperature, factor)))
}

fn notes(section: &Section) -> Result<Vec<String>> {
    let note = |(index, value): (usize, &toml::Value)| match value.as_str() {
        Some(text) if !text.contains(char::is_control) => Ok(text.to_owned()),
        _ => Err(section.must_be(&format!("notes.{index}"), "a text on one line", value)),
    };
    section.values("notes")?.iter().enumerate().map(note).collect()
}

impl Given {
    /// The material at its temperature, as moduli and arms.
    fn resolve(mut self, section: &Section, loading: Option<&Loading>) -> Result<Material> {
        let factor = self.shift.map_or(1.0, |(_, _, factor)| factor);
        let (shear_modulus, mut arms) = match self.series {
            Series::Prony { modulus, ref mut arms } => (modulus, std::mem::take(arms)),
            Series::Fractional { law, arms } => {
                self.approximate(law, arms, factor, loading).map_err(|error| match error {
                    Error::Scene { .. } => error,
                    other => section.error("fractional", other.to_string()),
                })?
            }
        };
        for (key, arms) in [("arms", &mut arms), ("bulk_arms", &mut self.bulk_arms)] {
            for (index, arm) in arms.iter_mut().enumerate() {
                arm.time *= factor;
                if !(arm.time > 0.0 && arm.time.is_normal()) {
                    let reason = format!("takes {key}.{index}.time to {} s; choose one nearer the reference", arm.time);
                    return Err(section.error("temperature", reason));
                }
            }
        }
        if let Some((shift, temperature, factor)) = self.shift
            && temperature != shift.reference()
        {
            self.notes.push(shift_note(shift, temperature, factor));
        }
        Ok(Material {
            region: None,
            thickness: None,
            shear_modulus,
            poisson_ratio: self.poisson_ratio,
            arms,
            poisson_rule: self.poisson_rule,
            bulk_arms: self.bulk_arms,
            memory: self.memory,
            conductivity: section.optional_number("conductivity")?,
            heat_capacity: section.optional_number("heat_capacity")?,
            shift: self.shift.map(|(shift, temperature, _)| shift.from(temperature).into()),
            notes: self.notes,
        })
    }

    /// The power law under the loading as G(0) and arms at the reference temperature, where the clock runs 1/factor
    /// times as fast.
    fn approximate(
        &mut self,
        law: Fractional,
        arms: Option<usize>,
        factor: f64,
        loading: Option<&Loading>,
    ) -> Result<(f64, Vec<Arm>)> {
        /// Of the forces, where the scene does not say how many arms.
        const ERROR: f64 = 5e-3;
        const MOST: usize = 20;

        let none = || Error::Domain("needs a loading history of finite times".into());
        let there = loading.ok_or_else(none)?.stretched(1.0 / factor);
        let series = match arms {
            Some(arms) => law.under(&there, arms)?,
            None => law.within(ERROR, &there, MOST)?,
        };
        self.notes.push(format!(
            "power law E(t) = {} t^-{order} / Gamma(1 - {order}) Pa as a Prony series of {} arms for steps from {:.3e} s \
             to {:.3e} s: largest error of {} {:.2e}",
            law.modulus,
            series.series.arms.len(),
            there.band.from,
            there.band.to,
            if there.is_idle() { "E(t) there" } else { "the forces of the scene's ramps" },
            series.max_error,
            order = law.order,
        ));
        let arms = series.series.arms.iter().map(|arm| Arm { weight: arm.weight, time: arm.time }).collect();
        Ok((checks::shear_from_young(series.instantaneous, self.poisson_ratio), arms))
    }
}

fn shift_note(shift: Shift, temperature: f64, factor: f64) -> String {
    let (reference, law) = match shift {
        Shift::Wlf { reference, c1, c2 } => (reference, format!("WLF, c1 = {c1}, c2 = {c2} K")),
        Shift::Arrhenius { reference, activation_energy } => {
            (reference, format!("Arrhenius, {activation_energy} J/mol"))
        }
    };
    format!("relaxation times at {temperature} K: {factor:.6e} times those at {reference} K ({law})")
}
