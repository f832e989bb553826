//! `compare poses FILE` writes the poses that the firmware looks up; `compare check TARGET ANSWERS SIZES` holds its answers
//! against the host's, bit for bit, and prints a line of JSON. SIZES are fields of it that `run.sh` measures.

mod answers;
mod creep;
mod poses;

use std::process::ExitCode;

use answers::Report;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["poses", file] => std::fs::write(file, poses::bytes()).map(|()| true).map_err(|e| format!("{file}: {e}")),
        ["check", target, file, sizes] => check(target, file, sizes),
        _ => Err("compare poses FILE, or compare check TARGET ANSWERS SIZES".into()),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("compare: {message}");
            ExitCode::from(2)
        }
    }
}

/// Prints the figures of a target; whether every answer is the host's.
fn check(target: &str, file: &str, sizes: &str) -> Result<bool, String> {
    let bytes = std::fs::read(file).map_err(|e| format!("{file}: {e}"))?;
    let report = Report::of(&bytes).map_err(|e| format!("{file}: {e}"))?;
    let Report { poses, mismatches, lookup, laws, thousand, stack, check_stack, contacts } = report;
    let [creep, fastsim] = laws;
    println!(
        "{{\"target\": \"{target}\", \"poses\": {poses}, \"mismatches\": {mismatches}, {}, {}, {}, \"stack_bytes\": {stack}, \
         \"startup_stack_bytes\": {check_stack}, {sizes}, \"thousand_nops\": {thousand}, \"poses_by_contacts\": {contacts:?}}}",
        lookup.fields(""),
        creep.fields("creep_"),
        fastsim.fields("fastsim_")
    );
    Ok(mismatches == 0)
}
