//! Transient pressing and sliding over one relaxing arm: VERIFY's table.

use super::setting::{Phase, Setting, one_arm};
use super::{Case, Row, resolution};
use crate::oracle::PoissonRule;
use crate::oracle::transient::Update;
use crate::solution::Solution;

pub fn cases(quick: bool) -> Vec<Case> {
    use Update::{BackwardEuler, Exponential};
    if quick {
        return vec![case(128, (1e6, Exponential, 1), 0.0)];
    }
    vec![
        case(256, (1e6, BackwardEuler, 1), 0.0),
        case(256, (1e6, Exponential, 1), 0.0),
        case(256, (1e6, Exponential, 4), 0.0),
        case(256, (1e8, BackwardEuler, 1), 0.0),
        case(256, (1e6, Exponential, 1), 0.3),
    ]
}

/// Approach 2 g0 in 10 s (50 steps), then 0.1 m/s over 1 m (100 steps), f = 0.2, regularisation 0.01 v; the steps
/// times `finer`. The oracle takes the same steps with the same memory and penalty on as many nodes, its surface
/// kernel exact in Fourier space, so that the mesh is what differs.
fn case(n: usize, (penalty, update, finer): (f64, Update, usize), poisson: f64) -> Case {
    let phases = vec![Phase::press(10.0, 50 * finer, 1e-3), Phase::slide(0.1, 1.0, 100 * finer, 1e-3)];
    let solid = one_arm(poisson, PoissonRule::ConstantRatio);
    let setting = Setting { penalty, update, friction: Some([0.2, 1e-3]), ..Setting::new(n, solid, phases) };
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let exact = setting.transient(n.min(256))?;
        let [pressed, slid] = [&exact[0], &exact[1]];
        let (loaded, end) = (pressed[pressed.len() - 1], slid[slid.len() - 1]);
        let middle = slid[slid.len() / 2 - 1].normal;
        let solution = &solutions[0];
        let half_way = solution.history[100 * finer].normal_force;
        // The contact is about 0.37 m wide.
        // The contact is about 0.37 m wide while it slides.
        let resolution = resolution(setting.spacing(), 0.37);
        let row = |name: &str, computed, exact| Row::resolved(name, [computed, exact], resolution);
        Ok(vec![
            row("N_z(t0), N/m", solution.end_of(0).normal_force, loaded.normal),
            row("N_z half way through the slide, N/m", half_way, middle),
            row("Q_x at the end, N/m", solution.last().tangential_force, end.tangential),
        ])
    };
    let memory = match update {
        Update::Exponential => "exponential",
        Update::BackwardEuler => "backward Euler",
    };
    let steps = if finer == 1 { String::new() } else { format!(", {finer} x the steps") };
    Case {
        name: format!("transient, nu = {poisson}, alpha = {penalty:e}, {memory}{steps}"),
        source: "the same steps in Fourier space, same nodes",
        subjects,
        compare: Box::new(compare),
    }
}
