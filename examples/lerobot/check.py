"""Loads a dataset of the example with LeRobot's package, and checks its contents."""

import sys

import numpy as np
import torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset

CAMERA = "observation.images.side"
root, episodes = sys.argv[1], int(sys.argv[2])

dataset = LeRobotDataset("local/squats", root=root)
assert (dataset.num_episodes, dataset.num_frames, dataset.fps) == (episodes, 50 * episodes, 25)
rows = [dataset[index] for index in range(len(dataset))]
for index, row in enumerate(rows):
    assert row["index"] == index and row["episode_index"] == index // 50 and row["frame_index"] == index % 50
    assert abs(row["timestamp"].item() - (index % 50) / 25) < 1e-6 and row["task"] == "Squat."
    assert row[CAMERA].shape == (3, 240, 320)

# The torso moves by its velocities.
states = torch.stack([row["observation.state"] for row in rows]).numpy().astype(float)
actions = torch.stack([row["action"] for row in rows]).numpy().astype(float)
assert states.shape[1] == 28 + 27 and actions.shape[1] == 21
motion, velocity = np.diff(states[:50, :3], axis=0), states[:50, 28:31]
predicted = 0.04 * 0.5 * (velocity[:-1] + velocity[1:])
assert np.corrcoef(motion.ravel(), predicted.ravel())[0, 1] > 0.9
# The quaternion of the free joint has unit length.
assert np.allclose(np.linalg.norm(states[:, 3:7], axis=1), 1, atol=1e-6)

statistics = dataset.meta.stats
for key, values in [("observation.state", states), ("action", actions)]:
    for name, expected in [("min", values.min(0)), ("max", values.max(0)), ("mean", values.mean(0)), ("std", values.std(0))]:
        assert np.allclose(statistics[key][name], expected, rtol=1e-5, atol=1e-6), (key, name)
    assert statistics[key]["count"] == len(rows)
# The compression of the video loses details.
images = torch.stack([row[CAMERA] for row in rows])
for name, expected in [("mean", images.mean((0, 2, 3))), ("std", images.std((0, 2, 3)))]:
    assert np.allclose(statistics[CAMERA][name].ravel(), expected, atol=0.02), (name, expected)
assert (images[0] - images[40]).abs().max() > 0.1, "the humanoid moves"

# As a policy is trained: batches, with the actions of several times.
times = {"action": [0, 0.04, 0.08]}
loader = torch.utils.data.DataLoader(LeRobotDataset("local/squats", root=root, delta_timestamps=times), batch_size=10)
batch = next(iter(loader))
assert batch["action"].shape == (10, 3, 21) and batch[CAMERA].shape == (10, 3, 240, 320)
print(f"LeRobot reads {dataset.num_episodes} episodes of {dataset.num_frames} frames in all")
