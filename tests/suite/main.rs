//! All tests of the library and the program that share a process: one program to build and to link, `cargo test
//! --release --test suite loops::` for the tests of one file. The others are those of `fuzz`, which counts allocations.

#[path = "../common/mod.rs"]
mod common;
// Elementary functions of the program, for the library in this one.
#[path = "../../src/elementary.rs"]
mod elementary;

mod additions;
mod answers;
mod background;
mod bad_scenes;
mod capillary;
mod circles;
mod cli;
mod compare;
mod compressed;
mod coupled;
mod coupled_limits;
mod cycles;
mod ensemble;
mod extremes;
mod faults;
mod forest;
mod histories;
mod hostile_files;
mod hybrid;
mod independence;
mod instruction_sets;
mod integral_alone;
mod interruption;
mod lab;
mod large_surfaces;
mod laws;
mod loops;
mod loops_of_radii;
mod md_plastic;
mod measured_surfaces;
mod model_range;
mod outputs;
mod populations;
mod probe;
mod processors;
mod programs;
mod quantiles;
mod rough_surface;
mod same_bits;
mod sampling;
mod scene_defaults;
mod secant;
mod shards;
mod single_asperity;
mod sizes;
mod skips;
mod solver;
mod stability;
mod stopping;
mod sums;
mod sweep;
mod sweeps;
mod terminal;
mod unloading;
mod validation;
mod validity;
mod wet_plastic;
