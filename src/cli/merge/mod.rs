//! `stiction merge`: the shards of a run put together into the result of one run of all.

mod whole;

use super::points::Points;
use super::progress::Progress;
use super::rows::row;
use super::run::laws_of;
use super::session::{Session, override_ensemble};
use super::summary::summary;
use super::{Failure, MergeArguments, files_of, print_of, sweep};
use crate::engine::ReductionTree;
use crate::experiment::Phases;
use crate::experiment::checkpoint::{OverwritePolicy, Run, beginning, read_records};
use crate::experiment::prepared::{PreparedRun, Task, write};
use crate::experiment::results::{Partial, Results, RunMetadata};
use crate::output::OutputLock;
use crate::output::partial::{Kept, Visit};
use crate::output::schema::SWEEP;
use crate::scene::{Document, Scene};
use std::sync::atomic::Ordering;
use std::time::Duration;
use whole::{Place, WholeRun};

pub(super) fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    let MergeArguments { shards, output, partial, scene, .. } = arguments;
    let session = Session::new(&arguments.execution, Duration::MAX)?;
    let run = WholeRun::new(shards, *partial, scene.as_deref())?;
    let lock = OutputLock::new(output, &[&shards[..], &files_of(&run.source, &run.document.scene)].concat())?;
    let policy = OverwritePolicy { resume: false, force: arguments.execution.force };
    lock.check(policy.force)?;
    let merge = Merge { run: &run, session: &session };
    let text = match &run.document {
        Document { scene, sweep: None } => {
            let task = Task { output, lock: &lock, policy, shard: None, is_read_back: false };
            let mut scene = scene.clone();
            override_ensemble(&mut scene, Some(run.identity.replicas), Some(run.identity.seed))?;
            beginning(&lock, Run { scene: &scene, shard: None }, policy)?;
            summary(merge.point(scene, &run.places[0], &task, Progress::new(session.quiet))?.as_ref(), output)
        }
        Document { sweep: Some(sweep), .. } => merge.several(&Points {
            sweep,
            source: &run.source,
            lock: &lock,
            policy,
            replicas: Some(run.identity.replicas),
            seed: Some(run.identity.seed),
            shard: None,
        })?,
    };
    print_of(output, &(text + &missing(&run.missing)))
}

/// What is not there of a run.
fn missing(missing: &[String]) -> String {
    let label = |i: usize| if i == 0 { "incomplete" } else { "" };
    missing.iter().enumerate().map(|(i, what)| row(label(i), what)).collect()
}

/// Shards on their way into one result.
struct Merge<'a> {
    run: &'a WholeRun,
    session: &'a Session,
}

impl Merge<'_> {
    /// Merges the points of a sweep, each by itself, and then all into one file.
    fn several(&self, points: &Points<'_>) -> Result<String, Failure> {
        points.begin(&SWEEP, &self.run.identity)?;
        let merged = self
            .each_point(points)
            .and_then(|()| {
                sweep::assemble(points, &self.run.identity, self.session, !self.run.missing.is_empty())
            })
            .map_err(Failure::not_kept);
        // What has been merged can be merged again.
        let cleared = points.clear();
        let table = merged?;
        cleared.map(|()| table)
    }

    fn each_point(&self, points: &Points<'_>) -> Result<(), Failure> {
        for (point, places) in self.run.places.iter().enumerate().filter(|(_, places)| !places.is_empty()) {
            let output = points.file(point);
            let lock = OutputLock::within(output.clone())?;
            let policy = OverwritePolicy { resume: false, force: false };
            let task = Task { output: &output, lock: &lock, policy, shard: None, is_read_back: true };
            let name = format!("point {} of {}", point + 1, points.sweep.count());
            let progress = Progress::of_run(self.session.quiet, name);
            let merged = self.point(points.scene(point)?, places, &task, progress);
            merged.map_err(|failure| points.at(point, failure))?;
        }
        Ok(())
    }

    /// Merges the pieces of one scene and writes its result.
    fn point(
        &self,
        scene: Scene,
        places: &[Place],
        task: &Task<'_>,
        mut progress: Progress,
    ) -> Result<Box<Results>, Failure> {
        let mut phases = Phases::new(&mut progress);
        // No surfaces but a few on trial.
        let laws = laws_of(&scene, scene.replicas, (&self.run.source, task), 1)?;
        let of = scene.replicas;
        let Some(first) = places.first() else {
            return Err(Failure::Usage(format!("{}: no replicas are there", self.run.source.display())));
        };
        let functionals = self.run.kept(*first, &scene)?.partial.functionals;
        let ground = PreparedRun::new(scene, laws, Some(functionals.clone()), self.session, &mut phases);
        let setup = ground.sampling();
        let job = setup.job();
        phases.replicas("ensemble", 0, of);
        let mut merged = ReductionTree::of(&job);
        let (mut metadata, mut records, mut there) = (RunMetadata::default(), Vec::new(), Vec::new());
        for place in places {
            self.goes_on(merged.replicas.len() as u64, of)?;
            let mut kept = self.run.kept(*place, &ground.scene)?;
            if kept.partial.functionals != functionals {
                let problem = "has other functionals of the joint test than the shards before it";
                return Err(kept.records.refused(problem).into());
            }
            read_records(&ground.scene, &mut kept)?;
            let Kept { partial, records: own } = kept;
            there.extend(partial.extent().0);
            let tree = partial.tree.restored(&job).filter(ReductionTree::is_complete);
            let tree = tree.ok_or_else(|| own.refused("is not of this scene"))?;
            phases.advance(tree.replicas.len() as u64);
            merged.append(tree);
            records.push(own);
            metadata.seconds_before += partial.seconds;
            metadata.resumptions += partial.resumptions;
        }
        metadata.partial = (there.len() as u64 != of).then_some(Partial { replicas: there, of });
        let summation = setup.summation(&self.session.pool);
        let results = ground.results(merged, summation, metadata, self.session, &mut phases);
        phases.phase("writing");
        let mut all = |visit: &mut Visit<'_>| {
            for records in &records {
                if !records.each(visit)? {
                    return Ok(false);
                }
            }
            Ok(true)
        };
        let written = write(task, &results, &mut all, &self.session.stop);
        phases.end();
        match written {
            Ok(true) => Ok(Box::new(results)),
            Ok(false) => Err(Failure::Interrupted { done: of, of, kept: false }),
            Err(error) => Err(Failure::not_written(error, task.output)),
        }
    }

    fn goes_on(&self, done: u64, of: u64) -> Result<(), Failure> {
        let stopped = self.session.stop.load(Ordering::Relaxed);
        if stopped { Err(Failure::Interrupted { done, of, kept: false }) } else { Ok(()) }
    }
}
