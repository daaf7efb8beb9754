"""Pictures of the surroundings as what is seen and as a light: against closed forms and fine quadrature, by each way of
sampling."""
import math
import os
import unittest

import numpy

import images
import make
import skies
from render import Daemon
from writers import Gltf, box, quad

daemon = Daemon()
WAYS = ("mis", "nee", "none")
ALBEDO = 0.5
FLOOR = (0, 3, 0, 0, 0, 0, 0, 0, -1, 10)


def setUpModule():
    unittest.enterModuleContext(daemon)


def written(name, sky):
    path = os.path.join(daemon.folder, name + ".exr")
    images.write(path, sky)
    return path


def floor():
    """A plane that sees nothing but the upper half of the sky."""
    g = Gltf()
    g.place(*quad((-10, 0, 10), (10, 0, 10), (10, 0, -10), (-10, 0, -10)), g.material("floor", (ALBEDO,) * 3))
    g.camera(FLOOR[:3], FLOOR[3:6], FLOOR[9], up=(0, 0, -1))
    return g.save(daemon.folder, "floor.gltf")


def room():
    """A box with a hole above and a lamp, and a point light in it."""
    g = Gltf()
    white = g.material("white", (0.7,) * 3)
    g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), white)
    g.place(*quad((-2, 0, -2), (2, 0, -2), (2, 3, -2), (-2, 3, -2)), white)
    g.place(*box((-0.5, 0, -0.5), (0.5, 1, 0.5)), white)
    g.place(*quad((-2, 2, -1), (-2, 1, -1), (-2, 1, 1), (-2, 2, 1)), g.material("lamp", (0,) * 3, (3,) * 3, both_sides=True))
    g.light("point", 4, (1.5, 2, 1))
    g.camera((0, 2, 6), (0, 0.8, 0), 40)
    return g.save(daemon.folder, "room.gltf")


def under(sky, *more):
    return ["--background", sky, *more]


def irradiance(picture):
    """W/m2 on the diffuse plane that fills the picture, its mean and the mean's standard error."""
    values = picture.radiance.astype(numpy.float64).mean(axis=2) * math.pi / ALBEDO
    return values.mean(), values.std() / math.sqrt(values.size)


class Furnace(unittest.TestCase):
    def test_an_even_sky_is_an_even_background(self):
        sky = written("even", skies.even(64, 32))
        path = make.furnace(daemon.folder)
        by_chance = daemon.render(path, (16, 16), 4, options={"pt.lights": "none"}, arguments=under(sky)).radiance
        numpy.testing.assert_allclose(by_chance, 1, rtol=2e-6)
        for way in ("mis", "nee"):
            picture = daemon.render(path, (24, 24), 64, options={"pt.lights": way}, arguments=under(sky)).radiance
            print(f"furnace, {way}: {picture.mean():.5f} +- {picture.std():.4f}")
            self.assertLess(abs(picture.mean() - 1), 0.015)
            self.assertLess(picture.std(), 0.2)

    def test_one_texel_is_a_sky_too(self):
        picture = daemon.render(make.furnace(daemon.folder), (16, 16), 16, arguments=under(written("one", skies.even(1, 1))))
        self.assertLess(abs(picture.radiance.mean() - 1), 0.01)


class Planes(unittest.TestCase):
    def test_half_of_the_sky(self):
        # Bright on the side of +X: half of the floor's pi. Bright above: all of it.
        side, above = numpy.zeros((32, 64, 3)), numpy.zeros((32, 64, 3))
        side[:, 32:] = 1
        above[:17] = 1  # the row below the horizon too, so that what is bilinear fades beneath it
        for name, sky, expected in (("side", side, math.pi / 2), ("above", above, math.pi)):
            for way in WAYS:
                picture = daemon.render(floor(), (16, 16), 64, options={"pt.lights": way},
                                        arguments=under(written(name, sky)))
                mean, error = irradiance(picture)
                print(f"{name}, {way}: {mean / expected:.5f} of {expected:.4f}, +- {error / expected:.5f}")
                self.assertLess(abs(mean / expected - 1), max(0.005, 4 * error / expected))

    def test_a_single_bright_texel(self):
        sky = skies.spot(64, 32, 40, 8, 1e6)
        expected = skies.irradiance(sky, (0, 1, 0), 16)[0]
        errors = {}
        for way in WAYS:
            picture = daemon.render(floor(), (24, 24), 128, options={"pt.lights": way}, arguments=under(written("spot", sky)))
            mean, errors[way] = irradiance(picture)
            print(f"a texel of 1e6, {way}: {mean / expected:.5f} of {expected:.2f}, +- {errors[way] / expected:.5f}")
            self.assertLess(abs(mean / expected - 1), 0.01 if way != "none" else 4 * errors[way] / expected)
        self.assertGreater(errors["none"], 5 * errors["mis"])

    def test_turned_and_scaled(self):
        # The brightest texel of a smooth sky goes round with it; the plane leans, so that it matters where the sky is.
        g = Gltf()
        g.place(*quad((-5, -5, 0), (5, -5, 0), (5, 5, 0), (-5, 5, 0)), g.material("wall", (ALBEDO,) * 3))
        g.camera((0, 0, 3), (0, 0, 0), 10)
        wall = g.save(daemon.folder, "wall.gltf")
        w = skies.directions(64, 32)
        sky = (1 + w @ numpy.array([0.6, 0.3, 0.7]))[:, :, None] ** 4 * numpy.array([1, 0.5, 0.25])
        for turn in (0, 90, -135):
            rolled = numpy.roll(sky, -turn * 64 // 360, axis=1)
            expected = skies.irradiance(rolled, (0, 0, 1))
            turned = daemon.render(wall, (16, 16), 64, arguments=under(written("smooth", sky), "--background-turn", str(turn)))
            mean = turned.radiance.astype(numpy.float64).mean(axis=(0, 1)) * math.pi / ALBEDO
            print(f"turned by {turn}: {mean / expected}")
            self.assertLess(numpy.abs(mean / expected - 1).max(), 0.01)
        once = daemon.render(wall, (16, 16), 4, arguments=under(written("smooth", sky)))
        again = daemon.render(wall, (16, 16), 4, arguments=under(written("smooth", sky)))
        twice = daemon.render(wall, (16, 16), 4, arguments=under(written("smooth", sky), "--background-scale", "2"))
        self.assertEqual(once.radiance.tobytes(), again.radiance.tobytes())
        self.assertEqual((2 * once.radiance).tobytes(), twice.radiance.tobytes())


    def test_densities_are_those_of_the_directions(self):
        # A sky of three decades, by next-event estimation alone: no weight makes up for a density that is wrong.
        random = numpy.random.default_rng(9)
        sky = 10 ** (3 * random.random((8, 16, 1))) * numpy.ones(3)
        expected = skies.irradiance(sky, (0, 1, 0), 16)[0]
        picture = daemon.render(floor(), (24, 24), 128, options={"pt.lights": "nee"}, arguments=under(written("decades", sky)))
        mean, error = irradiance(picture)
        print(f"three decades: {mean / expected:.5f}, +- {error / expected:.5f}")
        self.assertLess(abs(mean / expected - 1), 0.01)


class Seen(unittest.TestCase):
    def test_a_panorama_gives_the_sky_back(self):
        # A pixel of the panorama is a texel: the mean over it of what is bilinear.
        random = numpy.random.default_rng(5)
        sky = random.random((16, 32, 3))
        expected = images.box_down(skies.finer(sky, 8), 8)
        away = (0, 0, 50, 0, 0, 0, 0, 1, 0, 40)  # of the furnace's sphere, which hides little
        for turn, roll in ((0, 0), (45, -4)):
            picture = daemon.render(make.furnace(daemon.folder), (32, 16), 64, away,
                                    arguments=under(written("random", sky), "--panorama", "--background-turn", str(turn)))
            error = numpy.abs(picture.radiance - numpy.roll(expected, roll, axis=1))
            error[7:9, 15:17] = 0  # the sphere
            print(f"panorama turned by {turn}: at most {error.max():.4f} off")
            self.assertLess(error.max(), 0.02)

    def test_a_mirror_shows_it(self):
        g = Gltf()
        g.place(*quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), g.material("mirror", metallic=1, roughness=0))
        mirror = g.save(daemon.folder, "mirror.gltf")
        w = skies.directions(64, 32)
        sky = (1.2 + w @ numpy.array([0.5, 0.5, -0.7]))[:, :, None] ** 6 * numpy.array([1, 0.5, 0.25])
        down, up = ((0, 1, 0.5, 0, 0, 0, 0, 1, 0, 60), (0, 1, 0.5, 0, 2, 0, 0, 1, 0, 60))
        below, above = (daemon.render(mirror, (16, 16), 16, camera, arguments=under(written("clear", sky))).radiance
                        for camera in (down, up))
        numpy.testing.assert_allclose(below, above[::-1], rtol=0.03)


class OtherTechniques(unittest.TestCase):
    def test_a_plane_by_cones(self):
        w = skies.directions(64, 32)
        smooth = (1 + w @ numpy.array([0.6, 0.3, 0.7]))[:, :, None] ** 4 * numpy.array([1, 0.5, 0.25])
        for name, sky, turn in (("even", skies.even(64, 32), 0), ("smooth", smooth, 0), ("coarse", skies.even(2, 1), 0)):
            expected = skies.irradiance(sky, (0, 1, 0)) * ALBEDO / math.pi
            pictures = [daemon.render(floor(), (16, 16), 1, arguments=under(written(name, sky), "--technique", "vct",
                                                                          "--background-scale", scale))
                        for scale in ("1", "1", "0.5")]
            ratio = pictures[0].radiance.mean(axis=(0, 1)) / expected
            print(f"vct, {name}: {ratio}")
            self.assertLess(numpy.abs(ratio - 1).max(), 0.03)
            self.assertEqual(pictures[0].radiance.tobytes(), pictures[1].radiance.tobytes())
            self.assertLess(numpy.abs(pictures[2].radiance.mean(axis=(0, 1)) / expected - ratio / 2).max(), 0.01)

    def test_what_is_seen_is_the_same(self):
        w = skies.directions(64, 32)
        sky = written("smooth", (1 + w @ numpy.array([0.6, 0.3, 0.7]))[:, :, None] ** 4 * numpy.array([1, 0.5, 0.25]))
        pictures = [daemon.render(room(), (32, 24), 4, arguments=under(sky, "--technique", technique, "--background-turn", "70",
                                                                      "--aov", "depth")) for technique in ("pt", "direct", "vct")]
        beyond = numpy.logical_and.reduce([numpy.isinf(p.channels["Z"]) for p in pictures])
        beyond[1:-1] &= beyond[2:] & beyond[:-2]
        beyond[:, 1:-1] &= beyond[:, 2:] & beyond[:, :-2]
        self.assertGreater(beyond.sum(), 100)
        for picture in pictures[1:]:
            numpy.testing.assert_allclose(picture.radiance[beyond], pictures[0].radiance[beyond], rtol=0.03)
        whole, direct, cones = (p.radiance.mean() for p in pictures)
        print(f"a room under a sky: {cones / whole:.3f} of pt's light by cones, {direct / whole:.3f} with none of the sky's")
        self.assertLess(abs(cones / whole - 1), 0.05)
        why = {e["name"]: e["why"] for e in pictures[1].report["effects"]}["environment"]
        self.assertIn("it is seen, and lights nothing", why)


class NoScene(unittest.TestCase):
    def test_a_picture_is_not_rendered_as_a_scene(self):
        sky = written("alone", numpy.ones((4, 8, 3), numpy.float32))
        for command in (["render", sky, "-o", daemon.folder + "/alone.exr"], ["inspect", sky, "-o", daemon.folder + "/alone"]):
            status, _, text = daemon.candil(*command, "--size", "8x8", check=False)
            self.assertEqual(status, 2, text)
            self.assertIn("background", text)


class Together(unittest.TestCase):
    def test_lights_add_up(self):
        sky = written("sunset", skies.sunset(128, 500))
        scene, size = room(), (32, 24)
        whole = daemon.render(scene, size, 64, arguments=under(sky)).radiance.astype(float)
        parts = [daemon.render(scene, size, 64, arguments=under(sky, "--effects", effects)).radiance.astype(float)
                 for effects in ("auto,-emitters,-lights", "auto,-environment,-lights", "auto,-environment,-emitters")]
        ratio = whole.mean() / sum(parts).mean()
        print(f"sky, lamp and light: {ratio:.4f} of the sum of {[round(p.mean(), 4) for p in parts]}")
        self.assertLess(abs(ratio - 1), 0.01)
        blocks = [a.reshape(3, 8, 4, 8, 3).mean(axis=(1, 3, 4)) for a in (whole, sum(parts))]
        self.assertLess(numpy.abs(blocks[0] / blocks[1] - 1).max(), 0.08)

    def test_forced_and_left_out(self):
        sky = written("sunset", skies.sunset(128, 500))
        scene = room()
        usual = daemon.render(scene, (24, 18), 4, arguments=under(sky))
        forced = daemon.render(scene, (24, 18), 4, arguments=under(sky, "--effects", "all"))
        numpy.testing.assert_allclose(forced.radiance, usual.radiance, rtol=1e-5, atol=1e-6)
        states = {e["name"]: e["state"] for e in usual.report["effects"]}
        self.assertEqual(states["environment"], "simulated")
        without = daemon.render(scene, (24, 18), 4)
        off = daemon.render(scene, (24, 18), 4, arguments=under(sky, "--effects", "auto,-environment"))
        self.assertEqual(without.radiance.tobytes(), off.radiance.tobytes())
        black = daemon.render(scene, (24, 18), 4, arguments=under(written("black", skies.even(8, 4, 0))))
        self.assertEqual(without.radiance.tobytes(), black.radiance.tobytes())
        self.assertEqual({e["name"]: e["state"] for e in black.report["effects"]}["environment"], "absent")

    def test_a_picture_at_rest_is_no_trouble(self):
        """A picture and a scene that stay loaded, used together and then one without the other: by one worker all along."""
        with Daemon() as other:
            other.candil("load", written("sunset", skies.sunset(128, 500)), "--name", "sunset")
            other.candil("load", room(), "--name", "room")
            for technique in ("pt", "vct", "direct", "radiosity"):
                for more in (under("sunset"), []):
                    other.render("room", (16, 12), 1, arguments=["--technique", technique, *more])
            self.assertEqual(other.stats()["worker_starts"], 1)

    def test_pieces_do_not_show(self):
        sky = written("sunset", skies.sunset(128, 500))
        for way in ("mis", "nee"):
            pictures = {daemon.render(room(), (24, 18), 4, arguments=under(sky), options={"pt.lights": way, **options})
                        .radiance.tobytes() for options in ({}, {"pt.segment": "1"}, {"pt.batch": "1"})}
            self.assertEqual(len(pictures), 1, way)


if __name__ == "__main__":
    unittest.main()
