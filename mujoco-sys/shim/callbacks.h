// The engine's callbacks, which are function pointers of the whole process and may not fail: here each has a twin that may.
#ifndef MUJOCO_SYS_CALLBACKS_H_
#define MUJOCO_SYS_CALLBACKS_H_

#include <mujoco/mujoco.h>

// What the engine asks for. Not all are callbacks of their own in the engine.
enum {
  MUJOCO_SYS_CONTROL = 0,
  MUJOCO_SYS_PASSIVE = 1,
  MUJOCO_SYS_SENSOR = 2,
  MUJOCO_SYS_CONTACT_FILTER = 3,
  MUJOCO_SYS_ACTUATOR_DYNAMICS = 4,
  MUJOCO_SYS_ACTUATOR_GAIN = 5,
  MUJOCO_SYS_ACTUATOR_BIAS = 6,
};

// What answers. `first` and `second` are the stage of a sensor, the two geoms of a contact, the index of an actuator. `value`
// comes with what the engine does without a callback (whether a pair of geoms is left out, or the number of an actuator) and
// is to be overwritten where there is a better answer. A result other than zero is an error of the engine call that asked; by
// then the handler must have returned, since that error jumps over every frame in between.
typedef int (*mujoco_sys_handler_fn)(int what, const mjModel* m, mjData* d, int first, int second, mjtNum* value);

// Makes `handler` answer what the engine asks for from now on, for the whole process. There is no way back: the engine reads
// the pointer twice, so to take it away while another thread simulates would be a call of NULL.
void mujoco_sys_answer(int what, mujoco_sys_handler_fn handler);

// Makes a monotonic clock, in seconds, the engine's, for the whole process.
void mujoco_sys_install_clock(void);

#endif
