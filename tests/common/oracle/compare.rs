//! Compares answers case by case, and sums up the outcome.
//!
//! The product may round: a pair of faces on which the two disagree is forgiven if its margin is below a millionth of
//! the bodies' size. Forgiven pairs are counted, and `regimes` limits their number.

use super::body::{Body, World};
use super::brute::Touch;
use super::margin::margin;
use super::tritri::meet;
use std::collections::BTreeMap;
use std::iter::Sum;

/// Disagreements with a margin below this part of the sum of the radii are forgiven.
pub const FORGIVEN: f64 = 1e-6;

/// The outcome of comparisons.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Pairs of bodies whose boxes meet.
    pub pairs: usize,
    pub touching: usize,
    pub contained: usize,
    pub face_pairs: usize,
    /// Pairs of faces on which the answers differ within the margin.
    pub forgiven: usize,
    /// Forgiven pairs that the product does not report.
    pub missed: usize,
    /// Thread time of the oracle and of the other side, seconds.
    pub seconds: [f64; 2],
    /// Descriptions of all failures.
    pub failures: Vec<String>,
}

impl Sum for Tally {
    fn sum<I: Iterator<Item = Self>>(tallies: I) -> Self {
        tallies.fold(Self::default(), |mut sum, next| {
            sum.pairs += next.pairs;
            sum.touching += next.touching;
            sum.contained += next.contained;
            sum.face_pairs += next.face_pairs;
            sum.forgiven += next.forgiven;
            sum.missed += next.missed;
            sum.seconds[0] += next.seconds[0];
            sum.seconds[1] += next.seconds[1];
            sum.failures.extend(next.failures);
            sum
        })
    }
}

impl Tally {
    /// The header of the table whose lines [`Tally::row`] returns.
    pub fn head() -> String {
        format!(
            "{:24} {:>7} {:>9} {:>10} {:>11} {:>9} {:>9} {:>9}",
            "regime", "pairs", "touching", "contained", "face pairs", "forgiven", "oracle s", "product s"
        )
    }

    /// One line of a table.
    pub fn row(&self, name: &str) -> String {
        format!(
            "{name:24} {:>7} {:>9} {:>10} {:>11} {:>9} {:>9.2} {:>9.2}{}",
            self.pairs,
            self.touching,
            self.contained,
            self.face_pairs,
            self.forgiven,
            self.seconds[0],
            self.seconds[1],
            if self.failures.is_empty() {
                String::new()
            } else {
                format!("  {} FAILURES", self.failures.len())
            }
        )
    }

    /// Panics with the first failures, if there are any.
    pub fn require_no_failures(&self) {
        let shown: Vec<&str> = self.failures.iter().take(5).map(String::as_str).collect();
        assert!(
            shown.is_empty(),
            "{} failures, of which the first:\n{}",
            self.failures.len(),
            shown.join("\n")
        );
    }

    /// Panics if a touching pair of faces was missed, however small the margin.
    pub fn require_none_missed(&self) {
        assert_eq!(self.missed, 0, "face pairs missed of {}", self.face_pairs);
    }

    /// Panics if more than one pair in 100,000 was forgiven; a few are allowed however small the sample.
    pub fn require_few_forgiven(&self) {
        let allowed = (self.face_pairs as f64 * 1e-5).max(3.0);
        assert!(
            self.forgiven as f64 <= allowed,
            "{} of {} face pairs forgiven",
            self.forgiven,
            self.face_pairs
        );
    }
}

/// Compares an answer with the oracle's for the same bodies.
pub fn compare(label: &str, bodies: &[Body], worlds: &[World], truth: &[Touch], answer: &[Touch]) -> Tally {
    let mut tally = Tally::default();
    tally
        .failures
        .extend(malformed(worlds, answer).map(|what| format!("{label}: {what}")));
    for (i, a) in worlds.iter().enumerate() {
        tally.pairs += worlds[i + 1..].iter().filter(|b| a.bounds.meets(&b.bounds)).count();
    }
    let mut both: BTreeMap<(u32, u32), [Option<&Touch>; 2]> = BTreeMap::new();
    for (side, touches) in [truth, answer].into_iter().enumerate() {
        for touch in touches {
            both.entry((touch.a, touch.b)).or_default()[side] = Some(touch);
        }
    }
    for (&(a, b), &[expected, got]) in &both {
        let wrong = compare_pair(&mut tally, [&worlds[a as usize], &worlds[b as usize]], expected, got);
        if let Some(what) = wrong {
            let [a_body, b_body] = [&bodies[a as usize], &bodies[b as usize]].map(describe);
            tally.failures.push(format!(
                "{label}: bodies {a} and {b}: {what}\n    {a_body}\n    {b_body}"
            ));
        }
    }
    tally
}

fn compare_pair(
    tally: &mut Tally,
    [a, b]: [&World; 2],
    expected: Option<&Touch>,
    got: Option<&Touch>,
) -> Option<String> {
    let faces = |touch: Option<&Touch>| touch.map_or(vec![], |t| t.faces.clone());
    let contained = |touch: Option<&Touch>| touch.is_some_and(|t| t.contained);
    let [expected_faces, got_faces] = [faces(expected), faces(got)];
    tally.touching += usize::from(expected.is_some());
    tally.contained += usize::from(contained(expected));
    tally.face_pairs += expected_faces.len();

    let missed = expected_faces
        .iter()
        .filter(|pair| got_faces.binary_search(pair).is_err());
    let invented = got_faces
        .iter()
        .filter(|pair| expected_faces.binary_search(pair).is_err());
    let size = a.radius + b.radius;
    let mut wrong = vec![];
    for pair in missed.chain(invented) {
        let (Some(s), Some(t)) = (a.triangle(pair[0]), b.triangle(pair[1])) else {
            return Some(format!("faces {pair:?} are not faces with an area"));
        };
        let relative = margin(s, t) / size;
        if relative < FORGIVEN {
            tally.forgiven += 1;
            tally.missed += usize::from(expected_faces.binary_search(pair).is_ok());
        } else {
            let truth = if meet(s, t) { "missed" } else { "invented" };
            wrong.push(format!("{truth} faces {pair:?} (margin {relative:.1e})"));
        }
    }
    if let Some(first) = wrong.first() {
        return Some(format!(
            "{} of {} face pairs wrong: {first}",
            wrong.len(),
            expected_faces.len()
        ));
    }
    // If a forgiven pair decides whether the surfaces meet at all, it also decides about containment.
    if expected_faces.is_empty() == got_faces.is_empty() && contained(expected) != contained(got) {
        return Some(format!(
            "contained is {}, should be {}",
            contained(got),
            contained(expected)
        ));
    }
    None
}

/// Errors in the form of an answer.
fn malformed<'a>(worlds: &'a [World], answer: &'a [Touch]) -> impl Iterator<Item = String> + 'a {
    let unsorted = answer.windows(2).filter(|w| (w[0].a, w[0].b) >= (w[1].a, w[1].b));
    let unsorted = unsorted.map(|w| format!("pairs {:?} stand in the wrong order or twice", [w[0].b, w[1].b]));
    let each = answer.iter().filter_map(|touch| {
        let what = if touch.a >= touch.b || touch.b as usize >= worlds.len() {
            "names bodies that do not exist or in the wrong order"
        } else if !touch.faces.is_sorted_by(|x, y| x < y) {
            "has unsorted or repeated faces"
        } else if touch.contained != touch.faces.is_empty() {
            "is contained with faces, or not contained without"
        } else {
            return None;
        };
        Some(format!("pair {} {} {what}", touch.a, touch.b))
    });
    unsorted.chain(each)
}

fn describe(body: &Body) -> String {
    let Body {
        mesh,
        translation,
        rotation,
        scale,
    } = body;
    format!(
        "{}: translation {translation:?} rotation {rotation:?} scale {scale:?}",
        mesh.name
    )
}
