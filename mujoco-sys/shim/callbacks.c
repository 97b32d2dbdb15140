#define _POSIX_C_SOURCE 199309L
#include "callbacks.h"

#if defined(_WIN32)
#include <windows.h>
#else
#include <time.h>
#endif

#include "compiler.h"

static mujoco_sys_handler_fn handler;

// Calls the handler, and raises an engine error if it fails. The handler has returned by then, so
// the jump skips none of its frames.
static mjtNum call_handler(int callback, const mjModel* m, const mjData* d, int first, int second, mjtNum value) {
  // The engine passes `const mjData*` to actuator callbacks only; it points to the same mutable
  // data as in the other callbacks.
  const mujoco_sys_handler_fn current = MUJOCO_SYS_ACQUIRE(mujoco_sys_handler_fn, handler);
  if (current(callback, m, (mjData*)d, first, second, &value)) {
    mju_error("a callback failed");
  }
  return value;
}

static void control(const mjModel* m, mjData* d) { call_handler(MUJOCO_SYS_CONTROL, m, d, 0, 0, 0); }

static void passive(const mjModel* m, mjData* d) { call_handler(MUJOCO_SYS_PASSIVE, m, d, 0, 0, 0); }

static void sensor(const mjModel* m, mjData* d, int stage) { call_handler(MUJOCO_SYS_SENSOR, m, d, stage, 0, 0); }

// The engine's default filter, which an installed callback replaces. Excludes geoms whose contype
// and conaffinity masks do not match, geoms that are welded together, and geoms of a parent and its
// child, unless the parent is welded to the world.
static int excluded(const mjModel* m, int geom1, int geom2) {
  if (!(m->geom_contype[geom1] & m->geom_conaffinity[geom2]) && !(m->geom_contype[geom2] & m->geom_conaffinity[geom1])) {
    return 1;
  }
  const int part1 = m->body_weldid[m->geom_bodyid[geom1]];
  const int part2 = m->body_weldid[m->geom_bodyid[geom2]];
  if (part1 == part2) {
    return 1;
  }
  if ((m->opt.disableflags & mjDSBL_FILTERPARENT) || !part1 || !part2) {
    return 0;
  }
  return part1 == m->body_weldid[m->body_parentid[part2]] || part2 == m->body_weldid[m->body_parentid[part1]];
}

static int contact_filter(const mjModel* m, mjData* d, int geom1, int geom2) {
  return call_handler(MUJOCO_SYS_CONTACT_FILTER, m, d, geom1, geom2, excluded(m, geom1, geom2)) != 0;
}

static mjtNum dynamics(const mjModel* m, const mjData* d, int id) {
  return call_handler(MUJOCO_SYS_ACTUATOR_DYNAMICS, m, d, id, 0, 0);
}

static mjtNum gain(const mjModel* m, const mjData* d, int id) { return call_handler(MUJOCO_SYS_ACTUATOR_GAIN, m, d, id, 0, 1); }

static mjtNum bias(const mjModel* m, const mjData* d, int id) { return call_handler(MUJOCO_SYS_ACTUATOR_BIAS, m, d, id, 0, 0); }

// Atomic, because other threads may be simulating: they read either NULL or the callback.
void mujoco_sys_install_callback(int callback, mujoco_sys_handler_fn new_handler) {
  MUJOCO_SYS_PUBLISH(handler, new_handler);
  switch (callback) {
    case MUJOCO_SYS_CONTROL:
      MUJOCO_SYS_PUBLISH(mjcb_control, control);
      break;
    case MUJOCO_SYS_PASSIVE:
      MUJOCO_SYS_PUBLISH(mjcb_passive, passive);
      break;
    case MUJOCO_SYS_SENSOR:
      MUJOCO_SYS_PUBLISH(mjcb_sensor, sensor);
      break;
    case MUJOCO_SYS_CONTACT_FILTER:
      MUJOCO_SYS_PUBLISH(mjcb_contactfilter, contact_filter);
      break;
    case MUJOCO_SYS_ACTUATOR_DYNAMICS:
      MUJOCO_SYS_PUBLISH(mjcb_act_dyn, dynamics);
      break;
    case MUJOCO_SYS_ACTUATOR_GAIN:
      MUJOCO_SYS_PUBLISH(mjcb_act_gain, gain);
      break;
    case MUJOCO_SYS_ACTUATOR_BIAS:
      MUJOCO_SYS_PUBLISH(mjcb_act_bias, bias);
      break;
  }
}

static mjtNum seconds(void) {
#if defined(_WIN32)
  LARGE_INTEGER now, per_second;
  QueryPerformanceCounter(&now);
  QueryPerformanceFrequency(&per_second);
  return (mjtNum)now.QuadPart / (mjtNum)per_second.QuadPart;
#else
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (mjtNum)now.tv_sec + 1e-9 * (mjtNum)now.tv_nsec;
#endif
}

void mujoco_sys_install_clock(void) { MUJOCO_SYS_PUBLISH(mjcb_time, seconds); }
