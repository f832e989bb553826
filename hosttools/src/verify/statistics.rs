//! Quantiles of errors.

/// The usual figures of a set of errors.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Quantiles {
    /// Root mean square.
    pub rms: f64,
    /// Median.
    pub median: f64,
    /// 95 % quantile.
    pub p95: f64,
    /// 99 % quantile.
    pub p99: f64,
    /// Largest.
    pub max: f64,
}

impl Quantiles {
    /// Figures of these values; all zero without any.
    pub fn of(mut values: Vec<f64>) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        values.sort_by(f64::total_cmp);
        let mean_square = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        let at = |q| quantile(&values, q);
        Self { rms: mean_square.sqrt(), median: at(0.5), p95: at(0.95), p99: at(0.99), max: at(1.0) }
    }
}

/// Quantile of sorted values, linear between neighbours; 0 without any.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let position = q * sorted.len().saturating_sub(1) as f64;
    let low = position.floor() as usize;
    let (Some(a), b) = (sorted.get(low), sorted.get(low + 1)) else { return 0.0 };
    a + (b.unwrap_or(a) - a) * (position - low as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_ramp() {
        let q = Quantiles::of((0..=100).map(f64::from).collect());
        assert_eq!((q.median, q.p95, q.p99, q.max), (50.0, 95.0, 99.0, 100.0));
        assert!((q.rms - f64::sqrt(3350.0)).abs() < 1e-12);
        assert_eq!(Quantiles::of(vec![]), Quantiles::default());
    }
}
