"""Cameras by what they must show of a few glowing squares: sizes, directions, circles of confusion."""
import math
import unittest

import numpy

from render import Daemon, Failed
from table import HardCase
from writers import Gltf, quad

daemon = Daemon()
SIZE = 64
ALONG_Z = (0, 0, 0, 0, 0, -1, 0, 1, 0, 40)  # from the origin along -Z


def setUpModule():
    unittest.enterModuleContext(daemon)


def square(middle, towards, side, up=(0, 1, 0)):
    """Corners of a square whose front shows `towards`."""
    n = numpy.array(towards, float) / numpy.linalg.norm(towards)
    x = numpy.cross(up, n)
    x /= numpy.linalg.norm(x)
    y = numpy.cross(n, x)
    m, h = numpy.array(middle, float), side / 2
    return quad(*[tuple(float(c) for c in m + h * (a * x + b * y)) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def scene(name, *squares):
    """Squares of radiance 1 each in one colour: the first red, the second green, the third blue."""
    g = Gltf()
    for i, (middle, towards, side) in enumerate(squares):
        emission = [0.0, 0.0, 0.0]
        emission[i] = 1.0
        g.place(*square(middle, towards, side), g.material(f"glow {i}", (0, 0, 0), emission))
    g.camera((0, 0, 0), (0, 0, -1), 40)
    return g.save(daemon.folder, name)


def moments(weights):
    """Sum, mean place and variance along x and y, in pixels from the picture's top left corner."""
    weights = weights.astype(numpy.float64)
    height, width = weights.shape
    y, x = numpy.mgrid[0:height, 0:width] + 0.5
    total = weights.sum()
    mean = [(weights * a).sum() / total for a in (x, y)]
    variance = [(weights * (a - m) ** 2).sum() / total for a, m in ((x, mean[0]), (y, mean[1]))]
    return total, mean, variance


class Orthographic(unittest.TestCase):
    def test_size_does_not_depend_on_distance(self):
        # One metre of a picture four metres high is 16 pixels of 64, near or far.
        path = scene("ortho.gltf", ((-1, 1, -2), (0, 0, 1), 1), ((1, -1, -2000), (0, 0, 1), 1))
        picture = daemon.render(path, (SIZE, SIZE), 4, ALONG_Z, arguments=["--orthographic", "4"]).radiance
        for channel, (x, y) in ((0, (8, 8)), (1, (40, 40))):
            expected = numpy.zeros((SIZE, SIZE))
            expected[y:y + 16, x:x + 16] = 1
            numpy.testing.assert_array_equal(picture[:, :, channel], expected)

    def test_wide_pictures_and_the_scenes_own_cameras(self):
        path = scene("wide.gltf", ((0, 0, -2), (0, 0, 1), 1))
        for camera in (ALONG_Z, "camera"):
            picture = daemon.render(path, (96, 32), 4, camera, arguments=["--orthographic", "2"]).radiance
            self.assertEqual(float(picture[8:24, 40:56, 0].sum()), 256)
            self.assertEqual(float(picture.sum()), 256)


class Panorama(HardCase):
    def test_directions_and_solid_angles(self):
        width, height, side, far = 128, 64, 0.2, 2.0
        for name, longitudes in (("a", (0, 90, -135)), ("b", (45, -60, 170))):
            places = [(longitude, latitude) for longitude, latitude in zip(longitudes, (0, 50, -35))]
            squares = []
            for longitude, latitude in places:
                a, b = math.radians(longitude), math.radians(latitude)
                w = numpy.array((math.cos(b) * math.sin(a), math.sin(b), -math.cos(b) * math.cos(a)))
                squares.append((tuple(far * w), tuple(-w), side))
            whole = daemon.twice(scene(f"panorama_{name}.gltf", *squares), (width, height), 64, ALONG_Z, arguments=["--panorama"])
            picture = whole.radiance.astype(numpy.float64)
            latitudes = math.pi * (0.5 - (numpy.arange(height) + 0.5) / height)
            solid = 2 * math.pi / width * math.pi / height * numpy.cos(latitudes)[:, None]
            expected = 4 * math.asin((side / 2) ** 2 / ((side / 2) ** 2 + far ** 2))
            for channel, (longitude, latitude) in enumerate(places):
                seen = picture[:, :, channel] * solid
                total, (x, y), _ = moments(seen)
                self.row("camera", f"a square of 20 cm at 2 m in a panorama, {longitude}° across, {latitude}° up", whole, total, expected, "its solid angle, by samples", 0.03)
                self.assertLess(abs(x - width * (0.5 + longitude / 360)), 0.1)
                self.assertLess(abs(y - height * (0.5 - latitude / 180)), 0.1)

    def test_depth_is_a_distance(self):
        path = scene("behind.gltf", ((0, 0, 3), (0, 0, -1), 1))
        picture = daemon.render(path, (64, 32), 1, ALONG_Z, arguments=["--panorama", "--aov", "depth"])
        depth = picture.channels["Z"]
        # The first and the last column look backwards.
        self.assertLess(abs(float(depth[16, 0]) - 3), 0.02)
        self.assertLess(abs(float(depth[16, 63]) - 3), 0.02)
        self.assertTrue(math.isinf(float(depth[16, 32])))


class Lens(HardCase):
    RADIUS, FOCUS = 0.05, 2.0
    SCALE = SIZE / 2 / math.tan(math.radians(20))  # pixels a unit of slope

    def image(self, distance, side, orthographic=None, lens=True):
        path = scene(f"lens_{distance}.gltf", ((0, 0, -distance), (0, 0, 1), side))
        arguments = ["--lens", f"{self.RADIUS},{self.FOCUS}"] if lens else []
        if orthographic:
            arguments += ["--orthographic", str(orthographic)]
        return daemon.twice(path, (SIZE, SIZE), 256, ALONG_Z, arguments=arguments)

    def test_circle_of_confusion(self):
        for distance in (0.7, 1.2, 6.0):
            side = 0.02 * distance
            picture = self.image(distance, side)
            total, mean, variance = moments(picture.radiance[:, :, 0])
            # A point's light is spread evenly over a disc; its variance along an axis is a quarter of the squared radius. The
            # square's own and the pixel's come on top.
            radius = self.RADIUS * abs(1 - self.FOCUS / distance) / self.FOCUS * self.SCALE
            expected = radius ** 2 / 4 + ((0.02 * self.SCALE) ** 2 + 1) / 12
            for axis, v, m in zip(("across", "down"), variance, mean):
                self.row("camera", f"a point {distance} m away, the lens focused at {self.FOCUS:g} m: its image's variance {axis}", picture, v, expected,
                         "circle of confusion, by samples", 0.1)
                self.assertLess(abs(m - SIZE / 2), 0.05)
            # Light is spread, not lost.
            self.assertLess(abs(total / (0.02 * self.SCALE) ** 2 - 1), 0.1)

    def test_what_is_in_focus_is_sharp(self):
        sharp, pinhole = self.image(self.FOCUS, 0.25), self.image(self.FOCUS, 0.25, lens=False)
        self.assertLess(float(numpy.abs(sharp.radiance - pinhole.radiance).max()), 0.05)

    def test_orthographic_lens(self):
        distance, height = 3.0, 1.0
        _, _, variance = moments(self.image(distance, 0.03, orthographic=height).radiance[:, :, 0])
        radius = self.RADIUS * abs(1 - distance / self.FOCUS) * SIZE / height
        expected = radius ** 2 / 4 + ((0.03 * SIZE / height) ** 2 + 1) / 12
        print(f"orthographic lens: variance {variance[0]:.3f}, expected {expected:.3f}")
        self.assertLess(abs(variance[0] / expected - 1), 0.05)

    def test_samples_of_a_lens_merge(self):
        path = scene("merge.gltf", ((0, 0, -1), (0, 0, 1), 0.2))
        arguments = ["--lens", "0.05,2", "--filter", "bh"]
        whole, first, rest = (daemon.render(path, (32, 32), spp, ALONG_Z, arguments=[*arguments, "--first-sample", str(at)])
                              .radiance.astype(numpy.float64) for spp, at in ((24, 0), (8, 0), (16, 8)))
        numpy.testing.assert_allclose((8 * first + 16 * rest) / 24, whole, rtol=1e-5, atol=1e-7)


class Refused(unittest.TestCase):
    def test_by_name(self):
        path = scene("refused.gltf", ((0, 0, -2), (0, 0, 1), 1))
        for wrong, word in ((["--panorama", "--lens", "0.1,1"], "bad-argument"),
                            (["--technique", "direct", "--panorama"], "unsupported"),
                            (["--technique", "vct", "--lens", "0.1,1"], "unsupported"),
                            (["--technique", "radiosity", "--panorama"], "unsupported"),
                            (["--technique", "direct", "--filter", "bh"], "unsupported"),
                            (["--technique", "direct", "--error", "0.1"], "unsupported")):
            with self.assertRaises(Failed) as failure:
                daemon.render(path, (8, 8), 1, ALONG_Z, arguments=wrong)
            self.assertEqual(failure.exception.status, 2)
            self.assertIn(word, failure.exception.text)


if __name__ == "__main__":
    unittest.main()
