// What the engine's collision functions trust in, and a model, or a change of it, may not give.
#ifndef MUJOCO_SYS_COLLISION_H_
#define MUJOCO_SYS_COLLISION_H_

#include <mujoco/mujoco.h>

// Puts a checked function in the place of each of the engine's, for the whole process. No other thread may be in the engine.
void mujoco_sys_check_collisions(void);

// The function that the engine has for two types, checked, called for two geoms; -1 where it has none.
int mujoco_sys_collide_as(const mjModel* m, const mjData* d, mjContact* con, int type1, int type2, int g1, int g2,
                          mjtNum margin);

#endif
