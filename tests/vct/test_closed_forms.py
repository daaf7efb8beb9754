"""Pictures of voxel cone tracing that are known beforehand: furnaces, exact zeros and doubles, sums of lights."""
import unittest

import numpy

import make
import rooms
from common import WHITE, VctDaemon
from writers import Gltf, icosphere, quad

daemon = VctDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


class Furnace(unittest.TestCase):
    def test_plane_is_its_albedo(self):
        """Nothing is there but the plane itself, and that it must not see: neither in thin grids nor in cubes, by whatever
        cones."""
        for albedo in (0.7, 1.0):
            scene = rooms.plane(daemon.folder, albedo)
            for options in ({"resolution": 32}, {"resolution": 64}, {"resolution": 64, "grid": "cube"}, {"resolution": 32, "cones": 32},
                            {"resolution": 32, "detail": "full"}):
                with self.subTest(albedo=albedo, **options):
                    picture = daemon.vct(scene, arguments=WHITE, **options)
                    self.assertLess(float(numpy.abs(picture.radiance[6:26, 6:26] / albedo - 1).max()), 1e-3)

    def test_convex_body_is_nearly_its_albedo(self):
        """A facet's neighbours lie in its own voxels, below its plane in truth and at it in voxels: cones along the
        surface meet them. What they hide of the background is 5 % in the mean, 15 % at the worst facet; what they send
        instead makes up for it the more, the whiter they are."""
        for albedo, mean, least in ((1.0, 0.03, 0.9), (0.25, 0.06, 0.8)):
            scene = make.furnace(daemon.folder, albedo=albedo, name=f"furnace_{albedo}.gltf")
            for resolution in (32, 64):
                middle = daemon.vct(scene, resolution, arguments=WHITE).radiance[10:22, 10:22] / albedo
                print(f"sphere, albedo {albedo}, {resolution}: mean {middle.mean():.4f}, {middle.min():.4f} to {middle.max():.4f}")
                self.assertLess(abs(float(middle.mean()) - 1), mean)
                self.assertGreater(float(middle.min()), least)
                self.assertLess(float(middle.max()), 1.001)

    def test_nothing_but_background(self):
        picture = daemon.vct(make.furnace(daemon.folder), camera=(0, 0, 4, 0, 0, 9, 0, 1, 0, 40), arguments=WHITE)
        self.assertEqual(float(picture.radiance.min()), 1.0)
        self.assertEqual(float(picture.radiance.max()), 1.0)


class Exact(unittest.TestCase):
    def test_no_light_is_black(self):
        picture = daemon.vct(make.unlit(daemon.folder))
        self.assertEqual((float(picture.radiance.min()), float(picture.radiance.max())), (0.0, 0.0))

    def test_doubled_emission_doubles_every_pixel(self):
        """By points on the lamp and by cones alone: the scale of the voxels' half floats doubles with the light."""
        scenes = [make.cornell(daemon.folder, radiance=r, name=f"radiance_{r}.gltf") for r in (15.0, 30.0)]
        for emitters in ("points", "cones"):
            once, twice = (daemon.vct(scene, emitters=emitters).radiance for scene in scenes)
            self.assertGreater(float(once.max()), 0.0)
            numpy.testing.assert_array_equal(twice, 2 * once)

    def test_sealed_room_is_nearly_dark(self):
        """A lamp of radiance 1e6 one hundredth outside of a closed room, a fifth of a voxel: what comes in is its leak."""
        inside = daemon.vct(make.sealed_room(daemon.folder), 64).radiance
        self.assertLess(float(inside.mean()), 1e6 * 0.01)


class Sums(unittest.TestCase):
    def scene(self, name, lamp, light):
        g = Gltf()
        g.place(*icosphere(2), g.material("body", (0.6, 0.5, 0.4)))
        g.place(*quad((-5, -1, 5), (5, -1, 5), (5, -1, -5), (-5, -1, -5)), g.material("floor", (0.5,) * 3))
        g.place(*quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)), g.material("lamp", (0, 0, 0), (2 * lamp, lamp, lamp / 2)))
        if light:
            g.light("point", 4.0 * light, (2, 2, 2), colour=(0.2, 0.4, 1))
        g.camera((0, 1, 6), (0, 0, 0), 40)
        return g.save(daemon.folder, name + ".gltf")

    def test_lights_apart_add_up(self):
        """Every light has as many bounces, whether it comes by rays, by cones, or from the background: half floats' 11 bits are
        all that may differ."""
        white = ["--background", "0.3,0.2,0.1"]
        scenes = {name: self.scene(name, *lights) for name, lights in
                  {"both": (1, 1), "lamp": (1, 0), "light": (0, 1), "none": (0, 0)}.items()}
        for emitters in ("points", "cones"):
            everything = daemon.vct(scenes["both"], size=(64, 64), arguments=white, emitters=emitters).radiance
            parts = [daemon.vct(scenes[name], size=(64, 64), arguments=arguments, emitters=emitters).radiance
                     for name, arguments in (("lamp", []), ("light", []), ("none", white))]
            self.assertTrue(all(float(part.mean()) > 0.005 for part in parts))
            numpy.testing.assert_allclose(sum(parts), everything, rtol=3e-3, atol=1e-4)


if __name__ == "__main__":
    unittest.main()
