#!/usr/bin/env python3
"""The engine's renderer, as the reference of the benchmark `render`.

Reads requests from standard input, one JSON object per line, and answers each with another:

    {"open": MODEL, "width": W, "height": H, ...}   opens a scene (see `Drawing`): {}
    {"draw": N, "kind": KIND}                       {"cpu": seconds of all threads, "wall": seconds} for N images,
                                                    KIND is rgb, depth (in metres) or ids (of segments)
    {"picture": FILE}                               writes the bytes of an image, from the upper left: {}

As on the Rust side, an image consists of updating the abstract scene, drawing it and reading the
pixels back.
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
    """A model in a given state, with these flags of `mjvOption` and `mjvScene`.

    It is seen from its camera `fixed` or from a free camera.
    """

    def __init__(self, scene):
        self.model = mujoco.MjModel.from_xml_path(scene["open"])
        self.model.hfield_data[:] = scene["elevations"]
        quality = self.model.vis.quality
        if scene["samples"] is not None:
            # OpenGL counts no samples without multisampling.
            quality.offsamples = scene["samples"] if scene["samples"] > 1 else 0
        if scene["shadow_size"] is not None:
            quality.shadowsize = scene["shadow_size"]
        self.data = mujoco.MjData(self.model)
        for key, values in scene["state"].items():
            getattr(self.data, key)[:] = values
        mujoco.mj_forward(self.model, self.data)
        self.camera, self.options = make.view_of(scene)
        if scene["fixed"] is not None:
            self.camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
            self.camera.fixedcamid = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_CAMERA, scene["fixed"])
        self.perturbation = mujoco.MjvPerturb()
        self.picture = mujoco.MjvScene(self.model, maxgeom=20_000)
        for flag in scene["render"]:
            self.picture.flags[getattr(mujoco.mjtRndFlag, f"mjRND_{flag}")] = 1
        width, height = scene["width"], scene["height"]
        self.model.vis.global_.offwidth, self.model.vis.global_.offheight = width, height
        self.opengl = mujoco.GLContext(width, height)
        self.opengl.make_current()
        self.context = mujoco.MjrContext(self.model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self.context)
        self.area = mujoco.MjrRect(0, 0, width, height)
        self.rgb = np.empty((height, width, 3), np.uint8)
        self.depth = np.empty((height, width), np.float32)
        self.draw()

    def draw(self, kind="rgb"):
        make.update(self.picture, self.model, self.data, self.camera, self.options, self.perturbation)
        for flag in mujoco.mjtRndFlag.mjRND_SEGMENT, mujoco.mjtRndFlag.mjRND_IDCOLOR:
            self.picture.flags[flag] = kind == "ids"
        mujoco.mjr_render(self.area, self.picture, self.context)
        if kind == "depth":
            mujoco.mjr_readPixels(None, self.depth, self.area, self.context)
            # As mujoco.Renderer converts it to metres.
            extent, visual = self.model.stat.extent, self.model.vis.map
            near, far = visual.znear * extent, visual.zfar * extent
            return near / (1 - self.depth * (1 - near / far))
        mujoco.mjr_readPixels(self.rgb, None, self.area, self.context)
        if kind == "ids":
            return self.rgb.astype(np.int32) @ np.array([1, 1 << 8, 1 << 16], np.int32)
        return self.rgb

    def close(self):
        self.context.free()
        self.opengl.free()


def answers():
    drawing = None
    for line in sys.stdin:
        request = json.loads(line)
        if "open" in request:
            if drawing:
                drawing.close()
            drawing = Drawing(request)
            yield {}
        elif "picture" in request:
            drawing.draw()
            # OpenGL counts rows from the bottom.
            drawing.rgb[::-1].tofile(request["picture"])
            yield {}
        else:
            cpu, wall = time.process_time(), time.perf_counter()
            for _ in range(request["draw"]):
                drawing.draw(request["kind"])
            yield {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}


if __name__ == "__main__":
    for answer in answers():
        print(json.dumps(answer), flush=True)
