"""Directional lights from a disc: irradiance and penumbra in closed form."""
import math
import unittest

import numpy

from render import Daemon, Failed
from writers import Gltf, quad

daemon = Daemon()
ALBEDO = 0.5


def setUpModule():
    unittest.enterModuleContext(daemon)


def sun(angle, direction="0,-1,0", irradiance=2):
    extra = f",angle={angle}" if angle else ""
    return ["--light", f"directional:direction={direction},intensity={irradiance}{extra}"]


def scene(name, *blades):
    g = Gltf()
    g.place(*quad((-20, 0, 20), (20, 0, 20), (20, 0, -20), (-20, 0, -20)), g.material("floor", (ALBEDO,) * 3))
    for blade in blades:
        g.place(*blade, g.material("blade", (0,) * 3))
    g.camera((0, 3, 0), (0, 0, 0), 20, up=(0, 0, -1))
    return g.save(daemon.folder, name + ".gltf")


def irradiance(picture):
    return picture.radiance.astype(numpy.float64).mean(axis=2) * math.pi / ALBEDO


class Irradiance(unittest.TestCase):
    def test_on_a_plane_that_faces_the_middle(self):
        # E whatever the disc's size, and each sample is E cos θ 2 / (1 + cos α): for small discs hardly noisy.
        for angle in (0, 0.001, 0.53, 30, 120, 179):
            picture = irradiance(daemon.render(scene("plane"), (16, 16), 64, arguments=sun(angle)))
            print(f"disc of {angle} degrees: {picture.mean() / 2:.5f}")
            self.assertLess(abs(picture.mean() / 2 - 1), 2e-5 if angle < 1 else 0.003)

    def test_on_a_plane_aslant(self):
        # A uniform disc wholly above a plane gives E times the cosine of its middle.
        for angle in (0, 0.53, 40):
            picture = irradiance(daemon.render(scene("plane"), (16, 16), 64, arguments=sun(angle, "1,-1,0")))
            self.assertLess(abs(picture.mean() / (2 * math.sqrt(0.5)) - 1), 1e-5 if angle == 0 else 0.005)


class Penumbra(unittest.TestCase):
    def test_edge(self):
        # A half plane at height 1 over x < 0: at x the disc shows the part of it beyond -x, a segment of a circle in the plane
        # of tangents.
        angle, height, size = 8.0, 1.0, 64
        tangent = math.tan(math.radians(angle / 2))
        blade = quad((-20, height, 20), (0, height, 20), (0, height, -20), (-20, height, -20))
        picture = irradiance(daemon.render(scene("edge", blade), (size, size), 64,
                                           (0, 0.5, 0, 0, 0, 0, 0, 0, -1, 40), arguments=sun(angle)))
        half = 0.5 * math.tan(math.radians(20))
        x = ((numpy.arange(size) + 0.5) / size * 2 - 1) * half
        c = numpy.clip(-x / (height * tangent), -1, 1)  # the part of the disc with a slope above c is seen
        seen = (numpy.arccos(c) - c * numpy.sqrt(1 - c * c)) / math.pi
        measured = picture.mean(axis=0) / 2
        print(f"penumbra: at most {numpy.abs(measured - seen).max():.4f} off; width {2 * tangent * height:.4f} m")
        self.assertLess(numpy.abs(measured - seen).max(), 0.02)
        umbra, lit = x < -1.05 * height * tangent, x > 1.05 * height * tangent
        self.assertEqual(float(numpy.abs(measured[umbra]).max()), 0)
        self.assertLess(float(numpy.abs(measured[lit] - 1).max()), 0.002)

    def test_without_an_angle_nothing_changes(self):
        blade = quad((-20, 1, 20), (0, 1, 20), (0, 1, -20), (-20, 1, -20))
        path = scene("edge", blade)
        sharp, zero = (daemon.render(path, (24, 24), 4, arguments=arguments).radiance.tobytes()
                       for arguments in (sun(0), [*sun(0)[:1], sun(0)[1] + ",angle=0"]))
        self.assertEqual(sharp, zero)

    def test_with_other_lights(self):
        path = scene("edge", quad((-20, 1, 20), (0, 1, 20), (0, 1, -20), (-20, 1, -20)))
        lamp = ["--light", "point:at=0.5,2,0,intensity=3"]
        both, one, other = (irradiance(daemon.render(path, (16, 16), 64, arguments=arguments)).mean()
                            for arguments in (sun(8) + lamp, sun(8), lamp))
        self.assertLess(abs(both / (one + other) - 1), 0.01)


class Techniques(unittest.TestCase):
    def test_those_that_take_the_middle_say_so(self):
        for technique, angle, told in (("pt", 5, 0), ("direct", 5, 1), ("direct", 0, 0), ("vct", 5, 1), ("radiosity", 5, 1)):
            report = daemon.render(scene("plane"), (8, 8), 1, arguments=["--technique", technique, *sun(angle)]).report
            self.assertEqual(sum("angle" in note for note in report["notes"]), told, report["notes"])


class Refused(unittest.TestCase):
    def test_words(self):
        for light in ("directional:direction=0,-1,0,intensity=1,angle=180", "directional:direction=0,-1,0,intensity=1,angle=-1",
                      "point:at=0,1,0,intensity=1,angle=5", "directional:direction=0,-1,0,intensity=1,angle=1,2"):
            with self.assertRaises(Failed) as failure:
                daemon.render(scene("plane"), (8, 8), 1, arguments=["--light", light])
            self.assertEqual(failure.exception.status, 2, light)


if __name__ == "__main__":
    unittest.main()
