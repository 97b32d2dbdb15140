// Checked replacements of the engine's collision functions, for preconditions that a valid model or
// an edited model may violate.
#ifndef MUJOCO_SYS_COLLISION_H_
#define MUJOCO_SYS_COLLISION_H_

#include "compat.h"

// Replaces each of the engine's collision functions by a checked one, for the whole process. No
// other thread may use the engine meanwhile.
void mujoco_sys_check_collisions(void);

// Calls the engine's collision function of two geom types for two geoms, after the checks. Returns
// -1 if the engine has no such function.
int mujoco_sys_collide_as(const mjModel* m, compat_collision_data* d, compat_contact* con, int type1, int type2, int g1,
                          int g2, mjtNum margin);

// Calls a collision function of the engine for two geoms, after the checks. Returns 0 without a
// call for contacts that would overflow a row of the Jacobian.
int mujoco_sys_collide_by(mjfCollision function, const mjModel* m, compat_collision_data* d, compat_contact* con, int g1,
                          int g2, mjtNum margin);

// Returns 1 if the sensors of distances would measure these types of geoms by another method than
// the engine's own, because its function in `mjCOLLISIONFUNC` was replaced.
int mujoco_sys_changes_distance(int type1, int type2);

// Raises an engine error if the number of elements of the constraint Jacobian might overflow with
// more contacts.
void mujoco_sys_check_contacts(const mjModel* m, const mjData* d);

// Raises an engine error for a pose that is not a rotation and a bounded position, and for an
// unbounded size: the iteration of a collision or of a distance may not end.
void mujoco_sys_check_pose(const mjModel* m, const mjData* d, int geom);

// Resets the pointer to the memory of a collision stage that an error has ended. Call it in the
// thread of the error, behind a guard.
void mujoco_sys_forget_collision(void);

#endif
