//! Transient pressing and sliding over one relaxing arm, beside a transient solution in Fourier space.

use super::setting::{Phase, Setting, one_arm, tanh};
use super::{Case, Row, resolution};
use crate::oracle::PoissonRule;
use crate::oracle::transient::Update;
use crate::solution::Solution;

pub fn cases(quick: bool) -> Vec<Case> {
    use Update::{BackwardEuler, Exponential};
    if quick {
        return vec![case(128, (1e6, Exponential, 1), 0.0), rigid(128)];
    }
    vec![
        case(256, (1e6, BackwardEuler, 1), 0.0),
        case(256, (1e6, Exponential, 1), 0.0),
        case(256, (1e6, Exponential, 4), 0.0),
        case(256, (1e8, BackwardEuler, 1), 0.0),
        rigid(256),
        case(256, (1e6, Exponential, 1), 0.3),
    ]
}

/// What the table varies: the penalty (Pa/m), the memory, and how many times its steps are taken.
type Variant = (f64, Update, usize);

/// Approach 2 g0 in 10 s (50 steps), then 0.1 m/s over 1 m (100 steps), f = 0.2, regularisation 0.01 v; the steps
/// times `finer`.
fn setting(n: usize, (penalty, update, finer): Variant, poisson: f64) -> Setting {
    let phases = vec![Phase::press(10.0, 50 * finer, 1e-3), Phase::slide(0.1, 1.0, 100 * finer, 1e-3)];
    let solid = one_arm(poisson, PoissonRule::ConstantRatio);
    Setting { penalty: Some(penalty), update, friction: Some(tanh(0.2, 1e-3)), ..Setting::new(n, solid, phases) }
}

fn case(n: usize, variant: Variant, poisson: f64) -> Case {
    let (penalty, update, finer) = variant;
    let memory = match update {
        Update::Exponential => "exponential",
        Update::BackwardEuler => "backward Euler",
    };
    let steps = if finer == 1 { String::new() } else { format!(", {finer} x the steps") };
    let name = format!("transient, nu = {poisson}, alpha = {penalty:e}, {memory}{steps}");
    compared(name, setting(n, variant, poisson), finer)
}

/// The row of the highest penalty, without any.
fn rigid(n: usize) -> Case {
    let stiff = setting(n, (1e8, Update::BackwardEuler, 1), 0.0);
    compared("transient, nu = 0, no penetration".into(), Setting { penalty: None, ..stiff }, 1)
}

/// The oracle takes the same steps with the same memory and penalty on as many nodes, its surface kernel exact in
/// Fourier space, so that the mesh is what differs.
fn compared(name: String, setting: Setting, finer: usize) -> Case {
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let exact = setting.transient(setting.cells[0].min(256))?;
        let [pressed, slid] = [&exact[0], &exact[1]];
        let (loaded, end) = (pressed[pressed.len() - 1], slid[slid.len() - 1]);
        let middle = slid[slid.len() / 2 - 1].normal;
        let solution = &solutions[0];
        let half_way = solution.history[100 * finer].normal_force;
        // The contact is about 0.37 m wide while it slides.
        let resolution = resolution(setting.spacing(), 0.37);
        let row = |name: &str, computed, exact| Row::resolved(name, [computed, exact], resolution);
        let mut rows = vec![
            row("N_z(t0), N/m", solution.end_of(0).normal_force, loaded.normal),
            row("N_z half way through the slide, N/m", half_way, middle),
            row("Q_x at the end, N/m", solution.last().tangential_force, end.tangential),
        ];
        if setting.penalty.is_none() {
            let deepest = solution.history.iter().map(|row| row.max_penetration).fold(0.0, f64::max);
            rows.push(Row::new("penetration, m", [deepest, 0.0], 0.0, "none at all"));
        }
        Ok(rows)
    };
    Case { name, source: "the same steps in Fourier space, same nodes", subjects, compare: Box::new(compare) }
}
