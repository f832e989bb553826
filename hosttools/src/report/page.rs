//! The page around the figures.

use std::fmt::Write;

use flangeway::{AxisName, Side, Slot};

use super::style::colour;
use super::{Content, Figure};
use crate::pair::Pair;
use crate::verify::{Quantiles, Report};

const STYLE: &str = "\
body{margin:0 auto;padding:24px;max-width:1200px;font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff}\
h1{font-size:28px;margin:0 0 4px}h2{font-size:20px;margin:40px 0 8px}p{max-width:75ch;margin:8px 0}\
.tables{display:flex;flex-wrap:wrap;align-items:flex-start;gap:8px 48px}\
table{border-collapse:collapse;margin:8px 0}caption{text-align:left;white-space:nowrap;font-weight:600;padding:4px 0}\
th,td{padding:3px 14px 3px 0;text-align:left;font-weight:400;border-bottom:1px solid #ddd;vertical-align:top}\
thead th{color:#555}.number{text-align:right;font-variant-numeric:tabular-nums}\
figure{margin:0}svg{display:block;width:100%;height:auto}figcaption{max-width:90ch;color:#333}\
.chip{display:inline-block;width:12px;height:12px;margin-right:6px;border-radius:2px}";

/// The whole page.
pub(super) fn page(content: &Content<'_>, figures: &[Figure]) -> String {
    let header = content.table.header().side(Side::Right);
    let title = title(header);
    let mut html = head(
        &title,
        "A contact table by Flangeway, measured against the direct solver it was sampled from. Track frame: x forward, \
         y to the right, z down.",
    );
    html += "<div class=\"tables\">\n";
    html += &made_of(content);
    html += &slots(content.pair);
    html += &errors(content.report);
    html += "</div>\n";
    for (index, figure) in figures.iter().enumerate() {
        html += &numbered(index + 1, figure);
    }
    html += END;
    html
}

/// The end of every page.
pub(crate) const END: &str = "</body>\n</html>\n";

/// The beginning of a page: title (escaped already) and a sentence below it.
pub(crate) fn head(title: &str, words: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}: Flangeway report</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p>{}</p>\n",
        escaped(words)
    )
}

/// A figure under its number and title.
pub(super) fn numbered(number: usize, figure: &Figure) -> String {
    let Figure { title, svg, caption } = figure;
    format!(
        "<h2>{number}. {title}</h2>\n<figure>\n{}\n<figcaption>{}</figcaption>\n</figure>\n",
        svg.trim_end(),
        escaped(caption)
    )
}

fn row(html: &mut String, name: &str, value: &str) {
    let _ = writeln!(html, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", escaped(name), escaped(value));
}

fn made_of(content: &Content<'_>) -> String {
    let (recipe, header) = (content.recipe, content.table.header());
    let (wheel, rail) = (&recipe.wheel, &recipe.rail);
    let mut html = String::from("<table>\n<caption>Pair and table</caption>\n<tbody>\n");
    let mm = |x: f64| format!("{:.1} mm", 1e3 * x);
    row(&mut html, "Wheel", &format!("{}, nominal radius {}", wheel.profile, mm(wheel.nominal_radius_m)));
    row(&mut html, "Flange backs", &format!("{} apart", mm(wheel.flange_back_spacing_m)));
    let gauge = rail
        .gauge_m
        .map_or(String::new(), |gauge| format!(", gauge {} at {} below the crown", mm(gauge), mm(rail.gauge_height_m)));
    let inclined =
        if rail.cant_rad == 0.0 { "upright".into() } else { format!("inclined 1:{:.0}", 1.0 / rail.cant_rad) };
    row(&mut html, "Rail", &format!("{}, {inclined}{gauge}", rail.profile));
    row(&mut html, "Solver", header.solver);
    row(
        &mut html,
        "Table",
        &format!("{}, {} bytes, compiled in {:.1} s", content.table_name, content.bytes, content.seconds),
    );
    for (name, what, unit, scale) in [
        (AxisName::Lateral, "Lateral displacement u", "mm", 1e3),
        (AxisName::Yaw, "Yaw", "mrad", 1e3),
        (AxisName::RollOffset, "Roll about the rigid one", "mrad", 1e3),
        (AxisName::Vertical, "Height about the rigid one", "mm", 1e3),
    ] {
        let axis = content.table.axis(name);
        let (first, last) = axis.range();
        row(&mut html, what, &format!("{:.3} to {:.3} {unit}, {} nodes", first * scale, last * scale, axis.len()));
    }
    html += "</tbody>\n</table>\n";
    html
}

/// The error figures.
pub(super) fn errors(report: &Report) -> String {
    let mut html = format!(
        "<table>\n<caption>Errors over {} random poses (seed {})</caption>\n<thead><tr><th></th>",
        report.samples, report.seed
    );
    for name in ["rms", "median", "95 %", "99 %", "largest"] {
        let _ = write!(html, "<th class=\"number\">{name}</th>");
    }
    html += "</tr></thead>\n<tbody>\n";
    let rows: [(&str, &Quantiles, f64); 4] = [
        ("Normal force (%)", &report.normal_force, 1e2),
        ("Position (mm)", &report.position_m, 1e3),
        ("Contact angle (mrad)", &report.angle_rad, 1e3),
        ("Semi-axes (%)", &report.semi_axes, 1e2),
    ];
    for (name, q, unit) in rows {
        let _ = write!(html, "<tr><th scope=\"row\">{name}</th>");
        for value in [q.rms, q.median, q.p95, q.p99, q.max] {
            let _ = write!(html, "<td class=\"number\">{:.3}</td>", unit * value);
        }
        html += "</tr>\n";
    }
    let _ = write!(
        html,
        "</tbody>\n</table>\n<table>\n<caption>Contacts and continuity</caption>\n<tbody>\n\
         <tr><th scope=\"row\">Poses with another number of contacts</th><td class=\"number\">{:.2} %</td></tr>\n\
         <tr><th scope=\"row\">Largest change of force over 10 nm or 10 nrad, table</th>\
         <td class=\"number\">{:.3} %</td></tr>\n\
         <tr><th scope=\"row\">The same, direct solver</th><td class=\"number\">{:.3} %</td></tr>\n\
         </tbody>\n</table>\n",
        1e2 * report.other_count,
        1e2 * report.continuity,
        1e2 * report.continuity_direct
    );
    html
}

/// The slots and their ranges.
pub(super) fn slots(pair: &Pair) -> String {
    let mut html = String::from("<table>\n<caption>Slots, by the wheel-profile coordinate s</caption>\n<tbody>\n");
    for side in Side::ALL.into_iter().take(pair.sides()) {
        let [upper, lower] = pair.body(side).boundaries().map(|s| 1e3 * s);
        let which = if pair.sides() == 1 { String::new() } else { format!(" ({side} wheel)") };
        for slot in Slot::ALL {
            let range = match slot {
                Slot::Tread => format!("s above {upper:.1} mm"),
                Slot::FlangeRoot => format!("s from {lower:.1} to {upper:.1} mm"),
                Slot::Flange => format!("s below {lower:.1} mm"),
            };
            let plotters::style::RGBColor(r, g, b) = colour(slot);
            let _ = writeln!(
                html,
                "<tr><th scope=\"row\"><span class=\"chip\" style=\"background:#{r:02x}{g:02x}{b:02x}\"></span>\
                 {slot}{which}</th><td>{range}</td></tr>"
            );
        }
    }
    html += "</tbody>\n</table>\n";
    html
}

/// Wheel on rail, as a heading: built-in names in capitals, file names as they are.
pub(super) fn title(header: &flangeway::SideHeader<'_>) -> String {
    let name = |name: &str| escaped(&if name.contains('.') { name.to_owned() } else { name.to_uppercase() });
    format!("{} on {}", name(header.wheel), name(header.rail))
}

/// Text with the characters that mean something in HTML written out.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
