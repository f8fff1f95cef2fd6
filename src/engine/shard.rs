//! Shards of a run: fixed ranges of it that are computed by themselves.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Most shards of a run.
const MOST: u64 = 1_000_000;

/// One of a number of shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "[u64; 2]", into = "[u64; 2]")]
pub struct Shard {
    /// Number of the shard, from 1.
    pub index: u64,
    /// The number of shards.
    pub count: u64,
}

impl Shard {
    /// The range that it has of `all` pieces of work, of which all shards have the same number, or one more.
    pub fn range(self, all: u64) -> Range<u64> {
        // In 128 bits nothing overflows, and what comes out is at most `all`.
        let begin = |index: u64| (u128::from(all) * u128::from(index) / u128::from(self.count)) as u64;
        begin(self.index - 1)..begin(self.index)
    }
}

impl TryFrom<[u64; 2]> for Shard {
    type Error = String;

    fn try_from([index, count]: [u64; 2]) -> Result<Self, String> {
        if (1..=MOST).contains(&count) && (1..=count).contains(&index) {
            return Ok(Self { index, count });
        }
        let needed = "which of how many is needed, such as 3/16: a number from 1 to the second one";
        Err(format!("{needed}, which is at most {MOST}"))
    }
}

impl From<Shard> for [u64; 2] {
    fn from(Shard { index, count }: Shard) -> Self {
        [index, count]
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse().unwrap_or(0);
        let (index, count) = text.split_once('/').unwrap_or_default();
        Self::try_from([number(index), number(count)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_work_among_them() {
        for (all, count) in [(100, 16), (5, 8), (0, 3), (12_500_000, 1000), (u64::MAX, 7)] {
            let ranges: Vec<Range<u64>> =
                (1..=count).map(|index| Shard { index, count }.range(all)).collect();
            assert_eq!((ranges[0].start, ranges[ranges.len() - 1].end), (0, all));
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
            let lengths = ranges.iter().map(|range| range.end - range.start);
            assert!(lengths.clone().max().unwrap() - lengths.min().unwrap() <= 1);
        }
    }

    #[test]
    fn shards_are_read_as_they_are_shown() {
        assert_eq!("3/16".parse(), Ok(Shard { index: 3, count: 16 }));
        assert_eq!(Shard { index: 3, count: 16 }.to_string(), "3/16");
        for wrong in [
            "",
            "3",
            "0/4",
            "5/4",
            "1/0",
            "-1/4",
            "1/4/2",
            "a/b",
            "1.5/4",
            " 1/4",
            "1/1000001",
            "1/18446744073709551615",
        ] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
