//! Named, counter-based random streams: the only place where a generator is made.
//!
//! A stream is ChaCha8 keyed by SHA-256 over (experiment seed, declared coordinates, label), so its numbers
//! depend on the trial's identity alone: never on order, threads or what other streams drew. A stream can be
//! positioned at any counter ([`Stream::at`]), so a reading indexed by tick has the same noise whether or not
//! earlier readings were computed.
//!
//! Distributions are our own on `libm`: those of the usual crates are not portable between releases.

use crate::digest::Hasher;
use crate::math;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use std::sync::{Arc, OnceLock};

/// The identity of a family of streams: the experiment's seed and the trial's declared coordinates.
///
/// Coordinates are `name=value` pairs in a fixed order (factor values, then the trial number). Trials that declare
/// shared noise leave out the factors over which they share it.
///
/// ```
/// use reenact::rng::Seeds;
///
/// let seeds = Seeds::new(7, vec![("trial".to_owned(), "0".to_owned())]);
/// let (mut lidar, mut drive) = (seeds.stream("lidar"), seeds.stream("drive"));
/// assert_ne!(lidar.bits(), drive.bits());
/// // A reading depends on its index alone, never on what was drawn before.
/// assert_eq!(lidar.at(3).uniform(), seeds.stream("lidar").at(3).uniform());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Seeds {
    experiment: u64,
    /// Shared by the trials of a condition.
    coordinates: Arc<[(String, String)]>,
    /// The number that stands behind them as the coordinate `trial`, where they are a trial's.
    trial: Option<u32>,
}

impl Seeds {
    /// Creates the seeds of the experiment `experiment` at `coordinates`.
    pub fn new(experiment: u64, coordinates: Vec<(String, String)>) -> Self {
        Self { experiment, coordinates: coordinates.into(), trial: None }
    }

    /// Returns the seeds of trial `number` of the condition whose coordinates these are: those of one more coordinate, `trial`.
    #[must_use]
    pub fn of_trial(&self, number: u32) -> Self {
        Self { trial: Some(number), ..self.clone() }
    }

    /// Returns the stream named `label` at these coordinates.
    pub fn stream(&self, label: &str) -> Stream {
        let mut hasher = Hasher::new();
        hasher.update(b"reenact-stream-1\0").update(self.experiment.to_le_bytes());
        let mut field = |text: &str| {
            // Lengths first, so that ("ab", "c") and ("a", "bc") are different streams.
            hasher.update((text.len() as u64).to_le_bytes()).update(text);
        };
        for (name, value) in self.coordinates.iter() {
            field(name);
            field(value);
        }
        if let Some(number) = self.trial {
            field("trial");
            field(&number.to_string());
        }
        field(label);
        Stream { generator: ChaCha8Rng::from_seed(hasher.digest().0), layers: Layers::shared() }
    }
}

/// One named generator. Not shared, not cloned, not global.
#[derive(Debug)]
pub struct Stream {
    generator: ChaCha8Rng,
    layers: &'static Layers,
}

impl Stream {
    /// Positions this stream at the beginning of block `index`: 2^32 words, far more than a reading takes.
    ///
    /// The same index always yields the same numbers, whatever was drawn before.
    pub fn at(&mut self, index: u64) -> &mut Self {
        // The stream number is the high half of ChaCha's counter space: a position of its own per index.
        self.generator.set_stream(index);
        self.generator.set_word_pos(0);
        self
    }

    /// Draws the next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Draws a number uniform in [0, 1), with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "53 bits are exact in an f64")]
        let mantissa = (self.bits() >> 11) as f64;
        mantissa * (1.0 / 9_007_199_254_740_992.0)
    }

    /// Draws for each of `events`, independent of one another, whether it happens: each does with `probability`, where
    /// [`Stream::uniform`] would be below it.
    pub fn events(&mut self, probability: f64, events: &mut [bool]) {
        // A multiple of 2^-53 is below it exactly where the multiple is below this number, which has no fraction.
        let limit = (probability * 9_007_199_254_740_992.0).ceil();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole; what is below zero or no number is zero, and what is too large never reached"
        )]
        let limit = limit as u64;
        let mut words = [0_u8; 256];
        for events in events.chunks_mut(words.len() / 8) {
            let words = &mut words[..8 * events.len()];
            self.generator.fill_bytes(words);
            for (event, word) in events.iter_mut().zip(words.as_chunks::<8>().0) {
                *event = u64::from_le_bytes(*word) >> 11 < limit;
            }
        }
    }

    /// Draws a number uniform in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Draws a number uniform in `0..bound`, without bias (Lemire 2019, "Fast random integer generation in an
    /// interval").
    ///
    /// # Panics
    /// Where `bound` is zero.
    pub fn below(&mut self, bound: u64) -> u64 {
        assert!(bound > 0, "an empty range has no number to draw");
        below(bound, || self.bits())
    }

    /// Draws a standard normal number, by layers of the bell (Marsaglia and Tsang 2000, "The ziggurat method for generating
    /// random variables"), with other bits for the layer than for the place in it (Doornik 2005).
    ///
    /// Nearly all draws take one multiplication and 64 bits of the stream; how many bits the rest take differs.
    pub fn normal(&mut self) -> f64 {
        let layers = self.layers;
        loop {
            let bits = self.bits();
            let layer = (bits & 0xff) as usize;
            #[expect(clippy::cast_precision_loss, reason = "53 bits are exact in an f64")]
            let place = (bits >> 11) as f64 * (2.0 / 9_007_199_254_740_992.0) - 1.0;
            let x = place * layers.ends[layer];
            if x.abs() < layers.ends[layer + 1] {
                return x;
            }
            if layer == 0 {
                return self.tail().copysign(x);
            }
            let (low, high) = (layers.heights[layer], layers.heights[layer + 1]);
            if low + (high - low) * self.uniform() < bell(x) {
                return x;
            }
        }
    }

    /// Draws a normal number that is known to be beyond [`TAIL`] (Marsaglia 1964).
    fn tail(&mut self) -> f64 {
        loop {
            // 1 - u is in (0, 1], so the logarithms are finite.
            let beyond = -math::ln(1.0 - self.uniform()) / TAIL;
            if -2.0 * math::ln(1.0 - self.uniform()) > beyond * beyond {
                return TAIL + beyond;
            }
        }
    }

    /// Puts `items` in a random order (Fisher and Yates 1938): each, from the last to the second, changes places with one that
    /// [`Stream::below`] draws of those up to itself.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        let mut words = Words::default();
        for last in (1..items.len()).rev() {
            let bound = last as u64 + 1;
            #[expect(clippy::cast_possible_truncation, reason = "an index below the length")]
            let other = below(bound, || words.next(&mut self.generator, last)) as usize;
            items.swap(last, other);
        }
    }

    /// Draws `count` different places out of `of`, in order; all of them where there are no more.
    pub fn places(&mut self, count: usize, of: usize) -> Vec<usize> {
        let mut places: Vec<usize> = (0..of).collect();
        let count = count.min(of);
        for i in 0..count {
            #[expect(clippy::cast_possible_truncation, reason = "below a usize")]
            let pick = i + self.below((of - i) as u64) as usize;
            places.swap(i, pick);
        }
        places.truncate(count);
        places.sort_unstable();
        places
    }
}

/// Where the lowest of [`LAYERS`] layers ends and the tail begins, and the area of each layer (Marsaglia and Tsang 2000).
const TAIL: f64 = 3.654_152_885_361_009;
const AREA: f64 = 0.004_928_673_233_974_655;
const LAYERS: usize = 256;

/// The layers of the bell exp(-x²/2), of equal area, from the lowest, whose area is that of the tail too.
#[derive(Debug)]
struct Layers {
    /// How far each layer goes to the right; the next one's is how far it is wholly under the bell.
    ends: [f64; LAYERS + 1],
    /// The bell's height there.
    heights: [f64; LAYERS + 1],
}

impl Layers {
    fn shared() -> &'static Self {
        static LAYERS: OnceLock<Layers> = OnceLock::new();
        LAYERS.get_or_init(Self::new)
    }

    fn new() -> Self {
        let mut ends = [0.0; LAYERS + 1];
        // As long as makes its area that of the others.
        ends[0] = AREA / bell(TAIL);
        ends[1] = TAIL;
        for layer in 2..LAYERS {
            let top = bell(ends[layer - 1]) + AREA / ends[layer - 1];
            ends[layer] = (-2.0 * math::ln(top)).sqrt();
        }
        Self { ends, heights: ends.map(bell) }
    }
}

fn bell(x: f64) -> f64 {
    math::exp(-0.5 * x * x)
}

/// Draws a number uniform in `0..bound` from random `bits`.
fn below(bound: u64, mut bits: impl FnMut() -> u64) -> u64 {
    let mut product = u128::from(bits()) * u128::from(bound);
    #[expect(clippy::cast_possible_truncation, reason = "the low half is what is meant")]
    if (product as u64) < bound {
        let threshold = bound.wrapping_neg() % bound;
        while (product as u64) < threshold {
            product = u128::from(bits()) * u128::from(bound);
        }
    }
    (product >> 64) as u64
}

/// Random bits that are fetched many at once, and never more than will be wanted.
#[derive(Default)]
struct Words {
    bytes: [[u8; 8]; 32],
    left: usize,
}

impl Words {
    /// Returns the next 64 bits, where so many more are `wanted` at least.
    fn next(&mut self, generator: &mut ChaCha8Rng, wanted: usize) -> u64 {
        if self.left == 0 {
            self.left = wanted.clamp(1, self.bytes.len());
            let begin = self.bytes.len() - self.left;
            generator.fill_bytes(self.bytes[begin..].as_flattened_mut());
        }
        let word = self.bytes[self.bytes.len() - self.left];
        self.left -= 1;
        u64::from_le_bytes(word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeds(trial: u32) -> Seeds {
        Seeds::new(2019, vec![("start".into(), "A".into()), ("trial".into(), trial.to_string())])
    }

    #[test]
    fn streams_are_named_repeatable_and_distinct() {
        let draw = |seeds: &Seeds, label: &str| seeds.stream(label).bits();
        assert_eq!(draw(&seeds(0), "lidar"), draw(&seeds(0), "lidar"));
        assert_ne!(draw(&seeds(0), "lidar"), draw(&seeds(0), "drive"));
        assert_ne!(draw(&seeds(0), "lidar"), draw(&seeds(1), "lidar"));
        let ab_c = Seeds::new(1, vec![("ab".into(), "c".into())]);
        let a_bc = Seeds::new(1, vec![("a".into(), "bc".into())]);
        assert_ne!(draw(&ab_c, ""), draw(&a_bc, ""));
    }

    #[test]
    fn a_position_does_not_depend_on_what_was_drawn_before() {
        let mut lazy = seeds(0).stream("lidar");
        let mut eager = seeds(0).stream("lidar");
        for index in 0..7 {
            eager.at(index).normal();
        }
        assert_eq!(lazy.at(7).normal().to_bits(), eager.at(7).normal().to_bits());
    }

    #[test]
    fn events_are_those_that_uniform_numbers_are_below_of() {
        let edge = seeds(0).stream("events").uniform();
        let probabilities = [0.0, 1.0, 0.3, 1e-9, edge, edge.next_up(), edge.next_down()];
        for probability in
            probabilities.into_iter().chain([-1.0, 2.0, f64::NAN, 1.0f64.next_down()])
        {
            let (mut one, mut all) = (seeds(0).stream("events"), seeds(0).stream("events"));
            // From within a block, and over the end of one.
            for count in [1, 7, 40, 0, 300] {
                let mut events = vec![true; count];
                all.events(probability, &mut events);
                let expected: Vec<bool> = (0..count).map(|_| one.uniform() < probability).collect();
                assert_eq!(events, expected, "{count} of {probability}");
            }
            assert_eq!(one.bits(), all.bits());
        }
    }

    #[test]
    fn a_shuffle_swaps_with_what_is_drawn_one_by_one() {
        let (mut one, mut all) = (seeds(0).stream("shuffle"), seeds(0).stream("shuffle"));
        for count in [0_u64, 1, 2, 31, 33, 34, 500] {
            let mut items: Vec<u64> = (0..count).collect();
            let mut expected = items.clone();
            all.shuffle(&mut items);
            for last in (1..expected.len()).rev() {
                expected.swap(last, usize::try_from(one.below(last as u64 + 1)).unwrap());
            }
            assert_eq!(items, expected);
        }
        assert_eq!(one.bits(), all.bits());
    }

    #[test]
    fn a_bound_that_does_not_divide_asks_for_other_bits() {
        let mut asked = [0, 1, u64::MAX].into_iter();
        // Of the 2^64 numbers one is too many for three even parts: the lowest product.
        assert_eq!(below(3, || asked.next().unwrap()), 0);
        assert_eq!(asked.next(), Some(u64::MAX));
    }

    /// Checks the pinned numbers: a change here changes every trial, so the engine version must be raised with it.
    #[test]
    fn the_algorithm_is_pinned() {
        let mut stream = seeds(0).stream("pin");
        assert_eq!(
            [stream.bits(), stream.at(3).bits(), stream.at(3).below(1000)],
            [87_813_726_223_822_956, 9_171_920_531_770_413_246, 497]
        );
    }

    /// Checks the shares below every tenth of a standard deviation, tails included, against the distribution function.
    #[test]
    fn normals_are_distributed_as_they_should() {
        let mut stream = seeds(0).stream("moments");
        let n = 1_000_000_u32;
        let mut drawn: Vec<f64> = (0..n).map(|_| stream.normal()).collect();
        drawn.sort_unstable_by(f64::total_cmp);
        for tenth in -45..=45 {
            let x = f64::from(tenth) / 10.0;
            let expected = crate::stats::distribution::normal_cdf(x);
            let below = drawn.partition_point(|drawn| *drawn < x);
            let found = f64::from(u32::try_from(below).unwrap()) / f64::from(n);
            // Five standard errors, and one draw.
            let error =
                5.0 * (expected * (1.0 - expected) / f64::from(n)).sqrt() + 1.0 / f64::from(n);
            assert!((found - expected).abs() < error, "{x}: {found}, expected {expected}");
        }
    }

    #[test]
    fn the_layers_of_the_bell_have_equal_areas() {
        let layers = Layers::new();
        assert!(layers.ends.windows(2).all(|ends| ends[0] > ends[1]));
        for layer in 1..LAYERS {
            let area = layers.ends[layer] * (layers.heights[layer + 1] - layers.heights[layer]);
            assert!((area - AREA).abs() < 1e-12, "{layer}: {area}");
        }
    }

    #[test]
    fn bounded_integers_are_uniform() {
        let mut stream = seeds(0).stream("below");
        let mut counts = [0_i32; 7];
        for _ in 0..70_000 {
            counts[usize::try_from(stream.below(7)).unwrap()] += 1;
        }
        assert!(counts.iter().all(|c| (c - 10_000).abs() < 500), "{counts:?}");
    }
}
