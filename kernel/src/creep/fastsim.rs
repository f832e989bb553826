//! FASTSIM: Kalker's simplified theory of rolling contact on a fixed grid.

use core::f32::consts::{FRAC_1_SQRT_2, PI};

use crate::creep::{Case, CreepForces, Creepages, Elasticity, Forces, Patch};
use crate::math::{Four, greater, lesser, sqrt};

/// FASTSIM on NX elements along by NY strips across, its tractions under Hertz's half ellipsoid by strip theory; 10 by 10
/// for real time, more for reference. Zero elements give no force.
///
/// J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle System Dynamics 11 (1982). Material
/// enters each strip at the leading edge without traction and runs backwards; displacements are proportional to the
/// tractions of their own point, which are cut to a parabola g = 1 - x²/a² - y²/b² (in units of its top):
///
/// ```text
/// p(x - h) = cut( p(x) - (h/a) r(x) )
/// r = (k1 ξ - k3 φ y, k2 η + k3 φ x)      k1 = κ U C11,  k2 = κ U C22,  k3 = 2 U C23 sqrt(b / a),  κ = 8 / (3 π)
/// ```
///
/// with U = G a b / (μ N). Along a strip of half length l the parabola to flexibilities of points is what the ellipse is to
/// an elastic half-plane: either makes a displacement whose slope is linear. So slip and direction are FASTSIM's, and
/// tractions the ellipsoid's, as in **FaStrip** (M. Sh. Sichani, R. Enblom, M. Berg, An alternative to FASTSIM for
/// tangential solution of the wheel-rail contact, Vehicle System Dynamics 54, 2016). With s = x/l, p/g' the share of the
/// ellipsoid's g', c = (r without its x) a / l, ψ = U C23 sqrt(a b) φ and e the 1 + s at which p reaches g:
///
/// ```text
/// slip:      p/g' = p/g
/// adhesion:  p/g' = -(0, ψ) - (c/e) (1 - sqrt(1 - e / (1 + s)))      in place of  p/g = -(0, ψ) - c / (1 + s)
/// e:         |c/e + (0, ψ)| = 1
/// ```
///
/// That is the strip theory of J. J. Kalker (A strip theory for rolling with slip and spin, Proc. Kon. Ned. Akad. Wet. B70,
/// 1967; Carter's solution where there is no spin) with C11, C22 and C23 of the ellipse, whose forces at small creepages
/// are Kalker's linear ones on **every** grid. From |ψ| = 1 on spin alone slides, and e is taken with |ψ| = 1.
///
/// **In slip** growth has one flexibility, so that it has the slip's own direction; Kalker (1982) weights the three by the
/// creepages, here all are the lateral one's, which the comparison below favours:
///
/// ```text
/// r = k (ξ - φ y, η + φ x)      k = k2 sqrt(ξ² + η² + a b φ²) / (sqrt(ξ² + η²) + sqrt(a b) |φ|)
/// ```
///
/// **Second order.** Kalker's step is first order where there is slip with spin. As E. Vollebregt and P. Wilders do
/// (FASTSIM2, Computational Mechanics 47, 2011) the step is made second order, here by the two-step backward formula
/// (BDF2), which damps however far adhesion would go beyond the bound:
///
/// ```text
/// p(x) = cut( 4/3 p(x + h) - 1/3 p(x + 2h) - 2/3 (h/a) r(x) )
/// ```
///
/// The tractions stand at the elements' middles; in adhesion the steps are exact, and sums over p/g' leave out
/// sqrt(1 - e / (1 + s)), whose integral over the ellipse is closed: π/2 (1 - e/2)², its centre at e/2. Four strips go at
/// once.
///
/// **Measured** on 20 by 20 against the half-space of `tests/creep_half_space.rs`, 275 cases, a/b from 0.2 to 5: the force's
/// size within 3.4 % without spin, 7 % with spin that helps the creepages (a/b = 0.2: 11.5 %), 11.8 % in pure spin; where
/// spin opposes the lateral creepage the force is a difference, within 16 % of μN. CONTACT's printed cases within 2.7 %.
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
    let case = Case::of(patch, elasticity, creepages, friction);
    let sums = Tractions::new(&case, Grid::<NX>::new(NY)).sums();
    sums.within(case.bound).times(case.valid).into()
}

/// Largest growth of the traction over the patch's largest bound that is computed; everything slides long before.
const TRACTION_LIMIT: f32 = 1e12;

/// κ: growth of a strip's traction over the linear force.
const STRIP: f32 = 8.0 / (3.0 * PI);

/// The grid's own numbers, in the unit square.
struct Grid<const NX: usize> {
    /// Strips.
    strips: usize,
    /// Length of an element over the half length of its strip.
    length: f32,
    /// Width of a strip over b.
    width: f32,
    /// Elements from the leading edge on, every strip's.
    elements: [Element; NX],
    /// Σ sqrt(1 - s²) over a strip's elements.
    ellipse: f32,
    /// Σ sqrt(1 - v²) and Σ (1 - v²) over the strips.
    halves: f32,
    squares: f32,
}

/// An element at its middle s.
struct Element {
    /// sqrt(1 - s²): the ellipse, whose square is the parabola.
    ellipse: f32,
    /// sqrt(1 - s²) / (1 + s)
    growth: f32,
}

impl<const NX: usize> Grid<NX> {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "counts of elements")]
    fn new(strips: usize) -> Self {
        let [length, width] = [2.0 / NX as f32, 2.0 / strips as f32];
        let elements = core::array::from_fn(|element| {
            let s = 1.0 - (element as f32 + 0.5) * length;
            let ellipse = sqrt(1.0 - s * s);
            Element { ellipse, growth: ellipse / (1.0 + s) }
        });
        let ellipse = elements.iter().fold(0.0, |sum, element| sum + element.ellipse);
        let mut grid = Self { strips, length, width, elements, ellipse, halves: 0.0, squares: 0.0 };
        let (mut halves, mut squares) = (Four::all(0.0), Four::all(0.0));
        for group in 0..strips.div_ceil(4) {
            let (_, squared) = grid.strips(group);
            halves = halves + squared.sqrt();
            squares = squares + squared;
        }
        (grid.halves, grid.squares) = (total(halves), total(squares));
        grid
    }

    /// Four strips: v = y/b and 1 - v²; strips beyond the last have no length.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "counts of elements")]
    fn strips(&self, group: usize) -> (Four, Four) {
        let number = Four::all((4 * group) as f32) + Four::load(&[0.5, 1.5, 2.5, 3.5]);
        let v = number * Four::all(self.width) - Four::all(1.0);
        (v, (Four::all(1.0) - v * v).at_least(Four::all(0.0)))
    }
}

/// r, growth of the traction backwards over a length a: by ξ, by η, and by φ a.
#[derive(Clone, Copy)]
struct Growth([Four; 3]);

impl Growth {
    #[inline(always)]
    fn new(each: [f32; 3]) -> Self {
        Self(each.map(|x| Four::all(lesser(greater(x, -TRACTION_LIMIT), TRACTION_LIMIT))))
    }

    /// On strips over their half length: along, across, and across by the place s.
    #[inline(always)]
    fn on(&self, half: Four, y: Four) -> [Four; 3] {
        let [along, across, spin] = self.0;
        [half * (along - spin * y), half * across, half * half * spin]
    }
}

/// The problem over the parabola's largest bound, lengths over a strip's half length or b.
struct Tractions<const NX: usize> {
    grid: Grid<NX>,
    adhesion: Growth,
    slip: Growth,
    /// ψ, at most one: what spin alone makes of the bound in adhesion.
    spin: Four,
    /// b / a
    slenderness: Four,
    /// Force and moment of the sums.
    force: f32,
    moment: f32,
}

impl<const NX: usize> Tractions<NX> {
    #[inline(always)]
    fn new(case: &Case<f32>, grid: Grid<NX>) -> Self {
        // The unit of linear forces over μ N.
        let Case { xi, eta, turn, stiffness: unit, flexibilities, .. } = *case;
        let [c11, c22, c23] = flexibilities.map(|flexibility| 1.0 / flexibility);
        let psi = unit * c23 * turn;
        // What the grid makes of κ U
        let strip = unit * grid.squares / grid.halves;
        // k / k2, from 1/√2 to 1
        let line = xi * xi + eta * eta;
        let share = sqrt(line + turn * turn) / greater(sqrt(line) + turn.abs(), 1e-30);
        let slip = STRIP * unit * c22 * greater(share, FRAC_1_SQRT_2);
        Self {
            adhesion: Growth::new([strip * c11 * xi, strip * c22 * eta, 2.0 * psi]),
            slip: Growth::new([slip * xi, slip * eta, slip * (case.slenderness * turn)]),
            spin: Four::all(lesser(greater(psi, -1.0), 1.0)),
            slenderness: Four::all(case.inverse),
            force: case.bound / (grid.squares * grid.ellipse),
            moment: case.a,
            grid,
        }
    }

    #[inline(always)]
    fn sums(&self) -> Forces<f32> {
        let all = Four::all;
        let (mut fx, mut fy, mut mz) = (all(0.0), all(0.0), all(0.0));
        for group in 0..self.grid.strips.div_ceil(4) {
            let (v, squared) = self.grid.strips(group);
            // Half length of the strip over a, and y over a.
            let (half, y) = (squared.sqrt(), v * self.slenderness);
            let (adhesion, slip) = (self.adhesion.on(half, y), self.slip.on(half, y));
            let edge = self.edge(&adhesion, squared);
            let [along, across, moment] = self.strip(&adhesion, &slip, squared, edge);
            fx = fx + along;
            fy = fy + across;
            // Mz = Σ (x py - y px)
            mz = mz + half * moment - y * along;
        }
        Forces([self.force * total(fx), self.force * total(fy), self.force * self.moment * total(mz)])
    }

    /// 1 / e, with 1 + s = e where adhesion ends: |c / e + (0, ψ)| = 1 for the growth c over the strip's bound.
    ///
    /// ```text
    /// 1 / e = (sqrt(cy² + (1 - ψ²) cx²) - ψ cy) / |c|²
    /// ```
    #[inline(always)]
    fn edge(&self, [along, across, _]: &[Four; 3], squared: Four) -> Four {
        let (along, across, psi) = (*along, *across, self.spin);
        let (along_squared, across_squared) = (along * along, across * across);
        let rest = Four::all(1.0) - psi * psi;
        let root = (across_squared + rest * along_squared).sqrt();
        // Without growth all is adhesion, unless spin alone slides.
        let (little, least) = (Four::all(1e-15), Four::all(1e-30));
        let size = (root - psi * across).at_least(little * rest);
        squared * size / (along_squared + across_squared + least)
    }

    /// Sums of the strips' tractions px, py, and s py.
    #[inline(always)]
    fn strip(&self, adhesion: &[Four; 3], slip: &[Four; 3], squared: Four, edge: Four) -> [Four; 3] {
        let all = Four::all;
        let zero = all(0.0);
        let Grid { length, ellipse, ref elements, .. } = self.grid;
        // Growth over a step, 2/3 of an element, in slip, and what adhesion has more; across at the element's middle.
        let step = all(2.0 / 3.0 * length);
        let [slip_x, slip_y, slip_s] = slip.map(|growth| step * growth);
        let more = |adhesion: Four, slip: Four| step * adhesion - slip;
        let [more_x, more_y, more_s] =
            [more(adhesion[0], slip_x), more(adhesion[1], slip_y), more(adhesion[2], slip_s)];
        let (first, length) = (all(1.0 - 0.25 * length), all(length));
        let (mut slip_y, mut more_y) = (slip_y + first * slip_s, more_y + first * more_s);
        let (slip_s, more_s) = (length * slip_s, length * more_s);
        // Elements from the middle of this one to the end of adhesion, and half of one.
        let mut left = (all(2.0) - all(1.0) / edge.at_least(all(1e-20))) / length;
        // Strips of no length have no traction; a bound all the same, to divide by.
        let top = squared + all(1e-30);
        let (mut p, mut q, mut sums, mut stuck) = ([zero; 2], [zero; 2], [zero; 3], [zero; 2]);
        let mut advance = |element: &Element, step: Step| {
            let [last, before, step, fall] = [step.last, step.before, step.step, step.fall].map(all);
            // Share of the element in adhesion, and the growth.
            let share = left.at_least(zero).at_most(all(1.0));
            let growth_x = slip_x + share * more_x;
            let growth_y = slip_y + share * more_y;
            let nx = last * p[0] - before * q[0] - step * growth_x;
            let ny = last * p[1] - before * q[1] - step * growth_y;
            // |p| cut to the parabola, and the same ratio to the ellipse
            let ellipse = all(element.ellipse);
            let bound = top * ellipse;
            let parabola = bound * ellipse;
            let ratio = bound / (nx * nx + ny * ny).sqrt().at_least(parabola);
            let factor = ratio * ellipse;
            (q, p) = (p, [nx * factor, ny * factor]);
            let across = sums[1] + ny * ratio;
            sums = [sums[0] + nx * ratio, across, sums[2] + across];
            let ending = stuck[0] + all(element.growth).at_most(ellipse * edge);
            stuck = [ending, stuck[1] + ending];
            (left, slip_y, more_y) = (left - all(1.0), slip_y - fall * slip_s, more_y - fall * more_s);
        };
        let mut elements = elements.iter();
        if let Some(element) = elements.next() {
            // From the edge to the first middle.
            advance(element, Step { last: 1.0, before: 0.0, step: 0.75, fall: 1.25 });
        }
        if let Some(element) = elements.next() {
            // Twice as long as the first; its point before is the edge, without traction.
            advance(element, Step { last: 9.0 / 5.0, before: 0.0, step: 9.0 / 10.0, fall: 1.0 });
        }
        let step = Step { last: 4.0 / 3.0, before: 1.0 / 3.0, step: 1.0, fall: 1.0 };
        let mut pairs = elements.as_slice().chunks_exact(2);
        for pair in &mut pairs {
            for element in pair {
                advance(element, step);
            }
        }
        for element in pairs.remainder() {
            advance(element, step);
        }
        // Sums of sums, the first element n times to the last once: s is that times its length, less 1 + ds/2.
        let first_moment = |once: Four, sums: Four| length * sums - (all(1.0) + all(0.5) * length) * once;
        // Adhesion: the strip's tractions for the simplified theory's.
        let held = edge.at_least(all(0.5));
        let whole = (all(1.0) - all(0.25) / held) * (edge + edge).at_most(all(1.0));
        let left = all(1.0) - all(0.5) / held;
        let force = all(ellipse) * whole - stuck[0];
        let moment = all(0.5 * ellipse) * left * left + first_moment(stuck[0], stuck[1]);
        let [growth_x, growth_y, _] = *adhesion;
        [sums[0] - growth_x * force, sums[1] - growth_y * force, first_moment(sums[1], sums[2]) + growth_y * moment]
    }
}

/// One step backwards: p(s) = last p(s + ds) - before p(s + 2 ds) - step r, r the growth over 2/3 of an element, whose
/// next place is so many elements on.
#[derive(Clone, Copy)]
struct Step {
    last: f32,
    before: f32,
    step: f32,
    fall: f32,
}

/// Sum of four numbers.
#[inline(always)]
fn total(x: Four) -> f32 {
    let [a, b, c, d] = x.numbers();
    (a + b) + (c + d)
}
