//! Memory that is fetched before it is needed.

/// Number of bytes that a processor fetches at once. Where lines are longer, some are asked for twice.
pub(crate) const LINE_BYTES: usize = 64;

/// Asks for the line of memory of a value that will be overwritten soon, beyond the processor's first cache: a line
/// that is fetched into the first one occupies one of a few slots until it arrives, and loads wait for a slot, too.
///
/// Nothing but the time of a later access changes. Does nothing where the processor cannot be asked.
pub(crate) fn fetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t2(value);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}
