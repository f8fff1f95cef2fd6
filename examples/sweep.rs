//! A sweep: `cargo run --release --example sweep -- configs/sweep_roughness.toml roughness.h5`.

use stiction::Error;

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let mut argument = |default: &str| arguments.next().unwrap_or_else(|| default.to_owned());
    let (scene, output) = (argument("configs/sweep_roughness.toml"), argument("roughness.h5"));
    for (number, point) in stiction::sweep(scene, output)?.iter().enumerate() {
        let difference = point.differences[0];
        for [mean, error] in point.pull_offs.iter().map(|own| own.force) {
            println!("{number:3} {mean:.4e} N ± {error:.0e} N, {:.4e} N by the integral", point.integral);
        }
        println!("    {:+.3e} N ± {:.0e} N from the first", difference.mean, difference.standard_error);
    }
    Ok(())
}
