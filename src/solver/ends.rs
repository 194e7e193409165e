//! Which ends of pairs each body has: what the sum over a body runs along.

use super::constraints::Pair;
use super::motion::Movers;

/// For every body the ends of pairs it is at, in the order of pairs (compressed sparse rows).
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// Where each body's ends start; one entry more than bodies.
    starts: Vec<u32>,
    /// Twice the pair's number, plus 1 for its second body.
    ends: Vec<u32>,
}

impl Ends {
    /// Sorts the ends of all pairs that push by body (a counting sort, stable). Bodies without mass have none: nothing
    /// pushes them.
    pub fn build(&mut self, pairs: &[Pair], movers: &Movers) {
        let Self { starts, ends } = self;
        starts.clear();
        starts.resize(movers.len() + 1, 0);
        for_ends(pairs, movers, |body, _| starts[body] += 1);
        let mut sum = 0;
        for start in starts.iter_mut() {
            sum += *start;
            *start = sum;
        }
        ends.clear();
        ends.resize(sum as usize, 0);
        // Each start is at its segment's end and counts down, so ends go in backward.
        for_ends_backward(pairs, movers, |body, end| {
            starts[body] -= 1;
            ends[starts[body] as usize] = end;
        });
    }

    /// The ends of one body.
    pub fn of(&self, body: usize) -> &[u32] {
        &self.ends[self.starts[body] as usize..self.starts[body + 1] as usize]
    }
}

fn for_ends(pairs: &[Pair], movers: &Movers, mut f: impl FnMut(usize, u32)) {
    for (k, pair) in pairs.iter().enumerate() {
        ends_of(k, pair, movers, &mut f);
    }
}

fn for_ends_backward(pairs: &[Pair], movers: &Movers, mut f: impl FnMut(usize, u32)) {
    for (k, pair) in pairs.iter().enumerate().rev() {
        ends_of(k, pair, movers, &mut f);
    }
}

fn ends_of(k: usize, pair: &Pair, movers: &Movers, f: &mut impl FnMut(usize, u32)) {
    if pair.frozen {
        return;
    }
    for (end, &body) in pair.bodies.iter().enumerate() {
        if movers.has_mass(body as usize) {
            f(body as usize, (2 * k + end) as u32);
        }
    }
}
