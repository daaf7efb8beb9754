"""Default light: a scene that nothing gives light to gets a neutral sky, if the request asks for it; and no other scene does."""
import math
import os
import re
import unittest

import numpy

import images
import make
import skies
import wire
from render import SOURCE, Daemon
from wire import pb
from writers import Gltf, box, icosphere, quad

daemon = Daemon()
SKY = .8
TECHNIQUES = ("pt", "direct", "vct", "radiosity")
DOWN = (0, 2, 0, 0, 0, 0, 0, 0, -1, 20)


def setUpModule():
    unittest.enterModuleContext(daemon)


def floor(g, material, half=2.0):
    g.place(*quad((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)), material)


def wall():
    g = Gltf()
    floor(g, g.material("floor", (.5,) * 3), 4)
    g.place(*quad((-4, 0, 0), (4, 0, 0), (4, 1, 0), (-4, 1, 0)), g.material("wall", (0, 0, 0), both_sides=True))
    return g.save(daemon.folder, "wall.gltf")


def seen(scene, technique, spp, camera, **more):
    picture = daemon.render(scene, (16, 16), spp, camera, default_light=True, arguments=("--technique", technique), **more)
    assert picture.report["default_light"]
    return picture.radiance.astype(numpy.float64)


class Light(unittest.TestCase):
    def test_a_plane(self):
        """ρ L, in every pixel: nothing hides the sky."""
        g = Gltf()
        floor(g, g.material("white", (.5, .75, 1)))
        scene = g.save(daemon.folder, "plane.gltf")
        for technique, tolerance in (("pt", 1e-6), ("direct", 1e-6), ("vct", .01), ("radiosity", 1e-5)):
            got = seen(scene, technique, 1, DOWN)
            numpy.testing.assert_allclose(got, numpy.broadcast_to((.5 * SKY, .75 * SKY, SKY), got.shape), rtol=tolerance,
                                          err_msg=technique)

    def test_a_furnace(self):
        """What reflects everything and hides nothing of the sky from itself is not to be told from the sky, which is seen too."""
        for name, more in (("matte", {}), ("metal", {"metallic": 1, "roughness": .5}), ("mirror", {"metallic": 1, "roughness": 0})):
            g = Gltf()
            g.place(*icosphere(3), g.material(name, (1, 1, 1), **more))
            scene = g.save(daemon.folder, name + ".gltf")
            for technique, tolerance in (("pt", .01), ("direct", .01), ("vct", .05)):
                got = seen(scene, technique, 32 if technique == "pt" else 16, (0, 0, 4, 0, 0, 0, 0, 1, 0, 40))
                self.assertLess(abs(got.mean() / SKY - 1), tolerance, (name, technique, got.mean()))
                numpy.testing.assert_allclose(got[0, 0], SKY, rtol=1e-6)

    def test_beneath_a_wall(self):
        """A floor beside a black wall, by quadrature over the wall of what it hides: d y / (π (d² + x² + y²)²)."""
        y, x = numpy.meshgrid((numpy.arange(400) + .5) / 400, (numpy.arange(3200) + .5) / 400 - 4, indexing="ij")
        for technique, spp, tolerance, at in (("pt", 256, .02, (.25, 1)), ("direct", 64, .01, (.25, 1)), ("vct", 1, .06, (1, 2)), ("radiosity", 1, .02, (.25, 1))):
            for d in at:
                got = seen(wall(), technique, spp, (0, .5, d, 0, 0, d, 0, 0, -1, 1)).mean()
                expected = .5 * SKY * (1 - (d * y / (math.pi * (d * d + x * x + y * y) ** 2)).sum() / 400 ** 2)
                self.assertLess(abs(got / expected - 1), tolerance, (technique, d, got, expected))

    def test_direct_is_one_event_of_pt(self):
        g = Gltf()
        floor(g, g.material("floor", (.8,) * 3))
        g.place(*box((-.5, .2, -.5), (.5, 1.2, .5)), g.material("box", (.7, .3, .2), specular=1, roughness=.4))
        scene = g.save(daemon.folder, "box.gltf")
        camera = (2, 2, 3, 0, .4, 0, 0, 1, 0, 40)
        one = seen(scene, "pt", 256, camera, options={"pt.depth": 1})
        for spp, tolerance, noise in ((4, .02, .04), (64, .005, .01)):
            got = seen(scene, "direct", spp, camera)
            self.assertLess(abs(got.mean() / one.mean() - 1), tolerance, spp)
            self.assertLess(((got - one) ** 2 / (one ** 2 + .01)).mean(), noise, spp)

    def test_direct_without_shadows(self):
        got = seen(wall(), "direct", 1, (0, .5, .1, 0, 0, .1, 0, 0, -1, 1), options={"direct.shadows": "none"})
        numpy.testing.assert_allclose(got, .5 * SKY, rtol=1e-6)


class Given(unittest.TestCase):
    """Which scenes and requests get it. Pictures are as small as can be."""
    def given(self, scene, *arguments, technique="pt"):
        picture = daemon.render(scene, (8, 8), 1, arguments=("--technique", technique, *arguments), default_light=True)
        report = picture.report
        told = [note for note in report["notes"] if "neutral sky" in note]
        environment = next(e for e in report["effects"] if e["name"] == "environment")
        self.assertEqual(len(told), report["default_light"])
        self.assertEqual("neutral sky" in environment["why"], report["default_light"])
        self.assertEqual(picture.metadata["candil/request/default_light"], "on")
        self.assertEqual(picture.metadata.get("candil/default_light"), f"{SKY:g}" if report["default_light"] else None)
        if report["default_light"]:
            self.assertEqual(environment["state"], "simulated")
            self.assertGreater(picture.radiance.max(), 0)
        return report["default_light"]

    def test_without_light(self):
        scene = make.unlit(daemon.folder)
        for technique in TECHNIQUES:
            self.assertTrue(self.given(scene, technique=technique))
        self.assertTrue(self.given(scene, "--background", "0,0,0"))
        self.assertTrue(self.given(scene, "--light", "point:at=0,3,0,intensity=0"))
        self.assertTrue(self.given(make.unlit_quad(daemon.folder)), "the floor beneath the unlit sign is lit by nothing")
        self.assertTrue(self.given(scene, "--effects", "all"), "the lights that it forces are none")

    def test_unlit_surfaces_in_mirrors_and_through_clear_glass(self):
        for name, more in (("mirror", {"metallic": 1, "roughness": 0}), ("pane", {"clear": 1, "roughness": 0, "specular": 1})):
            g = Gltf()
            g.place(*quad((-2, -2, -3), (2, -2, -3), (2, 2, -3), (-2, 2, -3)), g.material("sign", (.8, .4, .2), unlit=True))
            g.place(*quad((-2, -2, -2), (2, -2, -2), (2, 2, -2), (-2, 2, -2)), g.material(name, **more))
            g.camera((0, 0, 0), (0, 0, -1), 20)
            self.assertFalse(self.given(g.save(daemon.folder, name + ".gltf")), name)
            g.place(*quad((-2, -1, 3), (2, -1, 3), (2, -1, -3), (-2, -1, -3)), g.material("floor", (.5,) * 3))
            self.assertTrue(self.given(g.save(daemon.folder, name + "_floor.gltf")), name)

    def test_with_light(self):
        scene = make.unlit(daemon.folder)
        for technique in TECHNIQUES:
            self.assertFalse(self.given(make.cornell(daemon.folder), technique=technique))
        self.assertFalse(self.given(make.lit_floor(daemon.folder, "point"), technique="direct"))
        self.assertFalse(self.given(scene, "--background", "0,0,1e-9"))
        self.assertFalse(self.given(scene, "--light", "point:at=0,3,0,intensity=1e-6"))
        self.assertFalse(self.given(scene, "--material", "floor:emission=.1"))
        black = os.path.join(daemon.folder, "black.exr")
        images.write(black, skies.even(8, 4, 0.0))
        self.assertFalse(self.given(scene, "--background", black), "the picture is what was asked for")

    def test_light_that_an_edit_takes(self):
        self.assertTrue(self.given(make.cornell(daemon.folder), "--material", "lamp:emission=0"))
        floor_lit = make.lit_floor(daemon.folder, "point")
        self.assertTrue(self.given(floor_lit, "--replace-lights", "--light", "point:at=0,3,0,intensity=0"))

    def test_light_that_is_switched_off(self):
        """Who switches off asks for the dark."""
        self.assertFalse(self.given(make.cornell(daemon.folder), "--effects", "auto,-emitters"))
        self.assertFalse(self.given(make.lit_floor(daemon.folder, "spot"), "--effects", "auto,-lights"))
        self.assertFalse(self.given(make.unlit(daemon.folder), "--effects", "auto,-environment"))
        self.assertFalse(self.given(make.unlit(daemon.folder), "--set", "vct.show=albedo", technique="vct"))

    def test_unlit_surfaces_need_none(self):
        g = Gltf()
        g.place(*icosphere(1), g.material("a", (.2, .4, .6), unlit=True))
        g.place(*quad((-5, -1, 5), (5, -1, 5), (5, -1, -5), (-5, -1, -5)), g.material("b", (1, 0, 0), unlit=True))
        scene = g.save(daemon.folder, "signs.gltf")
        for technique in TECHNIQUES:
            self.assertFalse(self.given(scene, technique=technique))
        self.assertTrue(self.given(scene, "--effects", "auto,-unlit"), "now they are lit like any other")


class Asked(unittest.TestCase):
    def test_off_unless_asked(self):
        make.unlit(daemon.folder)
        with wire.Connection(daemon.socket) as connection:
            connection.load("dark", daemon.folder, "unlit.gltf")
            for asked in (None, False, True):
                request = pb.Render(scene="dark", width=8, height=8, samples=1)
                if asked is not None:
                    request.default_light = asked
                replies = connection.follow(connection.send(wire.RENDER, request.SerializeToString()))
                accepted = next(r.body for r in replies if r.kind == wire.ACCEPTED)
                self.assertEqual(accepted.default_light, bool(asked))
                path = os.path.join(daemon.folder, "asked.exr")
                with open(path, "wb") as file:
                    file.write(wire.images(replies)[-1][1])
                self.assertEqual(images.rgb(path).max() > 0, bool(asked))

    def test_a_lit_scene_has_the_same_bits(self):
        scene = make.cornell(daemon.folder)
        for technique in TECHNIQUES:
            arguments = ("--technique", technique)
            a, b = (daemon.render(scene, (16, 16), 2, arguments=arguments, default_light=asked) for asked in (False, True))
            self.assertEqual(a.radiance.tobytes(), b.radiance.tobytes(), technique)
            self.assertEqual(a.metadata["candil/request/default_light"], "off")

    def test_the_manual_knows_its_radiance(self):
        with open(os.path.join(SOURCE, "protocol", "PROTOCOL.md"), encoding="utf-8") as manual:
            self.assertTrue(re.search(rf"neutral sky: a background of {SKY:g} W/", manual.read()))


if __name__ == "__main__":
    unittest.main()
