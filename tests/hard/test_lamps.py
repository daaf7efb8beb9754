"""Lamps and lights where they are hard for the path tracer's ways of sampling: in one plane with a wall, touching what they light, dim beside
bright; rooms with several at any scale and place; lamps without area or without a number."""
import math
import unittest

import numpy

from images import relmse
from render import Daemon, Failed
from table import HardCase
from writers import Gltf, box, quad

daemon = Daemon()
SCALES = (1e-3, 1e3, 1e6)
SQUARE = "form factor of a square, Howell B-3"


def setUpModule():
    unittest.enterModuleContext(daemon)


def floor(g, half, y=0.0, albedo=0.5):
    return g.place(*quad((-half, y, half), (half, y, half), (half, y, -half), (-half, y, -half)), g.material("floor", (albedo,) * 3))


def square(g, half, y, radiance, **material):
    """A square lamp that looks down."""
    g.place(*quad((-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)),
            g.material("lamp", (0, 0, 0), (radiance,) * 3, **material))


def below_square(half, height=1.0):
    """Irradiance below the middle of a square of radiance 1."""
    a = half / math.hypot(half, height)
    return 4 * a * math.atan(a)


def beside_wall(width, height, distance):
    """Irradiance on the floor at a distance before the middle of a rectangle of radiance 1 that stands on it: Howell's catalogue
    of configuration factors, B-4, twice."""
    x, y = height / (width / 2), distance / (width / 2)
    a = 1 / math.hypot(x, y)
    return math.atan(1 / y) - a * y * math.atan(a)


def irradiance(g, at, name, spp=1024, eye=None, albedo=0.5, **more):
    """What comes to a place of the floor by direct light, seen through a narrow lens from straight above or from `eye`; and the picture."""
    x, y, z = at
    eye = eye or (x, y + 0.5, z)
    camera = (*eye, *at, 0, 0, -1, 0.01) if eye[0] == x and eye[2] == z else (*eye, *at, 0, 1, 0, 0.01)
    picture = daemon.twice(g.save(daemon.folder, name), size=(8, 8), spp=spp, camera=camera, options={"pt.depth": 1, **more})
    return picture.mean() * math.pi / albedo, picture


class Near(HardCase):
    def test_a_lamp_in_the_plane_of_the_ceiling(self):
        """Let into the ceiling, or lying in the very plane of it: the ceiling takes nothing of its light."""
        for hole in (True, False):
            g = Gltf()
            floor(g, 5)
            plate = g.material("ceiling", (0, 0, 0))
            parts = [(-5, -5, 5, -.5), (-5, .5, 5, 5), (-5, -.5, -.5, .5), (.5, -.5, 5, .5)] if hole else [(-5, -5, 5, 5)]
            for x0, z0, x1, z1 in parts:
                g.place(*quad((x0, 1, z0), (x1, 1, z0), (x1, 1, z1), (x0, 1, z1)), plate)
            square(g, .5, 1, 1.0)
            # Which of two surfaces in one plane is seen is nobody's to say: by its points the lamp is there.
            ways = {} if hole else {"pt.lights": "nee"}
            value, picture = irradiance(g, (0, 0, 0), "ceiling.gltf", **ways)
            self.row("near", "a lamp in a hole of the ceiling" if hole else "a lamp that lies in a whole ceiling, by points on it", picture, value, below_square(.5),
                     SQUARE, 0.01)

    def test_a_lamp_that_stands_on_the_floor(self):
        for distance in (0.5, 0.05, 0.005):
            g = Gltf()
            floor(g, 5)
            g.place(*quad((-1, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 1, 0)), g.material("lamp", (0, 0, 0), (1, 1, 1)))
            value, picture = irradiance(g, (0, 0, distance), "standing.gltf", **{"pt.lights": "none"})
            self.row("near", f"{distance:g} m before a lamp that stands on the floor, found by chance", picture, value, beside_wall(2, 1, distance),
                     "form factor of a rectangle, Howell B-4", 0.015)

    def test_a_dim_light_near_and_bright_ones_far(self):
        """What a light sends in all says little about what comes here: of two thousand watts two are nearly all of it."""
        g = Gltf()
        floor(g, 5)
        square(g, .5, 2, 3.0)
        g.light("point", .16, (0, .02, 0))
        g.light("point", 100, (3, 4, 0))
        g.light("spot", 50, (0, 3, 4), (0, 0, 0), cone=(0.2, 0.5))
        g.light("directional", 2, (0, 1, 0), (1, 0, 0), up=(0, 0, 1))
        expected = .16 / .02 ** 2 + 100 * .8 / 25 + 50 * .6 / 25 + 2 * math.sqrt(.5) + 3 * below_square(.5, 2)
        for spp, tolerance in ((16, 0.02), (1024, 0.002)):
            value, picture = irradiance(g, (0, 0, 0), "near_and_far.gltf", spp=spp)
            self.row("range", f"a watt 2 cm off, two thousand further off, {spp} samples", picture, value, expected, "the sum of five lights", tolerance)

    def test_grazing_by_a_tenth_of_a_degree(self):
        """A white floor in a white world, seen at 0.1 degrees, is white."""
        g = Gltf()
        floor(g, 1e4, albedo=1.0)
        a = math.radians(0.1)
        picture = daemon.twice(g.save(daemon.folder, "grazing.gltf"), size=(8, 8), spp=16, arguments=["--background", "1,1,1"],
                               camera=(0, math.sin(a), math.cos(a), 0, 0, 0, 0, 1, 0, 0.01))
        self.row("angle", "a white floor in a white world seen at 89.9°, its worst pixel", picture, numpy.abs(picture.radiance - 1).max(), 0, "conservation", 1e-5)


def lit_room(g, s, at=(0.0, 0.0, 0.0)):
    """A lamp, a point light and a spot over blocks, all lengths times s: radiance and irradiance stay what they are."""
    place = {"translation": list(at)}
    wall = g.material("wall", (.7, .5, .3))
    shape = lambda parts: ([[c * s for c in p] for p in parts[0]], parts[1])
    g.place(*shape(box((-2, 0, -2), (2, 2.5, 2), inward=True)), wall, **place)
    g.place(*shape(box((-1, 0, -.5), (-.3, .8, .3))), wall, **place)
    g.place(*shape(quad((-.4, 2.4, -.4), (.4, 2.4, -.4), (.4, 2.4, .4), (-.4, 2.4, .4))), g.material("lamp", (0, 0, 0), (3, 3, 3)), **place)
    here = lambda *p: [c * s + o for c, o in zip(p, at)]
    g.light("point", 1.5 * s * s, here(1.5, 1.2, 1), here(1.5, 0, 1))
    g.light("spot", 4.0 * s * s, here(-1.5, 2, 1.5), here(0, 0, 0), cone=(0.2, 0.5), up=(0, 1, 0))
    return (*here(1.7, 1.6, 1.9), *here(0, .8, 0), 0, 1, 0, 70)


class Anywhere(HardCase):
    """One room at many scales and places. Same samples: what differs is rounding, and the few paths that it turns."""

    @classmethod
    def setUpClass(cls):
        g = Gltf()
        camera = lit_room(g, 1.0)
        cls.usual = daemon.render(g.save(daemon.folder, "room.gltf"), size=(48, 48), spp=64, camera=camera).radiance

    def check(self, kind, case, picture):
        self.row(kind, case + ", its mean", picture, picture.mean(), self.usual.mean(), "the room of 4 m at the origin", 2e-3)
        self.row(kind, case + ", relMSE", picture, relmse(picture.radiance, self.usual), 0, "the room of 4 m at the origin", 2e-3)

    def test_scales(self):
        for s in SCALES:
            g = Gltf()
            camera = lit_room(g, s)
            self.check("size", f"a lit room of {4 * s:g} m", daemon.twice(g.save(daemon.folder, "scaled.gltf"), size=(48, 48), spp=64, camera=camera))

    def test_far_away_by_a_node(self):
        g = Gltf()
        camera = lit_room(g, 1.0, (1e5, 0.0, -1e5))
        scene = g.save(daemon.folder, "far.gltf")
        # Lights and cameras are placed in double precision too: 1e5 m off, a float would be 8 mm coarse.
        self.check("place", "a lit room 100 km from the origin", daemon.twice(scene, size=(48, 48), spp=64, camera=camera))


class Odd(HardCase):
    def test_shading_normals_that_look_away(self):
        """Normals that point into the floor count by the side that they are on: nothing is black, nothing gained."""
        for up in (1, -1):
            g = Gltf()
            positions, triangles = quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5))
            g.node(mesh=g.mesh(positions, triangles, g.material("floor", (.5,) * 3), normals=[(0.6, .8 * up, 0)] * 4))
            picture = daemon.twice(g.save(daemon.folder, "away.gltf"), size=(8, 8), spp=256, camera=(0, 2, 3, 0, 0, 0, 0, 1, 0, 1),
                                   arguments=["--background", "1,1,1"])
            self.row("away", f"normals that lean by 37° {'up' if up > 0 else 'into the floor'}, in a white world", picture, picture.mean(), 0.5, "albedo", 0.01)

    def test_lamps_without_area_are_no_lamps(self):
        means = []
        for extra in (False, True):
            g = Gltf()
            floor(g, 5)
            square(g, .5, 1, 1.0)
            if extra:
                glow = g.material("needle", (0, 0, 0), (1e6,) * 3)
                g.place([(0, .5, 0), (1, .5, 0), (2, .5, 0)], [(0, 1, 2)], glow)
                g.place([(0, .5, 0), (0, .5, 0), (0, .5, 0)], [(0, 1, 2)], glow)
            means.append(irradiance(g, (0, 0, 0), "no_area.gltf", spp=64)[0])
        self.assertEqual(means[0], means[1])

    def test_a_light_that_is_no_number_is_refused(self):
        g = Gltf()
        floor(g, 5)
        scene = g.save(daemon.folder, "nan.gltf")
        for intensity in ("nan", "inf", "-1"):
            with self.assertRaises(Failed, msg=intensity):
                daemon.render(scene, size=(8, 8), camera=(0, 2, 3, 0, 0, 0, 0, 1, 0, 10), arguments=["--light", f"point:at=0,1,0,intensity={intensity}"])
        g.light("point", 1.0, (0, 1, 0))
        g.json["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = float("nan")
        with self.assertRaises(Failed) as refused:
            daemon.render(g.save(daemon.folder, "nan_light.gltf"), size=(8, 8), camera=(0, 2, 3, 0, 0, 0, 0, 1, 0, 10))
        self.assertIn("scene-invalid", refused.exception.text)


if __name__ == "__main__":
    unittest.main()
