"""Radiosity beside path tracing of all that bounces: what both must agree on, diffuse rooms and mirrors."""
import unittest

import numpy

import make
from common import RadiosityDaemon, figures, stages
from writers import Gltf, box, quad

daemon = RadiosityDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


class Paths:
    """Two pictures of pt with other samples: their errors have nothing to do with each other, so that the mean of the product of
    two differences has no share of their noise."""

    def __init__(self, scene, size, spp, depth=64):
        self.one, self.two = (daemon.render(scene, size, spp, options={"pt.depth": depth}, arguments=["--seed", str(seed)])
                              .radiance.astype(numpy.float64) for seed in (1, 2))
        self.both = (self.one + self.two) / 2
        noise = ((self.one - self.two) ** 2 / (self.one * self.two + .01)).mean() / 4
        print(f"pt: relMSE {noise:.5f} of noise")

    def compare(self, picture, name):
        """relMSE, and the relative error of the mean."""
        x = picture.radiance.astype(numpy.float64)
        error = ((x - self.one) * (x - self.two) / (self.one * self.two + .01)).mean()
        mean = x.mean() / self.both.mean() - 1
        print(f"{name}: relMSE {error:.5f}, mean {100 * mean:+.2f} %")
        return error, abs(mean)


class Rooms(unittest.TestCase):
    def check(self, scene, size, spp, displays, **options):
        paths = Paths(scene, size, spp)
        for display, bar in displays:
            with self.subTest(display):
                # Edges of a lamp count: every pixel of a row has the same samples.
                error, mean = paths.compare(daemon.radiosity(scene, size=size, spp=64, display=display, **options), display)
                self.assertLess(error, bar)
                self.assertLess(mean, .01)

    def test_cornell_box(self):
        """As many patches as without an option."""
        self.check(make.cornell(daemon.folder), (48, 48), 160, (("vertex", .02), ("constant", .02), ("gather", .005)), rays=512)

    def test_cornell_box_of_few_patches(self):
        """Those that lie partly beneath a block have no light there. What corners interpolate goes by the square of a patch's size:
        at 1000 patches the mean is 1.1 % below that of paths, at 4000 0.5 %, and by constant values 0.4 and 0.3 %."""
        paths = Paths(make.cornell(daemon.folder), (32, 32), 128)
        for display, bar, off in (("vertex", .02, .015), ("constant", .02, .01), ("gather", .005, .01)):
            error, mean = paths.compare(daemon.radiosity(make.cornell(daemon.folder), 1000, (32, 32), 64, display=display), display)
            self.assertLess(error, bar)
            self.assertLess(mean, off)

    def test_a_room_lit_by_a_point_light_and_a_sky(self):
        """An open room: one wall of the box is not there."""
        g = Gltf()
        for part, colour, corners in make.CORNELL:
            g.place(*quad(*corners), g.material(part, colour))
        g.place(*box((-.6, .5, -.5), (-.1, 1, 0)), g.material("block", (.5, .6, .7)))
        g.light("point", 4.0, (.3, 1.6, .2), colour=(1, .8, .6))
        g.camera((0, 1, 3.9), (0, 1, 0), 39)
        scene = g.save(daemon.folder, "open.gltf")
        size, sky = (32, 32), ["--background", ".3,.4,.6"]
        one, two = (daemon.render(scene, size, 96, options={"pt.depth": 64}, arguments=[*sky, "--seed", seed]).radiance.astype(float)
                    for seed in ("1", "2"))
        for display, bar in (("vertex", .02), ("gather", .005)):
            x = daemon.radiosity(scene, 2500, size, 64, display=display, rays=512, arguments=sky).radiance.astype(float)
            error, mean = ((x - one) * (x - two) / (one * two + .01)).mean(), 2 * x.mean() / (one + two).mean() - 1
            print(f"open room, {display}: relMSE {error:.5f}, mean {100 * mean:+.2f} %")
            self.assertLess(error, bar)
            self.assertLess(abs(mean), .01)


def mirrored_box(name="mirrored.gltf", albedo=.9):
    """The box, its back wall a mirror."""
    g = Gltf()
    for part, colour, corners in make.CORNELL:
        mirror = {"metallic": 1, "roughness": 0} if part == "back" else {}
        g.place(*quad(*corners), g.material(part, (albedo,) * 3 if part == "back" else colour, **mirror))
    g.place(*box((-.5, 0, -.3), (0, .7, .2)), g.material("block", (.7, .6, .3)))
    g.place(*quad((-.3, 1.98, -.3), (.3, 1.98, -.3), (.3, 1.98, .3), (-.3, 1.98, .3)), g.material("lamp", (.3,) * 3, (12,) * 3))
    g.camera((.2, 1.1, 3.7), (0, .9, 0), 39)
    return g.save(daemon.folder, name)


class Mirrors(unittest.TestCase):
    def test_a_room_with_a_mirror(self):
        scene = mirrored_box()
        paths = Paths(scene, (32, 32), 256)
        pictures = {display: daemon.radiosity(scene, 2500, (32, 32), 64, display=display, rays=512) for display in ("vertex", "gather")}
        for display, picture in pictures.items():
            error, mean = paths.compare(picture, display)
            self.assertLess(error, .02)
            self.assertLess(mean, .015)
        off = daemon.radiosity(scene, 2500, (32, 32), 64, rays=512, mirrors="off")
        self.assertGreater(paths.compare(off, "without mirrors")[0], .02)
        states = {e["name"]: e for e in off.report["effects"]}
        self.assertEqual(states["glossy"]["state"], "unsupported")
        self.assertIn("metals are diffuse", states["glossy"]["why"])
        self.assertEqual({e["name"]: e["state"] for e in pictures["vertex"].report["effects"]}["glossy"], "simulated")

    def facing(self, name, reflectance):
        """A black lamp that looks away from a square wall at a mirror, which the wall sees: the lamp's image lights it."""
        g = Gltf()
        g.place(*quad((-1, -4, 6), (-1, -4, -4), (-1, 4, -4), (-1, 4, 6)), g.material("mirror", (reflectance,) * 3, metallic=1, roughness=0))
        g.place(*quad((.5, -.5, -.5), (.5, -.5, .5), (.5, .5, .5), (.5, .5, -.5)), g.material("lamp", (0, 0, 0), (1,) * 3))
        g.place(*quad((1, -.5, 1.5), (1, -.5, 2.5), (1, .5, 2.5), (1, .5, 1.5)), g.material("wall", (.5,) * 3))
        g.camera((0, 0, 2), (1, 0, 2), 20)
        return g.save(daemon.folder, name)

    def test_what_comes_by_way_of_a_mirror(self):
        """R π F of the lamp's image, 3.5 away and 2 aside, by quadrature over both squares; and of the wall's own, 4 away."""
        at = (numpy.arange(24) + .5) / 24 - .5
        y0, z0, y1, z1 = numpy.meshgrid(at, at, at, at, indexing="ij")
        lamp, wall = ((away ** 2 / (numpy.pi * (away ** 2 + (y1 - y0) ** 2 + (aside + z1 - z0) ** 2) ** 2)).mean() for away, aside in ((3.5, 2), (4, 0)))
        for reflectance in (.8, .4):
            scene = self.facing(f"facing_{reflectance}.gltf", reflectance)
            expected = .5 * reflectance * lamp / (1 - .5 * reflectance * wall)
            # So many rays find the lamp that it is known within 0.4 and 0.9 % by one standard error.
            for display, spp, tolerance in (("constant", 1, .015), ("gather", 64, .03)):
                picture = daemon.radiosity(scene, 64, (8, 8), spp, display=display, gather=64, rays=65536)
                print(f"reflectance {reflectance}, {display}: {picture.mean():.6f}, expected {expected:.6f}")
                self.assertLess(abs(picture.mean() / expected - 1), tolerance)
            none = daemon.radiosity(scene, 64, (8, 8), display="constant", rays=4096, bounces=0)
            self.assertEqual(none.mean(), 0)

    def test_forced_without_mirrors_it_changes_nothing(self):
        scene = make.cornell(daemon.folder)
        for display in ("vertex", "gather"):
            auto, forced = (daemon.radiosity(scene, 300, rays=64, display=display, arguments=a) for a in ((), ["--effects=+glossy"]))
            states = [{e["name"]: e["state"] for e in p.report["effects"]}["glossy"] for p in (auto, forced)]
            self.assertEqual(states, ["absent", "forced"])
            numpy.testing.assert_array_equal(forced.radiance, auto.radiance)
            self.assertEqual(forced.report["job_bytes"], auto.report["job_bytes"])
            self.assertLessEqual(stages(forced), stages(auto) | {"compile"})



if __name__ == "__main__":
    unittest.main()
