//! Patches of several sizes: `cargo run --release --example finite_size -- configs/case_ii.toml sizes.h5`.

use stiction::Error;

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let mut argument = |default: &str| arguments.next().unwrap_or_else(|| default.to_owned());
    let (scene, output) = (argument("configs/case_ii.toml"), argument("sizes.h5"));
    let study = stiction::finite_size(scene, &[30, 100, 300, 1000], output)?;
    for size in &study.sizes {
        let ([bias, error], scatter) = (size.bias.map(|share| 100.0 * share), size.scatter.relative_std);
        println!("{:6} asperities: {bias:+7.2} % ± {error:.2} %, scatter {scatter:.3}", size.count);
    }
    match &study.approach {
        Ok(law) => println!("the bias goes as N^-{:.2}", law.exponent),
        Err(refusal) => println!("no power law: {refusal}"),
    }
    Ok(())
}
