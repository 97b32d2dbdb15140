#!/usr/bin/env python3
"""Draws scenes of everything that an engine shows, with its own renderer: colour, depth and segmentation.

    MUJOCO_GL=osmesa python linked.py OUT [PART_OF_A_NAME ...]
    MUJOCO_GL=osmesa python linked.py --record

needs the official bindings of the linked engine (numpy, pillow, pyopengl) and Debian's package libosmesa6; with bindings from 4.0, MUJOCO_GL=egl.
The test `pictures_equal_those_of_the_bindings` runs it and compares. Writes scenes.json, and for each scene NAME.xml, NAME.rgb (bytes),
NAME.depth (float32, metres, without transparent geoms) and NAME.ids (int32, index of the geom in the scene, -1 for the background), row-major
from the upper left. A scene whose model needs a newer engine is left out.

--record writes small colour images of the scenes in RECORDED to recorded/VERSION, with which the test `recorded_pictures_are_drawn` compares.
"""

import json
import sys
import zlib
from pathlib import Path

import mujoco
import numpy as np

WIDTH, HEIGHT = 320, 240
RECORDED_SIZE = 160, 120
RECORDED = (
    "camera_ortho_2.0 camera_ortho_free_3.0 camera_intrinsic_principal camera_intrinsic_square texture_2d_sphere_false_2.5_3 texture_2d_box_true_2.5_3 "
    "texture_2d_capsule_false_2.5_3 texture_2d_cylinder_false_2.5_3 texture_2d_plane_true_2.5_3 texture_2d_mesh_uv_false_2.5_3 texture_skin_3 "
    "texture_flex_3 texture_layer_rgba texture_srgb visual_frustum islands flex_3_edges shadow_in_transparent visual_many light_type_point_false "
    "light_shadows_7 shadow_off_geoms"
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
          label="NONE", frame="NONE", layer=0, depth=0, lookat=(0.0, 0.0, 0.0)):
    if VERSION >= since:
        azimuth, elevation, distance = free
        SCENES.append({
            "name": name, "xml": text, "camera": camera, "azimuth": azimuth, "elevation": elevation, "distance": distance,
            "lookat": list(lookat), "visual": visual.split(), "no_visual": no_visual.split(), "render": render.split(),
            "no_render": no_render.split(), "steps": steps, "label": label, "frame": frame, "flex_layer": layer, "bvh_depth": depth,
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


def effects():
    sky = xml(LIGHT + BODIES + '<geom type="plane" size="0 0 1" pos="0 0 -.6" material="m"/>',
              asset=CHECKER + SKY + '<material name="m" texture="t" texuniform="true" texrepeat="2 2" reflectance=".3"/>', visual='<map fogstart="1" fogend="4"/><rgba fog=".7 .5 .3 1"/>')
    for flag in ("SHADOW", "REFLECTION", "SKYBOX", "HAZE", "CULL_FACE"):
        scene(f"render_no_{flag.lower()}", sky, no_render=flag)
    for flag in ("WIREFRAME", "ADDITIVE", "FOG", "SEGMENT"):
        scene(f"render_{flag.lower()}", sky, render=flag, no_render="SHADOW" if flag == "WIREFRAME" else "")
    scene("render_idcolor", sky, render="SEGMENT IDCOLOR")
    scene("mirror_transparent", xml(LIGHT + BODIES + '<geom size=".3" pos="0 0 .5" rgba=".3 .9 .3 .5"/><geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>',
          asset='<material name="m" reflectance=".6"/>'))
    scene("mirror_point_light", xml('<light pos="1 -1 2" type="point"/>' + LIGHT + BODIES + '<geom type="plane" size="1 1 1" pos="0 0 -.6" material="m"/>',
          asset='<material name="m" reflectance=".6"/>'), since=(3, 3, 3))
    scene("plane_from_behind", xml(LIGHT + BODIES + FLOOR), free=(140.0, 30.0, 3.0))
    scene("sdf", xml(LIGHT + FLOOR + '<geom type="sdf" mesh="plain" rgba=".8 .4 .2 1"/>', asset=MESHES), since=(3, 3, 0))


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
    for _ in range(row["steps"]):
        mujoco.mj_step(model, data)
    for key in ("qpos", "qvel", "act"):
        row[key] = [float(value) for value in getattr(data, key)]
    if not row["steps"] or not any("sleep" in text for text in (row["name"],)):
        mujoco.mj_resetData(model, data)
        for key in ("qpos", "qvel", "act"):
            getattr(data, key)[:] = row[key]
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
    camera = mujoco.MjvCamera()
    if row["camera"]:
        camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(row["camera"]).id
    else:
        if hasattr(mujoco, "mjv_defaultFreeCamera"):
            mujoco.mjv_defaultFreeCamera(model, camera)
        camera.type, camera.lookat[:] = mujoco.mjtCamera.mjCAMERA_FREE, row["lookat"]
        camera.distance, camera.azimuth, camera.elevation = row["distance"], row["azimuth"], row["elevation"]
    picture = mujoco.MjvScene(model, maxgeom=20_000)
    for index in flags(row["render"], mujoco.mjtRndFlag, "mjRND_"):
        picture.flags[index] = 1
    for index in flags(row["no_render"], mujoco.mjtRndFlag, "mjRND_"):
        picture.flags[index] = 0
    everything = mujoco.mjtCatBit.mjCAT_ALL.value
    # Infinite planes are centred at the viewpoint of the previous update.
    for _ in range(2):
        mujoco.mjv_updateScene(model, data, options, mujoco.MjvPerturb(), camera, everything, picture)
    row["geoms"] = picture.ngeom
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    opengl = mujoco.GLContext(WIDTH, HEIGHT)
    opengl.make_current()
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    reversed_z = VERSION >= (3, 0, 1)
    if reversed_z:
        context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
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
    for name in ("SEGMENT", "IDCOLOR"):
        picture.flags[getattr(mujoco.mjtRndFlag, "mjRND_" + name)] = 1
    if hasattr(mujoco.mjtRndFlag, "mjRND_DEPTH"):
        picture.flags[mujoco.mjtRndFlag.mjRND_DEPTH] = 0
    mujoco.mjr_render(area, picture, context)
    mujoco.mjr_readPixels(rgb, None, area, context)
    # Transparent geoms have no depth. The engine has marked them, and does not draw geoms without an id here.
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
    global WIDTH, HEIGHT
    WIDTH, HEIGHT = RECORDED_SIZE
    out = Path(__file__).parent / "recorded" / mujoco.__version__
    out.mkdir(parents=True, exist_ok=True)
    rows = [row for row in SCENES if row["name"] in RECORDED]
    for row in rows:
        draw(row, out, is_recorded=True)
        # An image that equals that of 4.0.0 is not stored twice.
        image, other = (folder / f"{row['name']}.png" for folder in (out, out.parent / "4.0.0"))
        if other != image and other.exists() and other.read_bytes() == image.read_bytes():
            image.unlink()
    (out / "scenes.json").write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")


def main():
    for part in (cameras, textures, lights, flexes, decoration, effects):
        part()
    if sys.argv[1] == "--record":
        return record()
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    rows = []
    for row in SCENES:
        if sys.argv[2:] and not any(part in row["name"] for part in sys.argv[2:]):
            continue
        try:
            draw(row, out)
        except (ValueError, mujoco.FatalError) as error:
            print(f"{row['name']}: {error}")
            continue
        rows.append(row)
    (out / "scenes.json").write_text(json.dumps({"version": mujoco.__version__, "width": WIDTH, "height": HEIGHT, "scenes": rows}))
    print(f"{len(rows)} scenes of MuJoCo {mujoco.__version__}")


if __name__ == "__main__":
    main()
