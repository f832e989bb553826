//! The height at which a wheel carries a given load.

use crate::contact::Column;

/// Height (m) of the axle at which the total normal force is `load` (N), by [`Column::estimated_force`]; `None` where the
/// wheel misses the rail.
///
/// Regula falsi (Illinois) on N^(2/3), which is nearly linear in the height because N = C δ^1.5.
pub fn height_for_load(column: &mut Column<'_>, load: f64) -> Option<f64> {
    let (touching, point) = column.touching(None)?;
    let target = libm::cbrt(load * load);
    let mut f = |vertical: f64| {
        let force = column.estimated_force(vertical);
        libm::cbrt(force * force) - target
    };
    // δ ≈ (N / C)^(2/3) with C of a typical contact, divided by cos γ, as a first bracket.
    let reach = libm::cbrt((load / 6e10).powi(2)) / point.foot.tangent[0].max(0.05);
    let (mut low, mut f_low) = (touching, -target);
    let mut high = touching + reach;
    let mut f_high = f(high);
    let mut doublings = 0;
    while f_high < 0.0 {
        (low, f_low) = (high, f_high);
        high += reach * f64::from(1 << doublings);
        f_high = f(high);
        doublings += 1;
        if doublings > 8 {
            return None;
        }
    }
    for _ in 0..60 {
        let middle = low + (high - low) * f_low / (f_low - f_high);
        let value = f(middle);
        if value.abs() < 1e-9 * target || high - low < 1e-14 {
            return Some(middle);
        }
        if value < 0.0 {
            (low, f_low) = (middle, value);
            f_high *= 0.5;
        } else {
            (high, f_high) = (middle, value);
            f_low *= 0.5;
        }
    }
    Some(0.5 * (low + high))
}
