"""Each part of a material against what it must come to, and against its stated substitute when its effect is off."""
import math
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, png, quad

daemon = Daemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def middle(picture, channel=None):
    pixels = picture.radiance if channel is None else picture.channels[channel]
    h, w = pixels.shape[:2]
    part = pixels[h // 2 - 2:h // 2 + 2, w // 2 - 2:w // 2 + 2].astype(numpy.float64)
    return part.mean(axis=(0, 1))


class NormalMap(unittest.TestCase):
    def check(self, expected, reflected, **scene):
        picture = daemon.render(make.normal_mapped_quad(daemon.folder, **scene), spp=4, arguments=["--aov", "normal"], options={"pt.depth": 1})
        normal = [float(middle(picture, f"N.{c}")) for c in "XYZ"]
        for got, value in zip(normal, expected):
            self.assertLess(abs(got - value), 0.01)
        self.assertLess(abs(float(middle(picture)[0]) / (0.5 / math.pi * reflected) - 1), 0.01)

    def test_tilts_the_normal(self):
        self.check((0.6, 0, 0.8), 0.8)
        self.check((0, 0.6, 0.8), 0.8, tilt=(0, 0.6, 0.8))

    def test_mirrored_coordinates_mirror_it(self):
        self.check((-0.6, 0, 0.8), 0.8, mirrored=True)

    def test_scale(self):
        length = math.hypot(0.3, 0.8)
        self.check((0.3 / length, 0, 0.8 / length), 0.8 / length, scale=0.5)

    def test_off_is_the_mesh(self):
        picture = daemon.render(make.normal_mapped_quad(daemon.folder), spp=4, arguments=["--effects", "-normal-maps"], options={"pt.depth": 1})
        self.assertLess(abs(float(middle(picture)[0]) / (0.5 / math.pi) - 1), 0.005)

    def test_a_furnace_stays_white_under_any_normal(self):
        """A normal that lies almost in the surface: no light is lost below it, none made."""
        for tilt in ((0.6, 0, 0.8), (0.95, 0, 0.312), (0, -0.99, 0.141)):
            scene = make.normal_mapped_quad(daemon.folder, tilt=tilt)
            picture = daemon.render(scene, spp=64, arguments=["--background", "1,1,1", "--effects", "-lights"])
            self.assertLess(abs(float(middle(picture)[0]) - 0.5), 0.003)


class SpecularMap(unittest.TestCase):
    def test_its_alpha_is_how_much_there_is(self):
        """A black mirror that is no metal, in a white world: its reflectances at 0 and 90 degrees are both the alpha's share."""
        for alpha, factor in ((1, 1), (.4, 1), (.4, .5), (0, 1)):
            g = Gltf()
            material = g.material("m", (0, 0, 0), roughness=0, specular=1)
            texture = g.image(png(1, 1, lambda x, y: (9, 9, 9, round(alpha * 255))))
            g.extend(g.json["materials"][material], "KHR_materials_specular", {"specularFactor": factor, "specularTexture": {"index": texture}})
            g.node(mesh=g.mesh(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), material, uvs=[(0, 0)] * 4))
            scene = g.save(daemon.folder, "specular.gltf")
            for degrees in (10, 75):
                a = math.radians(degrees)
                picture = daemon.render(scene, (8, 8), 16, (0, math.cos(a), math.sin(a), 0, 0, 0, 0, 1, -.1, .01), arguments=["--background", "1,1,1"])
                expected = alpha * factor * (.04 + .96 * (1 - math.cos(a)) ** 5)
                self.assertLess(abs(float(middle(picture)[0]) - expected), 2e-3 * expected + 1e-9, (alpha, factor, degrees))


class AlphaMask(unittest.TestCase):
    def test_cut_out_half(self):
        scene = make.alpha_mask(daemon.folder)
        cut = daemon.render(scene, size=(128, 96), spp=16, arguments=["--aov", "id,albedo"])
        whole = daemon.render(scene, size=(128, 96), spp=16, arguments=["--aov", "id,albedo", "--effects", "-alpha-mask"])
        leaf_cut, leaf_whole = (numpy.abs(p.channels["albedo.G"] - 0.6) < 0.01 for p in (cut, whole))
        # Half of the leaf is gone, all of it on the right.
        self.assertLess(abs(leaf_cut.sum() / leaf_whole.sum() - 0.5), 0.03)
        self.assertEqual(int(leaf_cut[:, 66:].sum()), 0)
        # And light comes through the hole: the picture is brighter there.
        self.assertGreater(float(cut.radiance[:, 66:].mean()), 1.1 * float(whole.radiance[:, 66:].mean()))

    def test_both_walks_see_the_same_hole(self):
        scene = make.alpha_mask(daemon.folder)
        single, packet = (daemon.render(scene, spp=8, options={"pt.traversal": t}) for t in ("single", "packet"))
        self.assertTrue(numpy.array_equal(single.radiance, packet.radiance))

    def test_the_factor_counts(self):
        solid = daemon.render(make.alpha_mask(daemon.folder, alpha=0.4), size=(128, 96), spp=1, arguments=["--aov", "albedo"])
        self.assertEqual(int((numpy.abs(solid.channels["albedo.G"] - 0.6) < 0.01).sum()), 0)


class AlphaBlend(unittest.TestCase):
    WHITE = ["--background", "1,1,1"]

    def test_what_is_not_there_lets_light_through(self):
        for alpha, sheets in ((.25, 1), (.25, 4), (0, 2), (1, 1)):
            picture = daemon.render(make.alpha_blend(daemon.folder, alpha, sheets), spp=256, arguments=self.WHITE)
            self.assertLess(abs(float(middle(picture)[0]) - (1 - alpha) ** sheets), .02, (alpha, sheets))

    def test_off_is_whole(self):
        picture = daemon.render(make.alpha_blend(daemon.folder), spp=4, arguments=[*self.WHITE, "--effects", "-alpha-blend"])
        self.assertEqual(float(middle(picture)[0]), 0)

    def test_any_order_of_work_gives_the_same(self):
        scene = make.alpha_blend(daemon.folder, sheets=3, albedo=.5)
        first, *others = (daemon.render(scene, spp=8, arguments=self.WHITE, options=o).radiance
                          for o in ({"pt.traversal": "single"}, {"pt.traversal": "packet"}, {"pt.segment": 2, "pt.batch": 3}))
        for other in others:
            self.assertTrue(numpy.array_equal(first, other))

    def lit_floor(self, sheet):
        g = Gltf()
        g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3))
        sheet(g)
        g.camera((0, 1, 3), (0, 0, 0), 10)
        return float(daemon.render(g.save(daemon.folder, "lit.gltf"), size=(16, 16), spp=256).radiance.mean(dtype=numpy.float64))

    def test_a_lamp_that_is_half_there_shines_half(self):
        lamp = quad((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1))
        half = self.lit_floor(lambda g: g.place(*lamp, g.material("lamp", (0, 0, 0), (2,) * 3, alpha=.5, blend=True)))
        whole = self.lit_floor(lambda g: g.place(*lamp, g.material("lamp", (0, 0, 0), (1,) * 3)))
        self.assertLess(abs(half / whole - 1), .02)

    def test_a_shadow_is_as_deep_as_it_is_there(self):
        def sheet(alpha):
            def place(g):
                g.light("point", 5.0, (0, 3, 0))
                g.place(*quad((-2, 1.5, 2), (2, 1.5, 2), (2, 1.5, -2), (-2, 1.5, -2)), g.material("sheet", (0, 0, 0), alpha=alpha, blend=True))
            return place
        self.assertLess(abs(self.lit_floor(sheet(.3)) / self.lit_floor(sheet(0)) - .7), .02)


class Colours(unittest.TestCase):
    def test_vertex_colours_interpolate(self):
        for width in (3, 4):
            picture = daemon.render(make.vertex_colours(daemon.folder, width=width), spp=4, arguments=["--aov", "albedo"])
            # In the quad's middle, halfway between the red lower left and the blue upper right corner.
            self.assertLess(float(numpy.abs([middle(picture, f"albedo.{c}") for c in "RGB"] - numpy.array([0.5, 0.0, 0.5])).max()), 0.03)
        off = daemon.render(make.vertex_colours(daemon.folder), spp=4, arguments=["--aov", "albedo", "--effects", "-vertex-colors"])
        self.assertLess(float(numpy.abs([middle(off, f"albedo.{c}") for c in "RGB"] - numpy.ones(3)).max()), 1e-6)

    def test_second_coordinates_and_transform(self):
        for override in (True, False):
            picture = daemon.render(make.second_uvs(daemon.folder, override=override), spp=4, arguments=["--aov", "albedo"])
            self.assertLess(float(numpy.abs([middle(picture, f"albedo.{c}") for c in "RGB"] - numpy.array([0.0, 0.0, 1.0])).max()), 1e-6)

    def test_unlit_shows_its_colour_and_lights_nothing(self):
        picture = daemon.render(make.unlit_quad(daemon.folder), spp=16)
        self.assertLess(float(numpy.abs(middle(picture) - numpy.array([0.25, 0.5, 0.75])).max()), 1e-6)
        self.assertEqual(float(picture.radiance[-4:].max()), 0.0)
        off = daemon.render(make.unlit_quad(daemon.folder), spp=4, arguments=["--effects", "-unlit"])
        self.assertEqual(float(off.radiance.max()), 0.0)


class Gloss(unittest.TestCase):
    def test_off_is_diffuse_with_the_base_colour(self):
        scene = make.ggx_furnace(daemon.folder, roughness=0.3, metallic=1, albedo=0.5)
        off = daemon.render(scene, spp=64, arguments=["--background", "1,1,1", "--effects", "-glossy"])
        self.assertLess(abs(float(middle(off)[0]) - 0.5), 0.005)

    def test_lamps_in_plates(self):
        """Small and large lamps in smooth and rough metal: every pair is found by one of the two ways of sampling, so a short
        render is close to a long one everywhere."""
        scene = make.plates(daemon.folder)
        short = daemon.render(scene, size=(96, 64), spp=64)
        longer = daemon.render(scene, size=(96, 64), spp=1024, arguments=["--seed", "9"])
        r = longer.radiance.astype(numpy.float64)
        error = float((((short.radiance - r) ** 2) / (r * r + 0.01)).mean())
        print(f"plates: relMSE at 64 samples {error:.2e}, estimated {short.report['estimated_relmse']:.2e}")
        self.assertLess(error, 0.02)


if __name__ == "__main__":
    unittest.main()
