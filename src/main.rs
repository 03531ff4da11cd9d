//! temporary
use mpjr::composition::build;
use mpjr::petsc::Session;
use mpjr::scene::{Source, read};
use mpjr::solve::{Driver, Observer, Report};
use mpi::traits::*;
struct Print(bool);
impl Observer for Print {
    fn observe(&mut self, r: Report<'_>) -> mpjr::error::Result<()> {
        let t = r.problem.contact()?.totals()?;
        if self.0 { println!("{} {:.6} {} {:.12} {:.12} {:.6e} {:.3} {:.3} {:.3e}", r.phase, r.time, r.newton, t.normal_force, t.tangential_force, t.hysteretic_force, t.contact_fraction, t.stick_fraction, t.max_penetration); }
        Ok(())
    }
}
fn main() -> mpjr::error::Result<()> {
    let args: Vec<String> = std::env::args().collect();
    let split = args.iter().position(|a| a == "--").unwrap_or(args.len());
    let session = Session::start(&args[(split + 1).min(args.len())..])?;
    let source = Source { file: args[1].clone().into(), overrides: args[2..split].to_vec() };
    let text = std::fs::read_to_string(&args[1]).unwrap_or_default();
    let scene = read(&text, &source)?;
    let world = session.world();
    let mut p = build(&world, &scene)?;
    let mut print = Print(world.rank() == 0);
    let start = std::time::Instant::now();
    let outcome = Driver::new(&mut p.monolithic, &mut print, &p.phases).run(&world, p.settings, &mut p.tangent, &mut p.u);
    if world.rank() == 0 { println!("{:?} {:?} unused {:?}", outcome, start.elapsed(), session.unused_options()); }
    Ok(())
}
