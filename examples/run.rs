//! Runs a scene and writes its result: `cargo run --release --example run -- configs/case_ii.toml
//! case_ii.h5`.

use stiction::{Error, Scene};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "configs/case_ii.toml".to_owned());
    let scene = Scene::from_toml_file(scene)?;
    let results = stiction::run(&scene)?;
    let pull_off = results.pull_off();
    println!("pull-off {:.4e} N, standard error {:.1e} N", pull_off.mean, pull_off.standard_error);
    println!(
        "of the integral {:.4e} N: {}",
        results.pull_off_of_integral(),
        results.joint_test().verdict.name()
    );
    match arguments.next() {
        Some(output) => results.write(output),
        None => Ok(()),
    }
}
