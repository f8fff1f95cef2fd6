//! Identity of the run that a file is of, and how two runs differ.

use crate::engine::Shard;
use crate::scene;
use crate::scene::echo::shortened;
use crate::scene::{Input, Scene, differing};
use serde::{Deserialize, Serialize};

/// The identity of a run: all that the bits of its result depend on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program.
    pub program_version: String,
    /// Hash of the source that it was built from.
    pub source_hash: String,
    /// Text of the scene.
    pub scene: String,
    /// The files that the scene has taken values from.
    pub inputs: Vec<Input>,
    /// Seed.
    pub seed: u64,
    /// Number of replicas.
    pub replicas: u64,
    /// The shard that it is of the run, if not all of it.
    pub shard: Option<Shard>,
}

impl Identity {
    /// The identity of a run of a scene, or of a shard of it, by this program.
    pub fn new(scene: &Scene, shard: Option<Shard>) -> Self {
        Self {
            shard,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            source_hash: env!("STICTION_SOURCE_HASH").to_owned(),
            scene: scene.text.clone(),
            inputs: scene.inputs.clone(),
            seed: scene.seed,
            replicas: scene.replicas,
        }
    }

    /// Whether it is the same run as another, whatever its title and comments.
    pub fn is_of(&self, other: &Self) -> bool {
        self.difference("", ("", ""), other).is_none()
    }

    /// The difference of this run from `kept`, the run of `whose`; none when they are one run. `verbs` say
    /// when each is what it is.
    pub fn difference(&self, whose: &str, verbs: (&str, &str), kept: &Self) -> Option<String> {
        let is = |what: &str, kept: &dyn std::fmt::Display, own: &dyn std::fmt::Display| {
            Some(format!("{what} of {whose} {} {kept}, and {} {own}", verbs.0, verbs.1))
        };
        if self.program_version != kept.program_version {
            return is("the version of stiction", &kept.program_version, &self.program_version);
        }
        if self.source_hash != kept.source_hash {
            return is("the source of stiction", &kept.source_hash, &self.source_hash);
        }
        if self.seed != kept.seed {
            return is("the seed", &kept.seed, &self.seed);
        }
        if self.replicas != kept.replicas {
            return is("the number of replicas", &kept.replicas, &self.replicas);
        }
        if let Some((key, kept, own)) = scene::difference(&kept.scene, &self.scene) {
            return is(&format!("`{}`", shortened(&key)), &shortened(&kept), &shortened(&own));
        }
        if let Some((path, kept, own)) = differing(&kept.inputs, &self.inputs) {
            return is(&format!("`{}`", shortened(&path)), &kept, &own);
        }
        let shard = |shard: Option<Shard>| shard.map_or("none".to_owned(), |shard| shard.to_string());
        if self.shard != kept.shard {
            return is("the shard", &shard(kept.shard), &shard(self.shard));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(checksum: u32) -> Input {
        Input { path: "a.csv".to_owned(), values: 3, checksum }
    }

    fn identity() -> Identity {
        let text = |text: &str| text.to_owned();
        let scene = text("format = 1\ntitle = \"\"\n");
        Identity {
            program_version: text("0.1.0"),
            source_hash: text("abc"),
            scene,
            inputs: vec![input(7)],
            seed: 1,
            replicas: 800,
            shard: None,
        }
    }

    /// Every part of an identity counts, and the difference names it.
    #[test]
    fn another_run_is_named_by_its_difference() {
        let kept = identity();
        let difference = |own: &Identity| own.difference("the interrupted run", ("was", "is now"), &kept);
        assert_eq!(difference(&identity()), None);
        let renamed = Identity { scene: "# Another title\nformat = 1\ntitle = \"a\"".into(), ..identity() };
        assert_eq!(difference(&renamed), None);
        let others = [
            (Identity { program_version: "0.2.0".into(), ..identity() }, "version of stiction"),
            (Identity { source_hash: "def".into(), ..identity() }, "source of stiction"),
            (
                Identity { scene: "format = 2\n".into(), ..identity() },
                "`format` of the interrupted run was 1, and is now 2",
            ),
            (Identity { scene: "seed = 1\nformat = 1\n".into(), ..identity() }, "`seed`"),
            (
                Identity { inputs: vec![input(8)], ..identity() },
                "`a.csv` of the interrupted run was 3 values, CRC-32 00000007, and is now 3 values, CRC-32 \
                 00000008",
            ),
            (Identity { inputs: vec![], ..identity() }, "00000007, and is now none"),
            (Identity { inputs: vec![input(7), input(7)], ..identity() }, "was none, and is now 3 values"),
            (Identity { seed: 2, ..identity() }, "seed of the interrupted run was 1, and is now 2"),
            (
                Identity { shard: "3/16".parse().ok(), ..identity() },
                "shard of the interrupted run was none, and is now 3/16",
            ),
            (Identity { replicas: 8, ..identity() }, "replicas of the interrupted run was 800, and is now 8"),
        ];
        for (own, named) in others {
            let difference = difference(&own).unwrap();
            assert!(difference.contains(named), "{difference}");
        }
    }
}
