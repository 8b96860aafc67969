//! What is in a log: topics, numbers of messages, first and last time.

use std::{collections::HashMap, ops::ControlFlow, sync::Arc};

use super::{
    Ending, Log, LogError, Message, Sink,
    files::LogFile,
    mcap::read_mcap,
    mcap_summary,
    sqlite::read_sqlite,
    topic::{Topic, TopicSet},
};

/// Topic of a log with what is in it.
#[derive(Debug, Clone)]
pub struct TopicSummary {
    /// Topic.
    pub topic: Arc<Topic>,
    /// Number of its messages.
    pub count: u64,
    /// Times at which its first and its last message were logged, nanoseconds, where the whole log was read.
    pub log_times_ns: Option<(i64, i64)>,
}

/// Topics of a log, by name.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    /// Topics, sorted by name.
    pub topics: Vec<TopicSummary>,
    /// How the log ends; nothing is known of it where only the files' summaries were read.
    pub ending: Ending,
}

impl Log {
    /// Reads the whole log and returns what is in it. Fails if a file cannot be read at all.
    pub fn survey(&self) -> Result<Survey, LogError> {
        let (mut topics, mut tally) = (TopicSet::default(), Tally::default());
        let ending = self.read(&mut topics, &mut tally)?;
        Ok(Survey { topics: tally.sorted(), ending })
    }

    /// Returns the topics, from the files' summaries where they have them. Fails if a file cannot be read at all.
    pub fn topics(&self, topics: &mut TopicSet) -> Result<Vec<TopicSummary>, LogError> {
        let mut tally = Tally::default();
        for file in &self.files {
            match &*file.unpacked()? {
                LogFile::Mcap(path) => match mcap_summary::counts(path, topics) {
                    Some(counts) => {
                        counts.into_iter().for_each(|(topic, count)| tally.add(&topic, count, None));
                    }
                    None => read_mcap(path, topics, &mut tally).map(drop)?,
                },
                LogFile::Sqlite(path) => read_sqlite(path, topics, &mut tally).map(drop)?,
                LogFile::Packed(..) => {}
            }
        }
        Ok(tally.sorted())
    }
}

/// Counts messages.
#[derive(Default)]
struct Tally {
    topics: HashMap<*const Topic, TopicSummary>,
}

impl Tally {
    fn add(&mut self, topic: &Arc<Topic>, count: u64, log_time_ns: Option<i64>) {
        let nothing = || TopicSummary { topic: topic.clone(), count: 0, log_times_ns: None };
        let summary = self.topics.entry(Arc::as_ptr(topic)).or_insert_with(nothing);
        summary.count = summary.count.saturating_add(count);
        if let Some(time_ns) = log_time_ns {
            let (first, last) = summary.log_times_ns.unwrap_or((time_ns, time_ns));
            summary.log_times_ns = Some((first.min(time_ns), last.max(time_ns)));
        }
    }

    fn sorted(self) -> Vec<TopicSummary> {
        let mut topics: Vec<TopicSummary> = self.topics.into_values().collect();
        topics.sort_by(|a, b| (&a.topic.name, &a.topic.type_name).cmp(&(&b.topic.name, &b.topic.type_name)));
        topics
    }
}

impl Sink for Tally {
    fn wants(&mut self, topic: &Arc<Topic>) -> bool {
        self.add(topic, 0, None);
        true
    }

    fn take(&mut self, message: Message<'_>) -> ControlFlow<()> {
        self.add(message.topic, 1, Some(message.log_time_ns));
        ControlFlow::Continue(())
    }

    fn needs_contents(&self) -> bool {
        false
    }
}
