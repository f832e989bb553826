//! Where both wheels touch, rigid, over the lateral position of the wheelset: on the wheel, on the rail, at what angle.

use flangeway::Side;

use super::style::{
    Axis, GREY, LEGEND, Mark, around, colour, dashes, figure, legend, line, panel, panel_height, px, runs, slot_entries,
};
use super::sweep::Step;
use crate::error::Result;
use crate::pair::Pair;

/// Height of a plot (shown pixels).
const PLOT: u32 = 230;
const SHIFT: &str = "lateral position of the wheelset y (mm)";

/// A quantity of a contact, in the unit of its axis.
type Value<'a> = Box<dyn Fn(&Step, Side) -> f64 + 'a>;

/// Three rows, left and right wheel side by side; yaw 0 in full, another yaw (rad) dashed.
pub(super) fn positions(pair: &Pair, straight: &[Step], yawed: &[Step], yaw: f64) -> Result<String> {
    let rail = |step: &Step, side: Side| {
        let body = pair.body(side);
        let foot = body.rail().curve().at(step.point(side).foot.t);
        1e3 * (foot.y - body.wheel().geometry().lateral_position)
    };
    let angle = |step: &Step, side: Side| {
        let [across, down] = step.point(side).foot.tangent;
        side.sign() * libm::atan2(down, across).to_degrees()
    };
    let rows: [(&str, &str, Value<'_>); 3] = [
        ("contact on the wheel", "s (mm)", Box::new(|step, side| 1e3 * step.point(side).wheel.s)),
        ("contact on the rail", "outward (mm)", Box::new(rail)),
        ("contact angle", "angle (deg)", Box::new(angle)),
    ];
    figure("rigid contact over the lateral position", LEGEND + 3 * panel_height(PLOT), |area| {
        let (above, below) = area.split_vertically(px(LEGEND));
        let mut entries = slot_entries(Mark::Line);
        entries.push((Mark::Dashes, GREY, format!("dashed: yaw {} mrad", 1e3 * yaw)));
        legend(&above, &entries)?;
        let areas = below.split_evenly((rows.len(), 2));
        for (index, area) in areas.iter().enumerate() {
            let (name, label, value) = &rows[index / 2];
            let side = if index % 2 == 0 { Side::Left } else { Side::Right };
            let (Some(first), Some(last)) = (straight.first(), straight.last()) else { return Ok(()) };
            let all = straight.iter().chain(yawed).map(|step| value(step, side));
            let x = Axis::new(SHIFT, 1e3 * first.lateral..1e3 * last.lateral, 9);
            let y = Axis::new(label, around(all, 0.03, 5.0), 7);
            let mut chart = panel(area, &format!("{side} wheel: {name}"), &x, &y)?;
            let of_slots = |steps: &[Step]| {
                runs(steps.iter().map(|step| (step.slot(pair, side), (1e3 * step.lateral, value(step, side)))))
            };
            for (slot, run) in of_slots(straight) {
                line(&mut chart, run, colour(slot))?;
            }
            for (slot, run) in of_slots(yawed) {
                dashes(&mut chart, run, colour(slot))?;
            }
        }
        Ok(())
    })
}
