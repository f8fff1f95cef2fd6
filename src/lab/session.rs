//! A scene that is computed in pieces, here or in other instances, and merged in order.

use super::failure::Failure;
use super::scenes::Text;
use crate::asperity::{PlasticContact, Quantity};
use crate::engine::{Job, Piece, Pieces, ReductionTree, Summation, Workspace};
use crate::error::Error;
use crate::estimate::Estimate;
use crate::experiment::ensemble::Sampling;
use crate::experiment::model_range::{ByContact, others};
use crate::experiment::snaps::Snaps;
use crate::experiment::{Phases, PreparedRun, SceneLaws, Workers};
use crate::format::bytes;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::Arc;

/// Most memory, bytes, of a scene that is taken: pages of browsers have 4 GB at most.
const MOST_MEMORY: f64 = 2e9;

/// Replicas that are asked for, of the run itself or by another plastic contact.
#[derive(Deserialize)]
pub(super) struct Asked {
    /// The name of the contact; none for the run itself.
    #[serde(default)]
    contact: Option<String>,
    /// The number of replicas of the contact.
    #[serde(default)]
    replicas: u64,
    first: u64,
    count: u64,
}

/// A piece on its way from one instance to another.
#[derive(Serialize, Deserialize)]
pub(super) struct Sent {
    /// The scene that it is of.
    scene: u32,
    contact: Option<String>,
    of: u64,
    pub piece: Piece,
}

impl Sent {
    /// What the page draws of it at once: the pull-offs of its replicas, and their curves of the external force.
    pub fn head(&self, session: &Session) -> Value {
        let replicas = self.piece.replicas.iter();
        let numbers: Vec<f64> = replicas.clone().flat_map(|(_, curves)| curves.snaps.clone()).collect();
        let snaps = Snaps::of_numbers(&session.scene, &numbers);
        let turns = snaps.loading.preload.iter().zip(snaps.places_of_turns());
        let turns: Vec<Vec<f64>> = turns.map(|(_, turn)| snaps.every_pull_off(turn)).collect();
        let after =
            (0..self.piece.replicas.len()).map(|i| turns.iter().map(|turn| turn[i]).collect::<Vec<f64>>());
        let force = replicas.clone().map(|(_, curves)| &curves.total[Quantity::ExternalForce.index()]);
        json!({
            "contact": self.contact, "first": self.piece.first, "count": self.piece.replicas.len(),
            "pull_off": replicas.clone().map(|(replica, _)| replica.pull_off_force).collect::<Vec<f64>>(),
            "after_preload": after.collect::<Vec<_>>(), "force": force.collect::<Vec<_>>(),
        })
    }
}

/// A scene that is computed.
pub(super) struct Session {
    /// Checksum of the text of the scene, by which pieces of another one are known.
    checksum: u32,
    pub scene: Scene,
    pub run: Part,
    /// The parts of the model range, in the order of the contacts.
    pub range: Vec<Part>,
}

/// Replicas by one contact, and what has been merged of them.
pub(super) struct Part {
    pub contact: Option<PlasticContact>,
    pub replicas: u64,
    source: Source,
    workspace: Option<Workspace>,
    summation: Option<Arc<Summation>>,
    pub tree: Option<ReductionTree>,
    pieces: Pieces,
    /// Whether all replicas are merged, or the targets are met.
    pub is_complete: bool,
}

/// The ground on which replicas are computed.
enum Source {
    /// The run before its integral is known.
    Laws(Box<(Scene, SceneLaws)>),
    Run(Box<PreparedRun>),
    /// None where the contact has no law.
    Contact(Option<Box<ByContact>>),
    /// On the way from one to the other.
    Between,
}

impl Source {
    fn sampling(&self) -> Result<Sampling<'_>, Failure> {
        match self {
            Self::Laws(own) => Ok(own.1.sampling(&own.0)),
            Self::Run(run) => Ok(run.sampling()),
            Self::Contact(Some(own)) => Ok(own.sampling()),
            Self::Contact(None) | Self::Between => Err(Failure::new("the contact has no law here")),
        }
    }
}

impl Session {
    /// Makes the laws of a scene.
    ///
    /// # Errors
    /// All that is wrong with the scene, and what a browser cannot compute.
    pub fn new(text: Text) -> Result<Self, Failure> {
        // Curves are kept for files, and there is none.
        let scene = Scene { curves: false, ..text.scene()? };
        if scene.replicas == 0 {
            let problem =
                "`ensemble.replicas` = 0 asks for the integral alone; a page of replicas needs some";
            return Err(Failure::new(problem));
        }
        let laws = SceneLaws::new(&scene)?;
        let memory = Estimate::new(&scene, laws.law.view(), 1).memory();
        if memory > MOST_MEMORY {
            let [memory, most] = [memory, MOST_MEMORY].map(bytes);
            return Err(Failure::new(format!(
                "the run would take about {memory} of memory, and a page takes {most} at most; `stiction run` computes it"
            )));
        }
        let source = Source::Laws(Box::new((scene.clone(), laws)));
        let checksum = crc32fast::hash(scene.text.as_bytes());
        let run = Part::new(None, scene.replicas, source);
        Ok(Self { checksum, scene, run, range: Vec::new() })
    }

    /// Computes some replicas.
    ///
    /// # Errors
    /// Replicas that the scene does not have.
    pub fn compute(
        &mut self,
        Asked { contact, replicas, first, count }: Asked,
        workers: &Workers,
    ) -> Result<Sent, Failure> {
        let group = self.scene.sampling.group();
        // The scatter by the integral is the measure of how well pull-offs of coupled asperities are sought.
        if self.scene.substrate.is_some() {
            self.prepared(workers)?;
        }
        let part = self.part(contact.as_deref(), replicas)?;
        let end = first.checked_add(count).filter(|end| *end <= part.replicas && count > 0);
        let end = end.ok_or_else(|| Failure::new(format!("there are {} replicas only", part.replicas)))?;
        if !first.is_multiple_of(group) || !(end - first).is_multiple_of(group) {
            return Err(Failure::new(format!("replicas come in groups of {group}")));
        }
        let of = part.replicas;
        let piece = part.compute(first..end, workers)?;
        Ok(Sent { scene: self.checksum, contact, of, piece })
    }

    /// The part of a contact, whose laws are made when it is first asked for.
    fn part(&mut self, contact: Option<&str>, replicas: u64) -> Result<&mut Part, Failure> {
        let Some(name) = contact else { return Ok(&mut self.run) };
        let found = PlasticContact::ALL.into_iter().find(|(own, _)| *own == name);
        let (_, contact) =
            found.ok_or_else(|| Failure::new(format!("there is no plastic contact {name:?}")))?;
        let is_own = |part: &Part| part.contact == Some(contact) && part.replicas == replicas;
        if let Some(place) = self.range.iter().position(is_own) {
            return Ok(&mut self.range[place]);
        }
        if replicas == 0 || replicas > self.scene.replicas {
            return Err(Failure::new(format!("the model range has no {replicas} replicas")));
        }
        let source = Source::Contact(ByContact::new(&self.scene, contact, replicas).map(Box::new));
        self.range.retain(|part| part.contact != Some(contact));
        self.range.push(Part::new(Some(contact), replicas, source));
        Ok(self.range.last_mut().expect("it was put there"))
    }

    /// Adds a piece that was computed here or elsewhere.
    ///
    /// # Errors
    /// A piece of another scene.
    pub fn merge(&mut self, sent: Sent, workers: &Workers) -> Result<(), Failure> {
        let other = || Failure::new("the piece is of another scene");
        if sent.scene != self.checksum {
            return Err(other());
        }
        let part = self.part(sent.contact.as_deref(), sent.of)?;
        if part.is_complete {
            return Ok(());
        }
        if !sent.piece.is_of(&part.source.sampling()?.job()) {
            return Err(other());
        }
        part.pieces.add(sent.piece);
        part.advance(workers)
    }

    /// The run with its integral, which is computed when it is first asked for.
    pub fn prepared(&mut self, workers: &Workers) -> Result<&PreparedRun, Failure> {
        let Part { source, .. } = &mut self.run;
        if let Source::Laws(_) = source
            && let Source::Laws(own) = std::mem::replace(source, Source::Between)
        {
            let mut nobody = ();
            let mut phases = Phases::new(&mut nobody);
            let (scene, laws) = *own;
            let run = PreparedRun::new(scene, laws, None, workers, &mut phases);
            let interrupted = Error::Interrupted { done: 0, of: self.scene.replicas, kept: false };
            *source = Source::Run(Box::new(run.ok_or(interrupted)?));
            self.run.advance(workers)?;
        }
        match &self.run.source {
            Source::Run(run) => Ok(run),
            _ => Err(Failure::new("the integral was interrupted; prepare the scene again")),
        }
    }

    /// The parts that there are to compute, by their contacts and numbers of replicas: the run itself and, once its number of
    /// replicas is known and contacts yield, its model range.
    pub fn parts(&self) -> Vec<(Option<PlasticContact>, u64)> {
        let own = (None, self.run.replicas);
        let merged = self.run.tree.as_ref().map_or(0, |tree| tree.replicas.len() as u64);
        let replicas = match self.scene.stopping {
            None => Some(self.scene.replicas),
            Some(_) => self.run.is_complete.then_some(merged),
        };
        let yields = matches!(&self.run.source, Source::Run(run) if run.yields);
        let range = replicas.filter(|_| yields).and_then(|replicas| others(&self.scene, replicas));
        let others =
            range.map(|(contacts, replicas)| contacts.into_iter().map(move |own| (Some(own), replicas)));
        [own].into_iter().chain(others.into_iter().flatten()).collect()
    }
}

impl Part {
    fn new(contact: Option<PlasticContact>, replicas: u64, source: Source) -> Self {
        Self {
            contact,
            replicas,
            source,
            workspace: None,
            summation: None,
            tree: None,
            pieces: Pieces::default(),
            is_complete: false,
        }
    }

    /// The scene, and the sums of what is merged.
    pub fn sampling(&self) -> Result<Sampling<'_>, Failure> {
        self.source.sampling()
    }

    /// The way in which surfaces are summed, which is tried when it is first asked for.
    pub fn summation(&mut self, workers: &Workers) -> Result<Arc<Summation>, Failure> {
        if let Some(known) = &self.summation {
            return Ok(Arc::clone(known));
        }
        let tried = Arc::new(self.source.sampling()?.summation(&workers.pool));
        Ok(Arc::clone(self.summation.insert(tried)))
    }

    fn compute(&mut self, indices: std::ops::Range<u64>, workers: &Workers) -> Result<Piece, Failure> {
        let summation = self.summation(workers)?;
        let sampling = self.source.sampling()?;
        let job = Job { moments: summation.matrix.as_ref(), ..sampling.job() };
        let workspace = self.workspace.get_or_insert_with(|| Workspace::new(&job));
        Ok(workers.pool.install(|| Piece::compute(&job, workspace, indices)))
    }

    /// Merges the batches that are there in order, as soon as it is known what is kept of them.
    fn advance(&mut self, workers: &Workers) -> Result<(), Failure> {
        if let Source::Laws(_) = self.source {
            return Ok(());
        }
        let summation = self.summation(workers)?;
        let sampling = self.source.sampling()?;
        let job = Job { moments: summation.matrix.as_ref(), ..sampling.job() };
        let tree = self.tree.get_or_insert_with(|| ReductionTree::of(&job));
        while !self.is_complete
            && let Some(batch) = self.pieces.batch(&job, tree.next())
        {
            tree.push(&batch);
            self.is_complete =
                tree.is_complete() || sampling.rule.is_some_and(|rule| rule.is_met(&job, tree));
        }
        Ok(())
    }
}
