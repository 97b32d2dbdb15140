"""Records ticks of mink for tests/ik/mink.rs.

    pip install mink==1.3.0 daqp==0.11.0 mujoco==4.0.0
    python tests/oracle/ik.py
"""

import json
from importlib.metadata import version
from pathlib import Path

import mink
import mujoco
import numpy as np

HERE = Path(__file__).parent
DT = 0.01


def load():
    model = mujoco.MjModel.from_xml_path(str(HERE / "../../models/humanoid.xml"))
    configuration = mink.Configuration(model)
    configuration.update_from_keyframe("stand")
    return model, configuration


def limits(model, speed):
    hinges = [model.joint(index).name for index in range(1, model.njnt)]
    return [
        mink.ConfigurationLimit(model, gain=1.0),
        mink.VelocityLimit(model, {name: speed for name in hinges}),
    ]


def tick():
    """One tick of tasks whose errors have the same definition as ours."""
    model, configuration = load()
    com = mink.ComTask(cost=1.0)
    com.set_target(configuration.data.subtree_com[1] + [0.05, 0.03, -0.06])
    posture = mink.PostureTask(model, cost=0.1, gain=0.5)
    target = configuration.q.copy()
    target[7:] = np.clip(target[7:] + 0.3 * np.sin(np.arange(model.nq - 7)), *model.jnt_range[1:].T)
    posture.set_target(target)
    damping = mink.DampingTask(model, cost=0.05)
    tasks = [com, posture, damping]
    exact = {"primal_tol": 1e-12, "dual_tol": 1e-12}
    velocity = mink.solve_ik(configuration, tasks, DT, "daqp", damping=1e-3, limits=limits(model, 1.0), **exact)
    return {"com": com.target_com.tolist(), "posture": target.tolist(), "velocity": velocity.tolist()}


def track():
    """Six tasks with moving hands, for two seconds: the mean errors of both."""
    model, configuration = load()
    data = configuration.data
    tasks = []
    for body in ["foot_left", "foot_right"]:
        tasks.append(mink.FrameTask(body, "body", position_cost=1.0, orientation_cost=0.5))
    for body in ["hand_left", "hand_right"]:
        tasks.append(mink.FrameTask(body, "body", position_cost=1.0, orientation_cost=0.0))
    for task in tasks:
        task.set_target_from_configuration(configuration)
    starts = [data.body(body).xpos.copy() for body in ["hand_left", "hand_right"]]
    com = mink.ComTask(cost=1.0)
    com.set_target(data.subtree_com[1].copy())
    posture = mink.PostureTask(model, cost=0.01)
    posture.set_target(configuration.q.copy())
    errors = []
    for step in range(200):
        phase = 2 * np.pi * (step + 1) * DT
        moved = [0.15 * np.sin(phase), 0.1 * (1 - np.cos(phase)), 0.15 * (1 - np.cos(phase))]
        for task, start, side in zip(tasks[2:], starts, [1, -1]):
            target = start + np.array(moved) * [1, side, 1]
            task.set_target(mink.SE3.from_rotation_and_translation(mink.SO3.identity(), target))
        velocity = mink.solve_ik(configuration, [*tasks, com, posture], DT, "daqp", limits=limits(model, 4.0))
        configuration.integrate_inplace(velocity, DT)
        feet = [np.linalg.norm(task.compute_error(configuration)) for task in tasks[:2]]
        hands = [
            np.linalg.norm(data.body(task.frame_name).xpos - task.transform_target_to_world.translation())
            for task in tasks[2:]
        ]
        errors.append([*feet, *hands, np.linalg.norm(com.compute_error(configuration))])
    return {"errors": np.mean(errors, axis=0).tolist(), "last": configuration.q.tolist()}


record = {"mink": version("mink"), "tick": tick(), "track": track()}
(HERE / "ik.json").write_text(json.dumps(record, indent=1) + "\n")
