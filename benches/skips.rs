//! What each skip brings: the time of one replica, summed directly, with it and without, in the same run. A
//! skip is switched off from outside, by a law that hides what allows it, so that the library has one way
//! only:
//!
//! * series: far from contact every asperity is solved;
//! * constant: the lubricant's force is evaluated and summed asperity by asperity;
//! * touches: where nothing touches, load and area are summed, too;
//! * unreached: the regimes that no asperity reaches are there. This is the other way round, because a regime
//!   without asperities is an empty range and nothing needs to be skipped: what would be gained without them.
//!
//! Both runs alternate, and the least of many counts. How far two runs of the same law are from 1 is said
//! first, as `nothing`.

mod common;

use common::{job, scene, seconds, text};
use stiction::asperity::emd::Emd;
use stiction::asperity::{BLOCK, Boundary, Lane, Lanes, Law, Method, Piece, Regime, Responses, SolverStats};
use stiction::engine::Workspace;
use stiction::math::instruction_set::InstructionSet;
use stiction::scene::Scene;

/// Runs of each kind.
const RUNS: usize = 60;

/// A law without some of what allows skips.
struct Hidden<'a> {
    law: &'a dyn Law,
    regimes: Vec<Regime>,
    /// The branch before contact without the series, the unit of length, the lubricant's thickness and the
    /// unit of force, SI.
    solved: Option<(Emd, f64, f64, f64)>,
    hides_constant: bool,
}

impl<'a> Hidden<'a> {
    fn nothing(law: &'a dyn Law) -> Self {
        Self { law, regimes: law.regimes().to_vec(), solved: None, hides_constant: false }
    }

    fn series(law: &'a dyn Law, scene: &Scene) -> Self {
        let (scale, (lowest, highest)) = (scene.scale(), scene.interference_range());
        let thickness = scene.asperity.lubricant_thickness;
        let lowest = (lowest + thickness) / scale.length;
        let emd = Emd::new(scale.lambda, scene.history).expect("a valid lambda");
        let emd = emd.with_contact_table(highest / scale.length).with_noncontact_tables(lowest);
        Self { solved: Some((emd, scale.length, thickness, scale.force)), ..Self::nothing(law) }
    }

    fn constant(law: &'a dyn Law) -> Self {
        Self { hides_constant: true, ..Self::nothing(law) }
    }

    /// With regimes before contact under the name of one in contact.
    fn touches(law: &'a dyn Law) -> Self {
        let mut hidden = Self::nothing(law);
        hidden
            .regimes
            .iter_mut()
            .filter(|regime| !regime.is_contact())
            .for_each(|regime| *regime = Regime::Elastic);
        hidden
    }

    /// Without the regimes that no height within 11 standard deviations reaches.
    fn unreached(law: &'a dyn Law, scene: &Scene) -> Self {
        let (_, highest) = scene.interference_range();
        let mut hidden = Self::nothing(law);
        let reached =
            law.boundaries().iter().take_while(|boundary| boundary.interference < highest).count() + 1;
        hidden.regimes.truncate(reached);
        hidden
    }
}

impl Law for Hidden<'_> {
    fn regimes(&self) -> &[Regime] {
        &self.regimes
    }

    fn boundaries(&self) -> &[Boundary] {
        let boundaries = self.law.boundaries();
        &boundaries[..boundaries.len().min(self.regimes.len())]
    }

    fn pieces_of(&self, regime: usize, _: Option<&Lane>) -> Vec<Piece> {
        self.law.pieces_of(regime, None)
    }

    fn method(&self, regime: usize) -> Method {
        match self.law.method(regime) {
            Method::Constant(_) if self.hides_constant => Method::ClosedForm,
            method => method,
        }
    }

    fn evaluate(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let Some((emd, length, thickness, force)) = self.solved.as_ref().filter(|_| regime == 0) else {
            return self.law.evaluate(regime, lanes, interference, out, stats);
        };
        let (inverse, count) = (1.0 / length, interference.len());
        let mut approaches = [0.0; BLOCK];
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (approach, &delta) in approaches.iter_mut().zip(interference) {
                    *approach = (delta + thickness) * inverse;
                }
                emd.noncontact_block(&mut approaches[..count], &mut out.adhesion, stats);
                out.adhesion[..count].iter_mut().for_each(|adhesion| *adhesion *= force);
                out.contact[..count].fill(0.0);
                out.area[..count].fill(0.0);
            },
        );
    }
}

/// A shipped scene with some of its text replaced.
fn changed(name: &str, changes: &[(&str, &str)]) -> Scene {
    let text = changes.iter().fold(text(name), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from} in {name}");
        text.replace(from, to)
    });
    Scene::parse(&text).expect("a valid scene")
}

fn scenes() -> Vec<(&'static str, Scene)> {
    vec![
        ("case I", scene("case_i")),
        ("case II", scene("case_ii")),
        ("case III", scene("case_iii")),
        (
            "II, dry",
            changed("case_ii", &[("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"0 nm\"")]),
        ),
        ("III, emd", changed("case_iii", &[("\"hybrid\"", "\"emd\"")])),
        ("II, h* 6 to 12", changed("case_ii", &[("from = 0.7, to = 8.0", "from = 6.0, to = 12.0")])),
        ("II, 25 GPa hard", changed("case_ii", &[("\"2.5 GPa\"", "\"25 GPa\"")])),
    ]
}

/// Least seconds of a replica under each of two laws, in alternating runs, each law first in every other
/// round.
fn compare(scene: &Scene, laws: [&dyn Law; 2]) -> [f64; 2] {
    let jobs = laws.map(|law| job(scene, law, 1));
    let mut workspaces = jobs.each_ref().map(Workspace::new);
    let mut least = [f64::INFINITY; 2];
    for round in 0..RUNS {
        for i in [round % 2, 1 - round % 2] {
            let seconds = seconds(|| workspaces[i].replicas(&jobs[i], 0..1, |_, _| ()));
            least[i] = least[i].min(seconds);
        }
    }
    least
}

fn main() {
    // Without it, as in `cargo test --benches`, it is enough that this compiles.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    println!("one replica, ms     {:16} {:>9} {:>9} {:>8}", "scene", "with", "without", "ratio");
    let scenes = scenes();
    for skip in ["nothing", "series", "constant", "touches", "unreached"] {
        for (name, scene) in &scenes {
            let law = scene.law().expect("a law of the scene");
            let law = law.typical.as_ref();
            let whole = Hidden::nothing(law);
            let hidden = match skip {
                "nothing" => Hidden::nothing(law),
                "series" => Hidden::series(law, scene),
                "constant" => Hidden::constant(law),
                "touches" => Hidden::touches(law),
                _ => Hidden::unreached(law, scene),
            };
            let [with, without] = compare(scene, [&whole, &hidden]);
            println!("{skip:19} {name:16} {:9.3} {:9.3} {:8.3}", 1e3 * with, 1e3 * without, without / with);
        }
    }
}
