//! Coming from the `mujoco` package for Python: a table of calls, idioms, and differences.
//!
//! The names are the engine's, without `mj_` and in snake case. Fields are methods: `data.qpos` is
//! [`data.qpos()`](Data::qpos), and [`data.qpos_mut()`](Data::qpos_mut) for writing. The search of
//! this documentation finds functions by their C names. The tables use `m` for a [`Model`], `d` for
//! a [`Data`], and `edit` for a [`ModelMut`].
//!
//! # Models
//!
//! | Python | here |
//! |---|---|
//! | `mujoco.MjModel.from_xml_path(path)` | [`Model::from_xml_path(path)?`](Model::from_xml_path) |
//! | `mujoco.MjModel.from_xml_string(xml)` | [`Model::from_xml_str(xml)?`](Model::from_xml_str) |
//! | `from_xml_string(xml, assets)` | [`Model::from_xml_str_with(xml, &LoadOptions::default().with_file(name, bytes))?`](Model::from_xml_str_with) |
//! | `mujoco.MjModel.from_binary_path(path)` | [`Model::from_binary_path(path)?`](Model::from_binary_path) |
//! | `mujoco.mj_saveModel(m, path)` | [`m.save_binary(path)?`](Model::save_binary) |
//! | `mujoco.mj_saveLastXML(path, m)` | [`m.save_xml(path)?`](Model::save_xml), which saves `m` or fails, never another model |
//! | `copy.copy(m)` | `m.clone()`, or [`m.try_clone()?`](Model::try_clone) |
//! | `m.nq`, `m.nu`, `m.body_mass` | [`m.nq()`](Model::nq), [`m.nu()`](Model::nu), [`m.body_mass()`](Model::body_mass) |
//! | `m.opt.timestep` | [`m.timestep()`](Model::timestep), [`m.options()`](Model::options) |
//! | `m.opt.timestep = 0.001` | [`m.edit().set_timestep(0.001)?`](ModelMut::set_timestep) |
//! | `m.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4` | [`m.edit().edit_options(\|o\| o.integrator = Integrator::Rk4)?`](ModelMut::edit_options) |
//! | `m.opt.gravity[:] = 0` | [`m.edit().edit_options(\|o\| o.gravity = [0.0; 3])?`](ModelMut::edit_options) |
//! | `m.opt.disableflags \|= mujoco.mjtDisableBit.mjDSBL_CONTACT` | [`m.edit().edit_options(\|o\| o.disable \|= DisableFlags::CONTACT)?`](crate::model::DisableFlags) |
//! | `m.opt.enableflags \|= mujoco.mjtEnableBit.mjENBL_ENERGY` | [`m.edit().edit_options(\|o\| o.enable \|= EnableFlags::ENERGY)?`](crate::model::EnableFlags) |
//! | `m.vis.global_.offwidth = 1280` | [`m.edit().edit_visual(\|v\| v.global.offwidth = 1280)?`](ModelMut::edit_visual) |
//! | `mujoco.mj_setConst(m, d)` | [`edit.update_constants()?`](ModelMut::update_constants) |
//! | `mujoco.mj_versionString()` | [`engine_version()`](crate::engine_version) |
//!
//! # Simulation and state
//!
//! | Python | here |
//! |---|---|
//! | `mujoco.MjData(m)` | [`Data::new(m)?`](Data::new), with a [`Model`], an `Arc<Model>` or an `&Arc<Model>` |
//! | `copy.copy(d)` | `d.clone()`; [`target.copy_from(&d)?`](Data::copy_from) into an existing simulation |
//! | `mujoco.mj_step(m, d)` | [`d.step()?`](Data::step) |
//! | `mujoco.mj_step(m, d, nstep=10)` | [`d.step_n(10)?`](Data::step_n) |
//! | `mujoco.mj_step1(m, d)`, `mujoco.mj_step2(m, d)` | [`d.step1()?`](Data::step1), [`d.step2()?`](Data::step2) |
//! | `mujoco.mj_forward(m, d)` | [`d.forward()?`](Data::forward) |
//! | `mujoco.mj_inverse(m, d)`, `d.qfrc_inverse` | [`d.inverse()?`](Data::inverse), [`d.qfrc_inverse()`](Data::qfrc_inverse) |
//! | `mujoco.mj_resetData(m, d)` | [`d.reset()?`](Data::reset) |
//! | `mujoco.mj_resetDataKeyframe(m, d, 0)` | [`d.reset_to_key(0)?`](Data::reset_to_key), or `d.reset_to_key("home")?` |
//! | `mujoco.mj_setKeyframe(m, d, 0)` | [`d.set_keyframe(0)?`](Data::set_keyframe) |
//! | `m.key('home').qpos` | [`m.keyframe("home")?.qpos()`](Model::keyframe) |
//! | `d.time`, `d.time = 0` | [`d.time()`](Data::time), [`d.set_time(0.0)`](Data::set_time) |
//! | `d.qpos[:] = q` | [`d.qpos_mut().copy_from_slice(&q)`](Data::qpos_mut) |
//! | `d.ctrl[2] = 0.5` | [`d.ctrl_mut()[2] = 0.5`](Data::ctrl_mut) |
//! | `d.xfrc_applied[b, :3] = f` | [`d.xfrc_applied_mut()[b][..3].copy_from_slice(&f)`](Data::xfrc_applied_mut) |
//! | `d.mocap_pos[m.body('target').mocapid] = p` | [`*d.body_mut("target")?.mocap_pos_mut().unwrap() = p`](crate::element::BodyDataMut) |
//! | `mujoco.mj_getState(m, d, s, spec)` | [`d.state(spec)`](Data::state), [`d.state_into(spec, &mut s)?`](Data::state_into) |
//! | `mujoco.mj_setState(m, d, s, spec)` | [`d.set_state(spec, &s)?`](Data::set_state) |
//! | `mujoco.mj_stateSize(m, spec)` | [`m.state_size(spec)`](Model::state_size) |
//! | `d.energy` | [`d.energy()`](Data::energy), with [`EnableFlags::ENERGY`](crate::model::EnableFlags::ENERGY) |
//! | `d.warning[k].number` | [`d.warning(kind).number`](Data::warning) |
//! | `d.timer[k].duration` | [`d.timer(part).duration`](Data::timer), after [`enable_timers()`](crate::data::enable_timers) |
//!
//! # Names and elements
//!
//! | Python | here |
//! |---|---|
//! | `m.geom('floor').id` | [`m.geom("floor")?.id()`](Model::geom); [`index()`](crate::element::View::index) is the number |
//! | `m.geom(3).name` | [`m.geom(3)?.name()`](crate::element::View::name), an `Option` |
//! | `mujoco.mj_name2id(m, mjtObj.mjOBJ_BODY, 'torso')`, −1 if unknown | [`m.body("torso")?.index()`](Model::body), an error that lists the names |
//! | `mujoco.mj_id2name(m, mjtObj.mjOBJ_BODY, 1)` | [`m.body(1)?.name()`](Model::body) |
//! | `[m.joint(i).name for i in range(m.njnt)]` | [`m.joints().filter_map(\|joint\| joint.name())`](Model::joints) |
//! | `d.joint('knee').qpos`, `d.joint('knee').qvel` | [`d.joint("knee")?.qpos()`](Data::joint), `d.joint("knee")?.qvel()`: slices |
//! | `d.joint('knee').qpos = 0.1` | [`d.joint_mut("knee")?.qpos_mut()[0] = 0.1`](Data::joint_mut) |
//! | `m.joint('knee').qposadr`, `m.joint('knee').dofadr` | `m.joint("knee")?.qpos_range()`, `m.joint("knee")?.dofs()`: ranges |
//! | `d.body('torso').xpos`, `d.site('tip').xmat` | [`d.body("torso")?.xpos()`](Data::body), [`d.site("tip")?.xmat()`](Data::site): `[f64; 9]`, row-major |
//! | `d.actuator('motor').ctrl = 0.5` | [`d.actuator_mut("motor")?.set_ctrl(0.5)`](Data::actuator_mut) |
//! | `m.actuator('motor').ctrlrange` | [`m.actuator("motor")?.ctrlrange()`](Model::actuator) |
//! | `d.sensor('gyro').data` | [`d.sensor("gyro")?.data()?`](Data::sensor) |
//! | `d.sensordata` | [`d.sensordata()`](Data::sensordata), with [`m.sensor("gyro")?.data_range()`](Model::sensor) |
//! | `print(d.joint('knee'))` | `println!("{}", d.joint("knee")?)` |
//!
//! # Models in code
//!
//! A [`Spec`](crate::spec::Spec) works with every engine, also with those before 3.2, which have no
//! `mjSpec`. Its attributes have the names and units of MJCF.
//!
//! | Python | here |
//! |---|---|
//! | `spec = mujoco.MjSpec()` | [`Spec::new("name")`](crate::spec::Spec::new) |
//! | `mujoco.MjSpec.from_file(path)`, `from_string(xml)` | [`Spec::from_xml_path(path)?`](crate::spec::Spec::from_xml_path), [`Spec::from_xml_str(xml)?`](crate::spec::Spec::from_xml_str) |
//! | `body = spec.worldbody.add_body(name='arm', pos=p)` | [`let body = spec.add_body(spec.world()).set_name("arm").set_pos(p).id();`](crate::spec::Spec::add_body) |
//! | `body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0, 0])` | [`spec.add_geom(body).set_type(GeomType::Sphere).set_size(&[0.1]);`](crate::spec::Spec::add_geom) |
//! | `spec.add_actuator(target='elbow', trntype=…)` | [`spec.add_actuator(ActuatorElement::Motor).set_joint("elbow");`](crate::spec::Spec::add_actuator) |
//! | `spec.option.timestep = 0.001` | [`spec.section_mut("option")?.set("timestep", 0.001)?;`](crate::spec::Spec::section_mut) |
//! | `spec.default.geom.rgba = …` | [`spec.default_mut("main", "geom")?.set("rgba", …)?;`](crate::spec::Spec::default_mut) |
//! | `spec.body('arm').pos`, `spec.geoms` | [`spec.body("arm")?.numbers("pos")?`](crate::spec::Element::numbers), [`spec.ids::<Geom>()`](crate::spec::Spec::ids) |
//! | `spec.attach(child, prefix='left_', site=site)` | [`spec.attach(&child, Mount::site(site), "left_")?`](crate::spec::Spec::attach) |
//! | `spec.delete(body)` | [`spec.remove_with_references(body)?`](crate::spec::Spec::remove_with_references) |
//! | `spec.compile()`, `spec.to_xml()` | [`spec.compile()?`](crate::spec::Spec::compile), [`spec.to_xml()`](crate::spec::Spec::to_xml) |
//! | `spec.to_file(path)`, `spec.to_zip(path)` | [`spec.save_xml(path)?`](crate::spec::Spec::save_xml), [`spec.save_xml_with_assets(path)?`](crate::spec::Spec::save_xml_with_assets), a folder; `spec.save_archive(path)?`, feature `mjz` |
//!
//! # Contacts, rays and dynamics
//!
//! | Python | here |
//! |---|---|
//! | `d.ncon`, `d.contact[i]`, `d.contact[i].geom1` | [`d.ncon()`](Data::ncon), [`d.contacts()`](Data::contacts), [`contact.geoms()`](crate::data::Contact::geoms) |
//! | `d.contact[i].flex`, `d.contact[i].vert` | [`contact.sides()`](crate::data::Contact::sides) |
//! | `d.contact[i].pos`, `d.contact[i].dist` | [`contact.pos()`](crate::data::Contact::pos), [`contact.dist()`](crate::data::Contact::dist) |
//! | `mujoco.mj_contactForce(m, d, i, f)`, `f[0]` | [`contact.force()?.force[0]`](crate::data::Contact::force), the normal force; [`contact.force_in_world()?`](crate::data::Contact::force_in_world) |
//! | `d.contact[i].geom`, whose order depends on the types of the geoms | [`contact.force_on(geom)?`](crate::data::Contact::force_on), independent of the order |
//! | `mujoco.mj_setTotalmass(m, mass)` | [`d.edit_model(\|m\| m.set_total_mass(mass))?`](crate::ModelMut::set_total_mass) |
//! | `any(w.number for w in d.warning)` | [`d.warnings()`](Data::warnings)`.next().is_some()` |
//! | `mujoco.mj_applyFT(m, d, …)` | [`d.apply_ft(…)?`](Data::apply_ft) |
//! | `mujoco.mj_ray(m, d, …)` | [`d.ray(origin, direction, &RayOptions::default())?`](Data::ray) |
//! | `mujoco.mj_multiRay(m, d, …)` | [`d.multi_ray_into(origin, &directions, &options, cutoff, &mut hits)?`](Data::multi_ray_into) |
//! | `mujoco.mj_jacBodyCom(m, d, jp, jr, b)` | [`d.jac_body_com("torso")?`](Data::jac_body_com): `linear` and `angular`; [`jac_body_com_into`](Data::jac_body_com_into) |
//! | `mujoco.mj_kinematics(m, d)`, `mujoco.mj_comPos(m, d)` before a Jacobian | [`d.kinematics()?`](Data::kinematics), [`d.com_pos()?`](Data::com_pos); or [`d.fwd_position()?`](Data::fwd_position) |
//! | `J = np.vstack([jp, jr])` | [`d.jac_site("tip")?.stacked()`](crate::data::Jacobian::stacked) |
//! | `mujoco.mj_jacSite`, `mujoco.mj_jac`, `mujoco.mj_jacSubtreeCom` | [`jac_site`](Data::jac_site), [`jac`](Data::jac), [`jac_subtree_com`](Data::jac_subtree_com) |
//! | `mujoco.mj_jacDot(m, d, jp, jr, p, b)` | [`d.jac_dot(p, "torso")?`](Data::jac_dot) |
//! | `mujoco.mj_copyState`, `mujoco.mj_extractState` | [`d.copy_state(&other, spec)?`](Data::copy_state), [`m.extract_state(&state, spec, part)?`](Model::extract_state) |
//! | `mujoco.mj_readCtrl`, `mujoco.mj_readSensor` | [`read_ctrl_into`](Data::read_ctrl_into), [`read_sensor_into`](Data::read_sensor_into) |
//! | `mujoco.mj_fullM(m, M, d.qM)` | [`d.full_m()?`](Data::full_m) |
//! | `mujoco.mj_mulM`, `mujoco.mj_solveM` | [`mul_m_into`](Data::mul_m_into), [`solve_m_into`](Data::solve_m_into) |
//! | `mujoco.mj_differentiatePos(m, dq, 1, q1, q2)` | [`m.differentiate_pos_into(1.0, &q1, &q2, &mut dq)?`](Model::differentiate_pos_into) |
//! | `mujoco.mj_integratePos(m, q, v, dt)` | [`m.integrate_pos(&mut q, &v, dt)?`](Model::integrate_pos); [`d.integrate_pos(&v, dt)?`](Data::integrate_pos) for the present position |
//! | `mujoco.mj_objectVelocity(m, d, mjtObj.mjOBJ_BODY, b, v, 1)` | [`d.object_velocity(FrameId::Body(id), Axes::Local)?`](Data::object_velocity) |
//! | `mujoco.mj_rnePostConstraint(m, d)`, `d.cfrc_ext` | [`d.rne_post_constraint()?`](Data::rne_post_constraint), [`d.body("torso")?.cfrc_ext()?`](Data::body) |
//! | `mujoco.mjd_transitionFD(m, d, eps, True, A, B, C, D)` | [`d.transition_fd(eps, Differences::Central)?`](Data::transition_fd), or a [`Lineariser`](crate::Lineariser) |
//! | `mujoco.mju_mulQuat(r, a, b)` | [`math::mul_quat(&a, &b)`](crate::math::mul_quat), with results instead of output arguments |
//! | `scipy.linalg.solve_discrete_are(A, B, Q, R)` | [`Lqr::solve(…)?`](crate::Lqr::solve): `p` and the gain `k`; [`Riccati`](crate::control::riccati) |
//! | `mujoco.mju_mat2Quat`, `mujoco.mju_negQuat`, `mujoco.mju_quat2Vel` | [`math::mat2quat`](crate::math::mat2quat), [`math::neg_quat`](crate::math::neg_quat), [`math::quat2vel`](crate::math::quat2vel) |
//! | `mujoco.mju_rotVecQuat`, `mujoco.mju_quat2Mat`, `mujoco.mju_axisAngle2Quat` | [`math::rot_vec_quat`](crate::math::rot_vec_quat), [`math::quat2mat`](crate::math::quat2mat), [`math::axis_angle2quat`](crate::math::axis_angle2quat) |
//!
//! # Edits, callbacks and many simulations
//!
//! | Python | here |
//! |---|---|
//! | `m.body('torso').mass *= s`, and its inertia, before a simulation exists | [`m.edit().body_mut("torso")?.scale_mass(s)?`](ModelMut::body_mut), then [`update_constants`](ModelMut::update_constants) |
//! | `m.geom('floor').friction[0] = f`, `m.dof_damping[3:] *= s` | `m.edit().geom_mut("floor")?.friction_mut()[0] = f`, [`m.edit().dof_damping_mut()[3..]`](ModelMut::dof_damping_mut) |
//! | `m.body_mass[b] *= 2` on a running simulation | [`d.edit_model(…)?`](Data::edit_model), see [below](#editing-a-parameter-of-a-running-simulation) |
//! | `d.eq_active[i] = 0` (`m.eq_active` in 2.2.2) | [`d.set_equality_active("grasp", false)?`](Data::set_equality_active) |
//! | `m.eq_data[i, 3:10] = …` for the present pose, `d.eq_active[i] = 1` | [`d.weld_at_present_pose("grasp")?`](Data::weld_at_present_pose) |
//! | `mujoco.set_mjcb_control(f)`, … | [`d.set_callbacks(Callbacks::new().with_control(f))`](Data::set_callbacks): one simulation, see the [example with a struct](Data::set_callbacks); often unnecessary: set the controls before `d.step()?`; [`d.with_callbacks(callbacks, \|d\| …)`](Data::with_callbacks): one scope |
//! | `mujoco.set_mjcb_control(None)` | `d.set_callbacks(Callbacks::new())` |
//! | `rollout.rollout(m, d, initial_state, control)` | [`Rollout::new(m, nroll, nstep)`](crate::rollout::Rollout)`.with_initial_states(…).with_controls(…).run()?` |
//! | `gymnasium.vector` environments | [`VectorEnvironment`](crate::environment::VectorEnvironment), or [`Batch`](crate::rollout::Batch) |
//! | `ThreadPoolExecutor` with one `MjData` per thread | `(0..n).into_par_iter().map(episode).collect::<Result<Vec<_>, _>>()?` of [`rayon`], or [`std::thread::scope`], with one [`Data`] per task |
//! | `np.savez(path, qpos=…)` | `npz::save(path, &[Array::new("qpos", &[n, nq], &qpos)])?`, feature `npz` |
//! | the same for results | [`trajectory.save_npz(path)?`](crate::Trajectory), [`rollouts.save_npz(path)?`](crate::rollout::RolloutResult); [`save_csv`](crate::Trajectory::save_csv) |
//!
//! # Images and the viewer
//!
//! | Python | here |
//! |---|---|
//! | `mujoco.Renderer(m, height, width)` | [`Renderer::new(&m, width, height)?`][renderer], feature `renderer` |
//! | `renderer.update_scene(d, camera='eye')` | [`renderer.snapshot(&mut d, "eye")?`][snapshot] |
//! | `mujoco.mjv_updateScene(…)` | [`scene.update(&mut d, &options, None, &mut camera, Categories::all())?`](crate::Scene::update) |
//! | `camera='eye'` | [`Camera::fixed(&m, "eye")?`](crate::scene::Camera::fixed) |
//! | `mujoco.MjvCamera()`, `mujoco.MjvOption()` | [`Camera::free(&m)`](crate::scene::Camera), [`SceneOptions::default()`](crate::scene::SceneOptions) |
//! | `renderer.render()` | [`snapshot.rgb()?`][rgb] |
//! | `renderer.enable_depth_rendering()` | [`snapshot.depth()?`][depth], in metres |
//! | `renderer.enable_segmentation_rendering()` | [`snapshot.segmentation()?`][segmentation]; [`geom_ids()`][geom_ids] for the first channel |
//! | `mujoco.mjr_render(…)`, `mujoco.mjr_readPixels(rgb, depth, …)` | `snapshot.rgb()?`, `snapshot.depth()?`: the first row is the top, depth in metres without conversion |
//! | `mjRND_SEGMENT` and `mjRND_IDCOLOR` | `snapshot.segmentation()?.pixel(x, y)`; its `object` is `Some(Object::Geom(id))` for a geom |
//! | depth to points | `depth.points(&snapshot.pinhole_camera()?)`, see [points from a depth image](super::pictures#points-from-a-depth-image) |
//! | `mujoco.mjv_initGeom(scn.geoms[scn.ngeom], …)` | [`scene.add_geom(&NewGeom::sphere(0.1).with_pos(p))?`](crate::Scene::add_geom) |
//! | `mujoco.viewer.launch(m, d)` | [`Viewer::new().run(d)?`][viewer], feature `viewer` |
//! | `mujoco.viewer.launch_passive(m, d)` | [`viewer::launch(options)?`][launch], or [`viewer::run`][run] on macOS |
//! | `v.sync()`, `v.is_running()`, `v.user_scn` | [`handle.sync(&mut d)?`][handle], `handle.is_running()`, `handle.geoms_mut()` |
//! | `mediapy.write_video(path, frames)` | [`Recorder`][recorder]: GIF, APNG, PNG files, or MP4 by ffmpeg |
//!
//! # A loop with a controller and observations
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let (hinge, motor) = (data.model().joint("hinge")?.id(), data.model().actuator("slide")?.id());
//! data.joint_mut(hinge).qpos_mut()[0] = 0.1;
//! let mut observations = Vec::new();
//! while data.time() < 1.0 {
//!     let pole = data.joint(hinge);
//!     let (angle, rate) = (pole.qpos()[0], pole.qvel()[0]);
//!     data.actuator_mut(motor).set_ctrl((3.0 * angle + 0.5 * rate).clamp(-1.0, 1.0));
//!     data.step()?;
//!     observations.push([data.time(), angle, rate]);
//! }
//! assert!(observations.last().unwrap()[1].abs() < 0.02);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Rollouts on all cores
//!
//! Arrays are flat and row-major, like NumPy's: controls have the shape `(nroll, nstep, nu)`, and
//! states `(nroll, nstep + 1, nstate)`. Row 0 is the initial state.
//!
//! ```
//! use mujoco_safe::rollout::Rollout;
//! use mujoco_safe::{StateSpec, sample};
//!
//! let (nroll, nstep) = (16, 50);
//! let initial: Vec<f64> = (0..nroll).flat_map(|roll| [0.0, 0.01 * roll as f64, 0.0, 0.0]).collect();
//! let controls = vec![0.1; nroll * nstep]; // nu = 1
//! let result = Rollout::new(sample::cartpole(), nroll, nstep)
//!     .with_initial_states(StateSpec::PHYSICS, &initial)
//!     .with_controls(&controls)
//!     .run()?;
//! assert!(result.outcomes().iter().all(Result::is_ok));
//! assert_eq!(result.states_of(15).shape(), (51, 4));
//! assert_eq!(result.sensordata_of(15).ncols(), 7);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # An image from a camera of the model
//!
//! The width comes before the height. One snapshot gives colours, depth and segmentation of the
//! same moment.
//!
#![cfg_attr(feature = "renderer", doc = "```no_run")]
#![cfg_attr(not(feature = "renderer"), doc = "```ignore")]
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! data.forward()?;
//! let mut renderer = Renderer::new(data.model(), 640, 480)?;
//! renderer.snapshot(&mut data, "fixed")?.rgb()?.save_png("cartpole.png")?;
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! # Editing a parameter of a running simulation
//!
//! The edit applies to this simulation only. A shared model is copied once; later edits of the same
//! simulation copy nothing.
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! data.step_n(10)?;
//! data.edit_model(|edit| {
//!     edit.body_mut("pole")?.scale_mass(2.0)?; // mass and inertia
//!     edit.update_constants()                  // quantities that the compiler derived from them
//! })?;
//! data.step()?; // continues with the heavier pole
//! assert_eq!(data.model().body("pole")?.mass(), 1.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Differences
//!
//! - **A simulation holds its model.** Python does not check that `m` and `d` in `mj_step(m, d)`
//!   belong together; other sizes cause accesses out of bounds. Here the model is part of the
//!   [`Data`].
//! - **Reading and writing are separate,** so that no value changes while a program uses it. A view
//!   in Python changes with the next step. Here a slice of [`Data::qpos`] is a borrow, and the
//!   compiler rejects a step while it is in use. Copy values with `to_vec()`.
//! - **A model is constant while it is shared,** so that threads read it without locks. Python
//!   changes a model under all of its simulations. [`Model::edit`] needs the only reference;
//!   [`Data::edit_model`] gives the simulation its own copy.
//! - **A diverged simulation is an error,** because a reset would hide the failure. The engine
//!   resets it and prints a warning. Here [`Data::step`] returns
//!   [`Error::Unstable`](crate::Error::Unstable) with the quantity, the joint and the time.
//! - **Missing results are errors,** because zeros are plausible measurements. In Python
//!   `d.sensor('gyro').data` contains zeros before the first computation. Here it returns
//!   [`Error::NotComputed`](crate::Error::NotComputed). See [results that have not been
//!   computed](super::concepts#results-that-have-not-been-computed).
//! - **As in Python, the id of a joint is not its position in `qpos`.** `d.qpos[j]` with the id of
//!   a joint is correct only without free and ball joints. Use `d.joint(id).qpos()`, or the ranges
//!   `qpos_range()` and `dofs()` of the joint.
//! - **Callbacks belong to a simulation**, not to the process, and a panic in a callback is an
//!   error of the call.
//! - **Nothing is printed,** except the viewer's help (F1). Warnings go to the
//!   [`log`](https://docs.rs/log) crate and to counters; no `MUJOCO_LOG.TXT` is written.
//! - **The default engine is 2.2.2,** which has no plugins, flexes and implicit-fast integrator;
//!   [newer engines](super::engines) have them. `MjSpec` and the GPU backends have no counterpart.
//!   Some functions of newer engines exist with every engine: `mj_getState`, `mj_multiRay`,
//!   `mj_geomDistance`, `mjd_inverseFD`.
//!
#![cfg_attr(feature = "viewer", doc = include_str!("links/with_viewer.md"))]
#![cfg_attr(not(feature = "viewer"), doc = include_str!("links/without_viewer.md"))]

#[cfg(doc)]
use crate::{Data, Model, ModelMut, StateSpec};
