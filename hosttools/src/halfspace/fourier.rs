//! Fast Fourier transforms of single precision, eight side by side.
//!
//! Every lane is a transform of its own, so the compiler makes vectors of them without being asked, and plain additions
//! and multiplications in a fixed order give the same bits on every machine. Forward transforms leave their numbers in
//! the order of reversed digits, backward ones take them from there: nothing is sorted, since a convolution does not care.

use std::f64::consts::TAU;

/// Transforms side by side.
pub(super) const LANES: usize = 8;

/// One number of each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes {
    pub(super) re: [f32; LANES],
    pub(super) im: [f32; LANES],
}

impl Lanes {
    pub(super) const ZERO: Self = Self { re: [0.0; LANES], im: [0.0; LANES] };

    #[inline(always)]
    fn lane(&self, l: usize) -> Number {
        Number { re: self.re[l], im: self.im[l] }
    }

    #[inline(always)]
    fn put(&mut self, l: usize, number: Number) {
        self.re[l] = number.re;
        self.im[l] = number.im;
    }
}

/// A complex number of one lane.
#[derive(Debug, Clone, Copy)]
struct Number {
    re: f32,
    im: f32,
}

impl Number {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }

    #[inline(always)]
    fn scaled(self, factor: f32) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    /// Times i, or -i.
    #[inline(always)]
    fn turned<const BACK: bool>(self) -> Self {
        if BACK { Self { re: -self.im, im: self.re } } else { Self { re: self.im, im: -self.re } }
    }

    /// Times exp(iφ), given by cos φ and sin φ, or exp(-iφ).
    #[inline(always)]
    fn by<const BACK: bool>(self, [cos, sin]: [f32; 2]) -> Self {
        let (re, im) = (self.re, self.im);
        if BACK {
            Self { re: re * cos + im * sin, im: im * cos - re * sin }
        } else {
            Self { re: re * cos - im * sin, im: re * sin + im * cos }
        }
    }
}

/// One stage: blocks of `radix` x `stride` numbers, each `stride` apart transformed among themselves and turned.
#[derive(Debug, Clone)]
struct Stage {
    radix: usize,
    stride: usize,
    /// exp(-2πi j q / (radix stride)), q from 1, for each j in turn.
    turns: Vec<[f32; 2]>,
}

/// Transforms of one length, a multiple of four without prime factors beyond 5.
#[derive(Debug, Clone)]
pub(super) struct Fourier {
    length: usize,
    stages: Vec<Stage>,
    /// Where each frequency is left.
    places: Vec<usize>,
}

/// The smallest multiple of four, of at least `n`, without prime factors beyond 5.
pub(super) fn smooth(n: usize) -> usize {
    let is_smooth = |mut m: usize| {
        for p in [2, 3, 5] {
            while m.is_multiple_of(p) {
                m /= p;
            }
        }
        m == 1
    };
    (n.div_ceil(4).max(1)..).map(|m| 4 * m).find(|&m| is_smooth(m)).unwrap_or(n)
}

impl Fourier {
    /// For a length that [`smooth`] gives.
    pub(super) fn new(length: usize) -> Self {
        let mut stages: Vec<Stage> = Vec::new();
        let mut stride = length;
        while stride > 1 {
            let radix = [4, 5, 3, 2].into_iter().find(|&r| stride.is_multiple_of(r)).unwrap_or(stride);
            let block = stride;
            stride /= radix;
            let turn = |j: usize, q: usize| {
                let angle = -TAU * (j * q % block) as f64 / block as f64;
                [libm::cos(angle) as f32, libm::sin(angle) as f32]
            };
            let turns = (0..stride).flat_map(|j| (1..radix).map(move |q| turn(j, q))).collect();
            stages.push(Stage { radix, stride, turns });
        }
        let place = |mut k: usize| {
            let mut place = 0;
            for stage in &stages {
                place += k % stage.radix * stage.stride;
                k /= stage.radix;
            }
            place
        };
        let places = (0..length).map(place).collect();
        Self { length, stages, places }
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// Where the number of a frequency is after [`Fourier::forward`].
    pub(super) fn place(&self, frequency: usize) -> usize {
        self.places[frequency]
    }

    /// Σ_j x_j exp(-2πi j k / n), of which x_j from `filled` on are nothing, whatever stands there.
    pub(super) fn forward(&self, data: &mut [Lanes], filled: usize) {
        let [first, later @ ..] = self.stages.as_slice() else { return };
        if first.radix == 4 && filled <= 2 * first.stride {
            data[filled..2 * first.stride].fill(Lanes::ZERO);
            for ([a, b, c, d], w) in first.quarters(data) {
                four_of_two(a, b, c, d, w);
            }
        } else {
            data[filled..].fill(Lanes::ZERO);
            first.run::<false>(data);
        }
        for stage in later {
            stage.run::<false>(data);
        }
    }

    /// n times the inverse; only the first `wanted` numbers are right afterwards.
    pub(super) fn backward(&self, data: &mut [Lanes], wanted: usize) {
        let [first, later @ ..] = self.stages.as_slice() else { return };
        for stage in later.iter().rev() {
            stage.run::<true>(data);
        }
        if first.radix == 4 && wanted <= 2 * first.stride {
            for ([a, b, c, d], w) in first.quarters(data) {
                two_of_four(a, b, c, d, w);
            }
        } else {
            first.run::<true>(data);
        }
    }
}

impl Stage {
    /// The numbers of a single block of four that belong together, and their turns.
    #[inline(always)]
    fn quarters<'a>(&'a self, data: &'a mut [Lanes]) -> impl Iterator<Item = ([&'a mut Lanes; 4], &'a [[f32; 2]; 3])> {
        let (low, high) = data.split_at_mut(2 * self.stride);
        let ((a, b), (c, d)) = (low.split_at_mut(self.stride), high.split_at_mut(self.stride));
        let parts = a.iter_mut().zip(b).zip(c).zip(d).zip(self.turns.as_chunks().0);
        parts.map(|((((a, b), c), d), w)| ([a, b, c, d], w))
    }

    fn run<const BACK: bool>(&self, data: &mut [Lanes]) {
        let stride = self.stride;
        for block in data.chunks_exact_mut(self.radix * stride) {
            let (first, rest) = block.split_at_mut(stride);
            let (second, rest) = rest.split_at_mut(stride);
            let parts = first.iter_mut().zip(second);
            match self.radix {
                2 => {
                    for ((a, b), w) in parts.zip(&self.turns) {
                        two::<BACK>(a, b, *w);
                    }
                }
                3 => {
                    for (((a, b), c), w) in parts.zip(rest).zip(self.turns.as_chunks().0) {
                        three::<BACK>(a, b, c, w);
                    }
                }
                4 => {
                    let (third, fourth) = rest.split_at_mut(stride);
                    for ((((a, b), c), d), w) in parts.zip(third).zip(fourth).zip(self.turns.as_chunks().0) {
                        four::<BACK>(a, b, c, d, w);
                    }
                }
                _ => {
                    let (third, rest) = rest.split_at_mut(stride);
                    let (fourth, fifth) = rest.split_at_mut(stride);
                    let parts = parts.zip(third).zip(fourth).zip(fifth);
                    for (((((a, b), c), d), e), w) in parts.zip(self.turns.as_chunks().0) {
                        five::<BACK>(a, b, c, d, e, w);
                    }
                }
            }
        }
    }
}

// Forward, what comes out is turned; backward, what goes in.

#[inline(always)]
fn two<const BACK: bool>(a: &mut Lanes, b: &mut Lanes, w: [f32; 2]) {
    for l in 0..LANES {
        let (x, y) = (a.lane(l), b.lane(l));
        if BACK {
            let y = y.by::<BACK>(w);
            a.put(l, x.plus(y));
            b.put(l, x.minus(y));
        } else {
            a.put(l, x.plus(y));
            b.put(l, x.minus(y).by::<BACK>(w));
        }
    }
}

#[inline(always)]
fn three<const BACK: bool>(a: &mut Lanes, b: &mut Lanes, c: &mut Lanes, w: &[[f32; 2]; 2]) {
    const SIN: f32 = 0.866_025_4;
    for l in 0..LANES {
        let (x, mut y, mut z) = (a.lane(l), b.lane(l), c.lane(l));
        if BACK {
            (y, z) = (y.by::<BACK>(w[0]), z.by::<BACK>(w[1]));
        }
        let (sum, turned) = (y.plus(z), y.minus(z).scaled(SIN).turned::<BACK>());
        let middle = x.minus(sum.scaled(0.5));
        (y, z) = (middle.plus(turned), middle.minus(turned));
        if !BACK {
            (y, z) = (y.by::<BACK>(w[0]), z.by::<BACK>(w[1]));
        }
        a.put(l, x.plus(sum));
        b.put(l, y);
        c.put(l, z);
    }
}

#[inline(always)]
fn four<const BACK: bool>(a: &mut Lanes, b: &mut Lanes, c: &mut Lanes, d: &mut Lanes, w: &[[f32; 2]; 3]) {
    for l in 0..LANES {
        let mut x = [a.lane(l), b.lane(l), c.lane(l), d.lane(l)];
        if BACK {
            x = [x[0], x[1].by::<BACK>(w[0]), x[2].by::<BACK>(w[1]), x[3].by::<BACK>(w[2])];
        }
        let (sum, difference) = (x[0].plus(x[2]), x[0].minus(x[2]));
        let (other, turned) = (x[1].plus(x[3]), x[1].minus(x[3]).turned::<BACK>());
        x = [sum.plus(other), difference.plus(turned), sum.minus(other), difference.minus(turned)];
        if !BACK {
            x = [x[0], x[1].by::<BACK>(w[0]), x[2].by::<BACK>(w[1]), x[3].by::<BACK>(w[2])];
        }
        a.put(l, x[0]);
        b.put(l, x[1]);
        c.put(l, x[2]);
        d.put(l, x[3]);
    }
}

/// As [`four`] forward, where the last two are nothing.
#[inline(always)]
fn four_of_two(a: &mut Lanes, b: &mut Lanes, c: &mut Lanes, d: &mut Lanes, w: &[[f32; 2]; 3]) {
    for l in 0..LANES {
        let (x, y) = (a.lane(l), b.lane(l));
        let turned = y.turned::<false>();
        a.put(l, x.plus(y));
        b.put(l, x.plus(turned).by::<false>(w[0]));
        c.put(l, x.minus(y).by::<false>(w[1]));
        d.put(l, x.minus(turned).by::<false>(w[2]));
    }
}

/// As [`four`] backward, where the last two are not wanted.
#[inline(always)]
fn two_of_four(a: &mut Lanes, b: &mut Lanes, c: &Lanes, d: &Lanes, w: &[[f32; 2]; 3]) {
    for l in 0..LANES {
        let [x, y] = [a.lane(l), b.lane(l).by::<true>(w[0])];
        let [z, v] = [c.lane(l).by::<true>(w[1]), d.lane(l).by::<true>(w[2])];
        a.put(l, x.plus(z).plus(y.plus(v)));
        b.put(l, x.minus(z).plus(y.minus(v).turned::<true>()));
    }
}

#[inline(always)]
fn five<const BACK: bool>(
    a: &mut Lanes,
    b: &mut Lanes,
    c: &mut Lanes,
    d: &mut Lanes,
    e: &mut Lanes,
    w: &[[f32; 2]; 4],
) {
    const COS: [f32; 2] = [0.309_017, -0.809_017];
    const SIN: [f32; 2] = [0.951_056_5, 0.587_785_25];
    for l in 0..LANES {
        let mut x = [b.lane(l), c.lane(l), d.lane(l), e.lane(l)];
        let first = a.lane(l);
        if BACK {
            x = [x[0].by::<BACK>(w[0]), x[1].by::<BACK>(w[1]), x[2].by::<BACK>(w[2]), x[3].by::<BACK>(w[3])];
        }
        let (s1, s2) = (x[0].plus(x[3]), x[1].plus(x[2]));
        let (d1, d2) = (x[0].minus(x[3]).turned::<BACK>(), x[1].minus(x[2]).turned::<BACK>());
        let near = first.plus(s1.scaled(COS[0])).plus(s2.scaled(COS[1]));
        let far = first.plus(s1.scaled(COS[1])).plus(s2.scaled(COS[0]));
        let near_turned = d1.scaled(SIN[0]).plus(d2.scaled(SIN[1]));
        let far_turned = d1.scaled(SIN[1]).minus(d2.scaled(SIN[0]));
        x = [near.plus(near_turned), far.plus(far_turned), far.minus(far_turned), near.minus(near_turned)];
        if !BACK {
            x = [x[0].by::<BACK>(w[0]), x[1].by::<BACK>(w[1]), x[2].by::<BACK>(w[2]), x[3].by::<BACK>(w[3])];
        }
        a.put(l, first.plus(s1).plus(s2));
        b.put(l, x[0]);
        c.put(l, x[1]);
        d.put(l, x[2]);
        e.put(l, x[3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_length_against_the_sum_and_there_and_back() {
        for length in [4, 8, 12, 20, 24, 36, 40, 60, 100, 108, 128, 180, 300] {
            assert_eq!(smooth(length - 1), length);
            let fourier = Fourier::new(length);
            for filled in [length, length / 2, length / 3 + 1] {
                let value = |j: usize, l: usize| libm::sin((j * (3 + l)) as f64);
                let number = |j: usize| Lanes {
                    re: std::array::from_fn(|l| if j < filled { value(j, l) as f32 } else { 7.0 }),
                    im: std::array::from_fn(|l| if j < filled { value(j, l + 9) as f32 } else { 7.0 }),
                };
                let mut data: Vec<Lanes> = (0..length).map(number).collect();
                fourier.forward(&mut data, filled);
                for k in 0..length {
                    let found = data[fourier.place(k)];
                    for l in [0, LANES - 1] {
                        let mut sum = [0.0; 2];
                        for j in 0..filled {
                            let (sin, cos) = libm::sincos(-TAU * (j * k % length) as f64 / length as f64);
                            let (re, im) = (value(j, l), value(j, l + 9));
                            sum = [sum[0] + re * cos - im * sin, sum[1] + re * sin + im * cos];
                        }
                        let apart = libm::hypot(f64::from(found.re[l]) - sum[0], f64::from(found.im[l]) - sum[1]);
                        assert!(apart < 3e-6 * (length as f64).sqrt(), "{length} {filled} {k} {apart}");
                    }
                }
                fourier.backward(&mut data, filled);
                for (j, found) in data.iter().enumerate().take(filled) {
                    let apart = f64::from(found.im[3]) / length as f64 - value(j, 12);
                    assert!(apart.abs() < 2e-6, "{length} {filled} {j} {apart}");
                }
            }
        }
    }
}
