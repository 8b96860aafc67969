//! The program `reality-sim`, with one file per command in `commands/`.

mod commands;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, error::ErrorKind};

use commands::{Command, advice};
use reality_sim::sequence::one_line;

/// What does the camera see at this pose? Answers with recorded pictures, for robot simulators
#[derive(Debug, Parser)]
#[command(name = "reality-sim", version, disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    quiet_drivers();
    let cli = Cli::parse();
    if let Err(message) = cli.command.check_usage() {
        Cli::command().error(ErrorKind::ArgumentConflict, message).exit();
    }
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let advice = advice(&error).map_or_else(String::new, |advice| format!(" ({advice})"));
            eprintln!("error: {}{advice}", message(&error));
            ExitCode::FAILURE
        }
    }
}

/// Disables Mesa's device-select layer: whenever adapters are listed without a display, it complains on standard error
/// among the program's own messages. Adapters are ordered without its help.
fn quiet_drivers() {
    // SAFETY: the program has no other thread yet that could read the environment at the same time.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
}

/// Joins the messages of an error and its causes on one line. A cause that the message already quotes is left out.
fn message(error: &anyhow::Error) -> String {
    error.chain().map(one_line).fold(String::new(), |message, cause| {
        if message.is_empty() {
            cause
        } else if message.contains(&cause) {
            message
        } else {
            format!("{message}: {cause}")
        }
    })
}
