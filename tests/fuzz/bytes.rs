//! Damaged copies of binary files.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What sizes, counts, addresses and versions are overwritten with.
const NUMBERS: [u64; 14] = [
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    1 << 40,
    i64::MAX as u64,
    1 << 63,
    u64::MAX,
];

/// One of `seeds`, damaged in one to six places; the same for the same number.
pub fn damaged(seeds: &[Vec<u8>], case: u64) -> Vec<u8> {
    let mut rng = ChaCha8Rng::seed_from_u64(case);
    let mut bytes = seeds[rng.random_range(0..seeds.len())].clone();
    for _ in 0..rng.random_range(1..=6) {
        if bytes.is_empty() {
            break;
        }
        damage(&mut bytes, seeds, &mut rng);
    }
    bytes
}

fn damage(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], rng: &mut ChaCha8Rng) {
    let place = place(bytes, rng);
    match rng.random_range(0..100) {
        0..30 => bytes[place] ^= 1 << rng.random_range(0..8),
        30..45 => bytes[place] = rng.random(),
        45..75 => {
            let number = NUMBERS[rng.random_range(0..NUMBERS.len())].to_le_bytes();
            let width = 1 << rng.random_range(0..4);
            overwrite(bytes, place, &number[..width]);
        }
        75..85 => {
            // A near copy: a size or an address that is right elsewhere.
            let from = place.saturating_sub(rng.random_range(0..256));
            let piece = bytes[from..(from + rng.random_range(1..64)).min(bytes.len())].to_vec();
            overwrite(bytes, place, &piece);
        }
        85..92 => {
            let other = &seeds[rng.random_range(0..seeds.len())];
            let from = rng.random_range(0..other.len());
            let piece = &other[from..(from + rng.random_range(1..2048)).min(other.len())];
            overwrite(bytes, place, piece);
        }
        92..95 => {
            let end = (place + rng.random_range(1..256)).min(bytes.len());
            rng.fill_bytes(&mut bytes[place..end]);
        }
        95..97 => {
            bytes.drain(place..(place + rng.random_range(1..64)).min(bytes.len()));
        }
        97..99 => bytes.truncate(place),
        _ => bytes.resize(bytes.len() + rng.random_range(1..4096), 0),
    }
}

/// A place, often near the beginning, where the structure of a file is.
fn place(bytes: &[u8], rng: &mut ChaCha8Rng) -> usize {
    let reach = match rng.random_range(0..4) {
        0 => bytes.len().min(1024),
        1 => bytes.len().min(8192),
        _ => bytes.len(),
    };
    rng.random_range(0..reach)
}

fn overwrite(bytes: &mut [u8], place: usize, piece: &[u8]) {
    let end = (place + piece.len()).min(bytes.len());
    bytes[place..end].copy_from_slice(&piece[..end - place]);
}
