"""Pictures whose every pixel is known beforehand. Nothing else about the path tracer is believed before these hold."""
import math
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, icosphere, png, quad

daemon = Daemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def smooth_sphere():
    """A coarse sphere whose normals pretend that it is round: shading and true normals differ by up to 20 degrees."""
    g = Gltf()
    positions, triangles = icosphere(1)
    g.node(mesh=g.mesh(positions, triangles, g.material("white", (1, 1, 1)), normals=positions))
    g.camera((0, 0, 4), (0, 0, 0), 40)
    return g.save(daemon.folder, "smooth.gltf")


def worst(picture, expected):
    """The largest relative error of any pixel and channel."""
    return float(numpy.abs(picture.radiance / expected - 1).max())


class Furnace(unittest.TestCase):
    def test_convex_body_vanishes_in_a_white_world(self):
        picture = daemon.render(make.furnace(daemon.folder), spp=64, arguments=["--background", "1,1,1"])
        self.assertLess(worst(picture, 1.0), 0.005)

    def test_smooth_normals_lose_no_energy(self):
        picture = daemon.render(smooth_sphere(), spp=64, arguments=["--background", "1,1,1"])
        # A facet seen past its own horizon may reflect to a neighbour once more; albedo 1 gives that back too.
        self.assertLess(worst(picture, 1.0), 0.005)

    def test_grey_body_reflects_its_albedo(self):
        picture = daemon.render(make.furnace(daemon.folder, albedo=0.25, name="grey.gltf"), spp=16,
                                arguments=["--background", "2,2,2"])
        middle = picture.radiance[28:36, 28:36]
        self.assertLess(float(numpy.abs(middle / 0.5 - 1).max()), 0.005)


class ClosedSphere(unittest.TestCase):
    """Albedo rho, inward emission 1 - rho: radiance 1, and 1 - rho^(N+1) after N scattering events."""

    def check(self, rho, depth, spp, tolerance):
        scene = make.closed_sphere(daemon.folder, rho=rho)
        picture = daemon.render(scene, size=(32, 32), spp=spp, options={"pt.depth": depth})
        expected = 1 - rho ** (depth + 1)
        mean = float(picture.radiance.mean(dtype=numpy.float64))
        print(f"closed sphere rho {rho} depth {depth}: mean {mean:.5f}, expected {expected:.5f}")
        self.assertLess(abs(mean / expected - 1), tolerance)
        return picture

    def test_half(self):
        picture = self.check(0.5, 7, 64, 0.005)
        self.assertLess(worst(picture, 1.0), 0.06)
        self.assertLess(abs(float(picture.radiance.mean()) - 1), 0.01)

    def test_bright_walls(self):
        # The series itself lacks 0.94 % here; what is left of the percent is for the noise of a mean of 65,536 paths, 0.25 %.
        self.assertLess(0.95 ** 91, 0.01)
        self.check(0.95, 90, 64, 0.0075)

    def test_truncated_series(self):
        for rho, depth in ((0.5, 1), (0.5, 2), (0.5, 4), (0.95, 1), (0.95, 5), (0.95, 20)):
            with self.subTest(rho=rho, depth=depth):
                self.check(rho, depth, 64, 0.01)


class Irradiance(unittest.TestCase):
    def check(self, scene, expected):
        # Straight down the axis would look at the lamp's back: from the side, at a spot of some centimetres.
        camera = (0, 0.5, 3, 0, 0, 0, 0, 1, 0, 0.25)
        picture = daemon.render(scene, size=(8, 8), spp=1024, camera=camera, options={"pt.depth": 1})
        irradiance = picture.radiance.mean(dtype=numpy.float64) * math.pi / 0.5
        print(f"irradiance {irradiance:.5f}, expected {expected:.5f}")
        self.assertLess(abs(irradiance / expected - 1), 0.005)

    def test_square_lamp(self):
        # Form factor of a square from a point under its centre: 4 / (2 pi) * 2 * a/sqrt(1+a^2) atan(a/sqrt(1+a^2)), a = 1/2.
        a = 0.5 / math.sqrt(1.25)
        expected = 4 * a * math.atan(a)
        self.assertLess(abs(expected - 0.75227), 1e-5)
        self.check(make.lamp_over_floor(daemon.folder), expected)

    def test_disc_lamp(self):
        self.check(make.disc_lamp(daemon.folder), math.pi / 5)

    def test_textured_lamp(self):
        """Of a square a metre up only the strip a quarter to half a metre to the right of its middle is lit by its texture, and
        blue less than the rest. A rectangle's irradiance above one of its corners: Howell's catalogue, B-3, times pi."""
        def corner(a, b):
            x, y = math.hypot(1, a), math.hypot(1, b)
            return 0.5 * (a / x * math.atan(b / x) + b / y * math.atan(a / y))

        g = Gltf()
        texture = g.image(png(4, 1, lambda x, y: (255, 255, 188) if x == 3 else (0, 0, 0)), magFilter=9728, minFilter=9728)
        lamp = g.material("lamp", (0, 0, 0), (1, 1, 1))
        g.json["materials"][lamp]["emissiveTexture"] = {"index": texture}
        g.node(mesh=g.mesh([(-.5, 1, -.5), (.5, 1, -.5), (.5, 1, .5), (-.5, 1, .5)], [(0, 1, 2), (0, 2, 3)], lamp,
                           uvs=[(0, 0), (1, 0), (1, 1), (0, 1)]))
        g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (0.5,) * 3))
        scene = g.save(daemon.folder, "textured_lamp.gltf")
        expected = 2 * (corner(0.5, 0.5) - corner(0.25, 0.5))
        blue = ((188 / 255 + 0.055) / 1.055) ** 2.4
        for lights, tolerance in (("mis", 0.015), ("nee", 0.015), ("none", 0.03)):
            picture = daemon.render(scene, size=(8, 8), spp=1024, camera=(0, 0.5, 3, 0, 0, 0, 0, 1, 0, 0.25),
                                    options={"pt.depth": 1, "pt.lights": lights})
            got = picture.radiance.mean(axis=(0, 1), dtype=numpy.float64) * math.pi / 0.5
            print(f"{lights}: irradiance {got}, expected {expected:.5f}, blue {blue * expected:.5f}")
            for c, share in enumerate((1, 1, blue)):
                self.assertLess(abs(got[c] / (share * expected) - 1), tolerance)

    def test_point_light(self):
        # Intensity I at height 2, straight above: E = I / 4.
        self.check(make.lit_floor(daemon.folder, "point", 3.0), 0.75)

    def test_spot_light(self):
        # On its axis a spot is a point light.
        self.check(make.lit_floor(daemon.folder, "spot", 3.0), 0.75)

    def test_directional_light(self):
        self.check(make.lit_floor(daemon.folder, "directional", 3.0), 3.0)


class Superposition(unittest.TestCase):
    def test_lamp_and_light_add_up(self):
        """Next-event estimation divides its samples between both tables; together they are the sum of each alone."""
        g = Gltf()
        g.place(*icosphere(2), g.material("body", (0.6, 0.5, 0.4)))
        g.place(*quad((-5, -1, 5), (5, -1, 5), (5, -1, -5), (-5, -1, -5)), g.material("floor", (0.5,) * 3))
        g.place(*quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)), g.material("lamp", (0, 0, 0), (2, 1, 0.5)))
        g.light("point", 4.0, (2, 2, 2), colour=(0.2, 0.4, 1))
        g.light("directional", 0.5, (0, 5, 0), (1, 0, 0))
        g.camera((0, 1, 6), (0, 0, 0), 40)
        scene = g.save(daemon.folder, "both.gltf")
        both, lamp, light = (daemon.render(scene, spp=256, arguments=["--effects", effects]).radiance.astype(numpy.float64)
                             for effects in ("auto", "-lights", "-emitters"))
        for c in range(3):
            self.assertLess(abs(both[:, :, c].mean() / (lamp[:, :, c].mean() + light[:, :, c].mean()) - 1), 0.005)
        self.assertGreater(lamp.mean(), 0.01)
        self.assertGreater(light.mean(), 0.01)


class Exact(unittest.TestCase):
    def test_no_light_is_black(self):
        picture = daemon.render(make.unlit(daemon.folder), spp=8)
        self.assertEqual(float(picture.radiance.max()), 0.0)
        self.assertEqual(float(picture.radiance.min()), 0.0)

    def test_doubled_emission_doubles_every_pixel(self):
        once = daemon.render(make.cornell(daemon.folder, radiance=15.0, name="once.gltf"), spp=8)
        twice = daemon.render(make.cornell(daemon.folder, radiance=30.0, name="twice.gltf"), spp=8)
        self.assertGreater(float(once.radiance.max()), 0.0)
        self.assertTrue(numpy.array_equal(twice.radiance, 2 * once.radiance))

    def test_nothing_is_not_finite(self):
        for scene in (make.cornell(daemon.folder), make.closed_sphere(daemon.folder), make.lamp_over_floor(daemon.folder)):
            picture = daemon.render(scene, spp=8)
            self.assertTrue(bool(numpy.isfinite(picture.radiance).all()))
            self.assertEqual(picture.report["non_finite_samples"], 0)


if __name__ == "__main__":
    unittest.main()
