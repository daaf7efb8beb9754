"""What is there by name alone is not simulated: the reply says why not, forcing it on changes nothing, and an edit that wakes it
calls for it."""
import unittest

import numpy

from render import Daemon
from writers import Gltf, box, png, quad, save

daemon = Daemon()
SIZE, SPP = (16, 16), 4


def setUpModule():
    unittest.enterModuleContext(daemon)


def scene(name, build):
    """A floor, and a box of a material, under a sun. `build` gives the material of a file; it may add what it likes to a mesh."""
    g = Gltf()
    g.place(*quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), g.material("floor", (.5, .5, .5)))
    material, attributes = build(g)
    positions, triangles = box((-.5, .1, -.5), (.5, .9, .5))
    attributes = {"uvs": [(x + z, y) for x, y, z in positions], **attributes}
    g.node(mesh=g.mesh(positions, triangles, material, **attributes))
    g.camera((2, 1.5, 3), (0, .4, 0), 30)
    g.light("directional", 3, target=(-.3, -1, -.2), up=(1, 0, 0))
    return g.save(daemon.folder, name + ".gltf")


def image(g, pixel):
    return {"index": g.image(png(4, 4, pixel))}


def checks(x, y):
    return (40, 90, 200) if (x + y) % 2 else (200, 160, 40)


def put(g, material, extension=None, **fields):
    target = g.json["materials"][material]
    if extension:
        g.extend(target, extension, fields)
    else:
        target.update(fields)
    return material, {}


def textured(g, extension, name, pixel, **fields):
    m = g.material("box", (.6, .5, .4), roughness=.4, specular=1)
    return put(g, m, extension, **fields, **{name: image(g, pixel)})


def colours(values, **more):
    return lambda g: (g.material("box", **more), {"colors": [values[i % len(values)] for i in range(8)]})


def normal_map(g, scale, **more):
    m = g.material("box", **more)
    return put(g, m, normalTexture={**image(g, lambda x, y: (200, 90, 220)), "scale": scale})


def no_surface(g):
    m = g.material("box", (.6, .5, .4), roughness=0, metallic=0)
    g.json["materials"][m]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = image(g, checks)
    return m, {}


# By name: the effect that must be absent, the words of its reason, and the material.
INERT = {
    "mask of alpha 1": ("alpha-mask", "nowhere below", lambda g: (g.material("box", (.6, .5, .4), cutoff=.5), {})),
    "mask beyond its cutoff": ("alpha-mask", "nowhere below", lambda g: (
        g.material("box", texture=image(g, lambda x, y: (90, 90, 90, 140 + 20 * x)), cutoff=.5), {})),
    "mask that vertices keep": ("alpha-mask", "nowhere below", colours([(.9, .5, .5, .7), (.2, .5, .9, .6)], cutoff=.5)),
    "blend of alpha 1": ("alpha-blend", "1 everywhere", lambda g: (g.material("box", (.6, .5, .4), blend=True), {})),
    "blend by a picture without alpha": ("alpha-blend", "1 everywhere", lambda g: (
        g.material("box", texture=image(g, checks), blend=True), {})),
    "normal map of scale 0": ("normal-maps", "scale of zero", lambda g: normal_map(g, 0, albedo=(.6, .5, .4))),
    "normal map on black": ("normal-maps", "nothing reflects", lambda g: normal_map(g, 1, albedo=(0, 0, 0))),
    "normal map without coordinates": ("normal-maps", "no coordinates", lambda g: (
        normal_map(g, 1, albedo=(.6, .5, .4))[0], {"uvs": None})),
    "unlit and nowhere there": ("unlit", "by its alpha", lambda g: (g.material("box", alpha=0, blend=True, unlit=True), {})),
    "matte metal": ("rough-diffuse", "metal", lambda g: (g.material("box", (.6, .5, .4), metallic=1, roughness=.4, matte=.9), {})),
    "matte black": ("rough-diffuse", "black", lambda g: (g.material("box", (0, 0, 0), specular=1, roughness=.3, matte=.9), {})),
    "clear metal": ("glass", "all metal", lambda g: (g.material("box", (.6, .5, .4), metallic=1, roughness=.4, clear=1), {})),
    "opaque by its texture": ("glass", "texture", lambda g: textured(
        g, "KHR_materials_transmission", "transmissionTexture", lambda x, y: (0, 99, 99), transmissionFactor=1)),
    "coat of none by its texture": ("clearcoat", "textures", lambda g: textured(
        g, "KHR_materials_clearcoat", "clearcoatTexture", lambda x, y: (0, 99, 99), clearcoatFactor=1)),
    "gloss of none by its texture": ("glossy", "by its texture", lambda g: put(
        g, g.material("box", (.6, .5, .4), specular=1), "KHR_materials_specular", specularFactor=1,
        specularTexture=image(g, lambda x, y: (99, 99, 99, 0)))),
    "gloss of what is all clear": ("glossy", "clear", lambda g: (g.material("box", (.9, .8, .7), roughness=.2, specular=1, clear=1), {})),
    "emission by a black texture": ("emitters", "black texture", lambda g: textured(
        g, None, "emissiveTexture", lambda x, y: (0, 0, 0), emissiveFactor=[1, 1, 1])),
    "texture on black": ("textures", "on black", lambda g: (g.material("box", (0, 0, 0), texture=image(g, checks)), {})),
    "white texture": ("textures", "white", lambda g: (g.material("box", texture=image(g, lambda x, y: (255, 255, 255))), {})),
    "texture of no roughness": ("textures", "without weight", no_surface),
    "vertex colours on black": ("vertex-colors", "on black", colours([(.5, 1, 1, 1), (.2, .3, .4, 1)], albedo=(0, 0, 0))),
    "vertex alpha of what is opaque": ("vertex-colors", "nothing reads", colours([(1, 1, 1, .3)], albedo=(.6, .5, .4))),
}


def report(picture):
    return {e["name"]: e for e in picture.report["effects"]}


class Inert(unittest.TestCase):
    def forced(self, path, technique="pt", more=()):
        auto = daemon.render(path, SIZE, SPP, arguments=["--technique", technique, *more])
        on = daemon.render(path, SIZE, SPP, arguments=["--technique", technique, "--effects", "all", *more])
        scale = numpy.maximum(numpy.abs(auto.radiance), 1e-3)
        self.assertLessEqual(float((numpy.abs(on.radiance - auto.radiance) / scale).max()), 1e-5)
        return report(auto)

    def test_it_is_left_out_with_its_reason_and_forcing_it_changes_nothing(self):
        for name, (effect, words, build) in INERT.items():
            with self.subTest(name):
                told = self.forced(scene(name.replace(" ", "-"), build))[effect]
                self.assertEqual(told["state"], "absent")
                self.assertIn(words, told["why"])
                self.assertLess(len(told["why"]), 95)

    def test_what_others_run_keeps_the_textures_that_take_it_away(self):
        """Two boxes of one scene: one has a coat, the other has none by its texture. Without textures both had one."""
        def build(g):
            shiny = g.material("shiny", (.3, .3, .3), coat={"clearcoatFactor": 1})
            g.place(*box((-2, .1, -.5), (-1, .9, .5)), shiny)
            return textured(g, "KHR_materials_clearcoat", "clearcoatTexture", lambda x, y: (0, 99, 99), clearcoatFactor=1)
        told = self.forced(scene("two-coats", build))
        self.assertEqual([told[e]["state"] for e in ("clearcoat", "textures")], ["simulated"] * 2)

    def test_the_other_techniques(self):
        for technique in ("direct", "vct", "radiosity"):
            for name in ("mask of alpha 1", "texture on black", "gloss of what is all clear"):
                with self.subTest((technique, name)):
                    effect, _, build = INERT[name]
                    told = self.forced(scene(name.replace(" ", "-"), build), technique)[effect]
                    # What is clear these two draw opaque, with the gloss that it has by name.
                    opaque = technique in ("direct", "radiosity") and effect == "glossy"
                    self.assertEqual(told["state"], "simulated" if opaque else "absent")

    def test_a_flat_normal_map_is_not_flat(self):
        """128 of 255 is 1/255 above the middle: the map tilts by a third of a degree, which light shows."""
        path = scene("flat", lambda g: put(g, g.material("box", (.6, .5, .4)), normalTexture=image(g, lambda x, y: (128, 128, 255))))
        on, off = (daemon.render(path, SIZE, SPP, arguments=a) for a in ([], ["--effects", "-normal-maps"]))
        self.assertEqual(report(on)["normal-maps"]["state"], "simulated")
        self.assertGreater(float(numpy.abs(on.radiance / numpy.maximum(off.radiance, 1e-3) - 1).max()), 1e-3)

    def test_black_surroundings_are_none(self):
        path = scene("plain", lambda g: (g.material("box"), {}))
        around = save(daemon.folder, "black.png", png(4, 2, lambda x, y: (0, 0, 0)))
        self.assertEqual(self.forced(path, more=["--background", around])["environment"]["state"], "absent")

    def test_a_normal_map_on_black_is_there_for_who_asks_for_normals(self):
        path = scene("normals", INERT["normal map on black"][2])
        plain, shown = (daemon.render(path, SIZE, SPP, arguments=a) for a in ([], ["--aov", "normal"]))
        forced = daemon.render(path, SIZE, SPP, arguments=["--aov", "normal", "--effects", "all"])
        self.assertEqual([report(p)["normal-maps"]["state"] for p in (plain, shown)], ["absent", "simulated"])
        self.assertTrue(numpy.array_equal(shown.channels["N.X"], forced.channels["N.X"]))
        self.assertTrue(numpy.array_equal(plain.radiance, shown.radiance))


class Awake(unittest.TestCase):
    """An edit that wakes what slept has the picture of a file that has it so."""

    def check(self, effect, sleeping, edit, waking):
        asleep = scene("asleep", sleeping)
        self.assertEqual(report(daemon.render(asleep, SIZE, 1))[effect]["state"], "absent")
        edited = daemon.render(asleep, SIZE, SPP, arguments=["--material", "box:" + edit])
        file = daemon.render(scene("awake", waking), SIZE, SPP)
        self.assertEqual([report(p)[effect]["state"] for p in (edited, file)], ["simulated"] * 2)
        self.assertTrue(numpy.array_equal(edited.radiance, file.radiance))
        self.assertEqual(report(daemon.render(asleep, SIZE, 1))[effect]["state"], "absent")

    def test_no_metal_any_more(self):
        def build(metal):
            return lambda g: (g.material("box", (.6, .5, .4), metallic=metal, roughness=.4, clear=.5, specular=1), {})
        self.check("glass", build(1), "metallic=0", build(0))

    def test_no_black_any_more(self):
        def build(albedo):
            return lambda g: (g.material("box", albedo, texture=image(g, checks)), {})
        self.check("textures", build((0, 0, 0)), "color=1,1,1", build((1, 1, 1)))
        values = [(.5, 1, 1, 1), (.2, .3, .4, 1)]
        self.check("vertex-colors", colours(values, albedo=(0, 0, 0)), "color=1,.5,.25", colours(values, albedo=(1, .5, .25)))

    def test_matte_once_it_is_no_metal(self):
        def build(metal):
            return lambda g: (g.material("box", (.6, .5, .4), metallic=metal, roughness=.4, matte=.75), {})
        self.check("rough-diffuse", build(1), "metallic=.5", build(.5))

    def test_a_normal_map_once_something_reflects(self):
        self.check("normal-maps", lambda g: normal_map(g, 1, albedo=(0, 0, 0)), "color=.5,.5,.5",
                   lambda g: normal_map(g, 1, albedo=(.5, .5, .5)))


if __name__ == "__main__":
    unittest.main()
