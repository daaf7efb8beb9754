"""Where floats are short: lamps at the world's zero, very thin and very large triangles, pictures larger than one buffer, and
more of a scene than a driver lets one loop visit."""
import math
import unittest

import numpy

from render import Daemon
from table import HardCase
from writers import Gltf, box, quad

daemon = Daemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def lamp(g, half, y, radiance, both_sides=False):
    g.place(*quad((-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)),
            g.material("lamp", (0, 0, 0), (radiance,) * 3, both_sides=both_sides))


class LampAtZero(HardCase):
    """A lamp whose own coordinates are next to nothing, and whose distance is not."""

    def test_over_far_floors(self):
        for height in (1, 100, 1000):
            g = Gltf()
            s = 20.0 * height
            g.place(*quad((-s, -height, s), (s, -height, s), (s, -height, -s), (-s, -height, -s)), g.material("floor", (0.5,) * 3))
            half = 0.5 * height
            lamp(g, half, 0, 1.0)
            scene = g.save(daemon.folder, f"floor_{height}.gltf")
            camera = (0, -0.6 * height, 3 * height, 0, -height, 0, 0, 1, 0, 0.25)
            picture = daemon.twice(scene, size=(8, 8), spp=256, camera=camera, options={"pt.depth": 1})
            a = 0.5 / math.sqrt(1.25)
            self.row("place", f"a lamp at the world's zero, {height} m over a floor", picture, picture.mean() * math.pi / 0.5, 4 * a * math.atan(a),
                     "form factor of a square, Howell B-3", 0.01)

    def test_a_room_at_any_height_is_as_bright(self):
        means = []
        for y in (0.0, 0.013, 7.0):
            g = Gltf()
            g.place(*box((-2, y - 1.5, -2), (2, y + 1, 2), inward=True), g.material("walls", (0.7,) * 3))
            lamp(g, 0.2, y, 5.0)
            scene = g.save(daemon.folder, f"room_{y}.gltf")
            picture = daemon.render(scene, size=(32, 32), spp=64, camera=(1.8, y + 0.5, 1.8, 0, y - 1, 0, 0, 1, 0, 60))
            means.append(float(picture.radiance.mean(dtype=numpy.float64)))
        print("means by height:", means)
        self.assertLess(max(means) / min(means) - 1, 0.01)

    def test_a_lamp_of_two_sides_lights_both(self):
        g = Gltf()
        for y, up in ((-1, 1), (1, -1)):
            x = 10.0 * up
            g.place(*quad((-x, y, 10), (x, y, 10), (x, y, -10), (-x, y, -10)), g.material("plate", (0.5,) * 3))
        lamp(g, 0.5, 0, 1.0, both_sides=True)
        scene = g.save(daemon.folder, "two_sides.gltf")
        for up in (1, -1):
            picture = daemon.render(scene, size=(8, 8), spp=256, camera=(0, 0.4 * up, 3, 0, up, 0, 0, 1, 0, 0.25),
                                    options={"pt.depth": 1})
            reflected = float(picture.radiance.mean(dtype=numpy.float64)) * math.pi / 0.5
            self.assertLess(abs(reflected / 0.75227 - 1), 0.01)


class Thin(HardCase):
    def test_texture_runs_on_along_a_plank(self):
        """Ten metres by one millimetre, a hundred metres out: the colour is that of the place, on both triangles."""
        from writers import png
        g = Gltf()
        texture = g.image(png(64, 1, lambda x, y: (x * 4, x * 4, x * 4)), magFilter=9728)
        g.node(mesh=g.mesh([[-5, 0, 100], [5, 0, 100], [5, 0.001, 100], [-5, 0.001, 100]], [(0, 1, 2), (0, 2, 3)],
                           g.material("ramp", texture=texture), uvs=[(0, 1), (1, 1), (1, 0), (0, 0)]))
        scene = g.save(daemon.folder, "plank.gltf")
        # A strip of the plank, seen from a metre: 0.8 mm high, 1.5 to 3.1 metres along. Texels are 0.156 m wide.
        seen = []
        for x in (-3.0, 0.05, 3.0):
            picture = daemon.render(scene, size=(4, 4), spp=16, camera=(x, 0.0005, 101, x, 0.0005, 100, 0, 1, 0, 0.04),
                                    arguments=["--aov", "albedo"])
            albedo = picture.channels["albedo.R"]
            self.assertEqual(float(albedo.max()), float(albedo.min()))
            seen.append(float(albedo[0, 0]))
        texels = [int((x + 5) / 10 * 64) * 4 / 255 for x in (-3.0, 0.05, 3.0)]
        for got, value in zip(seen, texels):
            linear = ((value + 0.055) / 1.055) ** 2.4
            self.assertLess(abs(got / linear - 1), 0.02)

    def test_very_large_triangles_have_a_normal(self):
        for size in (1e3, 1e9, 1e11):
            g = Gltf()
            g.place(*quad((-size, 0, size), (size, 0, size), (size, 0, -size), (-size, 0, -size)), g.material("floor", (0.5,) * 3))
            g.camera((0, size, 0.5 * size), (0, 0, 0), 30)
            picture = daemon.twice(g.save(daemon.folder, "large.gltf"), size=(16, 16), spp=16, arguments=["--background", "1,1,1"])
            self.row("size", f"a floor of {2 * size:g} m in a white world, its worst pixel", picture, numpy.abs(picture.radiance - 0.5).max(), 0, "albedo", 0.01)

    def test_ten_thousands_of_needles_are_drawn_or_refused_by_name(self):
        """Every ray that looks along them meets the boxes of all: more than one dispatch of many events may visit."""
        g = Gltf()
        positions, triangles = [], []
        for i in range(20000):
            a = i * 0.7
            positions += [[math.sin(a), math.cos(a), -5], [-math.sin(a), -math.cos(a), 5], [math.sin(a) + 1e-4, math.cos(a), -5]]
            triangles.append((3 * i, 3 * i + 1, 3 * i + 2))
        g.place(positions, triangles, g.material("needles", (0.5,) * 3))
        g.camera((0, 0, 20), (0, 0, 0), 20)
        scene = g.save(daemon.folder, "needles.gltf")
        whole = daemon.render(scene, size=(16, 16), spp=2, arguments=["--background", "1,1,1"])
        split = daemon.render(scene, size=(16, 16), spp=2, arguments=["--background", "1,1,1"], options={"pt.segment": 1})
        self.assertTrue(numpy.array_equal(whole.radiance, split.radiance))


class LargePictures(unittest.TestCase):
    def test_more_pixels_than_a_buffer_holds(self):
        """At 48 bytes a pixel 2,800,000 pixels fill what software devices bind: this one is cut into bands."""
        g = Gltf()
        g.place(*box((-1, -1, -1), (1, 1, 1)), g.material("box", (0.5,) * 3))
        scene = g.save(daemon.folder, "box.gltf")
        camera = (3, 2, 4, 0, 0, 0, 0, 1, 0, 40)
        size = (2000, 1701)
        picture = daemon.render(scene, size=size, spp=1, camera=camera, arguments=["--background", "1,1,1", "--aov", "depth,id"])
        self.assertEqual(picture.radiance.shape, (size[1], size[0], 3))
        # What is hit is grey, the rest is the background, in every row: no band is lost, shifted or drawn twice.
        hit = picture.channels["id"] > 0
        self.assertTrue(bool(numpy.array_equal(hit, numpy.isfinite(picture.channels["Z"]))))
        grey = picture.radiance[:, :, 0] < 0.9
        self.assertGreater(float((grey == hit).mean()), 0.995)
        rows = hit.any(axis=1).nonzero()[0]
        self.assertEqual(len(rows), rows[-1] - rows[0] + 1)


if __name__ == "__main__":
    unittest.main()
