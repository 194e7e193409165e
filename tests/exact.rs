//! `queries::check` against brute force with exact predicates, over every situation we could think of.

mod oracle;

use oracle::compare::Tally;
use oracle::product::Product;
use oracle::regimes::{REGIMES, Rule};
use oracle::shapes::Shapes;

/// Fewer touching pairs than this would prove little.
const ENOUGH: usize = 20_000;

#[test]
fn check_finds_what_brute_force_finds() {
    let shapes = Shapes::new();
    let product = Product::default();
    // Threads of our own: the product's may not wait for ours nor ours for them.
    let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
    println!("{}", Tally::head());
    let tallies: Vec<(Rule, Tally)> = REGIMES
        .iter()
        .map(|regime| {
            let tally = pool.install(|| regime.run(&shapes, regime.cases, &|bodies| product.check(bodies)));
            println!("{}", tally.row(regime.name));
            (regime.rule, tally)
        })
        .collect();
    let all: Tally = tallies.iter().map(|(_, tally)| tally.clone()).sum();
    println!("{}", all.row("all"));
    all.require_no_failures();
    assert!(all.touching >= ENOUGH, "only {} touching pairs", all.touching);
    // Where surfaces coincide by construction any number may be forgiven; elsewhere very few.
    let general: Tally = tallies
        .into_iter()
        .filter(|(rule, _)| *rule != Rule::Coincident)
        .map(|(_, t)| t)
        .sum();
    general.require_few_forgiven();
}
