//! Expressions: precedence, errors with their column, and agreement with a tree evaluated by hand.

use proptest::prelude::*;

use super::*;

fn value(text: &str) -> f64 {
    Expression::parse(text)
        .unwrap_or_else(|error| panic!("{error}"))
        .evaluate(|name| match name {
            "n" => Some(100.0),
            "per_cluster" => Some(8.0),
            _ => None,
        })
        .unwrap_or(f64::NAN)
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("-n^2", -10_000.0),
        ("(-n)^2", 10_000.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2^-2*4", 1.0),
        ("-2*3", -6.0),
        ("--n", 100.0),
        ("100 - 10 + 1 - 2 * 3 ^ 2 / 3", 85.0),
        ("8 / 4 / 2", 1.0),
        ("1e6 + 10^6", 2e6),
        ("1.5E-3 + .5 + 2.", 2.5015),
        ("10 * n / 10^6", 1e-3),
        ("log2(8) * sqrt(4)", 6.0),
        ("min(3, n, 2) + max(1, per_cluster)", 10.0),
        ("abs(-3) + exp(0) + ln(1) + log10(n)", 6.0),
        ("\tn*( n-1 ) /2 ", 4950.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    assert!(value("unknown").is_nan());
    assert_eq!(value("1 / (n - 100)"), f64::INFINITY);
}

#[test]
fn errors_name_the_column() {
    for (text, column, problem) in [
        ("", 1, "expected, not its end"),
        ("n +", 4, "a number, a variable or '(' is expected, not its end"),
        ("((n)", 5, "an operator or ')' is expected, not its end"),
        ("n n", 3, "an operator is expected, not 'n'"),
        ("2n", 2, "an operator is expected, not 'n'"),
        (")", 1, "not ')'"),
        ("n / / 2", 5, "not '/'"),
        ("log2", 5, "the function log2 takes its arguments in parentheses"),
        (
            "1 + log(n)",
            5,
            "there is no function 'log'; did you mean log2?; the functions are: min, max, abs",
        ),
        ("min(n)", 6, "min takes two arguments or more"),
        ("sqrt(n, 2)", 7, "an operator or ')' is expected, not ','"),
        ("1 + 1e999", 5, "'1e999' is not a finite number"),
        (".", 1, "'.' is not a finite number"),
        ("µ§", 2, "an operator is expected, not '§'"),
        ("n ** 2", 4, "not '*'"),
    ] {
        let error = Expression::parse(text).map(|_| text).unwrap_err();
        assert_eq!(error.column, column, "{error}");
        assert!(error.to_string().contains(problem), "{error}");
    }
    for deep in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000)] {
        let error = Expression::parse(&deep).unwrap_err().to_string();
        assert!(error.contains("nested more than 64 levels"), "{}", &error[..40]);
    }
    assert_eq!(value(&format!("1{}", "+1".repeat(100_000))), 100_001.0);
}

#[test]
fn variables_are_named_once_with_their_column() {
    let expression = Expression::parse("(n + list_push) / n").unwrap();
    assert_eq!(expression.variables().collect::<Vec<_>>(), [("n", 2), ("list_push", 6)]);
    assert!(!expression.uses_time() && Expression::parse("1e3*time_ns").unwrap().uses_time());
}

/// The straightforward evaluator: a tree, printed with all parentheses or with none that are not
/// needed.
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    Variable,
    Negated(Box<Tree>),
    Joined(char, Box<[Tree; 2]>),
    Called(usize, Box<Tree>),
    Largest(Vec<Tree>),
}

impl Tree {
    fn value(&self, n: f64) -> f64 {
        match self {
            Tree::Number(number) => *number,
            Tree::Variable => n,
            Tree::Negated(tree) => -tree.value(n),
            Tree::Called(k, tree) => UNARY[*k].1(tree.value(n)),
            Tree::Largest(trees) => {
                trees.iter().map(|tree| tree.value(n)).reduce(f64::max).unwrap()
            }
            Tree::Joined(sign, sides) => {
                let [a, b] = [sides[0].value(n), sides[1].value(n)];
                match sign {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a.powf(b),
                }
            }
        }
    }

    /// 0: a sum, 1: a product, 2: a sign, 3: a power, 4: anything that stands alone.
    fn level(&self) -> u8 {
        match self {
            Tree::Joined('+' | '-', _) => 0,
            Tree::Joined('*' | '/', _) => 1,
            Tree::Negated(_) => 2,
            Tree::Joined(..) => 3,
            _ => 4,
        }
    }

    fn text(&self, least: u8, spare: bool) -> String {
        let level = self.level();
        let text = match self {
            Tree::Number(number) => format!("{number:?}"),
            Tree::Variable => "n".into(),
            Tree::Negated(tree) => format!("-{}", tree.text(2, spare)),
            Tree::Called(k, tree) => format!("{}({})", UNARY[*k].0, tree.text(0, spare)),
            Tree::Largest(trees) => {
                let trees: Vec<String> = trees.iter().map(|tree| tree.text(0, spare)).collect();
                format!("max({})", trees.join(" , "))
            }
            // A power groups to the right, everything else to the left.
            Tree::Joined('^', sides) => {
                format!("{}^{}", sides[0].text(4, spare), sides[1].text(2, spare))
            }
            Tree::Joined(sign, sides) => {
                let right = sides[1].text(level + 1, spare);
                format!("{} {sign} {right}", sides[0].text(level, spare))
            }
        };
        if level < least || spare && level < 4 { format!("({text})") } else { text }
    }
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        prop_oneof![0.0..10.0, Just(1e-7), Just(1e21)].prop_map(Tree::Number),
        Just(Tree::Variable)
    ];
    leaf.prop_recursive(5, 24, 3, |tree| {
        let pair = (tree.clone(), tree.clone());
        let sign = prop_oneof![Just('+'), Just('-'), Just('*'), Just('/'), Just('^')];
        prop_oneof![
            tree.clone().prop_map(|tree| Tree::Negated(Box::new(tree))),
            (sign, pair).prop_map(|(sign, (a, b))| Tree::Joined(sign, Box::new([a, b]))),
            (0..UNARY.len(), tree.clone()).prop_map(|(k, tree)| Tree::Called(k, Box::new(tree))),
            prop::collection::vec(tree, 2..4).prop_map(Tree::Largest),
        ]
    })
}

proptest! {
    #[test]
    fn random_expressions_have_the_value_of_their_tree(tree in tree(), n in 0.5..1e6) {
        let expected = tree.value(n);
        for spare in [false, true] {
            let text = tree.text(0, spare);
            let found = Expression::parse(&text).unwrap().evaluate(|_| Some(n)).unwrap();
            prop_assert!(
                found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan(),
                "{}: {} instead of {}", text, found, expected
            );
        }
    }

    #[test]
    fn no_text_makes_the_parser_panic(text in "[-+*/^(), .e0-9nlogmax_µ]{0,40}") {
        if let Ok(expression) = Expression::parse(&text) {
            prop_assert!(expression.evaluate(|_| Some(2.0)).is_some());
        }
    }
}
