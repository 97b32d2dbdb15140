"""Estimates of a linear system by conditioning one joint normal distribution, without recursions.

    pip install numpy==2.5.5 && python tests/oracle/estimation.py

The system is two masses on springs between walls, as in tests/estimation/main.rs. Its state, the
noise of its motors and of its forces, and its readings are linear functions of independent normal
variables. `filtered` is the mean and the covariance of the state of each step, given the readings up
to that step; `smoothed` is given all of them. The readings are arbitrary numbers.
"""

import json
from pathlib import Path

import numpy as np

H, STEPS = 0.02, 8
MASS = np.array([[2.0, 0.5], [0.5, 0.5]])
STIFFNESS, DAMPING, GEAR = np.diag([3.0, -2.0]), np.diag([0.2, 0.1]), np.diag([1.0, 2.0])
inverse = np.linalg.inv(MASS)

# The engine integrates damping implicitly: (M + h D) v' = M v + h (gear u - K q), q' = q + h v'.
damped = np.linalg.inv(MASS + H * DAMPING)
velocity = np.hstack([-H * damped @ STIFFNESS, damped @ MASS])
A = np.vstack([np.hstack([np.eye(2), np.zeros((2, 2))]) + H * velocity, velocity])
B = np.vstack([H * H * damped @ GEAR, H * damped @ GEAR])
# A force changes the accelerations, the velocities after the step, and the positions with these.
G = np.vstack([H * H * inverse, H * inverse])
# Position of the first joint, velocity of the second, and acceleration of the second mass.
acceleration = inverse @ np.hstack([-STIFFNESS, -DAMPING])
C = np.vstack([[1, 0, 0, 0], [0, 0, 0, 1], acceleration.sum(axis=0)])
D = np.vstack([np.zeros((2, 2)), (inverse @ GEAR).sum(axis=0)])
E = np.vstack([np.zeros((2, 2)), inverse.sum(axis=0)])

prior = np.array([0.1, -0.2, 0.0, 0.3])
root = np.array([[0.3, 0.0, 0.0, 0.0], [0.1, 0.2, 0.0, 0.0], [0.0, 0.1, 0.4, 0.0], [0.0, 0.0, -0.2, 0.5]])
P0 = root @ root.T
sensors, motors, forces = np.array([0.05, 0.1, 0.5]), np.array([0.4, 0.2]), np.array([1.5, 0.7])
other = np.diag([1e-4, 2e-4, 3e-4, 1e-4])


def estimates(has_motor_noise):
    per_step = 2 + 2 + 4 + 3  # motors, forces, other noise, sensors
    n = 4 + STEPS * per_step
    covariance = np.zeros((n, n))
    covariance[:4, :4] = P0
    state = np.zeros((4, n))
    state[:, :4] = np.eye(4)
    mean = prior.copy()
    states, means, rows, innovations = [], [], [], []
    readings, controls = [], []
    for k in range(STEPS):
        at = 4 + k * per_step
        w, f, q, v = at + np.arange(2), at + 2 + np.arange(2), at + 4 + np.arange(4), at + 8 + np.arange(3)
        covariance[w, w] = motors**2 if has_motor_noise else 0.0
        covariance[f, f], covariance[v, v] = forces**2, sensors**2
        covariance[np.ix_(q, q)] = other
        u = np.array([np.sin(0.7 * k), np.cos(0.4 * k)])
        y = np.array([0.1 + 0.05 * np.sin(1.3 * k), 0.3 * np.cos(0.9 * k), np.sin(2.0 * k)])
        row = C @ state
        row[:, w] += D
        row[:, f] += E
        row[:, v] += np.eye(3)
        states.append(state.copy())
        means.append(mean.copy())
        rows.append(row)
        innovations.append(y - C @ mean - D @ u)
        state, mean = A @ state, A @ mean + B @ u
        state[:, w] += B
        state[:, f] += G
        state[:, q] += np.eye(4)
        readings.append(y.tolist())
        controls.append(u.tolist())

    def given(k, last):
        H_, nu = np.vstack(rows[: last + 1]), np.concatenate(innovations[: last + 1])
        S, cross = H_ @ covariance @ H_.T, states[k] @ covariance @ H_.T
        gain = np.linalg.solve(S, cross.T).T
        P = states[k] @ covariance @ states[k].T - gain @ cross.T
        return {"mean": (means[k] + gain @ nu).tolist(), "covariance": P.ravel().tolist()}

    return {
        "controls": controls,
        "readings": readings,
        "filtered": [given(k, k) for k in range(STEPS)],
        "smoothed": [given(k, STEPS - 1) for k in range(STEPS)],
    }


result = {
    "prior": prior.tolist(),
    "covariance": P0.ravel().tolist(),
    "deviations": {"sensors": sensors.tolist(), "motors": motors.tolist(), "forces": forces.tolist()},
    "noise": other.ravel().tolist(),
    "with_motor_noise": estimates(True),
    "without_motor_noise": estimates(False),
}
path = Path(__file__).with_name("estimation.json")
path.write_text(json.dumps(result, indent=None, separators=(",", ":")) + "\n")
