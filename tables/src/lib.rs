//! Recipes for common wheel and rail pairs, as text. The table format is specified in `FORMAT.md` beside this crate.
#![no_std]

/// S1002 wheel on 60E1 rail inclined 1:40, standard gauge: the recipe of `flangeway quickstart`.
pub const S1002_60E1_40: &str = include_str!("../recipes/s1002_60e1_40.toml");
