//! The chain of state hashes of a trial: what names the first step at which two runs of it part.

use crate::digest::{Hasher, Sha256Digest};
use crate::units::{Seconds, Tick};

/// Simulated time between state hashes (s).
pub(super) const EVERY: Seconds = Seconds(10.0);

/// State hashes, one every 10 s of simulated time, each over the state and its predecessor.
#[derive(Debug, Default)]
pub(super) struct StateChain {
    next: Tick,
    hashes: Vec<Sha256Digest>,
}

impl StateChain {
    /// Returns whether a hash is due; the next one is then due 10 s later.
    pub(super) fn is_due(&mut self, now: Tick) -> bool {
        let due = now >= self.next;
        if due {
            self.next = self.next + Tick::at_or_after(EVERY);
        }
        due
    }

    /// Adds the hash of a state, which `feed` hands over: numbers and counts in a fixed order and width.
    pub(super) fn push(&mut self, feed: impl FnOnce(&mut Hasher)) {
        let mut hasher = Hasher::new();
        if let Some(before) = self.hashes.last() {
            hasher.update(before.0);
        }
        feed(&mut hasher);
        self.hashes.push(hasher.digest());
    }

    /// Returns the chain as records hold it: the first 16 hex digits of each hash.
    pub(super) fn to_hex(&self) -> Vec<String> {
        self.hashes.iter().map(|hash| hash.hex()[..16].to_owned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_holds_the_state_and_all_before_it() {
        let chain = |first: f64| {
            let mut chain = StateChain::default();
            for number in [first, 2.0] {
                chain.push(|hasher| {
                    hasher.update(number.to_le_bytes());
                });
            }
            chain.to_hex()
        };
        assert_eq!(chain(1.0), chain(1.0));
        assert_ne!(chain(1.0)[1], chain(1.5)[1], "the second hash knows the first state");
        assert_eq!(chain(1.0)[0].len(), 16);
    }

    #[test]
    fn hashes_are_due_every_ten_seconds() {
        let mut chain = StateChain::default();
        let due: Vec<u64> = (0..=250).filter(|&i| chain.is_due(Tick(i * 300))).collect();
        assert_eq!(due, [0, 100, 200]);
    }
}
