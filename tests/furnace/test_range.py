"""Lights with a range: at a distance d, max(1 - (d / range)^4, 0) of their light is left, by every technique and every way of theirs."""
import math
import unittest

import numpy

from render import Daemon, Failed
from writers import Gltf, quad

daemon = Daemon()
HEIGHT = 1.5
SIZE = 16
VIEW = 4.0
CAMERA = (0, 1, 0, 0, 0, 0, 0, 0, -1, 40)


def setUpModule():
    unittest.enterModuleContext(daemon)


def window(d, reach):
    return numpy.clip(1 - (d / reach) ** 4, 0, 1) if reach else numpy.ones_like(d)


def places():
    """The floor's points behind the pixels' middles."""
    x = (numpy.arange(SIZE) + 0.5) / SIZE * VIEW - VIEW / 2
    return numpy.meshgrid(x, x)


def irradiance(x, z, lights):
    """W/m² on the floor, of lights (x, height, z, intensity, range, cone or None) that look down."""
    total = numpy.zeros_like(x)
    for at, height, to, intensity, reach, cone in lights:
        d = numpy.sqrt((x - at) ** 2 + height ** 2 + (z - to) ** 2)
        ramp = 1.0
        if cone:
            inner, outer = (math.cos(math.radians(a)) for a in cone)
            ramp = numpy.clip((height / d - outer) / (inner - outer), 0, 1) ** 2
        total += intensity * ramp * height / d ** 3 * window(d, reach)
    return total


def floor(lights=(), name="floor.gltf"):
    g = Gltf()
    g.place(*quad((-9, 0, 9), (9, 0, 9), (9, 0, -9), (-9, 0, -9)), g.material("floor", (0.8,) * 3))
    for x, y, z, intensity, reach, cone in lights:
        g.light("spot" if cone else "point", intensity, (x, y, z), (x, y - 1, z), cone=cone and [math.radians(c) for c in cone])
        if reach is not None:
            g.json["extensions"]["KHR_lights_punctual"]["lights"][-1]["range"] = reach
    return g.save(daemon.folder, name)


def words(lights):
    out = []
    for x, y, z, intensity, reach, cone in lights:
        text = f"spot:at={x},{y},{z},to={x},{y - 1},{z},cone={cone[0]},{cone[1]}" if cone else f"point:at={x},{y},{z}"
        out += ["--light", text + f",intensity={intensity}" + (f",range={reach}" if reach is not None else "")]
    return out


def seen(scene, technique, spp=1, options=None, arguments=()):
    picture = daemon.render(scene, (SIZE, SIZE), spp, CAMERA, options,
                            ["--technique", technique, "--orthographic", repr(VIEW), *arguments])
    return picture.radiance[:, :, 1].astype(float) * math.pi / 0.8


class Range(unittest.TestCase):
    KINDS = {
        "point": [(0, HEIGHT, 0, 10, 2.0, None)],
        "spot": [(0.3, HEIGHT, -0.2, 10, 1.9, (20, 50))],
        "beside one without": [(-0.5, HEIGHT, 0, 5, None, None), (1, HEIGHT, 0.5, 10, 1.7, None)],
        "far too short": [(0, HEIGHT, 0, 10, 1e-30, None), (0, HEIGHT, 0, 1, None, None)],
        "endless": [(0, HEIGHT, 0, 10, 1e30, None)],
    }

    def test_direct_light_in_closed_form(self):
        x, z = places()
        for name, lights in self.KINDS.items():
            scene = floor(lights)
            expected = irradiance(x, z, lights)
            for technique, options in (("direct", {}), ("direct", {"direct.shadows": "map"}),
                                       ("vct", {"vct.bounces": 0, "vct.resolution": 32})):
                with self.subTest(lights=name, technique=technique, options=options):
                    self.assertLess(float(numpy.abs(seen(scene, technique, options=options) - expected).max() / expected.max()), 1e-4)

    def test_path_tracing(self):
        """A pixel of `pt` is a mean over its area: of 32 x 32 points of it here."""
        parts = (numpy.arange(SIZE * 32) + 0.5) / (SIZE * 32) * VIEW - VIEW / 2
        x, z = numpy.meshgrid(parts, parts)
        for name, lights in self.KINDS.items():
            expected = irradiance(x, z, lights).reshape(SIZE, 32, SIZE, 32).mean(axis=(1, 3))
            for tree in ("on", "off"):
                with self.subTest(lights=name, tree=tree):
                    got = seen(floor(lights), "pt", 64, {"pt.depth": 1, "pt.light_tree": tree})
                    self.assertLess(float(numpy.abs(got - expected).mean() / expected.mean()), 0.02 if tree == "on" else 0.08)
                    self.assertLess(abs(float(got.mean() / expected.mean()) - 1), 0.004)
                    self.assertTrue((got[expected == 0] == 0).all())

    def test_the_tree_leaves_out_lights_that_do_not_reach(self):
        """64 lights, each over its own patch: with the tree each place is lit by one or few, almost without noise."""
        lights = [(i - 3.5, 0.4, j - 3.5, 1.0, 0.7, None) for i in range(8) for j in range(8)]
        x, z = places()
        scene = floor(lights)
        expected = irradiance(x, z, lights)
        error = {}
        for tree in ("on", "off"):
            got = seen(scene, "pt", 64, {"pt.depth": 1, "pt.light_tree": tree})
            error[tree] = float(numpy.sqrt(((got - expected) ** 2).mean()) / expected.mean())
            self.assertLess(abs(float(got.mean() / expected.mean()) - 1), 0.05)
        print("relative RMSE of 64 short lights:", error)
        self.assertLess(error["on"], 0.25 * error["off"])

    def test_a_request_is_like_a_file(self):
        for name, lights in self.KINDS.items():
            for technique, spp in (("pt", 4), ("direct", 1)):
                with self.subTest(lights=name, technique=technique):
                    edited = seen(floor(), technique, spp, arguments=words(lights))
                    filed = seen(floor(lights), technique, spp)
                    # A file's cone is in radians and a request's in degrees.
                    self.assertLess(float(numpy.abs(edited - filed).max()), 1e-5 if name == "spot" else 1e-30)

    def test_no_range_has_the_bits_of_before(self):
        bare, zero = ([(0, HEIGHT, 0, 10, reach, None)] for reach in (None, 0))
        for technique in ("pt", "direct"):
            reference = seen(floor(bare), technique, 4)
            for other in (seen(floor(zero), technique, 4), seen(floor(), technique, 4, arguments=words(zero))):
                self.assertTrue((reference == other).all())

    def test_by_way_of_a_mirror(self):
        """What a mirror sends to a ceiling is as bright as at the mirror's place within the range, and then thins out by the whole way."""
        for reach in (None, 1.2, 1.03):
            g = Gltf()
            g.place(*quad((-.3, 0, .3), (.3, 0, .3), (.3, 0, -.3), (-.3, 0, -.3)), g.material("mirror", (1, 1, 1), metallic=1, roughness=0, specular=1))
            g.place(*quad((-9, 2, -9), (9, 2, -9), (9, 2, 9), (-9, 2, 9)), g.material("ceiling", (0.8,) * 3))
            g.light("point", 10, (0, 1, 0))
            if reach:
                g.json["extensions"]["KHR_lights_punctual"]["lights"][-1]["range"] = reach
            scene = g.save(daemon.folder, "mirror.gltf")
            picture = daemon.render(scene, (64, 64), 64, (0, 1, 0, 0, 2, 0, 0, 0, 1, 40), {"pt.depth": 2}, ["--orthographic", "1"])
            got = picture.radiance[:, :, 1].astype(float) * math.pi / 0.8
            parts = (numpy.arange(128) + 0.5) / 128 - 0.5
            x, z = numpy.meshgrid(parts, parts)
            near, far = numpy.sqrt(x ** 2 + z ** 2 + 1), numpy.sqrt(x ** 2 + z ** 2 + 9)
            expected = float((10 * (window(near, reach) / near ** 3 + 3 * window(far / 3, reach) / far ** 3)).mean())
            print(f"range {reach}: {got.mean():.4f}, expected {expected:.4f}")
            self.assertLess(abs(float(got.mean()) / expected - 1), 0.01)

    def test_refusals(self):
        for text in ("point:at=0,1,0,intensity=1,range=-1", "point:at=0,1,0,intensity=1,range=inf", "point:at=0,1,0,intensity=1,range=nan",
                     "directional:direction=0,-1,0,intensity=1,range=2", "point:at=0,1,0,intensity=1,range=1,2"):
            with self.assertRaises(Failed) as caught:
                seen(floor(), "pt", 1, arguments=["--light", text])
            self.assertEqual(caught.exception.status, 2, text)

    def test_a_file_whose_range_is_below_zero_says_so(self):
        scene = floor([(0, HEIGHT, 0, 10, -3.0, None)])
        _, out, _ = daemon.candil("load", scene, "--name", "negative", "--json")
        self.assertIn("range below zero", out)
        self.assertTrue((seen(scene, "direct") == seen(floor([(0, HEIGHT, 0, 10, None, None)], "plain.gltf"), "direct")).all())


if __name__ == "__main__":
    unittest.main()
