"""Light from lamps by way of polished surfaces: what light paths bring, against closed forms and against chance."""
import math
import os
import unittest

import numpy

import images
import make
import skies
from render import Daemon, rel
from writers import Gltf, box, icosphere, png, quad, transformed

daemon = Daemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def stages(picture):
    return {s["name"] for s in picture.report["stages"]}


def mean(picture):
    return picture.radiance.reshape(-1, 3).mean(axis=0, dtype=numpy.float64)


def fresnel(degrees, n):
    i = math.radians(degrees)
    t = math.asin(math.sin(i) / n)
    c, d = math.cos(i), math.cos(t)
    return (((c - n * d) / (c + n * d)) ** 2 + ((n * c - d) / (n * c + d)) ** 2) / 2


def floor(half, height=0.0):
    return quad((-half, height, half), (half, height, half), (half, height, -half), (-half, height, -half))


def ceiling(half, height):
    return quad((-half, height, -half), (half, height, -half), (half, height, half), (-half, height, half))


def glass(g, ior=1.5, solid=True, roughness=0.0, **more):
    return g.material("glass", clear=1, roughness=roughness, ior=ior, volume={"thicknessFactor": 1} if solid else None, **more)


class Plates(unittest.TestCase):
    """Parallel light on a floor of albedo 1/2, seen from between it and a clear plate."""

    CAMERA = (0, .45, 0, 0, 0, 0, 0, 0, -1, 120)

    def scene(self, solid):
        g = Gltf()
        g.place(*floor(3), g.material("floor", (.5, .5, .5)))
        if solid:
            g.place(*box((-1.5, .5, -1.5), (1.5, .8, 1.5)), glass(g))
        else:
            g.place(*floor(1.5, .5), glass(g, solid=False))
        return g.save(daemon.folder, "plate.gltf")

    def irradiance(self, solid, degrees, depth, spp=1024, width=0, size=(16, 16), more=()):
        a = math.radians(degrees)
        light = "directional:direction=%r,%r,0,intensity=%r,angle=%g" % (math.sin(a), -math.cos(a), math.pi, width)
        return daemon.render(self.scene(solid), size=size, spp=spp, camera=self.CAMERA, options={"pt.depth": depth},
                             arguments=["--light", light, *more])

    def passed(self, degrees):
        r = fresnel(degrees, 1.5)
        return .5 * math.cos(math.radians(degrees)) * (1 - r) / (1 + r)

    def test_light_comes_through_a_thin_pane(self):
        """From a disc as wide as five degrees nearly as much as from its middle."""
        for degrees, width in ((0, 0), (40, 0), (40, 5)):
            expected = self.passed(degrees)
            value = float(mean(self.irradiance(False, degrees, 2, width=width))[0])
            print(f"pane, {degrees} degrees, {width} wide: {value:.4f}, {expected:.4f} expected")
            self.assertLess(rel(value, expected), 0.03)

    def test_each_band_has_its_own(self):
        """A picture of more pixels than software devices bind is cut into bands, which have light paths each."""
        rows = 134217728 // (2048 * 48 * 8) * 8
        picture = self.irradiance(False, 20, 2, 1, size=(2048, rows + 640), more=["--orthographic", "1.6"]).radiance[:, :, 0]
        for part in (picture[:rows], picture[rows:]):
            value = float(part.mean(dtype=numpy.float64))
            print(f"{part.shape[0]} rows: {value:.4f}, {self.passed(20):.4f} expected")
            self.assertLess(rel(value, self.passed(20)), 0.02)

    def test_the_suns_of_a_sky(self):
        """One bright texel and its rim: what comes of every direction, by fine quadrature."""
        sky = skies.spot(64, 32, 40, 8, 1e4)
        fine = skies.finer(sky, 8)[:, :, 0] * skies.solid_angles(512, 256)[:, None]
        heights = skies.directions(512, 256)[:, :, 1]
        expected = sum(float(fine[y].sum()) * self.passed(math.degrees(math.acos(heights[y, 0]))) / math.pi for y in range(100))
        images.write(os.path.join(daemon.folder, "spot.exr"), sky)
        picture = daemon.render(self.scene(False), size=(16, 16), spp=1024, camera=self.CAMERA, options={"pt.depth": 2},
                                arguments=["--background", os.path.join(daemon.folder, "spot.exr")])
        self.assertIn("caustics", stages(picture))
        value = float(mean(picture)[0])
        print(f"a texel of 1e4: {value:.3f}, {expected:.3f} expected")
        self.assertLess(rel(value, expected), 0.03)

    def test_and_through_a_slab(self):
        """With what goes to and fro inside of it, but for the little that depth cuts."""
        for degrees in (0, 40):
            r = fresnel(degrees, 1.5)
            expected = .5 * math.cos(math.radians(degrees)) * (1 - r) / (1 + r)
            value = float(mean(self.irradiance(True, degrees, 7))[0])
            # The floor's own light, sent back by the slab, comes on top: the camera's paths find it.
            without = float(mean(self.irradiance(True, degrees, 3))[0])
            print(f"slab, {degrees} degrees: {value:.4f}, {without:.4f} straight through, {expected:.4f} expected")
            self.assertLess(rel(without, expected * (1 - r) * (1 + r)), 0.03)
            self.assertGreater(value, expected)

    def test_depth_counts_every_event(self):
        self.assertEqual(float(self.irradiance(True, 0, 2, 16).radiance.max()), 0)
        self.assertGreater(float(mean(self.irradiance(True, 0, 3, 16))[0]), 0.4)


class Mirrors(unittest.TestCase):
    """A lamp at height 1.5 over a mirror of reflectance 0.8 lights a ceiling at height 2 as its image at -1.5 would."""
    CAMERA = (0, 1, 0, 0, 2, 0, 0, 0, -1, 53)

    def scene(self, half=.4):
        g = Gltf()
        g.place(*floor(half), g.material("mirror", (.8, .8, .8), metallic=1, roughness=0))
        g.place(*ceiling(1, 2), g.material("ceiling", (.5, .5, .5)))
        return g.save(daemon.folder, "mirror.gltf")

    def reflected(self, light, *arguments, camera=CAMERA, size=(16, 16), spp=1024):
        both, direct = (daemon.render(self.scene(), size=size, spp=spp, camera=camera, options={"pt.depth": depth},
                                      arguments=["--light", light, *arguments]) for depth in (2, 1))
        self.assertEqual(both.report["non_finite_samples"], 0)
        return both.radiance - direct.radiance

    def expected(self, half):
        x = (numpy.arange(100) + .5) / 50 * half - half
        r2 = (x * x)[:, None] + x * x + 3.5 ** 2
        return float((.5 * .8 * 3.5 / r2 ** 1.5).mean())

    def test_cameras_and_filters(self):
        half = math.tan(math.radians(26.5))
        point = f"point:at=0,1.5,0,intensity={math.pi}"
        for name, side, arguments in (("pinhole", half, []), ("gauss", half, ["--filter", "gauss"]), ("window", half, ["--filter", "bh"]),
                                      ("parallel", .5, ["--orthographic", "1"]), ("lens", half, ["--lens", ".1,.7"]),
                                      ("parallel lens", .5, ["--orthographic", "1", "--lens", ".1,.5"])):
            value = float(self.reflected(point, *arguments).mean(dtype=numpy.float64))
            print(f"{name}: {value:.5f}, {self.expected(side):.5f} expected")
            self.assertLess(rel(value, self.expected(side)), 0.02, name)

    def test_a_panorama(self):
        """Overhead: the top row, which sees a cap of 11.25 degrees."""
        value = self.reflected(f"spot:at=0,1.5,0,to=0,0,0,cone=30,60,intensity={math.pi}", "--panorama",
                               camera=(0, 1, 0, 0, 1, -1, 0, 1, 0, 20), size=(32, 16), spp=2048)
        self.assertLess(rel(float(value[0].mean(dtype=numpy.float64)), .5 * .8 / 3.5 ** 2), 0.05)
        self.assertEqual(float(value[8:].max()), 0)

    def test_what_they_light_lights_the_rest(self):
        """Parallel light by way of a mirror makes a bright square on a ceiling 2 above a floor, which nothing else lights."""
        g = Gltf()
        low = .3

        def at(x, corners):
            return transformed(corners[0], offset=(x, 0, 0)), corners[1]
        g.place(*at(-1, floor(low)), g.material("mirror", (.8, .8, .8), metallic=1, roughness=0))
        g.place(*at(1, ceiling(.5, 2)), g.material("ceiling", (.5, .5, .5)))
        g.place(*at(1, floor(1)), g.material("floor", (.5, .5, .5)))
        g.place(*at(-1.2, ceiling(1.2, 2.2)), g.material("shade", (0, 0, 0)))
        picture = daemon.render(g.save(daemon.folder, "bright.gltf"), size=(16, 16), spp=1536, camera=(1, 1, 0, 1, 0, 0, 0, 0, -1, 40),
                                options={"pt.depth": 3},
                                arguments=["--orthographic", "1.6", "--light", "directional:direction=1,-1,0,intensity=10"])
        exitance = .5 * .8 * 10 * math.sqrt(.5)
        x = (numpy.arange(40) + .5) / 40
        from_x, from_z, to_x, to_z = numpy.meshgrid(1.6 * x - .8, 1.6 * x - .8, 2 * low * x - low, 2 * low * x - low)
        r2 = (from_x - to_x) ** 2 + (from_z - to_z) ** 2 + 4
        expected = .5 * exitance / math.pi * (4 / math.pi / r2 ** 2).mean() * (2 * low) ** 2
        value = float(mean(picture)[0])
        print(f"twice spread: {value:.5f}, {expected:.5f} expected")
        self.assertLess(rel(value, expected), 0.03)


class Chance(unittest.TestCase):
    """The camera's paths alone, and both ways: the same picture, the one with less noise."""

    def both(self, scene, **more):
        off, on = (daemon.render(scene, arguments=["--effects", f"auto,{e}caustics"], **more) for e in "-+")
        self.assertNotIn("caustics", stages(off))
        self.assertIn("caustics", stages(on))
        return off, on

    def blocks(self, picture, side):
        h, w = picture.radiance.shape[:2]
        return picture.radiance.astype(numpy.float64).reshape(h // side, side, w // side, side, 3).mean(axis=(1, 3))

    def check(self, scene, side, error, **more):
        off, on = self.both(scene, **more)
        a, b = self.blocks(off, side), self.blocks(on, side)
        difference = float((numpy.abs(a - b) / numpy.maximum(b, 0.05 * b.mean())).mean())
        print(f"in the mean {mean(on) / mean(off)}, blocks differ by {difference:.4f}, relMSE {off.report['estimated_relmse']:.4f} "
              f"by chance, {on.report['estimated_relmse']:.4f}")
        self.assertLess(difference, error)
        self.assertLess(float(numpy.abs(mean(on) / mean(off) - 1).max()), error / 2)

    def test_a_room_with_a_ball_of_glass(self):
        g = Gltf()
        for part, colour, corners in make.CORNELL:
            g.place(*quad(*corners), g.material(part, colour))
        ball, triangles = icosphere(3, radius=.45)
        inside = {"thicknessFactor": 1, "attenuationDistance": .5, "attenuationColor": [.4, .9, .5]}
        g.node(mesh=g.mesh(transformed(ball, offset=(0, .6, 0)), triangles, g.material("ball", clear=1, roughness=0, ior=1.5, volume=inside),
                           normals=[[c / .45 for c in p] for p in ball]))
        g.place(*ceiling(.4, 1.98), g.material("lamp", (.78, .78, .78), (8, 8, 8)))
        g.camera((0, 1, 3.9), (0, 1, 0), 39)
        self.check(g.save(daemon.folder, "ball.gltf"), 8, 0.05, size=(32, 32), spp=512)

    def test_a_lamp_behind_a_pane(self):
        """Of either size against what the camera sees: the shares of both ways differ, their sum does not."""
        for half, sides in ((.1, 1), (1.0, 1), (.3, 2)):
            g = Gltf()
            g.place(*floor(1.5), g.material("floor", (.5, .5, .5)))
            g.place(*floor(1.5, .5), glass(g, solid=False))
            lamp = g.material("lamp", (0, 0, 0), (1 / half ** 2,) * 3, both_sides=sides == 2)
            g.place(*(ceiling if sides == 1 else floor)(half, 1), lamp)
            self.check(g.save(daemon.folder, "pane.gltf"), 8, 0.06 if half < 1 else 0.03, size=(16, 16), spp=1024,
                       camera=(0, .45, 0, 0, 0, 0, 0, 0, -1, 90), options={"pt.depth": 3})


class Shares(unittest.TestCase):
    """Each kind of lamp by way of a rough metal, rough glass and a coat: what the ways to its light take of it is all of it."""

    def scene(self, lamp=None, both=False):
        g = Gltf()
        white = g.material("white", (.6, .6, .6))
        g.place(*quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)), white)
        g.place(*quad((-1, -.01, 1), (1, -.01, 1), (1, -.01, -1), (-1, -.01, -1)), white)
        g.place(*quad((-.6, 0, 0), (.4, 0, 0), (.4, 0, -.8), (-.6, 0, -.8)), g.material("metal", (.9,) * 3, metallic=1, roughness=.35))
        g.place(*box((-.6, .1, .3), (-.4, 1, .9)), glass(g, roughness=.4))
        film = {"clearcoatFactor": 1, "clearcoatRoughnessFactor": .2}
        g.place(*box((.1, 0, .2), (.5, .2, .7)), g.material("coated", (.8, .2, .2), metallic=1, roughness=.3, coat=film))
        if lamp:
            g.place(*quad((.2, 1.7, -.2), (.6, 1.7, -.2), (.6, 1.7, .2), (.2, 1.7, .2)),
                    g.material("lamp", (0, 0, 0), (lamp,) * 3, both_sides=both))
        g.camera((1.8, 1, 0), (-1, .5, 0), 45)
        return g.save(daemon.folder, f"shares{lamp}{both}.gltf")

    def check(self, name, scene, *arguments, ways="mis", size=(24, 16), spp=192, depth=4, error=0.02):
        off, on = (daemon.render(scene, size=size, spp=spp, options={"pt.depth": depth, "pt.lights": ways},
                                 arguments=["--effects", f"auto,{e}caustics", *arguments]) for e in "-+")
        self.assertIn("caustics", stages(on))
        print(f"{name}: in the mean {mean(on)[0] / mean(off)[0]:.4f}, relMSE {off.report['estimated_relmse']:.5f} by chance, "
              f"{on.report['estimated_relmse']:.5f}")
        self.assertLess(float(rel(mean(on)[0], mean(off)[0])), error, name)

    def test_surfaces(self):
        self.check("one side", self.scene(20))
        self.check("both sides", self.scene(20, True))
        self.check("both sides, by points", self.scene(20, True), ways="nee")

    def test_lights(self):
        for name, light in (("point", "point:at=.4,1,0,intensity=1"), ("spot", "spot:at=.6,1,0,to=-.1,0,0,cone=20,50,intensity=2"),
                            ("directional", "directional:direction=-1,-1,0,intensity=2"),
                            ("sun", "directional:direction=-1,-1,0,intensity=2,angle=10")):
            self.check(name, self.scene(), "--light", light)

    def test_skies(self):
        """A bright patch in an even sky, alone and beside a lamp."""
        sky = skies.even(64, 32, .3)
        sky[9:12, 46:50] = 40
        images.write(os.path.join(daemon.folder, "patch.exr"), sky)
        for name, scene in (("sky", self.scene()), ("sky and lamp", self.scene(20))):
            self.check(name, scene, "--background", os.path.join(daemon.folder, "patch.exr"))

    def test_a_sky_without_light_paths(self):
        """A broad patch: even enough for chance, while a weak lamp has light paths. They leave the sky's light alone."""
        towards = numpy.array([.75, .66, 0]) / math.hypot(.75, .66)
        sky = skies.even(64, 32, 1e-3)
        sky[skies.directions(64, 32) @ towards > .86] = 10
        images.write(os.path.join(daemon.folder, "broad.exr"), sky)
        g = Gltf()
        g.place(*quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)), g.material("white", (.6, .6, .6)))
        g.place(*quad((-.6, 0, .4), (.4, 0, .4), (.4, 0, -.4), (-.6, 0, -.4)), g.material("metal", (.9,) * 3, metallic=1, roughness=.45))
        g.place(*quad((3, 1.7, -.2), (3.1, 1.7, -.2), (3.1, 1.7, .2), (3, 1.7, .2)), g.material("lamp", (0, 0, 0), (1e-3,) * 3))
        g.camera((1.8, 1, 0), (-1, .5, 0), 45)
        self.check("broad sky, weak lamp", g.save(daemon.folder, "broad.gltf"), "--background", os.path.join(daemon.folder, "broad.exr"),
                   error=0.006)

    def test_a_coat_whose_normal_is_not_the_surfaces(self):
        """The coat is bent by no normal map of what is below, and neither is what it throws on a wall."""
        values = []
        for tilt in (0, 25, -25):
            a = math.radians(tilt)
            g = Gltf()
            texture = g.image(png(1, 1, lambda x, y: tuple(round(127.5 + 127.5 * n) for n in (math.sin(a), 0, math.cos(a)))))
            below = g.material("coated", (0, 0, 0), coat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0})
            g.json["materials"][below]["normalTexture"] = {"index": texture}
            corners, triangles = quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))
            g.node(mesh=g.mesh(corners, triangles, below, uvs=[(0, 0), (1, 0), (1, 1), (0, 1)]))
            g.place(*quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1)), g.material("white", (.6, .6, .6)))
            g.place(*ceiling(.3, 1.5), g.material("lamp", (0, 0, 0), (10, 10, 10)))
            g.camera((1.8, 1, 0), (-1, .8, 0), 40)
            path = g.save(daemon.folder, f"bent{tilt}.gltf")
            values.append(float(mean(daemon.render(path, size=(16, 16), spp=512, options={"pt.depth": 2}))[0] -
                                mean(daemon.render(path, size=(16, 16), spp=512, options={"pt.depth": 1}))[0]))
        print(f"thrown by a coat over normals of 0, 25, -25 degrees: {values}")
        for value in values[1:]:
            self.assertLess(rel(value, values[0]), 0.03)

    def test_a_lamp_in_two_bodies(self):
        """In a block of glass in water. What is lit is on dry ground."""
        g = Gltf()
        g.place(*floor(3, -1.01), g.material("ground", (.6, .6, .6)))
        for half, ior in ((.9, 1.33), (.4, 1.5)):
            g.place(*box((-half,) * 3, (half,) * 3), glass(g, ior=ior))
        g.place(*ceiling(.1, 0), g.material("lamp", (0, 0, 0), (50, 50, 50)))
        g.camera((0, 3, .01), (0, -1, 0), 60)
        self.check("in two bodies", g.save(daemon.folder, "two.gltf"), size=(16, 16), spp=768, depth=3, error=0.04)


class Bits(unittest.TestCase):
    def test_same_bits_whatever_the_dispatches(self):
        scene = make.cornell_glass(daemon.folder)
        first = daemon.render(scene, size=(40, 24), spp=6).radiance
        for options in ({}, {"pt.batch": 1}, {"pt.segment": 2}, {"pt.traversal": "single"}):
            self.assertTrue(numpy.array_equal(daemon.render(scene, size=(40, 24), spp=6, options=options).radiance, first), options)

    def test_parts_of_a_picture_make_the_whole(self):
        scene = make.cornell_glass(daemon.folder)
        whole = daemon.render(scene, size=(24, 24), spp=8).radiance.astype(numpy.float64)
        parts = [daemon.render(scene, size=(24, 24), spp=4, arguments=["--first-sample", str(n)]).radiance for n in (0, 4)]
        self.assertTrue(numpy.allclose((parts[0].astype(numpy.float64) + parts[1]) / 2, whole, rtol=1e-5, atol=1e-7))

    def test_only_where_the_scene_calls_for_it(self):
        state = {e["name"]: e["state"] for e in daemon.render(make.cornell(daemon.folder), spp=1).report["effects"]}
        self.assertEqual(state["caustics"], "absent")
        dark = daemon.render(make.cornell_glass(daemon.folder), spp=1, arguments=["--effects", "-emitters", "--background", "1,1,1"])
        told = {e["name"]: e for e in dark.report["effects"]}["caustics"]
        self.assertEqual(told["state"], "absent")
        self.assertIn("evenly", told["why"])
        self.assertNotIn("caustics", stages(dark))


if __name__ == "__main__":
    unittest.main()
