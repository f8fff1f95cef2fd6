//! The layout of a shard of a run.

use super::{Dimension, Layout, Variable, variable};

const P: &[Dimension] = &[Dimension::Piece];

/// A result of `stiction run --shard`, which `stiction merge` puts together with others.
pub static SHARD: Layout = Layout {
    format: "stiction-shard",
    command: "stiction run --shard",
    version: [2, 0],
    groups: &["pieces"],
    optional_groups: &[],
    of_points: None,
    variables: VARIABLES,
};

const VARIABLES: &[Variable] = &[
    variable("/piece", P, "1", "index of the point of a sweep that a piece is of, 0 without a sweep"),
    variable("/pieces/first_replica", P, "1", "index of the first replica of the piece"),
    variable("/pieces/end_replica", P, "1", "index of the last replica of the piece, and one"),
    variable("/pieces/seconds", P, "s", "time that the replicas of the piece took, interruptions left out"),
    variable("/pieces/resumptions", P, "1", "how often the piece was resumed"),
    variable("/pieces/state_bytes", P, "1", "bytes of the state of the piece"),
    variable("/record", &[Dimension::Record], "1", "index of the replica within its point"),
    variable("/record_word", &[Dimension::RecordWord], "1", "word of a record"),
    variable(
        "/records",
        &[Dimension::Record, Dimension::RecordWord],
        "1",
        "what is kept of each replica, 64-bit words",
    ),
    variable(
        "/state_row",
        &[Dimension::StateRow],
        "1",
        "row of the states of all pieces, one after the other",
    ),
    variable("/state_byte", &[Dimension::StateByte], "1", "byte of a row"),
    variable(
        "/state",
        &[Dimension::StateRow, Dimension::StateByte],
        "1",
        "sums of the replicas of each piece, as in a checkpoint",
    ),
];
