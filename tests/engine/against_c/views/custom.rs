//! Custom numbers, texts and tuples.

use std::ffi::CStr;

use super::driven::raw_object;
use super::{check_fields, int, models, on_model, raw, span};

#[test]
fn fields_of_numerics_texts_and_tuples_equal_c() {
    for subject in models() {
        let (name, model) = (&subject.name, &*subject.model);
        let m = on_model(model);
        check_fields!(name, model.numerics(), |numeric, i| {
            data: m.numeric_data, [int(m.numeric_adr, i); int(m.numeric_size, i)];
            => data_range: numeric.data_range(), span(m.numeric_adr, m.numeric_size, i);
        });
        check_fields!(name, model.texts(), |text, i| {
            // SAFETY: each text is in the array, with its terminator.
            => data: text.data(), unsafe { CStr::from_ptr(m.text_data.add(int(m.text_adr, i))) }.to_string_lossy();
        });
        for text in model.texts() {
            assert_eq!(text.bytes().len() + 1, int(m.text_size, text.index()), "{name}, {text:?}");
        }
        check_fields!(name, model.tuples(), |tuple, i| {
            objprm: m.tuple_objprm, [int(m.tuple_adr, i); int(m.tuple_size, i)];
            => data_range: tuple.data_range(), span(m.tuple_adr, m.tuple_size, i);
            => objects: tuple.objects().map(|object| raw_object(Some(object))).collect::<Vec<_>>(),
                span(m.tuple_adr, m.tuple_size, i)
                    .map(|at| [raw(m.tuple_objtype, at), raw(m.tuple_objid, at)])
                    .collect::<Vec<_>>();
        });
    }
}
