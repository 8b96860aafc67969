//! `reality-sim info` of a robot's log: its topics, and what they are taken for.

use std::path::Path;

use serde::Serialize;

use reality_sim::sequence::counted;
use reality_sim_formats::{
    log::{Log, Survey, TopicSummary},
    message::{Role, seconds},
};

use super::output::{aligned, print, print_json};

#[derive(Serialize)]
struct Report {
    log: String,
    bytes: u64,
    /// Number of messages.
    messages: u64,
    /// Whether the log is cut off or damaged.
    salvaged: bool,
    /// Length of what could not be read, bytes.
    bytes_lost: u64,
    topics: Vec<TopicReport>,
}

#[derive(Serialize)]
struct TopicReport {
    name: String,
    #[serde(rename = "type")]
    type_name: String,
    /// What `import` takes the messages for; `None` for nothing.
    taken_for: Option<&'static str>,
    /// Why the messages cannot be read, if they cannot.
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<String>,
    messages: u64,
    /// Messages a second, if there are two or more.
    rate_hz: Option<f64>,
    /// Time at which the first message was logged, seconds.
    first_s: Option<f64>,
    /// Time at which the last message was logged, seconds.
    last_s: Option<f64>,
}

/// Reads a log and prints what is in it.
pub fn run(path: &Path, json: bool) -> anyhow::Result<()> {
    let log = Log::open(path)?;
    let report = Report::new(&log, &log.survey()?);
    if json { print_json(&report) } else { print(&report.text()) }
}

impl Report {
    fn new(log: &Log, survey: &Survey) -> Self {
        Self {
            log: log.path().display().to_string(),
            bytes: log.bytes(),
            messages: survey.topics.iter().map(|topic| topic.count).sum(),
            salvaged: survey.ending.is_cut,
            bytes_lost: survey.ending.bytes_lost,
            topics: survey.topics.iter().map(TopicReport::new).collect(),
        }
    }

    fn text(&self) -> String {
        let (megabytes, messages) = (self.bytes as f64 / 1e6, counted(self.messages as usize, "message"));
        let mut lines = vec![("log", format!("{}, {megabytes:.1} MB, {messages}", self.log))];
        if self.salvaged {
            lines.push((
                "salvaged",
                format!("cut off or damaged: about {} bytes could not be read", self.bytes_lost),
            ));
        }
        lines.extend(self.topics.iter().map(|topic| ("topic", topic.text())));
        aligned(&lines)
    }
}

impl TopicReport {
    fn new(summary: &TopicSummary) -> Self {
        let topic = &summary.topic;
        let duration_s = summary.log_times_ns.map_or(0.0, |(first, last)| (last - first) as f64 * 1e-9);
        Self {
            name: topic.name.clone(),
            type_name: topic.type_name.clone(),
            taken_for: Role::of(topic).map(|role| role.kind.name()),
            fault: topic.definition.fault().map(str::to_owned),
            messages: summary.count,
            rate_hz: (duration_s > 0.0).then(|| summary.count.saturating_sub(1) as f64 / duration_s),
            first_s: summary.log_times_ns.map(|(first, _)| seconds(first)),
            last_s: summary.log_times_ns.map(|(_, last)| seconds(last)),
        }
    }

    fn text(&self) -> String {
        let Self { name, type_name, messages, .. } = self;
        let taken_for = self.taken_for.unwrap_or("not read");
        let mut text =
            format!("{name}: {type_name}, {taken_for}, {}", counted(*messages as usize, "message"));
        if let Some(rate_hz) = self.rate_hz {
            text.push_str(&format!(", {rate_hz:.1} Hz"));
        }
        if let (Some(first_s), Some(last_s)) = (self.first_s, self.last_s) {
            text.push_str(&format!(", {first_s:.3} s to {last_s:.3} s"));
        }
        if let Some(fault) = &self.fault {
            text.push_str(&format!(" ({fault})"));
        }
        text
    }
}
