//! Commands of the program.

mod advice;
mod build;
mod choice;
mod device;
#[cfg(feature = "gpu")]
mod doctor;
mod evaluate;
mod filter;
mod gap;
mod info;
mod output;
mod picture_at;
mod render;
mod tag;
#[cfg(feature = "viewer")]
mod viewer;

pub use self::advice::advice;

/// What to do.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Tag every picture of a sequence with the pose of the camera
    Tag(Box<tag::TagArgs>),
    /// Put recordings with their poses into a database
    Build(build::BuildArgs),
    /// Give the picture at a pose, or the pictures along a path, from a database
    Render(Box<render::RenderArgs>),
    /// Compare pictures at poses that are not in a database with those taken there
    Evaluate(evaluate::EvaluateArgs),
    /// Say what a database holds, and which parts of the field it covers
    Info(info::InfoArgs),
    /// Find which effect a model of the camera misses, add it, and show what that brings
    Gap(Box<gap::GapArgs>),
    /// List graphics adapters, and check that they compute what the CPU computes
    #[cfg(feature = "gpu")]
    Doctor(doctor::DoctorArgs),
    /// Open a window: the filter at work on a recording, pictures at any pose; without arguments the demonstration
    #[cfg(feature = "viewer")]
    Viewer(viewer::ViewerArgs),
}

impl Command {
    /// Refuses options that contradict each other, beyond what clap has checked already.
    pub fn check_usage(&self) -> Result<(), String> {
        match self {
            Self::Tag(args) => args.check_usage(),
            Self::Build(args) => args.check_usage(),
            Self::Render(args) => args.check_usage(),
            Self::Evaluate(args) => args.check_usage(),
            Self::Info(_) => Ok(()),
            Self::Gap(args) => args.check_usage(),
            #[cfg(feature = "gpu")]
            Self::Doctor(_) => Ok(()),
            #[cfg(feature = "viewer")]
            Self::Viewer(_) => Ok(()),
        }
    }

    /// Runs the command.
    pub fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Tag(args) => tag::run(args),
            Self::Build(args) => build::run(args),
            Self::Render(args) => render::run(args),
            Self::Evaluate(args) => evaluate::run(args),
            Self::Info(args) => info::run(args),
            Self::Gap(args) => gap::run(args),
            #[cfg(feature = "gpu")]
            Self::Doctor(args) => doctor::run(args),
            #[cfg(feature = "viewer")]
            Self::Viewer(args) => viewer::run(args),
        }
    }
}
