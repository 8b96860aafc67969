//! Summary at the end of MCAP files: topics and numbers of messages, without reading the file.

use std::{
    collections::HashMap,
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::Path,
    sync::Arc,
};

use mcap::{MAGIC, records::op};

use super::{
    mcap_records::{Channels, Fields, RECORD_HEADER_BYTES, record_header},
    sink::{Message, Sink},
    topic::{Topic, TopicSet},
};

/// Length of the footer record and the magic bytes behind it.
const FOOTER_BYTES: u64 = RECORD_HEADER_BYTES as u64 + 20 + 8;

/// Longest summary that is read, bytes; it has 150 for each chunk. Files with longer ones are read from the front.
const MAX_SUMMARY_BYTES: u64 = 64 << 20;

/// Returns the topics of a file and their numbers of messages, if it has a summary that states both.
pub(super) fn counts(path: &Path, topics: &mut TopicSet) -> Option<Vec<(Arc<Topic>, u64)>> {
    let summary = summary(path)?;
    let (mut channels, mut counts) = (Channels::default(), HashMap::new());
    let mut rest = summary.as_slice();
    while let Some((header, after)) = rest.split_first_chunk::<RECORD_HEADER_BYTES>() {
        let (kind, length) = record_header(*header);
        let (body, after) = after.split_at_checked(usize::try_from(length).ok()?)?;
        match kind {
            op::SCHEMA => channels.add_schema(body)?,
            op::CHANNEL => channels.add_channel(body, topics, &mut Nobody)?,
            op::STATISTICS => counts = statistics(body)?,
            _ => {}
        }
        rest = after;
    }
    let is_whole = !counts.is_empty() && counts.keys().all(|id| channels.by_id.contains_key(id));
    let count = |(id, count)| Some((channels.by_id.get(&id)?.topic.clone(), count));
    is_whole.then(|| counts.into_iter().filter_map(count).collect())
}

fn summary(path: &Path) -> Option<Vec<u8>> {
    let mut file = File::open(path).ok()?;
    let length = file.metadata().ok()?.len();
    let footer_at = length.checked_sub(FOOTER_BYTES)?;
    file.seek(SeekFrom::Start(footer_at)).ok()?;
    let mut footer = Vec::new();
    file.by_ref().take(FOOTER_BYTES).read_to_end(&mut footer).ok()?;
    if footer.first() != Some(&op::FOOTER) || !footer.ends_with(MAGIC) {
        return None;
    }
    let start = Fields(&footer[RECORD_HEADER_BYTES..]).u64()?;
    let count = footer_at.checked_sub(start).filter(|count| start > 0 && *count <= MAX_SUMMARY_BYTES)?;
    file.seek(SeekFrom::Start(start)).ok()?;
    let mut summary = Vec::new();
    file.take(count).read_to_end(&mut summary).ok()?;
    Some(summary)
}

/// Returns the number of messages of each channel.
fn statistics(body: &[u8]) -> Option<HashMap<u16, u64>> {
    let mut fields = Fields(body);
    // Numbers of messages, schemas, channels, attachments, metadata, chunks; first and last time.
    fields.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8)?;
    let mut entries = Fields(fields.bytes()?);
    let mut counts = HashMap::new();
    while let Some(id) = entries.u16() {
        counts.insert(id, entries.u64()?);
    }
    Some(counts)
}

/// Sink of nothing.
struct Nobody;

impl Sink for Nobody {
    fn wants(&mut self, _: &Arc<Topic>) -> bool {
        false
    }

    fn take(&mut self, _: Message<'_>) -> std::ops::ControlFlow<()> {
        std::ops::ControlFlow::Continue(())
    }
}
