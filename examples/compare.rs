//! Laws on the same asperities: `cargo run --release --example compare -- configs/case_ii.toml hybrid,dmt,isbl`.

use stiction::{Error, Scene};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let scene = Scene::from_toml_file(arguments.next().unwrap_or_else(|| "configs/quick.toml".to_owned()))?;
    let laws = arguments.next().unwrap_or_else(|| "hybrid,dmt,isbl".to_owned());
    let laws: Vec<&str> = laws.split(',').collect();
    let comparison = stiction::builder(&scene).compare_ensembles(&laws)?;
    for law in comparison.laws() {
        let integral = law.integral().pull_off();
        print!("{:8} {integral:.4e} N by the integral", law.name());
        if let (Some(mean), Some(difference)) = (comparison.pull_off(law), comparison.paired_difference(law))
        {
            print!(", {:.4e} N of patches, ", mean.mean);
            print!("{:+.2e} N from the first ± {:.0e} N", difference.mean, difference.standard_error);
        }
        println!();
        law.limits().iter().for_each(|limit| println!("         not valid: {limit}"));
    }
    Ok(())
}
