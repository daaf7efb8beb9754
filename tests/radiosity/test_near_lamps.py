"""Light straight from lamps on what is near them, gathered: Lambert's formula, whatever the number of samples."""
import math
import unittest

import numpy

from common import RadiosityDaemon
from lambert import lambert
from writers import Gltf, icosphere, quad, transformed

daemon = RadiosityDaemon()
RADIUS, HEIGHT = .1, .15


def setUpModule():
    unittest.enterModuleContext(daemon)


class BesideABall(unittest.TestCase):
    """A floor beneath a dim ball of many triangles, far more power than whose comes from a panel high above. Both are black, so
    that nothing but their own light is on the floor, and the ball's is convex, so that its triangles add up."""

    @classmethod
    def setUpClass(cls):
        g = Gltf()
        g.place(*quad((-20, 0, 20), (20, 0, 20), (20, 0, -20), (-20, 0, -20)), g.material("floor", (.5,) * 3))
        points, cls.triangles = icosphere(2, RADIUS)
        cls.points = transformed(points, offset=(0, HEIGHT, 0))
        g.place(cls.points, cls.triangles, g.material("ball", (0, 0, 0), (2,) * 3))
        cls.panel = [(-1, 6, -1), (1, 6, -1), (1, 6, 1), (-1, 6, 1)]
        g.place(*quad(*cls.panel), g.material("panel", (0, 0, 0), (10,) * 3))
        cls.scene = g.save(daemon.folder, "ball.gltf")

    def expected(self, x):
        """Radiance of the floor x from the ball's axis, where the ball hides nothing of the panel."""
        def form(polygon):
            return lambert([(a - x, b, c) for a, b, c in polygon], (0, 1, 0))
        at = numpy.array((x, 0, 0))
        ball = 0
        for t in self.triangles:
            a, b, c = (numpy.array(self.points[i]) for i in t)
            ball += form([a, b, c]) if numpy.dot(numpy.cross(b - a, c - a), at - a) > 0 else 0
        return .5 / math.pi * (2 * ball + 10 * form(self.panel))

    def test_at_any_number_of_samples(self):
        for x in (.15, .3, 2.5):
            expected = self.expected(x)
            for spp, bar in ((1, .5), (8, .2), (64, .07)):
                camera = (x + .3, .1, .3, x, 0, 0, 0, 1, 0, .05)
                picture = daemon.radiosity(self.scene, 64, (24, 24), spp, camera, display="gather")
                light = picture.radiance[..., 0].astype(float) / expected
                off, noise = light.mean() - 1, light.std() / math.sqrt(light.size)
                print(f"{x} m, {spp} samples: {100 * off:+.2f} % off, noise of the mean {100 * noise:.2f} %, of a pixel {100 * light.std():.1f} %")
                self.assertLess(abs(off), 4 * noise + 2e-3)
                self.assertLess(light.std(), bar)


if __name__ == "__main__":
    unittest.main()
