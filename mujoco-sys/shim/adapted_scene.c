// Values of the visualiser's structs, in the form of 2.2.2 for every version of the header.
#include "adapted.h"

#include <string.h>

struct mujoco_sys_texture mujoco_sys_sceneGeomTexture(const mjvGeom* geom) {
#if mjVERSION_HEADER >= 320
  return (struct mujoco_sys_texture){geom->matid, -1, {0, 0}, 0};
#else
  return (struct mujoco_sys_texture){-1, geom->texid, {geom->texrepeat[0], geom->texrepeat[1]}, geom->texuniform};
#endif
}

int mujoco_sys_setSceneGeomTexture(mjvGeom* geom, const struct mujoco_sys_texture* texture) {
#if mjVERSION_HEADER >= 320
  geom->matid = -1;
  return texture->texture < 0;
#else
  geom->texid = texture->texture;
  geom->texrepeat[0] = texture->repeat[0];
  geom->texrepeat[1] = texture->repeat[1];
  geom->texuniform = (mjtByte)(texture->uniform != 0);
  return 1;
#endif
}

int mujoco_sys_sceneLightDirectional(const mjvLight* light) {
#if mjVERSION_HEADER >= 333
  return light->type == mjLIGHT_DIRECTIONAL;
#else
  return light->directional;
#endif
}

int mujoco_sys_sceneIsFull(const mjvScene* scn) {
#if mjVERSION_HEADER >= 337
  return scn->status != 0;
#else
  (void)scn;
  return 0;
#endif
}

int mujoco_sys_sceneFlexes(const mjvScene* scn) {
#if mjVERSION_HEADER >= 300
  return scn->nflex;
#else
  (void)scn;
  return 0;
#endif
}

void mujoco_sys_sceneFlex(const mjvScene* scn, int flex, struct mujoco_sys_flex* result) {
#if mjVERSION_HEADER >= 300
  const size_t face = (size_t)scn->flexfaceadr[flex];
  const int is_skin = scn->flexskinopt && scn->flexfaceused[flex];
  result->vert = scn->flexvert + 3 * (size_t)scn->flexvertadr[flex];
  result->vertnum = scn->flexvertnum[flex];
  result->edge = scn->flexedge + 2 * (size_t)scn->flexedgeadr[flex];
  result->edgenum = scn->flexedgenum[flex];
  result->face = scn->flexface ? scn->flexface + 9 * face : NULL;
  result->normal = scn->flexnormal ? scn->flexnormal + 9 * face : NULL;
  result->texcoord = scn->flextexcoord ? scn->flextexcoord + 6 * face : NULL;
  result->facenum = scn->flexfaceused[flex];
  result->shows_vertices = scn->flexvertopt && !is_skin;
  result->shows_edges = scn->flexedgeopt && !is_skin;
#else
  (void)scn;
  (void)flex;
  memset(result, 0, sizeof(*result));
#endif
}

void mujoco_sys_clearSceneFlexes(const mjModel* m, mjvScene* scn) {
#if mjVERSION_HEADER >= 300
  size_t faces = 0;
  for (int i = 0; i < scn->nflex; i++) {
    faces += (size_t)scn->flexfacenum[i];
    scn->flexfaceused[i] = 0;
  }
  if (scn->nflex) {
    memset(scn->flexvert, 0, 3 * sizeof(float) * (size_t)m->nflexvert);
  }
  if (faces) {
    memset(scn->flexface, 0, 9 * sizeof(float) * faces);
    memset(scn->flexnormal, 0, 9 * sizeof(float) * faces);
    memset(scn->flextexcoord, 0, 6 * sizeof(float) * faces);
  }
#else
  (void)m;
  (void)scn;
#endif
}

void mujoco_sys_setFlexGroups(mjvOption* opt, const mjtByte* groups) {
#if mjVERSION_HEADER >= 300
  memcpy(opt->flexgroup, groups, sizeof(opt->flexgroup));
#else
  (void)opt;
  (void)groups;
#endif
}

void mujoco_sys_getGrip(const mjvPerturb* pert, mjtNum grip[4]) {
#if mjVERSION_HEADER >= 233
  mju_sub3(grip, pert->refselpos, pert->refpos);
  grip[3] = pert->localmass;
#else
  (void)pert;
  (void)grip;
#endif
}

void mujoco_sys_setGrip(mjvPerturb* pert, const mjtNum grip[4]) {
#if mjVERSION_HEADER >= 233
  mju_add3(pert->refselpos, pert->refpos, grip);
  pert->localmass = grip[3];
#else
  (void)pert;
  (void)grip;
#endif
}
