//! Commands of the program.

mod advice;
mod build;
mod calibrate;
mod choice;
mod dataset;
mod device;
#[cfg(feature = "gpu")]
mod doctor;
mod evaluate;
mod export;
mod filter;
mod frame_range;
mod gap;
mod import;
mod info;
mod input;
mod log_info;
mod model_file;
mod output;
mod output_folder;
mod parameter;
mod picture_at;
mod receivers;
mod remove;
mod render;
#[cfg(feature = "live")]
mod serving;
mod shell;
mod split;
mod stream;
mod summary;
mod tag;
#[cfg(feature = "viewer")]
mod viewer;
mod wanted_ball;

use clap::CommandFactory;

pub use self::{advice::advice, output::be_quiet};

/// What to do.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Find the camera's pose for every picture of a recording
    Tag(Box<tag::TagArgs>),
    /// Find the camera's lens and mount from the lines of the field
    Calibrate(calibrate::CalibrateArgs),
    /// Store recordings with their poses, or the pictures of other databases, in a database
    Build(build::BuildArgs),
    /// Make a sequence of a robot's log, or of another program's model
    Import(Box<import::ImportArgs>),
    /// Make the picture at a pose, or the pictures along a path, from a database
    Render(Box<render::RenderArgs>),
    /// Send what a camera sees along a path as messages of ROS 2, to a file or live
    Stream(Box<stream::StreamArgs>),
    /// Make pictures at random poses with labels, from a database
    Dataset(Box<dataset::DatasetArgs>),
    /// Compare reconstructed pictures with true ones that are not in the database
    Evaluate(evaluate::EvaluateArgs),
    /// Summarise a database, and how much of the field it covers, or list the topics of a robot's log
    Info(info::InfoArgs),
    /// Remove a sequence's pictures, or some of them, from a database
    Remove(remove::RemoveArgs),
    /// Split a database by field, one database each
    Split(split::SplitArgs),
    /// Write poses and pictures in the formats of other programs
    Export(export::ExportArgs),
    /// Find the effect that a camera model lacks, add it, and measure what that brings
    Gap(Box<gap::GapArgs>),
    /// Summarise the tables of studies: calibration and poses by robot and day, what to record next
    Summary(summary::SummaryArgs),
    /// List the graphics adapters, and check that they compute what the CPU computes
    #[cfg(feature = "gpu")]
    Doctor(doctor::DoctorArgs),
    /// Show a recording, a database or a report in a window
    #[cfg(feature = "viewer")]
    Viewer(viewer::ViewerArgs),
    /// Print the script by which a shell completes commands and options
    Completions(shell::CompletionsArgs),
    /// Write the manual pages
    Man(shell::ManArgs),
}

impl Command {
    /// Refuses options that contradict each other, beyond what clap has checked already.
    pub fn check_usage(&self) -> Result<(), String> {
        match self {
            Self::Tag(args) => args.check_usage(),
            Self::Build(args) => args.check_usage(),
            Self::Render(args) => args.check_usage(),
            Self::Stream(args) => args.check_usage(),
            Self::Dataset(args) => args.check_usage(),
            Self::Evaluate(args) => args.check_usage(),
            Self::Export(args) => args.check_usage(),
            Self::Calibrate(_)
            | Self::Import(_)
            | Self::Info(_)
            | Self::Remove(_)
            | Self::Split(_)
            | Self::Summary(_)
            | Self::Completions(_)
            | Self::Man(_) => Ok(()),
            Self::Gap(args) => args.check_usage(),
            #[cfg(feature = "gpu")]
            Self::Doctor(_) => Ok(()),
            #[cfg(feature = "viewer")]
            Self::Viewer(_) => Ok(()),
        }
    }

    /// Runs the command of a program.
    pub fn run<Program: CommandFactory>(&self) -> anyhow::Result<()> {
        match self {
            Self::Tag(args) => tag::run(args),
            Self::Calibrate(args) => calibrate::run(args),
            Self::Build(args) => build::run(args),
            Self::Import(args) => import::run(args),
            Self::Render(args) => render::run(args),
            Self::Stream(args) => stream::run(args),
            Self::Dataset(args) => dataset::run(args),
            Self::Evaluate(args) => evaluate::run(args),
            Self::Export(args) => export::run(args),
            Self::Info(args) => info::run(args),
            Self::Remove(args) => remove::run(args),
            Self::Split(args) => split::run(args),
            Self::Gap(args) => gap::run(args),
            Self::Summary(args) => summary::run(args),
            #[cfg(feature = "gpu")]
            Self::Doctor(args) => doctor::run(args),
            #[cfg(feature = "viewer")]
            Self::Viewer(args) => viewer::run(args),
            Self::Completions(args) => shell::completions::<Program>(args),
            Self::Man(args) => shell::man::<Program>(args),
        }
    }
}
