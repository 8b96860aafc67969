//! The program `reality-sim`: one file a command in `commands/`.

mod commands;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, error::ErrorKind};

use commands::Command;

/// What does the camera see at this pose? Real pictures for robot simulators, by pose.
#[derive(Debug, Parser)]
#[command(name = "reality-sim", version, about, disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Err(message) = cli.command.check_usage() {
        Cli::command().error(ErrorKind::ArgumentConflict, message).exit();
    }
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", one_line(&format!("{error:#}")));
            ExitCode::FAILURE
        }
    }
}

/// A message without line breaks and other control characters.
fn one_line(message: &str) -> String {
    let printable: String =
        message.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    printable.split_whitespace().collect::<Vec<_>>().join(" ")
}
