//! Lists of a fixed length. Plain serde stops reading after the last expected entry, and then reports a longer list as
//! invalid JSON.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, SeqAccess, Visitor};

/// A list of exactly `N` entries.
struct Fixed<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Deserialize<'de> for Fixed<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(FixedVisitor(PhantomData)).map(Self)
    }
}

struct FixedVisitor<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Copy + Default, const N: usize> Visitor<'de> for FixedVisitor<T, N> {
    type Value = [T; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match N {
            2 => f.write_str("a list of two numbers"),
            3 => f.write_str("a list of three numbers"),
            _ => write!(f, "a list of {N} numbers"),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<[T; N], A::Error> {
        let mut found = [T::default(); N];
        for (n, slot) in found.iter_mut().enumerate() {
            *slot = list.next_element()?.ok_or_else(|| A::Error::invalid_length(n, &self))?;
        }
        let mut n = N;
        while list.next_element::<IgnoredAny>()?.is_some() {
            n += 1;
        }
        if n == N { Ok(found) } else { Err(A::Error::invalid_length(n, &self)) }
    }
}

/// Reads a list of exactly `N` entries.
pub(super) fn one<'de, D: Deserializer<'de>, T, const N: usize>(deserializer: D) -> Result<[T; N], D::Error>
where
    T: Deserialize<'de> + Copy + Default,
{
    Fixed::deserialize(deserializer).map(|Fixed(entries)| entries)
}

/// Reads a list of lists of exactly `N` entries.
pub(super) fn list<'de, D: Deserializer<'de>, T, const N: usize>(deserializer: D) -> Result<Vec<[T; N]>, D::Error>
where
    T: Deserialize<'de> + Copy + Default,
{
    Vec::<Fixed<T, N>>::deserialize(deserializer).map(unwrapped)
}

/// Reads a list of lists of such lists.
pub(super) fn lists<'de, D: Deserializer<'de>, T, const N: usize>(deserializer: D) -> Result<Vec<Vec<[T; N]>>, D::Error>
where
    T: Deserialize<'de> + Copy + Default,
{
    let lists = Vec::<Vec<Fixed<T, N>>>::deserialize(deserializer)?;
    Ok(lists.into_iter().map(unwrapped).collect())
}

/// Unwraps the lists in place: a wrapper has the layout of its entries.
fn unwrapped<T, const N: usize>(lists: Vec<Fixed<T, N>>) -> Vec<[T; N]> {
    lists.into_iter().map(|Fixed(entries)| entries).collect()
}
