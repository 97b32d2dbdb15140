"""Records numbers of the official Python bindings for tests/engine/against_python.rs.

The bindings include their own build of the engine, so the numbers are independent of this library
and of the engine that it is linked with. The wheels of 2.2.2 need Python 3.7 to 3.10, and a numpy
before 2:

    python3.10 -m venv venv
    venv/bin/pip install mujoco==2.2.2 'numpy<2'
    venv/bin/python tests/oracle/record.py

This writes tests/oracle/recorded/2.2.2.json. With the bindings of another version it writes the
file of that version. Running it again gives the same file.
"""

import json
import math
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
MODELS = HERE.parent.parent / "models"

STEPS = 1000
EVERY = 50
SIZES = ("nq", "nv", "nu", "na", "nbody", "ngeom", "nsensordata")


def values(array):
    """Returns a flat list, row by row.

    Python prints the shortest digits that read back as the same number.
    """
    return [float(value) for value in np.asarray(array, dtype=float).ravel()]


def load(name):
    model = mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))
    return model, mujoco.MjData(model)


def reset(model, data, key):
    """Resets to a keyframe, or to the reference position for None."""
    if key is None:
        mujoco.mj_resetData(model, data)
    else:
        mujoco.mj_resetDataKeyframe(model, data, key)


def name_of(model, kind, index):
    return mujoco.mj_id2name(model, kind, index)


def keys(model):
    """Returns the reference position and every keyframe."""
    return [(None, "")] + [(key, name_of(model, mujoco.mjtObj.mjOBJ_KEY, key)) for key in range(model.nkey)]


def trajectory(model, data):
    """Returns every 50th state of 1000 steps with fixed controls."""
    reset(model, data, None)
    samples = []
    for step in range(STEPS):
        for index in range(model.nu):
            data.ctrl[index] = 0.3 * math.sin(step * 0.1 + index)
        mujoco.mj_step(model, data)
        if (step + 1) % EVERY == 0:
            samples.append(
                {
                    "step": step + 1,
                    "time": data.time,
                    "qpos": values(data.qpos),
                    "qvel": values(data.qvel),
                    "ncon": data.ncon,
                }
            )
    return samples


def linearisation(model, data, key):
    reset(model, data, key)
    nx = 2 * model.nv + model.na
    a, b = np.zeros((nx, nx)), np.zeros((nx, model.nu))
    c, d = np.zeros((model.nsensordata, nx)), np.zeros((model.nsensordata, model.nu))
    mujoco.mjd_transitionFD(model, data, 1e-6, 1, a, b, c, d)
    return {"a": values(a), "b": values(b), "c": values(c), "d": values(d)}


def inverse(model, data, key):
    """Returns the forces that would hold the pose."""
    reset(model, data, key)
    mujoco.mj_forward(model, data)
    data.qacc[:] = 0
    mujoco.mj_inverse(model, data)
    return values(data.qfrc_inverse)


def contacts(model, data, key):
    reset(model, data, key)
    mujoco.mj_forward(model, data)
    found = []
    for index in range(data.ncon):
        contact, force = data.contact[index], np.zeros(6)
        mujoco.mj_contactForce(model, data, index, force)
        names = [name_of(model, mujoco.mjtObj.mjOBJ_GEOM, geom) for geom in (contact.geom1, contact.geom2)]
        found.append({"geoms": names, "dist": contact.dist, "pos": values(contact.pos), "force": values(force)})
    return found


def jacobians(model, data, key, body_names, site_names):
    reset(model, data, key)
    mujoco.mj_forward(model, data)
    found = {"bodies": {}, "sites": {}}
    for name in body_names:
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        jacp, jacr, com, subtree = (np.zeros((3, model.nv)) for _ in range(4))
        mujoco.mj_jacBody(model, data, jacp, jacr, body)
        mujoco.mj_jacBodyCom(model, data, com, None, body)
        mujoco.mj_jacSubtreeCom(model, data, subtree, body)
        found["bodies"][name] = {
            "translation": values(jacp), "rotation": values(jacr), "com": values(com), "subtree_com": values(subtree)
        }
    for name in site_names:
        jacp, jacr = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jacSite(model, data, jacp, jacr, mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name))
        found["sites"][name] = {"translation": values(jacp), "rotation": values(jacr)}
    return found


def record(name, linearised_at, bodies, sites):
    model, data = load(name)
    return {
        "sizes": {size: int(getattr(model, size)) for size in SIZES},
        "trajectory": trajectory(model, data),
        "linearisation": linearisation(model, data, linearised_at),
        "poses": [
            {"keyframe": key_name, "qfrc_inverse": inverse(model, data, key), "contacts": contacts(model, data, key)}
            for key, key_name in keys(model)
        ],
        "jacobians": jacobians(model, data, model.nkey - 1, bodies, sites),
    }


def main():
    humanoid, _ = load("humanoid")
    on_one_leg = mujoco.mj_name2id(humanoid, mujoco.mjtObj.mjOBJ_KEY, "stand_on_left_leg")
    recorded = {
        "engine": mujoco.mj_versionString(),
        "humanoid": record("humanoid", on_one_leg, ["torso", "foot_left", "hand_right"], ["sole_left"]),
        "cartpole": record("cartpole", None, ["cart", "pole"], ["tip"]),
    }
    path = HERE / "recorded" / f"{mujoco.__version__}.json"
    path.write_text(json.dumps(recorded, separators=(",", ":")).replace('},{', '},\n{') + "\n")
    print(f"{path.name}: {path.stat().st_size // 1024} kB")


if __name__ == "__main__":
    main()
