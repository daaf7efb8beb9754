"""What `direct` shows: irradiances known in closed form, and else the path tracer's light after one scattering event."""
import math
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, icosphere, quad

daemon = Daemon()
DIRECT = ["--technique", "direct"]


def setUpModule():
    unittest.enterModuleContext(daemon)


def direct(scene, spp=1, arguments=(), **more):
    return daemon.render(scene, spp=spp, arguments=[*DIRECT, *arguments], **more)


def relmse(picture, reference):
    x, r = picture.radiance.astype(numpy.float64), reference.radiance.astype(numpy.float64)
    return float(((x - r) ** 2 / (r * r + 0.01)).mean())


class ClosedForms(unittest.TestCase):
    def check(self, scene, expected, tolerance, **more):
        camera = (0, 0.5, 3, 0, 0, 0, 0, 1, 0, 0.25)
        picture = direct(scene, size=(8, 8), camera=camera, **more)
        irradiance = picture.radiance.mean(dtype=numpy.float64) * math.pi / 0.5
        print(f"irradiance {irradiance:.6f}, expected {expected:.6f}")
        self.assertLess(abs(irradiance / expected - 1), tolerance)

    def test_square_lamp(self):
        a = 0.5 / math.sqrt(1.25)
        self.check(make.lamp_over_floor(daemon.folder), 4 * a * math.atan(a), 1e-3)

    def test_disc_lamp_of_many_triangles(self):
        # Too many for the closed form: points on them alone.
        self.check(make.disc_lamp(daemon.folder), math.pi / 5, 0.01, spp=4, options={"direct.samples": 16})

    def test_small_lamp_is_a_point(self):
        side = 1e-3
        g = Gltf()
        g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3))
        g.place(*quad(*((x * side, 2, z * side) for x, z in ((-.5, -.5), (.5, -.5), (.5, .5), (-.5, .5)))),
                g.material("lamp", (0, 0, 0), (1e6,) * 3))
        g.camera((0, 1, 4), (0, 0, 0), 40)
        self.check(g.save(daemon.folder, "small_lamp.gltf"), 0.25, 1e-3)

    def test_lamp_half_below_the_horizon(self):
        """A wall that goes up from the floor shows a floor's point beside it half a hemisphere's cosine, if it is high and
        wide enough; the part of it that reaches below the floor adds nothing."""
        g = Gltf()
        g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (.5,) * 3))
        g.place(*quad((-1e4, -3, -.1), (1e4, -3, -.1), (1e4, 1e4, -.1), (-1e4, 1e4, -.1)),
                g.material("lamp", (0, 0, 0), (1,) * 3))
        g.camera((0, 1, 4), (0, 0, 0), 40)
        self.check(g.save(daemon.folder, "horizon.gltf"), math.pi / 2, 1e-3)

    def test_point_light(self):
        self.check(make.lit_floor(daemon.folder, "point", 3.0), 0.75, 1e-3)

    def test_spot_light(self):
        self.check(make.lit_floor(daemon.folder, "spot", 3.0), 0.75, 1e-3)

    def test_directional_light(self):
        self.check(make.lit_floor(daemon.folder, "directional", 3.0), 3.0, 1e-4)


def mixed():
    """Every kind of light over smooth, glossy and diffuse bodies."""
    g = Gltf()
    positions, triangles = icosphere(2)
    shiny = g.material("shiny", (.7, .5, .3), metallic=.5, roughness=.4)
    g.node(mesh=g.mesh(positions, triangles, shiny, normals=positions))
    g.place(*quad((-5, -1, 5), (5, -1, 5), (5, -1, -5), (-5, -1, -5)), g.material("floor", (0.5,) * 3))
    g.place(*quad((-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)), g.material("lamp", (0, 0, 0), (2, 1, 0.5)))
    g.light("point", 4.0, (2, 2, 2), colour=(0.2, 0.4, 1))
    g.light("directional", 0.5, (0, 5, 0), (1, 0, 0))
    g.light("spot", 6.0, (-3, 3, 2), (0, 0, 0), cone=(.2, .4))
    g.camera((0, 1, 6), (0, 0, 0), 40)
    return g.save(daemon.folder, "mixed.gltf")


def many_lights():
    """A hundred points of light: more than there are shadow rays."""
    g = Gltf()
    g.place(*icosphere(1), g.material("body", (.6,) * 3))
    g.place(*quad((-5, -1, 5), (5, -1, 5), (5, -1, -5), (-5, -1, -5)), g.material("floor", (0.5,) * 3))
    for i in range(100):
        a = 2 * math.pi * i / 100
        g.light("point", .02 + .08 * (i % 2), (3 * math.cos(a), 2, 3 * math.sin(a)))
    g.camera((0, 1, 6), (0, 0, 0), 40)
    return g.save(daemon.folder, "many.gltf")


def mirror():
    """A perfect mirror on the floor under a lamp: the lamp is in it."""
    g = Gltf()
    g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("mirror", (.9,) * 3, metallic=1, roughness=0))
    g.place(*quad((-.5, 1, -1), (-.5, 2, -1), (.5, 2, -1), (.5, 1, -1)), g.material("lamp", (0, 0, 0), (1, 2, 3), both_sides=True))
    g.camera((0, 2, 4), (0, .5, 0), 50)
    return g.save(daemon.folder, "mirror.gltf")


class EqualsPathTracing(unittest.TestCase):
    """16 samples against 128 of one event: what differs is noise."""

    def check(self, scene, bound, pt_spp=128, mean_bound=0.02, **more):
        picture = direct(scene, spp=16, size=(40, 40), **more)
        reference = daemon.render(scene, spp=pt_spp, size=(40, 40), options={"pt.depth": 1})
        error = relmse(picture, reference)
        mean = float(picture.radiance.mean() / reference.radiance.mean())
        print(f"{scene.split('/')[-1]}: relMSE {error:.2e}, mean ratio {mean:.4f}")
        self.assertGreater(float(reference.radiance.max()), 0)
        self.assertLess(error, bound)
        self.assertLess(abs(mean - 1), mean_bound)

    def test_box_with_lamp(self):
        # The lamp, two pixels high, outshines all else.
        self.check(make.cornell(daemon.folder), 1e-2, mean_bound=0.06)

    def test_alpha_mask(self):
        self.check(make.alpha_mask(daemon.folder), 3e-3)

    def test_vertex_colours(self):
        self.check(make.vertex_colours(daemon.folder), 2e-4, pt_spp=64)

    def test_textures_and_second_coordinates(self):
        self.check(make.second_uvs(daemon.folder), 2e-4, pt_spp=64)

    def test_normal_map(self):
        self.check(make.normal_mapped_quad(daemon.folder), 2e-4, pt_spp=64)

    def test_negative_scale(self):
        # The lamp shines up: all that is to be seen is its small front, and little more than its edges.
        self.check(make.negative_scale(daemon.folder), 2e-3, mean_bound=0.06)

    def test_every_kind_of_light_on_gloss(self):
        # The path tracer chooses the spot seldom.
        self.check(mixed(), 3e-2)

    def test_more_lights_than_shadow_rays(self):
        self.check(many_lights(), 3e-3)

    def test_lamps_in_rough_plates(self):
        # Lamps of radiance 100 in the sharpest plate: whatever the samples, some pixels keep some noise.
        self.check(make.plates(daemon.folder), 5e-2, mean_bound=0.08)

    def test_mirror_shows_the_lamp(self):
        self.check(mirror(), 5e-3)

    def test_one_sample_has_no_noise(self):
        """A picture of one sample: off its edges it is the converged one, and shadows are soft."""
        scene = make.cornell(daemon.folder)
        picture = direct(scene, size=(64, 64))
        reference = daemon.render(scene, spp=128, size=(64, 64), options={"pt.depth": 1})
        r = reference.radiance.astype(numpy.float64)
        error = numpy.sort((((picture.radiance - r) ** 2) / (r * r + .01)).mean(axis=2).ravel())
        print(f"one sample: 90 % of the pixels have relMSE {error[:int(.9 * error.size)].mean():.2e}")
        self.assertLess(error[:int(.9 * error.size)].mean(), 1e-3)


class Aovs(unittest.TestCase):
    def test_the_same_as_the_path_tracers(self):
        for scene in (make.cornell(daemon.folder), make.alpha_mask(daemon.folder), make.normal_mapped_quad(daemon.folder),
                      make.unlit(daemon.folder)):
            aov = ["--aov", "depth,normal,albedo,id"]
            a = direct(scene, size=(96, 96), arguments=aov).channels
            b = daemon.render(scene, size=(96, 96), spp=1, arguments=aov).channels
            self.assertEqual(set(a), set(b))
            same = a["id"] == b["id"]
            self.assertGreater(float(same.mean()), 0.995)
            hit = same & (b["id"] != 0)
            self.assertTrue(numpy.array_equal(a["Z"][same & ~hit], b["Z"][same & ~hit]))
            for name in set(a) - set("RGB") - {"id"}:
                close = numpy.isclose(a[name][hit], b[name][hit], rtol=1e-3, atol=1e-4)
                self.assertGreater(float(close.mean()), 0.995, name)


class Effects(unittest.TestCase):
    def test_bounces_are_beyond_it(self):
        picture = direct(make.cornell(daemon.folder), size=(8, 8))
        bounces = [e for e in picture.report["effects"] if e["name"] == "bounces"][0]
        self.assertEqual(bounces["state"], "unsupported")
        self.assertIn("pt", bounces["why"])
        self.assertEqual(picture.metadata["candil/technique"], "direct")

    def test_forced_effects_change_nothing(self):
        for scene in (make.cornell(daemon.folder), make.lit_floor(daemon.folder, "spot"), make.textured_quad(daemon.folder)):
            auto = direct(scene)
            forced = direct(scene, arguments=["--effects", "all"])
            scale = numpy.maximum(numpy.abs(auto.radiance), 1e-3)
            self.assertLessEqual(float((numpy.abs(forced.radiance - auto.radiance) / scale).max()), 1e-5)

    def test_switched_off_is_dark(self):
        for scene, effect in ((make.cornell(daemon.folder), "emitters"), (make.lit_floor(daemon.folder, "point"), "lights")):
            picture = direct(scene, arguments=["--effects", "-" + effect])
            self.assertEqual(float(picture.radiance.max()), 0)

    def test_unlit_and_background(self):
        picture = direct(make.unlit_quad(daemon.folder), arguments=["--background", ".5,.25,2"])
        self.assertTrue(numpy.allclose(picture.radiance[0, 0], (.5, .25, 2)))
        self.assertTrue(numpy.allclose(picture.radiance[32, 32], (.25, .5, .75)))

    def test_options(self):
        scene = make.cornell(daemon.folder)
        shadows = direct(scene)
        none = direct(scene, options={"direct.shadows": "none"})
        self.assertTrue(bool((none.radiance >= 0.9999 * shadows.radiance).all()))
        self.assertGreater(float(none.radiance.mean()), 1.02 * float(shadows.radiance.mean()))
        status, _, text = daemon.candil("render", scene, "-o", daemon.folder + "/x.png", *DIRECT, "--set", "direct.samples=65",
                                        check=False)
        self.assertEqual(status, 2)
        self.assertIn("direct.samples", text)


if __name__ == "__main__":
    unittest.main()
