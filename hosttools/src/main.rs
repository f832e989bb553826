//! The `flangeway` program: reads its arguments, runs one command, and turns the outcome into an exit status.

use std::process::ExitCode;

use clap::Parser;
use flangeway_host::commands::{Cli, Outcome};

fn main() -> ExitCode {
    match Cli::parse().run() {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Err(error) => {
            eprintln!("flangeway: {error}");
            ExitCode::from(2)
        }
    }
}
