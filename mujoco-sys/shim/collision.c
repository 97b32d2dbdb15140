#include "collision.h"

#include "compat.h"
#include "compiler.h"
#include "interpose.h"

#include <math.h>

static mjfCollision original[mjNGEOMTYPES][mjNGEOMTYPES];

// True for the types whose contacts the engine computes from points (sphere centres, capsule ends)
// and a box.
static int is_point_and_box(int type1, int type2) {
  return type2 == mjGEOM_BOX && (type1 == mjGEOM_SPHERE || type1 == mjGEOM_CAPSULE);
}

// For a point inside a box, the engine searches for the nearest face. In a box of zero, negative or
// NaN size it finds none and then writes to an array at an uninitialised index.
static void check_box(const mjModel* m, int box) {
  for (int i = 0; i < 3; i++) {
    const mjtNum size = m->geom_size[3 * box + i];
    if (!(size >= mjMINVAL && isfinite(size))) {
      compat_error_i("the size of geom %d, a box, is not positive and finite", box);
    }
  }
}

// True for the types whose contacts the engine computes iteratively (with libccd).
static int is_iterated(int type1, int type2) {
  return type1 == mjGEOM_HFIELD || type1 == mjGEOM_ELLIPSOID || type2 == mjGEOM_ELLIPSOID || type1 == mjGEOM_CYLINDER ||
         type2 == mjGEOM_CYLINDER || type2 == mjGEOM_MESH;
}

// Upper limit of the size of a shape in an iterative collision, in metres. For a box of 1e9 m on a
// height field of 1 m, rounding errors make libccd's portal search cycle for ever.
static const mjtNum largest_size = 1e6;

void mujoco_sys_check_pose(const mjModel* m, const mjData* d, int geom) {
  const mjtNum* x = d->geom_xmat + 9 * geom;
  const mjtNum determinant = x[0] * (x[4] * x[8] - x[5] * x[7]) - x[1] * (x[3] * x[8] - x[5] * x[6]) +
                             x[2] * (x[3] * x[7] - x[4] * x[6]);
  int good = fabs(determinant - 1) < 1e-2;
  for (int i = 0; i < 3; i++) {
    const mjtNum length = x[3 * i] * x[3 * i] + x[3 * i + 1] * x[3 * i + 1] + x[3 * i + 2] * x[3 * i + 2];
    good &= fabs(length - 1) < 1e-2 && fabs(d->geom_xpos[3 * geom + i]) <= mjMAXVAL;
  }
  if (!good) {
    compat_error_i("the pose of geom %d is not a rotation and a finite position", geom);
  }
  for (int i = 0; i < 3; i++) {
    if (!(fabs(m->geom_size[3 * geom + i]) <= largest_size)) {
      compat_error_i("the size of geom %d is not finite or exceeds 1e6 m", geom);
    }
  }
}

// Raises an engine error for geoms with which the collision function of their types may not end or
// may write to a wrong address.
static void check_pair(const mjModel* m, const mjData* d, int type1, int type2, int g1, int g2, mjtNum margin) {
  if (is_point_and_box(type1, type2)) {
    check_box(m, g2);
  }
  if (is_iterated(type1, type2)) {
    mujoco_sys_check_pose(m, d, g1);
    mujoco_sys_check_pose(m, d, g2);
    if (!(fabs(margin) <= largest_size)) {
      compat_error_i("the contact margin of geom %d is not finite or exceeds 1e6 m", g1);
    }
  }
}

void mujoco_sys_check_contacts(const mjModel* m, const mjData* d) {
#if mjVERSION_HEADER >= 230
  // Newer engines compute the number of elements of the constraint Jacobian in an int. A contact
  // has at most ten rows.
  if ((long long)(d->ncon + mjMAXCONPAIR) * 10 * m->nv > 1 << 30) {
    compat_error_i("the Jacobian of more than %d contacts does not fit into an int", d->ncon);
  }
#else
  (void)m;
  (void)d;
#endif
}

int mujoco_sys_collide_as(const mjModel* m, compat_collision_data* d, compat_contact* con, int type1, int type2, int g1,
                          int g2, mjtNum margin) {
  const mjfCollision function = original[type1][type2];
  if (!function) {
    return -1;
  }
  check_pair(m, d, type1, type2, g1, g2, margin);
  return function(m, d, con, g1, g2, margin);
}

// True for two geoms of one simple body, which a <pair> may name, with a sparse Jacobian. Such a
// contact has no effect on the motion, but the engine writes each degree of freedom of the body
// twice into a row that has space for one entry.
static int overflows_row(const mjModel* m, int g1, int g2) {
  const int body = m->geom_bodyid[g1];
  return body == m->geom_bodyid[g2] && m->body_simple[body] && m->body_dofnum[body] && mj_isSparse(m);
}

int mujoco_sys_collide_by(mjfCollision function, const mjModel* m, compat_collision_data* d, compat_contact* con, int g1,
                          int g2, mjtNum margin) {
  if (overflows_row(m, g1, g2)) {
    return 0;
  }
  check_pair(m, d, m->geom_type[g1], m->geom_type[g2], g1, g2, margin);
  return function(m, d, con, g1, g2, margin);
}

// These engines recognise their function for two boxes by its address in the table, and then remove
// contacts.
#define REMOVES_CONTACTS_OF_BOXES (mjVERSION_HEADER >= 330 && mjVERSION_HEADER < 3006000)

#if REMOVES_CONTACTS_OF_BOXES
// Returns 1 if a point is outside of the box whose size is multiplied by 1.01, -1 if it is inside
// of the box whose size is divided by 1.01, else 0. The engine's function with this rule is
// private.
static int is_outside(const mjtNum point[3], const mjtNum pos[3], const mjtNum mat[9], const mjtNum size[3]) {
  static const mjtNum ratio = 1.01;
  mjtNum offset[3], local[3];
  mju_sub3(offset, point, pos);
  mju_mulMatTVec3(local, mat, offset);
  int inside = 1;
  for (int i = 0; i < 3; i++) {
    if (fabs(local[i]) > size[i] * ratio) return 1;
    inside &= fabs(local[i]) < size[i] / ratio;
  }
  return -inside;
}

// True unless a contact is outside of one box and not inside of the other, by the engine's rule.
static int is_at_boxes(const mjModel* m, const mjData* d, const mjContact* con, const int boxes[2], mjtNum margin) {
  int outside[2];
  for (int side = 0; side < 2; side++) {
    const int box = boxes[side];
    mjtNum size[3];
    for (int i = 0; i < 3; i++) size[i] = m->geom_size[3 * box + i] + margin;
    outside[side] = is_outside(con->pos, d->geom_xpos + 3 * box, d->geom_xmat + 9 * box, size);
  }
  return !(outside[0] == 1 && outside[1] != -1) && !(outside[1] == 1 && outside[0] != -1);
}

static int is_same_point(const mjtNum a[3], const mjtNum b[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

// Removes the contacts of two boxes that the engine would remove if the table had its own function:
// those that are not at both boxes, and all but the last of those at one point.
static int remove_contacts(const mjModel* m, const mjData* d, mjContact* con, int count, const int boxes[2], mjtNum margin) {
  int near = 0;
  for (int i = 0; i < count; i++) {
    if (is_at_boxes(m, d, con + i, boxes, margin)) con[near++] = con[i];
  }
  int distinct = 0;
  for (int i = 0; i < near; i++) {
    int next = i + 1;
    while (next < near && !is_same_point(con[i].pos, con[next].pos)) next++;
    if (next == near) con[distinct++] = con[i];
  }
  return distinct;
}
#endif

// True for the geom types whose collision function needs no check.
static unsigned char unchecked_types[mjNGEOMTYPES][mjNGEOMTYPES];

static MUJOCO_SYS_NOINLINE int check_and_collide(const mjModel* m, compat_collision_data* d, compat_contact* con,
                                                 int g1, int g2, mjtNum margin) {
  const int type1 = m->geom_type[g1];
  const int type2 = m->geom_type[g2];
  const int count = mujoco_sys_collide_by(original[type1][type2], m, d, con, g1, g2, margin);
#if REMOVES_CONTACTS_OF_BOXES
  if (type1 == mjGEOM_BOX && type2 == mjGEOM_BOX) {
    return remove_contacts(m, d, con, count, (const int[2]){g1, g2}, margin);
  }
#endif
  return count;
}

// Called for each pair of geoms that passes the broad phase, so the common case is a few
// instructions and a tail call.
static int collide(const mjModel* m, compat_collision_data* d, compat_contact* con, int g1, int g2, mjtNum margin) {
  const int type1 = m->geom_type[g1];
  const int type2 = m->geom_type[g2];
  mujoco_sys_check_contacts(m, d);
  if (unchecked_types[type1][type2] && m->geom_bodyid[g1] != m->geom_bodyid[g2]) {
    return original[type1][type2](m, d, con, g1, g2, margin);
  }
  return check_and_collide(m, d, con, g1, g2, margin);
}

// Since 3.9 a pointer of the thread refers to memory on the stack of the data, in which the convex
// collider works. Only the end of the collision of geoms resets it. After an error within that
// collision, collisions with flexes and computations of distances would write there, even if the
// data has been freed. A complete collision resets the pointer.
#if mjVERSION_HEADER >= 3009000
// The pair is explicit, because the engine calls the contact filter for others.
static const char touching[] =
    "<mujoco><size memory='20K'/><default><geom size='1 1 1' contype='0' conaffinity='0'/></default><worldbody><geom name='a' type='plane'/>"
    "<body><freejoint/><geom name='b'/></body></worldbody><contact><pair geom1='a' geom2='b'/></contact></mujoco>";
static mjModel* model;

static void compile_touching(void) {
  if (model) return;
  char error[200];
  mjSpec* spec = mj_parseXMLString(touching, NULL, error, sizeof error);
  if (spec) {
    model = mj_compile(spec, NULL);
    mj_deleteSpec(spec);
  }
}

void mujoco_sys_forget_collision(void) {
  mjData* d = model ? mj_makeData(model) : NULL;
  if (d) {
    mj_kinematics(model, d);
    mj_collision(model, d);
    mj_deleteData(d);
  }
}
#else
static void compile_touching(void) {}
void mujoco_sys_forget_collision(void) {}
#endif

// Since 3.3 the engine measures by another method if one of these two functions is in the table.
int mujoco_sys_changes_distance(int type1, int type2) {
#if mjVERSION_HEADER >= 330
  const int i = type1 < type2 ? type1 : type2, j = type1 < type2 ? type2 : type1;
  const mjfCollision function = original[i][j];
  return mjCOLLISIONFUNC[i][j] == collide &&
         (function == original[mjGEOM_ELLIPSOID][mjGEOM_ELLIPSOID] || function == original[mjGEOM_BOX][mjGEOM_BOX]);
#else
  (void)type1;
  (void)type2;
  return 0;
#endif
}

void mujoco_sys_check_collisions(void) {
  for (int i = 0; i < mjNGEOMTYPES; i++) {
    for (int j = 0; j < mjNGEOMTYPES; j++) {
      const mjfCollision replaced = mujoco_sys_replaced(mjCOLLISIONFUNC[i][j]);
      if (replaced) {
        original[i][j] = replaced;
      } else if (mjCOLLISIONFUNC[i][j] && mjCOLLISIONFUNC[i][j] != collide) {
        original[i][j] = mjCOLLISIONFUNC[i][j];
        unchecked_types[i][j] = !is_point_and_box(i, j) && !is_iterated(i, j);
        mjCOLLISIONFUNC[i][j] = collide;
      }
    }
  }
#if REMOVES_CONTACTS_OF_BOXES
  unchecked_types[mjGEOM_BOX][mjGEOM_BOX] = 0;
#endif
  mujoco_sys_check_interposed();
  compile_touching();
}
