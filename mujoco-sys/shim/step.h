// The engine's step for states that the caller has already checked.
#ifndef MUJOCO_SYS_STEP_H_
#define MUJOCO_SYS_STEP_H_

#include <mujoco/mujoco.h>

// True if this header reproduces the engine's step for this version and integrator. Other
// integrators are not exported.
static inline int step_is_known(const mjModel* m) {
  return mjVERSION_HEADER == 222 && (m->opt.integrator == mjINT_EULER || m->opt.integrator == mjINT_RK4);
}

static inline mjtNum now(void) { return mjcb_time ? mjcb_time() : 0; }

// Resets the data if an acceleration is invalid. The engine's check calls two functions per number;
// here it runs only to report an invalid one.
static inline void check_accelerations(const mjModel* m, mjData* d) {
  int good = 1;
  for (int i = 0; i < m->nv; i++) {
    good &= d->qacc[i] <= mjMAXVAL && d->qacc[i] >= -mjMAXVAL;
  }
  if (!good) {
    mj_checkAcc(m, d);
  }
}

// `mj_step` without its checks of positions and velocities.
static inline void step_prechecked(const mjModel* m, mjData* d) {
  if (!step_is_known(m)) {
    mj_step(m, d);
    return;
  }
  const mjtNum start = now();
  mj_forward(m, d);
  check_accelerations(m, d);
  if (m->opt.enableflags & mjENBL_FWDINV) {
    mj_compareFwdInv(m, d);
  }
  if (m->opt.integrator == mjINT_EULER) {
    mj_Euler(m, d);
  } else {
    mj_RungeKutta(m, d, 4);
  }
  d->timer[mjTIMER_STEP].duration += now() - start;
  d->timer[mjTIMER_STEP].number++;
}

#endif
