//! `flangeway creep`: creep forces of contacts by one of the kernel's laws, to hold against other programs.

use std::path::{Path, PathBuf};

use flangeway::creep::{
    self, CreepForces, Creepages, Elasticity, Patch, fastsim, kalker_linear, polach, shen_hedrick_elkins,
};

use crate::error::{Error, Result};
use crate::image::write_atomically;

/// Columns that a case has; `friction` may follow.
const COLUMNS: [&str; 6] = [
    "semi_axis_x_m",
    "semi_axis_y_m",
    "normal_force_n",
    "longitudinal_creepage",
    "lateral_creepage",
    "spin_creepage_per_m",
];
const FRICTION: &str = "friction";

/// Arguments of `flangeway creep`.
#[derive(Debug, Clone, clap::Args)]
pub struct CreepArgs {
    /// Cases (CSV: semi_axis_x_m, semi_axis_y_m, normal_force_n, longitudinal_creepage, lateral_creepage,
    /// spin_creepage_per_m, and optionally friction); creepages of the wheel against the rail
    #[arg(value_name = "CASES.csv")]
    pub cases: PathBuf,
    /// Law
    #[arg(long, value_enum, default_value_t = LawArg::Fastsim)]
    pub law: LawArg,
    /// Elements of FASTSIM along and across
    #[arg(long, value_enum, default_value_t = GridArg::Fifty)]
    pub grid: GridArg,
    /// Friction coefficient of cases without one of their own
    #[arg(long, default_value_t = 0.3, value_parser = positive)]
    pub friction: f32,
    /// Shear modulus of wheel and rail, Pa
    #[arg(long, default_value_t = Elasticity::STEEL.shear_modulus, value_parser = positive)]
    pub shear_modulus: f32,
    /// Poisson's ratio of wheel and rail, 0 to 0.5
    #[arg(long, default_value_t = Elasticity::STEEL.poisson_ratio, value_parser = poisson)]
    pub poisson: f32,
    /// Forces on the wheel (CSV: row, longitudinal_force_n, lateral_force_n, spin_moment_nm, force_over_bound,
    /// wear_index_n)
    #[arg(short, long)]
    pub output: PathBuf,
}

/// A creep-force law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum LawArg {
    /// Kalker's linear theory, without saturation
    Kalker,
    /// The linear theory bent to the bound by a cubic
    ShenHedrickElkins,
    /// Polach's closed form
    Polach,
    /// Kalker's simplified theory on a grid
    Fastsim,
}

/// A grid of FASTSIM.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum GridArg {
    /// 100 elements
    #[value(name = "10x10")]
    Ten,
    /// 400 elements
    #[value(name = "20x20")]
    Twenty,
    /// 2500 elements
    #[value(name = "50x50")]
    Fifty,
}

/// One contact.
struct Case {
    patch: Patch,
    creepages: Creepages,
    friction: f32,
}

/// Computes all cases and writes their forces.
///
/// # Errors
/// On a bad file of cases, or when the output cannot be written.
pub fn run(args: &CreepArgs) -> Result<()> {
    let cases = read(&args.cases, args.friction)?;
    let elasticity = Elasticity { shear_modulus: args.shear_modulus, poisson_ratio: args.poisson };
    let mut text =
        String::from("row,longitudinal_force_n,lateral_force_n,spin_moment_nm,force_over_bound,wear_index_n\n");
    for (row, case) in cases.iter().enumerate() {
        let forces = forces(args, &elasticity, case);
        let CreepForces { longitudinal, lateral, spin_moment } = forces;
        let share = forces.magnitude() / (case.friction * case.patch.normal_force);
        let wear = creep::wear_index(&case.creepages, &forces);
        text += &format!("{row},{longitudinal},{lateral},{spin_moment},{share},{wear}\n");
    }
    write_atomically(&args.output, text.as_bytes())?;
    eprintln!("{} cases: {}", cases.len(), args.output.display());
    Ok(())
}

fn forces(args: &CreepArgs, elasticity: &Elasticity, case: &Case) -> CreepForces {
    let Case { patch, creepages, friction } = case;
    let law = match (args.law, args.grid) {
        (LawArg::Kalker, _) => return kalker_linear(patch, elasticity, creepages),
        (LawArg::ShenHedrickElkins, _) => shen_hedrick_elkins,
        (LawArg::Polach, _) => polach,
        (LawArg::Fastsim, GridArg::Ten) => fastsim::<10, 10>,
        (LawArg::Fastsim, GridArg::Twenty) => fastsim::<20, 20>,
        (LawArg::Fastsim, GridArg::Fifty) => fastsim::<50, 50>,
    };
    law(patch, elasticity, creepages, *friction)
}

/// Reads the cases. Columns may stand in any order.
fn read(path: &Path, friction: f32) -> Result<Vec<Case>> {
    let file = std::fs::File::open(path).map_err(|e| Error::file(path, e.to_string()))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(file);
    let at = |e: &csv::Error| {
        e.position().map_or_else(
            || Error::file(path, e.to_string()),
            |position| Error::line(path, position.line() as usize, e.to_string()),
        )
    };
    let header = reader.headers().map_err(|e| at(&e))?.clone();
    let place = |column: &str| header.iter().position(|name| name == column);
    let mut order = [0; 6];
    for (order, column) in order.iter_mut().zip(COLUMNS) {
        *order = place(column).ok_or_else(|| Error::line(path, 1, format!("column {column} is missing")))?;
    }
    if let Some(unknown) = header.iter().find(|name| !COLUMNS.contains(name) && *name != FRICTION) {
        let known = COLUMNS.join(",");
        return Err(Error::line(path, 1, format!("column \"{unknown}\" is not one of {known},{FRICTION}")));
    }
    let own_friction = place(FRICTION);
    let mut cases = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| at(&e))?;
        let line = record.position().map_or(0, |p| p.line() as usize);
        let number = |place: usize, column: &str, above: f32| {
            let field = record.get(place).unwrap_or("");
            let value = field.parse().ok().filter(|v: &f32| v.is_finite() && *v > above);
            let kind = if above == 0.0 { "a finite number above zero" } else { "a finite number" };
            value.ok_or_else(|| Error::line(path, line, format!("{column}: \"{field}\" is not {kind}")))
        };
        let mut values = [0.0; 6];
        for (i, value) in values.iter_mut().enumerate() {
            *value = number(order[i], COLUMNS[i], if i < 3 { 0.0 } else { f32::MIN })?;
        }
        let friction = own_friction.map_or(Ok(friction), |place| number(place, FRICTION, 0.0))?;
        let [a, b, normal_force, longitudinal, lateral, spin] = values;
        cases.push(Case {
            patch: Patch { semi_axes: [a, b], normal_force },
            creepages: Creepages { longitudinal, lateral, spin },
            friction,
        });
    }
    if cases.is_empty() {
        return Err(Error::file(path, "no cases"));
    }
    Ok(cases)
}

fn positive(text: &str) -> std::result::Result<f32, String> {
    let value = text.parse().ok().filter(|v: &f32| v.is_finite() && *v > 0.0);
    value.ok_or_else(|| String::from("is not a finite number above zero"))
}

fn poisson(text: &str) -> std::result::Result<f32, String> {
    let value = text.parse().ok().filter(|v: &f32| (0.0..=0.5).contains(v));
    value.ok_or_else(|| String::from("is not a number from 0 to 0.5"))
}
