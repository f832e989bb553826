//! A wheelset as a unit of co-simulation by FMI 2.0: its variables, their description, its steps, and the packed file.
//!
//! [`variables`] lists what can be got and set, [`wheelset`] and [`contact`] are the two models behind it, [`instance`]
//! is one of them with its values, [`description`] writes modelDescription.xml from the list, and [`package`] packs it
//! with the table and the library. `hosttools/fmu` puts the C functions of FMI around an [`instance::Instance`].

pub mod contact;
pub mod description;
pub mod instance;
pub mod package;
pub mod variables;
pub mod wheels;
pub mod wheelset;

/// What a unit computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Mode {
    /// A wheelset on its suspension with its contacts, stepped inside at a fixed finer step
    Wheelset,
    /// Contact and creep forces only: motion in, wrench out
    Contact,
}

impl Mode {
    /// Both modes.
    pub const ALL: [Self; 2] = [Self::Wheelset, Self::Contact];

    /// FMI's model identifier: the stem of the library's name in the packed file.
    #[must_use]
    pub const fn identifier(self) -> &'static str {
        match self {
            Self::Wheelset => "flangeway_wheelset",
            Self::Contact => "flangeway_contact",
        }
    }

    /// What the unit is, with what its user must know.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Wheelset => {
                "One wheelset on its suspension with wheel-rail contact from a table, stepped inside at the fixed step \
                 of the parameter step. Track frame: x forward, y right, z down. Inputs are those of a step's end and \
                 are interpolated linearly from the step before."
            }
            Self::Contact => {
                "Wheel-rail contact and creep forces of one wheelset, without its mass: motion in, wrench out, at the \
                 same time. Track frame: x forward, y right, z down. STABILITY: the contacts of a wheelset are a spring \
                 of about k = 2e9 N/m. A force that is held over a communication step h lags by h/2, by 3h/2 where it \
                 also arrives a step late, and a lag t acts as a damping of -k t. So with a damping d of the vertical \
                 motion the coupling is stable below h = 2d/k, with a step's delay below h = 2d/(3k): 33 microseconds \
                 for d = 1e5 N.s/m. Without damping it grows at any step (1200 kg: at 205 Hz). Use it inside a \
                 solver's own iteration, or take the wheelset FMU."
            }
        }
    }
}
