//! The coefficient of friction, constant or falling with the speed of slip.

use crate::math::{greater, rising};

/// A coefficient of friction that may fall with the slip: μ(w) = μ0 ((1 - A) e^(-B w) + A).
///
/// O. Polach, Creep forces in simulations of traction vehicles running on adhesion limit, Wear 258 (2005).
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Friction {
    /// Greatest coefficient μ0, without slip.
    pub coefficient: f32,
    /// A: the coefficient at infinite slip over μ0; 1 does not fall.
    pub limit_ratio: f32,
    /// B: how fast it falls, s/m.
    pub decay: f32,
}

impl Friction {
    /// Coulomb's: the same at every slip.
    #[must_use]
    pub const fn constant(coefficient: f32) -> Self {
        Self { coefficient, limit_ratio: 1.0, decay: 0.0 }
    }

    /// Coefficient at a slip velocity w (m/s, the creepages' magnitude times the speed).
    #[inline]
    #[must_use]
    pub fn at(&self, slip: f32) -> f32 {
        // μ0 ((1 - A) e^(-B w) + A) = μ0 (1 - (1 - A) (1 - e^(-B w)))
        self.coefficient * (1.0 - (1.0 - self.limit_ratio) * rising(greater(self.decay * slip, 0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_from_the_coefficient_to_its_limit() {
        let friction = Friction { coefficient: 0.33, limit_ratio: 0.4, decay: 0.6 };
        assert_eq!(friction.at(0.0), 0.33);
        assert!((friction.at(1000.0) - 0.132).abs() < 1e-7);
        assert!((friction.at(2.0) - 0.33 * (0.6 * libm::expf(-1.2) + 0.4)).abs() < 1e-7);
        assert_eq!(Friction::constant(0.3).at(5.0), 0.3);
    }
}
