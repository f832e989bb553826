//! The report of a campaign: the grid of pairs, on one page that needs nothing but itself. Tables are linked.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::page::{END, escaped, head};
use crate::campaign::{CELLS, Entry, LOAD, Manifest, Record, State, Summary, conicity};

/// Colours by the number of contacts, 0 to 3: P. Tol's high-contrast scheme, and white where the load is not reached.
const COUNTS: [&str; 4] = ["#fff", "#e4e4de", "#004488", "#bb5566"];
/// Width and height of a cell of a map (pixels).
const PIXELS: [usize; 2] = [4, 5];
const STYLE: &str = "<style>\
table.grid td,table.grid th{border:1px solid #ddd;padding:6px 8px;vertical-align:top}\
table.grid td{font-size:13px;line-height:1.35;white-space:nowrap}\
table.grid svg{width:160px;height:60px;display:inline-block;margin:4px 0 0}\
.lacking{background:#fbeaec}.scroll{overflow-x:auto}</style>\n";

/// The page: `folder` names the campaign, `records` are what its tables' compilations have left, by identifier.
pub fn html(
    folder: &str,
    manifest: &Manifest,
    tables: &[(&Entry, &Summary)],
    records: &BTreeMap<String, Record>,
) -> String {
    let whole = tables.iter().filter(|(_, summary)| summary.state == State::Whole).count();
    let broken: Vec<_> = manifest.broken().collect();
    let mut html = head(
        &format!("Campaign {}", escaped(folder)),
        &format!(
            "{whole} of {} tables are there and whole; {} more have a broken profile. Force error is that of the total \
             normal force against the direct solver, as measured when the table was compiled. Equivalent conicity is tan γe \
             at y = {} mm to EN 15302 by integration of the kinematic motion (its Annex B), from the rigid contact of the \
             wheelset with its roll. The small maps count the contacts of the right wheel that carry under {} kN.",
            tables.len(),
            broken.len(),
            1e3 * conicity::AMPLITUDE,
            1e-3 * LOAD
        ),
    );
    html += STYLE;
    html += &legend(tables);
    for (title, group) in groups(tables) {
        html += &grid(&title, &group, records);
    }
    html += &list("Not there", &lacking(tables, records, &broken));
    html += &list("Warnings", &warnings(tables, records));
    html += END;
    html
}

type Table<'a> = (&'a Entry, &'a Summary);

/// Tables by what varies besides the two profiles.
fn groups<'a>(tables: &[Table<'a>]) -> BTreeMap<String, Vec<Table<'a>>> {
    let mut groups: BTreeMap<String, Vec<Table<'_>>> = BTreeMap::new();
    for table in tables {
        groups.entry(table.0.others()).or_default().push(*table);
    }
    groups
}

fn legend(tables: &[Table<'_>]) -> String {
    let mut html = String::from("<p>Contacts: ");
    for (count, words) in ["load beyond the table", "one", "two", "three"].iter().enumerate() {
        let _ = write!(
            html,
            "<span class=\"chip\" style=\"background:{};border:1px solid #999\"></span>{words} &nbsp; ",
            COUNTS[count]
        );
    }
    let known = tables.iter().map(|(_, summary)| summary).find(|summary| summary.state == State::Whole);
    if let Some(Summary { ends: [lateral, yaw], .. }) = known {
        let [from, to] = lateral.map(|u| 1e3 * u);
        let _ = write!(
            html,
            "To the right: lateral displacement, {from:.1} to {to:.1} mm; upwards: yaw, {:.1} to {:.1} mrad (of the first \
             table; others by their own ranges).",
            1e3 * yaw[0],
            1e3 * yaw[1]
        );
    }
    html += "</p>\n";
    html
}

/// Wheels down, rails across.
fn grid(title: &str, tables: &[Table<'_>], records: &BTreeMap<String, Record>) -> String {
    let (mut wheels, mut rails) = (Vec::new(), Vec::new());
    let mut cells: BTreeMap<(&str, &str), Table<'_>> = BTreeMap::new();
    for table in tables {
        let (wheel, rail) = table.0.names();
        if !wheels.contains(&wheel) {
            wheels.push(wheel);
        }
        if !rails.contains(&rail) {
            rails.push(rail);
        }
        cells.insert((wheel, rail), *table);
    }
    let title = if title.is_empty() { "Pairs" } else { title };
    let mut html =
        format!("<h2>{}</h2>\n<div class=\"scroll\"><table class=\"grid\">\n<thead><tr><th></th>", escaped(title));
    for rail in &rails {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escaped(rail));
    }
    html += "</tr></thead>\n<tbody>\n";
    for wheel in wheels {
        let _ = write!(html, "<tr><th scope=\"row\">{}</th>", escaped(wheel));
        for rail in &rails {
            html += &cells.get(&(wheel, *rail)).map_or("<td></td>".into(), |table| cell(table, records));
        }
        html += "</tr>\n";
    }
    html += "</tbody>\n</table></div>\n";
    html
}

fn cell((entry, summary): &Table<'_>, records: &BTreeMap<String, Record>) -> String {
    let Some(errors) = summary.errors else {
        let why = match (&summary.state, records.get(&entry.id).and_then(Record::reason)) {
            (_, Some(_)) => "failed",
            (State::Missing, None) => "missing",
            _ => "damaged",
        };
        return format!("<td class=\"lacking\">{why}</td>");
    };
    let conicity = summary.conicity.map_or("none".into(), |conicity| format!("{conicity:.3}"));
    format!(
        "<td><a href=\"tables/{id}.fwt\" title=\"{label}\">{}…</a>, {:.0} kB<br>force error {:.2} %, 95 % of poses<br>\
         conicity {conicity}<br>{}</td>",
        &entry.id[..8.min(entry.id.len())],
        1e-3 * summary.bytes as f64,
        1e2 * errors.force_p95,
        map(&summary.contacts),
        id = entry.id,
        label = escaped(&entry.label),
    )
}

/// The map of contacts as a drawing: one path a count, a rectangle for each run of cells.
fn map(contacts: &[u8]) -> String {
    let [across, up] = CELLS;
    let [width, height] = PIXELS;
    let mut svg =
        format!("<svg role=\"img\" aria-label=\"contacts\" viewBox=\"0 0 {} {}\">", across * width, up * height);
    for (count, colour) in COUNTS.iter().enumerate() {
        let mut path = String::new();
        for row in 0..up {
            let is = |column: usize| contacts.get(column * up + row).is_some_and(|&c| usize::from(c).min(3) == count);
            let mut column = 0;
            while column < across {
                let run = (column..across).take_while(|&c| is(c)).count();
                if run > 0 {
                    let (x, y) = (column * width, (up - 1 - row) * height);
                    let _ = write!(path, "M{x} {y}h{}v{height}h-{}z", run * width, run * width);
                }
                column += run.max(1);
            }
        }
        if !path.is_empty() {
            let _ = write!(svg, "<path fill=\"{colour}\" d=\"{path}\"/>");
        }
    }
    svg + "</svg>"
}

/// What is not there, with the reason.
fn lacking(tables: &[Table<'_>], records: &BTreeMap<String, Record>, broken: &[(&str, &str)]) -> Vec<(String, String)> {
    let reason = |(entry, summary): &Table<'_>| {
        let why = match (&summary.state, records.get(&entry.id).and_then(Record::reason)) {
            (State::Whole, _) => return None,
            (_, Some(reason)) => reason.to_owned(),
            (State::Missing, None) => "not compiled yet".into(),
            (State::Damaged(reason), None) => format!("damaged: {reason}"),
        };
        Some((entry.label.clone(), why))
    };
    let broken = broken.iter().map(|(label, reason)| ((*label).to_owned(), (*reason).to_owned()));
    broken.chain(tables.iter().filter_map(reason)).collect()
}

/// What the compiler has warned of.
fn warnings(tables: &[Table<'_>], records: &BTreeMap<String, Record>) -> Vec<(String, String)> {
    let of = |(entry, _): &Table<'_>| {
        let warnings = records.get(&entry.id).map(|record| record.warnings.as_slice()).unwrap_or_default();
        warnings.iter().map(|warning| (entry.label.clone(), warning.clone())).collect::<Vec<_>>()
    };
    tables.iter().flat_map(of).collect()
}

/// Tables and words, nothing where there are none.
fn list(title: &str, rows: &[(String, String)]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut html = format!("<h2>{title}</h2>\n<table>\n<tbody>\n");
    for (label, words) in rows {
        let _ = writeln!(html, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", escaped(label), escaped(words));
    }
    html += "</tbody>\n</table>\n";
    html
}
