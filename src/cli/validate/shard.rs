//! A shard: the checkpoint of each of its pieces, which has a checksum of itself and of the records.

use super::super::Failure;
use super::checked::Checked;
use super::{Answer, heading};
use crate::experiment::checkpoint::State;
use crate::output::checkpoint::{Checkpoint, Identity};
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::output::shard::ShardFile;
use crate::validation::Verdict;

pub(super) fn validate(reader: &Reader) -> Result<Answer, Failure> {
    let shard = ShardFile::open(reader.path())?;
    let mut checked = Checked::new(reader, 0);
    checked.bounds()?;
    let indices: Vec<f64> =
        shard.pieces.iter().flat_map(|piece| piece.replicas.clone()).map(|i| i as f64).collect();
    checked.follows("/record", &indices, 0.0, "/pieces")?;
    for piece in 0..shard.pieces.len() {
        checked.piece(&shard, piece)?;
    }
    let (pieces, replicas) = (shard.pieces.len(), indices.len());
    let text = heading(reader) + &format!("a shard of {replicas} replicas in {pieces} pieces\n");
    Ok(Answer { text, findings: checked.findings, verdict: Verdict::NotTested })
}

impl Checked<'_> {
    /// What is said of a piece is what its checkpoint says, and its records are those that it counts.
    fn piece(&mut self, shard: &ShardFile, index: usize) -> Result<(), Failure> {
        let piece = &shard.pieces[index];
        let checkpoint = match Checkpoint::<State>::decode(&shard.state(index)?) {
            Ok(checkpoint) => checkpoint,
            Err(problem) => {
                self.say("/state", &format!("of piece {index} {problem}"));
                return Ok(());
            }
        };
        // Of a sweep every point has a scene and a seed of its own.
        let own = shard.identity()?;
        let told = Identity { scene: own.scene.clone(), seed: own.seed, ..checkpoint.identity.clone() };
        if told != own {
            self.say("/state", &format!("of piece {index} is of another run than the file says"));
        }
        let of = checkpoint.state.replicas(checkpoint.identity.replicas);
        let whole = |value: u64| value as f64;
        for (name, found, expected) in [
            ("first_replica", whole(piece.replicas.start), whole(of.start)),
            ("end_replica", whole(piece.replicas.end), whole(of.end)),
            ("resumptions", whole(piece.resumptions), whole(checkpoint.resumptions)),
            ("seconds", piece.seconds, checkpoint.seconds),
        ] {
            if found != expected {
                let path = format!("/pieces/{name}");
                self.say_at(&path, index, found, &format!("{expected:e} is in the state of the piece"));
            }
        }
        let length = self.reader.length(Dimension::RecordWord)?;
        let checksum = shard.records(index, length, &mut |_| Ok(true))?;
        if checksum != Some(checkpoint.records_checksum) {
            self.say("/records", &format!("of piece {index} are not those of its checksum"));
        }
        Ok(())
    }
}
