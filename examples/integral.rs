//! The statistical integral of a law over a surface, without any scene: the external force over the
//! separation.

use stiction::asperity::{Asperity, LawError, LawParameters, Path, Quantity, model};
use stiction::integral::Expectations;
use stiction::surface::Surface;

fn main() -> Result<(), LawError> {
    let asperity = Asperity {
        radius: 3.33e-6,
        work_of_adhesion: 0.09,
        reduced_modulus: 85.29e9,
        equilibrium_spacing: 0.2e-9,
        lubricant_thickness: 0.5e-9,
        hardness: 6e9,
        poisson_ratio: 0.27,
    };
    // Heights of 1.6 nm standard deviation, 7390 asperities on 1000 µm².
    let surface = Surface::uniform(1.6e-9, asperity.radius, 7390, 1e-9);
    let law = model("hybrid").expect("it is a law").law(&LawParameters::new(
        &asperity,
        Path::Approach,
        (-50e-9, 50e-9),
    )?)?;
    let separations: Vec<f64> = (0..40).map(|k| 0.2e-9 * f64::from(k)).collect();
    let integral = Expectations::new(law.as_ref(), &surface, &separations);
    for (h, force) in separations.iter().zip(&integral.expected[Quantity::ExternalForce.index()]) {
        println!("{:5.1} nm {:12.3} uN", h * 1e9, force * 1e6);
    }
    Ok(())
}
