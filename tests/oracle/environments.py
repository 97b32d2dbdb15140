"""Records steps of Gymnasium's environments for tests/rollout/environments.rs.

These are motions, actions, observations, rewards and ends.

    python3.10 -m venv venv
    venv/bin/pip install mujoco==2.2.2 gymnasium==1.0.0 imageio 'numpy<2'
    venv/bin/python tests/oracle/environments.py

writes tests/oracle/environments.json. The models are those of Gymnasium, of which the file has no
part. Running it again gives the same file.
"""

import json
from pathlib import Path

import gymnasium
import numpy as np

HERE = Path(__file__).resolve().parent
# Number of steps, interval of the recorded steps, factor of the random actions, and initial
# velocity of the last joint.
RUNS = {
    "InvertedPendulum-v5": [(40, 5, 0.1, 0.0), (40, 5, 1.0, 0.0)],
    "Hopper-v5": [(60, 6, 0.3, 0.0), (200, 12, 3.0, 0.0), (1, 1, 1.0, 40.0), (1, 1, 1.0, 400.0)],
    "HalfCheetah-v5": [(60, 6, 1.0, 0.0)],
}


def numbers(array):
    return [float(value) for value in np.asarray(array, dtype=float).ravel()]


def steps(environment, length, every, factor, velocity, seed):
    """Yields every few steps of an episode, and its last."""
    inner = environment.unwrapped
    random = np.random.default_rng(seed)
    environment.reset(seed=seed)
    inner.data.qvel[-1] += velocity
    for step in range(length):
        before = [numbers(inner.data.qpos), numbers(inner.data.qvel)]
        action = factor * random.uniform(-1.0, 1.0, inner.model.nu)
        observation, reward, terminated, _, _ = inner.step(action)
        if step % every == 0 or terminated:
            yield {
                "duration": float(inner.dt),
                "before": before,
                "action": numbers(action),
                "after": [numbers(inner.data.qpos), numbers(inner.data.qvel)],
                "observation": numbers(observation),
                "reward": float(reward),
                "terminated": bool(terminated),
            }
        if terminated:
            return


def main():
    recorded = {}
    for name, runs in RUNS.items():
        environment = gymnasium.make(name)
        recorded[name] = [
            step for seed, run in enumerate(runs) for step in steps(environment, *run, seed)
        ]
    lines = ",\n".join(
        f"{json.dumps(name)}: [\n" + ",\n".join(json.dumps(step) for step in steps) + "\n]" for name, steps in recorded.items()
    )
    (HERE / "environments.json").write_text("{\n" + lines + "\n}\n")


if __name__ == "__main__":
    main()
