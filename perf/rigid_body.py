"""Derivatives of rigid bodies by Pinocchio and Crocoddyl, the reference of benches/rigid_body.rs.

Reads the number of joints and of states, gravity and the time step; for each joint its parent (-1
is the world), its kind (0 free, 1 hinge, 2 slide, 3 only a body of the parent), the placement in the frame of the parent
(position, rotation matrix by rows), the axis, the mass, the centre of mass, the inertia about it by
rows, and the armature; and for each state the positions, velocities, accelerations and forces, in
the coordinates of Pinocchio. Prints `ready`, and answers each line:

    NAME          the median time of a computation in seconds
    values NAME   the result in the first state
"""

import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import crocoddyl
import numpy as np
import pinocchio as pin


def numbers():
    return np.array([float(number) for number in sys.stdin.readline().split()])


joints, states, gravity, step = numbers()
model = pin.Model()
model.gravity.linear = np.array([0.0, 0.0, gravity])
armature = []
for index in range(int(joints)):
    row = numbers()
    parent, kind = int(row[0]) + 1, int(row[1])
    if kind == 3:
        model.appendBodyToJoint(parent, pin.Inertia(row[17], row[18:21], row[21:30].reshape(3, 3)), pin.SE3.Identity())
        continue
    placement = pin.SE3(row[5:14].reshape(3, 3), row[2:5])
    axis = row[14:17]
    joint = (
        pin.JointModelFreeFlyer()
        if kind == 0
        else [pin.JointModelRevoluteUnaligned, pin.JointModelPrismaticUnaligned][kind - 1](axis)
    )
    model.addJoint(parent, joint, placement, f"joint{index}")
    armature.extend([row[30]] * joint.nv)
model.armature = np.array(armature)
data = model.createData()
points = []
for _ in range(int(states)):
    row = numbers()
    points.append(np.split(row, [model.nq, model.nq + model.nv, model.nq + 2 * model.nv]))

# The semi-implicit Euler method, as the engine's.
state = crocoddyl.StateMultibody(model)
actuation = crocoddyl.ActuationModelFull(state)
costs = crocoddyl.CostModelSum(state, actuation.nu)
continuous = crocoddyl.DifferentialActionModelFreeFwdDynamics(state, actuation, costs)
action = crocoddyl.IntegratedActionModelEuler(continuous, step)
action_data = action.createData()


def inverse(q, v, a, _):
    pin.computeRNEADerivatives(model, data, q, v, a)
    return data.dtau_dq, data.dtau_dv, data.M


def regressor(q, v, a, _):
    return (pin.computeJointTorqueRegressor(model, data, q, v, a),)


def forward(q, v, _, tau):
    pin.computeABADerivatives(model, data, q, v, tau)
    return data.ddq_dq, data.ddq_dv, data.Minv


def linear_system(q, v, _, tau):
    x = np.concatenate([q, v])
    action.calc(action_data, x, tau)
    action.calcDiff(action_data, x, tau)
    return action_data.Fx, action_data.Fu


functions = {"inverse": inverse, "regressor": regressor, "forward": forward, "linear_system": linear_system}
print("ready", flush=True)
for line in sys.stdin:
    words = line.split()
    function = functions[words[-1]]
    if words[0] == "values":
        values = [np.array(matrix) for matrix in function(*points[0])]
        if words[-1] in ("inverse", "forward"):
            # Only the upper triangle is computed.
            values[2] = np.triu(values[2]) + np.triu(values[2], 1).T
        print(*(repr(float(number)) for matrix in values for number in matrix.ravel()), flush=True)
        continue
    seconds = []
    for point in points:
        before = time.perf_counter()
        function(*point)
        seconds.append(time.perf_counter() - before)
    print(np.median(seconds), flush=True)
