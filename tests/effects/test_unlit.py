"""An unlit surface shows its base colour to the camera and to what shows images: mirrors, clear glass and metals. It lights nothing."""
import unittest

import numpy

from render import Daemon
from writers import Gltf, box, quad

daemon = Daemon()
COLOUR = (.8, .4, .2)
BEHIND = 1 - 2 * .04 / 1.04   # what a thin sheet of index 1.5 lets through, straight on


def setUpModule():
    unittest.enterModuleContext(daemon)


def sheet(g, material, z, turned=False):
    corners = [(-2, -2, z), (2, -2, z), (2, 2, z), (-2, 2, z)]
    g.place(*quad(*(corners[::-1] if turned else corners)), material)


class Seen(unittest.TestCase):
    def check(self, fill, share, ahead=-1, tolerance=.01, spp=64, options=None):
        """The camera is at zero and looks along z. The unlit wall is at z = −3 and faces it."""
        g = Gltf()
        sheet(g, g.material("unlit", COLOUR, unlit=True), -3)
        fill(g)
        picture = daemon.render(g.save(daemon.folder, "unlit.gltf"), (8, 8), spp, (0, 0, 0, 0, 0, ahead, 0, 1, 0, 10), options=options)
        got = picture.radiance.mean(axis=(0, 1), dtype=numpy.float64)
        for c in range(3):
            self.assertLessEqual(abs(got[c] - share * COLOUR[c]), tolerance * COLOUR[c], got)

    def glass(self, g, **more):
        return g.material("glass", clear=1, specular=1, **more)

    def test_by_itself(self):
        self.check(lambda g: None, 1, tolerance=1e-6)

    def test_through_panes(self):
        for count in (1, 2, 3):
            def panes(g):
                for i in range(count):
                    sheet(g, self.glass(g, roughness=0), -1 - .5 * i)
            # Between panes light goes to and fro: R and T of a pile of n sheets are those of n · R / (1 − R).
            r = count * (1 - BEHIND) / BEHIND
            self.check(panes, 1 / (1 + r), tolerance=.02, spp=1024, options={"pt.depth": 64})

    def test_through_a_pane_that_bends_no_light(self):
        self.check(lambda g: sheet(g, self.glass(g, roughness=0, ior=1), -2), 1, tolerance=1e-6)

    def test_through_tinted_glass(self):
        self.check(lambda g: sheet(g, self.glass(g, roughness=0, ior=1, albedo=(.5, .5, .5)), -2), .5, tolerance=1e-5)

    def test_through_frosted_glass(self):
        """The wall is all that is to be seen through it, wherever the light is bent to."""
        g = Gltf()
        g.place(*box((-3, -3, -3), (3, 3, 3), inward=True), g.material("unlit", (.5,) * 3, unlit=True))
        sheet(g, self.glass(g, roughness=.4, ior=1), -1)
        picture = daemon.render(g.save(daemon.folder, "frosted.gltf"), (8, 8), 256, (0, 0, 0, 0, 0, -1, 0, 1, 0, 10))
        self.assertLess(abs(float(picture.radiance.mean(dtype=numpy.float64)) / .5 - 1), .02)

    def test_through_a_solid_block(self):
        def block(g):
            g.place(*box((-1.5, -1.5, -2), (1.5, 1.5, -1)), self.glass(g, roughness=0, volume={"thicknessFactor": 1}))
        self.check(block, BEHIND, tolerance=.02, spp=1024)

    def test_in_mirrors(self):
        def one(g):
            sheet(g, g.material("mirror", metallic=1, roughness=0), 3, turned=True)
        self.check(one, 1, ahead=1, tolerance=1e-5)

    def test_in_a_mirror_of_a_mirror(self):
        """The wall is behind the camera's back, and the two mirrors are turned by half a right angle each."""
        g = Gltf()
        mirror = g.material("mirror", (.9,) * 3, metallic=1, roughness=0, both_sides=True)
        g.place(*quad((-1, -1, -2), (1, -1, -4), (1, 1, -4), (-1, 1, -2)), mirror)
        g.place(*quad((3, -1, -4), (5, -1, -2), (5, 1, -2), (3, 1, -4)), mirror)
        g.place(*quad((2, -2, 3), (2, 2, 3), (6, 2, 3), (6, -2, 3)), g.material("unlit", COLOUR, unlit=True, both_sides=True))
        picture = daemon.render(g.save(daemon.folder, "two.gltf"), (8, 8), 16, (0, 0, 0, 0, 0, -1, 0, 1, 0, 4))
        got = picture.radiance.mean(axis=(0, 1), dtype=numpy.float64)
        self.assertLess(float(numpy.abs(got / COLOUR - .81).max()), 2e-3)

    def test_in_a_brushed_metal(self):
        g = Gltf()
        g.place(*box((-3, -3, -3), (3, 3, 3), inward=True), g.material("unlit", (.5,) * 3, unlit=True))
        sheet(g, g.material("metal", metallic=1, roughness=.4), -1)
        picture = daemon.render(g.save(daemon.folder, "brushed.gltf"), (8, 8), 256, (0, 0, 0, 0, 0, -1, 0, 1, 0, 10))
        self.assertLess(abs(float(picture.radiance.mean(dtype=numpy.float64)) / .5 - 1), .02)

    def test_paths_that_are_cut_into_pieces_know_it(self):
        g = Gltf()
        sheet(g, g.material("unlit", COLOUR, unlit=True), -3)
        for i in range(3):
            sheet(g, self.glass(g, roughness=.1), -1 - .5 * i)
        sheet(g, g.material("floor", (.5,) * 3, specular=1, roughness=.3), 1, turned=True)
        scene = g.save(daemon.folder, "pieces.gltf")
        first, *others = (daemon.render(scene, (16, 16), 8, (0, 0, 0, 0, 0, -1, 0, 1, 0, 10), options=o).radiance
                          for o in ({}, {"pt.segment": 1}, {"pt.segment": 2, "pt.batch": 3}))
        self.assertGreater(float(first.mean()), .1)
        for other in others:
            self.assertTrue(numpy.array_equal(first, other))


class LightsNothing(unittest.TestCase):
    def test_a_floor_before_it_stays_dark(self):
        for front in (None, "glass", "mirror"):
            g = Gltf()
            sheet(g, g.material("unlit", COLOUR, unlit=True), -3)
            g.place(*quad((-2, -1, 0), (2, -1, 0), (2, -1, -3), (-2, -1, -3)), g.material("floor", (.5,) * 3))
            if front == "glass":
                sheet(g, g.material("glass", clear=1, specular=1, roughness=0), -2.5)
            if front == "mirror":
                sheet(g, g.material("mirror", metallic=1, roughness=0), .5, turned=True)
            picture = daemon.render(g.save(daemon.folder, "dark.gltf"), (16, 16), 64, (0, 0, -.5, 0, -1, -1.5, 0, 1, 0, 5))
            self.assertEqual(float(picture.radiance.max()), 0, front)


if __name__ == "__main__":
    unittest.main()
