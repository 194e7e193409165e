//! The pairs of each body: an adjacency list in compressed sparse rows.

use super::constraints::Pair;
use super::motion::BodyStates;

/// For every body its sides of pairs, in the order of pairs.
///
/// A side is one of the two bodies of a pair. Its number is twice the pair's number, plus 1 for the second body.
#[derive(Clone, Debug, Default)]
pub(super) struct PairAdjacency {
    /// Where each body's sides start; one entry more than bodies.
    starts: Vec<u32>,
    sides: Vec<u32>,
}

impl PairAdjacency {
    /// Sorts the sides of all pairs by body (a stable counting sort). Frozen pairs, and bodies without mass, have none:
    /// no impulse changes their velocity.
    pub fn build(&mut self, pairs: &[Pair], states: &BodyStates) {
        let Self { starts, sides } = self;
        starts.clear();
        starts.resize(states.len() + 1, 0);
        for_each_side(pairs.iter().enumerate(), states, |body, _| starts[body] += 1);
        let mut sum = 0;
        for start in starts.iter_mut() {
            sum += *start;
            *start = sum;
        }
        sides.clear();
        sides.resize(sum as usize, 0);
        // Each start is now the end of its range and counts down, so the sides are written in reverse.
        for_each_side(pairs.iter().enumerate().rev(), states, |body, side| {
            starts[body] -= 1;
            sides[starts[body] as usize] = side;
        });
    }

    /// The sides of one body.
    pub fn sides_of(&self, body: usize) -> &[u32] {
        &self.sides[self.starts[body] as usize..self.starts[body + 1] as usize]
    }
}

fn for_each_side<'a>(
    pairs: impl Iterator<Item = (usize, &'a Pair)>,
    states: &BodyStates,
    mut f: impl FnMut(usize, u32),
) {
    for (k, pair) in pairs.filter(|(_, pair)| !pair.frozen) {
        for (side, &body) in pair.bodies.iter().enumerate() {
            if states.has_mass(body as usize) {
                f(body as usize, (2 * k + side) as u32);
            }
        }
    }
}
