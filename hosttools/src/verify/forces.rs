//! Total normal force of a canonical pose, by the table and by the direct solver.

use flangeway::{ContactTable, Contacts, Pose, Side};

use crate::pair::Pair;

/// The pose of the wheelset whose given wheel sees a canonical pose with positive yaw.
pub(super) fn actual(side: Side, canonical: &Pose) -> Pose {
    let sign = side.sign();
    let Pose { lateral, yaw, vertical, roll } = *canonical;
    Pose { lateral: sign * lateral, yaw: sign * yaw, vertical, roll: sign * roll }
}

/// Contacts by the table.
pub(super) fn looked_up(table: &ContactTable<'_>, side: Side, canonical: &Pose) -> Contacts {
    table.contacts(side, &actual(side, canonical))
}

/// Total force (N) by the table.
pub(super) fn table(table: &ContactTable<'_>, side: Side, canonical: &Pose) -> f64 {
    f64::from(looked_up(table, side, canonical).total_normal_force())
}

/// Total force (N) by the direct solver.
pub(super) fn direct(pair: &Pair, side: Side, canonical: &Pose) -> f64 {
    pair.column(side, canonical).total_force(canonical.vertical)
}
