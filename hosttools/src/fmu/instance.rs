//! One unit at work: values, phase, model. All of FMI but its C.

use std::path::{Path, PathBuf};

use flangeway::ContactTable;
use flangeway::creep::Elasticity;
use self_cell::self_cell;

use super::variables::{Causality, Variables};
use super::wheelset::{Constants, Inputs, State};
use super::{Mode, contact, package, wheels};
use crate::dynamics::source::Source;
use crate::dynamics::wheel_rail::WheelRail;

self_cell!(
    /// A table with its image.
    struct OwnedTable {
        owner: Vec<u8>,
        #[covariant]
        dependent: ContactTable,
    }
);

/// What may be done with a unit, in FMI's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Parameters and inputs are set.
    Instantiated,
    /// Outputs at the start are computed.
    Initializing,
    /// Steps.
    Stepping,
    /// A step failed, or the simulation is over: values can be read.
    Ended,
}

/// All that changes while a unit works: what FMI calls its state.
#[derive(Debug, Clone)]
pub struct Snapshot {
    phase: Phase,
    reals: Vec<f64>,
    integers: Vec<i32>,
    exact_track: bool,
    table: String,
    wheelset: Option<State>,
    /// Whether something was set that the outputs do not show yet.
    stale: bool,
}

/// A unit.
pub struct Instance {
    mode: Mode,
    variables: Variables,
    resources: PathBuf,
    table: Option<OwnedTable>,
    /// The file that [`Instance::table`] was read from.
    loaded: PathBuf,
    now: Snapshot,
}

/// What went wrong, in words for the log.
pub type Result<T> = std::result::Result<T, String>;

impl Instance {
    /// A unit with its start values, its packed table in the folder `resources`.
    #[must_use]
    pub fn new(mode: Mode, resources: &Path) -> Self {
        let variables = Variables::of(mode);
        let now = Snapshot {
            phase: Phase::Instantiated,
            reals: variables.reals.iter().map(|variable| variable.start).collect(),
            integers: variables.integers.iter().map(|variable| variable.start).collect(),
            exact_track: false,
            table: String::new(),
            wheelset: None,
            stale: true,
        };
        Self { mode, variables, resources: resources.into(), table: None, loaded: PathBuf::new(), now }
    }

    /// Where it stands.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.now.phase
    }

    /// A real variable.
    ///
    /// # Errors
    /// When there is no such variable, or outputs cannot be computed.
    pub fn real(&mut self, reference: u32) -> Result<f64> {
        self.refresh()?;
        let value = self.now.reals.get(reference as usize).copied();
        value.ok_or_else(|| format!("there is no real variable {reference}"))
    }

    /// An integer variable.
    ///
    /// # Errors
    /// As [`Instance::real`].
    pub fn integer(&mut self, reference: u32) -> Result<i32> {
        self.refresh()?;
        let value = self.now.integers.get(reference as usize).copied();
        value.ok_or_else(|| format!("there is no integer variable {reference}"))
    }

    /// A boolean variable.
    ///
    /// # Errors
    /// When there is no such variable.
    pub fn boolean(&self, reference: u32) -> Result<bool> {
        if reference == 0 && self.variables.exact_track {
            Ok(self.now.exact_track)
        } else {
            Err(format!("there is no boolean variable {reference}"))
        }
    }

    /// A string variable.
    ///
    /// # Errors
    /// When there is no such variable.
    pub fn string(&self, reference: u32) -> Result<&str> {
        if reference == 0 { Ok(&self.now.table) } else { Err(format!("there is no string variable {reference}")) }
    }

    /// Sets a real parameter or input.
    ///
    /// # Errors
    /// When there is no such variable, it is not to be set now, or the value is out of its range or no number. The
    /// variable keeps its value then.
    pub fn set_real(&mut self, reference: u32, value: f64) -> Result<()> {
        let Some(variable) = self.variables.reals.get(reference as usize) else {
            return Err(format!("there is no real variable {reference}"));
        };
        self.may_set(&variable.name, variable.causality)?;
        let [low, high] = variable.range;
        if !(value >= low && value <= high) {
            return Err(format!("{} cannot be {value}: it is {low} to {high}", variable.name));
        }
        self.now.reals[reference as usize] = value;
        self.now.stale = true;
        Ok(())
    }

    /// Sets an integer parameter.
    ///
    /// # Errors
    /// As [`Instance::set_real`].
    pub fn set_integer(&mut self, reference: u32, value: i32) -> Result<()> {
        let Some(variable) = self.variables.integers.get(reference as usize) else {
            return Err(format!("there is no integer variable {reference}"));
        };
        self.may_set(&variable.name, variable.causality)?;
        let [low, high] = variable.range;
        if !(low..=high).contains(&value) {
            return Err(format!("{} cannot be {value}: it is {low} to {high}", variable.name));
        }
        self.now.integers[reference as usize] = value;
        self.now.stale = true;
        Ok(())
    }

    /// Sets a boolean parameter.
    ///
    /// # Errors
    /// When there is no such variable, or it is not to be set now.
    pub fn set_boolean(&mut self, reference: u32, value: bool) -> Result<()> {
        self.boolean(reference)?;
        self.may_set(super::variables::EXACT_TRACK[0], Causality::Parameter)?;
        self.now.exact_track = value;
        Ok(())
    }

    /// Sets a string parameter.
    ///
    /// # Errors
    /// When there is no such variable, or it is not to be set now.
    pub fn set_string(&mut self, reference: u32, value: &str) -> Result<()> {
        self.string(reference)?;
        self.may_set(super::variables::TABLE[0], Causality::Parameter)?;
        self.now.table = value.into();
        self.now.stale = true;
        Ok(())
    }

    fn may_set(&self, name: &str, causality: Causality) -> Result<()> {
        match (causality, self.now.phase) {
            (Causality::Output, _) => Err(format!("{name} is an output and cannot be set")),
            (Causality::Parameter, Phase::Stepping) => Err(format!("{name} is a parameter and fixed now")),
            (_, Phase::Ended) => Err(format!("{name} cannot be set any more")),
            _ => Ok(()),
        }
    }

    /// Begins initialization: the table is read.
    ///
    /// # Errors
    /// When it is not the time, or the table is missing or damaged.
    pub fn enter_initialization(&mut self) -> Result<()> {
        self.expect(Phase::Instantiated)?;
        self.load()?;
        self.now.phase = Phase::Initializing;
        Ok(())
    }

    /// Ends initialization.
    ///
    /// # Errors
    /// When it is not the time, or these parameters allow no start.
    pub fn exit_initialization(&mut self) -> Result<()> {
        self.expect(Phase::Initializing)?;
        self.refresh()?;
        self.now.phase = Phase::Stepping;
        Ok(())
    }

    /// A communication step of this length (s).
    ///
    /// # Errors
    /// When it is not the time, the length is not above zero, or the step fails: the unit has ended then.
    pub fn step(&mut self, length: f64) -> Result<()> {
        self.expect(Phase::Stepping)?;
        if !(length > 0.0 && length <= 10.0) {
            return Err(format!("a communication step of {length} s: it is above 0 to 10"));
        }
        self.now.stale = true;
        let Some(mut state) = self.now.wheelset else { return self.refresh() };
        let (parameters, rest) = self.now.reals.split_at(self.variables.parameters);
        let inputs = Inputs::new(&rest[..self.variables.inputs]);
        let contact = self.contact(parameters)?;
        if let Err(message) = state.advance(length, inputs, self.now.exact_track, &Constants::new(parameters), &contact)
        {
            self.now.phase = Phase::Ended;
            return Err(message);
        }
        self.now.wheelset = Some(state);
        self.refresh()
    }

    /// Ends the simulation.
    ///
    /// # Errors
    /// When it has not begun.
    pub fn terminate(&mut self) -> Result<()> {
        self.expect(Phase::Stepping)?;
        self.now.phase = Phase::Ended;
        Ok(())
    }

    /// Back to the start values.
    pub fn reset(&mut self) {
        *self = Self::new(self.mode, &self.resources);
    }

    /// All that changes.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        self.now.clone()
    }

    /// Back to a snapshot of this unit.
    ///
    /// # Errors
    /// When the snapshot is of another table, which cannot be read any more, or of another mode.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if snapshot.reals.len() != self.variables.reals.len() {
            return Err("this state is of another kind of unit".into());
        }
        self.now.clone_from(snapshot);
        if self.now.phase == Phase::Instantiated { Ok(()) } else { self.load() }
    }

    fn expect(&self, phase: Phase) -> Result<()> {
        if self.now.phase == phase {
            Ok(())
        } else {
            Err(format!("not now: the unit is {:?}, not {phase:?}", self.now.phase))
        }
    }

    /// Reads the table that the parameters name, unless it is the one at hand.
    fn load(&mut self) -> Result<()> {
        let path = if self.now.table.is_empty() {
            self.resources.join(package::TABLE)
        } else {
            PathBuf::from(&self.now.table)
        };
        if self.table.is_some() && path == self.loaded {
            return Ok(());
        }
        self.table = None;
        let image = std::fs::read(&path).map_err(|e| format!("table {}: {e}", path.display()))?;
        let table = OwnedTable::try_new(image, |image| ContactTable::new(image));
        self.table = Some(table.map_err(|e| format!("table {}: {e}", path.display()))?);
        self.loaded = path;
        Ok(())
    }

    /// Contact and creep by these parameters.
    fn contact(&self, parameters: &[f64]) -> Result<WheelRail<'_>> {
        let table = self.table.as_ref().ok_or("the table is not read yet")?.borrow_dependent();
        let (friction, damping) = wheels::friction(parameters);
        Ok(WheelRail {
            source: Source::Table(table),
            law: wheels::law(self.now.integers[0]),
            friction,
            elasticity: Elasticity::from(&table.header().material),
            damping,
        })
    }

    /// Brings the outputs up to date with what was set, where the phase has them.
    fn refresh(&mut self) -> Result<()> {
        if !self.now.stale || !matches!(self.now.phase, Phase::Initializing | Phase::Stepping) {
            return Ok(());
        }
        if self.now.phase == Phase::Initializing {
            self.load()?;
        }
        let Variables { parameters, inputs, .. } = self.variables;
        let mut reals = std::mem::take(&mut self.now.reals);
        let found = self.evaluate(&mut reals, parameters, inputs);
        self.now.reals = reals;
        let (wheelset, flags) = found?;
        self.now.wheelset = wheelset;
        self.now.integers[1..].copy_from_slice(&flags);
        self.now.stale = false;
        Ok(())
    }

    /// Writes the real outputs; the wheelset's state and the integer outputs.
    fn evaluate(&self, reals: &mut [f64], parameters: usize, inputs: usize) -> Result<(Option<State>, [i32; 4])> {
        let (parameters, rest) = reals.split_at_mut(parameters);
        let (inputs, outputs) = rest.split_at_mut(inputs);
        let contact = self.contact(parameters)?;
        if self.mode == Mode::Contact {
            return Ok((None, wheels::integers(&contact::evaluate(inputs, &contact, outputs))));
        }
        let state = match (self.now.phase, self.now.wheelset) {
            (Phase::Stepping, Some(state)) => state,
            _ => {
                State::at_rest(&Constants::new(parameters), Inputs::new(inputs), &contact).map_err(|e| e.to_string())?
            }
        };
        state.write(outputs);
        Ok((Some(state), wheels::integers(&state.wheelset.wheels)))
    }
}
