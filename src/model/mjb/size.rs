//! Sizes that nothing in the file bounds: they decide how much memory a model and its data take, and how large the products
//! become that the engine computes in C ints.

use super::invalid::Invalid;
use super::layout::{Array, DATA_ARRAYS, MODEL_ARRAYS, size};
use super::rule::size_is;
use super::view::{View, array_bytes};

/// The engine begins each array of its buffers at a multiple of this many bytes.
const ALIGNMENT: u128 = 64;

/// The engine's buffer sizes, stack marks and products are C ints. A stack mark has the size of the next block added before
/// it is compared with the stack's end, so that the two together must stay in the range. (The compiler gives hundreds of
/// millions to models with many contacts.)
const LARGEST_STACK: usize = (1 << 30) - 1;
const LARGEST_PRODUCT: u64 = 1 << 30;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    if view.size(size::nbody) == 0 {
        return Err(Invalid::scalar("nbody", 0, "the world is a body"));
    }
    let model = buffer_bytes(MODEL_ARRAYS, view);
    size_is(view, size::nbuffer, u64::try_from(model).unwrap_or(u64::MAX), "the bytes of its arrays in memory")?;

    let data = buffer_bytes(DATA_ARRAYS, view);
    if data > i32::MAX as u128 {
        return Err(Invalid::file(format!(
            "the simulation data would have {data} bytes (njmax {}, nconmax {}, nv {}, …); the engine can address {}",
            view.size(size::njmax),
            view.size(size::nconmax),
            view.size(size::nv),
            i32::MAX
        )));
    }
    if view.size(size::nstack) > LARGEST_STACK {
        let nstack = view.size(size::nstack);
        return Err(Invalid::scalar(
            "nstack",
            nstack,
            format!("it must be at most {LARGEST_STACK} numbers, which is 8 GiB"),
        ));
    }
    products(view)
}

/// The sizes of blocks that the engine takes from its stack, as far as they are products. Those with `njmax`, `ntendon` or
/// `nu` as a factor are in `mjData` too, and bounded there.
fn products(view: &View<'_>) -> Result<(), Invalid> {
    let [nv, nbody, na, nu, nsensordata] =
        [size::nv, size::nbody, size::na, size::nu, size::nsensordata].map(|size| view.size(size) as u64);
    let state = 2 * nv + na;
    for (what, factors) in [
        ("6 nv nv", [6 * nv, nv]),
        ("6 nbody nv", [6 * nbody, nv]),
        ("nbody nbody", [nbody, nbody]),
        // Linearisation: the matrices A, B, C and D.
        ("(2 nv + na)²", [state, state]),
        ("(2 nv + na) nu", [state, nu]),
        ("(2 nv + na) nsensordata", [state, nsensordata]),
        ("nu nsensordata", [nu, nsensordata]),
    ] {
        // Each factor is below 2^34.
        let product = u128::from(factors[0]) * u128::from(factors[1]);
        if product > u128::from(LARGEST_PRODUCT) {
            return Err(Invalid::scalar(what, product, format!("more than {LARGEST_PRODUCT} overflows in the engine")));
        }
    }
    // Pairs of bodies are told by a signature with 16 bits for each, the first shifted into an int's upper half.
    if nbody >= i16::MAX as u64 {
        return Err(Invalid::scalar("nbody", nbody, format!("it must be below {}", i16::MAX)));
    }
    Ok(())
}

/// What the engine allocates for a list of arrays.
fn buffer_bytes(arrays: &[Array], view: &View<'_>) -> u128 {
    arrays.iter().fold(0, |end: u128, array| end.next_multiple_of(ALIGNMENT) + array_bytes(array, view.sizes()))
}
