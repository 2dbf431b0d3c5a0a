//! The grammar of words: `item* [ '(' item+ ')' ]`, `item := letter [ '^' n ] | '(' item+ ')' '^' n`.

use planish::scheme::letter::Letter;
use planish::scheme::word::Word;
use proptest::prelude::*;

fn letters(letters: &[Letter]) -> String {
    letters.iter().filter_map(|letter| letter.facts().letter).collect()
}

fn accepts(text: &str, prefix: &str, cycle: &str) {
    let word = Word::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert_eq!((letters(&word.prefix).as_str(), letters(&word.cycle).as_str()), (prefix, cycle), "{text}");
}

fn rejects(text: &str, why: &str) {
    match Word::parse(text) {
        Ok(word) => panic!("{text} was read as {word:?}"),
        Err(error) => assert_eq!(error.to_string(), why, "{text}"),
    }
}

#[test]
fn words_are_read() {
    accepts("U", "", "U");
    accepts("U2CP", "", "UCP");
    accepts("UC^3P", "", "UCCCP");
    accepts("UUCPD(UC)", "UUCPD", "UC");
    accepts("(UCP)", "", "UCP");
    accepts("(UC)^2", "", "UCUC");
    accepts("(UC)^2(D)", "UCUC", "D");
    accepts("(U(CD)^2)^2C", "", "UCDCDUCDCDC");
    accepts("U((C)^2)^2", "", "UCCCC");
    accepts("U^2(C^2)", "UU", "CC");
    accepts("((U)^1)", "", "U");
    accepts("C^064", "", &"C".repeat(64));
}

#[test]
fn other_texts_are_refused_at_their_place() {
    rejects("", "the word is empty; write at least one operator (U, D, C, A, P)");
    rejects("()", "expected an operator in the group at character 2");
    rejects("X", "\"X\" at character 1 is no operator; known are U, D, C, A, P");
    rejects("Uc", "\"c\" at character 2 is no operator; did you mean \"C\"? known are U, D, C, A, P");
    rejects("U C", "\" \" at character 2 is no operator; known are U, D, C, A, P");
    rejects("UÜC", "\"Ü\" at character 2 is no operator; known are U, D, C, A, P");
    rejects("U)", "\")\" at character 2 is no operator; known are U, D, C, A, P");
    rejects("D2", "\"2\" at character 2 is no operator; known are U, D, C, A, P");
    rejects("(UC", "expected \")\" at character 4");
    rejects("^2", "\"^\" at character 1 is no operator; known are U, D, C, A, P");
    rejects("U^", "expected a number at character 3");
    rejects("U^-1", "expected a number at character 3");
    rejects("U^2^2", "\"^\" at character 4 is no operator; known are U, D, C, A, P");
    rejects("U^0", "expected a power of at least 1 at character 4");
    rejects("U^٣", "expected a number at character 3");
    for text in ["(UC)U", "(UC)(U)", "((UC))"] {
        let place = text.find(')').expect("a group ends") + 2;
        let expected = "\"^\" and a power after the group; only the last group may go without";
        rejects(text, &format!("expected {expected} at character {place}"));
    }
    rejects("U9", "U9 is not offered; the arity of U is 2 to 8");
    rejects("U0", "U0 is not offered; the arity of U is 2 to 8");
    rejects("U99999999999999999999", "U4294967295 is not offered; the arity of U is 2 to 8");
}

#[test]
fn words_are_bounded() {
    accepts(&"C".repeat(64), "", &"C".repeat(64));
    accepts(&format!("C^63({})", "U".repeat(64)), &"C".repeat(63), &"U".repeat(64));
    let too_many = "the word has more than 64 letters once its powers are written out; ask for more levels instead";
    rejects(&"C".repeat(65), too_many);
    rejects("C^65", too_many);
    rejects("C^4294967295", too_many);
    rejects("((C^9)^9)^9", too_many);
    rejects("((((((((U^9)^9)^9)^9)^9)^9)^9)^9", too_many);
    let long = "(C)^1".repeat(52);
    rejects(&long, &format!("the word has {} bytes, at most 256 are allowed; use powers such as (UC)^3", long.len()));
    let nested = |n: usize| format!("{}U{}", "(".repeat(n), ")^1".repeat(n));
    accepts(&nested(8), "", "U");
    rejects(&nested(9), "groups are nested deeper than 8; write them out");
    rejects(&"(".repeat(256), "groups are nested deeper than 8; write them out");
}

/// A word as a tree.
#[derive(Debug, Clone)]
enum Item {
    Letter(char, u32),
    Group(Vec<Item>, u32),
}

impl Item {
    fn text(&self) -> String {
        match self {
            Self::Letter(letter, 0) => letter.to_string(),
            Self::Letter(letter, power) => format!("{letter}^{power}"),
            Self::Group(items, power) => format!("({})^{power}", items.iter().map(Self::text).collect::<String>()),
        }
    }

    fn letters(&self) -> String {
        match self {
            Self::Letter(letter, power) => letter.to_string().repeat(*power.max(&1) as usize),
            Self::Group(items, power) => items.iter().map(Self::letters).collect::<String>().repeat(*power as usize),
        }
    }
}

fn items() -> impl Strategy<Value = Vec<Item>> {
    let letter = (prop::sample::select(vec!['U', 'D', 'C', 'P']), 0..4_u32).prop_map(|(c, n)| Item::Letter(c, n));
    let item = letter.prop_recursive(4, 12, 4, |inner| {
        (proptest::collection::vec(inner, 1..4), 1..4_u32).prop_map(|(items, n)| Item::Group(items, n))
    });
    proptest::collection::vec(item, 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_words_are_read_as_they_were_meant(prefix in items(), cycle in items(), grouped in any::<bool>()) {
        let text = |items: &[Item]| items.iter().map(Item::text).collect::<String>();
        let meant = |items: &[Item]| items.iter().map(Item::letters).collect::<String>();
        let (whole, expected) = if grouped {
            (format!("{}({})", text(&prefix), text(&cycle)), (meant(&prefix), meant(&cycle)))
        } else {
            (text(&cycle), (String::new(), meant(&cycle)))
        };
        let fits = whole.len() <= 256 && expected.0.len() <= 64 && expected.1.len() <= 64;
        match Word::parse(&whole) {
            Ok(word) => prop_assert_eq!((letters(&word.prefix), letters(&word.cycle)), expected),
            Err(error) => prop_assert!(!fits, "{}: {}", whole, error),
        }
    }

    #[test]
    fn random_text_is_read_or_refused(text in prop_oneof!["[UDCP2()^0-9]{0,40}", ".{0,40}", "[(]{0,300}"]) {
        if let Ok(word) = Word::parse(&text) {
            prop_assert!(!word.cycle.is_empty(), "{}", text);
        }
    }
}
