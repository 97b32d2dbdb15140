#!/usr/bin/env python3
"""Draws everything that an engine shows with its own renderer.

The images are colour, depth and segmentation.

    MUJOCO_GL=osmesa python linked.py OUT [PART_OF_A_NAME ...]
    MUJOCO_GL=osmesa python linked.py OUT --random FIRST COUNT
    MUJOCO_GL=osmesa python linked.py --record

needs the official bindings of the linked engine (numpy, pillow, pyopengl) and Debian's package
libosmesa6; with bindings from 4.0, MUJOCO_GL=egl. The test `pictures_equal_those_of_the_bindings`
runs it and compares. Writes scenes.json, and for each scene NAME.xml, NAME.rgb (bytes), NAME.depth
(float32, metres, without transparent geoms) and NAME.ids (int32, index of the geom in the scene, -1
for the background), row-major from the upper left. A scene whose model needs a newer engine is left
out.

--random draws random scenes instead, of the seeds from FIRST on (compare with
MUJOCO_SAFE_PICTURES=OUT and MUJOCO_SAFE_SCENE=random). --record writes small colour images of the
scenes in RECORDED to recorded/VERSION, with which the test `recorded_pictures_are_drawn` compares.
"""

import json
import sys
import zlib
from pathlib import Path

import mujoco
import numpy as np

from random_scenes import random_scenes

SIZE = [320, 240]
RECORDED_SIZE = [160, 120]
RECORDED = (
    "camera_ortho_2.0 camera_ortho_free_3.0 camera_intrinsic_principal camera_intrinsic_square texture_2d_sphere_false_2.5_3 texture_2d_box_true_2.5_3 "
    "texture_2d_ellipsoid_false_2.5_3 texture_2d_capsule_false_2.5_3 texture_2d_cylinder_false_2.5_3 texture_2d_plane_true_2.5_3 texture_2d_mesh_uv_false_2.5_3 texture_skin_3 "
    "texture_flex_3 texture_layer_rgba texture_srgb visual_frustum_behind islands flex_3_edges shadow_in_transparent visual_many light_type_point_false light_point_first "
    "light_shadows_7 shadow_off_geoms coincident_2_0 coincident_1_2 coincident_decor lines_shadows_2 lines_fog decor_in_shadow wireframe_hfield texture_2d_skin_plain "
    "texture_cube_skin_plain transform_small tendon_active_0.3 "
    "haze_0 haze_coarse camera_default_ortho distant_plates fog_reversed light_attenuation_negative"
).split()
VERSION = tuple(int(part) for part in mujoco.__version__.split(".")[:3])

LIGHT = '<light name="lamp" pos="1.5 -2 4" dir="-.3 .4 -1" castshadow="true" diffuse=".6 .6 .6"/>'
FLOOR = '<geom name="floor" type="plane" size="3 3 .1" pos="0 0 -.6" rgba=".5 .6 .5 1"/>'
CHECKER = '<texture name="t" type="2d" builtin="checker" width="64" height="48" rgb1=".9 .2 .1" rgb2=".1 .3 .8" mark="cross" markrgb="1 1 .3"/>'
GRADIENT = '<texture name="t" type="cube" builtin="gradient" width="32" height="192" rgb1=".9 .4 .1" rgb2=".1 .3 .8" mark="cross" markrgb="1 1 .3"/>'
SKY = '<texture name="sky" type="skybox" builtin="gradient" rgb1=".4 .6 .8" rgb2=".1 .1 .2" width="64" height="384"/>'
BODIES = (
    '<geom name="ball" size=".25" pos=".5 .3 .1" rgba=".8 .3 .2 1"/><geom name="block" type="box" size=".2 .3 .15" pos="-.5 .2 0" '
    'euler="20 30 40" rgba=".2 .5 .8 1"/><geom name="rod" type="capsule" size=".08 .3" pos="0 -.4 0" euler="60 0 20" rgba=".9 .8 .2 1"/>'
    '<geom name="drum" type="cylinder" size=".15 .2" pos=".1 .6 -.2" euler="0 40 0" rgba=".5 .2 .7 1"/>'
)


def xml(body, asset="", visual="", more="", options=""):
    return (
        f'<mujoco><compiler angle="degree"/><statistic center="0 0 0" extent="2"/><option {options}/>'
        f"<visual>{visual}</visual><asset>{asset}</asset><worldbody>{body}</worldbody>{more}</mujoco>"
    )


SCENES = []


def scene(name, text, since=(2, 2, 2), camera=None, free=(140.0, -25.0, 3.0), visual="", no_visual="", render="", no_render="", steps=0,
          label="NONE", frame="NONE", layer=0, depth=0, lookat=(0.0, 0.0, 0.0), **more):
    if VERSION >= since:
        azimuth, elevation, distance = free
        SCENES.append({
            "name": name, "xml": text, "camera": camera, "azimuth": azimuth, "elevation": elevation, "distance": distance,
            "lookat": list(lookat), "visual": visual.split(), "no_visual": no_visual.split(), "render": render.split(),
            "no_render": no_render.split(), "steps": steps, "label": label, "frame": frame, "flex_layer": layer, "bvh_depth": depth,
            **more,
        })


def cameras():
    place = 'pos="1.6 -1.8 1.4" xyaxes="1.8 1.6 0 -.75 .85 1.6"'
    world = lambda camera, **kw: xml(f"{LIGHT}{FLOOR}{BODIES}{camera}", **kw)
    ortho = (3, 1, 0)
    projection = 'projection="orthographic"' if VERSION >= (3, 4, 0) else 'orthographic="true"'
    for fovy in (20, 60, 100):
        scene(f"camera_fovy_{fovy}", world(f'<camera name="c" {place} fovy="{fovy}"/>'), camera="c")
    for length in (0.7, 2.0, 6.0):
        scene(f"camera_ortho_{length}", world(f'<camera name="c" {place} {projection} fovy="{length}"/>'), camera="c", since=ortho)
    free = '<global orthographic="true" fovy="{}"/>'
    for length in (1.0, 3.0):
        scene(f"camera_ortho_free_{length}", world("", visual=free.format(length)), since=ortho)
    scene("camera_ortho_horizon", xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6" material="m"/>',
          asset=CHECKER + SKY + '<material name="m" texture="t" texuniform="true" texrepeat="2 2" reflectance=".3"/>', visual=free.format(3)), since=ortho)
    scene("camera_ortho_mirror", xml(LIGHT + BODIES + '<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>',
          asset='<material name="m" reflectance=".5" specular="1"/>', visual=free.format(3)), since=ortho)
    scene("camera_ortho_fog", world("", visual=free.format(3) + '<map fogstart="1" fogend="2"/><rgba fog=".2 .5 .3 1"/>'), since=ortho, render="FOG")
    scene("camera_ortho_wireframe", world("", visual=free.format(3)), since=ortho, render="WIREFRAME", no_render="SHADOW")
    scene("camera_ortho_transparent", world('<geom size=".4" pos="0 0 .3" rgba=".3 .9 .3 .4"/>', visual=free.format(3)), since=ortho)
    scene("camera_ortho_decor", world("", visual=free.format(3)), since=ortho, label="GEOM", frame="GEOM")
    scene("camera_ortho_specular", world(f'<camera name="c" {place} {projection} fovy="2"/><geom size=".4" pos="0 0 .5" material="m"/>',
          asset='<material name="m" specular="1" shininess=".8" rgba=".3 .3 .3 1"/>'), camera="c", since=ortho)
    scene("camera_ortho_skin", skin_xml(visual=free.format(2)), since=ortho)
    for name, sensor in {
        "focal": 'sensorsize=".0064 .0048" focal=".006 .004" resolution="320 240"',
        "principal": 'sensorsize=".0064 .0048" focal=".006 .004" principal="-.001 -.0012" resolution="320 240"',
        "principal_up": 'sensorsize=".0064 .0048" focal=".005 .005" principal=".001 .0007" resolution="320 240"',
        "square": 'sensorsize=".006 .006" focal=".005 .005" resolution="320 240"',
        "wide": 'sensorsize=".01 .004" focal=".005 .006" resolution="640 240"',
        "pixels": 'sensorsize=".0064 .0048" focalpixel="250 150" principalpixel="30 -20" resolution="320 240"',
        "fovy": 'sensorsize=".006 .003" fovy="50" resolution="320 240"',
        "no_resolution": 'sensorsize=".006 .003" focal=".004 .004"',
        "ipd": 'sensorsize=".006 .006" focal=".005 .006" resolution="320 240" ipd=".1"',
    }.items():
        scene(f"camera_intrinsic_{name}", world(f'<camera name="c" {place} {sensor}/>'), camera="c", since=(3, 1, 0))
    scene("camera_intrinsic_horizon", xml(f'{LIGHT}{BODIES}<camera name="c" {place} sensorsize=".006 .006" focal=".004 .007" '
          'principal=".0005 0" resolution="320 240"/><geom type="plane" size="0 0 1" pos="0 0 -.6" material="m"/>',
          asset=CHECKER + SKY + '<material name="m" texture="t" texuniform="true" texrepeat="2 2" reflectance=".3"/>'), camera="c", since=(3, 1, 0))


MESHES = (
    '<mesh name="tetra" vertex="0 0 0 .8 0 0 0 .8 0 0 0 .8" texcoord="0 0 1 0 0 1 1 1" face="0 2 1 0 1 3 0 3 2 1 2 3"/>'
    '<mesh name="plain" vertex="-.4 -.4 -.4 .4 -.4 -.4 .4 .4 -.4 -.4 .4 -.4 -.4 -.4 .4 .4 -.4 .4 .4 .4 .4 -.4 .4 .4"/>'
)
SHAPES = {
    "sphere": '<geom size=".6" material="m" euler="20 30 10"/>',
    "ellipsoid": '<geom type="ellipsoid" size=".7 .4 .5" material="m" euler="20 30 10"/>',
    "capsule": '<geom type="capsule" size=".35 .4" material="m" euler="20 60 10"/>',
    "cylinder": '<geom type="cylinder" size=".5 .4" material="m" euler="40 30 10"/>',
    "box": '<geom type="box" size=".5 .4 .3" material="m" euler="20 30 10"/>',
    "plane": '<geom type="plane" size=".9 .7 .1" material="m" euler="0 0 20"/>',
    "half_plane": '<geom type="plane" size=".9 0 .1" material="m" pos=".1 .2 -.2"/>',
    "infinite_plane": '<geom type="plane" size="0 0 .1" material="m" pos=".1 .2 -.2"/>',
    "mesh_uv": '<geom type="mesh" mesh="tetra" material="m" euler="0 0 200"/>',
    "mesh": '<geom type="mesh" mesh="plain" material="m" euler="20 30 10"/>',
    "hfield": '<geom type="hfield" hfield="h" material="m"/>',
    "sites": '<site type="box" size=".3 .2 .4" pos=".4 .3 0" material="m"/><site type="ellipsoid" size=".3 .2 .4" pos="-.4 -.3 0" material="m"/>',
}


def textures():
    fields = '<hfield name="h" nrow="8" ncol="9" size=".8 .7 .4 .1" elevation="{}"/>'.format(
        " ".join(str((x * x + 3 * y) % 7) for x in range(9) for y in range(8))) if VERSION >= (3, 0, 0) else ""
    for shape, body in SHAPES.items():
        if shape == "hfield" and not fields:
            continue
        for uniform in ("false", "true"):
            for repeat in ("1 1", "2.5 3", ".1 .3"):
                material = f'<material name="m" texture="t" texuniform="{uniform}" texrepeat="{repeat}"/>'
                scene(f"texture_2d_{shape}_{uniform}_{repeat.replace(' ', '_')}", xml(LIGHT + body, asset=MESHES + fields + CHECKER + material))
            material = f'<material name="m" texture="t" texuniform="{uniform}" texrepeat="2 3"/>'
            scene(f"texture_cube_{shape}_{uniform}", xml(LIGHT + body, asset=MESHES + fields + GRADIENT + material))
    for name, repeat in {"zero": "0 0", "negative": "-2 1"}.items():
        material = f'<material name="m" texture="t" texrepeat="{repeat}"/>'
        for shape in ("box", "plane", "mesh_uv", "mesh", "infinite_plane"):
            scene(f"texture_repeat_{name}_{shape}", xml(LIGHT + SHAPES[shape], asset=MESHES + CHECKER + material))
    for repeat in ("1 1", "3 2"):
        material = f'<material name="m" texture="t" texrepeat="{repeat}"/>'
        scene(f"texture_skin_{repeat[0]}", skin_xml(asset=CHECKER + material, material='material="m"', texcoord=True))
        scene(f"texture_flex_{repeat[0]}", flex_xml(2, asset=CHECKER + material, material='material="m"'), since=(3, 0, 0), lookat=(0, 0, .5))
    scene("texture_off", xml(LIGHT + SHAPES["box"], asset=CHECKER + '<material name="m" texture="t"/>'), no_visual="TEXTURE")
    scene("texture_emission", xml(LIGHT + SHAPES["capsule"], asset=CHECKER + '<material name="m" texture="t" emission=".4" specular=".9" shininess=".2"/>'))
    scene("texture_transparent", xml(LIGHT + FLOOR + SHAPES["capsule"], asset=CHECKER + '<material name="m" texture="t" rgba="1 1 1 .4"/>'))
    scene("texture_mirror", xml(LIGHT + BODIES + '<geom type="box" size="1 1 .1" pos="0 0 -.6" material="m"/>',
          asset=CHECKER + '<material name="m" texture="t" texuniform="true" texrepeat="1.5 2" reflectance=".4"/>'))
    layered = '<material name="m"{}><layer role="{}" texture="t"/></material>'
    for role in ("rgb", "rgba", "orm", "normal", "occlusion", "emissive"):
        scene(f"texture_layer_{role}", xml(LIGHT + SHAPES["box"], asset=CHECKER + layered.format("", role)), since=(3, 2, 1))
    scene("texture_layers", xml(LIGHT + SHAPES["box"], asset=CHECKER + '<texture name="n" type="2d" builtin="flat" width="8" height="8" rgb1=".5 .5 1"/>'
          '<material name="m" metallic=".5" roughness=".3"><layer role="rgb" texture="t"/><layer role="normal" texture="n"/></material>'), since=(3, 2, 1))
    scene("texture_srgb", xml(LIGHT + SHAPES["box"], asset=CHECKER.replace("/>", ' colorspace="sRGB"/>') + '<material name="m" texture="t"/>'), since=(3, 3, 0))
    scene("texture_metallic", xml(LIGHT + SHAPES["sphere"], asset='<material name="m" metallic=".9" roughness=".1" rgba=".8 .6 .2 1"/>'), since=(3, 2, 1))
    for channels in (1, 2, 3, 4):
        scene(f"texture_channels_{channels}", xml(LIGHT + SHAPES["plane"], asset=f'<texture name="t" type="2d" file="channels{channels}.png" '
              f'nchannel="{channels}"/><material name="m" texture="t"/>'), since=(3, 2, 0))
    scene("texture_by_reference", xml(LIGHT + SHAPES["plane"], asset='<texture name="t" type="2d" file="channels3.png" embed="false"/>'
          '<material name="m" texture="t"/>'), since=(3, 17, 0))
    scene("texture_reference_cube", xml(LIGHT + SHAPES["box"], asset='<texture name="t" type="cube" file="channels3.png" embed="false"/>'
          '<material name="m" texture="t"/>'), since=(3, 17, 0))


def lights():
    world = lambda text, **kw: xml(text + FLOOR + BODIES, **kw)
    dark = '<headlight active="0"/>'
    for name, light in {
        "spot": '<light pos="1 -1 2" dir="-.5 .5 -1"/>',
        "spot_narrow": '<light pos="1 -1 2" dir="-.5 .5 -1" cutoff="20" exponent="4"/>',
        "spot_attenuated": '<light pos="1 -1 2" dir="-.5 .5 -1" attenuation=".5 .3 .2" ambient=".1 .2 0"/>',
        "directional": '<light directional="true" pos="1 -1 2" dir="-.5 .5 -1"/>',
        "unshadowed": '<light pos="1 -1 2" dir="-.5 .5 -1" castshadow="false"/>',
        "two": '<light pos="1 -1 2" dir="-.5 .5 -1" diffuse=".5 0 0"/><light directional="true" pos="-1 -1 2" dir=".5 .5 -1" diffuse="0 .5 0"/>',
        "none": "",
    }.items():
        scene(f"light_{name}", world(light))
        scene(f"light_{name}_dark", world(light, visual=dark))
    for kind in ("point", "image", "spot", "directional"):
        light = f'<light pos="1 -1 2" dir="-.5 .5 -1" type="{kind}"' + (' texture="sky"/>' if kind == "image" else "/>")
        for castshadow in ("true", "false"):
            for name, visual in {"": "", "_dark": dark}.items():
                scene(f"light_type_{kind}_{castshadow}{name}", world(light.replace("/>", f' castshadow="{castshadow}"/>'),
                      asset=SKY if kind == "image" else "", visual=visual), since=(3, 3, 3))
    scene("light_range", world('<light pos="1 -1 2" dir="-.5 .5 -1" range="1.5" intensity="300" bulbradius=".2"/>'), since=(3, 3, 3))
    scene("light_softness", world('<light pos="1 -1 2" dir="-.5 .5 -1" cutoff="25" softness=".9"/>'), since=(3, 12, 0))
    scene("light_point_first", world('<light pos="1 -1 2" type="point"/><light pos="-1 -1 2" dir=".5 .5 -1"/>', visual=dark), since=(3, 3, 3))
    scene("light_auto", world("", visual='<headlight active="2"/>'), since=(4, 0, 0))
    scene("light_auto_lamp", world(LIGHT, visual='<headlight active="2"/>'), since=(4, 0, 0))
    shadowed = lambda n: "".join(f'<light pos="{1.5 * np.cos(k):.3f} {1.5 * np.sin(k):.3f} 2" dir="{-np.cos(k):.3f} {-np.sin(k):.3f} -1.5" '
                                 'diffuse=".2 .2 .2" specular=".1 .1 .1"/>' for k in range(n))
    for count in (4, 5, 6, 7):
        scene(f"light_shadows_{count}", world(shadowed(count)))
    # OpenGL rejects these values.
    for name, values in {
        "exponent_200": 'exponent="200"', "exponent_negative": 'exponent="-3"', "cutoff_negative": 'cutoff="-5"',
        "attenuation_negative": 'attenuation="-1 .1 .1"', "attenuation_linear_negative": 'attenuation=".5 -.2 .1"',
        "attenuation_all_negative": 'attenuation="-1 -1 -1"',
    }.items():
        scene(f"light_{name}", world(f'<light pos="1 -1 2" dir="-.5 .5 -1" {values}/>', visual=dark))
    scene("light_exponent_first_200", world('<light pos="1 -1 2" dir="-.5 .5 -1" exponent="300"/>'
          '<light pos="-1 -1 2" dir=".5 .5 -1" exponent="5"/>'))
    scene("shadow_in_transparent", xml(LIGHT + FLOOR + '<geom type="box" size=".5 .5 .5" rgba=".3 .4 .9 .3"/><geom size=".25" rgba=".9 .5 .2 1"/>'))
    scene("shadow_in_transparent_sphere", xml('<light directional="true" pos="0 0 3" dir=".2 .1 -1"/>' + FLOOR +
          '<geom size=".6" rgba=".3 .4 .9 .3"/><geom type="box" size=".2 .2 .2" rgba=".9 .5 .2 1"/>'))
    scene("shadow_off_geom", xml(LIGHT + FLOOR + BODIES + '<geom size=".3" pos="0 0 .6" castshadow="false"/>'), since=(4, 0, 0))
    scene("shadow_off_geoms", xml(LIGHT + FLOOR + '<geom size=".3" pos="0 0 .6" castshadow="false"/><geom type="mesh" mesh="plain" castshadow="false"/>'
          '<geom type="box" size=".2 .2 .2" pos=".8 0 0"/>', asset=MESHES), since=(4, 0, 0))
    scene("shadow_plane", xml(LIGHT + FLOOR + '<geom type="plane" size=".5 .5 .1" pos="0 0 .3" euler="10 20 0"/><geom type="plane" size=".4 .4 .1" pos=".5 .5 .2" euler="170 0 0"/>'))
    scene("shadow_wall", xml('<light directional="true" pos="0 0 3" dir=".02 .01 -1"/>' + FLOOR + BODIES + '<geom type="box" size=".05 1 .6" pos="-.8 0 0"/>'))
    scene("shadow_grazing", xml('<light directional="true" pos="-3 0 .3" dir="1 .1 -.05"/>' + FLOOR + BODIES))
    scene("shadow_hfield", xml(LIGHT + SHAPES["hfield"].replace('material="m"', 'rgba=".6 .6 .3 1"') + '<geom size=".2" pos="0 0 .9"/>',
          asset='<hfield name="h" nrow="8" ncol="9" size=".8 .7 .4 .1" elevation="{}"/>'.format(
              " ".join(str((x * x + 3 * y) % 7) for x in range(9) for y in range(8)))), since=(3, 0, 0))
    scene("shadow_small_map", world(LIGHT, visual='<quality shadowsize="256"/>'))
    scene("shadow_clip", world('<light directional="true" pos="0 0 2" dir=".3 .2 -1"/>', visual='<map shadowclip=".3"/>'))
    scene("shadow_scale", world('<light pos="0 0 2" dir=".3 .2 -1" cutoff="40"/>', visual='<map shadowscale=".4"/>'))


def skin_xml(asset="", material='rgba=".3 .6 .8 1"', visual="", texcoord=False):
    number = 5
    points = [(x / 2 - 1, y / 2 - 1, 0.3 * np.sin(x + y)) for x in range(number) for y in range(number)]
    faces = []
    for x in range(number - 1):
        for y in range(number - 1):
            a = x * number + y
            faces += [(a, a + number, a + 1), (a + 1, a + number, a + number + 1)]
    flat = lambda rows: " ".join(str(round(float(part), 5)) for row in rows for part in row)
    coordinates = f'texcoord="{flat([(x / 4, y / 4) for x in range(number) for y in range(number)])}"' if texcoord else ""
    ids = " ".join(str(k) for k in range(len(points)))
    skin = (f'<skin name="s" {material} vertex="{flat(points)}" {coordinates} face="{" ".join(str(k) for face in faces for k in face)}">'
            f'<bone body="b" bindpos="0 0 0" bindquat="1 0 0 0" vertid="{ids}" vertweight="{" ".join(["1"] * len(points))}"/></skin>')
    tag = "deformable" if VERSION >= (3, 0, 0) else "asset"
    return xml(LIGHT + FLOOR + '<body name="b"><freejoint/><geom size=".1"/></body>', asset=asset, visual=visual, more=f"<{tag}>{skin}</{tag}>")


def flex_xml(dim, asset="", material='rgba=".3 .6 .8 1"', radius=".03", more=""):
    count = {1: "8 1 1", 2: "5 5 1", 3: "4 4 4"}[dim]
    cloth = 'texcoord="0 0 0 .25 0 .5 0 .75 0 1 .25 0 .25 .25 .25 .5 .25 .75 .25 1 .5 0 .5 .25 .5 .5 .5 .75 .5 1 .75 0 .75 .25 .75 .5 .75 .75 .75 1 1 0 1 .25 1 .5 1 .75 1 1"'
    texcoord = cloth if dim == 2 and asset else ""
    flex = (f'<flexcomp name="f" type="grid" dim="{dim}" count="{count}" spacing=".2 .2 .2" pos="0 0 .5" euler="30 20 10" mass="1" radius="{radius}" '
            f'{material} {texcoord}><contact selfcollide="none"/>{more}</flexcomp>')
    return xml(LIGHT + FLOOR + flex, asset=asset)


def flexes():
    since = (3, 0, 0)
    at = {"since": since, "lookat": (0, 0, 0.5)}
    for dim in (1, 2, 3):
        text = flex_xml(dim)
        scene(f"flex_{dim}", text, **at)
        scene(f"flex_{dim}_vertices", text, **at, visual="FLEXVERT", no_visual="FLEXSKIN")
        scene(f"flex_{dim}_edges", text, **at, visual="FLEXEDGE", no_visual="FLEXSKIN")
        scene(f"flex_{dim}_faces", text, **at, visual="FLEXFACE", no_visual="FLEXSKIN FLEXEDGE")
        scene(f"flex_{dim}_all", text, **at, visual="FLEXVERT FLEXEDGE FLEXFACE", no_visual="FLEXSKIN")
    scene("flex_3_layer", flex_xml(3), **at, visual="FLEXFACE", no_visual="FLEXSKIN FLEXEDGE", layer=1)
    scene("flex_label", flex_xml(2), **at, label="FLEX")
    scene("flex_transparent", flex_xml(3, material='rgba=".3 .6 .8 .5"'), **at)
    for repeat in ("1 1", "3 2"):
        scene(f"flex_texture_edges_{repeat[0]}", flex_xml(2, asset=CHECKER + f'<material name="m" texture="t" texrepeat="{repeat}"/>',
              material='material="m"'), **at, visual="FLEXEDGE FLEXVERT FLEXFACE", no_visual="FLEXSKIN")
    many = " ".join(["a", "b"] * 16)
    scene("flex_materials", flex_xml(2, asset=CHECKER.replace('"t"', '"u"') + '<material name="a" texture="u" texrepeat="2 2"/><material name="b" rgba="1 .2 .2 1"/>',
          material=f'material="{many}"'), since=(4, 0, 0), lookat=(0, 0, 0.5))


MACHINE = (
    '<body name="base" pos="0 0 .3"><joint name="hinge" axis="0 1 0" range="-60 60" limited="true"/><geom name="arm" type="capsule" fromto="0 0 0 .5 0 0" size=".06"/>'
    '<site name="near" pos=".1 0 .1" size=".03"/><camera name="eye" pos="0 -.3 .3" fovy="40" resolution="64 48" xyaxes="1 0 0 0 .6 1"/><light name="head" pos=".2 0 .3" dir="1 0 -1" diffuse=".2 .2 .2"/>'
    '<body name="fore" pos=".5 0 0"><joint name="ball" type="ball"/><geom name="hand" type="box" size=".1 .15 .05" pos=".15 0 0"/><site name="far" pos=".1 0 .1" size=".03"/></body></body>'
    '<body name="slider" pos="-.6 0 0"><joint name="slide" type="slide" axis="0 0 1"/><geom type="cylinder" size=".1 .1"/><site name="tip" pos="0 0 .15" size=".03" euler="90 0 0"/></body>'
    '<body name="free" pos="-.2 .5 -.39"><freejoint name="free"/><geom name="dropped" size=".2" rgba=".3 .8 .4 1"/></body>'
    '<body name="free2" pos="-.65 .5 -.39"><freejoint/><geom size=".21" rgba=".8 .8 .4 1"/></body>'
    '<body name="marker" mocap="true" pos="0 .9 0"><geom size=".05" contype="0" conaffinity="0"/></body>'
)
MORE = (
    '<tendon><spatial name="string" width=".02"><site site="near"/><site site="far"/></spatial></tendon>'
    '<actuator><motor name="motor" joint="hinge" ctrllimited="true" ctrlrange="-1 1"/><position name="lift" joint="slide"/><motor tendon="string" name="pull"/>'
    '<motor name="push" site="tip" gear="0 0 1 0 0 0"/></actuator>'
    '<sensor><rangefinder site="tip"/></sensor><equality><connect name="pin" body1="fore" anchor=".3 0 0"/><weld body1="marker" body2="free"/></equality>'
)


def decoration():
    text = xml(LIGHT + FLOOR + MACHINE, more=MORE)
    scene("machine", text, steps=20)
    flags = [name[6:] for name in dir(mujoco.mjtVisFlag) if name.startswith("mjVIS_")]
    for flag in flags:
        scene(f"visual_{flag.lower()}", text, steps=20, visual=flag)
        scene(f"visual_no_{flag.lower()}", text, steps=20, no_visual=flag)
    scene("visual_contacts", text, steps=20, visual="CONTACTPOINT CONTACTFORCE CONTACTSPLIT")
    scene("visual_inertia_scaled", text, steps=20, visual="INERTIA SCLINERTIA")
    scene("visual_many", text, steps=20, visual="JOINT ACTUATOR COM CAMERA LIGHT CONSTRAINT AUTOCONNECT TRANSPARENT INERTIA")
    for name in [name[8:] for name in dir(mujoco.mjtLabel) if name.startswith("mjLABEL_")]:
        scene(f"label_{name.lower()}", text, steps=20, visual="JOINT CAMERA LIGHT ACTUATOR CONSTRAINT CONTACTPOINT CONTACTFORCE", label=name)
    for name in [name[8:] for name in dir(mujoco.mjtFrame) if name.startswith("mjFRAME_")]:
        scene(f"frame_{name.lower()}", text, steps=20, visual="CAMERA LIGHT CONTACTPOINT", frame=name)
    scene("label_letters", xml(LIGHT + FLOOR + '<geom name="kleiner Körper é ñ" size=".2"/><geom name="Ω→λ" size=".2" pos=".6 0 0"/>'), label="GEOM")
    scene("visual_frustum", xml(LIGHT + FLOOR + BODIES + '<camera name="c" pos="-1 -1 .5" xyaxes="1 -1 0 .2 .2 1" sensorsize=".0064 .0048" focal=".006 .004" resolution="320 240"/>',
          visual='<scale frustum="1.2"/>'), visual="CAMERA", since=(3, 1, 0))
    projection = 'projection="orthographic"' if VERSION >= (3, 4, 0) else 'orthographic="true"'
    scene("visual_frustum_ortho", xml(LIGHT + FLOOR + BODIES + f'<camera name="c" pos="-1 -1 .5" xyaxes="1 -1 0 .2 .2 1" {projection} fovy=".5" resolution="320 240"/>',
          visual='<scale frustum="1.2"/>'), visual="CAMERA", since=(3, 1, 0))
    scene("visual_frustum_inside", xml(LIGHT + FLOOR + BODIES + '<camera name="c" pos="-1 -1 .5" xyaxes="1 -1 0 .2 .2 1" fovy="60" resolution="320 240"/>'), camera="c", visual="CAMERA", since=(3, 1, 0))
    # The same lines, but not exactly on the near plane of the viewpoint: they are equal.
    scene("visual_frustum_behind", xml(LIGHT + FLOOR + BODIES + "".join(f'<camera name="{name}" pos="{pos}" xyaxes="1 -1 0 .2 .2 1" fovy="60" '
          'resolution="320 240"/>' for name, pos in (("c", "-1 -1 .5"), ("d", "-1.068 -1.068 .527")))), camera="d", visual="CAMERA", since=(3, 1, 0))
    pile = "".join(f'<body pos="{(k % 4) * .45 - .7} {(k // 4) * .6 - .3} {-.48 + .01 * k}"><freejoint/><geom type="box" size=".12 .12 .12"/></body>'
                   f'<body pos="{(k % 4) * .45 - .7} {(k // 4) * .6 - .3} {-.22 + .01 * k}"><freejoint/><geom size=".12"/></body>' for k in range(8))
    if VERSION >= (3, 0, 0):
        scene("islands", xml(LIGHT + FLOOR + pile, options='timestep=".002"'), visual="ISLAND", steps=60)
        scene("islands_contacts", xml(LIGHT + FLOOR + pile), visual="ISLAND CONTACTPOINT", steps=60, label="ISLAND")
    if VERSION >= (3, 5, 0):
        asleep = xml(LIGHT + FLOOR + pile, more='<option><flag sleep="enable"/></option>')
        scene("sleeping", asleep, steps=400)
        scene("sleeping_islands", asleep, visual="ISLAND", steps=400)
    scene("bounding_volumes", xml(LIGHT + FLOOR + SHAPES["mesh"].replace('material="m"', "") + '<body pos="0 0 .6"><freejoint/><geom size=".1"/><geom size=".1" pos=".4 0 0"/></body>', asset=MESHES),
          visual="BODYBVH MESHBVH", depth=1, since=(3, 1, 1))
    scene("site_mesh", xml(LIGHT + FLOOR + '<site type="mesh" mesh="tetra" rgba=".9 .4 .2 1"/>', asset=MESHES), since=(3, 13, 0))
    scene("transparent_stack", xml(LIGHT + FLOOR + "".join(f'<geom size=".25" pos="{.3 * k - .6} {.2 * k} {.1 * k}" rgba="{.2 * k} .5 .8 .5"/>' for k in range(5))))
    scene("ellipsoid_inertia", xml(LIGHT + FLOOR + MACHINE, visual='<global ellipsoidinertia="true"/>'), visual="INERTIA", steps=20, since=(3, 2, 5))
    if VERSION >= (3, 4, 0):
        scene("rangefinder_camera", xml(LIGHT + FLOOR + MACHINE, more='<sensor><rangefinder camera="eye" data="point"/></sensor>'), steps=20, since=(3, 5, 0))
        # The same 2,357 spheres with as few vertices as the coarse level of small ones.
        scene("rangefinder_coarse", xml(LIGHT + FLOOR + MACHINE, more='<sensor><rangefinder camera="eye" data="point"/></sensor>', visual='<quality numslices="14" numstacks="6"/>'),
              steps=20, since=(3, 5, 0), no_render="SHADOW")


def effects():
    sky = xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6" material="m"/>',
              asset=CHECKER + SKY + '<material name="m" texture="t" texuniform="true" texrepeat="2 2" reflectance=".3"/>', visual='<map fogstart="1" fogend="4"/><rgba fog=".7 .5 .3 1"/>')
    for flag in ("SHADOW", "REFLECTION", "SKYBOX", "HAZE", "CULL_FACE"):
        scene(f"render_no_{flag.lower()}", sky, no_render=flag)
    for flag in ("WIREFRAME", "ADDITIVE", "FOG", "SEGMENT"):
        scene(f"render_{flag.lower()}", sky, render=flag, no_render="SHADOW" if flag == "WIREFRAME" else "")
    # The reflector is added to its mirror image once for each of the polygons that share an edge,
    # if rounding does not hide the second: without a mirror the lines are equal.
    scene("render_matt_wireframe", sky.replace('reflectance=".3"', ""), render="WIREFRAME", no_render="SHADOW")
    scene("render_idcolor", sky, render="SEGMENT IDCOLOR")
    scene("mirror_transparent", xml(LIGHT + BODIES + '<geom size=".3" pos="0 0 .5" rgba=".3 .9 .3 .5"/><geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>',
          asset='<material name="m" reflectance=".6"/>'))
    scene("mirror_point_light", xml('<light pos="1 -1 2" type="point"/>' + LIGHT + BODIES + '<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>',
          asset='<material name="m" reflectance=".6"/>'), since=(3, 3, 3))
    scene("plane_from_behind", xml(LIGHT + BODIES + FLOOR), free=(140.0, 30.0, 3.0))
    scene("sdf", xml(LIGHT + FLOOR + '<geom type="sdf" mesh="plain" rgba=".8 .4 .2 1"/>', asset=MESHES), since=(3, 3, 0))


def sources():
    """Textures of every kind on every shape, and their images."""
    fields = HFIELD if VERSION >= (3, 0, 0) else ""
    for shape in ("sphere", "box", "plane", "infinite_plane", "mesh_uv", "mesh", "hfield", "capsule", "sites"):
        if shape != "hfield" or fields:
            scene(f"skybox_on_{shape}", xml(LIGHT + SHAPES[shape], asset=MESHES + fields + SKY + '<material name="m" texture="sky" texrepeat="2 3"/>'))
    material = '<material name="m" texture="t" texrepeat="2 2"/>'
    scene("texture_cube_skin", skin_xml(asset=GRADIENT + material, material='material="m"', texcoord=True))
    # In shadow maps the engine draws a skin without coordinates with those of what it drew before.
    plain = lambda asset: skin_xml(asset=asset + material, material='material="m"').replace('castshadow="true"', 'castshadow="false"')
    scene("texture_cube_skin_plain", plain(GRADIENT))
    scene("texture_2d_skin_plain", plain(CHECKER))
    for dim in (1, 2, 3):
        for kind, asset in {"2d": CHECKER, "cube": GRADIENT}.items():
            scene(f"texture_{kind}_flex_{dim}", flex_xml(dim, asset=asset + material, material='material="m"'), since=(3, 0, 0), lookat=(0, 0, 0.5))
    file = lambda kind, more: f'<texture name="t" type="{kind}" {more}/>'
    for name, texture in {
        "flips": file("2d", 'file="channels3.png" hflip="true"'), "vflip": file("2d", 'file="channels3.png" vflip="true"'),
        "cube": file("cube", 'file="channels3.png"'),
        "cube_sides": file("cube", 'fileright="channels3.png" fileup="channels1.png" rgb1=".2 .5 .3"'),
        "grid": file("cube", 'file="channels3.png" gridsize="2 2" gridlayout="RLUD"'),
        "random": file("2d", 'builtin="flat" mark="random" random=".1" width="32" height="32" rgb1=".3 .5 .7" markrgb="1 0 0"'),
        "edge": file("2d", 'builtin="gradient" mark="edge" width="31" height="17" rgb1=".3 .5 .7" rgb2=".9 .2 .2" markrgb="1 1 0"'),
        "cube_flat": file("cube", 'builtin="flat" mark="edge" width="32" height="192" rgb1=".3 .5 .7" rgb2=".9 .2 .2" markrgb="1 1 0"'),
        "tiny": file("2d", 'builtin="checker" width="2" height="2" rgb1=".3 .5 .7" rgb2=".9 .2 .2"'),
        "cube_srgb": file("cube", 'file="channels3.png" colorspace="sRGB"'),
    }.items():
        scene(f"texture_file_{name}", xml(LIGHT + SHAPES["box"] + '<geom type="plane" size="2 2 .1" pos="0 0 -.7" material="m"/>', asset=texture + '<material name="m" texture="t"/>'))
    scene("texture_alpha_shadow", xml(LIGHT + FLOOR + '<geom type="box" size=".3 .3 .3" material="m"/>', asset=file("2d", 'file="channels4.png" nchannel="4"')
          + '<material name="m" texture="t" rgba="1 1 1 .9"/>'), since=(3, 2, 0))
    scene("skybox_file", xml(LIGHT + BODIES, asset='<texture type="skybox" file="channels3.png"/>'))
    scene("skybox_marked", xml(LIGHT + BODIES, asset='<texture type="skybox" builtin="checker" rgb1=".2 .3 .4" rgb2=".4 .6 .8" mark="cross" markrgb="1 1 1" width="32" height="192"/>'), free=(40.0, 20.0, 3.0))
    scene("skybox_ortho", xml(LIGHT + BODIES, asset=SKY, visual='<global orthographic="true" fovy="3"/>'), since=(3, 1, 0), free=(40.0, -5.0, 3.0))
    scene("skybox_wide", xml(LIGHT + BODIES, asset=SKY, visual='<global fovy="120"/>'), free=(40.0, 30.0, 3.0))


HFIELD = '<hfield name="h" nrow="8" ncol="9" size=".8 .7 .4 .1" elevation="{}"/>'.format(" ".join(str((x * x + 3 * y) % 7) for x in range(9) for y in range(8)))
TENDONS = (
    '<site name="a" pos="-.9 0 .6"/><site name="b" pos=".3 0 .1"/><site name="e" pos="1 0 -.1"/><site name="side" pos="0 0 .9"/><site name="f" pos=".4 .5 .3"/>'
    '<geom name="w" size=".25" pos="-.2 0 .4" rgba=".4 .7 .4 .5"/><geom name="v" type="cylinder" size=".15 .3" pos=".6 0 .05" euler="90 0 0" rgba=".4 .4 .8 1"/>'
    '<body name="s" pos="0 .7 .2"><joint name="sl" type="slide" axis="0 0 1" range="-.2 .2" limited="true"/><geom size=".1"/><site name="g" pos="-.1 0 0"/></body>'
)


def tendons():
    strings = lambda more, less="": (
        f'<tendon><spatial name="wrap" width=".02" rgba=".9 .3 .1 1" {more}><site site="a"/><geom geom="w" sidesite="side"/><site site="b"/><geom geom="v"/><site site="e"/></spatial>'
        f'<spatial name="pulley" width=".015" {less}><site site="a"/><site site="f"/><pulley divisor="2"/><site site="f"/><site site="g"/><pulley divisor="2"/><site site="b"/><site site="g"/></spatial></tendon>'
    )
    scene("tendon_wrap", xml(LIGHT + FLOOR + TENDONS, more=strings("")))
    scene("tendon_material", xml(LIGHT + FLOOR + TENDONS, asset=CHECKER + '<material name="m" texture="t" texrepeat="3 3"/>', more=strings('material="m"')))
    scene("tendon_limited", xml(LIGHT + FLOOR + TENDONS, more=strings('limited="true" range="0 1"', 'limited="true" range="5 6"')), visual="CONSTRAINT", steps=3)
    slack = '<tendon><spatial width=".02" limited="true" range="0 {}" rgba=".2 .3 .9 1"><site site="a"/><site site="b"/></spatial><spatial limited="true" range="0 2"><site site="f"/><site site="g"/></spatial></tendon>'
    for length in (1.4, 2, 3):
        scene(f"tendon_slack_{length}", xml(LIGHT + FLOOR + TENDONS, more=slack.format(length)))
    scene("tendon_off", xml(LIGHT + FLOOR + TENDONS, more=strings("")), no_visual="TENDON")
    drives = '<actuator><motor tendon="wrap" ctrlrange="-1 1" ctrllimited="true"/><muscle tendon="pulley"/><position joint="sl" ctrlrange="-1 1"/></actuator>'
    for ctrl in (-1.0, 0.0, 0.3, 1.0):
        scene(f"tendon_actuated_{ctrl}", xml(LIGHT + FLOOR + TENDONS, more=strings("") + drives), visual="ACTUATOR ACTIVATION JOINT", ctrl=[ctrl] * 3, steps=5)
        scene(f"tendon_active_{ctrl}", xml(LIGHT + FLOOR + TENDONS, more=strings("") + drives), no_visual="ACTUATOR", visual="ACTIVATION", ctrl=[ctrl] * 3, steps=5)


def settings():
    """Visual settings of a model."""
    vis = mujoco.MjModel.from_xml_string("<mujoco/>").vis
    names = lambda part: [name for name in dir(part) if not name.startswith("_")]
    everything = "JOINT ACTUATOR COM CAMERA LIGHT CONSTRAINT AUTOCONNECT INERTIA CONTACTPOINT CONTACTFORCE CONTACTSPLIT RANGEFINDER ACTIVATION"
    colours = " ".join(f'{name}="{(37 * k % 10) / 10} {(53 * k % 10) / 10} {(71 * k % 10) / 10} {1 if k % 3 and name != "inertia" else 0.6}"' for k, name in enumerate(names(vis.rgba)))
    scales = " ".join(f'{name}="{float(getattr(vis.scale, name)) * (1.4 if k % 2 else 0.6):.4g}"' for k, name in enumerate(names(vis.scale)))
    text = lambda visual: xml(LIGHT + FLOOR + MACHINE, more=MORE, visual=visual)
    for name, visual in {
        "rgba": f"<rgba {colours}/>", "scale": f"<scale {scales}/>", "map": '<map stiffness="300" force=".02" torque=".3" alpha=".6" actuatortendon="4"/>',
        "linewidth": '<global linewidth="4"/>', "glow": '<global glow=".9"/>', "alpha": '<map alpha=".1"/>',
    }.items():
        scene(f"settings_{name}", text(visual), visual=everything + (" TRANSPARENT" if name == "alpha" else ""), steps=20)
    # Debian's llvmpipe draws the depth of lines half a pixel aside, if it has several samples per
    # pixel: without, the lines are equal.
    scene("settings_rgba_one_sample", text(f'<rgba {colours}/><quality offsamples="0"/>'), visual=everything, steps=20)
    scene("settings_fovy", text('<global fovy="80"/>'))
    scene("settings_near", text('<map znear=".8" zfar="2"/>'))
    scene("settings_near_far", text('<map znear=".0005" zfar="500"/>'))
    scene("settings_headlight", text('<headlight ambient=".5 .1 .1" diffuse="0 .5 .2" specular="1 1 1"/>'))
    for name, quality in {
        "coarse": 'numslices="5" numstacks="3" numquads="2"', "fine": 'numslices="90" numstacks="70" numquads="9"', "samples_0": 'offsamples="0"', "samples_8": 'offsamples="8"',
        "shadow_0": 'shadowsize="0"', "shadow_100": 'shadowsize="100"', "shadow_8192": 'shadowsize="8192"',
    }.items():
        scene(f"settings_quality_{name}", text(f"<quality {quality}/>"))
    for width, height in ((320, 60), (60, 240), (321, 243), (97, 53)):
        scene(f"size_{width}_{height}", text(""), size=[width, height])
        scene(f"size_{width}_{height}_sensor", xml(f'{LIGHT}{FLOOR}{BODIES}<camera name="c" pos="1.6 -1.8 1.4" xyaxes="1.8 1.6 0 -.75 .85 1.6" sensorsize=".006 .004" focal=".005 .004" resolution="320 240"/>'),
              camera="c", size=[width, height], since=(3, 1, 0))


def views():
    """Cameras that move, and what else a program chooses."""
    moving = MACHINE.replace('<geom name="hand"', '<camera name="m" mode="{}" {} pos="-.5 -1.2 .8" xyaxes="1 .2 0 -.1 .5 1"/><geom name="hand"')
    for mode in ("fixed", "track", "trackcom", "targetbody", "targetbodycom"):
        target = 'target="slider"' if "target" in mode else ""
        scene(f"camera_mode_{mode}", xml(LIGHT + FLOOR + moving.format(mode, target), more=MORE), camera="m", steps=20)
    lights = MACHINE.replace('<geom name="hand"', '<light mode="{}" {} pos="-.5 -.2 .8" dir="1 0 -1"/><geom name="hand"')
    for mode in ("fixed", "track", "trackcom", "targetbody", "targetbodycom"):
        target = 'target="slider"' if "target" in mode else ""
        scene(f"light_mode_{mode}", xml(FLOOR + lights.format(mode, target), more=MORE), steps=20)
    text = xml(LIGHT + FLOOR + MACHINE, more=MORE)
    scene("camera_tracking", text, steps=20, track="fore")
    scene("camera_ortho_tracking", xml(LIGHT + FLOOR + MACHINE, more=MORE, visual='<global orthographic="true" fovy="2"/>'), steps=20, track="fore", since=(3, 1, 0))
    view = '<global azimuth="30" elevation="-60" {}/>'
    scene("camera_default", xml(LIGHT + FLOOR + MACHINE, more=MORE, visual=view.format("")), default=True)
    scene("camera_default_ortho", xml(LIGHT + FLOOR + MACHINE, more=MORE, visual=view.format('orthographic="true" fovy="2.5"')), default=True, since=(3, 1, 0))
    for elevation in (-90.0, -60.0, 0.0, 90.0):
        for kind, visual in {"": "", "ortho_": '<global orthographic="true" fovy="2.5"/>'}.items():
            scene(f"camera_free_{kind}{elevation:.0f}", xml(LIGHT + FLOOR + MACHINE, more=MORE, visual=visual), free=(-70.0, elevation, 2.5), lookat=(0.1, 0.2, 0.3),
                  since=(3, 1, 0) if visual else (2, 2, 2))
    for body in ("base", "fore", "free"):
        for active in (0, 1, 2, 3):
            scene(f"perturb_{body}_{active}", text, steps=20, visual="PERTFORCE PERTOBJ SELECT", perturb={"body": body, "active": active})
    scene("perturb_label", text, steps=20, visual="SELECT", label="SELECTION", perturb={"body": "fore", "active": 0})
    for category in (1, 2, 4, 6):
        scene(f"category_{category}", text, steps=20, visual="JOINT COM", categories=category)
    grouped = xml(LIGHT + FLOOR + "".join(f'<geom group="{k}" size=".15" pos="{.4 * k - 1} 0 0"/><site group="{k}" type="box" size=".1 .1 .1" pos="{.4 * k - 1} .5 0"/>' for k in range(6)))
    for k in range(3):
        scene(f"groups_{k}", grouped, groups={"geomgroup": [(k + i) % 2 for i in range(6)], "sitegroup": [(k + i) % 3 % 2 for i in range(6)]})
    scene("transform", text, steps=20, transform={"translate": [0.1, 0.2, -0.3], "rotate": [0.96, 0.0, 0.0, 0.28], "scale": 1.5})
    scene("transform_small", text, steps=20, visual="CONTACTFORCE JOINT", transform={"translate": [0.1, 0.5, 0.3], "rotate": [0.8, 0.6, 0.0, 0.0], "scale": 0.7})
    scene("transform_sky", xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6" material="m"/>', asset=CHECKER + SKY +
          '<material name="m" texture="t" texuniform="true" texrepeat="2 2" reflectance=".3"/>'), transform={"translate": [0.0, 0.0, 0.2], "rotate": [1.0, 0.0, 0.0, 0.0], "scale": 1.5})
    shapes = [
        {"kind": "SPHERE", "size": [0.2, 0.2, 0.2], "pos": [0.5, 0.5, 0]}, {"kind": "CAPSULE", "size": [0.1, 0.2, 0.2], "pos": [-0.5, 0.5, 0]},
        {"kind": "ELLIPSOID", "size": [0.1, 0.2, 0.3], "pos": [0.5, -0.5, 0]}, {"kind": "CYLINDER", "size": [0.2, 0.1, 0.1], "pos": [-0.5, -0.5, 0]},
        {"kind": "BOX", "size": [0.1, 0.2, 0.1], "pos": [0, 0, 0]}, {"kind": "PLANE", "size": [0.3, 0.2, 0], "pos": [0, 0.8, 0.2]},
        {"kind": "MESH", "size": [0, 0, 0], "pos": [0, 0, 0.4]},
    ]
    lines = [{"kind": kind, "size": [0.04], "from": [x, -0.7, 0.2], "to": [x + 0.2, 0.3, 0.7]} for kind, x in
             (("CAPSULE", -0.9), ("CYLINDER", -0.5), ("ARROW", -0.1), ("ARROW1", 0.3), ("ARROW2", 0.7), ("LINE", 1.0))]
    for alpha in (1.0, 0.5):
        for name, geoms in {"shapes": shapes, "lines": lines}.items():
            colour = [0.9, 0.6, 0.2, alpha]
            scene(f"decor_{name}_{alpha}", xml(LIGHT + FLOOR, asset=MESHES), decor=[{**geom, "rgba": colour} for geom in geoms])
            scene(f"decor_{name}_{alpha}_dynamic", xml(LIGHT + FLOOR, asset=MESHES), decor=[{**geom, "rgba": colour, "category": 2} for geom in geoms])


def surfaces():
    """Shapes, materials, mirrors and lights that the parts above leave out."""
    concave = '<mesh name="star" vertex="{}" {}/>'.format(" ".join(f"{r * np.cos(k):.4f} {r * np.sin(k):.4f} {z}" for z in (-0.2, 0.2) for k, r in ((i * np.pi / 5, 0.6 if i % 2 else 0.25) for i in range(10))), "{}")
    side = " ".join(f"{i} {(i + 1) % 10} {i + 10} {(i + 1) % 10} {(i + 1) % 10 + 10} {i + 10}" for i in range(10))
    faces = side + " " + " ".join(f"{(i + 1) % 10} {i} 20 {i + 10} {(i + 1) % 10 + 10} 21" for i in range(10))
    star = concave.format(f'face="{faces}"').replace('" face', ' 0 0 -.2 0 0 .2" face')
    world = xml(LIGHT + FLOOR + '<geom type="mesh" mesh="star" rgba=".8 .5 .2 1" euler="50 20 0"/>', asset=star)
    scene("mesh_star", world)
    scene("mesh_hull", world, visual="CONVEXHULL")
    scene("mesh_smooth", xml(LIGHT + FLOOR + '<geom type="mesh" mesh="star" rgba=".8 .5 .2 1" euler="50 20 0"/>', asset=star.replace("<mesh", '<mesh smoothnormal="true"')))
    scene("mesh_mirrored", xml(LIGHT + FLOOR + '<geom type="mesh" mesh="star" rgba=".8 .5 .2 1" euler="50 20 0"/>', asset=star.replace("<mesh", '<mesh scale="1 -1.2 .8"')))
    scene("mesh_cube", xml(LIGHT + FLOOR + '<geom type="mesh" mesh="star" material="m" euler="50 20 0"/>', asset=star + GRADIENT + '<material name="m" texture="t"/>'))
    scene("mesh_fitted", xml(LIGHT + FLOOR + '<geom type="capsule" mesh="star" material="m" euler="50 20 0"/>', asset=star + CHECKER + '<material name="m" texture="t"/>'))
    for shape, name, uniform in (("capsule", "tetra", "true"), ("box", "tetra", "false"), ("ellipsoid", "plain", "true"), ("cylinder", "tetra", "false")):
        scene(f"mesh_fitted_{shape}_{name}", xml(LIGHT + FLOOR + f'<geom type="{shape}" mesh="{name}" material="m" euler="50 20 0"/>', asset=MESHES + CHECKER
              + f'<material name="m" texture="t" texrepeat="2.5 3" texuniform="{uniform}"/>'))
    scene("mesh_volume", world, visual="MESHBVH BODYBVH", depth=2)
    for name, params in {"sphere": "2", "hemisphere": "6", "cone": "9 .3", "supersphere": "12 .4 1.5", "supertorus": "18 .3 .6 1.2", "wedge": "6 5 90 50 .3", "plate": "4 5"}.items():
        scene(f"mesh_builtin_{name}", xml(LIGHT + FLOOR + '<geom type="mesh" mesh="b" material="m"/>', asset=f'<mesh name="b" builtin="{name}" params="{params}" scale=".5 .5 .5"/>' + CHECKER
              + '<material name="m" texture="t" texrepeat="2 3"/>'), since=(3, 3, 6))
    balls = lambda material: "".join(f'<geom size=".2" pos="{.5 * k - 1} 0 0" material="m{k}"/>' for k in range(5))
    for name, values in {"emission": (0, 0.3, 0.7, 1, 2), "specular": (0, 0.2, 0.5, 0.8, 1), "shininess": (0, 0.1, 0.4, 0.8, 1), "reflectance": (0, 0.1, 0.5, 0.8, 1)}.items():
        scene(f"material_{name}", xml(LIGHT + FLOOR + balls(""), asset="".join(f'<material name="m{k}" rgba=".6 .4 .3 1" {name}="{value}"/>' for k, value in enumerate(values))))
    scene("material_alpha", xml(LIGHT + FLOOR + "".join(f'<geom size=".25" pos="{.4 * k - 1} 0 {.1 * k}" rgba=".9 .5 .2 {value}"/>' for k, value in enumerate((0, 0.01, 0.3, 0.99, 0.995, 1)))))
    mirror = lambda geoms, reflectance, visual="", more="": xml(LIGHT + BODIES + geoms, asset=CHECKER + SKY + f'<material name="m" reflectance="{reflectance}" rgba=".5 .5 .6 1"/><material name="n" texture="t" texrepeat="3 3" reflectance=".6"/>' + more, visual=visual)
    box = '<geom type="box" size="1 1 .05" pos="0 0 -.7" euler="10 20 30" material="m"/>'
    scene("mirror_tilted_box", mirror(box, 0.7))
    scene("mirror_two", mirror('<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/><geom type="plane" size="1 1 1" pos="0 1 .4" euler="90 0 0" material="m"/>', 0.6))
    scene("mirror_full", mirror('<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>', 1))
    scene("mirror_below", mirror('<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>', 0.5), free=(140.0, 30.0, 3.0))
    scene("mirror_infinite", mirror('<geom type="plane" size="0 0 1" pos="0 0 -.6" material="n"/>', 0.5))
    scene("mirror_half_infinite", mirror('<geom type="plane" size="0 1 1" pos="0 0 -.6" material="n"/>', 0.5))
    scene("mirror_faint", mirror('<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m" rgba=".5 .6 .7 .6"/>', 0.5))
    scene("mirror_fog", mirror('<geom type="plane" size="0 0 1" pos="0 0 -.6" material="m"/>', 0.5, visual='<map fogstart="1" fogend="3"/>'), render="FOG")
    scene("mirror_vertical", mirror('<geom type="plane" size="1 1 1" pos="-.8 0 0" euler="0 90 0" material="m"/>' + FLOOR, 0.6))
    scene("mirror_wireframe", mirror('<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>', 0.5), render="WIREFRAME", no_render="SHADOW")
    scene("mirror_skin", skin_xml(asset='<material name="m" reflectance=".5"/>').replace('<geom name="floor"', '<geom name="floor" material="m"'))
    scene("mirror_flex", flex_xml(3, asset='<material name="m" reflectance=".5"/>').replace('<geom name="floor"', '<geom name="floor" material="m"'), since=(3, 0, 0), lookat=(0, 0, 0.5))
    scene("fog_transparent", xml(LIGHT + FLOOR + BODIES + '<geom size=".4" pos="0 0 .3" rgba=".3 .9 .3 .4"/>', asset=SKY, visual='<map fogstart="1" fogend="2.5"/><rgba fog=".7 .2 .2 1"/>'), render="FOG")
    # Fog that ends before it starts, or where it starts.
    for name, start, end in (("reversed", 1.6, 1.4), ("reversed_wide", 2, 1), ("equal", 1.25, 1.25), ("none", 0, 0)):
        scene(f"fog_{name}", xml(LIGHT + FLOOR + BODIES, asset=SKY,
              visual=f'<map fogstart="{start}" fogend="{end}"/><rgba fog=".7 .2 .2 1"/>'), render="FOG")
    scene("alpha_negative", xml(LIGHT + FLOOR + BODIES + '<geom size=".3" pos="0 0 .5" rgba=".9 .5 .2 -1"/>'))
    for haze in (0, 0.1, 0.8, 1.3, 2):
        # Haze beyond the camera overlaps itself. The depth buffer of engines before 3.0.1 separates
        # the layers only if the near plane is not too near.
        near = ' znear=".1"' if haze > 1 else ""
        scene(f"haze_{haze}", xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6"/>', asset=SKY, visual=f'<map haze="{haze}"{near}/><rgba haze=".9 .8 .6 1"/>'), free=(140.0, -5.0, 3.0))
    scene("haze_coarse", xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6"/>', asset=SKY,
          visual='<quality numslices="5"/><map haze=".4"/><rgba haze=".9 .8 .6 1"/>'), free=(140.0, -5.0, 3.0), lookat=(0.0, 0.0, 2.0))
    scene("haze_tilted", xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6" euler="10 0 0"/>', asset=SKY), free=(140.0, -5.0, 3.0))
    scene("haze_two_planes", xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6"/><geom type="plane" size="0 0 1" pos="0 -4 0" euler="-90 0 0" rgba=".5 .3 .3 1"/>', asset=SKY), free=(140.0, -5.0, 3.0))
    for name, light in {
        "down": '<light pos="0 0 2" dir="0 0 -1"/>', "down_directional": '<light directional="true" pos="0 0 2" dir="0 0 -1"/>', "wide": '<light pos="0 0 1" dir="0 0 -1" cutoff="90"/>',
        "all_round": '<light pos="0 0 1" dir="0 0 -1" cutoff="180"/>', "inside": '<light pos=".5 .3 .1" dir="0 0 -1"/>', "bright": '<light pos="1 -1 2" dir="-.5 .5 -1" diffuse="3 3 3" ambient="1 0 0"/>',
        "exponent": '<light pos="1 -1 2" dir="-.5 .5 -1" exponent="100" cutoff="60"/>', "inactive": '<light pos="1 -1 2" dir="-.5 .5 -1" active="false"/>', "up": '<light pos="0 0 -2" dir="0 0 1"/>',
        "dark_attenuated": '<light pos="1 -1 2" dir="-.5 .5 -1" attenuation="0 1 0"/>', "horizontal": '<light directional="true" pos="2 0 0" dir="-1 0 0"/>',
        "eleven": "".join(f'<light pos="{np.cos(k):.3f} {np.sin(k):.3f} 2" dir="0 0 -1" diffuse=".1 .1 .1" castshadow="false"/>' for k in range(11)),
        "coloured_shadows": "".join(f'<light directional="true" pos="0 0 3" dir="{np.cos(2 * k):.3f} {np.sin(2 * k):.3f} -1" diffuse="{" ".join(".5" if i == k else "0" for i in range(3))}"/>' for k in range(3)),
    }.items():
        scene(f"lamp_{name}", xml(light + FLOOR + BODIES))
    # The same floor with shadow maps that are small enough not to be reduced, and with a geom behind it, for which it is in the maps: it is equal.
    scene("lamp_shadows_unreduced", next(row for row in SCENES if row["name"] == "lamp_coloured_shadows")["xml"].replace("<visual>", '<visual><quality shadowsize="1024"/>'), decor=[{"kind": "SPHERE", "size": [0.1, 0.1, 0.1], "pos": [4, 0, -2], "rgba": [1, 1, 1, 1]}])
    # The engine adds a light with a shadow map once for each of the surfaces that coincide.
    lit = LIGHT.replace('castshadow="true"', 'castshadow="false"')
    pairs = ('material="m"', 'rgba=".9 .5 .2 1"', 'material="n"')
    for order in (pairs, pairs[::-1], (pairs[1], pairs[0], pairs[2])):
        scene(f"coincident_{pairs.index(order[0])}_{pairs.index(order[2])}", xml(lit + FLOOR + "".join(
              f'<geom type="box" size=".3 .3 .3" pos="-.5 0 0" {look}/><geom size=".3" pos=".4 0 0" {look}/><geom type="mesh" mesh="plain" pos="0 .8 0" {look}/>' for look in order),
              asset=MESHES + CHECKER + '<texture name="u" type="cube" builtin="flat" width="8" height="48" rgb1=".2 .8 .4"/><material name="m" texture="t"/><material name="n" texture="u"/>'))
    scene("coincident_decor", xml(lit + FLOOR + '<body><freejoint/><geom type="box" size=".3 .2 .3" rgba=".9 .5 .2 1"/></body>', visual='<rgba inertia=".2 .8 .9 1"/>'), visual="INERTIA")
    line = lambda y, z: {"kind": "LINE", "size": [3], "from": [-0.9, y, z], "to": [0.9, y, z], "rgba": [0.25, 0.2, 0.1, 1.0]}
    for count in (0, 1, 2, 6):
        lamps = "".join(f'<light pos="{k / 2 - 1} -1 3" dir="{(1 - k / 2) / 3} .3 -1" diffuse=".3 .3 .3"/>' for k in range(count))
        scene(f"lines_shadows_{count}", xml(lamps + FLOOR + BODIES + '<geom type="box" size=".4 .4 .02" pos="0 0 .8"/>'), decor=[line(-0.6, -0.2), line(0, 0.5), line(0.4, -0.3)])
    # Opaque decoration casts no shadow, and receives the plate's.
    thick = [{"kind": "ARROW", "size": [0.12], "from": [-0.8, -0.5, -0.3], "to": [0.6, -0.2, -0.1], "rgba": [0.9, 0.5, 0.2, 1.0]},
             {"kind": "CAPSULE", "size": [0.15], "from": [-0.5, 0.4, -0.3], "to": [0.7, 0.3, 0.1], "rgba": [0.3, 0.7, 0.9, 1.0]}]
    scene("decor_in_shadow", xml(LIGHT + FLOOR + '<geom type="box" size=".5 .6 .02" pos=".3 -.4 .9"/>'), decor=thick)
    scene("lines_fog", xml(LIGHT + FLOOR + BODIES, visual='<map fogstart="1" fogend="4"/><rgba fog=".2 .3 .5 1"/>'), decor=[line(-0.6, -0.2), line(0, 0.5)], render="FOG")
    scene("shadow_transparent", xml(LIGHT + FLOOR + '<geom size=".3" rgba=".3 .9 .3 .4"/><geom type="box" size=".2 .2 .2" pos=".7 0 0" rgba=".9 .2 .2 .99"/>'))
    scene("shadow_skin", skin_xml().replace("castshadow", 'name="l2" castshadow').replace('name="lamp" ', ""))
    scene("shadow_mesh", xml(LIGHT + FLOOR + '<geom type="mesh" mesh="star" rgba=".8 .5 .2 1" euler="50 20 0"/>', asset=star), no_render="CULL_FACE")
    scene("shadow_sites", xml(LIGHT + FLOOR + SHAPES["sites"].replace('material="m"', "")))
    machine = xml(LIGHT + FLOOR + MACHINE, more=MORE, asset=SKY)
    scene("wireframe_machine", machine, steps=20, render="WIREFRAME", no_render="SHADOW", visual="CONTACTPOINT CONTACTFORCE JOINT")
    scene("wireframe_star", world, render="WIREFRAME", no_render="SHADOW")
    scene("wireframe_hfield", xml(LIGHT + SHAPES["hfield"].replace('material="m"', ""), asset=HFIELD), render="WIREFRAME", no_render="SHADOW", since=(3, 0, 0))
    scene("wireframe_skin", skin_xml(), render="WIREFRAME", no_render="SHADOW")
    scene("wireframe_flex", flex_xml(2), render="WIREFRAME", no_render="SHADOW", since=(3, 0, 0), lookat=(0, 0, 0.5))
    scene("additive", machine, steps=20, render="ADDITIVE", visual="TRANSPARENT")
    scene("both_sides", xml(LIGHT + FLOOR + BODIES + '<geom type="mesh" mesh="tetra"/>', asset=MESHES), no_render="CULL_FACE", camera=None, lookat=(0.3, 0.3, 0.2), free=(140.0, -25.0, 0.4))
    scene("inside_box", xml(LIGHT + '<geom type="box" size="1 1 1"/><geom size=".2"/>'), free=(140.0, -25.0, 0.8))
    # Thin plates on a floor, from afar: the depth buffer must separate their surfaces.
    for name, asset in {"": "", "_mirror": '<material name="m" reflectance=".3" rgba=".5 .6 .5 1"/>'}.items():
        plane = '<geom type="plane" size="3 3 1" material="m"/>' if asset else FLOOR.replace("-.6", "0")
        scene(f"distant_plates{name}", xml(LIGHT + plane + "".join(f'<geom type="box" size=".5 .5 {h}" pos="{1.2 * k - 1.2} 0 {h}" rgba=".9 {.3 * k} .1 1"/>' for k, h in enumerate((0.0005, 0.001, 0.002))),
              asset=asset, visual='<global fovy="6"/>'), free=(90.0, -60.0, 40.0), since=(3, 0, 1))
    scene("flat_skin", flex_xml(3).replace("<flexcomp", '<flexcomp flatskin="true"'), since=(3, 0, 0), lookat=(0, 0, 0.5))
    scene("skin_inflated", skin_xml().replace("<skin ", '<skin inflate=".08" '))
    scene("skin_transparent", skin_xml(material='rgba=".3 .6 .8 .4"'))


def combinations():
    """Effects that act on each other."""
    asset = CHECKER + SKY + '<texture name="u" type="2d" file="channels4.png" nchannel="4"/>' if VERSION >= (3, 2, 0) else CHECKER + SKY + CHECKER.replace('"t"', '"u"')
    asset += (
        '<texture name="v" type="cube" builtin="gradient" width="32" height="192" rgb1=".9 .4 .1" rgb2=".1 .3 .8"/>'
        '<material name="mirror" texture="t" texuniform="true" texrepeat="2 2" reflectance=".4" specular=".8"/><material name="clear" texture="t" texrepeat="2 3" rgba="1 .9 .8 .5"/>'
        '<material name="holes" texture="u" rgba="1 1 1 .8"/><material name="cube" texture="v" emission=".2" specular=".9" shininess=".3"/>'
    )
    visual = '<map fogstart="1" fogend="2.2"/><rgba fog=".6 .4 .7 1" haze=".9 .8 .6 1"/>'
    bodies = (
        '<geom type="box" size=".3 .2 .3" pos="-.5 0 -.1" euler="10 0 30" material="clear"/><geom size=".3" pos=".5 .1 0" material="cube"/>'
        '<geom type="capsule" size=".1 .4" pos="0 .5 0" euler="70 0 20" material="holes"/><geom type="cylinder" size=".2 .2" pos="0 -.5 -.2" rgba=".3 .8 .4 .6"/>'
        '<geom type="ellipsoid" size=".1 .2 .3" pos="-.1 0 .2" material="clear"/><site type="box" size=".1 .1 .1" pos=".3 -.5 .3" rgba=".9 .2 .3 .5"/>'
    )
    floor = '<geom type="plane" size="{}" pos="0 0 -.6" material="mirror"/>'
    lamps = lambda count, shadows: "".join(
        f'<light pos="{1.5 * np.cos(2.4 * k):.3f} {1.5 * np.sin(2.4 * k):.3f} 2.5" dir="{-0.5 * np.cos(2.4 * k):.3f} {-0.5 * np.sin(2.4 * k):.3f} -1" cutoff="{25 + 6 * k}" exponent="{k}" '
        f'diffuse="{0.3 if k % 3 else 0.1} {0.3 if k % 2 else 0.1} .2" specular=".2 .2 .2" directional="{"true" if k % 4 == 3 else "false"}" castshadow="{"true" if k < shadows else "false"}"/>'
        for k in range(count)
    )
    for name, size, lights, flags, changed in (
        ("plain", "0 0 1", LIGHT, "", visual), ("fog", "0 0 1", LIGHT, "FOG", visual), ("finite", "1.2 1 .1", LIGHT, "FOG", visual), ("additive", "1.2 1 .1", LIGHT, "FOG ADDITIVE", visual),
        ("lamps", "1.2 1 .1", lamps(7, 4), "", visual), ("lamps_fog", "0 0 1", lamps(6, 2), "FOG", visual), ("many_lamps", "1.2 1 .1", lamps(12, 3), "", visual),
        ("dark", "1.2 1 .1", lamps(3, 3), "", visual + '<headlight active="0"/>'), ("bright", "1.2 1 .1", lamps(5, 5).replace('diffuse="', 'ambient=".2 .1 0" diffuse="'), "", visual + '<headlight ambient=".4 .4 .4" diffuse="1 1 1"/>'),
    ):
        scene(f"combined_{name}", xml(lights + bodies + floor.format(size), asset=asset, visual=changed), render=flags)
    for flag in ("SHADOW", "REFLECTION", "CULL_FACE", "HAZE"):
        scene(f"combined_no_{flag.lower()}", xml(lamps(3, 2) + bodies + floor.format("0 0 1"), asset=asset, visual=visual), render="FOG", no_render=flag)
    scene("combined_ids", xml(LIGHT + bodies + floor.format("0 0 1"), asset=asset, visual=visual), render="SEGMENT FOG")
    scene("combined_ortho", xml(lamps(3, 2) + bodies + floor.format("0 0 1"), asset=asset, visual=visual + '<global orthographic="true" fovy="2.5"/>'), render="FOG", since=(3, 1, 0))
    scene("combined_low", xml(lamps(3, 2) + bodies + floor.format("0 0 1"), asset=asset, visual=visual), render="FOG", free=(200.0, -4.0, 2.5))
    scene("combined_transform", xml(lamps(3, 2) + bodies + floor.format("0 0 1"), asset=asset, visual=visual), render="FOG",
          transform={"translate": [0.1, 0.2, 0.1], "rotate": [0.98, 0.0, 0.0, 0.199], "scale": 1.3})
    decor = [{"kind": "ARROW", "size": [0.04], "from": [-0.6, -0.7, 0.2], "to": [-0.4, 0.3, 0.7]}, {"kind": "LINE", "size": [3], "from": [-0.9, 0, 0.1], "to": [0.9, 0.2, 0.1]}]
    scene("combined_decor", xml(lamps(2, 2) + bodies + floor.format("1.2 1 .1"), asset=asset, visual=visual), render="FOG", decor=[{**geom, "rgba": [0.9, 0.6, 0.2, 0.6]} for geom in decor])
    # Coordinates for the material of the skin or the flex, and a floor that mirrors it.
    onto = lambda text, lights: text.replace('<geom name="floor"', '<geom name="floor" material="mirror"').replace(LIGHT, lights)
    for alpha in (1, 0.5):
        cloth = asset + f'<material name="cloth" texture="t" texrepeat="2 2" rgba="1 1 1 {alpha}"/>'
        for name, lights, flags in (("", LIGHT, ""), ("_fog", lamps(4, 3), "FOG"), ("_additive", lamps(4, 3), "ADDITIVE")):
            scene(f"combined_skin_{alpha}{name}", onto(skin_xml(asset=cloth, material='material="cloth"', texcoord=True, visual=visual), lights), render=flags)
            scene(f"combined_flex_{alpha}{name}", onto(flex_xml(2, asset=cloth, material='material="cloth"'), lights), render=flags, since=(3, 0, 0), lookat=(0, 0, 0.5))
        scene(f"combined_solid_flex_{alpha}", onto(flex_xml(3, asset=cloth, material='material="cloth"'), lamps(4, 3)), since=(3, 0, 0), lookat=(0, 0, 0.5), visual="FLEXEDGE FLEXVERT")


def flags(names, kind, prefix):
    return [int(getattr(kind, prefix + name)) for name in names if hasattr(kind, prefix + name)]


def draw(row, out, is_recorded=False):
    assets = {f"channels{k}.png": png(k) for k in (1, 2, 3, 4)}
    if is_recorded:
        model = mujoco.MjModel.from_xml_string(row["xml"])
    else:
        for name, data in assets.items():
            (out / name).write_bytes(data)
        path = out / f"{row['name']}.xml"
        path.write_text(row["xml"])
        model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.ctrl[:] = row.setdefault("ctrl", [0.0] * model.nu)
    for _ in range(row["steps"]):
        mujoco.mj_step(model, data)
    for key in ("qpos", "qvel", "act"):
        row[key] = [float(value) for value in getattr(data, key)]
    if not row["steps"] or not any("sleep" in text for text in (row["name"],)):
        mujoco.mj_resetData(model, data)
        for key in ("qpos", "qvel", "act"):
            getattr(data, key)[:] = row[key]
        data.ctrl[:] = row["ctrl"]
        mujoco.mj_forward(model, data)
    else:
        mujoco.mj_forward(model, data)
    options = mujoco.MjvOption()
    for index in flags(row["visual"], mujoco.mjtVisFlag, "mjVIS_"):
        options.flags[index] = 1
    for index in flags(row["no_visual"], mujoco.mjtVisFlag, "mjVIS_"):
        options.flags[index] = 0
    options.label = getattr(mujoco.mjtLabel, "mjLABEL_" + row["label"])
    options.frame = getattr(mujoco.mjtFrame, "mjFRAME_" + row["frame"])
    if VERSION >= (3, 0, 0):
        options.flex_layer, options.bvh_depth = row["flex_layer"], row["bvh_depth"]
    for kind, shown in row.get("groups", {}).items():
        getattr(options, kind)[:] = shown
    pulled = mujoco.MjvPerturb()
    if "perturb" in row:
        body = model.body(row["perturb"]["body"]).id
        pulled.select, pulled.active = body, row["perturb"]["active"]
        pulled.refpos[:] = data.xipos[body] + [0.2, 0.1, 0.3]
        if hasattr(pulled, "refselpos"):
            pulled.refselpos[:] = pulled.refpos
        pulled.refquat[:], pulled.localpos[:] = [0.8, 0.6, 0, 0], [0.05, 0.0, 0.05]
    camera = mujoco.MjvCamera()
    if row["camera"]:
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(row["camera"]).id
    else:
        if hasattr(mujoco, "mjv_defaultFreeCamera"):
            mujoco.mjv_defaultFreeCamera(model, camera)
        camera.type, camera.lookat[:] = mujoco.mjtCamera.mjCAMERA_FREE, row["lookat"]
        if "track" in row:
            camera.type, camera.trackbodyid = mujoco.mjtCamera.mjCAMERA_TRACKING, model.body(row["track"]).id
        camera.distance, camera.azimuth, camera.elevation = row["distance"], row["azimuth"], row["elevation"]
        if "default" in row:
            mujoco.mjv_defaultFreeCamera(model, camera)
    picture = mujoco.MjvScene(model, maxgeom=20_000)
    for index in flags(row["render"], mujoco.mjtRndFlag, "mjRND_"):
        picture.flags[index] = 1
    for index in flags(row["no_render"], mujoco.mjtRndFlag, "mjRND_"):
        picture.flags[index] = 0
    categories = row.get("categories", mujoco.mjtCatBit.mjCAT_ALL.value)
    # Infinite planes are centred at the viewpoint of the previous update.
    for _ in range(2):
        mujoco.mjv_updateScene(model, data, options, pulled, camera, categories, picture)
    if "transform" in row:
        picture.enabletransform = 1
        picture.translate[:], picture.rotate[:] = row["transform"]["translate"], row["transform"]["rotate"]
        picture.scale = row["transform"]["scale"]
    for new in row.get("decor", []):
        geom = picture.geoms[picture.ngeom]
        kind, colour = getattr(mujoco.mjtGeom, "mjGEOM_" + new["kind"]), np.array(new["rgba"], np.float32)
        if "from" in new:
            mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_NONE, np.zeros(3), np.zeros(3), np.eye(3).flatten(), colour)
            if hasattr(mujoco, "mjv_connector"):
                mujoco.mjv_connector(geom, kind, new["size"][0], np.array(new["from"]), np.array(new["to"]))
            else:
                mujoco.mjv_makeConnector(geom, kind, new["size"][0], *new["from"], *new["to"])
        else:
            mujoco.mjv_initGeom(geom, kind, np.array(new["size"], float), np.array(new["pos"], float), np.eye(3).flatten(), colour)
        geom.category, geom.segid = new.get("category", mujoco.mjtCatBit.mjCAT_DECOR.value), picture.ngeom
        geom.dataid = 0 if new["kind"] == "MESH" else -1
        picture.ngeom += 1
    row["geoms"] = picture.ngeom
    WIDTH, HEIGHT = row.setdefault("size", SIZE)
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    opengl = mujoco.GLContext(WIDTH, HEIGHT)
    opengl.make_current()
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    area = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
    rgb, depth = np.empty((HEIGHT, WIDTH, 3), np.uint8), np.empty((HEIGHT, WIDTH), np.float32)
    mujoco.mjr_render(area, picture, context)
    mujoco.mjr_readPixels(rgb, None, area, context)
    image = rgb[::-1].copy()
    if is_recorded:
        (out / f"{row['name']}.png").write_bytes(encoded(WIDTH, HEIGHT, 3, image.tobytes()))
        context.free()
        opengl.free()
        return
    # Depths and ids of round shapes, not of polyhedra with 28 slices.
    context.free()
    model.vis.quality.numslices = model.vis.quality.numstacks = 200
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    reversed_z = VERSION >= (3, 0, 1)
    if reversed_z:
        context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
    for name in ("SEGMENT", "IDCOLOR"):
        picture.flags[getattr(mujoco.mjtRndFlag, "mjRND_" + name)] = 1
    if hasattr(mujoco.mjtRndFlag, "mjRND_DEPTH"):
        picture.flags[mujoco.mjtRndFlag.mjRND_DEPTH] = 0
    mujoco.mjr_render(area, picture, context)
    mujoco.mjr_readPixels(rgb, None, area, context)
    # Transparent geoms have no depth. The engine has marked them, and does not draw geoms without
    # an id here.
    for geom in picture.geoms[: picture.ngeom]:
        if geom.transparent:
            geom.segid = -1
    mujoco.mjr_render(area, picture, context)
    mujoco.mjr_readPixels(None, depth, area, context)
    context.free()
    opengl.free()
    near, far = (float(picture.camera[0].frustum_near), float(picture.camera[0].frustum_far))
    z = depth.astype(np.float64) if reversed_z else 1.0 - depth.astype(np.float64)
    is_ortho = VERSION >= (3, 1, 0) and picture.camera[0].orthographic
    metres = far - z * (far - near) if is_ortho else near * far / (near + z * (far - near))
    metres[z <= 0] = np.inf
    ids = (rgb.astype(np.int32) @ np.array([1, 256, 65536], np.int32)) - 1
    (out / f"{row['name']}.depth").write_bytes(metres[::-1].astype(np.float32).tobytes())
    (out / f"{row['name']}.ids").write_bytes(ids[::-1].astype(np.int32).tobytes())
    (out / f"{row['name']}.rgb").write_bytes(image.tobytes())


def png(channels):
    """Returns an image with this number of channels."""
    size = 16
    pixel = lambda x, y, c: (37 * x + 91 * y * (c + 1) + 60 * c) % 256 if c < 3 else 128 + 8 * x
    return encoded(size, size, channels, bytes(pixel(x, y, c) for y in range(size) for x in range(size) for c in range(channels)))


def encoded(width, height, channels, pixels):
    """Returns pixels as a PNG file, without a library."""
    row = width * channels
    raw = [bytes(row)] + [pixels[start : start + row] for start in range(0, row * height, row)]
    # The filter Up: differences to the row above.
    rows = b"".join(b"\2" + bytes((a - b) % 256 for a, b in zip(below, above)) for above, below in zip(raw, raw[1:]))
    chunk = lambda tag, data: len(data).to_bytes(4, "big") + tag + data + zlib.crc32(tag + data).to_bytes(4, "big")
    header = width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes([8, {1: 0, 2: 4, 3: 2, 4: 6}[channels], 0, 0, 0])
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def record():
    global SIZE
    SIZE = RECORDED_SIZE
    out = Path(__file__).parent / "recorded" / mujoco.__version__
    out.mkdir(parents=True, exist_ok=True)
    rows = []
    for row in SCENES:
        if row["name"] not in RECORDED:
            continue
        try:
            draw(row, out, is_recorded=True)
        except ValueError as error:
            print(f"{row['name']}: {error}")
            continue
        rows.append(row)
        # An image that equals that of 4.0.1 is not stored twice.
        image, other = (folder / f"{row['name']}.png" for folder in (out, out.parent / "4.0.1"))
        if other != image and other.exists() and other.read_bytes() == image.read_bytes():
            image.unlink()
    (out / "scenes.json").write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")


def main():
    for part in (cameras, textures, lights, flexes, decoration, effects, sources, tendons, settings, views, surfaces, combinations):
        part()
    if sys.argv[1] == "--record":
        return record()
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    rows = []
    if sys.argv[2:3] == ["--random"]:
        SCENES.clear()
        first, count = map(int, sys.argv[3:])
        random_scenes(scene, xml, VERSION, range(first, first + count))
        del sys.argv[2:]
    for row in SCENES:
        if sys.argv[2:] and not any(part in row["name"] for part in sys.argv[2:]):
            continue
        try:
            draw(row, out)
        except (ValueError, mujoco.FatalError) as error:
            print(f"{row['name']}: {error}")
            continue
        rows.append(row)
    (out / "scenes.json").write_text(json.dumps({"version": mujoco.__version__, "scenes": rows}))
    print(f"{len(rows)} scenes of MuJoCo {mujoco.__version__}")


if __name__ == "__main__":
    main()
