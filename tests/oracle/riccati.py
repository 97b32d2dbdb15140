"""Writes riccati.json: the small real dense examples of DAREX, and SciPy's solutions.

P. Benner, A. J. Laub, V. Mehrmann, A Collection of Benchmark Examples for the Numerical Solution of
Algebraic Riccati Equations II: Discrete-Time Case, TU Chemnitz-Zwickau, SPC 95_23 (1995); J. Abels,
P. Benner, DAREX - A Collection of Benchmark Examples for Discrete-Time Algebraic Riccati Equations,
SLICOT Working Note 1999-16.

    python3 tests/oracle/riccati.py
"""

import json
import pathlib

import numpy as np
from scipy.linalg import solve_discrete_are


def examples():
    """Yields name, A, B, Q, R, optionally S, and the closed-form solution, if any."""
    golden = (1 + np.sqrt(5)) / 2

    q = np.array([[9, 6], [6, 4]])
    yield "1.1", [[4, 3], [-4.5, -3.5]], [[1], [-1]], q, [[1]], None, golden * q
    yield (
        "1.2",
        [[0.9512, 0], [0, 0.9048]],
        [[4.877, 4.877], [-1.1895, 3.569]],
        [[0.005, 0], [0, 0.02]],
        [[1 / 3, 0], [0, 3]],
        None,
        None,
    )
    yield "1.3", [[2, -1], [1, 0]], [[1], [0]], [[0, 0], [0, 1]], [[0]], None, np.eye(2)
    singular = [[9, 3], [3, 1]]
    q = np.array([[-4, -4], [-4, 7]]) / 11
    # With its S, no stabilising solution has a positive definite cost of the controls; SciPy's own
    # tests omit it as well.
    yield "1.4 without S", [[0, 1], [0, -1]], [[1, 0], [2, 1]], q, singular, None, None
    p = [[1, 2], [2, 2 + np.sqrt(5)]]
    yield "1.5", [[0, 1], [0, 0]], [[0], [1]], [[1, 2], [2, 4]], [[1]], None, p
    yield (
        "1.6",
        [[0.998, 0.067, 0, 0], [-0.067, 0.998, 0, 0], [0, 0, 0.998, 0.153], [0, 0, -0.153, 0.998]],
        [[0.0033, 0.0200], [0.1000, -0.0007], [0.0400, 0.0073], [-0.0028, 0.1000]],
        [[1.87, 0, 0, -0.244], [0, 0.744, 0.205, 0], [0, 0.205, 0.589, 0], [-0.244, 0, 0, 1.048]],
        np.eye(2),
        None,
        None,
    )
    yield (
        "1.7",
        [
            [0.984750, -0.079903, 0.0009054, -0.0010765],
            [0.041588, 0.998990, -0.0358550, 0.0126840],
            [-0.546620, 0.044916, -0.3299100, 0.1931800],
            [2.662400, -0.100450, -0.9245500, -0.2632500],
        ],
        [[0.0037112, 0.0007361], [-0.0870510, 9.3411e-6], [-1.198440, -4.1378e-4], [-3.192700, 9.2535e-4]],
        0.01 * np.eye(4),
        np.eye(2),
        None,
        None,
    )
    yield (
        "1.8",
        [[-0.6, -2.2, -3.6, -5.400018], [1, 0.6, 0.8, 3.399982], [0, 1, 1.8, 3.799982], [0, 0, 0, -0.999982]],
        [[1, -1, -1, -1], [0, 1, -1, -1], [0, 0, 1, -1], [0, 0, 0, 1]],
        [[2, 1, 3, 6], [1, 2, 2, 5], [3, 2, 6, 11], [6, 5, 11, 22]],
        np.eye(4),
        None,
        None,
    )
    a = [
        [95.4070, 1.9643, 0.3597, 0.0673, 0.0190],
        [40.8490, 41.3170, 16.0840, 4.4679, 1.1971],
        [12.2170, 26.3260, 36.1490, 15.9300, 12.3830],
        [4.1118, 12.8580, 27.2090, 21.4420, 40.9760],
        [0.1305, 0.5808, 1.8750, 3.6162, 94.2800],
    ]
    b = [[0.0434, -0.0122], [2.6606, -1.0453], [3.7530, -5.5100], [3.6076, -6.6000], [0.4617, -0.9148]]
    yield "1.9", 0.01 * np.array(a), 0.01 * np.array(b), np.eye(5), np.eye(2), None, None
    q = np.zeros((6, 6))
    q[:2, :2] = 1
    q[3:5, 3:5] = [[1, -1], [-1, 1]]
    chain = np.diag([1, 1], k=1)
    yield "1.10", np.kron(np.eye(2), chain), np.kron(np.eye(2), [[0], [0], [1]]), q, [[3, 0], [0, 1]], None, None
    a = [
        [870.1, 135.0, 11.59, 0.5014, -37.22, 0.3484, 0, 4.242, 7.249],
        [76.55, 897.4, 12.72, 0.5504, -40.16, 0.3743, 0, 4.53, 7.499],
        [-127.2, 357.5, 817, 1.455, -102.8, 0.987, 0, 11.85, 18.72],
        [-363.5, 633.9, 74.91, 796.6, -273.5, 2.653, 0, 31.72, 48.82],
        [-960, 1645.9, -128.9, -5.597, 71.42, 7.108, 0, 84.52, 125.9],
        [-664.4, 112.96, -88.89, -3.854, 84.47, 13.6, 0, 144.3, 101.6],
        [-410.2, 693, -54.71, -2.371, 66.49, 12.49, 0.1063, 99.97, 69.67],
        [-179.9, 301.7, -23.93, -1.035, 60.59, 22.16, 0, 213.9, 35.54],
        [-345.1, 580.4, -45.96, -1.989, 105.6, 19.86, 0, 219.1, 215.2],
    ]
    b = [
        [4.7600, -0.5701, -83.6800],
        [0.8790, -4.7730, -2.7300],
        [1.4820, -13.1200, 8.8760],
        [3.8920, -35.1300, 24.8000],
        [10.3400, -92.7500, 66.8000],
        [7.2030, -61.5900, 38.3400],
        [4.4540, -36.8300, 20.2900],
        [1.9710, -15.5400, 6.9370],
        [3.7730, -30.2800, 14.6900],
    ]
    yield "1.11", 0.001 * np.array(a), 0.001 * np.array(b), np.diag([50, 0, 0, 0, 50, 0, 0, 0, 0]), np.eye(3), None, None

    for epsilon in (1.0, 1e3, 1e6):
        p = np.diag([1, 1 + epsilon**2])
        yield f"2.1, {epsilon:g}", [[0, epsilon], [0, 0]], [[0], [1]], np.eye(2), [[1]], None, p
    for epsilon in (1.0, 1e6):
        turn = np.eye(3) - 2 / 3 * np.ones((3, 3))
        a = turn @ np.diag([0, 1, 3]) @ turn
        p = epsilon * turn @ np.diag([1, golden, (9 + np.sqrt(85)) / 2]) @ turn
        yield f"2.2, {epsilon:g}", a, np.eye(3), epsilon * np.eye(3), epsilon * np.eye(3), None, p
    for tau in (1e2, 1e4, 1e6, 1e8):
        a = np.diag([1.0, 1, 1], k=-1)
        a[0, 0] = 1 - 1 / tau
        yield f"2.3, {tau:g}", a, [[1 / tau], [0], [0], [0]], np.diag([0, 0, 0, 1]), [[0.25]], None, None
    for n in (10, 30):
        last = np.zeros((n, 1))
        last[-1] = 1
        yield f"4.1, {n}", np.eye(n, k=1), last, np.eye(n), [[1]], None, np.diag(np.arange(1, n + 1))


def main():
    recorded = []
    for name, a, b, q, r, s, formula in examples():
        a, b, q, r = (np.asarray(matrix, dtype=float) for matrix in (a, b, q, r))
        example = {"name": name, "a": a, "b": b, "q": q, "r": r, "s": s, "formula": formula}
        s = np.zeros_like(b) if s is None else np.asarray(s, dtype=float)
        example["scipy"] = example["scipy_residual"] = None
        try:
            p = solve_discrete_are(a, b, q, r, s=s)
        except np.linalg.LinAlgError as error:
            print(f"{name}: SciPy fails: {error}")
        else:
            k = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a + s.T)
            f = a - b @ k
            residual = f.T @ p @ f + k.T @ r @ k - s @ k - (s @ k).T + q - p
            example["scipy"] = p
            example["scipy_residual"] = np.linalg.norm(residual) / np.linalg.norm(p)
            print(f"{name}: {example['scipy_residual']:.1e}, radius {max(abs(np.linalg.eigvals(f))):.6f}")
        recorded.append(example)
    rows = lambda value: np.asarray(value, dtype=float).tolist()
    path = pathlib.Path(__file__).with_name("riccati.json")
    path.write_text(json.dumps(recorded, default=rows, separators=(",", ":")).replace('},{"name"', '},\n{"name"') + "\n")


main()
