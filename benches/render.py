#!/usr/bin/env python3
"""The engine's renderer, as the reference of the benchmark `render`.

Reads requests from standard input, one JSON object per line, and answers each with another:

    {"open": NAME, "width": W, "height": H}   a scene of tests/render/pictures/scenes.json: {"first": seconds to the first image}
    {"draw": N}                               {"cpu": seconds of all threads, "wall": seconds} for N images

As on the Rust side, an image consists of updating the abstract scene, drawing it and reading the pixels back.
"""

import json
import sys
import time
from pathlib import Path

import mujoco
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/render/pictures"))
import make  # noqa: E402


class Drawing:
    def __init__(self, scene, width, height):
        self.model, self.data, _ = make.state_of(scene)
        self.camera, self.options = make.view_of(scene)
        self.perturbation = mujoco.MjvPerturb()
        self.picture = mujoco.MjvScene(self.model, maxgeom=20_000)
        start = time.perf_counter()
        self.model.vis.global_.offwidth, self.model.vis.global_.offheight = width, height
        self.opengl = mujoco.GLContext(width, height)
        self.opengl.make_current()
        self.context = mujoco.MjrContext(self.model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self.context)
        self.area = mujoco.MjrRect(0, 0, width, height)
        self.rgb = np.empty((height, width, 3), np.uint8)
        self.draw()
        self.first = time.perf_counter() - start

    def draw(self):
        make.update(self.picture, self.model, self.data, self.camera, self.options, self.perturbation)
        mujoco.mjr_render(self.area, self.picture, self.context)
        mujoco.mjr_readPixels(self.rgb, None, self.area, self.context)

    def close(self):
        self.context.free()
        self.opengl.free()


def answers():
    scenes = {scene["name"]: scene for scene in json.loads((make.HERE / "scenes.json").read_text())}
    drawing = None
    for line in sys.stdin:
        request = json.loads(line)
        if "open" in request:
            if drawing:
                drawing.close()
            drawing = Drawing(scenes[request["open"]], request["width"], request["height"])
            yield {"first": drawing.first}
        else:
            cpu, wall = time.process_time(), time.perf_counter()
            for _ in range(request["draw"]):
                drawing.draw()
            yield {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}


if __name__ == "__main__":
    for answer in answers():
        print(json.dumps(answer), flush=True)
