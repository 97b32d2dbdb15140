"""Reference implementation in Python: the official bindings, SciPy and NumPy.

See engine.c for the protocol.

    peer.py MODEL.xml KEYFRAME|- < commands
    step CALLS
    rollout COUNT STEPS THREADS
    environments COUNT CALLS THREADS    one step per call for COUNT environments, each with its own
                                        MjData, by a pool of threads
    batch COUNT CALLS THREADS           as in engine.c, by mujoco.batch, which the bindings have
                                        since 3.17
    controller CALLS                    LQR control law: differentiatePos and a matrix-vector
                                        product
    riccati FILE                        SciPy's solve_discrete_are; the file contains A, B, Q and R

The bindings of 2.2.2 lack the `rollout` module of later versions. A pool of threads that call
`mj_step` replaces it: the binding releases Python's global lock during the call, as that module
does.
"""

import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
from scipy.linalg import solve_discrete_are

try:
    from mujoco.batch import Batch
except ImportError:
    Batch = None

MODEL = mujoco.MjModel.from_xml_path(sys.argv[1])
KEY = -1 if sys.argv[2] == "-" else mujoco.mj_name2id(MODEL, mujoco.mjtObj.mjOBJ_KEY, sys.argv[2])
MASK = (1 << 64) - 1


class Numbers:
    """Random number generator, equal to that of engine.c."""

    def __init__(self):
        self.x = 1

    def next(self):
        self.x = (self.x * 6364136223846793005 + 1442695040888963407) & MASK
        return (self.x >> 11) / 2.0**53 * 2 - 1


class Controls:
    """Controls, equal to those of engine.c, generated on first use."""

    made = np.zeros((0, MODEL.nu))

    @classmethod
    def of(cls, count):
        if len(cls.made) < count:
            numbers = Numbers()
            scale = [r[1] if limited else 1.0 for r, limited in zip(MODEL.actuator_ctrlrange, MODEL.actuator_ctrllimited)]
            cls.made = np.array([[0.1 * numbers.next() * s for s in scale] for _ in range(count)]).reshape(count, MODEL.nu)
        return cls.made[:count]


def pin_to(thread):
    """Pins the calling thread to a processor, as all implementations do."""
    os.sched_setaffinity(0, {PROCESSORS[thread % len(PROCESSORS)]})


def start(data):
    if KEY >= 0:
        mujoco.mj_resetDataKeyframe(MODEL, data, KEY)
    else:
        mujoco.mj_resetData(MODEL, data)


def step(calls):
    warm_up = calls // 8
    controls, data = Controls.of(warm_up + calls), DATA[0]
    start(data)
    for i in range(warm_up + calls):
        if i == warm_up:
            begin = time.perf_counter()
        data.ctrl[:] = controls[i]
        mujoco.mj_step(MODEL, data)
    return time.perf_counter() - begin, float(np.sum(data.qpos))


def rollout(count, steps, threads):
    controls = Controls.of(count * steps)
    while len(DATA) < threads:
        DATA.append(mujoco.MjData(MODEL))
    states = np.zeros((count, steps, MODEL.nq + MODEL.nv))

    def simulate(thread):
        pin_to(thread)
        data = DATA[thread]
        qpos, qvel, ctrl = data.qpos, data.qvel, data.ctrl
        for i in range(count * thread // threads, count * (thread + 1) // threads):
            start(data)
            for k in range(steps):
                ctrl[:] = controls[i * steps + k]
                mujoco.mj_step(MODEL, data)
                states[i, k, : MODEL.nq] = qpos
                states[i, k, MODEL.nq :] = qvel

    begin = time.perf_counter()
    list(POOL.map(simulate, range(threads)))
    return time.perf_counter() - begin, float(np.sum(states[-1, -1, : MODEL.nq]))


def environments(count, calls, threads):
    controls = Controls.of((calls + 1) * count).reshape(calls + 1, count, MODEL.nu)
    while len(DATA) < count:
        DATA.append(mujoco.MjData(MODEL))
    for data in DATA[:count]:
        start(data)

    def simulate(thread):
        pin_to(thread)
        for i in range(count * thread // threads, count * (thread + 1) // threads):
            data = DATA[i]
            data.ctrl[:] = current[i]
            mujoco.mj_step(MODEL, data)

    for call, current in enumerate(controls):
        if call == 1:
            begin = time.perf_counter()
        list(POOL.map(simulate, range(threads)))
    return time.perf_counter() - begin, float(np.sum(DATA[count - 1].qpos))


def new_batch(count, threads):
    """Creates a batch and pins its threads, of which the calling thread is one."""
    others = set(os.listdir("/proc/self/task"))
    result = Batch(MODEL, count, threads)
    created = sorted(set(os.listdir("/proc/self/task")) - others, key=int)
    for thread, task in enumerate(created, 1):
        os.sched_setaffinity(int(task), {PROCESSORS[thread % len(PROCESSORS)]})
    return result


def batch(count, calls, threads):
    controls = Controls.of((calls + 1) * count).reshape(calls + 1, count, MODEL.nu)
    if (count, threads) not in BATCHES:
        BATCHES[count, threads] = new_batch(count, threads)
    simulations = BATCHES[count, threads]
    simulations.reset(keyframe=KEY, stage=mujoco.mjtStage.mjSTAGE_NONE.value)
    qpos, ctrl = simulations.bind("qpos"), simulations.bind("ctrl")
    for call, current in enumerate(controls):
        if call == 1:
            begin = time.perf_counter()
        ctrl[:] = current
        simulations.step()
    return time.perf_counter() - begin, float(np.sum(qpos[-1]))


def controller(calls):
    data = DATA[0]
    start(data)
    nv = MODEL.nv
    numbers = Numbers()
    gain = np.array([[numbers.next() for _ in range(2 * nv)] for _ in range(MODEL.nu)])
    qpos0, ctrl0 = data.qpos.copy(), data.ctrl.copy()
    data.qvel[:] = 0.01
    dq = np.zeros(nv)
    begin = time.perf_counter()
    for _ in range(calls):
        mujoco.mj_differentiatePos(MODEL, dq, 1, qpos0, data.qpos)
        dx = np.hstack((dq, data.qvel))
        data.ctrl[:] = ctrl0 - gain @ dx
    return time.perf_counter() - begin, float(np.sum(data.ctrl))


def riccati(path):
    if path not in EQUATIONS:
        with open(path) as file:
            rows = [[float(entry) for entry in line.split()] for line in file]
        shapes, matrices = [(int(rows[0][i]), int(rows[0][i + 1])) for i in range(0, 8, 2)], rows[1:]
        EQUATIONS[path] = [np.array(entries).reshape(shape) for entries, shape in zip(matrices, shapes)]
    a, b, q, r = EQUATIONS[path]
    begin = time.perf_counter()
    p = solve_discrete_are(a, b, q, r)
    seconds = time.perf_counter() - begin
    k = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)
    f = a - b @ k
    return seconds, float(np.linalg.norm(f.T @ p @ f + k.T @ r @ k + q - p) / np.linalg.norm(p))


PROCESSORS = sorted(os.sched_getaffinity(0))
pin_to(0)
DATA = [mujoco.MjData(MODEL)]
POOL = ThreadPoolExecutor(64)
EQUATIONS = {}
BATCHES = {}
COMMANDS = {"step": step, "rollout": rollout, "environments": environments, "batch": batch, "controller": controller}

for line in sys.stdin:
    command, *arguments = line.split()
    if command == "riccati":
        seconds, number = riccati(arguments[0])
    else:
        seconds, number = COMMANDS[command](*map(int, arguments))
    print(f"{seconds:.9e} {number:.17e}", flush=True)
