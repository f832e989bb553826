//! Neighbours in lists of several dimensions, the last index fastest: the corners of a cell, with one check of bounds.
//!
//! A stride is the distance from one node to the next along a dimension. Each list below is as long as its strides and
//! the last two neighbours need, so that the compiler can see that all but the first check hold.
#![deny(clippy::indexing_slicing)]

/// Two neighbours along the last dimension.
type Pair<'a, T> = &'a [T; 2];

/// Pairs at the four corners of a square, the second stride's index fastest.
type Square<'a, T> = [Pair<'a, T>; 4];

/// The part of a list that a cell at `base` spans, `extent` from its first corner to its last pair.
#[inline(always)]
fn window<T>(list: &[T], base: u32, extent: usize) -> Option<&[T]> {
    let base = base as usize;
    list.get(base..base + extent + 2)
}

/// The first and the last pair.
#[inline(always)]
fn ends<T>(list: &[T]) -> Option<[Pair<'_, T>; 2]> {
    Some([list.first_chunk()?, list.last_chunk()?])
}

#[inline(always)]
fn square<T>(list: &[T], [j, k]: [usize; 2]) -> Option<Square<'_, T>> {
    let ([a, b], [c, d]) = (ends(list.get(..k + 2)?)?, ends(list.get(j..)?)?);
    Some([a, b, c, d])
}

/// Pairs at `base` and one stride further.
#[inline(always)]
pub(crate) fn two_pairs<T>(list: &[T], base: u32, stride: u32) -> Option<[Pair<'_, T>; 2]> {
    ends(window(list, base, stride as usize)?)
}

/// Pairs at the corners of a square, the second stride's index fastest.
#[inline(always)]
pub(crate) fn four_pairs<T>(list: &[T], base: u32, [j, k]: [u32; 2]) -> Option<Square<'_, T>> {
    let (j, k) = (j as usize, k as usize);
    square(window(list, base, j + k)?, [j, k])
}

/// Pairs at the corners of a cube, the third stride's index fastest.
#[inline(always)]
pub(crate) fn eight_pairs<T>(list: &[T], base: u32, [i, j, k]: [u32; 3]) -> Option<[Pair<'_, T>; 8]> {
    let (i, j, k) = (i as usize, j as usize, k as usize);
    let list = window(list, base, i + (j + k))?;
    let [a, b, c, d] = square(list.get(..j + k + 2)?, [j, k])?;
    let [e, f, g, h] = square(list.get(i..)?, [j, k])?;
    Some([a, b, c, d, e, f, g, h])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_lists_that_hold_them_exactly() {
        let list: [usize; 24] = core::array::from_fn(|i| i);
        // Two by three by two by two nodes.
        let pairs = eight_pairs(&list, 0, [12, 4, 2]).unwrap();
        assert_eq!(pairs.map(|pair| pair[0]), [0, 2, 4, 6, 12, 14, 16, 18]);
        assert!(pairs.iter().all(|pair| pair[1] == pair[0] + 1));
        assert_eq!(eight_pairs(&list, 4, [12, 4, 2]).unwrap()[7], &[22, 23]);
        assert_eq!(eight_pairs(&list, 5, [12, 4, 2]), None);
        assert_eq!(four_pairs(&list, 16, [4, 2]).unwrap().map(|pair| pair[0]), [16, 18, 20, 22]);
        assert_eq!(four_pairs(&list, 17, [4, 2]), None);
        assert_eq!(two_pairs(&list, 20, 2), Some([&[20, 21], &[22, 23]]));
        assert_eq!(two_pairs(&list, u32::MAX, 2), None);
    }
}
