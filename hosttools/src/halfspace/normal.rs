//! The normal contact problem: where the surfaces meet and with what pressure.
//!
//! With w the undeformed overlap and u = K p the elastic displacement, both pressure and gap are nowhere negative and
//! nowhere both positive:
//!
//! ```text
//! p ≥ 0,   e = K p - w ≥ 0,   p e = 0
//! ```
//! (the problem and its variational form: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990, chapter 4).
//! Active sets as in his NORM, but each only as well as it deserves: conjugate gradients, preconditioned by a stencil,
//! close the gaps of the elements that take part to a fifth; then those that pull leave, those that overlap join, and
//! the gaps are computed anew. One displacement of the grid a step, where conjugate gradients with a projection in each
//! step (Polonsky and Keer, Wear 231, 1999, 206-219) need two as long as the set changes. A preconditioner for bound-
//! constrained conjugate gradients: Vollebregt, J. Comput. Phys. 257, 2014, 333-351.
//!
//! Single precision is enough: what it leaves of a displacement is 3e-7 of the greatest, a thirtieth of the tolerance.

use std::ops::Range;

use super::convolution::{Convolution, Window};
use super::levels::Grid;
use super::stencil::Stencil;

/// Largest share of the greatest overlap by which an element may miss the contact condition.
pub const TOLERANCE: f64 = 1e-5;

/// Steps after which the search ends at the latest.
const MOST_STEPS: usize = 400;

/// What is left of the largest gap before the set of elements is looked at again.
const LEFT: f32 = 0.2;

/// Elements by which a window may at least grow before it needs another convolution.
const ROOM: usize = 2;

/// Solves for the pressure, from a first guess in the grid, and returns the number of steps: how many displacements were
/// computed, of the whole grid or of the elements that take part.
///
/// An element without overlap takes no pressure: displacements are positive everywhere, so it cannot touch.
pub(super) fn solve(grid: &mut Grid, links: &[f64], tolerance: f64) -> usize {
    let Grid { columns, ratio, zones, overlap, pressure, .. } = grid;
    let (columns, overlap) = (*columns, &*overlap);
    let goal = tolerance as f32 * overlap.iter().copied().fold(0.0, f32::max);
    let stencil = Stencil::new(*ratio);
    let mut influence = Displacements::new(columns, *ratio, zones, links);
    let zeros = || vec![0.0_f32; overlap.len()];
    let (mut gap, mut left, mut towards, mut direction, mut moved) = (zeros(), zeros(), zeros(), zeros(), zeros());
    // One for those that take part: those under pressure and those that overlap.
    let mut part = zeros();
    let mut steps = 0;
    while steps < MOST_STEPS {
        for (p, &w) in pressure.iter_mut().zip(overlap) {
            *p = if w > 0.0 { p.max(0.0) } else { 0.0 };
        }
        influence.everywhere(pressure, &mut gap);
        steps += 1;
        let mut worst = 0.0_f32;
        for ((((e, r), part), p), &w) in gap.iter().zip(&mut left).zip(&mut part).zip(&*pressure).zip(overlap) {
            let e = e - w;
            *part = if *p > 0.0 || (w > 0.0 && e < 0.0) { 1.0 } else { 0.0 };
            *r = *part * e;
            worst = worst.max(r.abs());
        }
        if worst <= goal {
            break;
        }
        let enough = (LEFT * worst).max(0.9 * goal);
        let window = bounds(columns, &part);
        let rows = window.rows.start * columns..window.rows.end * columns;
        direction.fill(0.0);
        let mut earlier = f32::INFINITY;
        while worst > enough && steps < MOST_STEPS {
            stencil.apply(&window, columns, &left, &mut towards);
            let (left, towards, part) = (&mut left[rows.clone()], &towards[rows.clone()], &part[rows.clone()]);
            let product = dot(columns, left, towards);
            let again = product / earlier;
            earlier = product;
            for ((t, z), part) in direction[rows.clone()].iter_mut().zip(towards).zip(part) {
                *t = part * (z + again * *t);
            }
            influence.within(&window, &direction, &mut moved);
            steps += 1;
            let (direction, moved) = (&direction[rows.clone()], &moved[rows.clone()]);
            let length = product / dot(columns, direction, moved);
            worst = 0.0;
            let elements = pressure[rows.clone()].iter_mut().zip(left).zip(direction).zip(moved).zip(part);
            for ((((p, r), t), m), part) in elements {
                *p -= length * t;
                *r = part * (*r - length * m);
                worst = if r.abs() > worst { r.abs() } else { worst };
            }
        }
    }
    steps
}

/// The smallest window with everything that is not zero.
fn bounds(columns: usize, values: &[f32]) -> Window {
    let mut window = Window { columns: columns..0, rows: values.len()..0 };
    for (j, row) in values.chunks_exact(columns).enumerate() {
        let Some(first) = row.iter().position(|&v| v != 0.0) else { continue };
        let last = row.iter().rposition(|&v| v != 0.0).unwrap_or(first);
        window.columns = window.columns.start.min(first)..window.columns.end.max(last + 1);
        window.rows = window.rows.start.min(j)..j + 1;
    }
    if window.rows.is_empty() { Window { columns: 0..0, rows: 0..0 } } else { window }
}

/// Sum of products: of a row in single precision, eight sums side by side, of all rows in double.
fn dot(columns: usize, a: &[f32], b: &[f32]) -> f32 {
    let row = |(a, b): (&[f32], &[f32])| {
        let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
        let mut sums = [0.0_f32; 8];
        let rest: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
        for (a, b) in a.zip(b) {
            sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
        }
        f64::from(sums.iter().sum::<f32>() + rest)
    };
    a.chunks_exact(columns).zip(b.chunks_exact(columns)).map(row).sum::<f64>() as f32
}

/// Displacements of a grid's elements.
struct Displacements<'a> {
    whole: Window,
    ratio: f64,
    zones: &'a [usize],
    links: &'a [f64],
    everywhere: Option<Convolution>,
    within: Option<Convolution>,
}

impl<'a> Displacements<'a> {
    fn new(columns: usize, ratio: f64, zones: &'a [usize], links: &'a [f64]) -> Self {
        let whole = Window { columns: 0..columns, rows: 0..zones.len() };
        Self { whole, ratio, zones, links, everywhere: None, within: None }
    }

    /// Of all elements.
    fn everywhere(&mut self, pressure: &[f32], displacement: &mut [f32]) {
        let source = bounds(self.whole.columns.len(), pressure);
        let extent = [self.whole.columns.len(), self.whole.rows.len()];
        let away = |whole: usize, source: &Range<usize>| source.end.max(whole - source.start.min(whole));
        let reach = [away(extent[0], &source.columns), away(extent[1], &source.rows)];
        let convolution = fitting(&mut self.everywhere, extent, reach, self.ratio);
        apply(convolution, self.zones, self.links, &self.whole, &self.whole, pressure, displacement);
    }

    /// Of the elements of a window, by the pressures in it.
    fn within(&mut self, window: &Window, pressure: &[f32], displacement: &mut [f32]) {
        let extent = [window.columns.len(), window.rows.len()];
        let convolution = fitting(&mut self.within, extent, extent, self.ratio);
        apply(convolution, self.zones, self.links, &self.whole, window, pressure, displacement);
    }
}

/// A convolution for windows of this extent and distances below this reach: the one that there is, or a new one with some
/// room.
fn fitting(found: &mut Option<Convolution>, extent: [usize; 2], reach: [usize; 2], ratio: f64) -> &mut Convolution {
    let reach = reach.map(|reach| reach.saturating_sub(1));
    if found.as_ref().is_some_and(|found| (0..2).any(|n| reach[n] > found.reach()[n])) {
        *found = None;
    }
    let room = |size: [usize; 2]| size.map(|size| size + ROOM);
    found.get_or_insert_with(|| Convolution::new(room(extent), room(reach), ratio))
}

/// Displacements in a window. Where zones act on each other by less than fully: zone after zone, each weighed as it is
/// felt.
fn apply(
    convolution: &mut Convolution,
    zones: &[usize],
    links: &[f64],
    whole: &Window,
    window: &Window,
    pressure: &[f32],
    displacement: &mut [f32],
) {
    let columns = whole.columns.len();
    if links.iter().all(|&link| link == 1.0) {
        convolution.apply(window, columns, pressure, displacement);
        return;
    }
    displacement.fill(0.0);
    let mut own = vec![0.0; pressure.len()];
    let mut moved = vec![0.0; pressure.len()];
    for zone in 0..=links.len() {
        for (place, (own, p)) in zones.iter().zip(own.chunks_exact_mut(columns).zip(pressure.chunks_exact(columns))) {
            if *place == zone { own.copy_from_slice(p) } else { own.fill(0.0) }
        }
        convolution.apply(window, columns, &own, &mut moved);
        for (&place, (u, m)) in
            zones.iter().zip(displacement.chunks_exact_mut(columns).zip(moved.chunks_exact(columns)))
        {
            let felt = links[zone.min(place)..zone.max(place)].iter().product::<f64>() as f32;
            for (u, m) in u.iter_mut().zip(m) {
                *u += felt * m;
            }
        }
    }
}
