//! The page that sets each figure beside what the paper says.

use std::fmt::Write;

use super::{Check, Plate};
use crate::report::page::{END, escaped, head};
use crate::report::plot::significant;

/// The whole page, self-contained.
#[must_use]
pub fn html(plates: &[Plate]) -> String {
    let mut html = head(
        "The paper's figures",
        "Santamaria, Vadillo, Gomez, \"A comprehensive method for the elastic calculation of the two-point wheel-rail \
         contact\": its figures made again by Flangeway, what the paper says of each in our words, and what comes out here. \
         Dimensions and vehicle data that the paper does not print are ours: see the recipes and scenarios. The urban pair \
         is a stand-in: its DT14 profile is not published.",
    );
    let checks: Vec<&Check> = plates.iter().flat_map(|plate| &plate.checks).collect();
    let held = checks.iter().filter(|check| check.holds).count();
    let _ = writeln!(html, "<p><b>{held} of {} claims hold.</b></p>", checks.len());
    for plate in plates {
        let _ = write!(
            html,
            "<h2>Figure {}. {}</h2>\n<figure>\n{}\n</figure>\n<table>\n<tbody>\n",
            plate.number,
            plate.title,
            plate.svg.trim_end()
        );
        for (name, text) in [("The paper", plate.theirs), ("Here", plate.ours.as_str()), ("Both", plate.difference)] {
            let _ = writeln!(html, "<tr><th scope=\"row\">{name}</th><td>{}</td></tr>", escaped(text));
        }
        for check in &plate.checks {
            let verdict = if check.holds { "holds" } else { "<b>does not hold</b>" };
            let _ = writeln!(
                html,
                "<tr><th scope=\"row\">{verdict}</th><td>{}: {} {}</td></tr>",
                escaped(check.claim),
                significant(check.measured),
                escaped(check.unit)
            );
        }
        html += "</tbody>\n</table>\n";
    }
    html += END;
    html
}
