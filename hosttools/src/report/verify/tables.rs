//! The tables of the report.

use std::fmt::Write;

use flangeway::Slot;
use plotters::style::RGBColor;

use super::classes::colour;
use crate::naive::Beside;
use crate::report::page::escaped;
use crate::verify::{Class, Findings, LargeChange, NearJoint, Quantiles, WorstPose};

/// Head of a table with a caption; names that begin with a space are columns of words.
fn begin(caption: &str, names: &[&str]) -> String {
    let mut html = format!("<table>\n<caption>{}</caption>\n<thead><tr>", escaped(caption));
    for name in names {
        let class = if name.starts_with(' ') { "" } else { " class=\"number\"" };
        let _ = write!(html, "<th{class}>{}</th>", escaped(name.trim()));
    }
    html + "</tr></thead>\n<tbody>\n"
}

/// Joints farther from a contact (m) than this are not told.
const NEAR: f64 = 5e-3;

const END: &str = "</tbody>\n</table>\n";

fn number(html: &mut String, text: &str) {
    let _ = write!(html, "<td class=\"number\">{}</td>", escaped(text));
}

fn words(html: &mut String, text: &str) {
    let _ = write!(html, "<td>{}</td>", escaped(text));
}

fn percents(html: &mut String, q: &Quantiles, with_max: bool) {
    let values = [q.rms, q.median, q.p95, q.p99, q.max];
    for value in values.iter().take(if with_max { 5 } else { 4 }) {
        number(html, &format!("{:.3}", 1e2 * value));
    }
}

/// Errors by class of cell.
pub(super) fn classes(findings: &Findings) -> String {
    let names = [" cell holds", "poses", "rms", "median", "95 %", "99 %", "largest", "of squares"];
    let mut html = begin("Force error (%) by what the cell holds", &names);
    for row in &findings.classes {
        let RGBColor(r, g, b) = colour(row.class);
        let _ = write!(
            html,
            "<tr><th scope=\"row\"><span class=\"chip\" style=\"background:#{r:02x}{g:02x}{b:02x}\"></span>{}</th>",
            row.class.words()
        );
        number(&mut html, &row.samples.to_string());
        percents(&mut html, &row.normal_force, true);
        number(&mut html, &format!("{:.1} %", 1e2 * row.share_of_squares));
        html += "</tr>\n";
    }
    html + END
}

/// The naive table beside this one.
pub(super) fn naive(tables: &[Beside]) -> String {
    let text = "The paper's coordinates and storage at the same bytes and the same poses: uniform nodes over raw y, yaw, \
                z and roll of the wheelset, windows of z and roll centred on its rigid contact, unsigned indentation, \
                contacts in the order in which they are found along the profile, linear interpolation of everything \
                but N, a and b, 60 bytes a node. Several windows and proportions of the node counts are tried, and \
                the best table is taken: for all poses, and again for fewer poses on which raw coordinates do better, \
                each time with all the bytes for just these poses, against the same table of ours.";
    let mut html = format!("<h2>Against a naive table</h2>\n<p>{}</p>\n<div class=\"tables\">\n", escaped(text));
    for table in tables {
        html += &side_by_side(table);
    }
    html + "</div>\n"
}

fn side_by_side(Beside { poses, samples, naive, ours, factor }: &Beside) -> String {
    let mut html = String::from("<div>\n");
    html += &begin(&format!("Force error (%), {poses} ({samples})"), &[" table", "rms", "median", "95 %", "99 %"]);
    for (name, figures) in [("naive", &naive.normal_force), ("this table", ours)] {
        let _ = write!(html, "<tr><th scope=\"row\">{name}</th>");
        percents(&mut html, figures, false);
        html += "</tr>\n";
    }
    html += "<tr><th scope=\"row\">factor</th>";
    for value in [factor.rms, factor.median, factor.p95, factor.p99] {
        number(&mut html, &format!("{value:.1}"));
    }
    html += "</tr>\n";
    html += END;
    let d = &naive.design;
    let [y, yaw, z, roll] = d.nodes;
    let [[y0, y1], _, [z0, z1], [r0, r1]] = d.ranges.map(|range| range.map(|x| 1e3 * x));
    let text = format!(
        "The best of {}: {y} x {yaw} x {z} x {roll} nodes (y, yaw, z, roll), {} bytes; y from {y0:.2} to {y1:.2} mm, \
         windows of {z0:.2} to {z1:.2} mm and {r0:.2} to {r1:.2} mrad, made for {} % of the poses ({:.1} % lie \
         outside, clamped); {} where a contact is missing.",
        naive.trials,
        naive.bytes,
        1e2 * d.covered,
        1e2 * naive.outside,
        if d.borrowed { "the stiffness of the contact below" } else { "no stiffness" }
    );
    let _ = write!(html, "<p style=\"max-width:60ch\">{}</p>\n</div>\n", escaped(&text));
    html
}

/// The worst poses.
pub(super) fn worst(findings: &Findings) -> String {
    let mut html = String::from("<h2>The worst poses</h2>\n<div style=\"overflow-x:auto\">\n");
    let names = [
        "",
        "error %",
        "u mm",
        "yaw mrad",
        "roll mrad",
        "height µm",
        " forces, kN: direct (table)",
        " what happens there",
    ];
    html += &begin(
        "Roll and height about the rigid contact; distances of joints along the profile, positive towards the field side",
        &names,
    );
    for (index, pose) in findings.worst.iter().enumerate() {
        html += "<tr>";
        number(&mut html, &(index + 1).to_string());
        number(&mut html, &format!("{:.1}", 1e2 * pose.error));
        number(&mut html, &format!("{:.3}", 1e3 * pose.lateral_m));
        number(&mut html, &format!("{:.2}", 1e3 * pose.yaw_rad));
        number(&mut html, &format!("{:.2}", 1e3 * pose.roll_offset_rad));
        number(&mut html, &format!("{:.1}", 1e6 * pose.vertical_m));
        words(&mut html, &forces(pose));
        words(&mut html, &happens(pose));
        html += "</tr>\n";
    }
    html + END + "</div>\n"
}

fn forces(pose: &WorstPose) -> String {
    let of = |slot: Slot| {
        let (direct, table) = (1e-3 * pose.direct_n[slot.index()], 1e-3 * pose.table_n[slot.index()]);
        (direct.max(table) > 0.0).then(|| format!("{slot} {direct:.1} ({table:.1})"))
    };
    Slot::ALL.into_iter().filter_map(of).collect::<Vec<_>>().join(", ")
}

fn happens(pose: &WorstPose) -> String {
    let mut parts = Vec::new();
    if !pose.onset.is_empty() {
        parts.push(format!("contact begins in the cell: {}", pose.onset.join(", ")));
    }
    if !pose.leaning.is_empty() {
        parts.push(format!("leans on its edge at a corner: {}", pose.leaning.join(", ")));
    }
    if pose.least_share < 1.0 - 1e-6 {
        parts.push(format!("{} peaks, merging: one keeps {:.0} %", pose.peaks, 1e2 * pose.least_share));
    }
    if pose.class == Class::Joint || pose.class == Class::Both {
        parts.push("a joint inside the cell".into());
    }
    let joint = |what: &str, joint: &NearJoint| {
        let [a, b] = joint.curvature_per_m;
        format!("{what} joint ({a:.0} to {b:.0} per m) at {:+.2} mm", 1e3 * joint.distance_m)
    };
    for (what, near) in [("wheel", &pose.wheel_joint), ("rail", &pose.rail_joint)] {
        let near = near.iter().filter(|near| near.distance_m.abs() < NEAR);
        parts.extend(near.map(|near| joint(what, near)));
    }
    if pose.beyond_vertical_axis {
        parts.push("above the vertical axis, extrapolated".into());
    }
    parts.push(format!("cell {:.0} µm wide", 1e6 * pose.lateral_width_m));
    parts.join("; ")
}

/// The largest changes over a tiny step.
pub(super) fn changes(findings: &Findings) -> String {
    let changes = &findings.changes;
    let text = format!(
        "The largest relative change of the total force over a step of 10 nm lateral or vertical or 10 nrad of yaw or \
         roll, loads over 5 kN, along {} random lines of which {} cross a change of contacts; on each line the search \
         bisects towards the largest change. A jump keeps more than half of its change when the step is halved six \
         times; what is no jump is a steep slope.",
        changes.lines, changes.crossing
    );
    let mut html = format!("<h2>Continuity</h2>\n<p>{}</p>\n<div style=\"overflow-x:auto\">\n", escaped(&text));
    html += &large("The table's largest changes", &changes.table);
    html += &large("The direct solver's largest changes", &changes.direct);
    html + "</div>\n"
}

fn large(caption: &str, rows: &[LargeChange]) -> String {
    let names = [
        "change %",
        "force kN",
        " step",
        "u mm",
        "yaw mrad",
        "roll mrad",
        "s mm",
        " kind",
        " what the direct solver shows",
    ];
    let mut html = begin(caption, &names);
    for row in rows {
        html += "<tr>";
        number(&mut html, &format!("{:.4}", 1e2 * row.relative));
        number(&mut html, &format!("{:.1}", 1e-3 * row.force_n));
        words(&mut html, &format!("{:?}", row.direction).to_lowercase());
        number(&mut html, &format!("{:.4}", 1e3 * row.lateral_m));
        number(&mut html, &format!("{:.3}", 1e3 * row.yaw_rad));
        number(&mut html, &format!("{:.3}", 1e3 * row.roll_offset_rad));
        number(&mut html, &format!("{:.2}", 1e3 * row.profile_m));
        words(&mut html, if row.jump { "jump" } else { "slope" });
        let [before, after] = row.peaks;
        let peaks = if before == after { format!("{before}") } else { format!("{before} to {after}") };
        words(
            &mut html,
            &format!(
                "{} (peaks {peaks}; contact point {:.1} times as fast as the step; share changes by {:.2} %)",
                row.cause.words(),
                row.speed,
                1e2 * row.share
            ),
        );
        html += "</tr>\n";
    }
    html + END
}
