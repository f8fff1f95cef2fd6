//! Shared by the tests of the library: the published cases, and a law asked for one asperity.
#![allow(dead_code)] // Each test takes what it needs.

pub mod asperities;
pub mod brute_force;
pub mod exact;
pub mod pool;
pub mod program;
pub mod unlocked;

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use stiction::asperity::scale::Asperity;
use stiction::asperity::{
    Facing, Law, LawParameters, Laws, Path, PlasticContact, Regime, Responses, Scratch, SolverStats,
};
use stiction::asperity::{MODELS, Model, model};
use stiction::engine::{Curves, Ensemble, Job, Outcome, Protocol, ReductionTree, Replica, Workspace, run};
use stiction::math::instruction_set::InstructionSet;
use stiction::surface::{Roughness, SamplingScheme, Surface};

/// The material and surface of case I, II or III of the published Table 2, with the inferred t and A_n, and the ν
/// of the reference values.
pub fn case(name: &str) -> (Asperity, Surface) {
    // R, Δγ, σ, η
    let (radius, work_of_adhesion, std, density) = match name {
        "I" => (1.66e-6, 0.01, 3.40e-9, 8.51e12),
        "II" => (3.33e-6, 0.09, 1.619e-9, 7.39e12),
        "III" => (6.38e-6, 0.30, 0.6541e-9, 9.87e12),
        _ => panic!("unknown case {name}"),
    };
    let asperity = Asperity {
        radius,
        reduced_modulus: 85.29e9,
        work_of_adhesion,
        equilibrium_spacing: 0.2e-9,
        hardness: 2.5e9,
        poisson_ratio: 0.27,
        lubricant_thickness: 0.5e-9,
    };
    let roughness = Roughness {
        asperity_radius: radius,
        asperity_density: density,
        nominal_area: 1000e-12,
        surface_height_std: Some(std),
        asperity_height_std: None,
        mean_plane_offset: None,
    };
    (asperity, Surface::new(&roughness).expect("a valid surface"))
}

/// Independent replicas that are summed directly, without functionals, controls and curves.
pub fn job<'a>(
    laws: impl Into<Laws<'a>>,
    surface: &'a Surface,
    separations: &'a [f64],
    replicas: u64,
) -> Job<'a> {
    Job {
        laws: laws.into(),
        surface,
        separations,
        seed: 5,
        scheme: SamplingScheme::Independent,
        replicas,
        controls: &[],
        keep_curves: false,
        moments: None,
        protocol: Protocol { stiffness_span: Some(0.2e-9), ..Protocol::default() },
    }
}

/// The ensemble of a job, on so many threads.
pub fn ensemble(job: &Job<'_>, threads: usize) -> Ensemble {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    match run::<()>(job, &pool, &AtomicBool::new(false), |_, _| Ok(())) {
        Ok(Outcome::Complete(tree)) => tree.into_ensemble(job),
        _ => panic!("the run did not complete"),
    }
}

/// The first replica of a job, and its curves.
pub fn one(job: &Job<'_>) -> (Replica, Curves) {
    let mut found = None;
    Workspace::new(job).replicas(job, 0..1, |replica, curves| found = Some((replica, curves.clone())));
    found.unwrap()
}

/// Even separations, m, between two that are given over σ.
pub fn separations(surface: &Surface, from: f64, to: f64, count: usize) -> Vec<f64> {
    let h_star = |i: usize| from + (to - from) * i as f64 / (count - 1) as f64;
    (0..count).map(|i| h_star(i) * surface.surface_height_std).collect()
}

/// A law of an asperity with starting tables for the interferences `reach`, m.
pub fn law(name: &str, asperity: &Asperity, path: Path, reach: (f64, f64)) -> Box<dyn Law> {
    let parameters = LawParameters::new(asperity, path, reach).expect("a valid setting");
    model(name).expect("a known law").law(&parameters).expect("a law of the setting")
}

/// The law `md_plastic` with a plastic contact by its name.
pub fn flattening(contact: &str) -> Model {
    let (_, contact) = PlasticContact::ALL.into_iter().find(|(name, _)| *name == contact).expect("a contact");
    model("md_plastic").expect("a known law").with_contact(contact)
}

/// The laws that need no liquid.
pub fn dry_laws() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().filter(|model| !model.is_wet())
}

/// All that is written of something, to the bit.
pub fn bytes(value: &impl serde::Serialize) -> Vec<u8> {
    postcard::to_stdvec(value).unwrap()
}

/// A tree as it is read after it was written.
pub fn reread(tree: &ReductionTree) -> ReductionTree {
    postcard::from_bytes(&bytes(tree)).unwrap()
}

/// What one asperity does at an interference: its regime and F_s, P (N), contact area (m²); `None` beyond the
/// law's end.
pub fn respond(law: &dyn Law, interference: f64) -> Option<(Regime, [f64; 3])> {
    let mut found = None;
    let visit = |regime: usize, _: std::ops::Range<usize>, responses: &Responses| {
        let values = [responses.adhesion[0], responses.contact[0], responses.area[0]];
        found = Some((law.regimes()[regime], values));
    };
    let facing = Facing { law, heights: &[interference], separation: 0.0 };
    facing.for_each_block(&mut Scratch::default(), &mut SolverStats::default(), visit);
    found
}

/// Does something with every instruction set of this processor in turn, the fastest last. Only one test of a
/// program at a time.
pub fn for_each_instruction_set(mut with: impl FnMut(InstructionSet)) {
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    for set in InstructionSet::available() {
        set.select();
        with(set);
        assert_eq!(InstructionSet::current(), set);
    }
}
