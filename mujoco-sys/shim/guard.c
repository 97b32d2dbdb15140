#include "guard.h"

#include "collision.h"
#include "compat.h"
#include "compiler.h"
#include "step.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mjxmacro.h>

static MUJOCO_SYS_THREAD_LOCAL struct mujoco_sys_guard* innermost;
static MUJOCO_SYS_THREAD_LOCAL char message[1024];
static MUJOCO_SYS_THREAD_LOCAL struct mujoco_sys_full full;
static MUJOCO_SYS_THREAD_LOCAL char lost_constraints[128];
static void (*warning_sink)(const char*);

void mujoco_sys_set_message(const char* text) {
  strncpy(message, text ? text : "", sizeof(message) - 1);
  message[sizeof(message) - 1] = '\0';
}

const char* mujoco_sys_message(void) { return message; }

struct mujoco_sys_guard** mujoco_sys_innermost(void) { return &innermost; }

int mujoco_sys_is_guarded(void) { return innermost != NULL; }

static void on_error(const char* text) {
  if (!innermost) {
    // The engine was called without a guard. If this handler returned, the engine would continue
    // with a broken invariant.
    fprintf(stderr, "MuJoCo error outside of any guard: %s\n", text);
    abort();
  }
  mujoco_sys_set_message(text);
  MUJOCO_SYS_RETURN_TO(innermost->return_to);
}

// Sets the numbers of constraints that the engine does not set when it removes them.
static void clear_numbers(mjData* d) {
#if mjVERSION_HEADER >= 230
  d->ne = d->nf = 0;
#else
  (void)d;
#endif
#if mjVERSION_HEADER >= 300
  d->nl = 0;
#endif
}

// Handles a full constraint buffer: see mujoco_sys_begin_full.
static void on_full_constraints(const char* text) {
  full.count++;
  // The engine adds 1. It would print the next warning only if the number were zero.
  full.data->warning[mjWARN_CNSTRFULL].number = -1;
  clear_numbers(full.data);
  if (!full.is_fatal) return;
#if mjVERSION_HEADER >= 3010000
  // The engine drops all errors and warnings of a thread whose handler of a warning does not
  // return. So the call goes on without constraints, and fails at its end. Actuators skip
  // contacts that are excluded because they affect no joints.
  for (int i = 0; i < full.data->ncon; i++) full.data->contact[i].exclude = 3;
  full.has_failed = 1;
  snprintf(lost_constraints, sizeof(lost_constraints), "%s", text);
#else
  on_error(text);
#endif
}

static void on_warning(const char* text) {
  // The handler receives only the text, so the warning is recognised by its beginning.
#if mjVERSION_HEADER >= 230
  static const char beginning[] = "Insufficient arena memory for the number of constraints";
#else
  static const char beginning[] = "Pre-allocated constraint buffer is full";
#endif
  if (full.data && innermost && strncmp(text, beginning, sizeof(beginning) - 1) == 0) {
    on_full_constraints(text);
    return;
  }
  if (warning_sink) {
    warning_sink(text);
  } else {
    fprintf(stderr, "MuJoCo warning: %s\n", text);
  }
}

void mujoco_sys_install(void (*warn)(const char*)) {
  warning_sink = warn;
  mju_user_error = on_error;
  mju_user_warning = on_warning;
  mujoco_sys_check_collisions();
}

// The top of the engine's stack inside mjData. A failing call leaves its frames on that stack. The
// frames below belong to outer callers, so an error restores the top at entry instead of clearing
// the stack.
struct stack_mark {
  size_t top;
  size_t base;
};

static struct stack_mark mark(const mjData* d) {
  struct stack_mark at = {0, 0};
  if (d) {
    at.top = (size_t)d->pstack;
#if mjVERSION_HEADER >= 300
    at.base = (size_t)d->pbase;
#endif
  }
  return at;
}

static void restore_stack(mjData* d, struct stack_mark at) {
#if mjVERSION_HEADER >= 300
  d->pstack = at.top;
  d->pbase = at.base;
#else
  d->pstack = (int)at.top;
#endif
}

#if mjVERSION_HEADER >= 230
#undef MJ_M
#undef MJ_D
#define MJ_M(size) 0
#define MJ_D(count) (d->count = 0)

// Sets the pointers to all arrays in the arena to NULL, and the counts in their shapes to zero,
// except the contacts.
static void clear_constraints(mjData* d) {
  mjContact* const contact = d->contact;
  const int ncon = d->ncon;
#define X(type, name, rows, columns) \
  d->name = NULL;                    \
  (void)(rows);                      \
  (void)(columns);
  MJDATA_ARENA_POINTERS
#undef X
  d->contact = contact;
  d->ncon = ncon;
  clear_numbers(d);
#if mjVERSION_HEADER >= 3011000
  d->efm_active = 0;
#endif
}

#undef MJ_M
#undef MJ_D
#define MJ_M(size) size
#define MJ_D(count) count
#endif

// Removes the contacts and constraints of a failed call: the error may have occurred after the
// engine had changed their counts, and before it had allocated their arrays. The engine writes new
// contacts to the start of the arena without setting this pointer.
static void clear_arena(mjData* d) {
#if mjVERSION_HEADER >= 230
  clear_constraints(d);
  d->ncon = 0;
  d->contact = d->arena;
#else
  (void)d;
#endif
}

static void restore(mjData* d, struct stack_mark at) {
  if (d) {
    restore_stack(d, at);
    clear_arena(d);
  }
}

void mujoco_sys_begin_full(mjData* d, int is_fatal, struct mujoco_sys_full* outer) {
  *outer = full;
  full.data = d;
  full.is_fatal = is_fatal;
  full.count = full.has_failed = 0;
}

int mujoco_sys_end_full(const struct mujoco_sys_full* outer, int* count) {
  const int has_failed = full.has_failed;
  if (has_failed) {
    clear_arena(full.data);
    mujoco_sys_set_message(lost_constraints);
  }
  *count = full.count;
  full = *outer;
  return has_failed;
}

void mujoco_sys_stack_mark(const mjData* d, struct stack_mark* at) { *at = mark(d); }

void mujoco_sys_stack_restore(mjData* d, const struct stack_mark* at) { restore_stack(d, *at); }

// Resets what the engine keeps outside of the data after an error. Keeps the error's text.
MUJOCO_SYS_NOINLINE void mujoco_sys_after_error(void) {
  struct mujoco_sys_guard guard;
  char text[sizeof(message)];
  memcpy(text, message, sizeof(message));
  guard.outer = innermost;
  if (!MUJOCO_SYS_SET_MARK(guard.return_to)) {
    innermost = &guard;
    mujoco_sys_forget_collision();
  }
  innermost = guard.outer;
  memcpy(message, text, sizeof(message));
}

// `guard` and `at` do not change between setjmp and longjmp.
#define GUARDED_RUN(data, statement)                        \
  struct mujoco_sys_guard guard;                            \
  const struct stack_mark at = mark(data);                  \
  guard.outer = innermost;                                  \
  if (MUJOCO_SYS_SET_MARK(guard.return_to)) {               \
    innermost = guard.outer;                                \
    restore(data, at);                                      \
    mujoco_sys_after_error();                               \
    return MUJOCO_SYS_ERROR;                                \
  }                                                         \
  innermost = &guard;                                       \
  statement;                                                \
  innermost = guard.outer;                                  \
  return MUJOCO_SYS_OK;

// Writes the states of the constraints, which newer engines leave in the order of the islands: in
// `efc_state` are those of the solver's initial guess, or none.
static void write_states(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER >= 3005000
  if (d->nisland > 0 && d->iefc_state && m->opt.solver != mjSOL_PGS && m->opt.noslip_iterations == 0) {
    for (int i = 0; i < d->nefc; i++) d->efc_state[i] = d->iefc_state[d->map_efc2iefc[i]];
  }
#else
  (void)m;
  (void)d;
#endif
}

// Defines the guarded version of an engine function without a result, and with a result, which is
// written to `*result`.
#define GUARDED(function, data, parameters, arguments) \
  int mujoco_sys_##function parameters { GUARDED_RUN(data, function arguments) }
#define GUARDED_RESULT(function, data, parameters, arguments) \
  int mujoco_sys_##function parameters { GUARDED_RUN(data, *result = function arguments) }

// The same for functions that use only the stack of the data. An error leaves the contacts and
// constraints as they are.
#define GUARDED_STACK(function, parameters, arguments)                                          \
  static int without_data_##function parameters { GUARDED_RUN(NO_DATA, function arguments) }     \
  int mujoco_sys_##function parameters {                                                        \
    const struct stack_mark before = mark(d);                                                   \
    const int status = without_data_##function arguments;                                       \
    if (status != MUJOCO_SYS_OK) restore_stack(d, before);                                      \
    return status;                                                                              \
  }

// The same for functions that solve for the constraint forces.
#define GUARDED_SOLVER(function, parameters, arguments) \
  int mujoco_sys_##function parameters { GUARDED_RUN(d, function arguments; write_states(m, d)) }

// The same for functions whose parameters differ between versions, which compat.h adapts.
#define ADAPTED(prefix, function, data, parameters, arguments) \
  int mujoco_sys_##prefix##_##function parameters { GUARDED_RUN(data, compat_##function arguments) }
#define ADAPTED_RESULT(prefix, function, data, parameters, arguments) \
  int mujoco_sys_##prefix##_##function parameters { GUARDED_RUN(data, *result = compat_##function arguments) }

#define NO_DATA ((mjData*)NULL)

// The cheapest engine function, for the benchmark of the guard's cost.
GUARDED_RESULT(mj_version, NO_DATA, (int* result), ())

// Construction, copying and reset of models and data.
GUARDED_RESULT(mj_copyModel, NO_DATA, (mjModel * dest, const mjModel* m, mjModel** result), (dest, m))
ADAPTED_RESULT(mj, addBufferVFS, NO_DATA, (mjVFS * vfs, const char* name, const void* buffer, int size, int* result),
               (vfs, name, buffer, size))
GUARDED_RESULT(mj_loadModel, NO_DATA, (const char* filename, const mjVFS* vfs, mjModel** result), (filename, vfs))
GUARDED(mj_saveModel, NO_DATA, (const mjModel* m, const char* filename, void* buffer, int size),
        (m, filename, buffer, size))
GUARDED_RESULT(mj_makeData, NO_DATA, (const mjModel* m, mjData** result), (m))
GUARDED_RESULT(mj_copyData, dest, (mjData * dest, const mjModel* m, const mjData* src, mjData** result), (dest, m, src))
GUARDED(mj_resetData, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_resetDataKeyframe, d, (const mjModel* m, mjData* d, int key), (m, d, key))
GUARDED(mj_setConst, d, (mjModel * m, mjData* d), (m, d))

// Simulation.
GUARDED_SOLVER(mj_step, (const mjModel* m, mjData* d), (m, d))
int mujoco_sys_step_prechecked(const mjModel* m, mjData* d) { GUARDED_RUN(d, step_prechecked(m, d); write_states(m, d)) }
GUARDED(mj_step1, d, (const mjModel* m, mjData* d), (m, d))
GUARDED_SOLVER(mj_step2, (const mjModel* m, mjData* d), (m, d))
GUARDED_SOLVER(mj_forward, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_inverse, d, (const mjModel* m, mjData* d), (m, d))
GUARDED_SOLVER(mj_forwardSkip, (const mjModel* m, mjData* d, int stage, int skip_sensor), (m, d, stage, skip_sensor))
GUARDED(mj_inverseSkip, d, (const mjModel* m, mjData* d, int stage, int skip_sensor), (m, d, stage, skip_sensor))

// Computes centres of mass and, since 3.0, the flexes, as the engine's position stage does.
static void com_pos(const mjModel* m, mjData* d) {
  mj_comPos(m, d);
#if mjVERSION_HEADER >= 300
  if (m->nflex > 0) mj_flex(m, d);
#endif
}

// Computes the inertia matrix. `mj_crb` of newer engines leaves out the armature of tendons, and
// 3.5.0 the copy of the matrix, `qM`.
static void make_inertia(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER >= 337
  mj_makeM(m, d);
#else
  mj_crb(m, d);
#endif
}

// Creates the rows of the constraints, and since 3.0 their islands, as the engine's position stage
// does. The engine allocates the arrays of the rows at the place of those of an earlier call, but
// keeps the pointers to the islands, which it would read with the new rows.
static void make_constraint(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER >= 230
  clear_constraints(d);
#endif
  mj_makeConstraint(m, d);
#if mjVERSION_HEADER >= 300
  mj_island(m, d);
#endif
}

// Computes the matrices of the dual problem in place of those of an earlier call. The engine would
// append them, until the arena is full.
static void project_constraint(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER >= 230
#define X(type, name, rows, columns)                                \
  if (d->name) {                                                    \
    const size_t start = (size_t)((char*)d->name - (char*)d->arena); \
    if (start < d->parena) d->parena = start;                       \
    d->name = NULL;                                                 \
  }
  MJDATA_ARENA_POINTERS_DUAL
#undef X
#endif
  mj_projectConstraint(m, d);
}

// Parts of the pipeline.
GUARDED(mj_kinematics, d, (const mjModel* m, mjData* d), (m, d))
int mujoco_sys_parts(const mjModel* m, mjData* d, void (*const parts[])(const mjModel*, mjData*), int count) {
  GUARDED_RUN(d, for (int i = 0; i < count; i++) parts[i](m, d))
}
int mujoco_sys_mj_comPos(const mjModel* m, mjData* d) { GUARDED_RUN(d, com_pos(m, d)) }
GUARDED(mj_camlight, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_tendon, d, (const mjModel* m, mjData* d), (m, d))
int mujoco_sys_mj_crb(const mjModel* m, mjData* d) { GUARDED_RUN(d, make_inertia(m, d)) }
GUARDED(mj_factorM, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_collision, d, (const mjModel* m, mjData* d), (m, d))
int mujoco_sys_mj_makeConstraint(const mjModel* m, mjData* d) { GUARDED_RUN(d, make_constraint(m, d)) }
int mujoco_sys_mj_projectConstraint(const mjModel* m, mjData* d) { GUARDED_RUN(d, project_constraint(m, d)) }
GUARDED(mj_transmission, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_comVel, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_passive, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_referenceConstraint, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_fwdPosition, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_fwdVelocity, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_fwdActuation, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_fwdAcceleration, d, (const mjModel* m, mjData* d), (m, d))
GUARDED_SOLVER(mj_fwdConstraint, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_invPosition, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_invVelocity, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_invConstraint, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_compareFwdInv, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_sensorPos, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_sensorVel, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_sensorAcc, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_energyPos, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_energyVel, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_Euler, d, (const mjModel* m, mjData* d), (m, d))
GUARDED_SOLVER(mj_RungeKutta, (const mjModel* m, mjData* d, int N), (m, d, N))

// Functions of a computed state that use the engine's stack or report invalid arguments by
// mju_error.
GUARDED(mj_jacSubtreeCom, d, (const mjModel* m, mjData* d, mjtNum* jacp, int body), (m, d, jacp, body))
GUARDED(mj_jacPointAxis, d,
        (const mjModel* m, mjData* d, mjtNum* jacp, mjtNum* jacr, const mjtNum* point, const mjtNum* axis, int body),
        (m, d, jacp, jacr, point, axis, body))
GUARDED(mj_solveM, d, (const mjModel* m, mjData* d, mjtNum* x, const mjtNum* y, int n), (m, d, x, y, n))
GUARDED(mj_rne, d, (const mjModel* m, mjData* d, int with_acceleration, mjtNum* result),
        (m, d, with_acceleration, result))
GUARDED(mj_rnePostConstraint, d, (const mjModel* m, mjData* d), (m, d))
GUARDED(mj_subtreeVel, d, (const mjModel* m, mjData* d), (m, d))
ADAPTED_RESULT(mj, stackAlloc, d, (mjData * d, int size, mjtNum** result), (d, size))

ADAPTED(mj, solveM2, d, (const mjModel* m, mjData* d, mjtNum* x, const mjtNum* y, int n), (m, d, x, y, n))
ADAPTED(mj, addM, d, (const mjModel* m, mjData* d, mjtNum* dst, int* rownnz, int* rowadr, int* colind),
        (m, d, dst, rownnz, rowadr, colind))
GUARDED(mj_applyFT, d,
        (const mjModel* m, mjData* d, const mjtNum* force, const mjtNum* torque, const mjtNum* point, int body,
         mjtNum* qfrc_target),
        (m, d, force, torque, point, body, qfrc_target))
GUARDED(mj_objectVelocity, NO_DATA,
        (const mjModel* m, const mjData* d, int objtype, int objid, mjtNum* res, int flg_local),
        (m, d, objtype, objid, res, flg_local))
GUARDED(mj_objectAcceleration, NO_DATA,
        (const mjModel* m, const mjData* d, int objtype, int objid, mjtNum* res, int flg_local),
        (m, d, objtype, objid, res, flg_local))
GUARDED(mj_constraintUpdate, d,
        (const mjModel* m, mjData* d, const mjtNum* jar, mjtNum* cost, int flg_coneHessian),
        (m, d, jar, cost, flg_coneHessian))
GUARDED_RESULT(mj_addContact, d, (const mjModel* m, mjData* d, const mjContact* con, int* result), (m, d, con))
ADAPTED_RESULT(mj, ray, NO_DATA,
               (const mjModel* m, const mjData* d, const mjtNum* pnt, const mjtNum* vec, const mjtByte* geomgroup,
                mjtByte flg_static, int bodyexclude, int* geomid, mjtNum* result),
               (m, d, pnt, vec, geomgroup, flg_static, bodyexclude, geomid))

static int print_data(const mjModel* m, mjData* d, const char* filename) { GUARDED_RUN(d, mj_printData(m, d, filename)) }

// Since 3.0 some arrays that the engine prints can be NULL. They are replaced while it prints. The
// replacements are not on the stack, because the engine does not print while the stack is in use.
int mujoco_sys_mj_printData(const mjModel* m, mjData* d, const char* filename) {
#if mjVERSION_HEADER < 300
  return print_data(m, d, filename);
#else
  // The matrix of the dual solver, which inverse dynamics does not compute. Here it has no
  // nonzeros.
  const int no_dual = d->nefc && mj_isDual(m) && !d->efc_AR_rownnz;
  const size_t dual_rows = no_dual ? (size_t)d->nefc : 0;
  // The first row of the constraints of each tendon, -1 for none. It is NULL if constraints are
  // disabled, or do not fit into the arena.
  size_t tendons = 0;
#if mjVERSION_HEADER < 3017000
  if (!d->tendon_efcadr) tendons = (size_t)m->ntendon;
#endif
  int* rows = calloc(dual_rows + tendons + 1, sizeof(int));
  if (!rows) {
    mujoco_sys_set_message("out of memory");
    return MUJOCO_SYS_OUT_OF_MEMORY;
  }
  if (no_dual) d->efc_AR_rownnz = d->efc_AR_rowadr = rows;
#if mjVERSION_HEADER < 3017000
  for (size_t i = 0; i < tendons; i++) rows[dual_rows + i] = -1;
  if (tendons) d->tendon_efcadr = rows + dual_rows;
#endif
  const int status = print_data(m, d, filename);
  if (no_dual) d->efc_AR_rownnz = d->efc_AR_rowadr = NULL;
#if mjVERSION_HEADER < 3017000
  if (tendons) d->tendon_efcadr = NULL;
#endif
  free(rows);
  return status;
#endif
}

// Calls a collision function and converts its contacts.
static int collide(const mjModel* m, mjData* d, mjContact* con, int type1, int type2, int g1, int g2, mjtNum margin) {
#if mjVERSION_HEADER >= 3009000
  mjPreContact found[mjMAXCONPAIR];
  const int count = mujoco_sys_collide_as(m, d, found, type1, type2, g1, g2, margin);
  for (int i = 0; i < count; i++) {
    con[i].dist = found[i].dist;
    mju_copy3(con[i].pos, found[i].pos);
    mju_copy3(con[i].frame, found[i].normal);
    mju_copy3(con[i].frame + 3, found[i].tangent);
  }
  return count;
#else
  return mujoco_sys_collide_as(m, d, con, type1, type2, g1, g2, margin);
#endif
}

int mujoco_sys_collide(const mjModel* m, mjData* d, mjContact* con, int type1, int type2, int g1, int g2, mjtNum margin,
                       int* result) {
  GUARDED_RUN(d, *result = collide(m, d, con, type1, type2, g1, g2, margin))
}

GUARDED(mjd_transitionFD, d,
        (const mjModel* m, mjData* d, mjtNum eps, int centered, mjtNum* A, mjtNum* B, mjtNum* C, mjtNum* D),
        (m, d, eps, centered, A, B, C, D))

// Abstract visualisation.
GUARDED(mjv_makeScene, NO_DATA, (const mjModel* m, mjvScene* scn, int maxgeom), (m, scn, maxgeom))
GUARDED_STACK(mjv_updateScene,
              (const mjModel* m, mjData* d, const mjvOption* opt, const mjvPerturb* pert, mjvCamera* cam, int catmask,
               mjvScene* scn),
              (m, d, opt, pert, cam, catmask, scn))
GUARDED_STACK(mjv_addGeoms,
              (const mjModel* m, mjData* d, const mjvOption* opt, const mjvPerturb* pert, int catmask, mjvScene* scn),
              (m, d, opt, pert, catmask, scn))
GUARDED(mjv_makeLights, NO_DATA, (const mjModel* m, mjData* d, mjvScene* scn), (m, d, scn))
GUARDED(mjv_updateCamera, NO_DATA, (const mjModel* m, mjData* d, mjvCamera* cam, mjvScene* scn), (m, d, cam, scn))
ADAPTED(mjv, makeConnector, NO_DATA,
        (mjvGeom * geom, int type, mjtNum width, mjtNum a0, mjtNum a1, mjtNum a2, mjtNum b0, mjtNum b1, mjtNum b2),
        (geom, type, width, a0, a1, a2, b0, b1, b2))
GUARDED(mjv_cameraInModel, NO_DATA, (mjtNum * headpos, mjtNum* forward, mjtNum* up, const mjvScene* scn),
        (headpos, forward, up, scn))
GUARDED(mjv_cameraInRoom, NO_DATA, (mjtNum * headpos, mjtNum* forward, mjtNum* up, const mjvScene* scn),
        (headpos, forward, up, scn))
GUARDED(mjv_room2model, NO_DATA,
        (mjtNum * modelpos, mjtNum* modelquat, const mjtNum* roompos, const mjtNum* roomquat, const mjvScene* scn),
        (modelpos, modelquat, roompos, roomquat, scn))
GUARDED(mjv_model2room, NO_DATA,
        (mjtNum * roompos, mjtNum* roomquat, const mjtNum* modelpos, const mjtNum* modelquat, const mjvScene* scn),
        (roompos, roomquat, modelpos, modelquat, scn))
GUARDED_RESULT(mjv_frustumHeight, NO_DATA, (const mjvScene* scn, mjtNum* result), (scn))
ADAPTED(mjv, moveCamera, NO_DATA,
        (const mjModel* m, int action, mjtNum reldx, mjtNum reldy, const mjvScene* scn, mjvCamera* cam),
        (m, action, reldx, reldy, scn, cam))
GUARDED(mjv_moveModel, NO_DATA,
        (const mjModel* m, int action, mjtNum reldx, mjtNum reldy, const mjtNum* roomup, mjvScene* scn),
        (m, action, reldx, reldy, roomup, scn))
GUARDED(mjv_movePerturb, NO_DATA,
        (const mjModel* m, const mjData* d, int action, mjtNum reldx, mjtNum reldy, const mjvScene* scn,
         mjvPerturb* pert),
        (m, d, action, reldx, reldy, scn, pert))
GUARDED_STACK(mjv_initPerturb, (const mjModel* m, mjData* d, const mjvScene* scn, mjvPerturb* pert), (m, d, scn, pert))
GUARDED(mjv_applyPerturbPose, NO_DATA, (const mjModel* m, mjData* d, const mjvPerturb* pert, int flg_paused),
        (m, d, pert, flg_paused))
// Newer engines pull the selected point with its inertia, which mjv_initPerturb computes. A
// perturbation that a program has set without it pulls the point by the displacement of the centre
// of mass.
static void apply_perturb_force(const mjModel* m, mjData* d, const mjvPerturb* pert) {
#if mjVERSION_HEADER >= 233
  mjvPerturb full = *pert;
  if (full.localmass == 0 && full.select > 0) {
    // The engine computes the motion of the mouse too, for which any camera will do.
    mjvScene view;
    mjv_defaultScene(&view);
    view.scale = view.rotate[0] = 1;
    for (int i = 0; i < 2; i++) {
      view.camera[i].forward[0] = view.camera[i].up[2] = 1;
      view.camera[i].frustum_near = view.camera[i].frustum_top = 1;
      view.camera[i].frustum_bottom = -1;
    }
    mjv_initPerturb(m, d, &view, &full);
    for (int i = 0; i < 3; i++) full.refselpos[i] += pert->refpos[i] - full.refpos[i];
    mju_copy3(full.refpos, pert->refpos);
    mju_copy4(full.refquat, pert->refquat);
  }
  mjv_applyPerturbForce(m, d, &full);
#else
  mjv_applyPerturbForce(m, d, pert);
#endif
}
int mujoco_sys_mjv_applyPerturbForce(const mjModel* m, mjData* d, const mjvPerturb* pert) {
  GUARDED_RUN(NO_DATA, apply_perturb_force(m, d, pert))
}
ADAPTED_RESULT(mjv, select, NO_DATA,
               (const mjModel* m, const mjData* d, const mjvOption* vopt, mjtNum aspectratio, mjtNum relx, mjtNum rely,
                const mjvScene* scn, mjtNum* selpnt, int* geomid, int* flexid, int* skinid, int* result),
               (m, d, vopt, aspectratio, relx, rely, scn, selpnt, geomid, flexid, skinid))
