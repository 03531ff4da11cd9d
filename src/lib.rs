//! Parallel transient viscoelastic contact with friction, by interface finite elements with embedded profiles (MPJR).
//!
//! A module uses those of its row and of the rows below, and none above (docs/architecture.md has the picture and the way of a step through it,
//! docs/equations.md where each equation lives):
//!
//! | | |
//! |---|---|
//! | [`cli`] | commands: arguments, exit codes, what is printed |
//! | [`study`], [`verify`], [`plot`], [`solution`], [`warnings`] | what is advised, compared, drawn; a scene solved in memory; what is doubtful |
//! | [`composition`] | the root: a scene becomes mesh, profile, laws, body and strategy |
//! | [`scene`] | keys and checks: plain typed data |
//! | [`steady`] | steady sliding, without steps |
//! | [`solve`] | the driver; the face solved for its tractions ([`solve::traction`]), what stands behind it, the monolithic strategy |
//! | [`output`] | history, fields, XDMF, checkpoints |
//! | [`interface`], [`bulk`] | points of the contact with their laws and states; forces of a body with memory |
//! | [`energy`], [`snapshot`], [`loading`] | the balance; the state as lists; where the indenter is |
//! | [`friction`], [`adhesion`], [`wear`], [`profile`], [`rheology`], [`element`], [`mesh`] | pure laws, numbers in and numbers out; cells |
//! | [`expression`], [`table`], [`heightmap`], [`input`], [`checksum`] | formulas and files of numbers |
//! | [`oracle`] | closed forms and Fourier solutions that results are compared with |
//! | [`petsc`], [`parallel`], [`memory`], [`error`] | thin safe wrappers, the only `unsafe` code; one outcome for all ranks |

// All that is printed goes through cli::terminal, which survives a reader that goes away.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod adhesion;
pub mod bulk;
pub mod checksum;
pub mod cli;
pub mod composition;
pub mod element;
pub mod energy;
pub mod error;
pub mod expression;
pub mod friction;
pub mod heightmap;
pub mod input;
pub mod interface;
pub mod loading;
pub mod memory;
pub mod mesh;
pub mod oracle;
pub mod output;
pub mod parallel;
pub mod petsc;
pub mod plot;
pub mod profile;
pub mod rheology;
pub mod scene;
pub mod snapshot;
pub mod solution;
pub mod solve;
pub mod steady;
pub mod study;
pub mod table;
pub mod verify;
pub mod warnings;
pub mod wear;
