"""The microfacet BSDF in a white world, where it may neither lose light nor make any."""
import math
import unittest

import numpy

from render import Daemon
from writers import Gltf, icosphere, quad

daemon = Daemon()
ROUGHNESSES = (0.0, 0.02, 0.1, 0.25, 0.5, 0.75, 1.0)
ANGLES = (0, 30, 60, 75, 85, 89, 89.9)


def setUpModule():
    unittest.enterModuleContext(daemon)


def plate(**material):
    g = Gltf()
    g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("plate", **material))
    return g.save(daemon.folder, "plate.gltf")


def at_angle(scene, degrees, spp=512):
    """Mean radiance of the plate's middle, seen at an angle from its normal in a world of radiance 1."""
    a = math.radians(degrees)
    camera = (0, 5 * math.cos(a), 5 * math.sin(a), 0, 0, 0, 0, 1, 0, 0.002) if degrees else (0, 5, 0, 0, 0, 0, 0, 0, -1, 0.002)
    picture = daemon.render(scene, size=(8, 8), spp=spp, camera=camera, arguments=["--background", "1,1,1"])
    return picture.radiance.reshape(-1, 3).mean(axis=0, dtype=numpy.float64)


class WhiteFurnace(unittest.TestCase):
    def check(self, name, **material):
        worst = 0
        for roughness in ROUGHNESSES:
            scene = plate(roughness=roughness, **material)
            for angle in ANGLES:
                value = at_angle(scene, angle)
                worst = max(worst, float(numpy.abs(value - 1).max()))
                self.assertLess(float(numpy.abs(value - 1).max()), 0.01, f"{name}: roughness {roughness}, {angle} degrees: {value}")
        print(f"{name}: worst {worst:.4f}")

    def test_white_metal(self):
        self.check("white metal", albedo=(1, 1, 1), metallic=1, specular=1)

    def test_white_plastic(self):
        self.check("white plastic", albedo=(1, 1, 1), metallic=0, specular=1)

    def test_strong_coat_on_white(self):
        self.check("ior 2.5 over white", albedo=(1, 1, 1), metallic=0, specular=1, ior=2.5)

    def test_nothing_is_gained(self):
        """Coloured and half-metallic surfaces stay at or below what comes in, and at or above what a perfect one would lose."""
        for metallic in (0.0, 0.5, 1.0):
            for roughness in (0.1, 0.5, 1.0):
                scene = plate(albedo=(0.9, 0.5, 0.1), metallic=metallic, roughness=roughness, specular=1)
                for angle in (0, 60, 85):
                    value = at_angle(scene, angle)
                    self.assertLess(float(value.max()), 1.005)
                    self.assertGreater(float(value[0]), 0.5)
                    self.assertGreater(float(value[0]), float(value[2]))

    def test_smooth_normals_keep_it(self):
        """A coarse sphere with round normals: those lean up to 20 degrees away from the facets."""
        for roughness in (0.0, 0.3, 1.0):
            g = Gltf()
            positions, triangles = icosphere(1)
            g.node(mesh=g.mesh(positions, triangles, g.material("metal", (1, 1, 1), metallic=1, roughness=roughness, specular=1),
                               normals=positions))
            g.camera((0, 0, 4), (0, 0, 0), 40)
            picture = daemon.render(g.save(daemon.folder, "sphere.gltf"), spp=64, arguments=["--background", "1,1,1"])
            self.assertLess(abs(float(picture.radiance.mean(dtype=numpy.float64)) - 1), 0.003)


class Mirror(unittest.TestCase):
    def test_a_perfect_mirror_shows_what_is_behind_the_camera(self):
        """Roughness 0: the lamp's image in a metal floor has exactly the lamp's radiance times the base colour."""
        g = Gltf()
        g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("mirror", (0.5, 0.25, 1), metallic=1, roughness=0, specular=1))
        g.place(*quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)), g.material("lamp", (0, 0, 0), (4, 4, 4)))
        scene = g.save(daemon.folder, "mirror.gltf")
        # Straight down beside the lamp's edge would miss it: at an angle, the mirrored view meets the lamp's middle.
        picture = daemon.render(scene, size=(4, 4), spp=16, camera=(0, 0.5, 0.5, 0, 0, 0.4, 0, 1, 0, 0.5))
        expected = numpy.array([0.5, 0.25, 1.0])
        cosine = 0.5 / math.hypot(0.5, 0.1)
        fresnel = expected + (1 - expected) * (1 - cosine) ** 5
        value = picture.radiance.reshape(-1, 3).mean(axis=0, dtype=numpy.float64) / 4
        self.assertLess(float(numpy.abs(value / fresnel - 1).max()), 1e-3)


class LampOnGloss(unittest.TestCase):
    def test_both_ways_of_sampling_agree(self):
        """A closed sphere of radiance 1 around a metal plate: the plate is 1 too, whichever of next-event estimation and the
        BSDF's own sampling finds the sphere, and by whatever weights the two are combined."""
        for roughness in (0.2, 0.5, 0.8, 1.0):
            g = Gltf()
            g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("plate", (1, 1, 1), metallic=1, roughness=roughness, specular=1))
            positions, triangles = icosphere(2, radius=8, inward=True)
            g.place(positions, triangles, g.material("sky", (0, 0, 0), (1, 1, 1)))
            scene = g.save(daemon.folder, "sky.gltf")
            picture = daemon.render(scene, size=(8, 8), spp=1024, camera=(0, 2, 3, 0, 0, 0, 0, 1, 0, 0.5), options={"pt.depth": 1})
            value = float(picture.radiance.mean(dtype=numpy.float64))
            self.assertLess(abs(value - 1), 0.01, f"roughness {roughness}")


if __name__ == "__main__":
    unittest.main()
