//! The face solved for its tractions: derivatives against differences, the linear system against its product, solutions, in the
//! plane and in space. (LAPACK is called through PETSc, which wants MPI.)
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/mpi.rs"]
mod mpi_cases;

use std::path::Path;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;
use mpi_cases::Case;
use mpjr::adhesion;
use mpjr::expression::Expression;
use mpjr::friction::{Coefficient, Coulomb, CoulombTanh, ElasticSlip, Law, Strength, VARIABLES};
use mpjr::interface::State;
use mpjr::loading::Support;
use mpjr::profile::Height;
use mpjr::solve::traction::{
    Border, Damping, Factor, Held, Laws, Moduli, Operator, Outcome, Site, Sites, against, product, settle, shift,
};
use mpjr::wear::{Part, Wear};
use nalgebra::{DMatrix, SMatrix, SVector, Vector2};

const CASES: &[Case] = &[
    Case::new("the_linear_system_is_the_derivative", &[1], the_linear_system_is_the_derivative),
    Case::new("the_linear_system_of_adhesion_is_the_derivative", &[1], the_linear_system_of_adhesion_is_the_derivative),
    Case::new("the_borders_are_derivatives", &[1], the_borders_are_derivatives),
    Case::new("the_solution_does_not_depend_on_rho", &[1], the_solution_does_not_depend_on_rho),
    Case::new("a_held_point_has_the_shear_of_its_slip", &[1], a_held_point_has_the_shear_of_its_slip),
];

fn main() {
    mpi_cases::main(CASES);
}

/// Deterministic numbers in [-1, 1).
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector<const D: usize>(&mut self) -> SVector<f64, D> {
        SVector::from_fn(|_, _| self.unit())
    }
}

/// A few points before a body of random compliance: some stick, some slip, some are open.
struct Face<const D: usize> {
    sites: Sites<D>,
    compliance: DMatrix<f64>,
    free: Vec<SVector<f64, D>>,
    tractions: Vec<SVector<f64, D>>,
}

impl<const D: usize> Face<D> {
    fn new(count: usize, draw: &mut Draw) -> Self {
        let root = DMatrix::from_fn(D * count, D * count, |_, _| draw.unit());
        let compliance = &root * root.transpose() + DMatrix::identity(D * count, D * count);
        let site = |_| Site {
            normal: (SVector::<f64, D>::from_fn(|i, _| f64::from(u8::from(i + 1 == D))) + draw.vector() * 0.3)
                .normalize(),
            weight: 1.0 + 0.5 * draw.unit(),
            clearance: 0.2 * draw.unit() - 0.5,
            drive: draw.vector(),
            elastic: SVector::zeros(),
            slid: 0.3,
            temperature: 0.0,
            moduli: Moduli { normal: 0.3, tangential: Some(0.4) },
            damping: None,
            lengths: [1.0; 2],
        };
        let sites = (0..count).map(site).collect::<Vec<_>>().into();
        let mut vectors = || (0..count).map(|_| draw.vector()).collect::<Vec<_>>();
        Self { sites, compliance, free: vectors(), tractions: vectors() }
    }

    fn block(&self, i: usize, j: usize) -> SMatrix<f64, D, D> {
        self.compliance.fixed_view::<D, D>(D * i, D * j) * self.sites[j].weight
    }

    fn column(&self, j: usize, rows: &[usize]) -> Vec<SMatrix<f64, D, D>> {
        rows.iter().map(|i| self.block(*i, j)).collect()
    }

    fn moves(&self, tractions: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let of = |i| tractions.iter().enumerate().map(|(j, t)| self.block(i, j) * t).sum();
        (0..tractions.len()).map(of).collect()
    }

    fn outcome(&self, tractions: Vec<SVector<f64, D>>, laws: Laws<'_>) -> Outcome<D> {
        let motions = self.moves(&tractions).iter().zip(&self.free).map(|(moved, free)| moved + free).collect();
        Outcome::new(&self.sites, tractions, (motions, SVector::zeros()), laws)
    }

    /// Central differences of G along dt.
    fn differences(&self, dt: &[SVector<f64, D>], laws: Laws<'_>) -> Vec<SVector<f64, D>> {
        let step = 1e-7;
        let shifted = |h: f64| {
            let t = self.tractions.iter().zip(dt).map(|(t, dt)| t + dt * h).collect();
            excesses(&self.outcome(t, laws))
        };
        shifted(step).iter().zip(shifted(-step)).map(|(plus, minus)| (plus - minus) / (2.0 * step)).collect()
    }
}

fn excesses<const D: usize>(outcome: &Outcome<D>) -> Vec<SVector<f64, D>> {
    outcome.excess()
}

/// No wear, and wear so quick that the depth is a third of the slip times the pressure.
fn worn() -> [Option<Wear>; 3] {
    let wear = |law| Wear { of: Part::Body, law, coefficient: 0.3 };
    [None, Some(wear(mpjr::wear::Law::Archard)), Some(wear(mpjr::wear::Law::Energy))]
}

fn all_laws(check: impl Fn(Laws<'_>)) {
    // Weakens with the rate and with the distance, by less than any rho of these tests; strengthens with the pressure up to a limit.
    let formula = Expression::parse("0.38 + 0.01*exp(-v/2) + 0.01*exp(-s) + 0.02*p", &VARIABLES).unwrap();
    let formula = Strength::new(Coefficient::Formula(Arc::new(formula)), Some(0.6));
    let laws = [Strength::constant(0.4), formula].map(|strength| -> [Box<dyn Law>; 3] {
        [
            Box::new(CoulombTanh { strength: strength.clone(), regularisation: 0.9 }),
            Box::new(ElasticSlip { strength: strength.clone(), elastic_slip: 0.7 }),
            Box::new(Coulomb { strength }),
        ]
    });
    let friction = std::iter::once(None).chain(laws.as_flattened().iter().map(|law| Some(&**law)));
    for friction in friction {
        for (penalty, wear) in [None, Some(2.0)].into_iter().flat_map(|penalty| worn().map(|wear| (penalty, wear))) {
            check(Laws { penalty, friction, wear, adhesion: None, dt: 0.5, resolution: 0.0, held: Held::default() });
        }
    }
}

/// The same with attraction across gaps, whose steepest fall is less than rho_n, also where it is held back on the way of a jump, and with
/// what a bond bears.
fn the_linear_system_of_adhesion_is_the_derivative(_: &SimpleCommunicator, _: &Path) {
    let (work, range) = (0.1, 1.0);
    let laws: [Box<dyn adhesion::Law>; 3] = [
        Box::new(adhesion::Exponential { work, range }),
        Box::new(adhesion::Bilinear { work, range }),
        Box::new(adhesion::Dugdale { work, range }),
    ];
    let bonded = |bond| -> [Box<dyn Law>; 3] {
        let strength = Strength::constant(0.4).bonded(bond);
        [
            Box::new(CoulombTanh { strength: strength.clone(), regularisation: 0.9 }),
            Box::new(ElasticSlip { strength: strength.clone(), elastic_slip: 0.7 }),
            Box::new(Coulomb { strength }),
        ]
    };
    let frictions = [bonded(0.0), bonded(0.3)];
    let mut open = 0;
    for (adhesion, damping) in laws.iter().flat_map(|law| [None, Some(0.5)].map(|kappa| (law, kappa))) {
        for friction in std::iter::once(None).chain(frictions.as_flattened().iter().map(|law| Some(&**law))) {
            for penalty in [None, Some(2.0)] {
                let (adhesion, held) = (Some(&**adhesion), Held::default());
                let laws = Laws { penalty, friction, wear: None, adhesion, dt: 0.5, resolution: 0.0, held };
                for seed in 1..6 {
                    let mut draw = Draw(seed);
                    let mut face = Face::<3>::new(7, &mut draw);
                    let stiffness = damping.unwrap_or_default();
                    for site in face.sites.each() {
                        site.damping = damping.map(|_| Damping { stiffness, overlap: draw.unit() });
                    }
                    open += pulled(&face, laws, &mut draw);
                }
            }
        }
    }
    assert!(open > 100, "{open}");
}

/// How many points are pulled across a gap, where the tangent is the derivative.
fn pulled<const D: usize>(face: &Face<D>, laws: Laws<'_>, draw: &mut Draw) -> usize {
    let at = face.outcome(face.tractions.clone(), laws);
    let points = at.linearised(&face.sites);
    let dt: Vec<SVector<f64, D>> = (0..7).map(|_| draw.vector()).collect();
    let exact = product(&points, &dt, &face.moves(&dt));
    for (difference, exact) in face.differences(&dt, laws).iter().zip(&exact) {
        assert!((difference - exact).norm() < 2e-6 * exact.norm().max(1.0), "{laws:?}");
    }
    at.answers.iter().filter(|(_, answer)| answer.active && answer.gap > 0.0).count()
}

/// J dt against central differences of G, and J (J^-1 b) = b, for every law and with no penetration.
fn the_linear_system_is_the_derivative(_: &SimpleCommunicator, _: &Path) {
    derivative::<2>();
    derivative::<3>();
}

fn derivative<const D: usize>() {
    all_laws(|laws| {
        let mut draw = Draw(3);
        let face = Face::<D>::new(7, &mut draw);
        let at = face.outcome(face.tractions.clone(), laws);
        assert!((2..7).contains(&at.in_contact()), "{}", at.in_contact());
        let points = at.linearised(&face.sites);
        let dt: Vec<SVector<f64, D>> = (0..7).map(|_| draw.vector()).collect();
        let exact = product(&points, &dt, &face.moves(&dt));
        for (difference, exact) in face.differences(&dt, laws).iter().zip(&exact) {
            assert!((difference - exact).norm() < 2e-7, "{laws:?}");
        }
        let factor = Factor::new(points.clone(), &|j, rows| face.column(j, rows)).unwrap();
        let solved = factor.solve(&dt, |t| Ok(face.moves(t))).unwrap();
        for (back, b) in product(&points, &solved, &face.moves(&solved)).iter().zip(&dt) {
            assert!((back - b).norm() < 1e-9, "{laws:?}");
        }
    });
}

/// An indenter that a force presses down, or a spring, and that a spring pulls along under a curved profile: the bordered product against
/// central differences of G and of the equations of the indenter, and its inverse.
fn the_borders_are_derivatives(_: &SimpleCommunicator, _: &Path) {
    borders::<2>();
    borders::<3>();
}

fn borders<const D: usize>() {
    let profile = |further: Vector2<f64>| {
        let height = |i: u32| {
            let [x, y] = [0.3 * f64::from(i) - further.x, 0.1 * f64::from(i * i) - further.y];
            let gradient = Vector2::new(0.2 * x.cos() * y.cos(), -0.2 * x.sin() * y.sin());
            Height { height: 0.2 * x.sin() * y.cos(), gradient }
        };
        (0..7).map(height).collect::<Vec<_>>()
    };
    let spring = Support { force: 0.4, stiffness: 1.7, size: 1.0, inert: false };
    let along = |normal, x: Option<Support>| [normal, x, x.filter(|_| D > 2)];
    let force = Some(Support::force(0.9));
    for supports in [along(force, None), along(None, Some(spring)), along(Some(spring), Some(spring))] {
        all_laws(|laws| {
            let laws = Laws { held: Held { supports, profile: Some(&profile) }, ..laws };
            let mut draw = Draw(5);
            let face = Face::<D>::new(7, &mut draw);
            let dt: Vec<SVector<f64, D>> = (0..7).map(|_| draw.vector()).collect();
            let gone = std::array::from_fn(|i| if supports[i].is_some() { [0.3, -0.2, 0.1][i] } else { 0.0 });
            let state = |h: f64| {
                let t: Vec<_> = face.tractions.iter().zip(&dt).map(|(t, dt)| t + dt * h).collect();
                let shift = shift::<D>(gone) * (h / 0.3);
                let moved = face.moves(&t).into_iter().zip(&face.free).zip(&face.sites);
                let motions = moved.map(|((moved, free), site)| moved + free + against(site, &shift)).collect();
                Outcome::new(&face.sites, t, (motions, shift), laws)
            };
            let at = state(0.0);
            let points = at.linearised(&face.sites);
            let border = Border::new(&face.sites, (&at, &points), laws.held).unwrap();
            // kappa is the points' modulus, 0.3.
            let mut exact = product(&points, &dt, &face.moves(&dt));
            let rows = border.product(&face.sites, (&dt, gone), &mut exact);
            let step = 1e-6;
            let (plus, minus) = (state(step), state(-step));
            for ((plus, minus), exact) in excesses(&plus).iter().zip(excesses(&minus)).zip(&exact) {
                let apart = ((plus - minus) / (2.0 * step) - exact).norm();
                assert!(apart < 1e-7, "{laws:?} {apart:e} {exact}");
            }
            let [plus, minus] = [plus, minus].map(|state| state.unbalanced(&face.sites));
            for i in (0..3).filter(|i| supports[*i].is_some()) {
                assert!(((plus[i] - minus[i]) / (2.0 * step) - rows[i]).abs() < 1e-6, "{laws:?} {i}");
            }
            let factor = Factor::new(points.clone(), &|j, rows| face.column(j, rows)).unwrap();
            let inverse = |right: &[SVector<f64, D>]| factor.solve(right, |t| Ok(face.moves(t)));
            let (back, far) = border.solve(&face.sites, (&exact, rows), inverse).unwrap().unwrap();
            for (back, dt) in back.iter().zip(&dt) {
                assert!((back - dt).norm() < 1e-8, "{laws:?}");
            }
            assert!((0..3).all(|i| (far[i] - gone[i]).abs() < 1e-8), "{laws:?} {far:?} {gone:?}");
        });
    }
}

/// Newton's method ends where the laws hold, whatever rho: in the plane and in space, exact laws too. Pressures and shears of
/// two rho differ by round-off.
fn the_solution_does_not_depend_on_rho(_: &SimpleCommunicator, _: &Path) {
    solution::<2>();
    solution::<3>();
}

fn solution<const D: usize>() {
    all_laws(|laws| {
        let mut solved = Vec::new();
        for rho in [0.05, 0.4] {
            let mut face = Face::<D>::new(9, &mut Draw(11));
            let moduli = Moduli { normal: rho, tangential: Some(1.3 * rho) };
            face.sites = face.sites.iter().map(|site| Site { moduli, ..site.clone() }).collect::<Vec<_>>().into();
            let from = face.outcome(vec![SVector::zeros(); 9], laws);
            let operator: Operator<'_, D> = (&|j, rows| face.column(j, rows), &|t| Ok(face.moves(t)));
            let end = settle(&face.sites, from, laws, operator, 60).unwrap();
            assert!(end.norm() <= end.noise(), "{laws:?} {rho}: {:e}", end.norm());
            for (i, answer) in &end.answers {
                let (site, motion) = (&face.sites[*i], &end.motions[*i]);
                let state = answer.state(site, motion, laws, &State::default());
                let at = site.circumstances(state.pressure, laws);
                let bound = laws.friction.map_or(0.0, |law| law.bound(at, answer.slip.norm()).value);
                assert!(state.pressure >= 0.0 && state.shear.norm() <= bound * (1.0 + 1e-14));
            }
            solved.push(end.tractions);
        }
        for (a, b) in solved[0].iter().zip(&solved[1]) {
            assert!((a - b).norm() < 1e-12, "{laws:?}: {a} {b}");
        }
    });
}

/// A point that is held along the face answers with what its law says of the slip, or takes any shear that Coulomb allows.
fn a_held_point_has_the_shear_of_its_slip(_: &SimpleCommunicator, _: &Path) {
    let law = Coulomb { strength: Strength::constant(0.5) };
    let (penalty, friction, held) = (Some(4.0), Some(&law as &dyn Law), Held::default());
    let laws = Laws { penalty, friction, wear: None, adhesion: None, dt: 1.0, resolution: 0.0, held };
    let site = |slip: f64| Site {
        normal: SVector::from([0.0, 1.0]),
        weight: 1.0,
        clearance: -1.0,
        drive: SVector::from([slip, 0.0]),
        elastic: SVector::zeros(),
        slid: 0.0,
        temperature: 0.0,
        moduli: Moduli { normal: 4.0, tangential: None },
        damping: None,
        lengths: [1.0; 2],
    };
    let met = |slip: f64, shear: f64| {
        let site = site(slip);
        site.answer(&SVector::from([shear, -4.0]), &SVector::zeros(), laws).met(&site)
    };
    // p = alpha o = 4 Pa.
    assert_eq!(met(0.1, 0.3), SVector::from([2.0, -4.0]));
    assert_eq!(met(-0.1, 0.3), SVector::from([-2.0, -4.0]));
    assert_eq!(met(0.0, 0.3), SVector::from([0.3, -4.0]));
    assert_eq!(met(0.0, -7.0), SVector::from([-2.0, -4.0]));
}
