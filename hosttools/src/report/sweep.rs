//! The rigid contact of the wheelset over its lateral position: what the rigid figures are drawn from.

use flangeway::{Side, Slot};
use rayon::prelude::*;

use super::style::slot_at;
use crate::contact::RidgePoint;
use crate::pair::Pair;
use crate::rigid::{Rigid, two_wheels};

/// Rigid contact at a lateral position (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) lateral: f64,
    pub(super) rigid: Rigid,
}

impl Step {
    /// Rigid contact at a lateral position (m) and yaw (rad); `None` where a wheel misses its rail.
    pub(super) fn at(pair: &Pair, lateral: f64, yaw: f64) -> Option<Self> {
        two_wheels(pair, lateral, yaw).map(|rigid| Self { lateral, rigid })
    }

    /// The contact point of a wheel, in its canonical frame.
    pub(super) fn point(&self, side: Side) -> &RidgePoint {
        match side {
            Side::Right => &self.rigid.right,
            Side::Left => &self.rigid.left,
        }
    }

    /// The slot in which a wheel touches.
    pub(super) fn slot(&self, pair: &Pair, side: Side) -> Slot {
        slot_at(pair.body(side).boundaries(), self.point(side).wheel.s)
    }
}

/// Steps over a range of lateral positions (m) at one yaw (rad), those where a wheel misses its rail left out.
pub(super) fn sweep(pair: &Pair, [from, to]: [f64; 2], yaw: f64, count: usize) -> Vec<Step> {
    let lateral = |i: usize| from + (to - from) * i as f64 / (count - 1) as f64;
    (0..count).into_par_iter().filter_map(|i| Step::at(pair, lateral(i), yaw)).collect()
}

/// The lateral positions at which the right wheel's contact changes its slot, yaw 0: the steps just before and just
/// after each, where the wheel touches in two places.
pub(super) fn jumps(pair: &Pair, steps: &[Step]) -> Vec<[Step; 2]> {
    let slot = |step: &Step| step.slot(pair, Side::Right);
    let changes = steps.windows(2).filter(|w| slot(&w[0]) != slot(&w[1]));
    let narrowed = |w: &[Step]| {
        let (mut before, mut after) = (w[0], w[1]);
        for _ in 0..40 {
            match Step::at(pair, 0.5 * (before.lateral + after.lateral), 0.0) {
                Some(middle) if slot(&middle) == slot(&before) => before = middle,
                Some(middle) => after = middle,
                None => break,
            }
        }
        [before, after]
    };
    changes.map(narrowed).collect()
}
