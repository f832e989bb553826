//! The two integrals of the strips' influence, tabulated.

use std::f64::consts::FRAC_PI_2;
use std::sync::OnceLock;

use crate::hertz::elliptic;

/// G and H, tabulated over √ρ.
pub(super) struct Integrals {
    values: Vec<[f64; 2]>,
}

/// Nodes of the table, and the ρ it ends at: beyond, g is π / 2ρ and H constant.
const NODES: usize = 4096;
const END: f64 = ROOT_END * ROOT_END;
const ROOT_END: f64 = 8.0;

impl Integrals {
    pub(super) fn table() -> &'static Self {
        static TABLE: OnceLock<Integrals> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let step = ROOT_END / NODES as f64;
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
    #[inline]
    pub(super) fn at(&self, rho: f64) -> [f64; 2] {
        let size = rho.abs();
        let found = if size >= END {
            let [g, h] = self.values[NODES];
            [g + FRAC_PI_2 * libm::log(size / END), h]
        } else {
            let place = size.sqrt() * (NODES as f64 / ROOT_END);
            let i = (place as usize).min(NODES - 1);
            let (low, high, share) = (self.values[i], self.values[i + 1], place - i as f64);
            [low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1])]
        };
        if rho < 0.0 { found.map(|v| -v) } else { found }
    }
}
