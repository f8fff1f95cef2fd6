//! Whether shards make up a run: what is missing, doubled, unfinished or of another run.

use super::identity::Identity;
use super::lock::{PARTIAL, beside};
use super::partial::{PartialFile, Piece};
use crate::engine::Shard;
use crate::error::Error;
use crate::format::replicas as shown;
use crate::input::columns::SceneFiles;
use crate::input::scene_file::LONGEST_SCENE;
use crate::scene::{Document, Sweep};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A piece of a shard, by the indices of both.
pub(crate) type Place = (usize, usize);

/// A run whose shards fit together.
pub(crate) struct ShardSet {
    /// The identity of the whole run.
    pub identity: Identity,
    /// The file of the scene.
    pub source: PathBuf,
    pub document: Document,
    pub shards: Vec<PartialFile>,
    /// Places of the pieces of each point, in the order of their replicas.
    pub places: Vec<Vec<Place>>,
    /// A line for each thing that is not there.
    pub missing: Vec<String>,
}

/// The reason why a path is no shard.
enum Not {
    /// The shard is not complete.
    Unfinished(String),
    /// The path is none.
    Shard(String),
}

impl ShardSet {
    /// The run that the shards of some paths are of; its scene is in the file `scene`, or in the one that
    /// they say.
    ///
    /// # Errors
    /// [`Error::NotOneRun`] with what does not fit together, and, unless the run may be `partial`,
    /// [`Error::Incomplete`] with what is missing.
    pub fn new(paths: &[PathBuf], partial: bool, scene: Option<&Path>) -> Result<Self, Error> {
        let (mut shards, mut problems, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for path in paths {
            match found(path) {
                Ok(found) => shards.push(found),
                Err(Not::Unfinished(what)) => missing.push(what),
                Err(Not::Shard(what)) => problems.push(what),
            }
        }
        problems.extend(differences(&shards));
        let fit =
            |problems: Vec<String>, missing: Vec<String>| Error::NotOneRun([problems, missing].concat());
        let Some(first) = shards.first().filter(|_| problems.is_empty()) else {
            return Err(fit(problems, missing));
        };
        let identity = Identity { shard: None, ..first.head.identity.clone() };
        let source = scene.unwrap_or(Path::new(&first.head.scene_file)).to_owned();
        let document = document(&identity, &source)?;
        let points = document.sweep.as_ref().map_or(1, Sweep::count);
        let Coverage { places, doubled, gaps } = coverage(&shards, points, identity.replicas);
        if !doubled.is_empty() {
            return Err(fit(doubled, missing));
        }
        missing.extend(absent(&shards, gaps));
        if !missing.is_empty() && !partial {
            return Err(Error::Incomplete(missing));
        }
        Ok(Self { identity, source, document, shards, places, missing })
    }

    /// A piece, and the shard that it is of.
    pub fn at(&self, (shard, piece): Place) -> (&PartialFile, &Piece) {
        (&self.shards[shard], &self.shards[shard].pieces[piece])
    }
}

fn found(path: &Path) -> Result<PartialFile, Not> {
    let partial = beside(path, PARTIAL);
    let is_there = path.exists();
    let found = match is_there {
        true => PartialFile::open(path),
        false if partial.exists() => PartialFile::open(&partial),
        false if beside(path, ".points").is_dir() => {
            return Err(Not::Unfinished(format!("{}: not finished", path.display())));
        }
        false => return Err(Not::Shard(format!("{}: is not there", path.display()))),
    };
    let found = found.map_err(|error| Not::Shard(error.to_string()))?;
    if is_there && found.is_complete() && found.head.identity.shard.is_some() {
        return Ok(found);
    }
    let done: u64 = found.pieces.iter().map(|piece| piece.done).sum();
    let shard = found.head.identity.shard.map(|shard| format!(", shard {shard}")).unwrap_or_default();
    let problem = format!("{}{shard}: not finished, {done} of its replicas are done", path.display());
    Err(Not::Unfinished(problem))
}

/// Differences of shards of another run than the first.
fn differences(shards: &[PartialFile]) -> Vec<String> {
    let Some(first) = shards.first() else { return Vec::new() };
    let name = first.path.display().to_string();
    let difference = |shard: &PartialFile| {
        let own = Identity { shard: first.head.identity.shard, ..shard.head.identity.clone() };
        let difference = own.difference(&name, ("is", "here"), &first.head.identity)?;
        Some(format!("{}: is of another run: {difference}", shard.path.display()))
    };
    shards[1..].iter().filter_map(difference).collect()
}

/// The scene of a run, which takes values from the files that it took them from before.
fn document(identity: &Identity, source: &Path) -> Result<Document, Error> {
    let failed = |problem: String| Error::SceneOfShards { path: source.to_owned(), problem };
    if identity.scene.len() as u64 > LONGEST_SCENE {
        return Err(failed("is too long for a scene".to_owned()));
    }
    let document = Document::parse(&identity.scene, Arc::new(SceneFiles::scene(source)));
    let document = document.map_err(|error| failed(error.to_string()))?;
    if document.scene.inputs == identity.inputs {
        return Ok(document);
    }
    let paths: Vec<&str> = document.scene.inputs.iter().map(|input| input.path.as_str()).collect();
    Err(failed(format!(
        "its files {} do not hold what they held when the shards were computed",
        paths.join(", ")
    )))
}

/// Replicas that are there.
struct Coverage {
    places: Vec<Vec<Place>>,
    doubled: Vec<String>,
    gaps: Vec<String>,
}

fn coverage(shards: &[PartialFile], points: usize, replicas: u64) -> Coverage {
    let mut places: Vec<Vec<Place>> = vec![Vec::new(); points];
    let (mut doubled, mut gaps) = (Vec::new(), Vec::new());
    for (s, shard) in shards.iter().enumerate() {
        for (p, piece) in shard.pieces.iter().enumerate() {
            match places.get_mut(piece.point as usize) {
                Some(places) if piece.replicas.end <= replicas => places.push((s, p)),
                _ => doubled.push(format!("{}: has replicas that its run has not", shard.path.display())),
            }
        }
    }
    for (point, places) in places.iter_mut().enumerate() {
        let own = |(s, p): Place| shards[s].pieces[p].replicas.clone();
        let named = |first: u64, end: u64| {
            let of = if points > 1 { format!(", point {}", point + 1) } else { String::new() };
            format!("replicas {}{of}", shown(&(first..end), replicas))
        };
        places.sort_by_key(|place| (own(*place).start, own(*place).end));
        let mut reached: (u64, Option<Place>) = (0, None);
        for &place in places.iter() {
            let range = own(place);
            if range.start > reached.0 {
                gaps.push(named(reached.0, range.start));
            }
            if let Some(other) = reached.1.filter(|_| range.start < reached.0) {
                let [one, two] = [other, place].map(|(s, _)| shards[s].path.display().to_string());
                doubled.push(format!(
                    "{one} and {two} both have {}",
                    named(range.start, range.end.min(reached.0))
                ));
            }
            if range.end > reached.0 {
                reached = (range.end, Some(place));
            }
        }
        if reached.0 < replicas {
            gaps.push(named(reached.0, replicas));
        }
    }
    Coverage { places, doubled, gaps }
}

/// Names what is missing: shards by their numbers, where all are of the same number of shards, or else
/// replicas.
fn absent(shards: &[PartialFile], gaps: Vec<String>) -> Vec<String> {
    let counts: BTreeSet<u64> =
        shards.iter().filter_map(|found| Some(found.head.identity.shard?.count)).collect();
    let (Some(&count), 1) = (counts.first(), counts.len()) else {
        return gaps.into_iter().map(|gap| format!("missing: {gap}")).collect();
    };
    if gaps.is_empty() {
        return Vec::new();
    }
    let there: BTreeSet<u64> =
        shards.iter().filter_map(|found| Some(found.head.identity.shard?.index)).collect();
    let mut ranges: Vec<(u64, u64)> = Vec::new();
    for index in (1..=count).filter(|index| !there.contains(index)) {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == index => *last = index,
            _ => ranges.push((index, index)),
        }
    }
    let range = |(first, last): &(u64, u64)| match first == last {
        true => format!("missing: shard {}", Shard { index: *first, count }),
        false => {
            format!("missing: shards {} to {}", Shard { index: *first, count }, Shard { index: *last, count })
        }
    };
    let named: Vec<String> = ranges.iter().map(range).collect();
    if named.is_empty() { gaps.into_iter().map(|gap| format!("missing: {gap}")).collect() } else { named }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::kept::Head;

    fn shard(index: u64, count: u64, pieces: &[[u64; 3]]) -> PartialFile {
        let piece = |&[point, start, end]: &[u64; 3]| Piece {
            point,
            replicas: start..end,
            done: end - start,
            seconds: 1.0,
            resumptions: 0,
        };
        let identity = Identity {
            program_version: "1".to_owned(),
            source_hash: "a".to_owned(),
            scene: "format = 1\n".to_owned(),
            inputs: Vec::new(),
            seed: 1,
            replicas: 40,
            shard: Some(Shard { index, count }),
        };
        let path = PathBuf::from(format!("{index}of{count}.h5"));
        let points = pieces.iter().map(|piece| piece[0]).collect();
        let head = Head { identity, scene_file: String::new(), points };
        PartialFile { path, head, pieces: pieces.iter().map(piece).collect() }
    }

    #[test]
    fn pieces_are_put_in_order_whatever_shards_they_are_of() {
        let shards = [shard(3, 4, &[[0, 16, 32]]), shard(1, 2, &[[0, 0, 16]]), shard(4, 4, &[[0, 32, 40]])];
        let Coverage { places, doubled, gaps } = coverage(&shards, 1, 40);
        assert_eq!(places, [[(1, 0), (0, 0), (2, 0)]]);
        assert!(doubled.is_empty() && gaps.is_empty());
        let shards = [shard(2, 2, &[[0, 24, 40], [1, 0, 40]]), shard(1, 2, &[[0, 0, 24]])];
        assert_eq!(coverage(&shards, 2, 40).places, [vec![(1, 0), (0, 0)], vec![(0, 1)]]);
    }

    #[test]
    fn what_is_missing_is_named_by_shards_or_replicas() {
        let own = |index: u64| shard(index, 5, &[[0, 8 * (index - 1), 8 * index]]);
        let missing = |shards: &[PartialFile]| absent(shards, coverage(shards, 1, 40).gaps);
        assert_eq!(missing(&[own(1), own(3)]), ["missing: shard 2/5", "missing: shards 4/5 to 5/5"]);
        assert!(missing(&[own(1), own(2), own(3), own(4), own(5)]).is_empty());
        let mixed = [own(1), shard(2, 2, &[[0, 16, 40]])];
        assert_eq!(missing(&mixed), ["missing: replicas 8 to 15 of 0 to 39"]);
        // More shards than batches: those that are empty are not missed.
        let few = [shard(2, 3, &[[0, 0, 40]]), shard(1, 3, &[])];
        assert!(missing(&few).is_empty());
    }

    #[test]
    fn what_is_there_twice_is_named() {
        let doubled = |shards: &[PartialFile]| coverage(shards, 1, 40).doubled;
        let twice =
            doubled(&[shard(1, 2, &[[0, 0, 24]]), shard(1, 2, &[[0, 0, 24]]), shard(2, 2, &[[0, 24, 40]])]);
        assert_eq!(twice, ["1of2.h5 and 1of2.h5 both have replicas 0 to 23 of 0 to 39"]);
        let overlap = doubled(&[shard(1, 2, &[[0, 0, 24]]), shard(3, 5, &[[0, 16, 40]])]);
        assert_eq!(overlap, ["1of2.h5 and 3of5.h5 both have replicas 16 to 23 of 0 to 39"]);
        assert_eq!(doubled(&[shard(1, 1, &[[0, 0, 48]])]).len(), 1);
        assert_eq!(doubled(&[shard(1, 1, &[[7, 0, 40]])]).len(), 1);
    }

    #[test]
    fn another_run_is_named_by_its_difference() {
        let first = shard(1, 2, &[]);
        let mut other = shard(2, 2, &[]);
        assert!(differences(&[first.clone(), other.clone()]).is_empty());
        other.head.identity.seed = 7;
        assert_eq!(
            differences(&[first, other]),
            ["2of2.h5: is of another run: the seed of 1of2.h5 is 1, and here 7"]
        );
    }
}
