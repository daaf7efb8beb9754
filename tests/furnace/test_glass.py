"""Glass against closed forms: Fresnel's equations, a white world that stays white, what an inside takes away."""
import math
import unittest

import numpy

import make
from render import Daemon
from table import HardCase
from writers import Gltf, box, icosphere, quad

daemon = Daemon()
WHITE = ["--background", "1,1,1"]


def setUpModule():
    unittest.enterModuleContext(daemon)


def glass(g, name="glass", ior=1.5, roughness=0.0, tint=(1, 1, 1), solid=True, inside=None, **more):
    """A material that lets all light through; `inside`: distance and colour of its attenuation."""
    volume = {"thicknessFactor": 1} if solid else None
    if inside:
        volume.update(attenuationDistance=inside[0], attenuationColor=list(inside[1]))
    return g.material(name, tint, roughness=roughness, ior=ior, clear=1, volume=volume, **more)


def fresnel(degrees, n):
    """The reflectance of unpolarised light that meets an index n times that of where it is."""
    i = math.radians(degrees)
    if math.sin(i) >= n:
        return 1.0
    t = math.asin(math.sin(i) / n)
    c, d = math.cos(i), math.cos(t)
    return (((c - n * d) / (c + n * d)) ** 2 + ((n * c - d) / (n * c + d)) ** 2) / 2


def mean(picture):
    return picture.radiance.reshape(-1, 3).mean(axis=0, dtype=numpy.float64)


def over_black(degrees, spp=256, **material):
    """A boundary seen at an angle, in a white world above it; below it is black and of its own index."""
    g = Gltf()
    g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), glass(g, **material))
    g.place(*quad((-50, -.01, 50), (50, -.01, 50), (50, -.01, -50), (-50, -.01, -50)), g.material("black", (0, 0, 0)))
    a = math.radians(degrees)
    camera = (0, 5 * math.cos(a), 5 * math.sin(a), 0, 0, 0, 0, 1, -.1, 0.002)
    return daemon.twice(g.save(daemon.folder, "over.gltf"), size=(8, 8), spp=spp, camera=camera, arguments=WHITE)


def inside(degrees, n, spp=256):
    """What a camera within a slab of index n sees of a white world above, looking up at an angle; below is black."""
    g = Gltf()
    g.place(*quad((-50, 0, 50), (50, 0, 50), (50, 0, -50), (-50, 0, -50)), glass(g, ior=n))
    g.place(*quad((-50, -1, 50), (50, -1, 50), (50, -1, -50), (-50, -1, -50)), g.material("black", (0, 0, 0)))
    a = math.radians(degrees)
    camera = (0, -.5 * math.cos(a), -.5 * math.sin(a), 0, 0, 0, 0, 1, .1, 0.002)
    return daemon.twice(g.save(daemon.folder, "inside.gltf"), size=(8, 8), spp=spp, camera=camera, arguments=WHITE)


class Fresnel(HardCase):
    def fresnel(self, case, picture, expected, tolerance, source="Fresnel's equations"):
        self.row("glass", case, picture, picture.mean(), expected, source, tolerance)

    def test_reflectance_at_an_index_of_one_and_a_half(self):
        for angle in (0, 30, 56.31, 75, 85, 89.9):
            self.fresnel(f"glass seen at {angle:g}°", over_black(angle), fresnel(angle, 1.5), 0.05 if angle < 60 else 0.02)

    def test_thin_walls_reflect_at_both_sides(self):
        for angle in (0, 60, 80):
            r = fresnel(angle, 1.5)
            self.fresnel(f"a thin pane at {angle}°", over_black(angle, solid=False), 2 * r / (1 + r), 0.05 if angle == 0 else 0.03, "2 R / (1 + R)")

    def test_total_reflection_from_within(self):
        """Up to 41.81 degrees light leaves, its radiance n² of what it was outside; from there on it stays."""
        for angle in (0, 30, 41.5, 41.8):
            self.fresnel(f"out of glass, at {angle:g}°", inside(angle, 1.5), (1 - fresnel(angle, 1 / 1.5)) * 1.5 ** 2, 0.02, "n² (1 − R)")
        for angle in (41.82, 60, 85):
            self.fresnel(f"out of glass, at {angle:g}°", inside(angle, 1.5), 0, 0, "total reflection")

    def test_an_index_next_to_one(self):
        self.fresnel("a boundary of index 1 at 89.9°", over_black(89.9, ior=1.0), 0, 0, "there is none")
        for ior, angle in ((1.0001, 89), (1.0001, 89.9), (1.01, 89)):
            self.fresnel(f"a boundary of index {ior:g} at {angle:g}°", over_black(angle, ior=ior), fresnel(angle, ior), 0.03)

    def test_an_index_below_one_reflects_from_without(self):
        angle = math.degrees(math.asin(0.75))
        self.fresnel("a bubble, index 0.75, seen at 20°", over_black(20, ior=0.75), fresnel(20, 0.75), 0.15)
        self.fresnel("a bubble, index 0.75, half a degree past total reflection", over_black(angle + 0.5, ior=0.75), 1, 1e-5, "total reflection")


def slab(g, material, top=0.0, thickness=0.5, side=50.0):
    positions, triangles = box((-side, top - thickness, -side), (side, top, side))
    g.place(positions, triangles, material)


def straight_down(g, spp=512, **more):
    camera = (0, 5, 0, 0, 0, 0, 0, 0, -1, 0.002)
    return daemon.twice(g.save(daemon.folder, "down.gltf"), size=(8, 8), spp=spp, camera=camera, arguments=WHITE, **more)


class Inside(HardCase):
    def test_a_slab_takes_away_what_its_length_says(self):
        """Straight through, with all that goes to and fro between its faces: the world is white on both sides."""
        colour = (0.5, 0.25, 0.9)
        for ior in (1.0, 1.5, 2.0):
            g = Gltf()
            slab(g, glass(g, ior=ior, inside=(0.5, colour)))
            picture = straight_down(g, options={"pt.depth": 32})
            r = fresnel(0, ior)
            for channel, got, t in zip(("red", "green", "blue"), mean(picture), colour):
                self.row("glass", f"through half a metre of glass of index {ior:g} that absorbs, {channel}", picture, got,
                         r + (1 - r) ** 2 * t * (1 + r * t) / (1 - (r * t) ** 2), "Lambert and Beer, and all that goes to and fro", 0.015)

    def test_the_tint_counts_at_each_face(self):
        g = Gltf()
        slab(g, glass(g, ior=1.0, tint=(0.5, 0.25, 1)))
        self.assertLess(float(numpy.abs(mean(straight_down(g, spp=4)) - numpy.array([0.25, 0.0625, 1])).max()), 1e-5)

    def test_an_index_of_one_is_invisible(self):
        def room(ball):
            g = Gltf()
            g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("floor", (0, 0, 0), (1, 2, 3)))
            g.place(*quad((-1, 0.1, 1), (1, 0.1, 1), (1, 0.1, -1), (-1, 0.1, -1)), g.material("mat", (0, 0, 0), (4, 0, 1)))
            if ball:
                positions, triangles = icosphere(2)
                g.place(positions, triangles, glass(g, ior=1.0, roughness=0.5), translation=[0, 1.5, 0])
            return daemon.render(g.save(daemon.folder, "room.gltf"), spp=1, camera=(0, 6, 6, 0, 1, 0, 0, 1, 0, 40)).radiance
        with_ball, without = room(True), room(False)
        # But for the edges of the mat, which a rounded direction may miss by a hair.
        self.assertLess(float((numpy.abs(with_ball - without).max(axis=2) > 1e-5).mean()), 0.002)

    def test_nested_bodies_of_one_index_are_one(self):
        """A ball inside of a slab of its own index leaves no trace: its boundary is that of two equal media. One of another
        index does."""
        def render(ior):
            g = Gltf()
            slab(g, glass(g, ior=1.5), thickness=3)
            g.place(*quad((-9, -3.5, 9), (9, -3.5, 9), (9, -3.5, -9), (-9, -3.5, -9)), g.material("red", (0, 0, 0), (1, 0, 0)))
            g.place(*quad((0, -3.4, 9), (9, -3.4, 9), (9, -3.4, -9), (0, -3.4, -9)), g.material("blue", (0, 0, 0), (0, 0, 1)))
            if ior:
                positions, triangles = icosphere(3)
                g.node(mesh=g.mesh(positions, triangles, glass(g, "ball", ior=ior), normals=positions), translation=[0, -1.5, 0])
            return daemon.render(g.save(daemon.folder, "nested.gltf"), spp=64, options={"pt.depth": 12},
                                 camera=(0, 6, 1, 0, -1.5, 0, 0, 1, 0, 30)).radiance
        without, same, air = render(0), render(1.5), render(1.0)
        self.assertLess(float(numpy.abs(same - without).mean()), 0.01)
        self.assertGreater(float(numpy.abs(air - without).mean()), 0.03)

    def test_scales_give_the_same_picture(self):
        pictures = [daemon.render(make.cornell_glass(daemon.folder, scale), spp=8).radiance for scale in (1, 1e-3, 1e3)]
        for picture in pictures[1:]:
            changed = numpy.abs(picture - pictures[0]).max(axis=2) > 1e-3 * (0.01 + pictures[0].max(axis=2))
            self.assertLess(float(changed.mean()), 0.06)
            self.assertLess(abs(float(picture.mean() / pictures[0].mean()) - 1), 0.01)

    def test_paths_go_on_in_the_next_dispatch(self):
        scene = make.cornell_glass(daemon.folder)
        whole, cut = (daemon.render(scene, spp=4, options={"pt.segment": n}).radiance for n in (9, 2))
        self.assertTrue(numpy.array_equal(whole, cut))

    def test_both_walks_see_the_same(self):
        scene = make.cornell_glass(daemon.folder)
        single, packet = (daemon.render(scene, spp=4, options={"pt.traversal": t}).radiance for t in ("single", "packet"))
        self.assertTrue(numpy.array_equal(single, packet))


class LampBehindGlass(unittest.TestCase):
    def test_both_ways_of_sampling_agree(self):
        """A closed lamp of radiance 1 around a rough boundary, found by lobe and by next-event estimation, is the white world,
        found by the lobe alone: above it what is reflected, below what comes through, 1/n² of it."""
        for solid, roughness, ior in ((False, 0.4, 1.5), (True, 0.5, 1.5), (True, 0.8, 0.7)):
            values = []
            for lamp in (False, True):
                g = Gltf()
                g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), glass(g, solid=solid, roughness=roughness, ior=ior))
                positions, triangles = icosphere(2, radius=8, inward=True)
                if lamp:
                    g.place(positions, triangles, g.material("sky", (0, 0, 0), (1, 1, 1)))
                picture = daemon.render(g.save(daemon.folder, "sky.gltf"), size=(8, 8), spp=1024, arguments=WHITE,
                                        camera=(0, 2, 3, 0, 0, 0, 0, 1, 0, 0.5), options={"pt.depth": 1})
                values.append(float(mean(picture)[0]))
            print(f"solid {solid}, roughness {roughness}, index {ior}: {values[0]:.4f} without, {values[1]:.4f} with a lamp")
            self.assertLess(abs(values[1] / values[0] - 1), 0.01)


class WhiteFurnace(unittest.TestCase):
    def ball(self, spp=256, camera=(0, 0, 4, 0, 0, 0, 0, 1, 0, 20), depth=64, normals=True, **material):
        g = Gltf()
        positions, triangles = icosphere(4)
        g.node(mesh=g.mesh(positions, triangles, glass(g, **material), normals=positions if normals else None))
        return mean(daemon.render(g.save(daemon.folder, "ball.gltf"), size=(16, 16), spp=spp, camera=camera,
                                  options={"pt.depth": depth}, arguments=WHITE))

    def test_smooth_balls(self):
        for ior in (1.5, 1.0, 0.75, 2.4):
            value = self.ball(ior=ior, spp=64)
            self.assertLess(float(numpy.abs(value - 1).max()), 0.005, f"index {ior}: {value}")

    def test_rough_balls(self):
        """In one picture, for what they send each other is white too. In a dense one light meets the boundary a dozen times."""
        indices, roughnesses, side = (0.7, 1.1, 1.5, 2.4), (0.2, 0.4, 0.6, 0.8, 1.0), 16
        g = Gltf()
        positions, triangles = icosphere(3)
        number = g.mesh(positions, triangles, normals=positions)
        shape = g.json["meshes"][number]["primitives"][0]
        for row, ior in enumerate(indices):
            for column, roughness in enumerate(roughnesses):
                material = glass(g, ior=ior, roughness=roughness)
                g.node(mesh=g.add("meshes", {"primitives": [dict(shape, material=material)]}), translation=[2.2 * column - 4.4, 3.3 - 2.2 * row, 0])
        camera = (0, 0, 200, 0, 0, 0, 0, 1, 0, math.degrees(2 * math.atan(4.4 / 200)))
        picture = daemon.render(g.save(daemon.folder, "balls.gltf"), size=(5 * side, 4 * side), spp=128, camera=camera,
                                options={"pt.depth": 256}, arguments=WHITE).radiance[:, :, 0].astype(numpy.float64)
        for row, ior in enumerate(indices):
            for column, roughness in enumerate(roughnesses):
                pixels = picture[side * row:side * (row + 1), side * column:side * (column + 1)].ravel()
                ball = math.pi / 4 / 1.1 ** 2    # of its square
                value, noise = 1 + (pixels.mean() - 1) / ball, pixels.std() / ball / side
                print(f"ball of index {ior}, roughness {roughness}: {value:.4f} +- {noise:.4f}")
                self.assertLess(noise, 0.015)
                self.assertLess(abs(value - 1), 0.01 + 2 * noise, f"index {ior}, roughness {roughness}")

    def test_thin_plates(self):
        for roughness in (0.0, 0.3, 1.0):
            for angle in (0, 60, 85):
                g = Gltf()
                g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), glass(g, roughness=roughness, solid=False))
                a = math.radians(angle)
                camera = (0, 5 * math.cos(a), 5 * math.sin(a), 0, 0, 0, 0, 1, -.1, 0.002)
                value = mean(daemon.render(g.save(daemon.folder, "thin.gltf"), size=(8, 8), spp=256, camera=camera, arguments=WHITE))
                self.assertLess(float(numpy.abs(value - 1).max()), 0.01, f"roughness {roughness}, {angle} degrees: {value}")

    def test_a_camera_inside_sees_more(self):
        """Radiance within is n² of that without, in every direction."""
        value = self.ball(camera=(0.3, 0, 0.2, 0, 0.5, -1, 0, 1, 0, 60))
        self.assertLess(float(numpy.abs(value / 1.5 ** 2 - 1).max()), 0.02, value)


if __name__ == "__main__":
    unittest.main()
