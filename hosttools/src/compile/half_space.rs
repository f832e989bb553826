//! Half-space tables: everything is prepared with the semi-Hertzian method, which is several times as fast and off by
//! a few percent at most, and what the half-space solver says otherwise is added at the nodes.
//!
//! Between the nodes the two differ smoothly: kinks, onsets and changes of contact are the semi-Hertzian table's own,
//! fitted or sampled. So one half-space solution a node is enough.

use flangeway::SLOTS;

use super::axes::Axes;
use super::checkpoint::Checkpoint;
use super::quantise;
use super::sampler::Sampler;
use crate::contact::{Normal, Settings, SlotState};
use crate::error::Result;
use crate::pair::Pair;
use crate::progress;
use rayon::prelude::*;

/// Columns of heights solved between two writes of the checkpoint.
const BATCH: usize = 64;

/// The pair with which a table is prepared: the pair itself, or for the half-space the semi-Hertzian one.
pub(super) fn preparing(pair: &Pair) -> Pair {
    let settings = *pair.body(flangeway::Side::Right).settings();
    match settings.normal {
        Normal::HalfSpace => pair.with_settings(Settings { normal: Normal::SemiHertzian, ..settings }),
        _ => pair.clone(),
    }
}

/// Slots by the half-space solver at every node, in the order of the records, for which the sampler is prepared; what
/// the checkpoint has is not solved again. None where the pair has another solver.
pub(super) fn solve(
    sampler: &Sampler<'_>,
    pair: &Pair,
    axes: &Axes,
    checkpoint: &mut Checkpoint,
) -> Result<Vec<[SlotState; SLOTS]>> {
    if pair.body(sampler.side).settings().normal != Normal::HalfSpace {
        return Ok(Vec::new());
    }
    let plane = axes.lateral.iter().flat_map(|&u| axes.yaw.iter().map(move |&yaw| (u, yaw)));
    let columns: Vec<[f64; 3]> = plane.flat_map(|(u, yaw)| axes.roll.iter().map(move |&roll| [u, yaw, roll])).collect();
    let mut nodes = checkpoint.solved(sampler.side, axes.vertical.len());
    let done = nodes.len() / axes.vertical.len();
    let bar = progress::bar(columns.len() as u64, "half-space");
    bar.set_position(done as u64);
    for batch in columns[done..].chunks(BATCH) {
        let solve = |&at: &[f64; 3]| {
            let pose = sampler.touching_pose(at);
            let mut column = pair.column(sampler.side, &pose);
            axes.vertical.iter().map(|&z| column.slots(pose.vertical + z)).collect::<Vec<_>>()
        };
        let solved: Vec<Vec<[SlotState; SLOTS]>> = batch.par_iter().map(solve).collect();
        let solved: Vec<[SlotState; SLOTS]> = solved.into_iter().flatten().collect();
        checkpoint.add(sampler.side, &solved)?;
        nodes.extend(solved);
        bar.inc(batch.len() as u64);
    }
    bar.finish_and_clear();
    Ok(nodes)
}

/// Adds to node values made with the semi-Hertzian method what the half-space solver says otherwise.
pub(super) fn correct(nodes: &mut [[SlotState; SLOTS]], semi: &[[SlotState; SLOTS]], half: &[[SlotState; SLOTS]]) {
    for ((node, semi), half) in nodes.iter_mut().zip(semi).zip(half) {
        for ((node, semi), half) in node.iter_mut().zip(semi).zip(half) {
            let stiffness = (node.stiffness + half.stiffness - semi.stiffness).max(0.0);
            if semi.stiffness > 0.0 && half.stiffness > 0.0 {
                let [value, of_semi, of_half] = [&*node, semi, half].map(quantise::values);
                let moved = std::array::from_fn(|n| value[n] + of_half[n] - of_semi[n]);
                quantise::set_values(node, moved);
                node.semi_axis_x = node.semi_axis_x.max(0.0);
                node.semi_axis_y = node.semi_axis_y.max(0.0);
            }
            node.stiffness = stiffness;
        }
    }
}
