//! Surfaces that are brought close and pulled back: what pulls them off, and the energy that is lost.

use stiction::{Error, Scene};

fn main() -> Result<(), Error> {
    let mut scene = Scene::from_toml_file("configs/loop.toml")?;
    scene.replicas = 64;
    let result = stiction::run(&scene)?;
    for (name, unit) in [("pull_off_force", "N"), ("dissipated_energy", "J")] {
        let Some(mean) = result.scalar(name) else { continue };
        println!("{name}: {:.4e} {unit} ± {:.0e}", mean.controlled_mean, mean.controlled_standard_error);
    }
    let integral = stiction::integrate(&scene)?;
    let approach = integral.main.pull_off();
    let retraction = integral.retraction.map_or(approach, |retraction| retraction.pull_off());
    println!("pull-off of the integral: {approach:.4e} N on approach, {retraction:.4e} N on retraction");
    Ok(())
}
