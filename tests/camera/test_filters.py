"""Pixel filters: a flat field stays flat, light is neither made nor lost, and an edge shows each filter's integral."""
import math
import unittest

import numpy

from render import Daemon
from test_camera import ALONG_Z, square
from writers import Gltf

daemon = Daemon()
SIZE = 32
FILTERS = ("box", "gauss", "bh")


def setUpModule():
    unittest.enterModuleContext(daemon)


def glowing(name, middle, side):
    g = Gltf()
    g.place(*square(middle, (0, 0, 1), side), g.material("glow", (0, 0, 0), (1, 1, 1)))
    g.camera((0, 0, 0), (0, 0, -1), 40)
    return g.save(daemon.folder, name)


def render(path, name, spp, *more):
    """A pixel is a sixteenth of a metre."""
    return daemon.render(path, (SIZE, SIZE), spp, ALONG_Z,
                         arguments=["--filter", name, "--orthographic", "2", *more]).radiance.astype(numpy.float64)


def window_integral(t):
    """Of the Blackman-Harris window from its middle to t of its half width, over the whole of it: -1/2 to 1/2."""
    s = abs(t)
    if s >= 1:
        return math.copysign(0.5, t)
    area = 0.35875 * s + sum(a / (n * math.pi) * math.sin(n * math.pi * s)
                             for n, a in ((1, 0.48829), (2, 0.14128), (3, 0.01168)))
    return math.copysign(0.5 * area / 0.35875, t)


def gauss_integral(distance):
    """Of the Gaussian cut at a distance of 2, marginal along one axis, by quadrature."""
    r = numpy.linspace(-2, 2, 40001)
    density = numpy.exp(-2 * r * r) * numpy.array([math.erf(math.sqrt(2 * max(0.0, 4 - x * x))) for x in r])
    return float(density[r < distance].sum() / density.sum()) - 0.5


class Filters(unittest.TestCase):
    def test_a_flat_field_stays_flat(self):
        path = glowing("far.gltf", (500, 0, -1), 1)
        for name in FILTERS:
            picture = render(path, name, 16, "--background", "1,2,3")
            numpy.testing.assert_array_equal(picture, numpy.broadcast_to([1.0, 2.0, 3.0], picture.shape))

    def test_light_is_kept(self):
        # A square of eight by eight pixels.
        path = glowing("small.gltf", (0.03, -0.02, -1), 0.5)
        for name in FILTERS:
            total = float(render(path, name, 256)[:, :, 0].sum())
            print(f"{name}: {total:.4f} of 64")
            self.assertLess(abs(total / 64 - 1), 2e-3)

    def test_an_edge_shows_the_integral(self):
        # Light from the picture's middle to the right: a pixel's middle is half a pixel and more from it.
        path = glowing("edge.gltf", (100, 0, -1), 200)
        distances = numpy.arange(-3, 3) + 0.5
        expected = {"box": [0, 0, 0, 1, 1, 1], "gauss": [0.5 + gauss_integral(d) for d in distances],
                    "bh": [0.5 + window_integral(d / 2) for d in distances]}
        for name in FILTERS:
            columns = render(path, name, 256)[:, 13:19, 0].mean(axis=0)
            print(name, numpy.round(columns, 4), "expected", numpy.round(expected[name], 4))
            numpy.testing.assert_allclose(columns, expected[name], atol=4e-3)

    def test_no_filter_is_the_box(self):
        path = glowing("plain.gltf", (0.03, -0.02, -1), 0.5)
        plain = daemon.render(path, (SIZE, SIZE), 8, ALONG_Z, arguments=["--orthographic", "2"]).radiance
        self.assertEqual(plain.tobytes(), render(path, "box", 8).astype(numpy.float32).tobytes())


if __name__ == "__main__":
    unittest.main()
