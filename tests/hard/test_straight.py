"""Light straight from its source where numbers are short, by every technique: of any size and at any place, next to what it lights
or next to nothing in size, at grazing angles, from thousands of lamps, over slivers, from behind. `vct` goes without its bounces,
so that its voxels have no part in it."""
import math
import unittest

from render import Daemon
from table import TECHNIQUES, HardCase
from writers import Gltf, quad

daemon = Daemon()
ALBEDO = 0.5
OPTIONS = {"pt": {"pt.depth": 1}, "direct": {}, "vct": {"vct.bounces": 0, "vct.resolution": 16}}


def setUpModule():
    unittest.enterModuleContext(daemon)


def floor(g, half=10.0, **place):
    g.place(*quad((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)), g.material("floor", (ALBEDO,) * 3), **place)


def ceiling(g, half, height, radiance=1.0, name="lamp", **place):
    """A square lamp that looks down."""
    g.place(*quad((-half, height, -half), (half, height, -half), (half, height, half), (-half, height, half)),
            g.material(name, (0, 0, 0), (radiance,) * 3), **place)


def below_square(half, height):
    """Irradiance below the middle of a square of radiance 1."""
    a = half / math.hypot(half, height)
    return 4 * a * math.atan(a)


def beside_wall(width, height, distance):
    """Irradiance on the floor before the middle of a rectangle of radiance 1 that stands on it."""
    x, y = height / (width / 2), distance / (width / 2)
    a = 1 / math.hypot(x, y)
    return math.atan(1 / y) - a * y * math.atan(a)


SQUARE = "form factor of a square, Howell B-3"
POINT = "I cos θ / d²"


class Straight(HardCase):
    def check(self, kind, case, g, expected, source, pt=0.005, raster=1e-3, spp=(256, 1, 1), scale=1.0, at=(0.0, 0.0, 0.0), eye=(0, .4, .3), fov=.05,
              size=(8, 8)):
        """The irradiance at a place of the floor, seen by a narrow camera, by each technique. Tolerances: of the path tracer, which has
        noise, and of the two that have none."""
        daemon.candil("load", g.save(daemon.folder, "case.glb"), "--name", "case")
        camera = [*(scale * e + a for e, a in zip(eye, at)), *at, 0, 1, 0, fov]
        for technique, samples in zip(TECHNIQUES, spp):
            picture = daemon.twice("case", size, samples, camera, options=OPTIONS[technique], arguments=["--technique", technique])
            self.row(kind, case, picture, picture.mean() * math.pi / ALBEDO, expected, source, pt if technique == "pt" else raster)
        daemon.candil("unload", "case")

    def test_of_any_size_and_anywhere(self):
        for kind, case, scale, at in (
                *(("size", f"a room of {s:g} m, a lamp over a floor", s, (0, 0, 0)) for s in (1e-6, 1e-3, 1e3, 1e6)),
                *(("place", f"a lamp over a floor, {d:g} m from the origin", 1, (d, 0, -d)) for d in (1e3, 1e5, 6.4e6))):
            g = Gltf()
            place = {"scale": [scale] * 3, "translation": list(at)}
            floor(g, **place)
            ceiling(g, .5, 1, **place)
            self.check(kind, case, g, below_square(.5, 1), SQUARE, scale=scale, at=at)

    def test_below_a_lamp_that_is_close(self):
        for height in (.1, .01, .001, 1e-4):
            g = Gltf()
            floor(g, 1)
            ceiling(g, .5, height)
            self.check("near", f"{height:g} m below a lamp of 1 m", g, below_square(.5, height), SQUARE, scale=height, fov=.5)

    def test_before_a_lamp_that_stands_on_the_floor(self):
        for distance in (.5, .05, .005, 5e-4):
            g = Gltf()
            floor(g, 1)
            g.place(*quad((-1, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 1, 0)), g.material("lamp", (0, 0, 0), (1, 1, 1)))
            self.check("near", f"{distance:g} m before a lamp that stands on the floor", g, beside_wall(2, 1, distance),
                       "form factor of a rectangle, Howell B-4", at=(0, 0, distance), scale=distance, fov=.5, pt=.01)

    def test_more_samples_near_a_lamp(self):
        for spp in (4, 16, 64):
            g = Gltf()
            floor(g, 1)
            ceiling(g, .5, .01)
            self.check("near", f"1 cm below a lamp of 1 m, {spp} samples", g, below_square(.5, .01), SQUARE, scale=.01, spp=(spp,) * 3, pt=.05)

    def test_a_lamp_in_the_plane_of_the_ceiling(self):
        g = Gltf()
        floor(g)
        black = g.material("ceiling", (0, 0, 0))
        for x0, z0, x1, z1 in ((-5, -5, 5, -.5), (-5, .5, 5, 5), (-5, -.5, -.5, .5), (.5, -.5, 5, .5)):
            g.place(*quad((x0, 1, z0), (x1, 1, z0), (x1, 1, z1), (x0, 1, z1)), black)
        ceiling(g, .5, 1)
        self.check("near", "a lamp let into the ceiling, edge to edge", g, below_square(.5, 1), SQUARE)

    def test_a_screen_that_touches_the_lamp(self):
        """Half of the lamp is covered, by a plate that all but lies on it."""
        g = Gltf()
        floor(g)
        ceiling(g, .5, 1)
        g.place(*quad((0, 1 - 1e-5, -.6), (.6, 1 - 1e-5, -.6), (.6, 1 - 1e-5, .6), (0, 1 - 1e-5, .6)), g.material("plate", (0, 0, 0)))
        self.check("near", "half of a lamp under a plate 1e-05 m off it", g, below_square(.5, 1) / 2, SQUARE, pt=.01, raster=.02, spp=(256, 64, 64))

    def test_two_floors_in_one_plane(self):
        g = Gltf()
        floor(g)
        floor(g)
        g.light("point", 1.0, (0, 1, 0))
        self.check("near", "two floors in one plane", g, 1, POINT)

    def test_a_lamp_that_shrinks(self):
        """Of one intensity, 1 W/sr straight down."""
        for half in (.05, 1e-3, 1e-5):
            g = Gltf()
            floor(g)
            ceiling(g, half, 1, 1 / (4 * half * half))
            self.check("small", f"a lamp of {2 * half:g} m, 1 m above", g, below_square(half, 1) / (4 * half * half), SQUARE)

    def test_lamps_without_area(self):
        g = Gltf()
        floor(g)
        ceiling(g, .5, 1)
        glow = g.material("needle", (0, 0, 0), (1e6,) * 3)
        g.place([(0, .5, 0), (1, .5, 0), (2, .5, 0)], [(0, 1, 2)], glow)
        g.place([(0, .5, 0), (0, .5, 0), (0, .5, 0)], [(0, 1, 2)], glow)
        self.check("small", "two lamps without area beside one with", g, below_square(.5, 1), SQUARE)

    def test_narrow_spots(self):
        """In the beam, halfway down its edge, and beside it; straight down and aslant."""
        for degrees, tolerance in ((1, 1e-3), (.1, 5e-3), (.01, .02)):
            inner, outer = (math.radians(degrees / 2) * c for c in (.6, 1))
            for case, angle in (("in", 0), ("at the edge of", .8 * outer), ("beside", 1.1 * outer)):
                ramp = (math.cos(angle) - math.cos(outer)) / (math.cos(inner) - math.cos(outer))
                for aslant in (0, 1):
                    g = Gltf()
                    floor(g, 4 * math.radians(degrees))
                    g.light("spot", 1.0, (-2 * aslant, 2, 0), (0, 0, 0), cone=(inner, outer))
                    x = 2 * math.tan(aslant * math.pi / 4 + angle) - 2 * aslant
                    flat = 4 / (4 + (x + 2 * aslant) ** 2) ** 1.5 * 2 / 4
                    self.check("small", f"{case} the beam of a spot of {degrees:g}°{', aslant' if aslant else ''}", g,
                               min(max(ramp, 0), 1) ** 2 * flat, POINT + ", and the cone's ramp", at=(x, 0, 0), scale=.5 * math.radians(degrees),
                               pt=tolerance, raster=tolerance)

    def test_a_point_light_at_any_distance(self):
        for height in (1e-4, 1e-2, 1e3, 1e6):
            g = Gltf()
            floor(g, 2 * height)
            g.light("point", height * height, (0, height, 0))
            self.check("near" if height < 1 else "size", f"a point light {height:g} m above", g, 1, POINT, scale=height)

    def test_grazing_suns(self):
        for degrees in (89, 89.9, 89.99):
            a = math.radians(degrees)
            g = Gltf()
            floor(g)
            g.light("directional", 1.0, (0, 0, 0), (math.sin(a), -math.cos(a), 0), up=(0, 0, 1))
            self.check("angle", f"a sun at {degrees:g}° from the normal", g, math.cos(a), "E cos θ")

    def test_grazing_points(self):
        for height in (1e-1, 1e-2, 1e-3):
            g = Gltf()
            floor(g, 1)
            g.light("point", 1.0, (-1, height, 0))
            self.check("angle", f"a point light 1 m aside, {height:g} m high", g, height / math.hypot(1, height) ** 3, POINT)

    def test_a_view_along_the_floor(self):
        for degrees in (89, 89.9, 89.99):
            a = math.radians(degrees)
            g = Gltf()
            floor(g, 1)
            g.light("directional", 1.0, (0, 1, 0), (0, 0, 0), up=(0, 0, 1))
            self.check("angle", f"a floor seen at {degrees:g}° from its normal", g, 1, "E cos θ", eye=(0, math.cos(a), math.sin(a)), fov=(90 - degrees) / 2)

    def test_a_floor_of_slivers(self):
        for width in (1e-3, 1e-5):
            g = Gltf()
            count = 200
            edges = [(i - count / 2) * width for i in range(count + 1)]
            positions = [[x, 0, z] for x in edges for z in (10, -10)]
            triangles = [t for i in range(0, 2 * count, 2) for t in ((i, i + 2, i + 1), (i + 1, i + 2, i + 3))]
            g.place(positions, triangles, g.material("floor", (ALBEDO,) * 3))
            ceiling(g, .5, 1)
            self.check("thin", f"a floor of strips 20 m long and {width:g} m wide", g, below_square(.5, 1), SQUARE, scale=min(1, 1e3 * width))

    def test_a_lamp_of_slivers(self):
        """The square in strips: as many lamps, each a thousand times as long as it is wide."""
        g = Gltf()
        floor(g)
        glow, count = g.material("lamp", (0, 0, 0), (1,) * 3), 1000
        edges = [i / count - .5 for i in range(count + 1)]
        positions = [[x, 1, z] for x in edges for z in (-.5, .5)]
        g.place(positions, [t for i in range(0, 2 * count, 2) for t in ((i, i + 2, i + 1), (i + 1, i + 2, i + 3))], glow)
        self.check("thin", "a lamp of 2,000 slivers", g, below_square(.5, 1), SQUARE + "; points on them have noise", pt=.02, raster=.02, spp=(256, 64, 64))

    def test_radiances(self):
        for radiance in (1e-20, 1e-6, 1e8, 1e12):
            g = Gltf()
            floor(g)
            ceiling(g, .5, 1, radiance)
            self.check("range", f"a lamp of radiance {radiance:g}", g, below_square(.5, 1) * radiance, SQUARE)

    def test_a_dim_lamp_near_and_a_bright_one_far(self):
        g = Gltf()
        floor(g, 1)
        g.place(*quad((-.01, 0, 0), (.01, 0, 0), (.01, .01, 0), (-.01, .01, 0)), g.material("dim", (0, 0, 0), (.01,) * 3))
        ceiling(g, 500, 1e5, 1e2, "bright")
        self.check("range", "5 mm before a lamp of 2 cm and radiance 0.01, 100 km below one of 1 km and radiance 100", g,
                   .01 * beside_wall(.02, .01, .005) + 1e2 * below_square(500, 1e5), "form factors, Howell B-4 and B-3", scale=.01, at=(0, 0, .005))

    def test_thousands_of_points(self):
        g = Gltf()
        floor(g)
        expected = 0
        for i in range(2000):
            a, r = i * 2.399963, .05 * math.sqrt(i)
            g.light("point", .001 * (1 + i % 7), (r * math.cos(a), 1 + i % 3, r * math.sin(a)))
            expected += .001 * (1 + i % 7) * (1 + i % 3) / (r * r + (1 + i % 3) ** 2) ** 1.5
        self.check("many", "2,000 point lights", g, expected, "their sum; a pixel's sample asks 64 of them", pt=.02, raster=.02, spp=(1024, 64, 64))

    def test_thousands_of_lamps(self):
        """Each of 2 cm, two metres up: by its middle alone the formula is right to the fifth digit."""
        g = Gltf()
        floor(g)
        positions, triangles, expected = [], [], 0
        for i in range(2500):
            x, z = (i % 50 - 24.5) * .1, (i // 50 - 24.5) * .1
            corners, two = quad((x - .01, 2, z - .01), (x + .01, 2, z - .01), (x + .01, 2, z + .01), (x - .01, 2, z + .01))
            triangles += [tuple(c + len(positions) for c in t) for t in two]
            positions += corners
            expected += .02 ** 2 * 4 / (x * x + z * z + 4) ** 2
        g.place(positions, triangles, g.material("lamps", (0, 0, 0), (1,) * 3))
        self.check("many", "2,500 lamps of 2 cm", g, expected, "their sum; points on them have noise", pt=.02, raster=.02, spp=(1024, 64, 64))

    def test_many_samples(self):
        g = Gltf()
        floor(g)
        ceiling(g, .5, 1)
        self.check("many", "one pixel, 65,536 samples (pt), 1,024 (direct, vct)", g, below_square(.5, 1), SQUARE, pt=2e-4, raster=1e-4,
                   spp=(65536, 1024, 1024), size=(1, 1))

    def test_behind(self):
        below, through = Gltf(), Gltf()
        floor(below)
        below.light("point", 1e6, (0, -1e-3, 0))
        self.check("away", "a point light of 1e+06 W/sr, 1 mm below the floor", below, 0, "nothing", pt=0, raster=0)
        floor(through)
        s = .5
        through.place(*quad((-s, 1, s), (s, 1, s), (s, 1, -s), (-s, 1, -s)), through.material("lamp", (0, 0, 0), (1e6,) * 3))
        self.check("away", "a lamp of radiance 1e+06 that shines up", through, 0, "nothing", pt=0, raster=0)

    def test_shading_normals_that_look_away(self):
        """They count by the side that they are on."""
        for up in (1, -1):
            g = Gltf()
            positions, triangles = quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5))
            g.node(mesh=g.mesh(positions, triangles, g.material("floor", (ALBEDO,) * 3), normals=[(.6, .8 * up, 0)] * 4))
            g.light("directional", 1.0, (0, 1, 0), (0, 0, 0), up=(0, 0, 1))
            self.check("away", f"normals that lean by 37° {'up' if up > 0 else 'into the floor'}", g, .8, "E cos θ of the leaning normal")


if __name__ == "__main__":
    unittest.main()
