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


class NormalsThatFaceAway(unittest.TestCase):
    def test_beneath_a_panel(self):
        """A floor whose normals are turned away from the camera is shaded by normals that are turned back until they are square to the
        view. The light of what is below them is folded to above the floor. Points and rays find a near panel together: all of
        its light, and none of it twice."""
        g = Gltf()
        smooth = (.94, .342, 0)
        positions, triangles = quad((-.5, 0, .5), (.5, 0, .5), (.5, 0, -.5), (-.5, 0, -.5))
        g.node(mesh=g.mesh(positions, triangles, g.material("floor", (.5,) * 3), normals=[smooth] * 4))
        panel = [(-.2, .12, -.2), (.2, .12, -.2), (.2, .12, .2), (-.2, .12, .2)]
        # Of so many triangles that points choose among them.
        shining, at = g.material("panel", (0, 0, 0), (4,) * 3), numpy.linspace(-.2, .2, 13)
        for low, high in zip(at, at[1:]):
            for near, far in zip(at, at[1:]):
                g.place(*quad((low, .12, near), (high, .12, near), (high, .12, far), (low, .12, far)), shining)
        scene = g.save(daemon.folder, "away.gltf")
        view = numpy.array((-1, .1, 0)) / math.hypot(1, .1)
        normal = numpy.array(smooth) / math.hypot(*smooth)
        self.assertLess(normal @ view, -.5)
        normal = normal + (1e-3 - normal @ view) * view
        normal /= numpy.linalg.norm(normal)
        expected = .5 / math.pi * 4 * sum(lambert([(x, side * y, z) for x, y, z in panel], normal) for side in (1, -1))
        for spp in (1, 64):
            camera = (*(4 * view), 0, 0, 0, 0, 1, 0, .05)
            light = daemon.radiosity(scene, 64, (24, 24), spp, camera, display="gather").radiance[..., 0].astype(float) / expected
            off, noise = light.mean() - 1, light.std() / math.sqrt(light.size)
            print(f"{spp} samples: {100 * off:+.2f} % off, noise of the mean {100 * noise:.2f} %")
            self.assertLess(abs(off), 4 * noise + 3e-3)


if __name__ == "__main__":
    unittest.main()
