//! The program's commands.

mod output;
mod tag;

/// What to do.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Tag every picture of a sequence with the pose of the camera
    Tag(Box<tag::TagArgs>),
}

impl Command {
    /// Refuses options that contradict each other; what clap can say of them alone it has said before.
    pub fn check_usage(&self) -> Result<(), String> {
        match self {
            Self::Tag(args) => args.check_usage(),
        }
    }

    /// Does it.
    pub fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Tag(args) => tag::run(args),
        }
    }
}
