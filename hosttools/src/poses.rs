//! Pose files: CSV with the header `y_m,yaw_rad,z_m,roll_rad`, one wheelset pose a row.

use std::path::Path;

use flangeway::{POSE_LIMIT, Pose};

use crate::error::{Error, Result};

const COLUMNS: [&str; 4] = ["y_m", "yaw_rad", "z_m", "roll_rad"];

/// Reads a pose file. Columns may stand in any order; others than the four are refused.
///
/// # Errors
/// When the file cannot be read, a column is missing or unknown, or a field is not a finite number.
pub fn read(path: &Path) -> Result<Vec<Pose>> {
    let file = std::fs::File::open(path).map_err(|e| Error::file(path, e.to_string()))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(file);
    let header = reader.headers().map_err(|e| at(path, &e))?.clone();
    let mut order = [0; 4];
    for (place, column) in order.iter_mut().zip(COLUMNS) {
        *place = header.iter().position(|name| name == column).ok_or_else(|| {
            Error::line(path, 1, format!("column {column} is missing; a pose file has {}", COLUMNS.join(",")))
        })?;
    }
    if let Some(unknown) = header.iter().find(|name| !COLUMNS.contains(name)) {
        return Err(Error::line(path, 1, format!("column \"{unknown}\" is not one of {}", COLUMNS.join(","))));
    }
    let mut poses = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| at(path, &e))?;
        let line = record.position().map_or(0, |p| p.line() as usize);
        let mut values = [0.0; 4];
        for ((value, &place), column) in values.iter_mut().zip(&order).zip(COLUMNS) {
            let field = record.get(place).unwrap_or("");
            *value = field.parse().ok().filter(|v: &f64| v.abs() <= POSE_LIMIT).ok_or_else(|| {
                Error::line(path, line, format!("{column}: \"{field}\" is not a finite number of m or rad"))
            })?;
        }
        let [lateral, yaw, vertical, roll] = values;
        poses.push(Pose { lateral, yaw, vertical, roll });
    }
    if poses.is_empty() {
        return Err(Error::file(path, "no poses"));
    }
    Ok(poses)
}

fn at(path: &Path, error: &csv::Error) -> Error {
    match error.position() {
        Some(position) => Error::line(path, position.line() as usize, error.to_string()),
        None => Error::file(path, error.to_string()),
    }
}
