"""What voxel cone tracing shows through glass, beside path tracing, whose shadow rays glass stops just as well."""
import unittest

import numpy

import make
from common import WHITE, VctDaemon
from writers import Gltf, box, quad

OPEN = {"thicknessFactor": 1}
daemon = VctDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def wall_behind(glass=None, name="wall_behind.gltf", solid=False, lamp=False):
    """A wall of two colours that a light before it shines on, and between the light and the camera a sheet of glass, or a
    body. `glass`: of Gltf.material; None: nothing is there."""
    g = Gltf()
    g.place(*quad((-2, -2, 0), (0, -2, 0), (0, 2, 0), (-2, 2, 0)), g.material("left", (.8, .4, .2)))
    g.place(*quad((0, -2, 0), (2, -2, 0), (2, 2, 0), (0, 2, 0)), g.material("right", (.2, .4, .8)))
    if lamp:
        g.place(*quad((-.5, -.5, .5), (.5, -.5, .5), (.5, .5, .5), (-.5, .5, .5)), g.material("lamp", (0, 0, 0), (3, 2, 1)))
    else:
        g.light("point", 20.0, (0, 1.2, .9))
    if glass is not None and solid:
        g.place(*box((-1.5, -1.5, 1.2), (1.5, 1.5, 1.7)), g.material("glass", **glass))
    elif glass is not None:
        g.place(*quad((-1.5, -1.5, 1.2), (1.5, -1.5, 1.2), (1.5, 1.5, 1.2), (-1.5, 1.5, 1.2)), g.material("glass", **glass))
    g.camera((0, 0, 5), (0, 0, 0), 30)
    return g.save(daemon.folder, name)


def state(picture, effect="glass"):
    return [e["state"] for e in picture.report["effects"] if e["name"] == effect][0]


class Through(unittest.TestCase):
    def both(self, scene, depth, **more):
        a = daemon.vct(scene, 64, size=(48, 48), spp=4, bounces=1, **more).radiance.astype(numpy.float64)
        b = daemon.render(scene, size=(48, 48), spp=128, options={"pt.depth": depth}).radiance.astype(numpy.float64)
        # What is seen through the glass, off its rim.
        return a[8:40, 8:40], b[8:40, 8:40]

    def check(self, scene, depth, mean, error, **more):
        a, b = self.both(scene, depth, **more)
        relmse = float((((a - b) ** 2) / (b * b + .01)).mean())
        print(f"mean ratio {a.mean() / b.mean():.4f}, relMSE {relmse:.2e}")
        self.assertGreater(float(b.mean()), .05)
        self.assertLess(abs(a.mean() / b.mean() - 1), mean)
        self.assertLess(relmse, error)

    def test_thin_clear_sheet(self):
        for detail in ("half", "full"):
            self.check(wall_behind({"clear": 1, "roughness": 0}), 2, .05, .02, detail=detail)

    def test_tinted_sheet(self):
        self.check(wall_behind({"clear": 1, "roughness": 0, "albedo": (.9, .5, .2)}), 2, .05, .02)

    def test_rough_sheet(self):
        self.check(wall_behind({"clear": 1, "roughness": .3}), 2, .1, .05)

    def test_half_clear_sheet_keeps_its_own_colour(self):
        scene = wall_behind({"clear": .5, "roughness": 0, "albedo": (.5, .5, .5)})
        a, b = self.both(scene, 2)
        self.assertLess(abs(a.mean() / b.mean() - 1), .1)

    def test_solid_absorbs(self):
        inside = {"thicknessFactor": 1, "attenuationDistance": .5, "attenuationColor": [.3, .6, .9]}
        self.check(wall_behind({"clear": 1, "roughness": 0, "ior": 1.5, "volume": inside}, solid=True), 3, .06, .03)

    def test_lamp_is_seen(self):
        self.check(wall_behind({"clear": 1, "roughness": 0}, lamp=True), 2, .05, .02)

    def test_body_that_bends_nothing_is_hardly_seen(self):
        scene = wall_behind({"clear": 1, "roughness": 0, "ior": 1.0, "volume": OPEN}, solid=True)
        a, _ = self.both(scene, 3)
        plain = daemon.vct(wall_behind(), 64, size=(48, 48), spp=4, bounces=1).radiance[8:40, 8:40].astype(numpy.float64)
        self.assertLess(abs(a.mean() / plain.mean() - 1), .02)
        self.assertLess(float(numpy.median(abs(a - plain) / (plain + .01))), .05)

    def test_background_is_seen(self):
        g = Gltf()
        g.place(*quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), g.material("glass", clear=1, roughness=0, ior=1.5))
        g.camera((0, 0, 3), (0, 0, 0), 20)
        picture = daemon.vct(g.save(daemon.folder, "pane.gltf"), arguments=WHITE)
        # What is reflected and what comes through are all of it.
        self.assertLess(float(abs(picture.radiance - 1).max()), .01)


class Effect(unittest.TestCase):
    def test_off_it_is_opaque(self):
        clear = wall_behind({"clear": 1, "roughness": .5, "albedo": (.5, .6, .7)})
        opaque = wall_behind({"roughness": .5, "albedo": (.5, .6, .7)}, name="opaque.gltf")
        off = daemon.vct(clear, arguments=["--effects=-glass"])
        self.assertEqual(state(off), "switched-off")
        self.assertTrue(numpy.allclose(off.radiance, daemon.vct(opaque).radiance, rtol=1e-5, atol=1e-6))
        on = daemon.vct(clear)
        self.assertEqual(state(on), "simulated")
        self.assertGreater(float(abs(on.radiance - off.radiance).max()), .05)

    def test_forced_without_glass_it_changes_nothing(self):
        scene = make.cornell(daemon.folder)
        auto, forced = (daemon.vct(scene, arguments=a) for a in ((), ["--effects=+glass"]))
        self.assertEqual((state(auto), state(forced)), ("absent", "forced"))
        scale = numpy.maximum(abs(auto.radiance), 1e-3)
        self.assertLessEqual(float((abs(forced.radiance - auto.radiance) / scale).max()), 1e-5)

    def test_same_bits_and_no_glass_for_direct(self):
        scene = make.cornell_glass(daemon.folder)
        a, b = (daemon.vct(scene, size=(40, 40)).radiance for _ in range(2))
        self.assertTrue(numpy.array_equal(a, b))


if __name__ == "__main__":
    unittest.main()
