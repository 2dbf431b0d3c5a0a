//! The binary form of a manifest.

use planish::job::key::Key;
use planish::service::job_key::Tenant;
use planish::service::store::{Manifest, PART_BYTES};
use proptest::prelude::*;

fn keys() -> impl Strategy<Value = Key> {
    any::<[u8; 32]>().prop_map(Key::from_bytes)
}

prop_compose! {
    fn manifests()(n_parts in 0_usize..20)(
        key in keys(),
        media_type in ".*",
        short in if n_parts == 0 { 0..1_u64 } else { 0..PART_BYTES as u64 },
        content in keys(),
        parts in prop::collection::vec(keys(), n_parts),
        warnings in prop::collection::vec(".*", 0..4),
        build in ".*",
        results_version in any::<u32>(),
        owners in prop::collection::vec(any::<u64>().prop_map(Tenant), 0..4),
    ) -> Manifest {
        let length = (parts.len() * PART_BYTES) as u64 - short;
        let owners = owners.into_iter().collect();
        Manifest { key, media_type, length, content, parts, warnings, build, results_version, owners }
    }
}

/// Appends the matching checksum to the bytes.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let checksum = blake3::hash(&bytes);
    bytes.extend_from_slice(checksum.as_bytes());
    bytes
}

proptest! {
    #[test]
    fn a_manifest_survives_its_binary_form(manifest in manifests()) {
        prop_assert_eq!(Manifest::decode(&manifest.encode()), Some(manifest));
    }

    #[test]
    fn any_flipped_bit_is_noticed(manifest in manifests(), at in any::<prop::sample::Index>(), bit in 0..8) {
        let mut bytes = manifest.encode();
        let at = at.index(bytes.len());
        bytes[at] ^= 1_u8 << bit;
        prop_assert_eq!(Manifest::decode(&bytes), None);
    }

    #[test]
    fn any_cut_is_noticed(manifest in manifests(), at in any::<prop::sample::Index>()) {
        let bytes = manifest.encode();
        prop_assert_eq!(Manifest::decode(&bytes[..at.index(bytes.len())]), None);
    }

    #[test]
    fn random_bytes_are_no_manifest(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert_eq!(Manifest::decode(&bytes), None);
        prop_assert_eq!(Manifest::decode(&sealed(bytes)), None);
    }

    #[test]
    fn a_lie_under_a_good_checksum_never_panics(
        manifest in manifests(),
        at in any::<prop::sample::Index>(),
        lie in prop::collection::vec(any::<u8>(), 1..9),
    ) {
        let mut bytes = manifest.encode();
        bytes.truncate(bytes.len() - 32);
        let at = at.index(bytes.len());
        let end = bytes.len().min(at + lie.len());
        bytes[at..end].copy_from_slice(&lie[..end - at]);
        if let Some(read) = Manifest::decode(&sealed(bytes)) {
            prop_assert_eq!(read.parts.len() as u64, read.length.div_ceil(PART_BYTES as u64));
        }
    }

    #[test]
    fn distinct_manifests_have_distinct_forms(a in manifests(), b in manifests()) {
        prop_assert_eq!(a == b, a.encode() == b.encode());
    }
}
