//! The program's commands.

mod device;
#[cfg(feature = "gpu")]
mod doctor;
mod output;
mod tag;

/// What to do.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Tag every picture of a sequence with the pose of the camera
    Tag(Box<tag::TagArgs>),
    /// List graphics adapters, and check that they compute what the CPU computes
    #[cfg(feature = "gpu")]
    Doctor(doctor::DoctorArgs),
}

impl Command {
    /// Refuses options that contradict each other; what clap can say of them alone it has said before.
    pub fn check_usage(&self) -> Result<(), String> {
        match self {
            Self::Tag(args) => args.check_usage(),
            #[cfg(feature = "gpu")]
            Self::Doctor(_) => Ok(()),
        }
    }

    /// Does it.
    pub fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Tag(args) => tag::run(args),
            #[cfg(feature = "gpu")]
            Self::Doctor(args) => doctor::run(args),
        }
    }
}
