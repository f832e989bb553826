//! FASTSIM: Kalker's simplified theory of rolling contact on a fixed grid.

use core::f32::consts::{FRAC_PI_2, PI};

use crate::creep::{Case, CreepForces, Creepages, Elasticity, Patch};
use crate::math::{Four, greater, lesser};

/// Largest traction of adhesion over the patch's largest bound that is computed; everything slides long before.
const TRACTION_LIMIT: f32 = 1e12;

/// FASTSIM on NX elements along by NY strips across; 10 by 10 for real time, more for reference. Zero elements give no
/// force.
///
/// J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle System Dynamics 11 (1982);
/// Kalker (1990). Displacements are proportional to the tractions of their own point, with flexibilities that make
/// the sums without slip those of the linear theory:
///
/// ```text
/// L1 = 8 a / (3 G C11)     L2 = 8 a / (3 G C22)     L3 = π a² / (4 G sqrt(a b) C23)
/// ```
///
/// Material enters each strip at the leading edge without traction and runs backwards:
///
/// ```text
/// px(x - h) = px(x) - h (ξ / L1 - φ y / L3)
/// py(x - h) = py(x) - h (η / L2 + φ x / L3)
/// |p| cut to g = μ (2 N / (π a b)) (1 - x²/a² - y²/b²)
/// ```
///
/// The bound is the **parabola** with the normal force for its volume, and not Hertz's half ellipsoid: flexibilities of
/// points let traction grow linearly from the leading edge, where the ellipsoid rises steeply, so that slip would start in
/// the wrong places and come too late; under the parabola the slip grows from the trailing edge, as in the full solution.
///
/// **Second order.** Kalker's step is first order where there is slip with spin. As E. Vollebregt and P. Wilders do
/// (FASTSIM2, Computational Mechanics 47, 2011) the step is made second order, here by the two-step backward formula
/// (BDF2), which damps however far adhesion would go beyond the bound:
///
/// ```text
/// p(x) = cut( 4/3 p(x + h) - 1/3 p(x + 2h) - 2/3 h r(x) )      r = (ξ / L1 - φ y / L3, η / L2 + φ x / L3)
/// ```
///
/// The tractions stand at the elements' middles. In adhesion the steps are exact. Sums over the middles exceed
/// the integrals by 1 + 1/(2 n²) and the like; they are divided by what the grid makes of 1, so that the bound is μN and
/// the slope at small creepages Kalker's on **every** grid. The moment is that of these tractions. Four strips go at once.
#[must_use]
pub fn fastsim<const NX: usize, const NY: usize>(
    patch: &Patch,
    elasticity: &Elasticity,
    creepages: &Creepages,
    friction: f32,
) -> CreepForces {
    if NX == 0 || NY == 0 {
        return CreepForces::NONE;
    }
    let case = Case::new(patch, elasticity, creepages, friction);
    let sums = Tractions::new(&case, Grid::new(NX, NY)).sums(NX);
    sums.within(case.bound).only_if(case.valid)
}

/// The grid's own numbers, in the unit square.
#[derive(Clone, Copy)]
struct Grid {
    /// Strips.
    strips: usize,
    /// Length of an element over the half length of its strip; width of a strip over b.
    step: [f32; 2],
    /// Σ (1 - v²)^1.5 dv over the strips, exactly 3π/8.
    cubes: f32,
}

impl Grid {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "counts of elements")]
    fn new(elements: usize, strips: usize) -> Self {
        let step = [2.0 / elements as f32, 2.0 / strips as f32];
        let mut grid = Self { strips, step, cubes: 0.0 };
        let mut sum = Four::all(0.0);
        for group in 0..strips.div_ceil(4) {
            let (_, squared, _) = grid.strips(group);
            sum = sum + squared * squared.sqrt();
        }
        grid.cubes = total(sum) * step[1];
        grid
    }

    /// Four strips: v = y/b, 1 - v² and 1 where there is a strip; strips beyond the last have no length.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "counts of elements")]
    fn strips(&self, group: usize) -> (Four, Four, Four) {
        let number = [0, 1, 2, 3].map(|i| 4 * group + i);
        let v = Four::load(&number.map(|n| (n as f32 + 0.5) * self.step[1] - 1.0));
        let real = Four::load(&number.map(|n| if n < self.strips { 1.0 } else { 0.0 }));
        (v, (Four::all(1.0) - v * v).at_least(Four::all(0.0)) * real, real)
    }
}

/// The problem over μ (2 N / (π a b)): tractions p, lengths over a strip's half length or b.
struct Tractions {
    grid: Grid,
    /// Tractions of adhesion of the whole length a, by ξ, by η and by φ (a for the length).
    adhesion: [Four; 3],
    /// b / a
    slenderness: Four,
    /// Bound at the centre.
    bound: Four,
    /// Force and moment of the sums.
    force: f32,
    moment: f32,
}

impl Tractions {
    #[inline(always)]
    fn new(case: &Case, grid: Grid) -> Self {
        let Creepages { longitudinal: xi, lateral: eta, spin: phi } = case.creepages;
        let c = &case.coefficients;
        let [ds, dv] = grid.step;
        // a / (L p0) = (3/8) G C / p0 with p0 = 2 μ N / (π a b), so that G / p0 = (π/2) G a b / (μ N)
        let unit = FRAC_PI_2 * case.unit / case.bound;
        // a² / (L3 p0) = (4/π) sqrt(a b) C23 G / p0
        let spin = 4.0 / PI * case.mean * c.c23 * unit * phi;
        // What the grid makes of 1: of ∫ 2 (1 - v²) dv, and of ∫∫ (1 - s²) ds (1 - v²)^1.5 dv.
        let lines = 1.0 / (1.0 + 0.125 * dv * dv);
        let volume = (3.0 * PI / 8.0) / ((1.0 + 0.125 * ds * ds) * grid.cubes);
        let held = |x: f32| Four::all(lesser(greater(x, -TRACTION_LIMIT), TRACTION_LIMIT));
        Self {
            grid,
            adhesion: [
                held(0.375 * c.c11 * unit * xi * lines),
                held(0.375 * c.c22 * unit * eta * lines),
                held(spin * volume),
            ],
            slenderness: Four::all(case.b / case.a),
            bound: Four::all(volume),
            // p0 a b ds dv
            force: case.bound / FRAC_PI_2 * ds * dv,
            moment: case.a,
        }
    }

    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "counts of elements")]
    fn sums(&self, elements: usize) -> CreepForces {
        let all = Four::all;
        let [ds, _] = self.grid.step;
        let [along, across, spin] = self.adhesion;
        let tiny = all(1e-30);
        let (mut fx, mut fy, mut mz) = (all(0.0), all(0.0), all(0.0));
        for group in 0..self.grid.strips.div_ceil(4) {
            let (v, squared, real) = self.grid.strips(group);
            // Half length of the strip over a, and y over a.
            let half = squared.sqrt();
            let y = v * self.slenderness * real;
            let top = self.bound * squared;
            // Growth over a length: px by half (ξ' - φ' y), py by half (η' + φ' x), x = half s.
            let growth = half * (along - spin * y);
            let (constant, linear) = (half * across, half * half * spin);
            let (mut px, mut py, mut mx, mut my) = (all(0.0), all(0.0), all(0.0), all(0.0));
            let mut moment = all(0.0);
            let (mut qx, mut qy) = (px, py);
            for element in 0..elements {
                let s = 1.0 - (element as f32 + 0.5) * ds;
                let Step { last, before, length, place } = Step::of(element, s, ds);
                let (last, before, h) = (all(last), all(before), all(length));
                // Tractions of adhesion from the last two points.
                let nx = last * px - before * qx - h * growth;
                let ny = last * py - before * qy - h * (constant + linear * all(place));
                // |p| cut to g (1 - s²)
                let bound = top * all(1.0 - s * s);
                let size = (nx * nx + ny * ny).sqrt();
                let factor = bound / size.at_least(bound).at_least(tiny);
                (qx, qy) = (px, py);
                px = nx * factor;
                py = ny * factor;
                mx = mx + px;
                my = my + py;
                moment = moment + all(s) * py;
            }
            fx = fx + half * mx;
            fy = fy + half * my;
            // Mz = Σ (x py - y px)
            mz = mz + half * (half * moment - y * mx);
        }
        CreepForces {
            longitudinal: self.force * total(fx),
            lateral: self.force * total(fy),
            spin_moment: self.force * self.moment * total(mz),
        }
    }
}

/// One step backwards: p(s) = last p(s + ds) - before p(s + 2 ds) - length r(place), r the growth over a length.
struct Step {
    last: f32,
    before: f32,
    length: f32,
    place: f32,
}

impl Step {
    /// The first step is from the edge to the first middle, the second twice as long as it; from then on they are equal.
    #[inline(always)]
    fn of(element: usize, s: f32, ds: f32) -> Self {
        match element {
            0 => Self { last: 1.0, before: 0.0, length: 0.5 * ds, place: 1.0 - 0.25 * ds },
            // Its point before is the edge, without traction.
            1 => Self { last: 9.0 / 5.0, before: 0.0, length: 3.0 / 5.0 * ds, place: s },
            _ => Self { last: 4.0 / 3.0, before: 1.0 / 3.0, length: 2.0 / 3.0 * ds, place: s },
        }
    }
}

/// Sum of four numbers.
#[inline(always)]
fn total(x: Four) -> f32 {
    let [a, b, c, d] = x.numbers();
    (a + b) + (c + d)
}
