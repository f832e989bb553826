//! `flangeway inspect`: what a table says of itself.

use std::path::PathBuf;

use flangeway::{AxisName, Channel, Side, Slot};
use serde_json::{Value, json};

use super::{print, print_json, read_table, view_table};
use crate::error::Result;

/// Arguments of `flangeway inspect`.
#[derive(Debug, Clone, clap::Args)]
pub struct InspectArgs {
    /// Table
    #[arg(value_name = "T.fwt")]
    pub table: PathBuf,
    /// Print as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Checks the table as the kernel does and prints its header.
///
/// # Errors
/// When the file cannot be read or is not a table.
pub fn run(args: &InspectArgs) -> Result<()> {
    let image = read_table(&args.table)?;
    let table = view_table(&args.table, &image)?;
    let header = table.header();
    let axes: serde_json::Map<String, Value> = AxisName::ALL
        .into_iter()
        .map(|name| {
            let axis = table.axis(name);
            let (first, last) = axis.range();
            let mut value = json!({ "nodes": axis.len(), "range": [first, last] });
            if let Some(parts) = header.refinement.get(name.index()) {
                value["rigid_parts"] = json!(parts);
            }
            (name.to_string().replace(' ', "_"), value)
        })
        .collect();
    let sides: serde_json::Map<String, Value> = Side::ALL
        .into_iter()
        .take(header.sides())
        .map(|side| {
            let s = header.side(side);
            let scales: serde_json::Map<String, Value> = Slot::ALL
                .into_iter()
                .map(|slot| {
                    let scales = &s.scales[slot.index()];
                    let channels: serde_json::Map<String, Value> = Channel::ALL
                        .into_iter()
                        .map(|c| {
                            let scale = scales[c.index()];
                            (c.to_string(), json!({ "offset": scale.offset, "step": scale.step }))
                        })
                        .collect();
                    (slot.to_string(), Value::Object(channels))
                })
                .collect();
            let value = json!({
                "wheel": s.wheel,
                "wheel_sha256": hex(&s.wheel_sha256),
                "rail": s.rail,
                "rail_sha256": hex(&s.rail_sha256),
                "nominal_radius_m": s.geometry.nominal_radius,
                "lateral_position_m": s.geometry.lateral_position,
                "slot_boundaries_m": s.slot_boundaries,
                "scales": scales,
            });
            (side.to_string(), value)
        })
        .collect();
    let e = &header.errors;
    let document = json!({
        "file": args.table.display().to_string(),
        "bytes": image.len(),
        "generator": header.generator,
        "solver": header.solver,
        "recipe_sha256": hex(&header.recipe_sha256),
        "gauge_m": header.gauge,
        "youngs_modulus_pa": header.material.young_modulus,
        "poisson_ratio": header.material.poisson_ratio,
        "axes": axes,
        "sides": sides,
        "errors": {
            "samples": e.samples,
            "seed": e.seed,
            "force_rms": e.force_rms,
            "force_median": e.force_median,
            "force_p95": e.force_p95,
            "force_p99": e.force_p99,
            "force_max": e.force_max,
            "continuity": e.continuity,
        },
    });
    if args.json { print_json(&document) } else { print(&lines(&document)) }
}

/// The document as indented lines; scales are left to the JSON.
fn lines(document: &Value) -> String {
    let Value::Object(entries) = document else { return String::new() };
    let mut lines = Vec::new();
    for (key, value) in entries {
        match value {
            Value::Object(inner) => {
                lines.push(format!("{key}:"));
                for (key, value) in inner {
                    match value {
                        Value::Object(fields) => {
                            let shown = fields.iter().filter(|(name, _)| *name != "scales");
                            let shown: Vec<String> = shown.map(|(name, value)| format!("{name} {value}")).collect();
                            lines.push(format!("  {key}: {}", shown.join(", ")));
                        }
                        _ => lines.push(format!("  {key}: {value}")),
                    }
                }
            }
            _ => lines.push(format!("{key}: {value}")),
        }
    }
    lines.join("\n")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
