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

int mujoco_sys_sceneLightKind(const mjvLight* light) {
#if mjVERSION_HEADER >= 333
  return light->type == mjLIGHT_SPOT ? 0 : light->type == mjLIGHT_DIRECTIONAL ? 1 : 2;
#else
  return light->directional ? 1 : 0;
#endif
}

int mujoco_sys_sceneGeomCastsShadow(const mjvGeom* geom) {
#if mjVERSION_HEADER >= 4000000
  return geom->castshadow && geom->category != mjCAT_DECOR;
#elif mjVERSION_HEADER >= 301
  return geom->category != mjCAT_DECOR;
#else
  (void)geom;
  return 1;
#endif
}

int mujoco_sys_drawnTexture(const mjModel* m, int material) {
#if mjVERSION_HEADER >= 321
  return m->mat_texid[material * mjNTEXROLE + mjTEXROLE_RGB];
#elif mjVERSION_HEADER == 320
  return m->mat_texid[material * mjNTEXMAT];
#else
  return m->mat_texid[material];
#endif
}

int mujoco_sys_textureIsSrgb(const mjModel* m, int texture) {
#if mjVERSION_HEADER >= 333
  return m->tex_colorspace[texture] == mjCOLORSPACE_SRGB;
#else
  (void)m;
  (void)texture;
  return 0;
#endif
}

void mujoco_sys_setFreeProjection(mjvCamera* camera, const mjModel* m) {
#if mjVERSION_HEADER >= 320
  camera->orthographic = m->vis.global.orthographic;
#else
  (void)camera;
  (void)m;
#endif
}

struct mujoco_sys_projection mujoco_sys_sceneProjection(const mjvGLCamera* camera) {
  struct mujoco_sys_projection projection = {0, 0};
#if mjVERSION_HEADER >= 300
  projection.half_width = camera->frustum_width;
#endif
#if mjVERSION_HEADER >= 320
  projection.orthographic = camera->orthographic != 0;
#endif
  (void)camera;
  return projection;
}

int mujoco_sys_setSceneProjection(mjvGLCamera* camera, const struct mujoco_sys_projection* projection) {
  (void)camera;
#if mjVERSION_HEADER >= 320
  camera->orthographic = projection->orthographic;
#else
  if (projection->orthographic) {
    return 0;
  }
#endif
#if mjVERSION_HEADER >= 300
  camera->frustum_width = projection->half_width;
  return 1;
#else
  return projection->half_width == 0;
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

void mujoco_sys_setLayers(mjvOption* opt, int flex_layer, int bvh_depth) {
#if mjVERSION_HEADER >= 300
  opt->flex_layer = flex_layer;
  opt->bvh_depth = bvh_depth;
#else
  (void)opt;
  (void)flex_layer;
  (void)bvh_depth;
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
