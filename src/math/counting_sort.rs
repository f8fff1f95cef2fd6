//! Sorting by a small number.

/// Puts `items` into `order` by their group, in a group as they come; returns the place where each of the
/// `groups` begins, and at last the number of items.
pub fn counting_sort(
    items: impl Iterator<Item = u32> + Clone,
    groups: usize,
    group: impl Fn(u32) -> usize,
    order: &mut Vec<u32>,
) -> Vec<usize> {
    let mut starts = vec![0; groups + 1];
    items.clone().for_each(|item| starts[group(item) + 1] += 1);
    (0..groups).for_each(|k| starts[k + 1] += starts[k]);
    order.resize(starts[groups], 0);
    let mut next = starts.clone();
    for item in items {
        let place = &mut next[group(item)];
        order[*place] = item;
        *place += 1;
    }
    starts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_of_a_group_keep_their_order() {
        let mut order = vec![7; 9];
        let starts = counting_sort([5, 2, 8, 1, 4].into_iter(), 4, |item| (item % 3) as usize, &mut order);
        assert_eq!((order, starts), (vec![1, 4, 5, 2, 8], vec![0, 0, 2, 5, 5]));
    }
}
