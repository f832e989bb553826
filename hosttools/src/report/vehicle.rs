//! The picture of a simulation: how the wheelsets run, and what the leading one's wheels bear.

use flangeway::{Side, Slot};

use super::plot::{Curve, Panel, draw};
use super::style::{GREY, INK, Mark, colour, slot_entries};
use crate::dynamics::body::{LATERAL, YAW};
use crate::dynamics::record::{Sample, slot_forces};
use crate::error::Result;

/// Most points of a curve.
const POINTS: usize = 1500;

/// Displacement and yaw of all wheelsets, forces of the leading one's wheels by slot, Y/Q and wear.
pub(crate) fn picture(title: &str, samples: &[Sample]) -> Result<String> {
    let every = samples.len().div_ceil(POINTS).max(1);
    let points = |scale: f64, value: &dyn Fn(&Sample) -> f64| {
        samples.iter().step_by(every).map(|s| (s.distance, scale * value(s))).collect::<Vec<_>>()
    };
    let marks = [(Mark::Line, INK), (Mark::Dashes, GREY)];
    let wheelsets = samples.first().map_or(0, |s| s.wheelsets.len());
    let of_wheelsets = |title: &str, label: &'static str, coordinate: usize| {
        let curves = (0..wheelsets)
            .zip(marks)
            .map(|(i, (mark, ink))| Curve::new(mark, ink, points(1e3, &|s| s.wheelsets[i].body.position[coordinate])));
        Panel::new(title, ["distance (m)", label], curves.collect())
    };
    let of_slots = |index: usize, side: Side| {
        let curves = Slot::ALL.map(|slot| {
            let force = |s: &Sample| slot_forces(&s.wheelsets[0].wheels[index])[slot.index()];
            Curve::new(Mark::Line, colour(slot), points(1e-3, &force))
        });
        let title = format!("{side} wheel of the leading wheelset");
        Panel::new(&title, ["distance (m)", "normal force (kN)"], curves.into())
    };
    let of_wheels = |title: &str, label: &'static str, value: fn(&crate::dynamics::wheel_rail::Wheel) -> f64| {
        let curves = [0, 1].map(|wheel| {
            let (mark, ink) = marks[wheel];
            Curve::new(mark, ink, points(1.0, &|s| value(&s.wheelsets[0].wheels[wheel])))
        });
        Panel::new(title, ["distance (m)", label], curves.into())
    };
    let rows = [
        vec![of_wheelsets("lateral displacement", "y (mm)", LATERAL), of_wheelsets("yaw", "yaw (mrad)", YAW)],
        Side::ALL.into_iter().enumerate().rev().map(|(index, side)| of_slots(index, side)).collect(),
        vec![
            of_wheels("guiding force over wheel load, leading wheelset", "Y/Q (-)", |w| w.loads.ratio()),
            of_wheels("wear index, leading wheelset", "wear index (N)", |w| w.wear()),
        ],
    ];
    let mut entries = slot_entries(Mark::Line);
    entries.push((Mark::Line, INK, "leading, right".into()));
    entries.push((Mark::Dashes, GREY, "dashed: trailing, left".into()));
    draw(title, &entries, &rows)
}
