// Expanded by the preprocessor into the table of fields: one record between @ and ; for each field.
// A type `-` is that of the field's declaration, for values inside a struct: not all versions give
// it here.
#include <mujoco/mujoco.h>
#include <mujoco/mjxmacro.h>

// Spelling of mjNISLAND in mjxmacro.h of 3.0.
#define mjNILSAND mjNISLAND

#undef MJ_M
#define MJ_M(n) n
#undef MJ_D
#define MJ_D(n) n
// Variants of X, which mark arrays that the visualiser does not need.
#undef XMJV
#define XMJV X
#undef XNV
#define XNV X

#define X(name) @ Model size - name 1 1 ;
#ifdef MJMODEL_SIZES
MJMODEL_SIZES
#else
MJMODEL_INTS
#endif
#undef X
#define X(type, name, rows, columns) @ Model array type name rows columns ;
MJMODEL_POINTERS
#undef X
#define X(type, name, rows, columns) @ Data array type name rows columns ;
MJDATA_POINTERS
#undef X
#ifdef MJDATA_ARENA_POINTERS
#define X(type, name, rows, columns) @ Data arena type name rows columns ;
MJDATA_ARENA_POINTERS
#undef X
#endif
#define X(type, name) @ Data scalar - name 1 1 ;
MJDATA_SCALAR
#undef X
#define X(type, name, rows, columns) @ Data vector - name rows columns ;
MJDATA_VECTOR
#undef X
#ifdef MJOPTION_FIELDS
#define X(type, name, rows) @ Option scalar type name 1 1 ;
#define XVEC(type, name, rows) @ Option vector type name rows 1 ;
MJOPTION_FIELDS
#undef XVEC
#else
#define X(type, name) @ Option scalar type name 1 1 ;
MJOPTION_SCALARS
#undef X
#define X(name, rows) @ Option vector mjtNum name rows 1 ;
MJOPTION_VECTORS
#endif
#undef X
