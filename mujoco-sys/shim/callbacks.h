// Fallible callbacks. The engine's callbacks are process-wide function pointers that cannot report
// a failure; these forward to one handler and turn its failure into an engine error.
#ifndef MUJOCO_SYS_CALLBACKS_H_
#define MUJOCO_SYS_CALLBACKS_H_

#include <mujoco/mujoco.h>

// Identifiers of the callbacks.
enum {
  MUJOCO_SYS_CONTROL = 0,
  MUJOCO_SYS_PASSIVE = 1,
  MUJOCO_SYS_SENSOR = 2,
  MUJOCO_SYS_CONTACT_FILTER = 3,
  MUJOCO_SYS_ACTUATOR_DYNAMICS = 4,
  MUJOCO_SYS_ACTUATOR_GAIN = 5,
  MUJOCO_SYS_ACTUATOR_BIAS = 6,
};

// Handler of all callbacks. `first` and `second` are the stage of a sensor, the two geoms of a
// contact, or the index of an actuator. `value` holds the engine's default on entry (for a contact
// 1 if the pair is excluded, for an actuator its number) and the handler's result on return. A
// nonzero return value makes the calling engine function fail. The error is raised after the
// handler has returned, because it jumps over all frames up to the guard.
typedef int (*mujoco_sys_handler_fn)(int callback, const mjModel* m, mjData* d, int first, int second, mjtNum* value);

// Installs `handler` for one callback, for the whole process. A callback cannot be uninstalled: the
// engine reads the pointer twice, so clearing it while another thread simulates could call NULL.
void mujoco_sys_install_callback(int callback, mujoco_sys_handler_fn handler);

// Installs a monotonic clock, in seconds, as the engine's timer callback, for the whole process.
void mujoco_sys_install_clock(void);

#endif
