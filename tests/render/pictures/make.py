#!/usr/bin/env python3
"""Draws the scenes of scenes.json with the engine's own renderer, for comparison with ours.

Their models are in models/ or Debian's samples.

    MUJOCO_GL=osmesa python make.py [NAME ...]

needs the official bindings of the engine's version (pip install 'mujoco==2.2.2' 'numpy<2' pillow
pyopengl), Debian's packages libosmesa6 and libmujoco-samples. Writes engine/NAME.png: 640 by 480
pixels, 4 samples each, shadow maps of the model's own size. The scenes `crowd` and `hundred` are
for the bench and have no picture.

The state of a scene is reached by a number of steps from reset without control. Other builds of the
engine, and the same build on another processor, give different states in some scenes (visibly in
`hammock`), so the states are written to engine/states.json, from which all renderers start.
"""

import json
import sys
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image

HERE = Path(__file__).parent
MODELS = [HERE / "models", Path("/usr/share/mujoco/model")]
WIDTH, HEIGHT = 640, 480
ONLY_FOR_SPEED = {"crowd", "hundred"}


def state_of(scene):
    path = next(folder / scene["model"] for folder in MODELS if (folder / scene["model"]).exists())
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for _ in range(scene["steps"]):
        mujoco.mj_step(model, data)
    # Draws the rounded numbers that are written. The warm start of the solver is not written.
    state = {key: [float(f"{value:.9g}") for value in getattr(data, key)] for key in ("qpos", "qvel", "act")}
    mujoco.mj_resetData(model, data)
    for key, values in state.items():
        getattr(data, key)[:] = values
    mujoco.mj_forward(model, data)
    return model, data, state


def view_of(scene):
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = scene["lookat"]
    camera.distance, camera.azimuth, camera.elevation = (scene[key] for key in ("distance", "azimuth", "elevation"))
    options = mujoco.MjvOption()
    for flag in scene["visual"]:
        options.flags[getattr(mujoco.mjtVisFlag, f"mjVIS_{flag}")] = 1
    return camera, options


def update(picture, model, data, camera, options, perturbation):
    everything = mujoco.mjtCatBit.mjCAT_ALL.value
    mujoco.mjv_updateScene(model, data, options, perturbation, camera, everything, picture)


def drawn(picture, model):
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    opengl = mujoco.GLContext(WIDTH, HEIGHT)
    opengl.make_current()
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    area = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
    mujoco.mjr_render(area, picture, context)
    rgb = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    mujoco.mjr_readPixels(rgb, None, area, context)
    context.free()
    opengl.free()
    # OpenGL counts rows from the bottom.
    return rgb[::-1]


def main():
    out = HERE / "engine"
    out.mkdir(exist_ok=True)
    names = sys.argv[1:]
    # Keeps the states of scenes that are not drawn again.
    written = out / "states.json"
    states = json.loads(written.read_text()) if written.exists() else {}
    for scene in json.loads((HERE / "scenes.json").read_text()):
        name = scene["name"]
        if name in ONLY_FOR_SPEED or (names and name not in names):
            continue
        model, data, states[name] = state_of(scene)
        picture = mujoco.MjvScene(model, maxgeom=20_000)
        update(picture, model, data, *view_of(scene), mujoco.MjvPerturb())
        Image.fromarray(drawn(picture, model)).save(out / f"{name}.png", optimize=True)
        states[name]["geoms"] = picture.ngeom
        print(f"{name}: {picture.ngeom} geoms, the sum of qpos is {data.qpos.sum()}")
    rows = (f"{json.dumps(name)}: {json.dumps(state, separators=(',', ':'))}" for name, state in states.items())
    written.write_text("{\n" + ",\n".join(rows) + "\n}\n")


if __name__ == "__main__":
    main()
