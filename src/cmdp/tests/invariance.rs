//! Another numbering of states and actions, or another order of entries, changes no expected total.

use super::*;
use proptest::prelude::*;

fn shuffled(n: usize, stream: &mut Stream) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, below(stream, i + 1));
    }
    order
}

fn renumbered(instance: &Instance, stream: &mut Stream) -> Instance {
    let states = shuffled(instance.states, stream);
    let actions = shuffled(instance.actions, stream);
    let cost = |(x, a, c): &(usize, usize, f64)| (states[*x], actions[*a], *c);
    let mut other = Instance {
        states: instance.states,
        actions: instance.actions,
        absorbing: instance.absorbing.iter().map(|x| states[*x]).collect(),
        initial: instance.initial.iter().map(|(x, p)| (states[*x], *p)).collect(),
        transitions: instance
            .transitions
            .iter()
            .map(|(x, a, y, p)| (states[*x], actions[*a], states[*y], *p))
            .collect(),
        primary: instance.primary.iter().map(cost).collect(),
        secondary: instance
            .secondary
            .iter()
            .map(|(bound, costs)| (*bound, costs.iter().map(cost).collect()))
            .collect(),
    };
    other.transitions.reverse();
    other.primary.reverse();
    other
}

fn outcome_of(cmdp: &Cmdp, relax: bool) -> Outcome {
    let how = if relax { Unmeetable::AchieveLeast } else { Unmeetable::Refuse };
    solve_with(cmdp, &vec![how; cmdp.secondary().len()]).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn renumbering_changes_no_total(
        family in 0..Family::ALL.len(), index in 0_u64..1000, seed in any::<u64>(), relax: bool,
    ) {
        let instance = Family::ALL[family].instance(index, 12);
        let mut stream = Seeds::new(seed, vec![]).stream("renumber");
        let other = renumbered(&instance, &mut stream);
        match (outcome_of(&instance.cmdp(), relax), outcome_of(&other.cmdp(), relax)) {
            (Outcome::Optimal(a), Outcome::Optimal(b)) => {
                prop_assert!(relative(a.primary, b.primary) < 1e-9, "{} {}", a.primary, b.primary);
                for (a, b) in a.secondary.iter().zip(&b.secondary) {
                    prop_assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{a} {b}");
                }
                prop_assert_eq!(a.relaxed.len(), b.relaxed.len());
            }
            (Outcome::Infeasible(a), Outcome::Infeasible(b)) => match (a, b) {
                (Infeasible::NoSureArrival, Infeasible::NoSureArrival) => {}
                (
                    Infeasible::Bound { index: i, least: a },
                    Infeasible::Bound { index: j, least: b },
                ) => {
                    prop_assert_eq!(i, j);
                    prop_assert!(relative(a, b) < 1e-9);
                }
                _ => prop_assert!(false, "{a:?} {b:?}"),
            },
            (a, b) => prop_assert!(false, "{a:?} {b:?}"),
        }
    }
}

/// Checks that the JSON form is the same model.
#[test]
fn the_document_is_the_model() {
    for family in Family::ALL {
        let instance = family.instance(7, 10);
        assert_eq!(
            document::read(&instance.document().to_string()).unwrap().pairs(),
            instance.cmdp().pairs()
        );
    }
}
