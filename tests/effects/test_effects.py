"""Only what the scene calls for: an effect that a scene lacks is left out, and forcing it on changes nothing; one that is
switched off draws its stated substitute."""
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, icosphere

daemon = Daemon()
EFFECTS = ("textures", "emitters", "lights", "environment", "bounces", "glossy", "normal-maps", "alpha-mask", "vertex-colors",
           "unlit", "glass", "alpha-blend", "clearcoat", "rough-diffuse", "caustics")


def setUpModule():
    unittest.enterModuleContext(daemon)


def states(picture):
    return {e["name"]: e["state"] for e in picture.report["effects"]}


class Forced(unittest.TestCase):
    def check(self, scene, arguments=(), **more):
        auto = daemon.render(scene, spp=8, arguments=list(arguments), **more)
        forced = daemon.render(scene, spp=8, arguments=[*arguments, "--effects", "all"], **more)
        absent = [e for e in EFFECTS if states(auto)[e] == "absent"]
        self.assertGreater(len(absent), 0)
        for effect in EFFECTS:
            self.assertEqual(states(forced)[effect], "forced" if effect in absent else "simulated")
        scale = numpy.maximum(numpy.abs(auto.radiance), 1e-3)
        self.assertLessEqual(float((numpy.abs(forced.radiance - auto.radiance) / scale).max()), 1e-5)
        return absent

    def test_each_effect_is_absent_somewhere_and_inert_there(self):
        absent = set()
        absent |= set(self.check(make.cornell(daemon.folder)))
        absent |= set(self.check(make.lit_floor(daemon.folder, "point")))
        absent |= set(self.check(make.textured_quad(daemon.folder), ["--background", "1,1,1"]))
        absent |= set(self.check(make.unlit(daemon.folder)))
        self.assertEqual(absent, set(EFFECTS))


class Off(unittest.TestCase):
    def test_textures_off_shows_factors(self):
        scene = make.textured_quad(daemon.folder)
        on = daemon.render(scene, spp=8, arguments=["--background", "1,1,1"])
        off = daemon.render(scene, spp=8, arguments=["--background", "1,1,1", "--effects", "-textures"])
        self.assertEqual(states(off)["textures"], "switched-off")
        self.assertGreater(float(numpy.abs(on.radiance - 1).max()), 0.9)
        self.assertLess(float(numpy.abs(off.radiance - 1).max()), 0.005)

    def test_emitters_off_is_black(self):
        off = daemon.render(make.cornell(daemon.folder), spp=4, arguments=["--effects", "-emitters"])
        self.assertEqual(float(off.radiance.max()), 0)

    def test_glass_off_is_opaque_with_the_base_colour(self):
        def ball(name, **more):
            g = Gltf()
            positions, triangles = icosphere(2)
            g.place(positions, triangles, g.material("ball", (.2, .4, .6), roughness=.3, **more))
            g.camera((0, 0, 4), (0, 0, 0), 40)
            return g.save(daemon.folder, name)
        glass = ball("glass.gltf", clear=1, volume={"thicknessFactor": 1})
        off = daemon.render(glass, spp=8, arguments=["--background", "1,1,1", "--effects", "-glass"])
        self.assertEqual(states(off)["glass"], "switched-off")
        opaque = daemon.render(ball("opaque.gltf"), spp=8, arguments=["--background", "1,1,1"])
        self.assertEqual(states(opaque)["glass"], "absent")
        self.assertTrue(numpy.array_equal(off.radiance, opaque.radiance))
        on = daemon.render(glass, spp=8, arguments=["--background", "1,1,1"])
        self.assertGreater(float(numpy.abs(on.radiance - off.radiance).max()), 0.1)

    def test_coat_and_matte_facets_off_are_without(self):
        def ball(name, **more):
            g = Gltf()
            positions, triangles = icosphere(2)
            g.place(positions, triangles, g.material("ball", (.2, .4, .6), roughness=.3, specular=1, **more))
            g.camera((0, 0, 4), (0, 0, 0), 40)
            g.light("directional", 3, target=(0, -1, -1), up=(1, 0, 0))
            return g.save(daemon.folder, name)
        plain = daemon.render(ball("plain.gltf"), spp=8)
        for effect, more in (("clearcoat", dict(coat={"clearcoatFactor": 1})), ("rough-diffuse", dict(matte=1))):
            scene = ball(effect + ".gltf", **more)
            off = daemon.render(scene, spp=8, arguments=["--effects", "-" + effect])
            self.assertEqual((states(off)[effect], states(plain)[effect]), ("switched-off", "absent"))
            self.assertTrue(numpy.array_equal(off.radiance, plain.radiance))
            self.assertGreater(float(numpy.abs(daemon.render(scene, spp=8).radiance - off.radiance).max()), 0.01)
            direct = daemon.render(scene, spp=1, arguments=["--technique", "direct"])
            self.assertEqual(states(direct)[effect], "unsupported")

    def test_direct_sees_through_no_glass(self):
        direct = daemon.render(make.cornell_glass(daemon.folder), spp=1, arguments=["--technique", "direct"])
        self.assertEqual([states(direct)[e] for e in ("glass", "caustics")], ["unsupported"] * 2)

    def test_what_the_scene_lacks_is_absent_whoever_could(self):
        """Of glass in a scene without any nobody is told that another technique can; with it, and where it is asked for, they are."""
        scene = make.lit_floor(daemon.folder, "spot")
        for technique in ("direct", "radiosity", "vct", "pt"):
            none, asked = (daemon.render(scene, size=(8, 8), spp=1, arguments=["--technique", technique, *more])
                           for more in ((), ("--effects=+glass",)))
            for effect in ("glass", "alpha-blend", "clearcoat", "caustics"):
                told = {e["name"]: e for e in none.report["effects"]}[effect]
                self.assertEqual(told["state"], "absent", (technique, effect))
                self.assertNotIn(" can: ", told["why"])
            self.assertEqual(states(asked)["glass"], "forced" if technique in ("pt", "vct") else "unsupported")

    def test_lights_off_is_black(self):
        off = daemon.render(make.lit_floor(daemon.folder, "spot"), spp=4, arguments=["--effects", "-lights"])
        self.assertEqual(float(off.radiance.max()), 0)

    def test_environment_off_is_black(self):
        off = daemon.render(make.unlit(daemon.folder), spp=4, arguments=["--background", "1,1,1", "--effects", "-environment"])
        self.assertEqual(float(off.radiance.max()), 0)

    def test_bounces_off_is_depth_one(self):
        scene = make.cornell(daemon.folder)
        off = daemon.render(scene, spp=4, arguments=["--effects", "-bounces"])
        direct = daemon.render(scene, spp=4, options={"pt.depth": 1})
        self.assertTrue(numpy.array_equal(off.radiance, direct.radiance))
        self.assertGreater(float(off.radiance.max()), 0)


class Times(unittest.TestCase):
    def test_costs_are_told_when_asked_for(self):
        scene = make.cornell(daemon.folder)
        plain = daemon.render(scene, spp=2)
        self.assertFalse(any("cost_us" in e for e in plain.report["effects"]))
        some = daemon.render(scene, spp=2, options={"pt.effect_times": "on"})
        # On a slow machine the last ones may stay unknown.
        told = [e for e in some.report["effects"] if "cost_us" in e]
        self.assertGreater(len(told), 0)
        self.assertEqual({e["state"] for e in told}, {"simulated"})
        every = daemon.render(scene, spp=2, options={"pt.effect_times": "all"})
        self.assertGreaterEqual(len([e for e in every.report["effects"] if "cost_us" in e and "share" in e]), len(told))
        # The probe leaves nothing behind.
        self.assertTrue(numpy.array_equal(some.radiance, plain.radiance))
        self.assertEqual(some.report["rays"], plain.report["rays"])
        self.assertTrue(numpy.array_equal(every.radiance, plain.radiance))
        # Nor one of paths that are longer than a dispatch.
        deep = [daemon.render(scene, spp=2, options={"pt.segment": 3, "pt.effect_times": t}).radiance for t in ("off", "on")]
        self.assertTrue(numpy.array_equal(deep[0], deep[1]))


class Plan(unittest.TestCase):
    def test_every_effect_has_a_reason(self):
        picture = daemon.render(make.cornell(daemon.folder), spp=1)
        self.assertEqual(set(states(picture)), set(EFFECTS))
        for effect in picture.report["effects"]:
            self.assertGreater(len(effect["why"]), 5)

    def test_unknown_option_is_refused(self):
        status, _, text = daemon.candil("render", make.cornell(daemon.folder), "-o", daemon.folder + "/x.png", "--set", "pt.colour=3",
                                        check=False)
        self.assertNotEqual(status, 0)
        self.assertIn("pt.colour", text)

    def test_an_option_of_another_technique_is_refused(self):
        scene = make.cornell(daemon.folder)
        for technique, option, wanted in (("pt", "vct.show=albedo", "vct"), ("auto", "direct.samples=2", "direct, vct or radiosity"),
                                          ("direct", "vct.bounces=1", "vct"), ("vct", "pt.depth=3", "pt")):
            status, _, text = daemon.candil("render", scene, "-o", daemon.folder + "/x.png", "--technique", technique, "--set", option,
                                            check=False)
            self.assertEqual(status, 2, text)
            self.assertIn(f"only with technique {wanted}:", text)

    def test_aovs_only_when_asked(self):
        scene = make.cornell(daemon.folder)
        plain = daemon.render(scene, spp=1)
        self.assertEqual(set(plain.channels), set("RGB"))
        self.assertNotIn("aov", [s["name"] for s in plain.report["stages"]])
        full = daemon.render(scene, spp=1, arguments=["--aov", "depth,normal,albedo,id"])
        self.assertEqual(set(full.channels), {"R", "G", "B", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B", "id"})
        self.assertTrue(numpy.array_equal(plain.radiance, full.radiance))
        # The back wall is 4.9 in front of the camera at every one of its pixels: depth is along the axis, not the ray.
        middle = full.channels["Z"][20, 30:34]
        self.assertTrue(numpy.allclose(middle, 4.9, rtol=1e-5), middle)
        self.assertTrue(numpy.allclose(full.channels["N.Z"][20, 30:34], 1, atol=1e-6))


if __name__ == "__main__":
    unittest.main()
