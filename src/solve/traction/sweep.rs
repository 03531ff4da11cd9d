//! Point after point: each meets its laws under what the others do (Gauss and Seidel; for friction Jourdan, Alart and Jean, Comput.
//! Methods Appl. Mech. Engrg. 155 (1998) 31).
//!
//! Newton's method takes all points at once from one side of a kink of the laws to the other, and may go round in circles among the
//! sides. Point after point the way is long, but it does not turn back; what it leaves are the long waves, which are Newton's.

use nalgebra::{SMatrix, SVector};

use super::dense::Influence;
use super::search::Outcome;
use super::{Laws, Moduli, Site, Sites};

/// Tractions after so many sweeps over all points, to and fro, under an indenter that stays.
pub fn sweep<const D: usize>(
    sites: &Sites<D>,
    mut at: Outcome<D>,
    laws: Laws<'_>,
    influence: &Influence<'_, D>,
    sweeps: usize,
) -> Outcome<D> {
    let all: Vec<usize> = (0..sites.len()).collect();
    let columns: Vec<_> = all.iter().map(|&j| influence(j, &all)).collect();
    let alone: Vec<Site<D>> = sites.iter().enumerate().map(|(i, site)| by_itself(site, &columns[i][i])).collect();
    let (tractions, motions) = (&mut at.tractions, &mut at.motions);
    for sweep in 0..sweeps {
        for step in 0..sites.len() {
            let i = if sweep % 2 == 0 { step } else { sites.len() - 1 - step };
            let met = alone[i].answer(&tractions[i], &motions[i], laws).met(&alone[i]);
            let change: SVector<f64, D> = met - tractions[i];
            if change.norm_squared() > 0.0 {
                tractions[i] = met;
                motions.iter_mut().zip(&columns[i]).for_each(|(motion, block)| *motion += block * change);
            }
        }
    }
    at.under(sites, laws)
}

/// With moduli of what the body answers to the point's own traction: then the laws meet it at once, but for what a pressure moves
/// along the face.
fn by_itself<const D: usize>(site: &Site<D>, own: &SMatrix<f64, D, D>) -> Site<D> {
    let normal = site.normal.dot(&(own * site.normal));
    let tangential = (own.trace() - normal) / (D - 1) as f64;
    let moduli = Moduli {
        normal: if normal > 0.0 { 1.0 / normal } else { site.moduli.normal },
        tangential: site.moduli.tangential.map(|rho| if tangential > 0.0 { 1.0 / tangential } else { rho }),
    };
    Site { moduli, ..site.clone() }
}
