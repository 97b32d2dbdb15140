// Engine functions with the parameters of 2.2.2, for every version of the header.
// `mjVERSION_HEADER` has one digit for each part of the version up to 3.4.0 (222, 340) and three
// digits from 3.5.0 (3005000), so it grows from version to version.
#ifndef MUJOCO_SYS_COMPAT_H_
#define MUJOCO_SYS_COMPAT_H_

#include <math.h>
#include <stddef.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "optional.h"

// Raises an engine error whose text contains an integer. `mju_error` takes a format since 2.3.3,
// and `mju_error_i` is removed in 3.10.
#if mjVERSION_HEADER < 233
#define compat_error_i(format, number) mju_error_i(format, number)
#else
#define compat_error_i(format, number) mju_error(format, number)
#endif

// Types of the parameters of a collision function.
#if mjVERSION_HEADER >= 3009000
typedef mjPreContact compat_contact;
#else
typedef mjContact compat_contact;
#endif
#if mjVERSION_HEADER >= 3007000
typedef mjData compat_collision_data;
#else
typedef const mjData compat_collision_data;
#endif

// Result of compat_addBufferVFS.
enum { COMPAT_VFS_ADDED = 0, COMPAT_VFS_FULL = 1, COMPAT_VFS_REPEATED = 2, COMPAT_VFS_FAILED = 3 };

// Adds a copy of a buffer to a virtual file system.
static inline int compat_addBufferVFS(mjVFS* vfs, const char* name, const void* buffer, int size) {
#if mjVERSION_HEADER >= 313
  const int outcome = mj_addBufferVFS(vfs, name, buffer, size);
  return outcome < 0 ? COMPAT_VFS_FAILED : outcome;
#else
  const int outcome = mj_makeEmptyFileVFS(vfs, name, size);
  if (outcome == 0) {
    memcpy(vfs->filedata[mj_findFileVFS(vfs, name)], buffer, (size_t)size);
  }
  return outcome;
#endif
}

// Allocates numbers on the engine's stack, in a frame that restoring the stack's mark releases.
static inline mjtNum* compat_stackAlloc(mjData* d, int size) {
#if mjVERSION_HEADER >= 300
  mj_markStack(d);
  return mj_stackAllocNum(d, (size_t)size);
#else
  return mj_stackAlloc(d, size);
#endif
}

static inline void compat_solveM2(const mjModel* m, mjData* d, mjtNum* x, const mjtNum* y, int n) {
#if mjVERSION_HEADER >= 327
  mj_markStack(d);
  mjtNum* scale = mj_stackAllocNum(d, (size_t)m->nv);
  for (int i = 0; i < m->nv; i++) {
    scale[i] = sqrt(d->qLDiagInv[i]);
  }
  mj_solveM2(m, d, x, y, scale, n);
  mj_freeStack(d);
#else
  mj_solveM2(m, d, x, y, n);
#endif
}

#if mjVERSION_HEADER >= 3005000
// Adds a number to an element of a sparse matrix. Inserts the element in the order of the columns
// if the row lacks it.
static inline void compat_addElement(mjtNum* dst, int* rownnz, const int* rowadr, int* colind, int row, int column,
                                     mjtNum value) {
  const int start = rowadr[row];
  int at = start + rownnz[row];
  while (at > start && colind[at - 1] > column) {
    at--;
  }
  if (at > start && colind[at - 1] == column) {
    dst[at - 1] += value;
    return;
  }
  for (int i = start + rownnz[row]; i > at; i--) {
    dst[i] = dst[i - 1];
    colind[i] = colind[i - 1];
  }
  dst[at] = value;
  colind[at] = column;
  rownnz[row]++;
}
#endif

// Adds the whole inertia matrix. Newer engines add its lower triangle only.
static inline void compat_addM(const mjModel* m, mjData* d, mjtNum* dst, int* rownnz, int* rowadr, int* colind) {
#if mjVERSION_HEADER >= 3005000
  for (int row = 0; row < m->nv; row++) {
    for (int i = m->M_rowadr[row]; i < m->M_rowadr[row] + m->M_rownnz[row]; i++) {
      const int column = m->M_colind[i];
      if (rownnz) {
        compat_addElement(dst, rownnz, rowadr, colind, row, column, d->M[i]);
      } else {
        dst[(size_t)row * (size_t)m->nv + (size_t)column] += d->M[i];
      }
      if (column != row && rownnz) {
        compat_addElement(dst, rownnz, rowadr, colind, column, row, d->M[i]);
      } else if (column != row) {
        dst[(size_t)column * (size_t)m->nv + (size_t)row] += d->M[i];
      }
    }
  }
#else
  mj_addM(m, d, dst, rownnz, rowadr, colind);
#endif
}

static inline mjtNum compat_ray(const mjModel* m, const mjData* d, const mjtNum* pnt, const mjtNum* vec,
                                const mjtByte* geomgroup, mjtByte flg_static, int bodyexclude, int* geomid) {
#if mjVERSION_HEADER >= 3005000
  return mj_ray(m, d, pnt, vec, geomgroup, flg_static, bodyexclude, geomid, NULL);
#else
  return mj_ray(m, d, pnt, vec, geomgroup, flg_static, bodyexclude, geomid);
#endif
}

static inline void compat_makeConnector(mjvGeom* geom, int type, mjtNum width, mjtNum a0, mjtNum a1, mjtNum a2,
                                        mjtNum b0, mjtNum b1, mjtNum b2) {
#if mjVERSION_HEADER >= 237
  const mjtNum from[3] = {a0, a1, a2}, to[3] = {b0, b1, b2};
  mjv_connector(geom, type, width, from, to);
#else
  mjv_makeConnector(geom, type, width, a0, a1, a2, b0, b1, b2);
#endif
}

static inline void compat_moveCamera(const mjModel* m, int action, mjtNum reldx, mjtNum reldy, const mjvScene* scn,
                                     mjvCamera* cam) {
#if mjVERSION_HEADER >= 3011000
  (void)scn;
  mjv_moveCamera(m, action, reldx, reldy, cam);
#else
  mjv_moveCamera(m, action, reldx, reldy, scn, cam);
#endif
}

static inline int compat_select(const mjModel* m, const mjData* d, const mjvOption* vopt, mjtNum aspectratio, mjtNum relx,
                                mjtNum rely, const mjvScene* scn, mjtNum* selpnt, int* geomid, int* flexid, int* skinid) {
#if mjVERSION_HEADER >= 300
  return mjv_select(m, d, vopt, aspectratio, relx, rely, scn, selpnt, geomid, flexid, skinid);
#else
  *flexid = -1;
  return mjv_select(m, d, vopt, aspectratio, relx, rely, scn, selpnt, geomid, skinid);
#endif
}

#endif
