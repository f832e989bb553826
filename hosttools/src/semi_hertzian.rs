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
//! which the deformed surface has the curvature 2 A along the track; that holds here strip by strip,
//!
//! ```text
//! A_i = Σ_j q_j / (π E*) [H((r + h/2) / a_j) - H((r - h/2) / a_j)],   H' = k (K - E)
//! ```
//! weighted by the strips' forces over some millimetres, so that the ends of a patch do not decide. Both are exact for
//! an ellipse. Unlike local rules of the family (STRIPES, Kik-Piotrowski, ANALYN) strips feel each other, so peaks
//! of one zone and near zones need no rule of their own.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

use crate::contact::{Row, Surface};
use crate::halfspace::{RowLoad, interaction};
use crate::hertz::elliptic;

/// Strips in each zone of overlap, narrower where it is deep.
const STRIPS: usize = 24;
/// Width (m) of the weights with which q is averaged.
const SMOOTHING: f64 = 3e-3;
/// Rounds at the most, and the relative change of force that ends them.
const ROUNDS: usize = 30;
const TOLERANCE: f64 = 1e-5;

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
    let mut strips: Vec<Strip> = Vec::with_capacity(STRIPS * zones.len());
    let mut loads = Vec::with_capacity(STRIPS * zones.len());
    for (zone, place) in zones.iter().enumerate() {
        strips.extend(place.cuts(STRIPS).windows(2).filter_map(|cuts| {
            let row = surface.row(place, 0.5 * (cuts[0] + cuts[1]))?;
            let carries = row.overlap > 0.0 && row.half_curvature > 0.0 && cuts[1] > cuts[0];
            carries.then_some(Strip { row, width: cuts[1] - cuts[0], zone })
        }));
        if links.get(zone).is_some_and(|&link| link > 0.0) {
            continue;
        }
        let group = Strips { strips: &strips, links: &links, scale: 1.0 / (PI * contact_modulus) };
        let found = group.solve(contact_modulus);
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
    fn solve(&self, contact_modulus: f64) -> Vec<[f64; 2]> {
        let n = self.strips.len();
        let least = |i: usize| 0.1 * self.strips[i].width;
        let mut q: Vec<f64> = self.strips.iter().map(|s| contact_modulus * s.row.half_curvature).collect();
        let mut lengths: Vec<f64> =
            self.strips.iter().map(|s| (0.5 * s.row.overlap / s.row.half_curvature).sqrt()).collect();
        let (mut sinking, mut bending) = (vec![0.0; n * n], vec![0.0; n * n]);
        let mut products = vec![0.0; n];
        let mut before = 0.0;
        for _ in 0..ROUNDS {
            self.assemble(&lengths, &mut sinking, &mut bending);
            products = self.meet_overlap(&sinking);
            self.meet_curvature(&bending, &products, &mut q);
            for i in 0..n {
                lengths[i] = (products[i] / q[i]).sqrt().max(least(i));
            }
            let force: f64 = products.iter().zip(self.strips).map(|(p, s)| p * s.width).sum();
            if (force - before).abs() <= TOLERANCE * force {
                break;
            }
            before = force;
        }
        products.into_iter().zip(lengths).map(|(product, length)| [product, length]).collect()
    }

    /// What unit p a, and unit q, of strip j do in the middle of strip i.
    fn assemble(&self, lengths: &[f64], sinking: &mut [f64], bending: &mut [f64]) {
        let table = Integrals::table();
        let n = self.strips.len();
        for (i, here) in self.strips.iter().enumerate() {
            for (j, there) in self.strips.iter().enumerate() {
                let [first, last] = [here.zone.min(there.zone), here.zone.max(there.zone)];
                let felt: f64 = self.links[first..last].iter().product();
                let distance = distance(&here.row, &there.row, lengths[j]);
                let [outer, inner] = [0.5, -0.5].map(|half| (distance + half * there.width) / lengths[j]);
                let ([g1, h1], [g0, h0]) = (table.at(outer), table.at(inner));
                sinking[i * n + j] = felt * self.scale * (g1 - g0);
                bending[i * n + j] = felt * self.scale * (h1 - h0);
            }
        }
    }

    /// p a ≥ 0 of every strip such that the overlap is met where there is pressure: strips that would pull are left out.
    fn meet_overlap(&self, sinking: &[f64]) -> Vec<f64> {
        let n = self.strips.len();
        let mut active: Vec<usize> = (0..n).collect();
        loop {
            let m = active.len();
            let mut matrix: Vec<f64> =
                active.iter().flat_map(|&i| active.iter().map(move |&j| sinking[i * n + j])).collect();
            let mut right: Vec<f64> = active.iter().map(|&i| self.strips[i].row.overlap).collect();
            eliminate(&mut matrix, &mut right, m);
            if right.iter().all(|&v| v >= 0.0) {
                let mut products = vec![0.0; n];
                active.iter().zip(right).for_each(|(&i, v)| products[i] = v);
                return products;
            }
            let mut values = right.iter();
            active.retain(|_| values.next().is_some_and(|&v| v >= 0.0));
        }
    }

    /// Corrects q so that the curvature along the track is met in the mean about each strip.
    fn meet_curvature(&self, bending: &[f64], products: &[f64], q: &mut [f64]) {
        let n = self.strips.len();
        let bend = |i: usize| (0..n).filter(|&j| products[j] > 0.0).map(|j| bending[i * n + j] * q[j]).sum::<f64>();
        let ratio: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let weight = products[i] * self.strips[i].width;
                if weight > 0.0 {
                    [weight, (self.strips[i].row.half_curvature / bend(i)).clamp(0.2, 5.0)]
                } else {
                    [0.0, 1.0]
                }
            })
            .collect();
        for (here, q) in self.strips.iter().zip(q) {
            let (mut sum, mut total) = (0.0, 0.0);
            for (there, [force, ratio]) in self.strips.iter().zip(&ratio) {
                let away = (here.row.rail.t - there.row.rail.t) / SMOOTHING;
                let weight = force / (1.0 + away * away).powi(2);
                sum += weight * ratio;
                total += weight;
            }
            if total > 0.0 {
                *q *= sum / total;
            }
        }
    }
}

/// Distance (m) at which a strip of half length a is felt from the middle of another: beside a strip across; a shift Δx
/// along the track counts only as far as it leads out of the strip.
///
/// ```text
/// r² = Δs² + Δx² Δ² / (Δ² + a²),   Δ² = Δs² + Δx²
/// ```
fn distance(from: &Row, to: &Row, length: f64) -> f64 {
    let (across2, along2) = ((from.rail.t - to.rail.t).powi(2), (from.x - to.x).powi(2));
    let all2 = across2 + along2;
    (across2 + along2 * all2 / (all2 + length * length)).sqrt()
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

/// G and H, tabulated over √ρ.
struct Integrals {
    values: Vec<[f64; 2]>,
}

/// Nodes of the table, and the ρ it ends at: beyond, g is π / 2ρ and H constant.
const NODES: usize = 4096;
const END: f64 = 64.0;

impl Integrals {
    fn table() -> &'static Self {
        static TABLE: OnceLock<Integrals> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let step = END.sqrt() / NODES as f64;
        // dG = g dρ = 2 v g(v²) dv with v = √ρ, by Simpson's rule.
        let rate = |v: f64| {
            if v == 0.0 {
                return [0.0; 2];
            }
            let rho = v * v;
            let root = (1.0 + rho * rho).sqrt();
            let (k, e) = elliptic(rho / root);
            [2.0 * v * 2.0 * root * (k - e), 2.0 * v * (k - e) / root]
        };
        let mut values = vec![[0.0; 2]];
        let mut sum = [0.0; 2];
        for i in 0..NODES {
            let [a, b, c] = [0.0, 0.5, 1.0].map(|part| rate((i as f64 + part) * step));
            for n in 0..2 {
                sum[n] += step / 6.0 * (a[n] + 4.0 * b[n] + c[n]);
            }
            values.push(sum);
        }
        Self { values }
    }

    /// G and H, odd in ρ.
    fn at(&self, rho: f64) -> [f64; 2] {
        let size = rho.abs();
        let found = if size >= END {
            let [g, h] = self.values[NODES];
            [g + FRAC_PI_2 * libm::log(size / END), h]
        } else {
            let place = (size / END).sqrt() * NODES as f64;
            let i = (place as usize).min(NODES - 1);
            let (low, high, share) = (self.values[i], self.values[i + 1], place - i as f64);
            [low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1])]
        };
        if rho < 0.0 { found.map(|v| -v) } else { found }
    }
}
