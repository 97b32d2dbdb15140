// Since 3.3 `mj_geomDistance`, and with it the sensors of distances, selects its method by the
// addresses of `mjc_Convex` and `mjc_BoxBox` in `mjCOLLISIONFUNC`, so another function in their
// entries changes the result. The checked functions here have the names of the engine's. The
// dynamic linker for ELF resolves a name to its first definition, that of the program, also for the
// engine's table and comparisons.
//
// Elsewhere these functions take the places of the engine's in the table only, and
// `mujoco_sys_changes_distance` says so: in programs where these symbols are not visible (a shared
// library that exports others), with an engine that binds its names itself or is linked statically
// (the definitions are weak), and with other formats of programs.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE  // RTLD_NEXT
#endif

#include "interpose.h"

#if MUJOCO_SYS_INTERPOSES

#include "collision.h"

#include <dlfcn.h>

typedef mjtNum (*distance_function)(const mjModel* m, compat_collision_data* d, int geom1, int geom2, mjtNum distmax,
                                    mjtNum fromto[6]);

// The engine's functions.
static mjfCollision engine_convex;
static mjfCollision engine_box_box;
static distance_function engine_distance;

static int checks;

static void* next(const char* name) { return dlsym(RTLD_NEXT, name); }

__attribute__((constructor)) static void find_functions(void) {
  // POSIX permits the conversion of this pointer to one to a function, ISO C does not.
  *(void**)&engine_convex = next("mjc_Convex");
  *(void**)&engine_box_box = next("mjc_BoxBox");
  *(void**)&engine_distance = next("mj_geomDistance");
}

static int call(mjfCollision function, const mjModel* m, compat_collision_data* d, compat_contact* con, int g1, int g2,
                mjtNum margin) {
  if (checks) mujoco_sys_check_contacts(m, d);
  return checks ? mujoco_sys_collide_by(function, m, d, con, g1, g2, margin) : function(m, d, con, g1, g2, margin);
}

static int convex(const mjModel* m, compat_collision_data* d, compat_contact* con, int g1, int g2, mjtNum margin) {
  return call(engine_convex, m, d, con, g1, g2, margin);
}

static int box_box(const mjModel* m, compat_collision_data* d, compat_contact* con, int g1, int g2, mjtNum margin) {
  return call(engine_box_box, m, d, con, g1, g2, margin);
}

static mjtNum distance(const mjModel* m, compat_collision_data* d, int geom1, int geom2, mjtNum distmax, mjtNum fromto[6]) {
  const int ordered = m->geom_type[geom1] <= m->geom_type[geom2];
  const int type1 = m->geom_type[ordered ? geom1 : geom2];
  const int type2 = m->geom_type[ordered ? geom2 : geom1];
  if (checks && mujoco_sys_replaced(mjCOLLISIONFUNC[type1][type2])) {
    mujoco_sys_check_pose(m, d, geom1);
    mujoco_sys_check_pose(m, d, geom2);
  }
  return engine_distance(m, d, geom1, geom2, distmax, fromto);
}

#define ALIAS(function) __attribute__((weak, alias(#function)))
ALIAS(convex) int mjc_Convex(const mjModel*, compat_collision_data*, compat_contact*, int, int, mjtNum);
ALIAS(box_box) int mjc_BoxBox(const mjModel*, compat_collision_data*, compat_contact*, int, int, mjtNum);
ALIAS(distance) mjtNum mj_geomDistance(const mjModel*, compat_collision_data*, int, int, mjtNum, mjtNum[6]);

mjfCollision mujoco_sys_replaced(mjfCollision function) {
  return function == convex ? engine_convex : function == box_box ? engine_box_box : NULL;
}

void mujoco_sys_check_interposed(void) { checks = 1; }

#else

mjfCollision mujoco_sys_replaced(mjfCollision function) {
  (void)function;
  return NULL;
}

void mujoco_sys_check_interposed(void) {}

#endif
