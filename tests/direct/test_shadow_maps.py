"""Shadow maps: shadows where rays find them, to a texel or two; nothing on lit surfaces; and when they are made."""
import math
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, box, quad

daemon = Daemon()
SIDE = 512


def setUpModule():
    unittest.enterModuleContext(daemon)


def direct(scene, shadows="map", arguments=(), on=None, side=SIDE, **more):
    picture = (on or daemon).render(scene, spp=1, options={"direct.shadows": shadows, "direct.map": side},
                                    arguments=["--technique", "direct", *arguments], **more)
    assert picture.report["non_finite_samples"] == 0
    return picture


def stage(picture, name="shadow-maps"):
    return [s["us"] for s in picture.report["stages"] if s["name"] == name]


def times(v, scale):
    return tuple(c * scale for c in v)


def plate_over_floor(kind, scale=1.0, tilt=0.0, plate=True):
    """A floor of 4 m, turned about z by `tilt` degrees, and a plate of 1 m above it, of which an upright light's shadow on the
    floor is known."""
    g = Gltf()
    more = {"scale": [scale] * 3, "rotation": [0, 0, math.sin(math.radians(tilt) / 2), math.cos(math.radians(tilt) / 2)]}
    g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3), **more)
    if plate:
        g.place(*quad((-.5, 1, .5), (.5, 1, .5), (.5, 1, -.5), (-.5, 1, -.5)), g.material("plate", (.8,) * 3), **more)
    if kind == "point":
        # Something above the light: it is in the midst of the scene, and looks all ways.
        g.place(*quad((-.1, 3.5, .1), (.1, 3.5, .1), (.1, 3.5, -.1), (-.1, 3.5, -.1)), g.material("cap", (.5,) * 3), **more)
    if kind == "directional":
        g.light("directional", 1.0, (0, 1, 0), (0, 0, 0))
    elif kind == "spot":
        g.light("spot", 9.0 * scale ** 2, (0, 3 * scale, 0), (0, 0, 0), cone=(.6, .7))
    else:
        g.light("point", 9.0 * scale ** 2, (0, (3 if kind == "point" else 9) * scale, 0))
    g.camera((0, scale, 4 * scale), (0, 0, 0), 50)
    return g.save(daemon.folder, "plate.gltf")


def from_below(scale=1.0):
    """Straight down on the floor between it and the plate: 2.4 m across, half a metre above."""
    return (0, .5 * scale, 0, 0, 0, 0, 0, 0, -1, 2 * math.degrees(math.atan(2.4)))


class Shadows(unittest.TestCase):
    def test_edges_are_where_they_belong(self):
        # (half the shadow's width, a texel) on the floor, metres.
        cases = {"directional": (.5, 4.1 / SIDE), "spot": (.75, 6 * math.tan(.7) / SIDE), "point": (.75, 6 / SIDE),
                 "from outside": (.5625, 9 * 2 * 2 / 8 / SIDE)}
        for (kind, (half, texel)), scale in zip(cases.items(), (1e-3, 1, 1e4, 1e-3)):
            with self.subTest(kind=kind, scale=scale):
                scene = plate_over_floor(kind, scale)
                picture, lit = (direct(scene, s, camera=from_below(scale), size=(256, 256)).radiance[128, :, 0]
                                for s in ("map", "none"))
                x = abs(numpy.linspace(-1, 1, 257)[:-1] + 1 / 256) * 1.2
                inside, outside = x < half - 2 * texel, x > half + 2 * texel
                self.assertGreater(float(lit.min()), 0)
                self.assertEqual(float(picture[inside].max()), 0)
                self.assertLess(float(abs(picture[outside] / lit[outside] - 1).max()), 1e-4)
                self.assertGreater(int(inside.sum()), 60)
                self.assertGreater(int(outside.sum()), 60)

    def test_lit_surfaces_have_no_acne(self):
        for kind in ("directional", "spot", "point", "from outside"):
            for tilt, scale in ((0, 1), (25, 1e-3), (70, 1e4)):
                with self.subTest(kind=kind, tilt=tilt, scale=scale):
                    scene = plate_over_floor(kind, scale, tilt, plate=False)
                    camera = times((-1, 2, 4), scale) + (0, 0, 0, 0, 1, 0, 50)
                    mapped = direct(scene, camera=camera, side=256).radiance
                    rays = direct(scene, "rays", camera=camera).radiance
                    self.assertGreater(float(rays.max()), 0)
                    self.assertLess(float(abs(mapped - rays).max()), 1e-3 * float(rays.max()))

    def test_no_light_at_the_foot_of_a_thin_wall(self):
        g = Gltf()
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3))
        g.place(*box((-.005, 0, -2), (.005, 1, 2)), g.material("wall", (.5,) * 3))
        g.light("directional", 1.0, (0, 0, 0), (1, -1, 0))
        g.camera((.5, .5, 0), (.5, 0, 0), 90, up=(0, 0, -1))
        # The map is about 3.6 m wide, and the picture 1 m: from x = 0 on.
        share = direct(g.save(daemon.folder, "wall.gltf"), size=(256, 256)).radiance[128, :, 0]
        x = (numpy.arange(256) + .5) / 256
        texel = 4.4 / SIDE
        self.assertEqual(float(share[(x > .005 + 2 * texel) & (x < .9)].max()), 0)

    def test_alpha_is_cut_out(self):
        scene = make.alpha_mask(daemon.folder)
        lamp = ["--effects=-emitters", "--light", "point:at=.4,.6,2.5,intensity=20"]
        mapped = direct(scene, arguments=lamp, side=2048, size=(96, 96)).radiance.astype(float)
        rays = direct(scene, "rays", arguments=lamp, size=(96, 96)).radiance.astype(float)
        self.assertGreater(float(rays.max()), 0)
        self.assertLess(float((abs(mapped - rays).max(axis=2) > .05 * rays.max()).mean()), .03)

    def test_more_lights_than_maps(self):
        """Those without a map have rays, and nothing of the picture is lost."""
        g = Gltf()
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3))
        g.place(*box((-.5, 0, -.5), (.5, .5, .5)), g.material("block", (.6,) * 3))
        for i in range(20):
            a = 2 * math.pi * i / 20
            g.light("spot", .5 + .1 * i, (2 * math.cos(a), 2, 2 * math.sin(a)), (0, 0, 0), cone=(.5, .8))
        g.camera((0, 2, 4), (0, .4, 0), 45)
        scene = g.save(daemon.folder, "spots.gltf")
        mapped, rays = direct(scene), direct(scene, "rays")
        difference = abs(mapped.radiance - rays.radiance)
        self.assertLess(float(difference.mean()), .01 * float(rays.radiance.mean()))
        self.assertGreater(mapped.report["rays"], 0)
        self.assertLess(mapped.report["rays"], .3 * rays.report["rays"])

    def test_lamps_keep_their_rays(self):
        g = Gltf()
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.5,) * 3))
        g.place(*quad((-.3, 2, -.3), (.3, 2, -.3), (.3, 2, .3), (-.3, 2, .3)), g.material("lamp", (0, 0, 0), (4,) * 3))
        g.camera((0, 1, 4), (0, 0, 0), 45)
        scene = g.save(daemon.folder, "lamp_alone.gltf")
        picture = direct(scene)
        self.assertEqual(stage(picture), [])
        self.assertTrue(numpy.array_equal(picture.radiance, direct(scene, "rays").radiance))


def settled(of):
    """Bytes that are held once the worker has let go of a scene that the daemon has forgotten."""
    looks = [of.stats()["device_bytes"]]
    while len(looks) < 5 or len(set(looks[-5:])) > 1:
        looks.append(of.stats()["device_bytes"])
    return looks[-1]


class Life(unittest.TestCase):
    def test_made_once_and_anew_for_another_light(self):
        daemon.candil("load", plate_over_floor("point"), "--name", "kept")
        first = direct("kept")
        again = direct("kept", camera=(1, 2, 3, 0, 0, 0, 0, 1, 0, 50))
        self.assertGreater(stage(first)[0], 0)
        self.assertEqual(stage(again), [])
        # Other materials, the same shadows.
        self.assertEqual(stage(direct("kept", arguments=["--material", "floor:color=.1,.2,.3"])), [])
        moved = direct("kept", arguments=["--light", "point:at=1,3,0,intensity=9", "--replace-lights"])
        self.assertGreater(stage(moved)[0], 0)
        self.assertFalse(numpy.array_equal(moved.radiance, first.radiance))
        self.assertEqual(stage(direct("kept", side=256)) == [], False)
        self.assertTrue(numpy.array_equal(direct("kept").radiance, first.radiance))
        daemon.candil("unload", "kept")
        self.assertTrue(numpy.array_equal(direct(plate_over_floor("point")).radiance, first.radiance))

    def test_memory_is_kept_and_given_back(self):
        with Daemon("--memory-budget", "64") as small:
            scene = plate_over_floor("point")
            status, _, text = small.candil("render", scene, "-o", daemon.folder + "/x.exr", "--technique", "direct", "--set",
                                           "direct.shadows=map", "--set", "direct.map=4096", check=False)
            self.assertEqual(status, 6, text)
            self.assertIn("direct.map=1024 would fit", text)
            self.assertEqual(small.stats()["device_bytes"], 0)
            held = []
            for _ in range(4):
                self.assertGreater(float(direct(scene, on=small).radiance.max()), 0)
                held.append(settled(small))
            self.assertEqual(len(set(held)), 1)

    def test_cones_look_into_them_too(self):
        """vct: voxels and pixels are lit by way of the maps, and few rays are left."""
        scene = plate_over_floor("point")
        pictures = [daemon.render(scene, spp=1, size=(48, 48), arguments=["--technique", "vct"],
                                  options={"vct.shadows": s, "vct.resolution": 32, "vct.bounces": 1}) for s in ("rays", "map")]
        self.assertGreater(stage(pictures[1])[0], 0)
        self.assertEqual(pictures[1].report["rays"], 0)
        a, b = (p.radiance.astype(float) for p in pictures)
        self.assertLess(abs(b.mean() / a.mean() - 1), .02)


if __name__ == "__main__":
    unittest.main()
