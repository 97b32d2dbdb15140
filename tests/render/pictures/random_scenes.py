"""Random scenes: combinations that no list has.

They combine settings, lights, cameras, materials, shapes and flags.
"""

import random

VISUAL_FLAGS = "CONVEXHULL TEXTURE JOINT ACTUATOR CAMERA LIGHT TENDON INERTIA SCLINERTIA PERTFORCE CONTACTPOINT CONTACTFORCE TRANSPARENT COM SELECT STATIC SKIN".split()
RENDER_FLAGS = "SHADOW WIREFRAME REFLECTION ADDITIVE SKYBOX FOG HAZE CULL_FACE".split()
# Lines cover other pixels, which the scene `render_wireframe` shows. Boxes of inertia touch the
# caps of cylinders, and the nearer of two surfaces in one plane depends on rounding.
WITHOUT = {"WIREFRAME", "INERTIA", "SCLINERTIA"}
SHAPES = ("sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh")


class Draw:
    """Draws attributes from a seed."""

    def __init__(self, seed, version):
        self.random, self.version = random.Random(seed), version

    def chance(self, probability):
        return self.random.random() < probability

    def number(self, low, high):
        return f"{self.random.uniform(low, high):.3f}"

    def numbers(self, count, low, high):
        return " ".join(self.number(low, high) for _ in range(count))

    def some(self, **attributes):
        """Returns each of the attributes with a probability of a half."""
        return " ".join(f'{name.rstrip("_")}="{value()}"' for name, value in attributes.items() if self.chance(0.5))

    def one(self, *values):
        return self.random.choice(values)

    def visual(self):
        colour = lambda: self.numbers(3, 0, 1)
        headlight = self.some(ambient=colour, diffuse=colour, specular=colour, active=lambda: self.one(0, 1, 1))
        settings = self.some(
            znear=lambda: self.number(0.005, 0.1), zfar=lambda: self.number(8, 60), fogstart=lambda: self.number(0.5, 2),
            fogend=lambda: self.number(2, 6), haze=lambda: self.number(0, 1), shadowclip=lambda: self.number(0.7, 2),
            shadowscale=lambda: self.number(0.3, 0.9), alpha=lambda: self.number(0.1, 0.9), stiffness=lambda: self.number(50, 300),
        )
        sizes = self.some(
            shadowsize=lambda: self.one(512, 1024, 2048), numslices=lambda: self.one(8, 20, 40), numstacks=lambda: self.one(8, 20, 40),
            numquads=lambda: self.one(1, 3, 8),
        )
        rgba = self.some(fog=lambda: colour() + " 1", haze=lambda: colour() + " 1")
        scale = self.some(
            framelength=lambda: self.number(0.5, 2), framewidth=lambda: self.number(0.05, 0.3), light=lambda: self.number(0.2, 0.6),
            camera=lambda: self.number(0.2, 0.6), jointlength=lambda: self.number(0.5, 2), com=lambda: self.number(0.2, 0.8),
        )
        fovy = f'fovy="{self.number(20, 80)}"'
        orthographic = ' orthographic="true"' if self.version >= (3, 1, 0) and self.chance(0.2) else ""
        return f'<global {fovy}{orthographic}/><headlight {headlight}/><map {settings}/><quality {sizes}/><rgba {rgba}/><scale {scale}/>'

    def assets(self):
        parts = ['<mesh name="tetra" vertex="0 0 0 .6 0 0 0 .6 0 0 0 .6"/>']
        for at in range(3):
            kind = self.one("2d", "cube")
            builtin = self.one("checker", "gradient", "flat")
            mark = self.one("none", "edge", "cross", "random")
            height = 32 if kind == "2d" else 192
            parts.append(
                f'<texture name="t{at}" type="{kind}" builtin="{builtin}" mark="{mark}" random=".02" width="32" height="{height}" '
                f'rgb1="{self.numbers(3, 0, 1)}" rgb2="{self.numbers(3, 0, 1)}" markrgb="{self.numbers(3, 0, 1)}"/>'
            )
        for at in range(4):
            texture = f'texture="t{self.random.randrange(3)}"' if self.chance(0.6) else ""
            more = self.some(
                texrepeat=lambda: self.numbers(2, 0.5, 3), texuniform=lambda: self.one("true", "false"), emission=lambda: self.number(0, 0.5),
                specular=lambda: self.number(0, 1), shininess=lambda: self.number(0, 1),
                rgba=lambda: self.numbers(3, 0.2, 1) + " " + self.one("1", "1", self.number(0.2, 0.9)),
            )
            reflectance = f' reflectance="{self.number(0, 0.6)}"' if self.chance(0.3) else ""
            parts.append(f'<material name="m{at}" {texture} {more}{reflectance}/>')
        if self.chance(0.5):
            parts.append(
                f'<texture type="skybox" builtin="{self.one("gradient", "checker", "flat")}" width="32" height="192" '
                f'rgb1="{self.numbers(3, 0, 1)}" rgb2="{self.numbers(3, 0, 1)}"/>'
            )
        return "".join(parts)

    def light(self):
        more = self.some(
            diffuse=lambda: self.numbers(3, 0.1, 0.7), ambient=lambda: self.numbers(3, 0, 0.3), specular=lambda: self.numbers(3, 0, 0.6),
            cutoff=lambda: self.number(20, 80), exponent=lambda: self.number(0, 20), attenuation=lambda: f"1 {self.numbers(2, 0, 0.2)}",
            castshadow=lambda: self.one("true", "false"), active=lambda: self.one("true", "true", "false"),
        )
        directional = 'directional="true"' if self.chance(0.4) else ""
        return f'<light pos="{self.numbers(2, -2, 2)} {self.number(2, 4)}" dir="{self.numbers(2, -0.5, 0.5)} -1" {directional} {more}/>'

    def geom(self, at):
        kind = self.one(*SHAPES)
        shape = 'type="mesh" mesh="tetra"' if kind == "mesh" else f'type="{kind}" size="{self.numbers(3, 0.08, 0.3)}"'
        look = f'material="m{self.random.randrange(4)}"' if self.chance(0.7) else f'rgba="{self.numbers(3, 0, 1)} {self.one("1", "1", ".5")}"'
        return f'<geom name="g{at}" {shape} {look} euler="{self.numbers(3, -90, 90)}"/>'

    def world(self):
        parts = [self.light() for _ in range(self.random.randrange(4))]
        floor = self.one('size="3 3 .1"', 'size="0 0 .1"', 'size="2 0 .5"')
        parts.append(f'<geom name="floor" type="plane" {floor} pos="0 0 -.6" material="m0"/>')
        for at in range(self.random.randrange(3, 8)):
            joint = self.one("", "<freejoint/>", '<joint axis="0 1 1"/>')
            parts.append(f'<body name="b{at}" pos="{self.numbers(2, -0.9, 0.9)} {self.number(-0.4, 0.6)}">{joint}{self.geom(at)}</body>')
        parts.append(f'<camera name="c" pos="{self.numbers(2, -0.5, 0.5)} {self.number(1.5, 2.5)}" fovy="{self.number(30, 70)}"/>')
        return "".join(parts)


def random_scenes(scene, xml, version, seeds):
    """Adds a scene for each seed."""
    for seed in seeds:
        draw = Draw(seed, version)
        pick = lambda names, count: " ".join(draw.random.sample([name for name in names if name not in WITHOUT], count))
        text = xml(draw.world(), asset=draw.assets(), visual=draw.visual())
        scene(
            f"random_{seed}", text, camera=draw.one(None, None, "c"), visual=pick(VISUAL_FLAGS, draw.random.randrange(3)),
            no_visual=pick(VISUAL_FLAGS, draw.random.randrange(2)), render=pick(RENDER_FLAGS, draw.random.randrange(3)),
            no_render=pick(RENDER_FLAGS, draw.random.randrange(2)),
            free=(draw.random.uniform(0, 360), draw.random.uniform(-60, -10), draw.random.uniform(2, 4)),
        )
