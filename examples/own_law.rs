//! A law and an ensemble of one's own, without any scene: DMT's contact written down in three formulas, on
//! patches of 1000 asperities, against its integral.

use stiction::asperity::{ClosedForm, Constant, Quantity, Regime, Row, Table};
use stiction::engine::Job;
use stiction::integral::Expectations;
use stiction::surface::Surface;
use stiction::validation::z_scores;

fn main() {
    let (radius, modulus, work_of_adhesion) = (1.66e-6_f64, 85.3e9, 0.04);
    let adhesion = move |_: f64| 2.0 * std::f64::consts::PI * radius * work_of_adhesion;
    let contact = move |delta: f64| 4.0 / 3.0 * modulus * radius.sqrt() * delta.powi(3).sqrt();
    let area = move |delta: f64| std::f64::consts::PI * radius * delta;
    let law = Table::new([
        Row::below(Regime::Noncontact, 0.0, Constant::NOTHING),
        Row::last(Regime::Elastic, ClosedForm::new(adhesion, contact, area).with_root(0.0, 2)),
    ]);
    // Heights of 1 nm standard deviation on 100 µm².
    let surface = Surface::uniform(1e-9, radius, 1000, 1e-10);
    let separations: Vec<f64> = (0..41).map(|k| 0.1e-9 * f64::from(k)).collect();
    let replicas = 256;
    let ensemble = Job::new(&law, &surface, &separations, replicas, 1).ensemble();
    let integral = Expectations::new(&law, &surface, &separations);
    let force = Quantity::ExternalForce.index();
    let (mean, expected) = (ensemble.curves[force].mean(), &integral.expected[force]);
    let scores = z_scores(mean, expected, &integral.std[force], replicas);
    for k in (0..separations.len()).step_by(8) {
        let (mean, expected) = (mean[k] * 1e6, expected[k] * 1e6);
        println!("{:4.1} nm {mean:9.4} uN {expected:9.4} uN, z = {:5.2}", separations[k] * 1e9, scores[k]);
    }
}
