"""Reference implementation of the Riccati equation: SLICOT, by its Python wrapper slycot.

See engine.c for the protocol.

    slicot.py MODEL.xml KEYFRAME|- < commands
    riccati METHOD FILE     SLICOT's routine SB02OD or SB02MD; the file contains A, B, Q and R

SB02OD uses deflating subspaces of a pencil, as SciPy does. SB02MD uses the Schur vectors of the
symplectic matrix, which takes less time and needs the inverse of A. The time of SB02MD includes
B R⁻¹ Bᵀ. The model and the keyframe are not used.
"""

import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
import slycot

EQUATIONS = {}


def sb02od(a, b, q, r):
    return slycot.sb02od(*b.shape, a, b, q, r, "D")[0]


def sb02md(a, b, q, r):
    g = b @ np.linalg.solve(r, b.T)
    # The eigenvalues of the inverse symplectic matrix that are outside the unit circle belong to
    # the stabilising solution.
    return slycot.sb02md(len(a), a, g, q, "D", hinv="D", sort="U")[0]


METHODS = {"SB02OD": sb02od, "SB02MD": sb02md}


def read(path):
    if path not in EQUATIONS:
        with open(path) as file:
            rows = [[float(entry) for entry in line.split()] for line in file]
        shapes, matrices = [(int(rows[0][i]), int(rows[0][i + 1])) for i in range(0, 8, 2)], rows[1:]
        EQUATIONS[path] = [np.array(entries).reshape(shape) for entries, shape in zip(matrices, shapes)]
    return EQUATIONS[path]


os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
for line in sys.stdin:
    _, method, path = line.split(maxsplit=2)
    a, b, q, r = read(path.strip())
    # The routines may overwrite their arguments.
    arguments = [matrix.copy(order="F") for matrix in (a, b, q, r)]
    begin = time.perf_counter()
    p = METHODS[method](*arguments)
    seconds = time.perf_counter() - begin
    k = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)
    f = a - b @ k
    residual = np.linalg.norm(f.T @ p @ f + k.T @ r @ k + q - p) / np.linalg.norm(p)
    print(f"{seconds:.9e} {residual:.17e}", flush=True)
