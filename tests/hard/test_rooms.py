"""Light that bounces where that is hard: white, grey and black rooms after one event and after many, worlds in which nothing may show, rooms
decades apart in brightness, walls that let nothing in, thousands of layers, skies of one texel, suns of every width, metals of every
roughness. `direct` takes part where one event is all there is."""
import math
import os
import unittest

import numpy

import images
import make
import rooms
from render import Daemon
from table import TECHNIQUES, HardCase
from writers import Gltf, box, quad

daemon = Daemon()
WHITE = ("--background", "1,1,1")


def setUpModule():
    unittest.enterModuleContext(daemon)


class Rooms(HardCase):
    def check(self, kind, case, scene, expected, source, tolerances, options, size=(8, 8), spp=(64, 1, 1), camera=None, arguments=(),
              measure=lambda picture: picture.mean()):
        """By the techniques that have a tolerance."""
        daemon.candil("load", scene, "--name", "room")
        for technique, samples in zip(TECHNIQUES, spp):
            if technique in tolerances:
                picture = daemon.twice("room", size, samples, camera, options=options.get(technique, {}), arguments=["--technique", technique, *arguments])
                self.row(kind, case, picture, measure(picture), expected, source, tolerances[technique])
        daemon.candil("unload", "room")


SERIES = "1 − ρ^(events + 1)"


class Closed(Rooms):
    def test_uniform_rooms(self):
        """Walls of albedo ρ that emit 1 − ρ."""
        for rho in (.01, .5, .9, .99):
            scene = rooms.uniform_room(daemon.folder, rho)
            for events in (1, 3, 9):
                tolerances = {"pt": .02, "vct": .03 if rho < .9 else .06}
                if events == 1:
                    tolerances["direct"] = 1e-3
                self.check("closed", f"a room of albedo {rho:g}, {events} event{'s' if events > 1 else ''}", scene, 1 - rho ** (events + 1),
                           SERIES + ("; a voxel's error comes back with each bounce" if events > 1 else ""), tolerances,
                           {"pt": {"pt.depth": events}, "vct": {"vct.bounces": events - 1, "vct.resolution": 32}}, spp=(256, 1, 1), size=(16, 16))

    def test_a_white_body_in_a_white_world(self):
        for albedo in (1.0, .5, 0.0):
            scene = rooms.plane(daemon.folder, albedo)
            self.check("closed", f"a plane of albedo {albedo:g} in a white world", scene, albedo, "albedo", {"pt": 1e-5, "vct": 1e-3},
                       {"vct": {"vct.resolution": 32}}, arguments=WHITE, camera=(0, 2, 0, 0, 0, 0, 0, 0, -1, 10))
        self.check("closed", "an icosphere of albedo 1 in a white world", make.furnace(daemon.folder), 1,
                   "conservation; in voxels a facet hides some of the sky from the next", {"pt": 1e-3, "vct": .05},
                   {"vct": {"vct.resolution": 32}}, arguments=WHITE, camera=(0, 0, 4, 0, 0, 0, 0, 1, 0, 10), size=(16, 16))

    def test_long_paths(self):
        for depth in (64, 256):
            rho = 1 - 1 / depth
            self.check("closed", f"a sphere of albedo 1 − 1/{depth}, {depth} events", make.closed_sphere(daemon.folder, rho=rho), 1 - rho ** (depth + 1), SERIES,
                       {"pt": .03}, {"pt": {"pt.depth": depth}}, spp=(16, 1, 1))


class Range(Rooms):
    def test_a_dim_room_beside_a_glaring_one(self):
        for eye, emission in ((-3, 1e-6), (3, 1e8)):
            g = Gltf()
            for x, e in ((-3, 1e-6), (3, 1e8)):
                g.place(*box((x - 1, -1, -1), (x + 1, 1, 1), inward=True), g.material("walls", (.5,) * 3, (e,) * 3))
            self.check("range", f"in a room of {emission:g}, the next is {1e-6 * 1e8 / emission:g}", g.save(daemon.folder, "range.gltf"), emission * (1 - .5 ** 5) / .5,
                       "(1 − ρ⁵) / (1 − ρ), four events", {"pt": .01}, {"pt": {"pt.depth": 4}}, camera=(eye, 0, .5, eye, 0, -1, 0, 1, 0, 60), size=(16, 16))

    def test_sealed_rooms(self):
        for scale in (1e-3, 1.0, 1e3):
            for turned in (0.0, 30.0):
                self.check("away", f"in a dark room of {2 * scale:g} m{', turned' if turned else ''}, a lamp of 1e+06 outside",
                           make.sealed_room(daemon.folder, scale, turned), 0, "nothing", {"pt": 0, "direct": 0}, {}, spp=(64, 4, 1), size=(48, 48))


class Many(Rooms):
    def test_sheets(self):
        for alpha, sheets in ((1e-3, 1000), (.25, 4)):
            g = Gltf()
            sheet = g.material("sheet", (0, 0, 0), alpha=alpha, blend=True)
            positions, triangles = [], []
            for i in range(sheets):
                p, t = quad((-1, -1, -i * 1e-3), (1, -1, -i * 1e-3), (1, 1, -i * 1e-3), (-1, 1, -i * 1e-3))
                triangles += [[c + len(positions) for c in corner] for corner in t]
                positions += p
            g.place(positions, triangles, sheet)
            expected = (1 - alpha) ** sheets
            self.check("many", f"{sheets} sheets of alpha {alpha:g}", g.save(daemon.folder, "sheets.glb"), expected, "(1 − α)^n; rays are drawn by chance",
                       {"pt": 5 * math.sqrt((1 - expected) / expected / 65536)}, {}, camera=(0, 0, 3, 0, 0, 0, 0, 1, 0, 10),
                       arguments=WHITE, size=(16, 16), spp=(256, 1, 1))


    def test_mirrors(self):
        """Two metals of 0.9 face each other; a ray goes to and fro between them at 45 degrees until it meets the lamp at their end."""
        for turns in (1, 10, 60):
            end = .2 * turns
            g = Gltf()
            mirror = g.material("mirror", (.9,) * 3, metallic=1, roughness=0, specular=1)
            g.place(*quad((-.5, 0, .5), (end, 0, .5), (end, 0, -.5), (-.5, 0, -.5)), mirror)
            g.place(*quad((-.5, .1, -.5), (end, .1, -.5), (end, .1, .5), (-.5, .1, .5)), mirror)
            at = end - .05
            g.place(*quad((at, -1, .6), (at, -1, -.6), (at, 2, -.6), (at, 2, .6)), g.material("lamp", (0, 0, 0), (1,) * 3, both_sides=True))
            reflectance = .9 + .1 * (1 - math.cos(math.radians(45))) ** 5
            self.check("many", f"a lamp seen by {2 * turns} reflections of two mirrors", g.save(daemon.folder, "mirrors.gltf"), reflectance ** (2 * turns),
                       "Schlick's reflectance, to that power", {"pt": 1e-4}, {"pt": {"pt.depth": 256, "pt.roulette": "off"}}, spp=(4, 1, 1),
                       camera=(-.05, .05, 0, 0, 0, 0, 0, 1, 0, .01))


class Small(Rooms):
    def test_a_narrow_spot_off_a_mirror(self):
        """Brought by paths from the light: the camera's never find it. The view is within the beam, 3 m from the spot."""
        for degrees in (.1, .02):
            wide = math.radians(degrees)
            g = Gltf()
            half = 4 * wide
            g.place(*quad((2 - half, 0, half), (2 + half, 0, half), (2 + half, 0, -half), (2 - half, 0, -half)), g.material("floor", (.5,) * 3))
            g.place(*quad((1.5, 1.5, -.5), (1.5, 1.5, .5), (2.5, .5, .5), (2.5, .5, -.5)), g.material("mirror", metallic=1, roughness=0, specular=1, both_sides=True))
            g.light("spot", 9.0, (0, 1, 0), (2, 1, 0), cone=(.45 * wide, .5 * wide), up=(0, 1, 0))
            camera = (2, .3, .2, 2, 0, 0, 0, 1, 0, math.degrees(2 * math.atan(.75 * wide / math.hypot(.3, .2))))
            self.check("small", f"in the beam of a spot of {degrees:g}°, off a mirror", g.save(daemon.folder, "beam.gltf"), .5 / math.pi, "I cos θ / d²; by paths of light",
                       {"pt": .03}, {"pt": {"pt.depth": 4}}, camera=camera, spp=(1024, 1, 1))


class Rough(Rooms):
    SPECULAR = dict(metallic=1, specular=1)

    def plate(self, name, roughness, light=None, **material):
        g = Gltf()
        g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("plate", roughness=roughness, **material))
        if light:
            g.light("point", 1.0, light)
        return g.save(daemon.folder, name)

    def test_a_white_metal_in_a_white_world(self):
        for roughness in (0, 1e-3, .02, .1, .3, .6, 1):
            for degrees in (0, 60, 89.9):
                a = math.radians(degrees)
                camera = (0, 5 * math.cos(a), 5 * math.sin(a), 0, 0, 0, 0, 1, -.1, .002)
                self.check("rough", f"white metal of roughness {roughness:g} at {degrees:g}°", self.plate("metal.gltf", roughness, **self.SPECULAR), 1, "conservation",
                           {"pt": .01}, {}, camera=camera, spp=(256, 1, 1), arguments=WHITE)

    def test_a_point_light_on_a_metal(self):
        """The light behind the camera: the lobe's peak."""
        for roughness in (.02, .1, .3, 1):
            scene = self.plate("lit.gltf", roughness, (0, 2, 0), albedo=(.9,) * 3, **self.SPECULAR)
            camera = (0, 1, 0, 0, 0, 0, 0, 0, -1, .001)
            self.check("rough", f"a light straight above a metal of roughness {roughness:g}", scene, self.peak(roughness, .9) / 4, "GGX by quadrature",
                       dict.fromkeys(TECHNIQUES, 2e-3), {"pt": {"pt.depth": 1}, "vct": {"vct.bounces": 0, "vct.resolution": 16}}, camera=camera)

    @staticmethod
    def peak(roughness, f0, steps=100000):
        """The BRDF at normal view and light: D F / 4 of Trowbridge and Reitz, plus what single scattering loses of it, given back by the
        viewer's angle. What single scattering keeps is the mean of Smith's height-correlated G2 over half vectors by their density D cos."""
        a2 = roughness ** 4
        u = (numpy.arange(steps) + .5) / steps
        light = numpy.cos(2 * numpy.arctan(numpy.sqrt(a2 * u / (1 - u))))
        light = light[light > 0]
        kept = (2 * light / (light + numpy.sqrt(a2 + (1 - a2) * light ** 2))).sum() / steps
        return f0 / (4 * math.pi * a2) * (1 + f0 * (1 / kept - 1))


class Glass(Rooms):
    """Where all ways of light come to the same, so that `vct`, which follows one, is held to it as well."""
    DOWN = (0, 5, 0, 0, 0, 0, 0, 0, -1, .002)

    def test_a_slab_that_bends_nothing(self):
        g = Gltf()
        inside = {"thicknessFactor": 1, "attenuationDistance": .5, "attenuationColor": [.5, .25, .9]}
        g.place(*box((-5, -.5, -5), (5, 0, 5)), g.material("glass", (1, 1, 1), roughness=0, ior=1.0, clear=1, volume=inside))
        self.check("glass", "half a metre of glass of index 1 that absorbs", g.save(daemon.folder, "slab.gltf"), (.5 + .25 + .9) / 3, "Lambert and Beer",
                   {"pt": 1e-3, "vct": 1e-3}, {"vct": {"vct.resolution": 32}}, camera=self.DOWN, arguments=WHITE)

    def test_panes_in_a_white_world(self):
        for count in (1, 4):
            g = Gltf()
            pane = g.material("pane", (1, 1, 1), roughness=0, clear=1)
            for i in range(count):
                g.place(*quad((-5, -i, 5), (5, -i, 5), (5, -i, -5), (-5, -i, -5)), pane)
            self.check("glass", f"{count} clear pane{'s' if count > 1 else ''} in a white world", g.save(daemon.folder, "panes.gltf"), 1,
                       "conservation" + ("; `vct` leaves out what panes behind the first reflect" if count > 1 else ""), {"pt": 5e-3, "vct": 5e-3 if count == 1 else .2},
                       {"pt": {"pt.depth": 64}, "vct": {"vct.resolution": 32}}, camera=self.DOWN, arguments=WHITE)


class Sky(Rooms):
    def scene(self):
        g = Gltf()
        g.place(*quad((-10, 0, 10), (10, 0, 10), (10, 0, -10), (-10, 0, -10)), g.material("floor", (.5,) * 3))
        return g.save(daemon.folder, "floor.gltf")

    CAMERA = (0, 3, 0, 0, 0, 0, 0, 0, -1, 10)

    def test_suns(self):
        for degrees in (1e-3, .53, 30, 120, 179):
            self.check("sky", f"a sun {degrees:g}° wide", self.scene(), .5 / math.pi * 2, "E, whatever its width", {"pt": 3e-3},
                       {"pt": {"pt.depth": 1}}, camera=self.CAMERA, arguments=("--light", f"directional:direction=0,-1,0,intensity=2,angle={degrees}"))
        self.check("sky", "a sun without a width", self.scene(), .5 / math.pi * 2, "E", {"pt": 1e-5, "direct": 1e-5, "vct": 1e-5},
                   {"pt": {"pt.depth": 1}, "vct": {"vct.bounces": 0}}, camera=self.CAMERA, arguments=("--light", "directional:direction=0,-1,0,intensity=2"))

    def test_pictures(self):
        for name, sky, expected in (("of one texel", numpy.ones((1, 1, 3)), .5), ("of 2 x 1 texels of 1e-9", numpy.full((1, 2, 3), 1e-9), .5e-9),
                                    ("of 1e+09", numpy.full((16, 32, 3), 1e9), .5e9)):
            path = os.path.join(daemon.folder, "sky.exr")
            images.write(path, sky)
            self.check("sky", f"a sky {name}", self.scene(), expected, "albedo", {"pt": 5e-3, "vct": .03}, {"vct": {"vct.resolution": 32}},
                       camera=self.CAMERA, arguments=("--background", path))


if __name__ == "__main__":
    unittest.main()
