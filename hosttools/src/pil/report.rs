//! A run in figures: text and JSON.

use flangeway_pil::Unit;
use serde_json::{Value, json as object};

use super::{Report, Settings, unit_words};

/// The run in lines for people.
#[must_use]
pub fn lines(report: &Report, settings: &Settings) -> String {
    let Report { board, exchanges, mismatches, retries, damaged: [to_board, to_host], counts: [least, most], .. } =
        report;
    let mut lines = vec![
        format!("board {}: {exchanges} exchanges in {:.1} s, {} contacts", board.name, report.seconds, report.contacts),
        match report.first_mismatch {
            None => "  every answer is the host's, bit for bit".into(),
            Some(step) => format!("  {mismatches} answers differ from the host's, the first at step {step}"),
        },
        format!(
            "  asked again {} times: {} requests and {} answers damaged, {} not answered in time, line reopened {}, board \
             restarted {}; {} late or repeated answers dropped",
            retries.total(),
            retries.request_damaged,
            retries.answer_damaged,
            retries.no_answer,
            retries.line_reopened,
            retries.board_restarted,
            report.dropped
        ),
    ];
    if settings.damage > 0.0 {
        lines.push(format!(
            "  damaged on purpose: {} frames to the board, {} to the host",
            to_board.total(),
            to_host.total()
        ));
    }
    if board.unit != Unit::Nothing {
        lines.push(format!("  {} a step of two wheels: {least} to {most}", unit_words(board.unit)));
    }
    lines.join("\n")
}

/// The run as JSON.
#[must_use]
pub fn json(report: &Report, settings: &Settings) -> Value {
    let Report { board, damaged: [to_board, to_host], counts: [least, most], .. } = report;
    object!({
        "board": board.name,
        "table_bytes": board.table_length,
        "exchanges": report.exchanges,
        "contacts": report.contacts,
        "mismatches": report.mismatches,
        "retries": report.retries.total(),
        "retries_by_cause": report.retries,
        "dropped": report.dropped,
        "damage": settings.damage,
        "seed": settings.seed,
        "damaged": { "to_board": to_board, "to_host": to_host },
        "count_unit": unit_words(board.unit),
        "count_min": least,
        "count_max": most,
        "seconds": report.seconds,
    })
}
