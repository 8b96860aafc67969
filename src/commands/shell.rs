//! `reality-sim completions` and `reality-sim man`: what shells and `man` need to know of the program.

use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use reality_sim::sequence::write_atomically;

use super::{output::print_all, output_folder::OutputFolder};

/// Options of `completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// Shell for which the script is
    shell: Shell,
}

/// Options of `man`.
#[derive(Debug, Args)]
pub struct ManArgs {
    /// Folder for the manual pages, one for each command, such as ~/.local/share/man/man1
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

/// Prints the script that completes commands and options in a shell.
pub fn completions<Program: CommandFactory>(args: &CompletionsArgs) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Program::command(), env!("CARGO_BIN_NAME"), &mut script);
    print_all(&script)
}

/// Writes the manual pages.
pub fn man<Program: CommandFactory>(args: &ManArgs) -> anyhow::Result<()> {
    let folder = OutputFolder::check(&args.out, &[])?;
    let mut program = Program::command();
    program.build();
    let commands = program.get_subcommands().filter(|command| !command.is_hide_set());
    for command in std::iter::once(&program).chain(commands) {
        let manual = Man::new(command.clone());
        let mut page = Vec::new();
        manual.render(&mut page)?;
        write_atomically(&folder.file(manual.get_filename())?, &page)?;
    }
    Ok(())
}
