//! Functions that are compiled for several instruction sets.

/// Defines a function that runs on the widest vector registers of the processor. It is compiled for
/// AVX-512, for AVX2 and for the target of the build, and selected at run time. All variants
/// compute the same bits: none fuses a product with a sum.
///
/// Only code that the compiler inlines into the function uses the registers, such as functions with
/// `#[inline(always)]`.
macro_rules! vectorised {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $body:block) => {
        $(#[$doc])*
        $visibility fn $name($($argument: $kind),*) {
            #[allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]
            #[inline(always)]
            fn run($($argument: $kind),*) $body
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f")]
                fn avx512($($argument: $kind),*) {
                    run($($argument),*);
                }
                #[target_feature(enable = "avx2")]
                fn avx2($($argument: $kind),*) {
                    run($($argument),*);
                }
                if is_x86_feature_detected!("avx512f") {
                    // SAFETY: the processor has these instructions.
                    return unsafe { avx512($($argument),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: as above.
                    return unsafe { avx2($($argument),*) };
                }
            }
            run($($argument),*);
        }
    };
}
pub(crate) use vectorised;
