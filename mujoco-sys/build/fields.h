// Expanded by the preprocessor into the table of fields: one record between @ and ; for each field.
#include <mujoco/mujoco.h>
#include <mujoco/mjxmacro.h>

#undef MJ_M
#define MJ_M(n) n
#ifdef MJ_D
#undef MJ_D
#define MJ_D(n) n
#endif

#define X(name) @ Model size int name 1 1 ;
MJMODEL_INTS
#undef X
#define X(type, name, rows, columns) @ Model array type name rows columns ;
MJMODEL_POINTERS
#undef X
#define X(type, name, rows, columns) @ Data array type name rows columns ;
MJDATA_POINTERS
#undef X
#define X(type, name) @ Data scalar type name 1 1 ;
MJDATA_SCALAR
#undef X
#define X(type, name, rows, columns) @ Data vector type name rows columns ;
MJDATA_VECTOR
#undef X
#define X(type, name) @ Option scalar type name 1 1 ;
MJOPTION_SCALARS
#undef X
#define X(name, rows) @ Option vector mjtNum name rows 1 ;
MJOPTION_VECTORS
#undef X
