//! Expressions: their values, the refused ones, and agreement with a tiny evaluator of trees.

use planish::math::expression::{Expression, ExpressionError};
use planish::math::functions as f;
use proptest::prelude::*;

fn value(text: &str, x: f64) -> f64 {
    let expression = Expression::parse(text, "alpha").unwrap_or_else(|error| panic!("{text}: {error}"));
    expression.value(x).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn means(text: &str, expected: f64) {
    assert_eq!(value(text, 0.25).to_bits(), expected.to_bits(), "{text} is {}, not {expected}", value(text, 0.25));
}

fn rejects(text: &str, why: &str) {
    match Expression::parse(text, "alpha") {
        Ok(expression) => panic!("{text} was read as {expression:?}"),
        Err(error) => assert_eq!(error.to_string(), why),
    }
}

#[test]
fn operators_bind_as_in_mathematics() {
    means("1+2*3", 7.0);
    means("(1+2)*3", 9.0);
    means("7-2-1", 4.0);
    means("8/4/2", 1.0);
    means("-2^2", -4.0);
    means("(-2)^2", 4.0);
    means("2^3^2", 512.0);
    means("(2^3)^2", 64.0);
    means("2^-1", 0.5);
    means("2^-2^2", 0.0625);
    means("2*-3", -6.0);
    means("--2", 2.0);
    means("-+-+2", 2.0);
    means("1 - -1", 2.0);
    means("2^0.5^2", f::pow(2.0, 0.25));
    means("-alpha^2", -0.0625);
}

#[test]
fn numbers_are_read_as_everyone_writes_them() {
    for (text, expected) in
        [("1e3", 1000.0), ("1E3", 1000.0), ("1e+3", 1000.0), ("25e-2", 0.25), (".5", 0.5), ("5.", 5.0), ("5.e1", 50.0)]
    {
        means(text, expected);
    }
    means("007", 7.0);
    means("0.1", 0.1);
    means("1.7976931348623157e308", f64::MAX);
    means("5e-324", 5e-324);
    means("1e-400", 0.0);
    means("-0", 0.0);
    means(" \t1\n + 2 ", 3.0);
}

#[test]
fn names_are_constants_the_variable_and_functions() {
    means("pi", std::f64::consts::PI);
    means("e", std::f64::consts::E);
    means("alpha", 0.25);
    means("2*pi/5", 2.0 * std::f64::consts::PI / 5.0);
    means("cos(alpha/2)", f::cos(0.125));
    means("1/cos(alpha/2)", 1.0 / f::cos(0.125));
    means("min(3, max(alpha, 2))", 2.0);
    means("pow(2, 10)", 1024.0);
    means("abs(-3)+sqrt(16)", 7.0);
    means("ln(exp(2))", f::ln(f::exp(2.0)));
    for (name, function) in FUNCTIONS {
        means(&format!("{name}(alpha)"), function(0.25));
        means(&format!("{name}(0.25)"), function(0.25));
    }
}

#[test]
fn other_texts_are_refused_at_their_place() {
    let expected = |what: &str, at: usize, text: &str| format!("expected {what} at character {at} of \"{text}\"");
    let operand = "a number, a name or \"(\"";
    for (text, at) in [("", 1), ("1+", 3), ("*2", 1), ("()", 2), ("2^", 3), ("cos()", 5), ("π", 1)] {
        rejects(text, &expected(operand, at, text));
    }
    for (text, at) in [("1 2", 3), ("2alpha", 2), ("2e", 2), ("1..2", 3), ("1)", 2), ("1,2", 2), ("0x10", 2), ("2π", 2)]
    {
        rejects(text, &expected("an operator or the end", at, text));
    }
    rejects("(1", &expected("\")\"", 3, "(1"));
    rejects("cos 1", &expected("\"(\"", 5, "cos 1"));
    rejects("cos", &expected("\"(\"", 4, "cos"));
    rejects("cos(1, 2)", &expected("\")\"", 6, "cos(1, 2)"));
    rejects("pow(2)", &expected("\",\" and a second argument", 6, "pow(2)"));
    rejects("min(1,2,3)", &expected("\")\"", 8, "min(1,2,3)"));
    rejects(".", &expected("a number", 1, "."));
    rejects("é+1", &expected(operand, 1, "é+1"));
    let known = "pi, e, alpha, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, ln, sqrt, abs, min, max, pow";
    for name in ["valence", "Pi", "negate", "log", "x", "__import__", "cosα"] {
        let ascii: String = name.chars().take_while(char::is_ascii).collect();
        rejects(
            name,
            &if ascii == "cos" {
                expected("\"(\"", 4, name)
            } else {
                format!("unknown name \"{ascii}\"; known here: {known}")
            },
        );
    }
}

#[test]
fn the_variable_is_the_one_of_the_place() {
    assert!(Expression::parse("(valence-4)/valence", "valence").is_ok());
    let error = Expression::parse("alpha", "").expect_err("no variable is known").to_string();
    assert!(error.starts_with("unknown name \"alpha\"; known here: pi, e, sin"), "{error}");
}

#[test]
fn expressions_are_bounded() {
    let long = format!("1{}", "+1".repeat(600));
    rejects(&long, "the expression has 1201 bytes, at most 1024 are allowed; shorten it");
    means(&format!("1{}", "+1".repeat(511)), 512.0);
    rejects(&"(".repeat(20_000), "the expression has 20000 bytes, at most 1024 are allowed; shorten it");
    let nested = |n: usize| format!("{}1{}", "(".repeat(n), ")".repeat(n));
    means(&nested(31), 1.0);
    for deep in [nested(33), nested(500), "(".repeat(1024), "-".repeat(1024), "cos(".repeat(256), "2^".repeat(512)] {
        let error = Expression::parse(&deep, "alpha").expect_err("it is too deep");
        assert!(matches!(error, ExpressionError::TooDeep(_)), "{deep}: {error}");
    }
    let powers = format!("alpha{}", "^alpha".repeat(100));
    assert!(matches!(Expression::parse(&powers, "alpha"), Err(ExpressionError::TooDeep(_))));
    let sum = |n: usize| format!("a{}", "+a".repeat(n - 1));
    assert_eq!(Expression::parse(&sum(128), "a").map(|e| e.value(0.5)), Ok(Ok(64.0)));
    assert_eq!(Expression::parse(&sum(129), "a"), Err(ExpressionError::TooLarge));
}

#[test]
fn values_that_are_not_finite_are_refused() {
    for text in ["1/0", "0/0", "ln(0)", "sqrt(-1)", "asin(2)", "exp(1000)", "10^400", "(-8)^(1/3)", "max(0/0, 1)"] {
        let expression = Expression::parse(text, "alpha").expect("it follows the grammar");
        assert!(matches!(expression.value(0.0), Err(ExpressionError::NotFinite { .. })), "{text}");
    }
    let pole = Expression::parse("1/alpha", "alpha").expect("it follows the grammar");
    assert_eq!(pole.value(0.5), Ok(2.0));
    let error = pole.value(0.0).expect_err("a pole").to_string();
    assert!(error.starts_with("the expression is not finite (inf) at alpha = 0"), "{error}");
    rejects("1e309", "the expression is not finite (inf); change the expression or the parameter");
}

#[test]
fn constant_parts_are_folded() {
    let code = |text: &str| Expression::parse(text, "alpha").expect("it follows the grammar").code().to_vec();
    assert_eq!(code("2*(3+4)-sin(0)"), code("14"));
    assert_eq!(code(" alpha * (1+1) "), code("alpha*2"));
    assert_ne!(code("alpha*2"), code("2*alpha"), "the order of operands stays as written");
    assert!(Expression::parse("3*pi", "alpha").is_ok_and(|e| e.is_constant()));
    assert!(Expression::parse("0*alpha", "alpha").is_ok_and(|e| !e.is_constant()));
}

type Function = fn(f64) -> f64;

const FUNCTIONS: [(&str, Function); 13] = [
    ("sin", f::sin),
    ("cos", f::cos),
    ("tan", f::tan),
    ("asin", f::asin),
    ("acos", f::acos),
    ("atan", f::atan),
    ("sinh", f::sinh),
    ("cosh", f::cosh),
    ("tanh", f::tanh),
    ("exp", f::exp),
    ("ln", f::ln),
    ("sqrt", f::sqrt),
    ("abs", f64::abs),
];

/// An expression as a tree.
#[derive(Debug, Clone)]
enum Tree {
    Number(f64),
    Variable,
    Negate(Box<Tree>),
    Apply(usize, Box<Tree>),
    Join(char, Box<Tree>, Box<Tree>),
}

impl Tree {
    fn value(&self, x: f64) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Variable => x,
            Self::Negate(a) => -a.value(x),
            Self::Apply(function, a) => FUNCTIONS[*function].1(a.value(x)),
            Self::Join('+', a, b) => a.value(x) + b.value(x),
            Self::Join('-', a, b) => a.value(x) - b.value(x),
            Self::Join('*', a, b) => a.value(x) * b.value(x),
            Self::Join('/', a, b) => a.value(x) / b.value(x),
            Self::Join('^', a, b) => f::pow(a.value(x), b.value(x)),
            Self::Join(end, a, b) => match (a.value(x), b.value(x)) {
                (a, b) if a.is_nan() || b.is_nan() => f64::NAN,
                (a, b) if (*end == 'm' && b <= a) || (*end == 'M' && b >= a) => b,
                (a, _) => a,
            },
        }
    }

    /// Returns the binding strength: sum 0, product 1, sign 2, power 3, atom 4.
    fn rank(&self) -> u8 {
        match self {
            Self::Join('+' | '-', ..) => 0,
            Self::Join('*' | '/', ..) => 1,
            Self::Negate(_) => 2,
            Self::Join('^', ..) => 3,
            _ => 4,
        }
    }

    /// Returns the text with as few parentheses as the grammar allows.
    fn text(&self) -> String {
        let at_least = |tree: &Self, rank: u8| {
            if tree.rank() >= rank { tree.text() } else { format!("({})", tree.text()) }
        };
        match self {
            Self::Number(number) => format!("{number:?}"),
            Self::Variable => "alpha".into(),
            Self::Negate(a) => format!("-{}", at_least(a, 2)),
            Self::Apply(function, a) => format!("{}({})", FUNCTIONS[*function].0, a.text()),
            Self::Join('^', a, b) => format!("{}^{}", at_least(a, 4), at_least(b, 2)),
            Self::Join('m', a, b) => format!("min({}, {})", a.text(), b.text()),
            Self::Join('M', a, b) => format!("max({},{})", a.text(), b.text()),
            Self::Join(operator, a, b) => {
                format!("{} {operator} {}", at_least(a, self.rank()), at_least(b, self.rank() + 1))
            }
        }
    }
}

fn tree() -> impl Strategy<Value = Tree> {
    let number = prop_oneof![(0..100_u32).prop_map(f64::from), 0.0..10.0_f64, 1e-20..1e20_f64, Just(0.0)];
    let leaf = prop_oneof![number.prop_map(Tree::Number), Just(Tree::Variable)];
    leaf.prop_recursive(6, 24, 2, |inner| {
        let operator = prop::sample::select(vec!['+', '-', '*', '/', '^', 'm', 'M']);
        prop_oneof![
            1 => inner.clone().prop_map(|a| Tree::Negate(a.into())),
            2 => (0..FUNCTIONS.len(), inner.clone()).prop_map(|(function, a)| Tree::Apply(function, a.into())),
            4 => (operator, inner.clone(), inner).prop_map(|(c, a, b)| Tree::Join(c, a.into(), b.into())),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_are_those_of_the_tree(tree in tree(), x in -3.0..3.0_f64) {
        let text = tree.text();
        let expression = Expression::parse(&text, "alpha");
        let expression = match expression {
            Err(ExpressionError::TooDeep(_) | ExpressionError::TooLong(_)) => return Ok(()),
            other => other.map_err(|error| TestCaseError::fail(format!("{text}: {error}")))?,
        };
        let expected = tree.value(x) + 0.0;
        match expression.value(x) {
            Ok(value) => {
                prop_assert_eq!(value.to_bits(), expected.to_bits(), "{}: {} is not {}", text, value, expected);
            }
            Err(_) => prop_assert!(!expected.is_finite(), "{} is {}", text, expected),
        }
    }

    #[test]
    fn random_text_is_read_or_refused(
        text in prop_oneof!["[-+*/^()0-9.e, ]{0,60}", "[a-z(),+^ 0-9]{0,60}", ".{0,60}", "(cos\\(|-|2\\^|\\(){0,80}"],
    ) {
        if let Ok(Ok(value)) = Expression::parse(&text, "alpha").map(|expression| expression.value(0.3)) {
            prop_assert!(value.is_finite());
        }
    }
}
