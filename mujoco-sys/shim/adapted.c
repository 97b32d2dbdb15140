// Engine functions that raise no error, with the parameters of 2.2.2 for every version of the
// header.
#include "adapted.h"

#include "compat.h"

void mujoco_sys_fullM(const mjModel* m, const mjData* d, mjtNum* dst) {
#if mjVERSION_HEADER >= 3010000
  mj_fullM(m, d, dst);
#else
  mj_fullM(m, dst, d->qM);
#endif
}

mjtNum mujoco_sys_rayMesh(const mjModel* m, const mjData* d, int geomid, const mjtNum pnt[3], const mjtNum vec[3]) {
#if mjVERSION_HEADER >= 3005000
  return mj_rayMesh(m, d, geomid, pnt, vec, NULL);
#else
  return mj_rayMesh(m, d, geomid, pnt, vec);
#endif
}

mjtNum mujoco_sys_rayHfield(const mjModel* m, const mjData* d, int geomid, const mjtNum pnt[3], const mjtNum vec[3]) {
#if mjVERSION_HEADER >= 3005000
  return mj_rayHfield(m, d, geomid, pnt, vec, NULL);
#else
  return mj_rayHfield(m, d, geomid, pnt, vec);
#endif
}

mjtNum mujoco_sys_rayGeom(const mjtNum pos[3], const mjtNum mat[9], const mjtNum size[3], const mjtNum pnt[3],
                          const mjtNum vec[3], int geomtype) {
#if mjVERSION_HEADER >= 3005000
  return mju_rayGeom(pos, mat, size, pnt, vec, geomtype, NULL);
#else
  return mju_rayGeom(pos, mat, size, pnt, vec, geomtype);
#endif
}

// The engine renamed these two functions in 3.2.5.
void mujoco_sys_rotVecMat(mjtNum res[3], const mjtNum vec[3], const mjtNum mat[9]) {
#if mjVERSION_HEADER >= 325
  mju_mulMatVec3(res, mat, vec);
#else
  mju_rotVecMat(res, vec, mat);
#endif
}

void mujoco_sys_rotVecMatT(mjtNum res[3], const mjtNum vec[3], const mjtNum mat[9]) {
#if mjVERSION_HEADER >= 325
  mju_mulMatTVec3(res, mat, vec);
#else
  mju_rotVecMatT(res, vec, mat);
#endif
}

// The engine computes the same numbers as a part of mj_fwdVelocity: dense rows before 3.2.5, sparse
// rows since. Newer engines set them to zero if actuation is disabled.
void mujoco_sys_actuatorVelocity(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER >= 325
  struct mujoco_sys_row row;
#if mjVERSION_HEADER >= 3017000
  const int count = m->nout;
#else
  const int count = m->nu;
#endif
  for (int i = 0; i < count; i++) {
    d->actuator_velocity[i] = 0;
#if mjVERSION_HEADER >= 337
    if (m->opt.disableflags & mjDSBL_ACTUATION) continue;
#endif
    mujoco_sys_momentRow(m, d, i, &row);
    for (int j = 0; j < row.count; j++) {
      d->actuator_velocity[i] += row.values[j] * d->qvel[row.columns[j]];
    }
  }
#else
  mju_mulMatVec(d->actuator_velocity, d->actuator_moment, d->qvel, m->nu, m->nv);
#endif
}

void mujoco_sys_momentRow(const mjModel* m, const mjData* d, int actuator, struct mujoco_sys_row* row) {
#if mjVERSION_HEADER >= 325
  (void)m;
  const int start = d->moment_rowadr[actuator];
  *row = (struct mujoco_sys_row){d->actuator_moment + start, d->moment_colind + start, d->moment_rownnz[actuator]};
#else
  *row = (struct mujoco_sys_row){d->actuator_moment + actuator * m->nv, NULL, m->nv};
#endif
}

void mujoco_sys_tendonRow(const mjModel* m, const mjData* d, int tendon, struct mujoco_sys_row* row) {
#if mjVERSION_HEADER >= 3006000
  const int start = m->ten_J_rowadr[tendon];
  *row = (struct mujoco_sys_row){d->ten_J + start, m->ten_J_colind + start, m->ten_J_rownnz[tendon]};
#else
  if (mj_isSparse(m)) {
    const int start = d->ten_J_rowadr[tendon];
    *row = (struct mujoco_sys_row){d->ten_J + start, d->ten_J_colind + start, d->ten_J_rownnz[tendon]};
  } else {
    *row = (struct mujoco_sys_row){d->ten_J + (size_t)tendon * (size_t)m->nv, NULL, (int)m->nv};
  }
#endif
}

void mujoco_sys_factorRow(const mjModel* m, const mjData* d, int dof, struct mujoco_sys_row* row) {
#if mjVERSION_HEADER >= 336
  const int start = m->M_rowadr[dof];
  *row = (struct mujoco_sys_row){d->qLD + start, m->M_colind + start, m->M_rownnz[dof] - 1};
#elif mjVERSION_HEADER >= 331
  (void)m;
  const int start = d->M_rowadr[dof];
  *row = (struct mujoco_sys_row){d->qLD + start, d->M_colind + start, d->M_rownnz[dof] - 1};
#elif mjVERSION_HEADER == 330
  (void)m;
  const int start = d->C_rowadr[dof];
  *row = (struct mujoco_sys_row){d->qLD + start, d->C_colind + start, d->C_rownnz[dof] - 1};
#else
  (void)m;
  (void)d;
  (void)dof;
  *row = (struct mujoco_sys_row){NULL, NULL, -1};
#endif
}

void mujoco_sys_inertiaRow(const mjModel* m, const mjData* d, int dof, struct mujoco_sys_row* row) {
#if mjVERSION_HEADER >= 3011000
  const int start = m->M_rowadr[dof];
  *row = (struct mujoco_sys_row){d->M + start, m->M_colind + start, m->M_rownnz[dof]};
#else
  (void)m;
  (void)d;
  (void)dof;
  *row = (struct mujoco_sys_row){NULL, NULL, -1};
#endif
}

const mjtNum* mujoco_sys_inertia(const mjData* d) {
#if mjVERSION_HEADER >= 3011000
  return d->M;
#else
  return d->qM;
#endif
}

int mujoco_sys_inertiaLength(const mjModel* m) {
#if mjVERSION_HEADER >= 3011000
  return (int)m->nC;
#else
  return (int)m->nM;
#endif
}

mjtByte* mujoco_sys_equalityActive(const mjModel* m) {
#if mjVERSION_HEADER >= 300
  return (mjtByte*)m->eq_active0;
#else
  return m->eq_active;
#endif
}

int mujoco_sys_equalityEnforced(const mjModel* m, const mjData* d, int equality) {
#if mjVERSION_HEADER >= 300
  (void)m;
  return d->eq_active[equality];
#else
  (void)d;
  return m->eq_active[equality];
#endif
}

int mujoco_sys_equalityCouplesSites(const mjModel* m, int equality) {
#if mjVERSION_HEADER >= 323
  return m->eq_objtype[equality] == mjOBJ_SITE;
#else
  (void)m;
  (void)equality;
  return 0;
#endif
}

int mujoco_sys_activation(const mjModel* m, int actuator) {
#if mjVERSION_HEADER >= 237
  return m->actuator_actadr[actuator];
#else
  const int activation = actuator - (m->nu - m->na);
  return activation >= 0 ? activation : -1;
#endif
}

void mujoco_sys_meshFaces(const mjModel* m, int mesh, struct mujoco_sys_mesh* result) {
  const int has_texcoord = m->mesh_texcoordadr[mesh] >= 0;
  const size_t face = 3 * (size_t)m->mesh_faceadr[mesh];
  result->texcoordadr = has_texcoord ? m->mesh_texcoordadr[mesh] : 0;
#if mjVERSION_HEADER >= 233
  result->normaladr = m->mesh_normaladr[mesh];
  result->normalnum = m->mesh_normalnum[mesh];
  result->texcoordnum = has_texcoord ? m->mesh_texcoordnum[mesh] : 0;
  result->facenormal = m->mesh_facenormal + face;
  result->facetexcoord = has_texcoord ? m->mesh_facetexcoord + face : NULL;
#else
  result->normaladr = m->mesh_vertadr[mesh];
  result->normalnum = m->mesh_vertnum[mesh];
  result->texcoordnum = has_texcoord ? m->mesh_vertnum[mesh] : 0;
  result->facenormal = m->mesh_face + face;
  result->facetexcoord = has_texcoord ? m->mesh_face + face : NULL;
#endif
}

mjtByte* mujoco_sys_textureBytes(const mjModel* m) {
#if mjVERSION_HEADER >= 321
  return m->tex_data;
#else
  return m->tex_rgb;
#endif
}

int mujoco_sys_textureChannels(const mjModel* m, int texture) {
#if mjVERSION_HEADER >= 321
  return m->tex_nchannel[texture];
#else
  (void)m;
  (void)texture;
  return 3;
#endif
}

int mujoco_sys_materialTexture(const mjModel* m, int material) {
#if mjVERSION_HEADER >= 321
  const int* textures = m->mat_texid + material * mjNTEXROLE;
  return textures[mjTEXROLE_RGB] >= 0 ? textures[mjTEXROLE_RGB] : textures[mjTEXROLE_RGBA];
#elif mjVERSION_HEADER == 320
  return m->mat_texid[material * mjNTEXMAT];
#else
  return m->mat_texid[material];
#endif
}

int mujoco_sys_lightDirectional(const mjModel* m, int light) {
#if mjVERSION_HEADER >= 333
  return m->light_type[light] == mjLIGHT_DIRECTIONAL;
#else
  return m->light_directional[light];
#endif
}

void mujoco_sys_setLightDirectional(mjModel* m, int light, int directional) {
#if mjVERSION_HEADER >= 333
  m->light_type[light] = directional ? mjLIGHT_DIRECTIONAL : mjLIGHT_SPOT;
#else
  m->light_directional[light] = directional != 0;
#endif
}

mjtNum* mujoco_sys_tendonRestLength(const mjModel* m, int tendon, int* count) {
#if mjVERSION_HEADER >= 230
  *count = 2;
#else
  *count = 1;
#endif
  return m->tendon_lengthspring + *count * tendon;
}

int mujoco_sys_solverIterations(const mjData* d, int island, const mjSolverStat** statistics) {
#if mjVERSION_HEADER >= 300
  const int islands = mjNISLAND;
  const int* counts = d->solver_niter;
#else
  const int islands = 1;
  const int* counts = &d->solver_iter;
#endif
  if (island < 0 || island >= islands) return 0;
  *statistics = d->solver + island * mjNSOLVER;
  return counts[island] < mjNSOLVER ? counts[island] : mjNSOLVER;
}

mjtNum* mujoco_sys_pluginState(const mjData* d) {
#if mjVERSION_HEADER >= 230
  return d->plugin_state;
#else
  (void)d;
  return NULL;
#endif
}

size_t mujoco_sys_pluginStateLength(const mjModel* m) {
#if mjVERSION_HEADER >= 230
  return (size_t)m->npluginstate;
#else
  (void)m;
  return 0;
#endif
}

int mujoco_sys_pluginHasReset(const mjModel* m, int instance) {
#if mjVERSION_HEADER >= 230
  const mjpPlugin* plugin = mjp_getPluginAtSlot(m->plugin[instance]);
  return plugin == NULL || plugin->reset != NULL;
#else
  (void)m, (void)instance;
  return 1;
#endif
}

mjtNum* mujoco_sys_plastic(const mjData* d) {
#if mjVERSION_HEADER >= 4000000
  return d->plastic;
#else
  (void)d;
  return NULL;
#endif
}

size_t mujoco_sys_plasticLength(const mjModel* m) {
#if mjVERSION_HEADER >= 4000000
  return (size_t)m->nplastic;
#else
  (void)m;
  return 0;
#endif
}

struct mujoco_sys_contact_side mujoco_sys_contactSide(const mjContact* contact, int side) {
#if mjVERSION_HEADER >= 300
  return (struct mujoco_sys_contact_side){contact->geom[side], contact->flex[side], contact->elem[side],
                                          contact->vert[side]};
#else
  return (struct mujoco_sys_contact_side){side ? contact->geom2 : contact->geom1, -1, -1, -1};
#endif
}

void mujoco_sys_completeContact(mjContact* contact) {
#if mjVERSION_HEADER >= 300
  const int geoms[2] = {contact->geom1, contact->geom2};
  for (int i = 0; i < 2; i++) {
    contact->geom[i] = geoms[i];
    contact->flex[i] = contact->elem[i] = contact->vert[i] = -1;
  }
#else
  (void)contact;
#endif
}

void mujoco_sys_getOptions(const mjOption* opt, struct mujoco_sys_options* options) {
#if mjVERSION_HEADER >= 337
  options->apirate = 100;
#else
  options->apirate = opt->apirate;
#endif
#if mjVERSION_HEADER >= 323
  options->ccd_tolerance = opt->ccd_tolerance;
  options->ccd_iterations = opt->ccd_iterations;
#else
  options->ccd_tolerance = opt->mpr_tolerance;
  options->ccd_iterations = opt->mpr_iterations;
#endif
#if mjVERSION_HEADER >= 300
  options->collision = -1;  // the value of Rust's mjCOL_ALL for engines without the constant
#else
  options->collision = opt->collision;
#endif
#if mjVERSION_HEADER >= 300
  options->ls_tolerance = opt->ls_tolerance;
  options->ls_iterations = opt->ls_iterations;
  options->sdf_iterations = opt->sdf_iterations;
  options->sdf_initpoints = opt->sdf_initpoints;
  memcpy(options->o_friction, opt->o_friction, sizeof options->o_friction);
#else
  // The defaults of the engines that have these options.
  options->ls_tolerance = 0.01;
  options->ls_iterations = 50;
  options->sdf_iterations = 10;
  options->sdf_initpoints = 40;
  const mjtNum friction[5] = {1, 1, 0.005, 0.0001, 0.0001};
  memcpy(options->o_friction, friction, sizeof friction);
#endif
#if mjVERSION_HEADER >= 301
  options->disableactuator = opt->disableactuator;
#else
  options->disableactuator = 0;
#endif
}

void mujoco_sys_setOptions(mjOption* opt, const struct mujoco_sys_options* options) {
#if mjVERSION_HEADER < 337
  opt->apirate = options->apirate;
#endif
#if mjVERSION_HEADER >= 323
  opt->ccd_tolerance = options->ccd_tolerance;
  opt->ccd_iterations = options->ccd_iterations;
#else
  opt->mpr_tolerance = options->ccd_tolerance;
  opt->mpr_iterations = options->ccd_iterations;
#endif
#if mjVERSION_HEADER < 300
  opt->collision = options->collision;
#else
  opt->ls_tolerance = options->ls_tolerance;
  opt->ls_iterations = options->ls_iterations;
  opt->sdf_iterations = options->sdf_iterations;
  opt->sdf_initpoints = options->sdf_initpoints;
  memcpy(opt->o_friction, options->o_friction, sizeof opt->o_friction);
#endif
#if mjVERSION_HEADER >= 301
  opt->disableactuator = options->disableactuator;
#endif
}

mjtNum* mujoco_sys_history(const mjData* d) {
#if mjVERSION_HEADER >= 3005000
  return d->history;
#else
  (void)d;
  return NULL;
#endif
}

int mujoco_sys_historyLength(const mjModel* m) {
#if mjVERSION_HEADER >= 3005000
  return (int)m->nhistory;
#else
  (void)m;
  return 0;
#endif
}

void mujoco_sys_readCtrl(const mjModel* m, const mjData* d, int id, mjtNum time, int interp, mjtNum* result) {
#if mjVERSION_HEADER >= 3014000
  const mjtNum* values = mj_readCtrl(m, d, id, time, result, interp);
  if (values && values != result) mju_copy(result, values, m->actuator_ctrlnum[id]);
#elif mjVERSION_HEADER >= 3005000
  *result = mj_readCtrl(m, d, id, time, interp);
#else
  (void)m, (void)time, (void)interp;
  *result = d->ctrl[id];
#endif
}

void mujoco_sys_readSensor(const mjModel* m, const mjData* d, int id, mjtNum time, int interp, mjtNum* result) {
#if mjVERSION_HEADER >= 3005000
  const mjtNum* values = mj_readSensor(m, d, id, time, result, interp);
#else
  (void)time, (void)interp;
  const mjtNum* values = d->sensordata + m->sensor_adr[id];
#endif
  if (values && values != result) mju_copy(result, values, m->sensor_dim[id]);
}

void mujoco_sys_resetCtrl(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER >= 3011000
  mj_resetCtrl(m, d);
#else
  mju_zero(d->ctrl, m->nu);
#endif
}

const char* mujoco_sys_actuatorInputName(const mjModel* m, int id, int input) {
#if mjVERSION_HEADER >= 3011000
  return mj_actuatorInputName(m, id, input);
#else
  (void)m, (void)id, (void)input;
  return NULL;
#endif
}

int mujoco_sys_insideSite(const mjModel* m, const mjData* d, int site, const mjtNum point[3]) {
#if mjVERSION_HEADER >= 3013000
  return mj_insideSite(m, d, site, point);
#else
  (void)m, (void)d, (void)site, (void)point;
  return -1;
#endif
}

mjtNum mujoco_sys_rayFlex(const mjModel* m, const mjData* d, int layer, int vertices, int edges, int faces, int skin,
                          int flex, const mjtNum pnt[3], const mjtNum vec[3], int* vertex) {
#if mjVERSION_HEADER >= 3005000
  return mj_rayFlex(m, d, layer, vertices != 0, edges != 0, faces != 0, skin != 0, flex, pnt, vec, vertex, NULL);
#elif mjVERSION_HEADER >= 300
  return mju_rayFlex(m, d, layer, vertices != 0, edges != 0, faces != 0, skin != 0, flex, pnt, vec, vertex);
#else
  (void)m, (void)d, (void)layer, (void)vertices, (void)edges, (void)faces, (void)skin;
  (void)flex, (void)pnt, (void)vec, (void)vertex;
  return -1;
#endif
}

int mujoco_sys_initiallyAsleep(const mjModel* m) {
#if mjVERSION_HEADER >= 340
  for (int i = 0; i < m->ntree; i++) {
    if (m->tree_sleep_policy[i] == mjSLEEP_INIT) {
      return m->tree_bodyadr[i];
    }
  }
#endif
  (void)m;
  return -1;
}

int mujoco_sys_isAsleep(const mjModel* m, const mjData* d, int body) {
#if mjVERSION_HEADER >= 340
  int tree = m->body_treeid[body];
  return tree >= 0 && d->tree_asleep[tree] >= 0;
#else
  (void)m, (void)d, (void)body;
  return 0;
#endif
}

int mujoco_sys_wake(const mjModel* m, mjData* d, int recompute_static) {
  int woken = 0;
#if mjVERSION_HEADER >= 340
  for (int i = 0; i < m->ntree; i++) {
    woken += d->tree_asleep[i] >= 0;
    d->tree_asleep[i] = -(1 + mjMINAWAKE);
    d->tree_awake[i] = 1;
  }
  for (int i = 0; i < m->nbody; i++) {
    d->body_awake_ind[i] = i;
    if (i > 0) {
      d->parent_awake_ind[i - 1] = i;
    }
    // The engine computes the poses of awake bodies only, and counts those attached to mocap bodies
    // as awake.
    int is_static = m->body_treeid[i] < 0 && m->body_mocapid[m->body_rootid[i]] < 0;
    d->body_awake[i] = is_static && !recompute_static ? mjS_STATIC : mjS_AWAKE;
  }
  for (int i = 0; i < m->nv; i++) {
    d->dof_awake_ind[i] = i;
  }
  d->ntree_awake = (int)m->ntree;
  d->nbody_awake = (int)m->nbody;
  d->nparent_awake = (int)m->nbody - 1;
  d->nv_awake = (int)m->nv;
#else
  (void)m, (void)d, (void)recompute_static;
#endif
  return woken;
}

int mujoco_sys_jacobianElements(const mjData* d) {
#if mjVERSION_HEADER >= 325
  return d->nJ;
#elif mjVERSION_HEADER >= 233
  return d->nnzJ;
#else
  (void)d;
  return 0;
#endif
}

void mujoco_sys_disableUnsafeIslands(mjModel* m) {
#if mjVERSION_HEADER >= 336 && mjVERSION_HEADER < 3006000
  if (m->nflex) m->opt.disableflags |= mjDSBL_ISLAND;
#elif mjVERSION_HEADER >= 334 && mjVERSION_HEADER < 336
  if (m->nflex) m->opt.enableflags &= ~mjENBL_ISLAND;
#else
  (void)m;
#endif
}

size_t mujoco_sys_arenaBytes(const mjData* d) {
#if mjVERSION_HEADER >= 300
  return d->narena;
#else
  return (size_t)d->nstack * sizeof(mjtNum);
#endif
}

int mujoco_sys_setKeyframe(mjModel* m, const mjData* d, int key) {
#if mjVERSION_HEADER >= 320
  mj_setKeyframe(m, d, key);
  return 0;
#else
  (void)m;
  (void)d;
  (void)key;
  return -1;
#endif
}
