"""Light of emissive rectangles at any distance and any number of samples: Lambert's formula where nothing is in the way, and where
something is, the path tracer's light after one event, which more samples come closer to."""
import math
import unittest

import numpy

from lambert import lambert
from render import Daemon
from writers import Gltf, png, quad

daemon = Daemon()
DISTANCES = (1, .1, .01, .001)


def setUpModule():
    unittest.enterModuleContext(daemon)


def floor(g, size=20, **more):
    g.place(*quad((-size, 0, size), (size, 0, size), (size, 0, -size), (-size, 0, -size)), g.material("floor", (.5,) * 3, **more))


def ceiling(h, half=.5):
    return [(-half, h, -half), (half, h, -half), (half, h, half), (-half, h, half)]


def wall(d, wide=5, high=5, low=0):
    return [(-wide, low, -d), (wide, low, -d), (wide, high, -d), (-wide, high, -d)]


class Open(unittest.TestCase):
    """Nothing in the way: exact, whatever the samples."""

    def check(self, lamps, scale, samples=(1, 16, 64), technique="direct", options=None, tolerance=2e-3):
        g = Gltf()
        floor(g)
        for i, (polygon, radiance) in enumerate(lamps):
            g.place(*quad(*polygon), g.material(f"lamp {i}", (0, 0, 0), (radiance,) * 3, both_sides=True))
        scene = g.save(daemon.folder, "open.gltf")
        expected = sum(lambert(polygon, (0, 1, 0)) * radiance for polygon, radiance in lamps) * .5 / math.pi
        for spp in samples:
            picture = daemon.render(scene, (8, 8), spp, (0, .4 * scale, .1 * scale, 0, 0, 0, 0, 1, 0, .5), options,
                                    ["--technique", technique])
            got = float(picture.radiance.mean(dtype=numpy.float64))
            self.assertLess(abs(got / expected - 1), tolerance, (lamps, spp, got, expected))
            self.assertLess(picture.report.get("estimated_relmse") or 0, 1e-4)

    def test_below_a_square(self):
        for h in DISTANCES:
            self.check([(ceiling(h), 1)], h)

    def test_beside_a_wall_that_stands_on_the_floor(self):
        for d in DISTANCES:
            self.check([(wall(d), 1)], d)

    def test_a_wall_that_goes_on_below_the_floor(self):
        for d in (1, .01):
            self.check([(wall(d, low=-3), 1)], d)

    def test_a_near_dim_lamp_and_a_far_bright_one(self):
        for d in (.1, .01):
            self.check([(wall(-d, .05, .05), .2), (wall(4), 30)], d)

    def test_four_lamps_side_by_side(self):
        lamps = [([(x - .02, .1, -.02), (x + .02, .1, -.02), (x + .02, .1, .02), (x - .02, .1, .02)], i + 1)
                 for i, x in enumerate((-.09, -.03, .03, .09))]
        self.check(lamps, .05, samples=(16,))

    def test_as_thin_as_a_hair(self):
        """Long for its distance, and hardly any area."""
        for wide, h in ((1e-3, 3), (1e-4, 1), (1e-5, 1), (1e-5, .1), (1e-6, .3), (1e-7, .05)):
            line = [(-.7, h, 0), (1.3, h, 0), (1.3, h, wide), (-.7, h, wide)]
            self.check([(line, 1 / wide)], min(h, .3), samples=(1, 16), options={"direct.shadows": "none"}, tolerance=5e-3)

    def test_vct(self):
        for h in (.1, .01):
            self.check([(ceiling(h), 1)], h, samples=(1, 16), technique="vct", options={"vct.bounces": 0})


class Textured(unittest.TestCase):
    """A ceiling whose emission has a texture, over its middle."""

    def errors(self, texel, share, h, samples):
        g = Gltf()
        floor(g)
        lamp = g.material("lamp", (0, 0, 0), (1,) * 3)
        g.json["materials"][lamp]["emissiveTexture"] = {"index": g.image(png(2, 2, texel), magFilter=9728, minFilter=9728)}
        g.node(mesh=g.mesh(ceiling(h), [(0, 1, 2), (0, 2, 3)], lamp, uvs=[(0, 0), (1, 0), (1, 1), (0, 1)]))
        scene = g.save(daemon.folder, "textured.gltf")
        expected = lambert(ceiling(h), (0, 1, 0)) * .5 / math.pi * share
        for spp in samples:
            picture = daemon.render(scene, (8, 8), spp, (0, .4 * h, .1 * h, 0, 0, 0, 0, 1, 0, .5), None, ["--technique", "direct"])
            yield float(numpy.sqrt(((picture.radiance.astype(numpy.float64) / expected - 1) ** 2).mean()))

    def test_white_is_exact(self):
        for h in DISTANCES:
            for error in self.errors(lambda x, y: (255,) * 3, 1, h, (1, 4, 16, 64)):
                self.assertLess(error, 2e-3, h)

    def test_squares_of_a_board(self):
        """Two quarters of the ceiling shine, and all four look alike from below its middle."""
        for h in DISTANCES:
            few, some, many = self.errors(lambda x, y: (255,) * 3 if x == y else (0, 0, 0), .5, h, (16, 64, 256))
            print(f"{h} m: {few, some, many}")
            self.assertLess(few, .2)
            self.assertLess(some, few)
            self.assertLess(many, .8 * some)


class Behind(unittest.TestCase):
    """Something in the way, as small as the distance: penumbras everywhere."""

    def picture(self, scene, spp, camera, technique="direct"):
        return daemon.render(scene, (16, 16), spp, camera, {"pt.depth": 1} if technique == "pt" else None,
                             ["--technique", technique]).radiance.astype(numpy.float64)

    def check(self, fill, h, **more):
        g = Gltf()
        floor(g, **more)
        fill(g)
        g.place(*quad((-.2 * h, .5 * h, -.3 * h), (-.2 * h, .5 * h, .2 * h), (.3 * h, .5 * h, .2 * h), (.3 * h, .5 * h, -.3 * h)),
                g.material("in the way", (0, 0, 0), both_sides=True))
        scene = g.save(daemon.folder, "behind.gltf")
        camera = (0, .4 * h, .1 * h, .1 * h, 0, 0, 0, 1, 0, 60)
        reference = self.picture(scene, 1024, camera, "pt")
        errors = []
        for spp in (16, 64, 256):
            got = self.picture(scene, spp, camera)
            errors.append(math.sqrt(((got - reference) ** 2).mean()) / reference.mean())
            self.assertLess(abs(got.mean() / reference.mean() - 1), .03, (h, spp))
        print(f"{h} m: {errors}")
        self.assertLess(errors[0], .2)
        self.assertLess(errors[1], .8 * errors[0])
        self.assertLess(errors[2], .7 * errors[1])

    def one(self, g, h):
        g.place(*quad(*ceiling(h)), g.material("lamp", (0, 0, 0), (1,) * 3))

    def test_matte(self):
        for h in DISTANCES:
            self.check(lambda g: self.one(g, h), h)

    def test_glossy(self):
        for h in DISTANCES:
            self.check(lambda g: self.one(g, h), h, specular=1, roughness=.3)

    def test_lamps_of_many_colours(self):
        """What hides one hides not the others: the shares of the channels differ."""
        def three(g, h):
            self.one(g, h)
            g.place(*quad((.6, h, -.5), (1.6, h, -.5), (1.6, h, .5), (.6, h, .5)), g.material("red", (0, 0, 0), (4, .5, .2)))
            g.place(*quad(*wall(3, 3, 3)), g.material("blue", (0, 0, 0), (.1, .2, 3)))
        for h in (1, .1, .01):
            self.check(lambda g: three(g, h), h)

    def test_nothing_gets_into_a_closed_box(self):
        from writers import box
        for h in (.1, .01):
            g = Gltf()
            floor(g)
            self.one(g, h)
            g.place(*box((-.6 * h, -h, -.6 * h), (.6 * h, .6 * h, .6 * h), inward=True), g.material("box", (0, 0, 0), both_sides=True))
            for spp in (1, 16, 64):
                got = self.picture(g.save(daemon.folder, "closed.gltf"), spp, (0, .4 * h, .1 * h, 0, 0, 0, 0, 1, 0, 30))
                self.assertEqual(float(numpy.abs(got).max()), 0)


if __name__ == "__main__":
    unittest.main()
