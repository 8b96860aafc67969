//! Cache of values on the device.

use std::sync::{Arc, Weak};

/// Values by key, of which the most recently used are kept. A key is identified by what an [`Arc`] points to, which is not
/// kept alive.
#[derive(Debug)]
pub(crate) struct Recent<K, V> {
    slots: Vec<Slot<K, V>>,
    capacity: usize,
    clock: u64,
}

#[derive(Debug)]
struct Slot<K, V> {
    /// No other key can have the same address: even a weak reference keeps the memory allocated.
    key: Weak<K>,
    value: V,
    used: u64,
}

impl<K, V> Recent<K, V> {
    /// Creates a cache for at most this many values, at least one.
    pub fn new(capacity: usize) -> Self {
        Self { slots: Vec::new(), capacity: capacity.max(1), clock: 0 }
    }

    /// Returns the value of a key. If there is none, `make` makes it for the slot whose number it gets, and the slot's old
    /// value is dropped: one whose key is gone, or else the least recently used one.
    pub fn get_or_make<E>(
        &mut self,
        key: &Arc<K>,
        make: impl FnOnce(usize) -> Result<V, E>,
    ) -> Result<&mut V, E> {
        self.clock += 1;
        let index = match self.slots.iter().position(|slot| slot.key.as_ptr() == Arc::as_ptr(key)) {
            Some(known) => known,
            None => {
                let index = self.free();
                let slot = Slot { key: Arc::downgrade(key), value: make(index)?, used: 0 };
                match self.slots.get_mut(index) {
                    Some(old) => *old = slot,
                    None => self.slots.push(slot),
                }
                index
            }
        };
        let slot = &mut self.slots[index];
        slot.used = self.clock;
        Ok(&mut slot.value)
    }

    /// Returns the slot to be overwritten next.
    fn free(&self) -> usize {
        let count = self.slots.len();
        let rank = |&index: &usize| (self.slots[index].key.strong_count() > 0, self.slots[index].used);
        if count < self.capacity { count } else { (0..count).min_by_key(rank).unwrap_or(0) }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// Returns the slot of a key, and whether its value was made.
    fn slot(recent: &mut Recent<u32, usize>, key: &Arc<u32>) -> (usize, bool) {
        let mut is_made = false;
        let slot = recent.get_or_make(key, |slot| {
            is_made = true;
            Ok::<_, Infallible>(slot)
        });
        (*slot.unwrap(), is_made)
    }

    #[test]
    fn values_stay_until_others_were_used_more_recently() {
        let keys: Vec<Arc<u32>> = (0..4).map(Arc::new).collect();
        let mut recent = Recent::new(3);
        for (index, key) in keys[..3].iter().enumerate() {
            assert_eq!(slot(&mut recent, key), (index, true));
        }
        assert_eq!(slot(&mut recent, &keys[0]), (0, false));
        assert_eq!(slot(&mut recent, &keys[3]), (1, true), "the second was not used for longest");
        assert_eq!(slot(&mut recent, &keys[0]), (0, false));
        assert_eq!(slot(&mut recent, &keys[1]), (2, true));
    }

    #[test]
    fn values_whose_key_is_gone_go_first() {
        let mut keys: Vec<Arc<u32>> = (0..4).map(Arc::new).collect();
        let mut recent = Recent::new(3);
        for key in &keys[..3] {
            slot(&mut recent, key);
        }
        keys.remove(2);
        assert_eq!(slot(&mut recent, &keys[2]), (2, true));
        assert_eq!(slot(&mut recent, &keys[0]), (0, false));
    }

    #[test]
    fn a_key_is_never_taken_for_one_that_is_gone() {
        let mut recent = Recent::new(2);
        for value in 0..100 {
            // Most allocators would give every key the address of the previous one.
            assert!(slot(&mut recent, &Arc::new(value)).1);
        }
    }

    #[test]
    fn where_a_value_cannot_be_made_nothing_is_lost() {
        let keys: Vec<Arc<u32>> = (0..2).map(Arc::new).collect();
        let mut recent = Recent::new(1);
        slot(&mut recent, &keys[0]);
        assert!(recent.get_or_make(&keys[1], |_| Err("no")).is_err());
        assert_eq!(slot(&mut recent, &keys[0]), (0, false));
    }
}
