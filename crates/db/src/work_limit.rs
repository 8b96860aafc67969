//! Limit on the work of a transaction: pages that somebody arranged, or that are damaged, can lead SQLite in circles. It follows
//! SQLite's own advice for files of unknown origin, <https://www.sqlite.org/security.html>.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use rusqlite::Connection;

/// Instructions of SQLite's virtual machine between two looks at the limit.
const STEP: u32 = 10_000;

/// Instructions that a transaction may take whatever the size of its file: a fraction of a second.
const LEAST: u64 = 10_000_000;

/// Further instructions for each byte of the file. A row of an image takes at least 160 bytes and, in the longest transaction,
/// that which checks all references, fewer than 200 instructions.
const PER_BYTE: u64 = 4;

/// Number of instructions that the present transaction of a connection may still take.
#[derive(Debug, Clone)]
pub(crate) struct WorkLimit {
    left: Arc<AtomicU64>,
}

impl WorkLimit {
    /// Limits the work of a connection to a file of this length, bytes. A transaction that takes more fails.
    pub fn new(connection: &mut Connection, file_bytes: u64) -> rusqlite::Result<Self> {
        let limit = Self { left: Arc::default() };
        limit.renew(file_bytes);
        let left = limit.left.clone();
        let is_spent = move || {
            let before = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                Some(left.saturating_sub(u64::from(STEP)))
            });
            before.is_ok_and(|before| before < u64::from(STEP))
        };
        connection.progress_handler(STEP as i32, Some(is_spent))?;
        Ok(limit)
    }

    /// Begins a transaction, which may take as much as the file's present length, bytes, allows: a writer's file grows.
    pub fn renew(&self, file_bytes: u64) {
        self.left.store(LEAST.saturating_add(PER_BYTE.saturating_mul(file_bytes)), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DbFault;

    const ENDLESS: &str = "WITH RECURSIVE endless(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM endless) SELECT count(*) FROM endless";

    #[test]
    fn an_endless_statement_is_ended_and_the_next_transaction_is_not() {
        let mut connection = Connection::open_in_memory().unwrap();
        let limit = WorkLimit::new(&mut connection, 1000).unwrap();
        let count = |connection: &Connection, query: &str| {
            connection.query_row(query, [], |row| row.get::<_, i64>(0)).map_err(DbFault::from)
        };
        assert!(matches!(count(&connection, ENDLESS), Err(DbFault::TooMuchWork)));
        limit.renew(1000);
        assert_eq!(count(&connection, "SELECT 2").unwrap(), 2);
    }

    #[test]
    fn a_transaction_may_take_more_work_once_its_file_has_grown() {
        const LONG: &str = "WITH RECURSIVE endless(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM endless)
            SELECT count(*) FROM (SELECT n FROM endless LIMIT 2000000)";
        let mut connection = Connection::open_in_memory().unwrap();
        let limit = WorkLimit::new(&mut connection, 0).unwrap();
        let count = || connection.query_row(LONG, [], |row| row.get::<_, i64>(0)).map_err(DbFault::from);
        assert!(matches!(count(), Err(DbFault::TooMuchWork)));
        limit.renew(1 << 30);
        assert_eq!(count().unwrap(), 2_000_000);
    }
}
