"""What is seen where cameras, pictures and numbers are extreme, by every technique that can: fields of view, sizes of pictures, parallel
rays, distances, exposures, texture coordinates, and scenes that a request moves."""
import math
import os
import unittest

from render import PIECES, Daemon, Picture
from table import TECHNIQUES, HardCase
from writers import Gltf, png, quad

daemon = Daemon()
OPTIONS = {"pt": {"pt.depth": 1}, "direct": {}, "vct": {"vct.bounces": 0, "vct.resolution": 16}}


def setUpModule():
    unittest.enterModuleContext(daemon)


def wall(g, half, z, material, **more):
    g.place(*quad((-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)), material, **more)


def glowing(half, z):
    g = Gltf()
    wall(g, half, z, g.material("glow", (0, 0, 0), (1, 1, 1)))
    return g


class Seen(HardCase):
    def each(self, g, size=(8, 8), spp=(1, 1, 1), camera=(0, 0, 0, 0, 0, -1, 0, 1, 0, 90), arguments=(), techniques=TECHNIQUES):
        """Pictures by each technique."""
        daemon.candil("load", g.save(daemon.folder, "seen.glb"), "--name", "seen")
        for technique, samples in zip(TECHNIQUES, spp):
            if technique in techniques:
                yield technique, daemon.twice("seen", size, samples, camera, options=OPTIONS[technique], arguments=["--technique", technique, *arguments])
        daemon.candil("unload", "seen")


class Cameras(Seen):
    def check(self, case, g, expected, tolerance=0, source="projection", **more):
        """The share of the picture that glows. What lies along the pixels' borders is seen whole or not at all."""
        for _, picture in self.each(g, **more):
            self.row("camera", case, picture, picture.mean(), expected, source, tolerance)

    def test_fields_of_view(self):
        for fov in (1e-3, .1, 90, 179, 179.9):
            half = 5 * math.tan(math.radians(fov / 2))
            self.check(f"half as high as a view of {fov:g}°", glowing(half, -10), .25, camera=(0, 0, 0, 0, 0, -1, 0, 1, 0, fov))

    def test_far_and_near(self):
        for distance in (1e-6, 1e-3, 1e4, 1e9):
            self.check(f"half as high as the view, {distance:g} m away", glowing(distance / 2, -distance), .25)

    def test_parallel_rays(self):
        for height in (1e-4, 1, 1e6):
            self.check(f"half as high as parallel rays over {height:g} m", glowing(height / 4, -10), .25, arguments=["--orthographic", str(height)])

    def test_sizes(self):
        for size in ((1, 1), (1, 512), (512, 1)):
            share = .5 * min(1, .5 * size[1] / size[0])  # 90 degrees are the height's
            self.check(f"{size[0]} x {size[1]} pixels", glowing(5, -10), share, tolerance=.02, source="projection; by samples",
                       size=size, spp=(4096 if size == (1, 1) else 64,) * 3)

    def test_depth(self):
        for distance in (1e-6, 1e-3, 1e3, 1e9):
            for _, picture in self.each(glowing(distance, -distance), arguments=["--aov", "depth"]):
                self.row("camera", f"depth of what is {distance:g} m away", picture, picture.channels["Z"][4, 4], distance, "itself", 1e-6)


class Texture(Seen):
    def test_far_from_zero(self):
        for side, turns in ((3, 1), (7, 33), (13, 100)):
            values = [[(83 * x + 131 * y) % 256 for x in range(side)] for y in range(side)]
            g = Gltf()
            texture = g.image(png(side, side, lambda x, y: (values[y][x],) * 3), magFilter=9728, minFilter=9728)
            uvs = [(-turns + u, -turns + v) for u, v in ((0, 1), (1, 1), (1, 0), (0, 0))]
            g.node(mesh=g.mesh(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("sign", texture=texture, unlit=True), uvs=uvs))
            linear = [((b / 255 + .055) / 1.055) ** 2.4 if b > 10 else b / 255 / 12.92 for row in values for b in row]
            for _, picture in self.each(g, size=(side, side), camera=(0, 0, 5, 0, 0, 0, 0, 1, 0, 40), arguments=["--orthographic", "2"]):
                self.row("texture", f"{side} x {side} texels, {turns} turns below zero", picture, picture.mean(), sum(linear) / side ** 2, "sRGB of its texels", 1e-3)


class Exposed(HardCase):
    """PNGs: eight bits, of the codes that are in between."""

    def test_exposures(self):
        daemon.candil("load", Gltf().save(daemon.folder, "nothing.gltf"), "--name", "nothing")
        for radiance, exposure in ((1e-6, 18), (.2, 0), (1e6, -21), (1e12, -41), (1e12, 0), (1e-12, 0)):
            value = min(radiance * 2.0 ** exposure, 1)
            code = 255 * (1.055 * value ** (1 / 2.4) - .055 if value > .0031308 else 12.92 * value)
            for technique in TECHNIQUES:
                pictures = []
                for options in ({}, PIECES[technique]):
                    path = os.path.join(daemon.folder, "exposed.png")
                    daemon.candil("render", "nothing", "-o", path, "--size", "8x8", "--spp", "1", "--technique", technique, "--exposure", str(exposure),
                                  "--background", ",".join([repr(radiance)] * 3), "--camera", "0,0,0,0,0,-1,0,1,0,40",
                                  *(word for name, v in options.items() for word in ("--set", f"{name}={v}")))
                    pictures.append(Picture(path, {"non_finite_samples": 0}))
                picture = pictures[0]
                picture.same_bits = picture.radiance.tobytes() == pictures[1].radiance.tobytes()
                self.row("output", f"radiance {radiance:g} at {exposure:+d} EV", picture, 255 * picture.mean(), round(code), "sRGB, IEC 61966-2-1", 1e-6)


class Moved(Seen):
    """A lamp over a floor, as a request puts it."""

    def scene(self):
        g = Gltf()
        room = g.node(children=[], name="room")
        for name, shape, material in (("floor", quad((-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9)), g.material("floor", (.5,) * 3)),
                                      ("lamp", quad((-.5, 1, -.5), (.5, 1, -.5), (.5, 1, .5), (-.5, 1, .5)), g.material("lamp", (0, 0, 0), (1,) * 3))):
            g.json["nodes"][room]["children"].append(g.place(*shape, material, root=False, name=name))
        return g

    def test_nodes(self):
        a = .5 / math.sqrt(1.25)
        square = 4 * a * math.atan(a)
        for case, edits, scale, at in (("shrunk to a thousandth", "room:scale=.001", 1e-3, (0, 0, 0)), ("a million times as large", "room:scale=1e6", 1e6, (0, 0, 0)),
                                       ("moved by 1 km", "room:translate=1e3,0,-1e3", 1, (1e3, 0, -1e3))):
            camera = (at[0], at[1] + .4 * scale, at[2] + .3 * scale, *at, 0, 1, 0, .05)
            for technique, picture in self.each(self.scene(), spp=(256, 1, 1), camera=camera, arguments=["--node", edits]):
                self.row("edit", f"a room {case}", picture, picture.mean() * math.pi / .5, square, "form factor of a square, Howell B-3"
                         + ("; rays start 1e-06 of 1 km off what they leave" if at[0] else ""), 5e-3 if technique == "pt" or at[0] else 1e-3)

    def test_lights(self):
        for distance in (1e-3, 1e6):
            light = f"point:at=0,{distance!r},0,intensity={distance * distance!r}"
            camera = (0, .4 * distance, .3 * distance, 0, 0, 0, 0, 1, 0, .05)
            g = Gltf()
            half = 3 * distance
            g.place(*quad((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)), g.material("floor", (.5,) * 3))
            for _, picture in self.each(g, camera=camera, arguments=["--light", light]):
                self.row("edit", f"a light put {distance:g} m above a floor", picture, picture.mean() * math.pi / .5, 1, "I cos θ / d²", 1e-3)

    def test_an_animation(self):
        """A bulb sinks from 1 m to nothing: a thousandth of a second before its end it is a millimetre high."""
        g = Gltf()
        g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("floor", (.5,) * 3))
        g.light("point", 1.0)
        del g.json["nodes"][-1]["matrix"]
        g.animation("sink", (len(g.json["nodes"]) - 1, "translation", [0, 1], [[0, 1, 0], [0, 0, 0]]))
        for at in (0, .9, .999):
            height = 1 - at
            for _, picture in self.each(g, camera=(0, .4 * height, .3 * height, 0, 0, 0, 0, 1, 0, .05), arguments=["--animation", "sink", "--at", str(at)]):
                self.row("edit", f"a bulb that sinks to the floor, {height:.3g} s before", picture, picture.mean() * math.pi / .5, 1 / height ** 2, "I cos θ / d²", 5e-3)


if __name__ == "__main__":
    unittest.main()
