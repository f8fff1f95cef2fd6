//! Shards of a run in their files: of each point what the shard has of it, a piece, as checkpoints keep it.
//!
//! A piece is the checkpoint of its replicas, which says what run they are of and holds their sums, and the
//! record of each.

use super::OutputError;
use super::checkpoint::{Identity, Visit};
use super::reader::Reader;
use super::schema::{Dimension, SHARD};
use super::writer::Writer;
use crate::engine::Shard;
use crc32fast::Hasher;
use std::ops::Range;
use std::path::Path;

/// Bytes of a row of states.
const ROW: usize = 4096;
/// Words of records that are read or written at once, about.
const AT_ONCE: usize = 1 << 17;

/// What a shard has of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The index of the point; 0 without a sweep.
    pub point: u64,
    /// Indices of its replicas within the point.
    pub replicas: Range<u64>,
    /// Seconds that they took.
    pub seconds: f64,
    /// How often it was resumed.
    pub resumptions: u64,
    /// Bytes of its checkpoint.
    pub state_bytes: u64,
}

impl Piece {
    fn count(&self) -> u64 {
        self.replicas.end - self.replicas.start
    }

    fn rows(&self) -> usize {
        (self.state_bytes as usize).div_ceil(ROW)
    }
}

/// Where pieces come from that are written.
pub trait Source {
    /// The bytes of the checkpoint of a piece.
    ///
    /// # Errors
    /// When they cannot be read.
    fn state(&mut self, piece: usize) -> Result<Vec<u8>, OutputError>;

    /// Shows every record of a piece in order, as long as `visit` asks for more.
    ///
    /// # Errors
    /// When they cannot be read, or those of `visit`.
    fn records(&mut self, piece: usize, visit: &mut Visit<'_>) -> Result<(), OutputError>;
}

/// Writes pieces with records of so many words, as long as it `goes_on`; whether it did.
///
/// # Errors
/// When the file or the source fails.
pub fn write(
    writer: &mut Writer<'_>,
    pieces: &[Piece],
    record_length: usize,
    source: &mut dyn Source,
    goes_on: &dyn Fn() -> bool,
) -> Result<bool, OutputError> {
    writer.scale(Dimension::Piece, &of(pieces, |piece| piece.point))?;
    writer.dataset("/pieces/first_replica", &of(pieces, |piece| piece.replicas.start))?;
    writer.dataset("/pieces/end_replica", &of(pieces, |piece| piece.replicas.end))?;
    writer.dataset("/pieces/seconds", &of(pieces, |piece| piece.seconds))?;
    writer.dataset("/pieces/resumptions", &of(pieces, |piece| piece.resumptions))?;
    writer.dataset("/pieces/state_bytes", &of(pieces, |piece| piece.state_bytes))?;
    let indices: Vec<u64> = pieces.iter().flat_map(|piece| piece.replicas.clone()).collect();
    writer.scale(Dimension::Record, &indices)?;
    writer.scale(Dimension::RecordWord, &(0..record_length as u32).collect::<Vec<u32>>())?;
    let rows: usize = pieces.iter().map(Piece::rows).sum();
    writer.scale(Dimension::StateRow, &(0..rows as u64).collect::<Vec<u64>>())?;
    writer.scale(Dimension::StateByte, &(0..ROW as u32).collect::<Vec<u32>>())?;
    writer.rows_dataset::<u64>("/records")?;
    writer.rows_dataset::<u8>("/state")?;
    let (mut record, mut row) = (0, 0);
    for (i, piece) in pieces.iter().enumerate() {
        if !goes_on() {
            return Ok(false);
        }
        let mut bytes = source.state(i)?;
        bytes.resize(piece.rows() * ROW, 0);
        writer.rows("/state", row, &bytes)?;
        row += piece.rows();
        let mut words = Vec::new();
        source.records(i, &mut |own: &[u64]| {
            words.extend_from_slice(own);
            if words.len() >= AT_ONCE {
                writer.rows("/records", record, &words)?;
                record += words.len() / record_length;
                words.clear();
            }
            Ok(goes_on())
        })?;
        writer.rows("/records", record, &words)?;
        record += words.len() / record_length;
    }
    Ok(goes_on())
}

fn of<T>(pieces: &[Piece], of: impl Fn(&Piece) -> T) -> Vec<T> {
    pieces.iter().map(of).collect()
}

/// A shard that is complete.
pub struct ShardFile {
    reader: Reader,
    /// What it has.
    pub pieces: Vec<Piece>,
    record_length: usize,
}

impl ShardFile {
    /// Opens a shard and checks that what it says of itself fits together.
    ///
    /// # Errors
    /// [`OutputError::NotAResult`].
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let reader = Reader::open(path, &[&SHARD])?;
        let broken =
            |problem: &str| OutputError::NotAResult { path: path.to_owned(), problem: problem.to_owned() };
        let whole = |name: &str| reader.values::<u64>(name);
        let (points, first, end) =
            (whole("/piece")?, whole("/pieces/first_replica")?, whole("/pieces/end_replica")?);
        let (seconds, resumptions) =
            (reader.values::<f64>("/pieces/seconds")?, whole("/pieces/resumptions")?);
        let bytes = whole("/pieces/state_bytes")?;
        let piece = |i: usize| Piece {
            point: points[i],
            replicas: first[i]..end[i],
            seconds: seconds[i],
            resumptions: resumptions[i],
            state_bytes: bytes[i],
        };
        let pieces: Vec<Piece> = (0..points.len()).map(piece).collect();
        if pieces.iter().any(|piece| piece.replicas.is_empty()) {
            return Err(broken("has a piece without replicas"));
        }
        let (records, rows) = (reader.length(Dimension::Record)?, reader.length(Dimension::StateRow)?);
        let count = pieces.iter().try_fold(0_u64, |sum, piece| sum.checked_add(piece.count()));
        let all = pieces
            .iter()
            .try_fold(0_u64, |sum, piece| sum.checked_add(piece.state_bytes.div_ceil(ROW as u64)));
        if count != Some(records as u64)
            || all != Some(rows as u64)
            || reader.length(Dimension::StateByte)? != ROW
        {
            return Err(broken("has pieces that are not as large as they say"));
        }
        let record_length = reader.length(Dimension::RecordWord)?;
        Ok(Self { reader, pieces, record_length })
    }

    /// Which run it is of, and which shard.
    ///
    /// # Errors
    /// [`OutputError::NotAResult`] when it does not say.
    pub fn identity(&self) -> Result<Identity, OutputError> {
        let text = |name: &str| self.reader.optional_text("/", name).map(Option::unwrap_or_default);
        let number = |name: &str| self.reader.number::<u64>("/", name);
        Ok(Identity {
            program_version: text("program_version")?,
            source_hash: text("source_hash")?,
            scene: text("scene")?,
            seed: number("seed")?,
            replicas: number("replicas")?,
            shard: Some(Shard { index: number("shard")?, count: number("shards")? }),
        })
    }

    /// The file of its scene, when it was computed.
    ///
    /// # Errors
    /// As [`ShardFile::identity`].
    pub fn scene_file(&self) -> Result<String, OutputError> {
        self.reader.optional_text("/", "scene_file").map(Option::unwrap_or_default)
    }

    /// The bytes of the checkpoint of a piece.
    ///
    /// # Errors
    /// When the file is damaged.
    pub fn state(&self, piece: usize) -> Result<Vec<u8>, OutputError> {
        let first: usize = self.pieces[..piece].iter().map(Piece::rows).sum();
        let own = &self.pieces[piece];
        let mut bytes: Vec<u8> = self.reader.rows("/state", first..first + own.rows())?;
        bytes.truncate(own.state_bytes as usize);
        Ok(bytes)
    }

    /// Shows every record of a piece in order, as long as `visit` asks for more; then also the CRC-32 of all
    /// of them, little-endian.
    ///
    /// # Errors
    /// When the file is damaged or its records have not so many words, and those of `visit`.
    pub fn records(
        &self,
        piece: usize,
        record_length: usize,
        visit: &mut Visit<'_>,
    ) -> Result<Option<u32>, OutputError> {
        if self.record_length != record_length {
            return Err(
                self.broken(format!("has records of {} words, not of {record_length}", self.record_length))
            );
        }
        let first: u64 = self.pieces[..piece].iter().map(Piece::count).sum();
        let (first, end) = (first as usize, (first + self.pieces[piece].count()) as usize);
        let (mut checksum, at_once) = (Hasher::new(), (AT_ONCE / record_length).max(1));
        for first in (first..end).step_by(at_once) {
            let words: Vec<u64> = self.reader.rows("/records", first..(first + at_once).min(end))?;
            checksum.update(&words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>());
            for record in words.chunks_exact(record_length) {
                if !visit(record)? {
                    return Ok(None);
                }
            }
        }
        Ok(Some(checksum.finalize()))
    }

    /// That the file is not what it should be.
    pub fn broken(&self, problem: String) -> OutputError {
        OutputError::NotAResult { path: self.reader.path().to_owned(), problem }
    }
}
