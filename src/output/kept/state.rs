//! The state of a run whose result is partial, which its file holds besides the datasets of the result.
//!
//! The group `restart` of such a file has a [`Head`] in `run` and a [`State`] for each point of which it has
//! replicas, in `0001` and so on: bytes of the Postcard format, and behind them their CRC-32 checksum,
//! little-endian. They are for the version of the program that wrote them.

use super::identity::Identity;
use crate::engine::ReductionTree;
use crate::experiment::Functionals;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// The group of the state in a file, and the dataset of its head.
pub const GROUP: &str = "restart";
/// The head.
pub const RESTART: &str = "/restart/run";
/// Bytes of a checksum.
const CHECKSUM: usize = 4;

/// The head of a partial result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// The run; for a sweep the run of all points.
    pub identity: Identity,
    /// The file of its scene, where a shard was computed.
    pub scene_file: String,
    /// The points of which there are states, by their index; 0 without a sweep.
    pub points: Vec<u64>,
}

/// The state of the replicas that are there of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The functionals of its ensemble.
    pub functionals: Functionals,
    /// Seconds that the replicas took.
    pub seconds: f64,
    /// The number of times that the run has been resumed.
    pub resumptions: u64,
    /// The sums, and the numbers of every replica.
    pub tree: ReductionTree,
}

/// The state that the file of a partial result holds.
pub(in crate::output) struct Restart {
    pub head: Head,
    /// The bytes of the state.
    pub state: Vec<u8>,
}

/// The bytes of a value.
pub fn encode(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = postcard::to_extend(value, Vec::new()).expect("lists know their lengths");
    let checksum = crc32fast::hash(&bytes).to_le_bytes();
    bytes.extend(checksum);
    bytes
}

/// The value of some bytes.
///
/// # Errors
/// The damage to them.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (bytes, checksum) = bytes.split_last_chunk::<CHECKSUM>().ok_or("is truncated")?;
    if crc32fast::hash(bytes).to_le_bytes() != *checksum {
        return Err("is damaged: its checksum is wrong".to_owned());
    }
    match postcard::take_from_bytes(bytes) {
        Ok((value, [])) => Ok(value),
        Ok(_) => Err("is damaged: it is too long".to_owned()),
        Err(error) => Err(format!("is damaged, or of another version of stiction: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Shard;

    fn head(shard: Option<Shard>) -> Head {
        let text = |text: &str| text.to_owned();
        let identity = Identity {
            program_version: text("0.1.0"),
            source_hash: text("abc"),
            scene: text("format = 1\ntitle = \"\"\n"),
            inputs: Vec::new(),
            seed: 1,
            replicas: 800,
            shard,
        };
        Head { identity, scene_file: text("scene.toml"), points: vec![0] }
    }

    /// CRC-32 finds every change of up to 32 neighbouring bits.
    #[test]
    fn every_flipped_bit_and_every_truncation_is_found() {
        let bytes = encode(&head(None));
        assert_eq!(decode(&bytes), Ok(head(None)));
        for place in 0..bytes.len() {
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[place] ^= 1 << bit;
                assert!(decode::<Head>(&flipped).is_err(), "{place} {bit}");
            }
            assert!(decode::<Head>(&bytes[..place]).is_err(), "{place}");
        }
        assert!(decode::<Head>(&[bytes.as_slice(), &[0]].concat()).is_err());
    }

    /// A list that is forged to be longer than there are bytes, with a checksum that fits.
    #[test]
    fn a_length_is_not_allocated_before_it_is_there() {
        let forged = encode(&(head(None).identity, String::new(), 1_u64 << 60));
        assert!(decode::<Head>(&forged).unwrap_err().starts_with("is damaged"));
    }

    /// A head that is forged to claim more shards than there can be, with a checksum that fits.
    #[test]
    fn more_shards_than_there_can_be_are_refused() {
        let read = |count: u64| decode::<Head>(&encode(&head(Some(Shard { index: 1, count }))));
        assert!(read(1000).is_ok());
        for count in [0, 1_000_001, 1_000_000_000, u64::MAX] {
            assert!(read(count).unwrap_err().contains("is damaged"), "{count}");
        }
    }
}
