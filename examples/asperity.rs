//! One asperity on approach and on retraction: the interferences at which it snaps in and off, and its
//! forces between them.

use stiction::asperity::{LawError, LawParameters, Path, SolvedAsperity, model};

fn main() -> Result<(), LawError> {
    // Scaled variables: forces are over πRΔγ, and the adhesion parameter λ is all that there is.
    let model = model("md").expect("Maugis and Dugdale's law");
    let approach = model.law(&LawParameters::scaled(5.0, Path::Approach)?)?;
    let retraction = model.law(&LawParameters::scaled(5.0, Path::Retraction)?)?;
    println!("{:>6} {:>10} {:>10}", "delta", "approach", "retraction");
    for step in -5..=4 {
        let delta = 0.25 * f64::from(step);
        let force = |law| SolvedAsperity::new(law, delta).external_force();
        println!("{delta:6.2} {:10.5} {:10.5}", force(approach.as_ref()), force(retraction.as_ref()));
    }
    Ok(())
}
