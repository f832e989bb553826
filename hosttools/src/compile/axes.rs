//! The axes of a table: evenly spaced so far, with a count an axis.

use crate::error::{Error, Result};
use crate::recipe::{self, Nodes, Recipe};

/// Default counts for `"auto"`. The lateral axis takes what the byte budget leaves.
const YAW: usize = 13;
const VERTICAL: usize = 3;
const ROLL: usize = 3;
const LATERAL: std::ops::RangeInclusive<usize> = 9..=961;

/// Room (bytes) for header, axes and padding.
const OVERHEAD: usize = 8192;

/// Node counts from the command line, lateral x yaw x vertical x roll as the paper writes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Uniform {
    /// Lateral, yaw, vertical, roll.
    pub counts: [usize; 4],
}

impl std::str::FromStr for Uniform {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let counts: Vec<usize> = text
            .split('x')
            .map(|n| n.parse().map_err(|_| format!("\"{n}\" is not a node count")))
            .collect::<std::result::Result<_, _>>()?;
        let counts: [usize; 4] = counts.try_into().map_err(|_| {
            format!("\"{text}\" is not four node counts, lateral x yaw x vertical x roll, such as 121x9x25x21")
        })?;
        match counts.iter().find(|n| !(2..=4096).contains(*n)) {
            Some(n) => Err(format!("{n} nodes: an axis has 2 to 4096 nodes")),
            None => Ok(Self { counts }),
        }
    }
}

/// Nodes of all axes, m or rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Axes {
    /// Lateral displacement of the tape-circle point.
    pub lateral: Vec<f32>,
    /// Yaw.
    pub yaw: Vec<f32>,
    /// Roll about the rigid one.
    pub roll: Vec<f32>,
    /// Height about the rigid one.
    pub vertical: Vec<f32>,
}

impl Axes {
    /// Axes by the recipe, or by the counts given on the command line.
    ///
    /// # Errors
    /// When the byte budget is too small for the counts.
    pub fn choose(recipe: &Recipe, sides: usize, uniform: Option<Uniform>) -> Result<Self> {
        let grid = &recipe.grid;
        let count = |axis: &recipe::Axis, auto: usize| match axis.nodes {
            Nodes::Count(n) => n,
            Nodes::Auto => auto,
        };
        let [lateral, yaw, vertical, roll] = match uniform {
            Some(uniform) => uniform.counts,
            None => {
                let (yaw, roll) = (count(&grid.yaw_rad, YAW), count(&grid.roll_rad, ROLL));
                let vertical = count(&grid.vertical_m, VERTICAL);
                let room = usize::try_from(grid.max_bytes).unwrap_or(usize::MAX).saturating_sub(OVERHEAD);
                let a_node = sides * yaw * (roll * vertical * flangeway::layout::RECORD + 4 * (1 + roll));
                let fitting = (room / a_node).min(*LATERAL.end());
                if grid.lateral_m.nodes == Nodes::Auto && fitting < *LATERAL.start() {
                    let message = format!(
                        "{} is too little: {} lateral nodes with {yaw} x {roll} x {vertical} others take {} bytes",
                        grid.max_bytes,
                        LATERAL.start(),
                        LATERAL.start() * a_node + OVERHEAD
                    );
                    return Err(Error::field(&recipe.path, "grid.max_bytes", message));
                }
                [count(&grid.lateral_m, fitting), yaw, vertical, roll]
            }
        };
        Ok(Self {
            lateral: evenly(grid.lateral_m.range, lateral),
            yaw: evenly(grid.yaw_rad.range, yaw),
            roll: evenly(grid.roll_rad.range, roll),
            vertical: evenly(grid.vertical_m.range, vertical),
        })
    }

    /// Number of records a side.
    pub fn nodes(&self) -> usize {
        self.lateral.len() * self.yaw.len() * self.roll.len() * self.vertical.len()
    }

    /// Axes of the rigid maps: lateral, yaw, roll offset. They are the records' own, so that the zero of the vertical
    /// axis is linear inside a cell and each slot's indentation with it. A finer map follows the rigid contact's
    /// kink from tread to flange and bends every other slot's indentation inside the cell: at equal bytes the force
    /// error of the Manchester pair was 2.6 % rms with the records' axis, 3.8 % with twice and 4.5 % with four times
    /// as many nodes.
    pub fn rigid(&self) -> [&[f32]; 3] {
        [&self.lateral, &self.yaw, &self.roll]
    }

    /// All axes in the order of the image.
    pub fn all(&self) -> [&[f32]; 7] {
        let [lateral, yaw, roll] = self.rigid();
        [&self.lateral, &self.yaw, &self.roll, &self.vertical, lateral, yaw, roll]
    }
}

fn evenly([first, last]: [f64; 2], count: usize) -> Vec<f32> {
    (0..count).map(|i| (first + (last - first) * i as f64 / (count - 1) as f64) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_as_the_paper_writes_them() {
        assert_eq!("121x9x25x21".parse(), Ok(Uniform { counts: [121, 9, 25, 21] }));
        for bad in ["121x9x25", "121x9x25x1", "0x9x25x21", "121x9x25x21x3", "ax9x25x21", ""] {
            assert!(bad.parse::<Uniform>().is_err(), "{bad}");
        }
    }

    #[test]
    fn evenly_spaced_nodes_keep_the_ends() {
        assert_eq!(evenly([-0.5, 1.0], 4), [-0.5, 0.0, 0.5, 1.0]);
    }
}
