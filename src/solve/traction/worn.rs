//! A point that wears as it slips: its worn depth grows with the pressure that the depth itself takes off.
//!
//! With h_w(p, m) what the step wears ([`Wear::depth`]) and s_n = p + rho_n o, o the overlap but for that, the laws of a point are two
//! equations for its pressure and its slip:
//!
//! ```text
//! p (1 + rho_n/alpha) + rho_n h_w(p, m) = s_n        for Archard's law a spring in series, 1/alpha + k m
//! |q|(p, m) + rho_t m = |s_t|                        without friction m = |s| is known
//! ```
//!
//! The second gives m(p), the first is then solved for p between 0 and what there is without wear. Their derivatives, with
//! give = dm/d|s_t| = 1/(d|q|/dm + rho_t), are
//!
//! ```text
//! dp  = theta (ds_n - beta d|s_t|),    beta = rho_n dh_w/dm give,
//! 1/theta = 1 + rho_n/alpha + rho_n dh_w/dp - beta d|q|/dp
//! ```
//!
//! and what friction adds to the tangent is as without wear.

use super::{Laws, Site};
use crate::friction::{Lasting, Law, Met, Shear};
use crate::wear::{Depth, Wear};

/// Evaluations at most.
const MOST: usize = 100;

/// What wear makes of the normal law at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Worn {
    /// p, Pa.
    pub pressure: f64,
    /// What the step wears, m.
    pub depth: f64,
    /// theta, and 1 - theta.
    pub stiff: f64,
    /// See `stiff`.
    pub soft: f64,
    /// theta beta, and that times rho_t; where the slip is known, 0 and theta rho_n dh_w/dm.
    pub coupling: [f64; 2],
}

/// The tangential side of a point: what its slip is at a pressure.
struct Slipping<'a, const D: usize> {
    site: &'a Site<D>,
    laws: Laws<'a>,
    /// |s|, m, and |s_t|, Pa.
    slip: f64,
    reach: f64,
}

/// What a pressure comes to.
struct Slipped {
    shear: Shear,
    depth: Depth,
    /// dm/d|s_t|, m/Pa; none where the slip is known.
    give: Option<f64>,
}

impl<const D: usize> Slipping<'_, D> {
    fn under(&self, pressure: f64, wear: Wear) -> Slipped {
        let at = self.site.circumstances(pressure, self.laws);
        let (shear, lasting, give) = match (self.laws.friction, self.site.moduli.tangential) {
            (None, _) => (Shear::default(), Lasting { length: self.slip, by_slip: 1.0 }, None),
            (Some(law), None) => (law.shear(at, self.slip), law.lasting(self.slip), None),
            (Some(law), Some(rho)) => {
                let Met { slip, shear } = Law::meet(law, at, self.reach, rho);
                (shear, law.lasting(slip), Some(1.0 / (shear.by_slip + rho)))
            }
        };
        Slipped { shear, depth: wear.depth(pressure, shear, lasting), give }
    }
}

/// The pressure under s_n = `trial`, Pa, and what goes with it; `slip` is |s|, m, and `reach` |s_t|, Pa.
pub(super) fn meet<const D: usize>(
    (site, laws): (&Site<D>, Laws<'_>),
    trial: f64,
    (slip, reach): (f64, f64),
    wear: Wear,
) -> Worn {
    let rho = site.moduli.normal;
    let elastic = laws.penalty.map_or(0.0, |alpha| rho / alpha);
    let slipping = Slipping { site, laws, slip, reach };
    // 1/theta - 1
    let softness = |Slipped { shear, depth, give }: &Slipped| {
        let taken = give.map_or(0.0, |give| depth.by_slip * give * shear.by_pressure);
        elastic + rho * (depth.by_pressure - taken)
    };
    let [mut low, mut high] = [0.0, trial / (1.0 + elastic)];
    let mut pressure = high;
    let mut met = slipping.under(pressure, wear);
    for _ in 0..MOST {
        let excess = pressure * (1.0 + elastic) + rho * met.depth.value - trial;
        *if excess < 0.0 { &mut low } else { &mut high } = pressure;
        let newton = pressure - excess / (1.0 + softness(&met));
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if excess == 0.0 || next.is_nan() || (next - pressure).abs() <= f64::EPSILON * pressure {
            break;
        }
        pressure = next;
        met = slipping.under(pressure, wear);
    }
    let softness = softness(&met);
    let stiff = 1.0 / (1.0 + softness);
    let beta = rho * met.depth.by_slip;
    let coupling = match (met.give, site.moduli.tangential) {
        (Some(give), Some(tangential)) => [stiff * beta * give, stiff * beta * give * tangential],
        _ => [0.0, stiff * beta],
    };
    Worn { pressure, depth: met.depth.value, stiff, soft: softness * stiff, coupling }
}
