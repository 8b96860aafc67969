//! The program `reality-sim`, with one file per command in `commands/`.

mod commands;

use std::process::ExitCode;

use clap::{Arg, ArgMatches, CommandFactory, FromArgMatches, Parser, error::ErrorKind};

use commands::{Command, advice, be_quiet};
use reality_sim::sequence::{hold_writing, one_line};
use reality_sim_formats::show::remove_unfinished_logs;

/// Exit status of an interrupted program: 128 and the number of the signal, as shells have it.
const INTERRUPTED: i32 = 130;

/// What does the camera see at this pose? Answers with recorded pictures, for robot simulators
#[derive(Debug, Parser)]
#[command(name = "reality-sim", version)]
struct Cli {
    /// Print neither a report in words nor progress; files, JSON and errors are still written
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    quiet_drivers();
    finish_files_when_interrupted();
    let matches = program().get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    if cli.quiet {
        be_quiet();
    }
    if let Err(message) = cli.command.check_usage() {
        usage_error(&matches, message).exit();
    }
    match cli.command.run::<Cli>() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let advice = advice(&error).map_or_else(String::new, |advice| format!(" ({advice})"));
            eprintln!("error: {}{advice}", message(&error));
            ExitCode::FAILURE
        }
    }
}

/// Returns the program's options. A negative number after an option is its value: one that is out of range is called that, not
/// an unknown option.
fn program() -> clap::Command {
    let takes_numbers = |arg: Arg| {
        let is_value = !arg.is_positional() && arg.get_action().takes_values();
        arg.allow_negative_numbers(is_value)
    };
    Cli::command().mut_subcommands(|command| command.mut_args(takes_numbers))
}

/// Returns the error of options that contradict each other, with the usage of the command that was given.
fn usage_error(matches: &ArgMatches, message: String) -> clap::Error {
    let mut program = program();
    program.build();
    let command = matches.subcommand_name().and_then(|name| program.find_subcommand_mut(name));
    match command {
        Some(command) => command.error(ErrorKind::ArgumentConflict, message),
        None => program.error(ErrorKind::ArgumentConflict, message),
    }
}

/// On Ctrl-C, and when the program is asked to end, files that are being written get their names first.
fn finish_files_when_interrupted() {
    let end = || {
        let _no_more_files = hold_writing();
        remove_unfinished_logs();
        eprintln!("error: interrupted");
        std::process::exit(INTERRUPTED);
    };
    // Without the handler an interrupted program may leave an unfinished file behind, and that is all.
    let _ = ctrlc::set_handler(end);
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
