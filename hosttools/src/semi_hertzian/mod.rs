//! A semi-Hertzian strip method: Hertz along the track, the true profiles across it.
//!
//! The patch is cut into strips along the track, each with a semi-elliptic pressure, and the strips' displacements
//! are made to meet the overlap in the middle of each (Knothe and Le The, Computers & Structures 18, 1984, 1025-1033).
//! With p the pressure in a strip's middle, a its half length, h its width and r the distance of two strips,
//!
//! ```text
//! w_i = Σ_j p_j a_j / (π E*) [G((r + h/2) / a_j) - G((r - h/2) / a_j)],   p_j ≥ 0
//! G' = g(ρ) = 2 √(1 + ρ²) (K - E),   modulus k² = 1 / (1 + ρ²)
//! ```
//! The half lengths close the system. In Hertz's ellipse q = p / a is the same for all strips, and it is the one with
//! which the deformed surface has the curvature 2 A along the track,
//!
//! ```text
//! A_i = Σ_j q_j / (π E*) [H((r + h/2) / a_j) - H((r - h/2) / a_j)],   H' = k (K - E)
//! ```
//! Here it holds in the mean over some millimetres, weighted by the strips' forces, so that the ends of a patch do not
//! decide. Both are exact for an ellipse. Unlike local rules of the family (STRIPES, Kik-Piotrowski, ANALYN) strips feel
//! each other, so peaks of one zone and near zones need no rule of their own. Rounds of the two conditions are
//! accelerated; the force is continuous in the pose because strips are ([`Surface::cuts`]), and because those without
//! overlap carry nothing. The wheel's curvature is the mean over a strip's width: a profile's arcs meet with a step of it.

use std::f64::consts::{FRAC_PI_2, PI};

mod integrals;
mod mixing;

use integrals::Integrals;
use mixing::Mixing;

use crate::contact::{Row, Surface};
use crate::halfspace::{RowLoad, interaction};

/// Strips in all zones of overlap, narrower where it is deep, but for what is left at the ends of zones.
const STRIPS: usize = 24;
/// Width (m) from which on what is left at the end of a zone is a strip.
const NARROWEST: f64 = 1e-8;
/// Share of the greatest overlap of its zone from which on a strip is taken to carry, as a first guess.
const CARRYING: f64 = 0.4;
/// Width (m) of the weights with which the curvature along the track is averaged.
const SMOOTHING: f64 = 3e-3;
/// Rounds at the most, and the mean relative change of the half lengths that ends them.
const ROUNDS: usize = 60;
const TOLERANCE: f64 = 1e-5;
/// Share of its neighbours' half length that a strip has at least where it acts on others. Without it the short strips at
/// the ends of a narrow patch decide the curvature beside them, and the half lengths do not settle.
const BLUNT: f64 = 0.3;
/// Changes of the set of strips that carry, at the most, in each round.
const MOST_CHANGES: usize = 20;

/// One strip: its row, its width (m) and its zone.
struct Strip {
    row: Row,
    width: f64,
    zone: usize,
}

/// What the strips of all zones carry. Zones too far apart to act on each other are solved on their own.
pub fn loads(surface: &Surface<'_>, contact_modulus: f64) -> Vec<RowLoad> {
    let zones = surface.zones();
    let links: Vec<f64> = zones.windows(2).map(|w| interaction(w[1].ends[0] - w[0].ends[1])).collect();
    let (mut strips, mut loads) = (Vec::<Strip>::new(), Vec::new());
    for (zone, (place, cuts)) in zones.iter().zip(surface.cuts(STRIPS)).enumerate() {
        strips.extend(cuts.windows(2).filter_map(|cuts| {
            let row = surface.row(place, 0.5 * (cuts[0] + cuts[1]), cuts[1] - cuts[0])?;
            let carries = row.overlap > 0.0 && row.half_curvature > 0.0 && cuts[1] - cuts[0] > NARROWEST;
            carries.then_some(Strip { row, width: cuts[1] - cuts[0], zone })
        }));
        if links.get(zone).is_some_and(|&link| link > 0.0) {
            continue;
        }
        let group = Strips { strips: &strips, links: &links, scale: 1.0 / (PI * contact_modulus) };
        let found = group.solve();
        let load = |(strip, [product, length]): (&Strip, [f64; 2])| RowLoad {
            row: strip.row,
            width: strip.width,
            // ∫ p √(1 - x² / a²) dx = π p a / 2, its second moment a² / 4
            force: FRAC_PI_2 * product * strip.width,
            moments: [0.0, 0.25 * length * length],
        };
        loads.extend(strips.iter().zip(found).map(load).filter(|load| load.force > 0.0));
        strips.clear();
    }
    loads
}

struct Strips<'a> {
    strips: &'a [Strip],
    /// How much each zone and the next act on each other.
    links: &'a [f64],
    /// 1 / (π E*)
    scale: f64,
}

impl Strips<'_> {
    /// p a (N/m) and a (m) of every strip.
    fn solve(&self) -> Vec<[f64; 2]> {
        let n = self.strips.len();
        let (mut sinking, mut bending) = (vec![0.0; n * n], vec![0.0; n * n]);
        let (pairs, weights) = (self.pairs(), self.weights());
        let mut carrying = self.guess();
        let mut products = vec![0.0; n];
        let mut state: Vec<f64> =
            self.strips.iter().map(|s| 0.5 * libm::log(0.5 * s.row.overlap / s.row.half_curvature)).collect();
        let mut mixing = Mixing::default();
        let (mut lengths, mut own) = (vec![0.0; n], Vec::new());
        for _ in 0..ROUNDS {
            lengths.iter_mut().zip(&state).for_each(|(a, &ln)| *a = libm::exp(ln));
            self.meet_overlap(&mut sinking, &mut carrying, &mut products, |j, sinking| {
                let bending = &mut bending[j * n..][..n];
                self.assemble(&pairs[j * n..][..n], self.strips[j].width, lengths[j], sinking, bending);
            });
            let acting;
            [own, acting] = self.meet_curvature(&bending, &weights, &products, &lengths);
            let forces: Vec<f64> = products.iter().zip(self.strips).map(|(p, s)| p * s.width).collect();
            if mixing.advance(&mut state, acting.into_iter().map(libm::log).collect(), &forces) <= TOLERANCE {
                break;
            }
        }
        products.into_iter().zip(own).map(|(product, length)| [product, length]).collect()
    }

    /// Strips that carry, at first sight.
    fn guess(&self) -> Vec<bool> {
        let deepest = |zone| {
            let same = self.strips.iter().filter(|s| s.zone == zone);
            same.map(|s| s.row.overlap).fold(0.0, f64::max)
        };
        self.strips.iter().map(|s| s.row.overlap > CARRYING * deepest(s.zone)).collect()
    }

    /// By how much the curvature at one strip counts at another.
    fn weights(&self) -> Vec<f64> {
        let of = |here: &Strip, there: &Strip| {
            let away = (here.row.rail.t - there.row.rail.t) / SMOOTHING;
            (1.0 + away * away).powi(-2)
        };
        self.strips.iter().flat_map(|here| self.strips.iter().map(move |there| of(here, there))).collect()
    }

    /// Δs², Δx² and 1 / (π E*), by how much their zones act on each other, of every two strips.
    fn pairs(&self) -> Vec<[f64; 3]> {
        let of = |here: &Strip, there: &Strip| {
            let [first, last] = [here.zone.min(there.zone), here.zone.max(there.zone)];
            let felt: f64 = self.links[first..last].iter().product();
            let (across, along) = (here.row.rail.t - there.row.rail.t, here.row.x - there.row.x);
            [across * across, along * along, felt * self.scale]
        };
        self.strips.iter().flat_map(|here| self.strips.iter().map(move |there| of(here, there))).collect()
    }

    /// What unit p a, and unit q, of one strip do in the middle of every strip; `pairs` are its own.
    fn assemble(&self, pairs: &[[f64; 3]], width: f64, length: f64, sinking: &mut [f64], bending: &mut [f64]) {
        let table = Integrals::table();
        let (square, inverse, half) = (length * length, 1.0 / length, 0.5 * width / length);
        for ((&[across2, along2, scale], sinking), bending) in pairs.iter().zip(sinking).zip(bending) {
            let rho = distance(across2, along2, square) * inverse;
            let ([g1, h1], [g0, h0]) = (table.at(rho + half), table.at(rho - half));
            *sinking = scale * (g1 - g0);
            *bending = scale * (h1 - h0);
        }
    }

    /// p a ≥ 0 of every strip such that the overlap is met where there is pressure and exceeded nowhere: strips that would
    /// pull are left out, strips whose overlap remains come in. `carrying` is the first guess, and what is found;
    /// `assemble` makes the influence of strips that carry, a row of the matrix for each.
    fn meet_overlap(
        &self,
        sinking: &mut [f64],
        carrying: &mut [bool],
        products: &mut [f64],
        mut assemble: impl FnMut(usize, &mut [f64]),
    ) {
        let n = self.strips.len();
        let mut known = vec![false; n];
        for _ in 0..MOST_CHANGES {
            let active: Vec<usize> = (0..n).filter(|&i| carrying[i]).collect();
            for &j in &active {
                if !known[j] {
                    assemble(j, &mut sinking[j * n..][..n]);
                    known[j] = true;
                }
            }
            let mut matrix: Vec<f64> = active
                .iter()
                .flat_map(|&i| active.iter().map(move |&j| (i, j)))
                .map(|(i, j)| sinking[j * n + i])
                .collect();
            let mut right: Vec<f64> = active.iter().map(|&i| self.strips[i].row.overlap).collect();
            eliminate(&mut matrix, &mut right, active.len());
            products.fill(0.0);
            active.iter().zip(right).for_each(|(&i, v)| products[i] = v);
            let mut changed = false;
            for (i, strip) in self.strips.iter().enumerate() {
                let stays = if carrying[i] {
                    products[i] >= 0.0
                } else {
                    let sunk: f64 = active.iter().map(|&j| sinking[j * n + i] * products[j].max(0.0)).sum();
                    sunk < (1.0 - TOLERANCE) * strip.row.overlap
                };
                changed |= stays != carrying[i];
                carrying[i] = stays;
            }
            products.iter_mut().for_each(|p| *p = p.max(0.0));
            if !changed {
                return;
            }
        }
    }

    /// Half lengths (m) such that the curvature along the track is met in the mean about each strip: those of the strips'
    /// own pressure, and those with which they act on others. `lengths` are the latter as they were.
    fn meet_curvature(&self, bending: &[f64], weights: &[f64], products: &[f64], lengths: &[f64]) -> [Vec<f64>; 2] {
        let n = self.strips.len();
        let ratios: Vec<f64> = products.iter().zip(lengths).map(|(p, a)| p / (a * a)).collect();
        let carried = |i: usize| {
            // Strips that do not carry bend nothing, and nothing is asked of them.
            let acts = |&j: &usize| products[i] > 0.0 && products[j] > 0.0;
            let bent: f64 = (0..n).filter(acts).map(|j| bending[j * n + i] * ratios[j]).sum();
            let force = products[i] * self.strips[i].width;
            [1.0, self.strips[i].row.half_curvature, bent, ratios[i]].map(|part| force * part)
        };
        let carried: Vec<[f64; 4]> = (0..n).map(carried).collect();
        let square = |i: usize| {
            let mut sums = [0.0; 4];
            for (w, parts) in weights[i * n..][..n].iter().zip(&carried) {
                sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += w * part);
            }
            let [force, wanted, bent, ratio] = sums;
            // p a / q, with q = p / a of the neighbourhood, as much larger as the surface is to be bent more; and the force.
            [products[i] * force * bent / (ratio * wanted), force]
        };
        let squares: Vec<[f64; 2]> = (0..n).map(square).collect();
        let weighted: Vec<f64> =
            carried.iter().zip(&squares).map(|([force, ..], [square, _])| force * square).collect();
        let acting = |i: usize| {
            let [square, force] = squares[i];
            let around = weights[i * n..][..n].iter().zip(&weighted).map(|(w, part)| w * part).sum::<f64>() / force;
            // The fourth powers leave all but the short ones as they are.
            (square.powi(2) + (BLUNT * BLUNT * around).powi(2)).sqrt().sqrt()
        };
        [squares.iter().map(|[square, _]| square.sqrt()).collect(), (0..n).map(acting).collect()]
    }
}

/// Distance (m) at which a strip of half length a is felt from the middle of another: beside a strip across; a shift Δx
/// along the track counts only as far as it leads out of the strip.
///
/// ```text
/// r² = Δs² + Δx² Δ² / (Δ² + a²),   Δ² = Δs² + Δx²
/// ```
#[inline]
fn distance(across2: f64, along2: f64, length2: f64) -> f64 {
    let all2 = across2 + along2;
    (across2 + along2 * all2 / (all2 + length2)).sqrt()
}

/// Gaussian elimination in place; the matrix is nearly symmetric and positive, so no pivot is sought.
fn eliminate(matrix: &mut [f64], right: &mut [f64], n: usize) {
    for k in 0..n {
        for i in k + 1..n {
            let factor = matrix[i * n + k] / matrix[k * n + k];
            let (above, below) = matrix.split_at_mut(i * n);
            for (b, a) in below[k..n].iter_mut().zip(&above[k * n + k..(k + 1) * n]) {
                *b -= factor * a;
            }
            right[i] -= factor * right[k];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| matrix[i * n + j] * right[j]).sum();
        right[i] = (right[i] - known) / matrix[i * n + i];
    }
}
