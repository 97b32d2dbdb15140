//! Archives of arrays, compared with the specification of the format and with NumPy.

use std::fs;

use mujoco_safe::Error;
use mujoco_safe::npz::{self, Array};

use crate::numpy;

/// Saves an array of each type and of several shapes. Returns the name, the type, the shape and the
/// bytes of each.
fn save_samples(path: &std::path::Path) -> Vec<(&'static str, &'static str, &'static str, Vec<u8>)> {
    let doubles = [f64::NAN, -0.0, 0.1, f64::INFINITY, 5e-324, f64::MIN];
    let singles = [1.5_f32, -2.25];
    let (longs, ints) = ([i64::MIN, -1, i64::MAX], [i32::MIN, 7]);
    // More values than are written at a time.
    let bytes: Vec<u8> = (0..20_000_u32).map(|value| (value * 7) as u8).collect();
    npz::save(
        path,
        &[
            Array::new("doubles", &[1, 3, 2], &doubles),
            Array::new("singles", &[2], &singles),
            Array::new("longs", &[3, 1], &longs),
            Array::new("ints", &[2], &ints),
            Array::new("bytes", &[100, 200], &bytes),
            Array::new("flags", &[2, 2], &[true, false, false, true]),
            Array::new("number", &[], &[2.5]),
            Array::new("empty", &[4, 0], &[0.0; 0]),
            Array::new("Größe, m", &[1], &[1_u8]),
        ],
    )
    .unwrap();
    vec![
        ("doubles", "<f8", "(1, 3, 2)", doubles.iter().flat_map(|value| value.to_bits().to_le_bytes()).collect()),
        ("singles", "<f4", "(2,)", singles.iter().flat_map(|value| value.to_bits().to_le_bytes()).collect()),
        ("longs", "<i8", "(3, 1)", longs.iter().flat_map(|value| value.to_le_bytes()).collect()),
        ("ints", "<i4", "(2,)", ints.iter().flat_map(|value| value.to_le_bytes()).collect()),
        ("bytes", "|u1", "(100, 200)", bytes),
        ("flags", "|b1", "(2, 2)", vec![1, 0, 0, 1]),
        ("number", "<f8", "()", 2.5_f64.to_le_bytes().to_vec()),
        ("empty", "<f8", "(4, 0)", Vec::new()),
        ("Größe, m", "|u1", "(1,)", vec![1]),
    ]
}

#[test]
fn arrays_follow_the_numpy_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arrays.npz");
    for (name, descr, shape, bytes) in save_samples(&path) {
        let (header, found) = numpy::array(&path, name);
        assert_eq!(header, format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}"));
        assert!(found == bytes, "{name}");
    }
}

#[test]
fn numpy_loads_the_same_types_shapes_and_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arrays.npz");
    let samples = save_samples(&path);
    let script = "import sys, numpy
for name, array in numpy.load(sys.argv[1]).items():
    print(ascii(name), array.dtype.str, array.shape, list(array.tobytes()), sep='|')";
    let Some(output) = numpy::python(script, &path) else { return };
    let expected = samples.into_iter().map(|(name, descr, shape, bytes)| {
        let name = name.replace('ö', "\\xf6").replace('ß', "\\xdf");
        format!("'{name}'|{descr}|{shape}|{bytes:?}\n")
    });
    assert_eq!(output, expected.collect::<String>());
}

#[test]
fn an_archive_of_no_arrays_is_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.npz");
    npz::save(&path, &[]).unwrap();
    assert!(path.exists());
    if let Some(output) = numpy::python("import sys, numpy; print(numpy.load(sys.argv[1]).files)", &path) {
        assert_eq!(output, "[]\n");
    }
}

#[test]
fn wrong_names_and_shapes_are_errors_and_leave_the_file_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arrays.npz");
    fs::write(&path, "before").unwrap();
    let values = [1.0, 2.0, 3.0];
    let good = Array::new("good", &[3], &values);
    let named = |name| Array::new(name, &[3], &values);
    let shaped = |shape| Array::new("x", shape, &values);
    let long = "n".repeat(252);
    let deep = [1; 33];
    for (array, expected) in [
        (named("good"), "the name of an array is \"good\" twice, but must be unique"),
        (named(""), "the name of an array is \"\", but must be a file name"),
        (named("a/b"), "\"a/b\""),
        (named("../a"), "\"../a\""),
        (named("a\\b"), "must be a file name"),
        (named("a\0"), "must be a file name"),
        (named("a\n"), "must be a file name"),
        (named("C:"), "must be a file name"),
        (named("good.npy"), "without the ending .npy"),
        (named(&long), "1 to 251 bytes"),
        (shaped(&[]), "the number of values of the array 'x' of shape () is 3, but must be 1"),
        (shaped(&[2]), "of shape (2,) is 3, but must be 2"),
        (shaped(&[3, 0]), "of shape (3, 0) is 3, but must be 0"),
        (shaped(&[2, 2]), "of shape (2, 2) is 3, but must be 4"),
        (shaped(&[usize::MAX, 2]), "but must be the product of the shape, which is too large"),
        (shaped(&deep), "the number of dimensions of the array 'x' is 33, but must be at most 32"),
    ] {
        let error = npz::save(&path, &[good.clone(), array]).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }) && error.to_string().contains(expected), "{expected}: {error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert!(matches!(npz::save(folder.path(), std::slice::from_ref(&good)), Err(Error::File { .. })));
    npz::save(&path, &[good, named(&long[..251])]).unwrap();
    assert_eq!(numpy::array(&path, "good").1.len(), 24);
}
