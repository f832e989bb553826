//! The report of `verify`: where the errors are, what happens at the worst poses, and where the force changes fast.

mod classes;
mod curves;
mod maps;
mod tables;

use flangeway::{ContactTable, Side};

use super::page::{self, END, errors, head, numbered, slots};
use super::{Figure, errors as scatter};
use crate::error::Result;
use crate::naive::Beside;
use crate::pair::Pair;
use crate::progress;
use crate::verify::{Findings, Measured};

/// What the report is made from.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// The pair.
    pub pair: &'a Pair,
    /// Its table.
    pub table: &'a ContactTable<'a>,
    /// Name of the table's file.
    pub table_name: &'a str,
    /// Error figures, samples and largest changes.
    pub measured: &'a Measured,
    /// What was found in them.
    pub findings: &'a Findings,
    /// Naive tables of the same bytes; none where they were not asked for.
    pub naive: &'a [Beside],
}

/// The page, which needs nothing but itself.
///
/// # Errors
/// When the drawing library fails.
pub fn html(content: &Content<'_>) -> Result<String> {
    let Content { pair, measured, findings, .. } = *content;
    let header = content.table.header().side(Side::Right);
    let title = page::title(header);
    let words = format!(
        "Verification of {}, {} bytes, against the direct solver it was sampled from. Lateral displacement u, yaw and \
         roll are uniform over the table, the load is log-uniform from 5 to 150 kN; the error of the wheel's total \
         normal force is |table - direct| / max(direct, 5 kN).",
        content.table_name, measured.report.table_bytes
    );
    let mut html = head(&title, &words);
    html += "<div class=\"tables\">\n";
    html += &errors(&measured.report);
    html += &tables::classes(findings);
    html += &slots(pair);
    html += "</div>\n";
    if !content.naive.is_empty() {
        html += &tables::naive(content.naive);
    }
    for (index, figure) in figures(content)?.iter().enumerate() {
        html += &numbered(index + 1, figure);
    }
    html += &tables::worst(findings);
    html += &tables::changes(findings);
    html += END;
    Ok(html)
}

fn figures(content: &Content<'_>) -> Result<Vec<Figure>> {
    let Content { pair, table, measured, findings, .. } = *content;
    let samples = &measured.samples;
    let bar = progress::bar(5, "drawing");
    let done = |figure: Figure| {
        bar.inc(1);
        figure
    };
    let map = "Colour: the 95 % quantile of the poses in each cell of the picture; white: no pose. Dots mark where the \
               rigid contact changes from one slot to the next.";
    let mut figures = vec![
        done(Figure { title: "Map of the force error", svg: scatter::map(pair, table, samples)?, caption: map.into() }),
        done(Figure {
            title: "Maps by the slot that carries most",
            svg: maps::by_slot(pair, table, samples)?,
            caption: format!("The same error, each pose in the map of the slot that carries most of its force. {map}"),
        }),
        done(Figure {
            title: "Error over each coordinate",
            svg: curves::curves(table, samples)?,
            caption:
                "Median, 95 % and 99 % quantile of the poses in each of the steps along the axis. A quantile that \
                      stands out in one panel only says which axis is too coarse there."
                    .into(),
        }),
        done(Figure {
            title: "Poses by slot",
            svg: scatter::scatter(table, samples)?,
            caption: "Every pose (or a regular choice of them) in the colour of the slot that carries most.".into(),
        }),
        done(Figure {
            title: "Poses by what their cell holds",
            svg: classes::scatter(table, samples, &findings.surroundings)?,
            caption: "The same poses by class. A cell straddles a joint when the contact's place on wheel or rail, at \
                      the cell's corners that carry and at the pose, lies to both sides of one; contacts change in a \
                      cell when a slot is loaded at some of its corners only, or when peaks of one zone of \
                      interpenetration share their force."
                .into(),
        }),
    ];
    figures.extend(super::normal::figures(pair)?);
    bar.finish_and_clear();
    Ok(figures)
}
