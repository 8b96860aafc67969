//! Topics of a log.

use std::{collections::HashMap, sync::Arc};

use crate::schema::{Definition, RawDefinition};

/// Topic: messages of one type, sent under one name.
#[derive(Debug)]
pub struct Topic {
    /// Name, such as `/camera/image_raw`.
    pub name: String,
    /// Name of the messages' type.
    pub type_name: String,
    /// Definition of the messages.
    pub definition: Definition,
}

/// Topics that have been met in a log, each once: files and channels of one name and type are one topic.
#[derive(Debug, Default)]
pub struct TopicSet {
    topics: HashMap<(String, String), Arc<Topic>>,
}

impl TopicSet {
    /// Returns a topic, made with the definition if it has not been met before.
    pub(super) fn topic(&mut self, name: &str, raw: RawDefinition<'_>) -> Arc<Topic> {
        let key = (name.to_owned(), raw.type_name.to_owned());
        let topic = || {
            let (name, type_name) = (name.to_owned(), raw.type_name.to_owned());
            Arc::new(Topic { name, type_name, definition: Definition::read(raw) })
        };
        self.topics.entry(key).or_insert_with(topic).clone()
    }
}
