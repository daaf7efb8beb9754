"""Lengths many decades apart: small lamps close over floors as wide as the earth, thin things on them, skies and rooms of such a
size. Rays start where they are, not a share of the floor's width above it."""
import math
import unittest

import numpy

from render import Daemon
from writers import Gltf, box, quad

daemon = Daemon()
WAYS = (("pt", {}), ("direct", {}), ("vct", {"vct.bounces": 0, "vct.resolution": 32}))


def setUpModule():
    unittest.enterModuleContext(daemon)


def floor(g, half, at=(0, 0, 0), albedo=0.5, split=False):
    """Its two triangles meet below the lamp if `split`. A rasteriser leaves gaps of a metre there, so that this is for `pt` alone."""
    right = half if split else 0.7 * half
    g.place(*quad((-half, 0, half), (right, 0, half), (right, 0, -half), (-half, 0, -half)), g.material("floor", (albedo,) * 3), translation=list(at))


def square_lamp(g, half, y, at=(0, 0, 0)):
    """It looks down."""
    g.place(*quad((-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)), g.material("lamp", (0, 0, 0), (1, 1, 1)),
            translation=list(at))


def below_square(half, height):
    a = half / math.hypot(half, height)
    return 4 * a * math.atan(a)


def seen(g, name, eye, target, technique="pt", options=None, spp=None, arguments=(), vfov=0.1, up=(0, 1, 0)):
    scene = g if isinstance(g, str) else g.save(daemon.folder, name)
    own = {"pt.depth": 1} if technique == "pt" else {}
    picture = daemon.render(scene, (8, 8), spp or (256 if technique == "pt" else 1), (*eye, *target, *up, vfov), {**own, **(options or {})},
                            ["--technique", technique, *arguments])
    return picture.radiance[:, :, 1].astype(float)


class Lamps(unittest.TestCase):
    def check(self, half, size, at=(0, 0, 0), slant=3, ways=WAYS, tolerance=0.01, vfov=0.1):
        """A square of this size at as great a height, over the middle of a floor: what comes to the place below it."""
        g = Gltf()
        floor(g, half, at, split=len(ways) == 1)
        square_lamp(g, size / 2, size, at)
        expected = below_square(size / 2, size)
        scene = g.save(daemon.folder, "lamp.gltf")
        for technique, options in ways:
            with self.subTest(half=half, size=size, at=at, slant=slant, technique=technique):
                eye = (at[0] + slant * size, at[1] + size, at[2])
                got = seen(scene, "", eye, at, technique, options, vfov=vfov).mean() * math.pi / 0.5
                print(f"floor {2 * half:g} m, lamp {size:g} m, {technique}: {got / expected:.5f}")
                self.assertLess(abs(got / expected - 1), tolerance)

    def test_a_tenth_of_a_millimetre_over_twenty_thousand_kilometres(self):
        self.check(1e7, 1e-4, ways=WAYS[:1])

    def test_other_sizes_of_both(self):
        for half, size in ((1e3, 1e-4), (1e7, 1e-6), (1e9, 1e-3), (20.0, 1e-5)):
            self.check(half, size, ways=WAYS[:1])
        for half, size in ((1e5, 1e-2), (1e7, 1.0), (3e-1, 1e-7)):
            self.check(half, size)

    def test_elsewhere(self):
        self.check(1e7, 1e-2, (32.5, 8.25, -16.0), ways=WAYS[:1])
        self.check(1e4, 1e-2, (-3.0, 4.0, 5.0), ways=WAYS[:1])

    def test_seen_along_the_floor(self):
        self.check(1e7, 1e-3, slant=100, ways=WAYS[:1], vfov=1e-3)

    def test_point_lights(self):
        for half, height, ways in ((1e7, 1e-4, WAYS[:1]), (1e7, 1e-2, WAYS[:1]), (1e7, 2.0, (*WAYS, ("direct", {"direct.shadows": "map"})))):
            g = Gltf()
            floor(g, half)
            scene = g.save(daemon.folder, "point.gltf")
            for technique, options in ways:
                with self.subTest(half=half, height=height, technique=technique, options=options):
                    got = seen(scene, "", (3 * height, height, 0), (0, 0, 0), technique, options,
                               arguments=["--light", f"point:at=0,{height!r},0,intensity={height ** 2!r}"]).mean() * math.pi / 0.5
                    self.assertLess(abs(got - 1), 0.01)

    def test_a_lamp_as_wide_as_the_earth_over_a_plate(self):
        g = Gltf()
        g.place(*quad((-1e-3, 0, 1e-3), (1e-3, 0, 1e-3), (1e-3, 0, -1e-3), (-1e-3, 0, -1e-3)), g.material("plate", (0.5,) * 3))
        square_lamp(g, 1e7, 1.0)
        got = seen(g, "wide.gltf", (0, 1e-3, 2e-3), (0, 0, 0), options={"pt.depth": 2}).mean() / 0.5
        self.assertLess(abs(got - 1), 0.01)


class Shadows(unittest.TestCase):
    def test_a_thin_box_on_a_huge_floor(self):
        """1 mm high, in light that falls at 45 degrees: its shadow is 1 mm wide, and all about it is lit."""
        g = Gltf()
        floor(g, 1e7)
        g.place(*box((-1e-3, 0, -1e-2), (1e-3, 1e-3, 1e-2)), g.material("box", (0.5,) * 3))
        scene = g.save(daemon.folder, "box.gltf")
        light = ["--light", "directional:direction=1,-1,0,intensity=2"]
        for x, expected in ((-1.5e-3, 1), (1.5e-3, 0), (1.95e-3, 0), (2.05e-3, 1), (3e-3, 1), (0.5, 1), (50, 1)):
            with self.subTest(x=x):
                got = seen(scene, "", (x, 1e-2, 0), (x, 0, 0), spp=16, arguments=light, up=(0, 0, -1)).mean()
                self.assertLess(abs(got / (math.sqrt(2) * 0.5 / math.pi) - expected), 1e-3)

    def test_a_sheet_a_micrometre_above(self):
        g = Gltf()
        floor(g, 1e7)
        g.place(*quad((-1, 1e-6, 1), (1, 1e-6, 1), (1, 1e-6, -1), (-1, 1e-6, -1)), g.material("sheet", (0.25,) * 3))
        scene = g.save(daemon.folder, "sheet.gltf")
        for x, albedo in ((0, 0.25), (3, 0.5)):
            got = seen(scene, "", (x, 2, 0), (x, 0, 0), arguments=["--light", "point:at=0,5,0,intensity=25"], up=(0, 0, -1)).mean()
            d = math.hypot(x, 5)
            self.assertLess(abs(got / (25 * 5 / d ** 3 * albedo / math.pi) - 1), 1e-3)


class Even(unittest.TestCase):
    """Under an even sky, and in rooms that glow alike, no place is darker by a shadow of its own."""

    def test_floors_of_every_size_and_slant(self):
        for half in (1.0, 1e3, 1e5, 1e7):
            for slope in (0.0, 0.3):
                g = Gltf()
                s, c = math.sin(slope), math.cos(slope)
                g.place(*quad((-half * c, -half * s, half), (half * c, half * s, half), (half * c, half * s, -half), (-half * c, -half * s, -half)),
                        g.material("floor", (0.5,) * 3))
                scene = g.save(daemon.folder, "even.gltf")
                for height in (1e-2 * half, 0.3 * half):
                    with self.subTest(half=half, slope=slope, height=height):
                        got = seen(scene, "", (-height * s, height * c, 0.3 * height), (0, 0, 0), spp=16, vfov=60,
                                   arguments=["--background", "1,1,1"], options={"pt.depth": 4})
                        self.assertLess(float(numpy.abs(got - 0.5).max()), 2e-3)

    def test_a_floor_of_needles(self):
        """Ten kilometres long, a metre wide: edges next to parallel."""
        g = Gltf()
        positions = [p for i in range(-8, 9) for p in ((-1e4, 0, -i), (1e4, 0, -i))]
        g.place(positions, [t for i in range(16) for t in ((2 * i, 2 * i + 1, 2 * i + 3), (2 * i, 2 * i + 3, 2 * i + 2))],
                g.material("floor", (0.5,) * 3))
        got = seen(g, "needles.gltf", (0, 2, 1), (0, 0, 0), spp=16, vfov=60, arguments=["--background", "1,1,1"], options={"pt.depth": 4})
        self.assertLess(float(numpy.abs(got - 0.5).max()), 2e-3)

    def test_closed_rooms(self):
        """No light is lost at edges, none comes in: all walls glow, and reflect half."""
        for half in (1e4, 1e7):
            for turned in ([0, 0, 0, 1], [0.1, 0.2, 0.3, math.sqrt(0.86)]):
                g = Gltf()
                g.place(*box((-half,) * 3, (half,) * 3, inward=True), g.material("walls", (0.5,) * 3, (1, 1, 1)), rotation=turned)
                g.place(*box((-1e-3,) * 3, (1e-3,) * 3), g.material("crumb", (0.5,) * 3), translation=[half / 2, 0, 0])
                got = seen(g, "closed.gltf", (0, 0, 0), (0, 0, -1), spp=64, vfov=100, options={"pt.depth": 3},
                           arguments=["--background", "100,100,100"])
                self.assertLess(abs(float(got.mean()) / 1.875 - 1), 0.01)


if __name__ == "__main__":
    unittest.main()
