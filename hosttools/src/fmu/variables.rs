//! The variables of a unit: one list for the description, for checks and for where values stand.
//!
//! A value reference is the position in the list of its type. Real variables stand in one array: parameters, inputs,
//! outputs.

use flangeway::Side;

use super::{Mode, contact, wheels, wheelset};

/// What a variable is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set before the simulation begins, then fixed.
    Parameter,
    /// Set before each step.
    Input,
    /// Computed.
    Output,
}

/// A real variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Real {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub causality: Causality,
    /// Unit, empty for a number.
    pub unit: &'static str,
    /// What it is.
    pub description: String,
    /// Its value before it is set.
    pub start: f64,
    /// Least and largest value that is taken.
    pub range: [f64; 2],
}

/// An integer variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Integer {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub causality: Causality,
    /// What it is.
    pub description: String,
    /// Its value before it is set.
    pub start: i32,
    /// Least and largest value that is taken.
    pub range: [i32; 2],
}

/// All variables of a mode. Its string variable is the parameter [`TABLE`], its boolean one, of
/// [`Mode::Wheelset`] alone, the parameter [`EXACT_TRACK`].
#[derive(Debug, Clone, PartialEq)]
pub struct Variables {
    /// Real ones.
    pub reals: Vec<Real>,
    /// Parameters among them.
    pub parameters: usize,
    /// Inputs among them.
    pub inputs: usize,
    /// Integer ones: the creep law, then flags and number of contacts of each wheel.
    pub integers: Vec<Integer>,
    /// Whether there is [`EXACT_TRACK`].
    pub exact_track: bool,
}

/// The string parameter.
pub const TABLE: [&str; 2] = ["table", "Contact table file; empty for the one packed with this unit"];
/// The boolean parameter.
pub const EXACT_TRACK: [&str; 2] = [
    "exact_track",
    "Take heading and cant slope of the track from the inputs; else they follow from curvature and cant",
];

/// Parameters that both modes have, after their own: Polach's falling friction and the contacts' damping.
pub(super) const SHARED: usize = 4;

/// A parameter.
pub(super) fn parameter(name: &str, unit: &'static str, description: &str, start: f64, range: [f64; 2]) -> Real {
    let (name, description) = (name.into(), description.into());
    Real { name, causality: Causality::Parameter, unit, description, start, range }
}

/// An input.
pub(super) fn input(name: &str, unit: &'static str, description: &str, limit: f64) -> Real {
    let (name, description) = (name.into(), description.into());
    Real { name, causality: Causality::Input, unit, description, start: 0.0, range: [-limit, limit] }
}

/// An output.
pub(super) fn output(name: &str, unit: &'static str, description: &str) -> Real {
    let (name, description) = (name.into(), description.into());
    Real { name, causality: Causality::Output, unit, description, start: 0.0, range: [f64::MIN, f64::MAX] }
}

impl Variables {
    /// The variables of a mode.
    #[must_use]
    pub fn of(mode: Mode) -> Self {
        let (mut reals, inputs, outputs) = match mode {
            Mode::Wheelset => (wheelset::parameters(), wheelset::inputs(), wheelset::outputs()),
            Mode::Contact => (Vec::new(), contact::inputs(), contact::outputs()),
        };
        // A track that is rigid takes nothing from a wheel that bounces: damping stands for it.
        let damping = if mode == Mode::Wheelset { 2.5 } else { 0.0 };
        let shared = [
            ("friction", "", "Coefficient of friction without slip", 0.3, 2.0),
            ("friction_limit_ratio", "", "Polach's A: friction at infinite slip over that without", 1.0, 1.0),
            ("friction_decay", "s/m", "Polach's B: how fast friction falls with slip velocity", 0.0, 1e3),
            ("contact_damping", "s/m", "The normal force is raised by this share per m/s of approach", damping, 100.0),
        ];
        debug_assert_eq!(shared.len(), SHARED);
        reals.extend(shared.map(|(name, unit, text, start, high)| parameter(name, unit, text, start, [0.0, high])));
        let (parameters, input_count) = (reals.len(), inputs.len());
        reals.extend(inputs.into_iter().chain(outputs).chain(wheels::outputs()));
        let law = Integer {
            name: "creep_law".into(),
            causality: Causality::Parameter,
            description: "0 Kalker linear, 1 Shen-Hedrick-Elkins, 2 Polach, 3 FASTSIM on 10 x 10 elements".into(),
            start: 2,
            range: [0, 3],
        };
        let mut integers = vec![law];
        for side in Side::ALL {
            for (name, description, largest) in [
                (
                    "flags",
                    "Remarks about the lookup: bits 1 lateral, 2 yaw, 4 roll, 8 vertical outside the table, 16 \
                           angle limited, 32 invalid, 64 conformal",
                    255,
                ),
                ("contacts", "Contacts that carry force", 3),
            ] {
                integers.push(Integer {
                    name: format!("{side}.{name}"),
                    causality: Causality::Output,
                    description: description.into(),
                    start: 0,
                    range: [0, largest],
                });
            }
        }
        Self { reals, parameters, inputs: input_count, integers, exact_track: mode == Mode::Wheelset }
    }

    /// Position of the first output among the real variables.
    #[must_use]
    pub fn first_output(&self) -> usize {
        self.parameters + self.inputs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_are_unique_and_starts_in_range() {
        for mode in Mode::ALL {
            let variables = Variables::of(mode);
            let names = variables.reals.iter().map(|v| &v.name).chain(variables.integers.iter().map(|v| &v.name));
            let unique: HashSet<_> = names.clone().collect();
            assert_eq!(unique.len(), names.count());
            assert!(variables.reals.iter().all(|v| v.range[0] <= v.start && v.start <= v.range[1]));
            let causality = |i: usize| variables.reals[i].causality;
            assert_eq!(causality(variables.parameters - 1), Causality::Parameter);
            assert_eq!(causality(variables.parameters), Causality::Input);
            assert_eq!(causality(variables.first_output()), Causality::Output);
        }
    }
}
