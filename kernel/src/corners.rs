//! Neighbours in lists of several dimensions, the last index fastest: the corners of a cell, with one check of bounds.
//!
//! A stride is the distance from one node to the next along a dimension. Each list below is as long as its strides and
//! the last neighbours need, so that the compiler can see that all but the first check hold.
#![deny(clippy::indexing_slicing)]

use crate::instructions::opaque;

/// `N` neighbours along the last dimension.
type Run<'a, T, const N: usize> = &'a [T; N];

/// Runs at the four corners of a square, the second stride's index fastest.
type Square<'a, T, const N: usize> = [Run<'a, T, N>; 4];

/// The part of a list that a cell at `base` spans, `extent` from its first corner to its last run.
#[inline(always)]
fn window<T, const N: usize>(list: &[T], base: u32, extent: usize) -> Option<&[T]> {
    let base = base as usize;
    list.get(base..base + (extent + N))
}

/// The first and the last run.
#[inline(always)]
fn ends<T, const N: usize>(list: &[T]) -> Option<[Run<'_, T, N>; 2]> {
    Some([list.first_chunk()?, list.last_chunk()?])
}

#[inline(always)]
fn square<T, const N: usize>(list: &[T], [j, k]: [usize; 2]) -> Option<Square<'_, T, N>> {
    let ([a, b], [c, d]) = (ends(list.get(..k + N)?)?, ends(list.get(j..)?)?);
    Some([a, b, c, d])
}

/// Runs at `base` and one stride further.
#[inline(always)]
pub(crate) fn two<T, const N: usize>(list: &[T], base: u32, stride: u32) -> Option<[Run<'_, T, N>; 2]> {
    ends(window::<T, N>(list, base, stride as usize)?)
}

/// Runs at the corners of a cube, the third stride's index fastest.
#[inline(always)]
pub(crate) fn eight<T, const N: usize>(list: &[T], base: u32, [i, j, k]: [u32; 3]) -> Option<[Run<'_, T, N>; 8]> {
    let (i, j, k) = (i as usize, j as usize, k as usize);
    // Two addresses, from which the other six are one or two strides: the compiler would keep nine in registers.
    let list = opaque(window::<T, N>(list, base, i + (j + k))?);
    let [a, b, c, d] = square(list.get(..j + k + N)?, [j, k])?;
    let [e, f, g, h] = square(opaque(list.get(i..)?), [j, k])?;
    Some([a, b, c, d, e, f, g, h])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_lists_that_hold_them_exactly() {
        let list: [usize; 24] = core::array::from_fn(|i| i);
        // Two by three by two by two nodes.
        let pairs = eight::<_, 2>(&list, 0, [12, 4, 2]).unwrap();
        assert_eq!(pairs.map(|pair| pair[0]), [0, 2, 4, 6, 12, 14, 16, 18]);
        assert!(pairs.iter().all(|pair| pair[1] == pair[0] + 1));
        assert_eq!(eight(&list, 4, [12, 4, 2]).unwrap()[7], &[22, 23]);
        assert_eq!(eight::<_, 2>(&list, 5, [12, 4, 2]), None);
        assert_eq!(two(&list, 20, 2), Some([&[20, 21], &[22, 23]]));
        assert_eq!(two::<_, 4>(&list, 18, 2), Some([&[18, 19, 20, 21], &[20, 21, 22, 23]]));
        assert_eq!(two::<_, 2>(&list, 21, 2), None);
        assert_eq!(two::<_, 2>(&list, u32::MAX, 2), None);
    }
}
