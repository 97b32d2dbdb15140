// Functions whose parameters, and values whose place in the engine's structs, differ between
// versions. They raise no error.
#ifndef MUJOCO_SYS_ADAPTED_H_
#define MUJOCO_SYS_ADAPTED_H_

#include <stddef.h>

#include <mujoco/mujoco.h>

// Row of a matrix: `count` values at `values`, in the columns `columns`, or in all columns if that
// is NULL.
struct mujoco_sys_row {
  const mjtNum* values;
  const int* columns;
  int count;
};

void mujoco_sys_fullM(const mjModel* m, const mjData* d, mjtNum* dst);
mjtNum mujoco_sys_rayMesh(const mjModel* m, const mjData* d, int geomid, const mjtNum pnt[3], const mjtNum vec[3]);
mjtNum mujoco_sys_rayHfield(const mjModel* m, const mjData* d, int geomid, const mjtNum pnt[3], const mjtNum vec[3]);
mjtNum mujoco_sys_rayGeom(const mjtNum pos[3], const mjtNum mat[9], const mjtNum size[3], const mjtNum pnt[3],
                          const mjtNum vec[3], int geomtype);
void mujoco_sys_rotVecMat(mjtNum res[3], const mjtNum vec[3], const mjtNum mat[9]);
void mujoco_sys_rotVecMatT(mjtNum res[3], const mjtNum vec[3], const mjtNum mat[9]);

// Rows of the actuators' moments and of the tendons' Jacobian.
void mujoco_sys_momentRow(const mjModel* m, const mjData* d, int actuator, struct mujoco_sys_row* row);
void mujoco_sys_tendonRow(const mjModel* m, const mjData* d, int tendon, struct mujoco_sys_row* row);

// Computes actuator_velocity from the moments. The model has one control and one force for each
// actuator.
void mujoco_sys_actuatorVelocity(const mjModel* m, mjData* d);

// Row of the factor L of the inertia matrix without its diagonal of ones. The count is -1 for
// engines before 3.3.3 except 3.3.0, which store L with `dof_Madr` and `dof_parentid`.
void mujoco_sys_inertiaRow(const mjModel* m, const mjData* d, int dof, struct mujoco_sys_row* row);
void mujoco_sys_factorRow(const mjModel* m, const mjData* d, int dof, struct mujoco_sys_row* row);

// Stored elements of the inertia matrix, and their number.
const mjtNum* mujoco_sys_inertia(const mjData* d);
int mujoco_sys_inertiaLength(const mjModel* m);

// Flags of the equality constraints that are enforced, or enforced initially; neq.
mjtByte* mujoco_sys_equalityActive(const mjModel* m);
int mujoco_sys_equalityEnforced(const mjModel* m, const mjData* d, int equality);

// True if an equality constraint couples sites instead of bodies.
int mujoco_sys_equalityCouplesSites(const mjModel* m, int equality);

// Address of an actuator's activation, or -1.
int mujoco_sys_activation(const mjModel* m, int actuator);

// Normals and texture coordinates of a mesh, as ranges of mesh_normal and mesh_texcoord, and the
// triples of their indices for each face, relative to these ranges. `facetexcoord` is NULL without
// texture coordinates. Before 2.3.3 all are those of the vertices.
struct mujoco_sys_mesh {
  int normaladr;
  int normalnum;
  int texcoordadr;
  int texcoordnum;
  const int* facenormal;
  const int* facetexcoord;
};
void mujoco_sys_meshFaces(const mjModel* m, int mesh, struct mujoco_sys_mesh* result);

// Pixels of all textures; ntexdata.
mjtByte* mujoco_sys_textureBytes(const mjModel* m);
int mujoco_sys_textureChannels(const mjModel* m, int texture);

// Texture for the colour of a material, or -1.
int mujoco_sys_materialTexture(const mjModel* m, int material);

int mujoco_sys_lightDirectional(const mjModel* m, int light);
void mujoco_sys_setLightDirectional(mjModel* m, int light, int directional);

// Rest length of a tendon: one number, or since 2.3 the two ends of a range.
mjtNum* mujoco_sys_tendonRestLength(const mjModel* m, int tendon, int* count);

// Number of the solver's recorded iterations for an island, and their statistics. Without islands,
// all constraints are those of the first one.
int mujoco_sys_solverIterations(const mjData* d, int island, const mjSolverStat** statistics);

// Texture of a geom of a scene. Since 3.2 only the material is known (`material` >= 0), whose
// texture is that of the model.
struct mujoco_sys_texture {
  int material;
  int texture;
  float repeat[2];
  int uniform;
};
struct mujoco_sys_texture mujoco_sys_sceneGeomTexture(const mjvGeom* geom);

// Sets the texture. Returns 0 if a geom without a material cannot have a texture.
int mujoco_sys_setSceneGeomTexture(mjvGeom* geom, const struct mujoco_sys_texture* texture);

// Kind of a light: 0 for a spot light, 1 for a directional light, 2 for one that the engine's
// OpenGL renderer does not draw (since 3.3.3).
int mujoco_sys_sceneLightKind(const mjvLight* light);

// True if the geom casts shadows; false for decoration since 3.0.1, and for geoms without
// `castshadow` since 4.0.
int mujoco_sys_sceneGeomCastsShadow(const mjvGeom* geom);

// Sets a keyframe to the state of the data, and returns 0. Before 3.2 there is no function for
// this: returns -1.
int mujoco_sys_setKeyframe(mjModel* m, const mjData* d, int key);

// Texture that the engine's OpenGL renderer draws on a material, or -1: the first one, since 3.2.1
// that of the base colour only.
int mujoco_sys_drawnTexture(const mjModel* m, int material);

// True if the pixels of a texture are in the sRGB colour space and the engine converts them (since
// 3.3.3).
int mujoco_sys_textureIsSrgb(const mjModel* m, int texture);

// Projection of a camera of a scene: half the width of the near plane, or 0 if it follows from the
// aspect ratio (since 3.0); and true for an orthographic projection (since 3.2).
struct mujoco_sys_projection {
  float half_width;
  int orthographic;
};
// Sets the projection of an abstract camera to that of the free camera of a model (since 3.2).
void mujoco_sys_setFreeProjection(mjvCamera* camera, const mjModel* m);

struct mujoco_sys_projection mujoco_sys_sceneProjection(const mjvGLCamera* camera);

// Sets the projection. Returns 0 if the engine has no such projection.
int mujoco_sys_setSceneProjection(mjvGLCamera* camera, const struct mujoco_sys_projection* projection);

// True if the scene had too few places for the geoms of the last update or addition, for engines
// that record it in the scene (since 3.3.7). These engines warn of it (`mjWARN_VGEOMFULL`) in the
// update only, and since 3.7 not at all.
int mujoco_sys_sceneIsFull(const mjvScene* scn);

// Flexes of a scene, since 3.0: their number, and the parts to draw.
struct mujoco_sys_flex {
  const float* vert;
  int vertnum;
  const int* edge;
  int edgenum;
  const float* face;
  const float* normal;
  const float* texcoord;
  int facenum;
  int shows_vertices;
  int shows_edges;
};
int mujoco_sys_sceneFlexes(const mjvScene* scn);
void mujoco_sys_sceneFlex(const mjvScene* scn, int flex, struct mujoco_sys_flex* result);

// Sets the positions of all flexes to zero and removes their faces. mjv_makeScene leaves them
// uninitialised.
void mujoco_sys_clearSceneFlexes(const mjModel* m, mjvScene* scn);

// Sets the visible groups of flexes, since 3.0.
void mujoco_sys_setFlexGroups(mjvOption* opt, const mjtByte* groups);

// Sets the visible layer of three-dimensional flexes and the visible depth of bounding volumes,
// since 3.0.
void mujoco_sys_setLayers(mjvOption* opt, int flex_layer, int bvh_depth);

// State of the plugins, since 2.3, and plastic deformation of the flexes, since 4.0; and their
// lengths.
mjtNum* mujoco_sys_pluginState(const mjData* d);
size_t mujoco_sys_pluginStateLength(const mjModel* m);
mjtNum* mujoco_sys_plastic(const mjData* d);
size_t mujoco_sys_plasticLength(const mjModel* m);

// True if an instance of a plugin has a function that resets its state. Otherwise the engine leaves
// the state as it finds the memory.
int mujoco_sys_pluginHasReset(const mjModel* m, int instance);

// Geom, or flex with an element or a vertex, on one side of a contact; -1 for none.
struct mujoco_sys_contact_side {
  int geom;
  int flex;
  int elem;
  int vert;
};
struct mujoco_sys_contact_side mujoco_sys_contactSide(const mjContact* contact, int side);

// Sets the fields of a contact between geom1 and geom2 that 2.2.2 does not have.
void mujoco_sys_completeContact(mjContact* contact);

// Options that only some versions have, or whose names differ.
struct mujoco_sys_options {
  mjtNum apirate;
  mjtNum ccd_tolerance;
  mjtNum ls_tolerance;
  mjtNum o_friction[5];
  int ccd_iterations;
  int collision;
  int ls_iterations;
  int sdf_iterations;
  int sdf_initpoints;
  int disableactuator;
};
void mujoco_sys_getOptions(const mjOption* opt, struct mujoco_sys_options* options);
void mujoco_sys_setOptions(mjOption* opt, const struct mujoco_sys_options* options);

// Offset of the selected point's target from that of the centre of mass (3), and inertia at the
// point (1), of newer engines.
void mujoco_sys_getGrip(const mjvPerturb* pert, mjtNum grip[4]);
void mujoco_sys_setGrip(mjvPerturb* pert, const mjtNum grip[4]);

// Buffers of delays (history) and their length (nhistory), since 3.5; before, NULL and 0.
mjtNum* mujoco_sys_history(const mjData* d);
int mujoco_sys_historyLength(const mjModel* m);

// Writes the controls of an actuator, or the reading of a sensor, at a time, from its buffer of
// delays (mj_readCtrl and mj_readSensor, since 3.5). Without a buffer, the present values.
void mujoco_sys_readCtrl(const mjModel* m, const mjData* d, int id, mjtNum time, int interp, mjtNum* result);
void mujoco_sys_readSensor(const mjModel* m, const mjData* d, int id, mjtNum time, int interp, mjtNum* result);

// Sets the controls to their neutral values (mj_resetCtrl, since 3.11), zero before.
void mujoco_sys_resetCtrl(const mjModel* m, mjData* d);

// Name of an input of an actuator (mj_actuatorInputName, since 3.11), or NULL.
const char* mujoco_sys_actuatorInputName(const mjModel* m, int id, int input);

// Returns 1 if a point is inside a site (mj_insideSite, since 3.13), else 0; -1 before 3.13.
int mujoco_sys_insideSite(const mjModel* m, const mjData* d, int site, const mjtNum point[3]);

// Distance at which a ray hits a flex, or -1 (mju_rayFlex since 3.0, mj_rayFlex since 3.5).
mjtNum mujoco_sys_rayFlex(const mjModel* m, const mjData* d, int layer, int vertices, int edges, int faces, int skin,
                          int flex, const mjtNum pnt[3], const mjtNum vec[3], int* vertex);

// Root of the first kinematic tree that sleeps initially (sleep="init", since 3.4), or -1.
int mujoco_sys_initiallyAsleep(const mjModel* m);

// Returns 1 if the kinematic tree of a body sleeps (since 3.4), else 0.
int mujoco_sys_isAsleep(const mjModel* m, const mjData* d, int body);

// Wakes all kinematic trees (since 3.4), and returns the number of those that slept. If
// `recompute_static` is 1, the next call that computes poses also computes those of static bodies.
int mujoco_sys_wake(const mjModel* m, mjData* d, int recompute_static);

// Disables the islands of a model with flexes with 3.3.4 to 3.5. These engines search only the
// first row of each contact for the trees of its island. The other rows of a contact with a flex
// can belong to other trees, for which the engine writes to the island with index -1.
void mujoco_sys_disableUnsafeIslands(mjModel* m);

// Bytes of the stack, or since 2.3 of the arena that contains the stack.
size_t mujoco_sys_arenaBytes(const mjData* d);

// Number of stored elements of the sparse constraint Jacobian (nnzJ, later nJ); 0 before 2.3.3.
int mujoco_sys_jacobianElements(const mjData* d);

#endif
