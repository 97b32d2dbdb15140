"""Records episodes of Gymnasium's tasks for tests/rollout/gymnasium.

The tasks are Gymnasium's classes, and the models are those of this repository. The engine must be
of the version that the test is linked with, because episodes include contacts:

    python3.10 -m venv venv
    venv/bin/pip install mujoco==2.2.2 gymnasium==1.0.0 imageio 'numpy<2'
    venv/bin/python tests/oracle/gymnasium/record.py

writes tests/oracle/gymnasium/2.2.2.json. Since version 4 the package of the engine is mujoco-core,
without glfw, which Gymnasium imports: install it, too. Running this again gives the same file.
"""

import json
from pathlib import Path

import gymnasium
import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
# The model, and the length, the interval of the recorded observations, the factor of the actions
# and the change of the vertical velocity of each episode.
TASKS = {
    "Reacher-v5": ("tests/models/gymnasium/reacher.xml", [(50, 7, 1.0, 0.0), (9, 3, 0.3, 0.0)]),
    "Ant-v5": ("tests/models/gymnasium/quadruped.xml", [(40, 8, 0.7, 0.0), (40, 8, 1.0, 3.0)]),
    "Humanoid-v5": ("models/humanoid.xml", [(60, 20, 1.0, 0.0), (6, 3, 0.2, 0.0)]),
}


def numbers(array):
    """Returns a flat list of numbers with 12 digits."""
    return [float(f"{value:.12g}") for value in np.asarray(array, dtype=float).ravel()]


def action(nu, step, episode, factor):
    """Returns an action that consists of multiples of 1/20 of the factor."""
    return np.array([factor * ((31 * step + 17 * actuator + 7 * episode) % 41 - 20) / 20 for actuator in range(nu)])


def record(environment, episode, length, every, factor, velocity):
    inner = environment.unwrapped
    environment.reset(seed=episode)
    qpos, qvel = inner.data.qpos.copy(), inner.data.qvel.copy()
    if velocity:
        qvel[2] += velocity
    # As at the end of a reset.
    mujoco.mj_resetData(inner.model, inner.data)
    inner.set_state(qpos, qvel)
    recorded = {
        "qpos": [float(value) for value in qpos],
        "qvel": [float(value) for value in qvel],
        "factor": factor,
        "observation": numbers(inner._get_obs()),
        "steps": [],
    }
    for step in range(length):
        observation, reward, terminated, truncated, _ = environment.step(action(inner.model.nu, step, episode, factor))
        is_last = terminated or truncated or step + 1 == length
        recorded["steps"].append(
            {
                "reward": float(f"{reward:.12g}"),
                "terminated": bool(terminated),
                "truncated": bool(truncated),
                "observation": numbers(observation) if is_last or step % every == 0 else None,
            }
        )
        if is_last:
            return recorded


def main():
    recorded = {}
    for name, (model, episodes) in TASKS.items():
        environment = gymnasium.make(name, xml_file=str(ROOT / model), disable_env_checker=True)
        recorded[name] = [record(environment, episode, *run) for episode, run in enumerate(episodes)]
    path = HERE / f"{mujoco.__version__}.json"
    path.write_text(json.dumps(recorded, separators=(",", ":")).replace('},{', '},\n{') + "\n")
    print(f"{path.name}: {path.stat().st_size // 1024} kB")


if __name__ == "__main__":
    main()
