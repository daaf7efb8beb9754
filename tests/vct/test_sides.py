"""Voxels that shine, and the shadows that they know of: both sides of a lamp, whatever the pyramid, and no program for a number."""
import unittest

import numpy

from common import VctDaemon
from writers import Gltf, box, quad

daemon = VctDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def vct(scene, arguments=(), **options):
    return daemon.vct(scene, size=(64, 64), arguments=arguments, **options)


def between_planes(name, both_sides=False, downwards=False):
    """A lamp halfway between a floor and a ceiling that are alike."""
    g = Gltf()
    grey = g.material("grey", (.5,) * 3)
    g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), grey)
    g.place(*quad((-2, 3, -2), (2, 3, -2), (2, 3, 2), (-2, 3, 2)), grey)
    corners = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
    lamp = g.mesh(*quad(*(corners[::-1] if downwards else corners)),
                  g.material("lamp", (0, 0, 0), (5, 5, 5), both_sides=both_sides))
    g.node(mesh=lamp, name="lamp", translation=[0, 1.5, 0])
    g.camera((0, 1.5, 6), (0, 1.5, 0), 50)
    return g.save(daemon.folder, name + ".gltf")


class Lamps(unittest.TestCase):
    def test_a_lamp_of_two_sides_is_two_lamps(self):
        # Moved, the lamp's voxels are merged into those of what stays.
        for arguments in ((), ("--node", "lamp:translate=0.5,1.4,0")):
            with self.subTest(arguments=arguments):
                both, up, down = (vct(scene, arguments, emitters="cones", bounces=0).radiance[:, :, 1]
                                  for scene in (between_planes("both", True), between_planes("up"),
                                                between_planes("down", downwards=True)))
                ceiling, floor = slice(4, 14), slice(50, 60)
                self.assertGreater(float(up[ceiling, 20:44].mean()), 0.05)
                self.assertEqual(float(up[floor].max()), 0)
                numpy.testing.assert_allclose(both[ceiling], up[ceiling], rtol=1e-3, atol=1e-4)
                numpy.testing.assert_allclose(both[floor], down[floor], rtol=1e-3, atol=1e-4)

    def test_without_a_bounce_nothing_is_lit_by_what_is_lit(self):
        # Whatever else the voxels are there for.
        for option in ({"shadows": "march"}, {"shadows": "volume"}):
            with self.subTest(**option):
                picture = vct(between_planes("up"), emitters="points", bounces=0, **option).radiance[:, :, 1]
                self.assertGreater(float(picture[4:14, 20:44].mean()), 0.05)
                self.assertEqual(float(picture[50:60].max()), 0)


class Shadows(unittest.TestCase):
    def test_shares_are_the_same_whatever_the_pyramid(self):
        g = Gltf()
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3))
        g.place(*box((-.6, 1, -.6), (.6, 1.2, .6)), g.material("block", (.5,) * 3))
        g.camera((0, 0.5, 4), (0, 0, 0), 30)
        scene = g.save(daemon.folder, "shadow.gltf")
        sun = ["--light", "directional:direction=0,-1,0,intensity=1"]
        seen = [vct(scene, sun, shadows="volume", pyramid=p, bounces=0).radiance.tobytes()
                for p in ("directional", "isotropic")]
        self.assertEqual(seen[0], seen[1])

    def test_an_aperture_compiles_nothing(self):
        g = Gltf()
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3))
        g.camera((0, 0.5, 4), (0, 0, 0), 30)
        scene = g.save(daemon.folder, "floor.gltf")
        compiled = []
        for aperture in (5, 20):
            report = vct(scene, ["--light", "point:at=0,1,0,intensity=1"], shadows="cones", shadow_aperture=aperture).report
            compiled.append("compile" in {s["name"] for s in report["stages"]})
        self.assertEqual(compiled, [True, False])


if __name__ == "__main__":
    unittest.main()
