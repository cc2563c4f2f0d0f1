//! The commands. Raw arguments become one valid command before anything runs;
//! a command returns what to say, and one place says it.

mod args;
mod bake;
mod diff;
mod error;
mod golden;
mod info;
mod measure;
mod preview;
mod reference;
mod render;
mod report;
mod run;
mod signals;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use error::CliError;
use report::Report;

/// Runs the program; the exit code is 0 fine, 1 images differ or a check failed, 2 wrong usage or
/// a scene that cannot be understood, 3 a file that could not be read or
/// written, 130 after Ctrl-C, 143 after SIGTERM.
pub(crate) fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let json = arguments.command.run_arguments().json;
    let printed = execute(&arguments.command).and_then(|report| {
        report.print(json)?;
        Ok(report.exit_code)
    });
    match printed {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            error.print();
            ExitCode::from(error.exit_code())
        }
    }
}

fn execute(command: &Command) -> Result<Report, CliError> {
    match command {
        Command::Render(arguments) => render::execute(arguments),
        Command::Bake(arguments) => bake::execute(arguments),
        Command::Info(arguments) => info::execute(arguments),
        Command::Diff(arguments) => diff::execute(arguments),
        Command::Golden(arguments) => golden::execute(arguments),
        Command::Reference(arguments) => reference::execute(arguments),
        Command::Measure(arguments) => measure::execute(arguments),
        Command::Preview(arguments) => preview::execute(arguments),
    }
}
