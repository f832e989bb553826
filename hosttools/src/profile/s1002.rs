//! The S1002 wheel profile of EN 13715 in its analytic definition, for a rim 130 mm wide.

use super::pieces::{Piece, profile};
use super::{Profile, ProfileKind};

/// Zone borders S (mm), from the flange back (H) to the field side (A).
const H_START: f64 = -70.0;
const G_START: f64 = -62.764705882;
const F_START: f64 = -49.662510381;
const E_START: f64 = -39.764473993;
const D_START: f64 = -38.426669071;
const C_START: f64 = -35.0;
const B_START: f64 = -26.0;
const A_START: f64 = 32.15796;
const A_END: f64 = 60.0;

/// A circular zone: centre S and z, radius (mm), and whether it lies above its centre.
struct Circle {
    centre: [f64; 2],
    radius: f64,
    above: bool,
}

const H: Circle = Circle { centre: [-49.5, 9.519259302], radius: 20.5, above: false };
const G: Circle = Circle { centre: [-55.0, 16.0], radius: 12.0, above: false };
const F: Circle = Circle { centre: [-58.558326413, 8.834924130], radius: 20.0, above: false };
const D: Circle = Circle { centre: [-26.210665, 16.446], radius: 13.0, above: true };

/// The 70° flange and the outer tread, z = intercept + slope S.
const E: [f64; 2] = [-93.576667419, -2.747477419];
const A: [f64; 2] = [1.364323640, -0.066666667];

/// Inner tread, by rising powers of S.
const B: [f64; 9] = [
    0.0,
    -3.358537058e-2,
    1.565681624e-3,
    -2.810427944e-5,
    5.844240864e-8,
    -1.562379023e-8,
    5.309217349e-15,
    -5.957839843e-12,
    2.646656573e-13,
];
/// Flange root towards the tread, by rising powers of S.
const C: [f64; 8] = [
    -4.320221063e3,
    -1.038384026e3,
    -1.065501873e2,
    -6.051367875,
    -2.054332446e-1,
    -4.169739389e-3,
    -4.687195829e-5,
    -2.252755540e-7,
];

/// Height z (m, positive down) of the S1002 at S (m, positive to the field side, 0 at the tape circle).
///
/// The formulas as printed: zone C begins 1.2e-4 mm above zone D's end and ends 3.7e-5 mm above zone B's start. NaN
/// outside -70 to 60 mm.
pub fn s1002_height(s: f64) -> f64 {
    let s = 1e3 * s;
    let (height, _) = zone(s);
    1e-3 * height
}

/// Slope dz/dS of the S1002 at S (m, positive to the field side). NaN outside -70 to 60 mm, infinite at -70 mm.
pub fn s1002_slope(s: f64) -> f64 {
    zone(1e3 * s).1
}

/// Height (mm) and slope at S (mm).
fn zone(s: f64) -> (f64, f64) {
    match s {
        H_START..G_START => circle(&H, s),
        G_START..F_START => circle(&G, s),
        F_START..E_START => circle(&F, s),
        E_START..D_START => polynomial(&E, s),
        D_START..C_START => circle(&D, s),
        C_START..B_START => polynomial(&C, s),
        B_START..A_START => polynomial(&B, s),
        A_START..=A_END => polynomial(&A, s),
        _ => (f64::NAN, f64::NAN),
    }
}

fn circle(c: &Circle, s: f64) -> (f64, f64) {
    let across = s - c.centre[0];
    let up = (c.radius * c.radius - across * across).max(0.0).sqrt();
    if c.above { (c.centre[1] - up, across / up) } else { (c.centre[1] + up, -across / up) }
}

/// Horner's scheme for value and derivative.
fn polynomial(coefficients: &[f64], s: f64) -> (f64, f64) {
    coefficients.iter().rev().fold((0.0, 0.0), |(value, slope), c| (value * s + c, slope * s + value))
}

/// Zone C with the straight ramp added that joins it to its neighbours.
///
/// As printed, its ends miss them by 1.2e-4 mm and 3.7e-5 mm; a spline through such a step would show a curvature of
/// several 1/m that is not there. The ramp takes the step out, leaves the curvature alone, and changes the slope by
/// 9e-6.
fn zone_c(s: f64) -> (f64, f64) {
    let at_start = circle(&D, C_START).0 - polynomial(&C, C_START).0;
    let at_end = polynomial(&B, B_START).0 - polynomial(&C, B_START).0;
    let ramp = (at_end - at_start) / (B_START - C_START);
    let (height, slope) = polynomial(&C, s);
    (height + at_start + ramp * (s - C_START), slope + ramp)
}

/// The S1002 over its whole width, sampled, continuous at the zone borders.
pub(super) fn s1002() -> Profile {
    let mm = |s: f64| 1e-3 * s;
    let arc = |c: &Circle, from: f64, to: f64| {
        Piece::arc([mm(c.centre[0]), mm(c.centre[1])], mm(c.radius), mm(from), mm(to), c.above)
    };
    let line = |coefficients: &[f64; 2], from: f64, to: f64| {
        let end = |s: f64| [mm(s), mm(polynomial(coefficients, s).0)];
        Piece::Line { from: end(from), to: end(to) }
    };
    let pieces = [
        arc(&H, H_START, G_START),
        arc(&G, G_START, F_START),
        arc(&F, F_START, E_START),
        line(&E, E_START, D_START),
        arc(&D, D_START, C_START),
        Piece::Graph {
            from: mm(C_START),
            to: mm(B_START),
            height: |y| 1e-3 * zone_c(1e3 * y).0,
            slope: |y| zone_c(1e3 * y).1,
        },
        Piece::Graph {
            from: mm(B_START),
            to: mm(A_START),
            height: |y| 1e-3 * polynomial(&B, 1e3 * y).0,
            slope: |y| polynomial(&B, 1e3 * y).1,
        },
        line(&A, A_START, A_END),
    ];
    profile(ProfileKind::Wheel, "s1002", "built-in: S1002 wheel, EN 13715, zones H to A, flange 28 mm high", &pieces)
}
