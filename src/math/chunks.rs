//! Work on parts of slices that several threads share.

/// Hands over chunks of slices of one length, with their numbers, to several threads of the pool or one after the other.
pub fn in_chunks<T: Send, const N: usize>(
    (size, is_shared): (usize, bool),
    slices: [&mut [T]; N],
    of: &(impl Fn(usize, [&mut [T]; N]) + Sync),
) {
    in_halves((size, is_shared), 0, slices, of);
}

/// Hands over chunks, the first of which has a number, by halves.
fn in_halves<T: Send, const N: usize>(
    (size, is_shared): (usize, bool),
    first: usize,
    slices: [&mut [T]; N],
    of: &(impl Fn(usize, [&mut [T]; N]) + Sync),
) {
    let count = slices[0].len().div_ceil(size);
    if count <= 1 {
        return of(first, slices);
    }
    let (middle, mut right) = (count / 2, slices);
    let left = right.each_mut().map(|slice| {
        let (left, rest) = std::mem::take(slice).split_at_mut(middle * size);
        *slice = rest;
        left
    });
    let left = || in_halves((size, is_shared), first, left, of);
    let right = || in_halves((size, is_shared), first + middle, right, of);
    if is_shared {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}
