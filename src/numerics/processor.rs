//! Functions that are compiled for several instruction sets of x86, and selected at run time.
//!
//! Only code that the compiler inlines into such a function uses the vector registers, such as
//! functions with `#[inline(always)]`.

/// Instruction set that the processor has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InstructionSet(
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, reason = "read on x86 only"))] Instructions,
);

#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "the last two are constructed on x86 only")]
pub(crate) enum Instructions {
    Any,
    Avx2,
    Avx512,
}

impl InstructionSet {
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") {
                return Self(Instructions::Avx512);
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self(Instructions::Avx2);
            }
        }
        Self(Instructions::Any)
    }

    #[cfg(target_arch = "x86_64")]
    pub(crate) fn instructions(self) -> Instructions {
        self.0
    }

    /// Returns all instruction sets that the processor has.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let all = [Instructions::Any, Instructions::Avx2, Instructions::Avx512].map(Self);
        let count = match Self::detect().0 {
            Instructions::Any => 1,
            Instructions::Avx2 => 2,
            Instructions::Avx512 => 3,
        };
        all[..count].to_vec()
    }
}

/// Availability of a fused multiply-add without run-time detection.
pub(crate) const ALWAYS_FUSED: bool = cfg!(any(target_arch = "aarch64", target_feature = "fma"));

/// Defines a function that calls the variant of another function that is compiled for the
/// processor. The const parameters of the other function select fused multiply-add, and the number
/// of rows of a block of eight that the registers hold.
macro_rules! for_processor {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident = $inner:ident($($argument:ident: $kind:ty),* $(,)?)) => {
        $(#[$doc])*
        $visibility fn $name(simd: $crate::numerics::InstructionSet, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            {
                use $crate::numerics::processor::Instructions;

                #[target_feature(enable = "avx512f")]
                fn avx512($($argument: $kind),*) {
                    $inner::<true, 8>($($argument),*);
                }
                #[target_feature(enable = "avx2,fma")]
                fn avx2($($argument: $kind),*) {
                    $inner::<true, 4>($($argument),*);
                }
                match simd.instructions() {
                    // SAFETY: the module of `InstructionSet` constructs it only for instructions
                    // that it has detected. Each processor with AVX-512 has AVX2 and FMA.
                    Instructions::Avx512 => return unsafe { avx512($($argument),*) },
                    // SAFETY: as above.
                    Instructions::Avx2 => return unsafe { avx2($($argument),*) },
                    Instructions::Any => (),
                }
            }
            let _ = simd;
            $inner::<{ $crate::numerics::processor::ALWAYS_FUSED }, 2>($($argument),*);
        }
    };
}
pub(crate) use for_processor;

/// Defines a function that runs on the widest vector registers of the processor. All variants
/// compute the same bits, because the body calls no `mul_add`, and the compiler does not fuse a
/// product with a sum.
macro_rules! vectorised {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $body:block) => {
        $(#[$doc])*
        $visibility fn $name($($argument: $kind),*) {
            #[allow(clippy::inline_always, reason = "only inlined code is compiled for the target features of the caller")]
            #[inline(always)]
            fn run<const FUSED: bool, const ROWS: usize>($($argument: $kind),*) $body
            $crate::numerics::for_processor! {
                fn selected = run($($argument: $kind),*)
            }
            selected($crate::numerics::InstructionSet::detect(), $($argument),*);
        }
    };
}
pub(crate) use vectorised;
