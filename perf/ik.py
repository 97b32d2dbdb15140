"""Inverse kinematics by mink, the reference of benches/ik.rs.

    ik.py MODEL.xml SOLVER < lines

Prints `ready`, and for each line of input runs 200 ticks of the tasks of the bench, and prints the
median time of a tick in seconds, which does not contain interruptions by other programs, and the
mean errors of the five tasks with targets.
"""

import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import mink
import mujoco
import numpy as np

DT = 0.01
TICKS = 200

model = mujoco.MjModel.from_xml_path(sys.argv[1])
solver = sys.argv[2]
configuration = mink.Configuration(model)
configuration.update_from_keyframe("stand")
start = configuration.q.copy()
data = configuration.data
feet = [mink.FrameTask(body, "body", position_cost=1.0, orientation_cost=0.5) for body in ["foot_left", "foot_right"]]
hands = [mink.FrameTask(body, "body", position_cost=1.0, orientation_cost=0.0) for body in ["hand_left", "hand_right"]]
for task in feet:
    task.set_target_from_configuration(configuration)
origins = [data.body(task.frame_name).xpos.copy() for task in hands]
com = mink.ComTask(cost=1.0)
com.set_target(data.subtree_com[1].copy())
posture = mink.PostureTask(model, cost=0.01)
posture.set_target(start)
tasks = [*feet, *hands, com, posture]
hinges = [model.joint(index).name for index in range(1, model.njnt)]
limits = [mink.ConfigurationLimit(model, gain=1.0), mink.VelocityLimit(model, {name: 4.0 for name in hinges})]
targets = []
for step in range(TICKS):
    phase = 2 * np.pi * (step + 1) * DT
    moved = np.array([0.15 * np.sin(phase), 0.1 * (1 - np.cos(phase)), 0.15 * (1 - np.cos(phase))])
    places = [origin + moved * [1, side, 1] for origin, side in zip(origins, [1, -1])]
    targets.append([mink.SE3.from_rotation_and_translation(mink.SO3.identity(), place) for place in places])

print("ready", flush=True)
for _ in sys.stdin:
    configuration.update(start)
    seconds = []
    errors = np.zeros(5)
    for target in targets:
        for task, place in zip(hands, target):
            task.set_target(place)
        before = time.perf_counter()
        velocity = mink.solve_ik(configuration, tasks, DT, solver, limits=limits)
        configuration.integrate_inplace(velocity, DT)
        seconds.append(time.perf_counter() - before)
        for index, task in enumerate(feet):
            body = data.body(task.frame_name)
            aim = task.transform_target_to_world
            turn = np.zeros(3)
            mujoco.mju_subQuat(turn, body.xquat, aim.rotation().wxyz)
            errors[index] += np.linalg.norm([*(body.xpos - aim.translation()), *turn])
        for index, task in enumerate(hands):
            errors[2 + index] += np.linalg.norm(
                data.body(task.frame_name).xpos - task.transform_target_to_world.translation()
            )
        errors[4] += np.linalg.norm(data.subtree_com[1] - com.target_com)
    print(np.median(seconds), *(errors / TICKS), flush=True)
