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
        ("per_cluster * 2", 16.0),
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
        ("log2(n)", 5, "an operator is expected, not '('"),
        ("1 + 1e999", 5, "'1e999' is not a finite number"),
        (".", 1, "'.' is not a finite number"),
        ("µ§", 2, "an operator is expected, not '§'"),
        ("n ** 2", 4, "not '*'"),
    ] {
        let error = Expression::parse(text).map(|_| text).unwrap_err();
        assert!(error.contains(&format!(": at column {column}, ")), "{error}");
        assert!(error.contains(problem), "{error}");
    }
    for deep in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000)] {
        let error = Expression::parse(&deep).unwrap_err();
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

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic(text in "[-+*/^(), .e0-9nlogmax_µ]{0,40}") {
        if let Ok(expression) = Expression::parse(&text) {
            prop_assert!(expression.evaluate(|_| Some(2.0)).is_some());
        }
    }
}
