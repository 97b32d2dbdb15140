// Collision functions that take the place of the engine's by their names.
#ifndef MUJOCO_SYS_INTERPOSE_H_
#define MUJOCO_SYS_INTERPOSE_H_

#include "compat.h"

#if defined(__ELF__) && mjVERSION_HEADER >= 330
#define MUJOCO_SYS_INTERPOSES 1
#else
#define MUJOCO_SYS_INTERPOSES 0
#endif

// Returns the engine's function that a collision function has taken the place of, or NULL for all
// other functions.
mjfCollision mujoco_sys_replaced(mjfCollision function);

// Lets these functions check their arguments, which they do not before. No other thread may use the
// engine meanwhile.
void mujoco_sys_check_interposed(void);

#endif
