"""Pictures of radiosity that are known beforehand: furnaces, lamps, each kind of light alone, skies, textures."""
import math
import os
import unittest

import numpy

import images
import make
import rooms
import skies
from common import WHITE, RadiosityDaemon, figures
from writers import Gltf, png, quad

daemon = RadiosityDaemon()
DISPLAYS = ("constant", "vertex", "gather")
ABOVE = (0, 5, 0, 0, 0, 0, 0, 0, -1, 40)


def setUpModule():
    unittest.enterModuleContext(daemon)


class Furnace(unittest.TestCase):
    """E / (1 - ρ), here 1, with all that bounces. The solver may end early by 1e-5 ρ / (1 - ρ)."""

    def check(self, scene, rho, **options):
        for display in DISPLAYS:
            with self.subTest(rho=rho, display=display, **options):
                # A gather takes samples of lamps, and here all is one: 64 of each pixel.
                gathers = display == "gather"
                picture = daemon.radiosity(scene, size=(12, 12), spp=64 if gathers else 1, display=display, rays=64, **options)
                self.assertLess(abs(picture.mean() - 1), 1e-3)
                self.assertLess(float(numpy.abs(picture.radiance - 1).max()), .1 if gathers else 2e-3)

    def test_room(self):
        for rho in (0.5, 0.9, 0.99):
            self.check(rooms.uniform_room(daemon.folder, rho), rho, patches=54)

    def test_sphere(self):
        for rho in (0.5, 0.9, 0.99):
            self.check(make.closed_sphere(daemon.folder, rho, name=f"sphere_{rho}.gltf"), rho, patches=320)

    def test_by_each_solver(self):
        scene = rooms.uniform_room(daemon.folder, 0.99)
        for solver in ("jacobi", "gauss-seidel", "gradient"):
            self.check(scene, 0.99, patches=54, solver=solver, residual=1e-6)

    def test_without_bounces_it_is_what_is_emitted_and_once_reflected(self):
        rho = 0.5
        scene = rooms.uniform_room(daemon.folder, rho)
        picture = daemon.radiosity(scene, 54, rays=64, arguments=["--effects=-bounces"])
        numpy.testing.assert_allclose(picture.radiance, 1 - rho ** 2, rtol=1e-5)


def lamp_opposite(side=1.0, gap=1.0):
    """A square floor, and opposite it a black square lamp of radiance 1."""
    g = Gltf()
    s = side / 2
    g.place(*quad((-s, 0, s), (s, 0, s), (s, 0, -s), (-s, 0, -s)), g.material("floor", (.5,) * 3))
    g.place(*quad((-s, gap, -s), (s, gap, -s), (s, gap, s), (-s, gap, s)), g.material("lamp", (0, 0, 0), (1,) * 3))
    g.camera((.3, .6, .4), (0, 0, 0), 30)
    return g.save(daemon.folder, "opposite.gltf")


class Lamps(unittest.TestCase):
    FACING = 0.1998248957  # form factor of two equal squares that face each other, as far away as they are long: Howell's C-11

    def test_squares_that_face_each_other(self):
        """Radiance ρ F of a patch that sees the lamp. The error is of the kind that the number of rays foretells, or less: they
        are spread more evenly than independent ones."""
        errors = {}
        for rays in (256, 4096, 65536):
            picture = daemon.radiosity(lamp_opposite(), 2, rays=rays, display="constant")
            self.assertEqual(figures(picture)["patches"], 2)
            errors[rays] = abs(picture.mean() / .5 - self.FACING)
            print(f"{rays} rays: {picture.mean() / .5:.6f}, wrong by {errors[rays]:.1e}")
            self.assertLess(errors[rays], 3 * math.sqrt(self.FACING * (1 - self.FACING) / rays))
        self.assertLess(errors[65536], 4e-4)

    def test_below_a_lamp(self):
        """Irradiance below the lamp's middle is 0.75227, by Lambert's polygon formula: of a corner for vertex, of the very pixel
        for gather; of a patch it is the mean over the patch."""
        g = Gltf()
        for x, z in ((-1, 1), (0, 1), (-1, 0), (0, 0)):
            g.place(*quad((x, 0, z), (x + 1, 0, z), (x + 1, 0, z - 1), (x, 0, z - 1)), g.material("floor", (.5,) * 3))
        g.place(*quad((-.5, 1, -.5), (.5, 1, -.5), (.5, 1, .5), (-.5, 1, .5)), g.material("lamp", (0, 0, 0), (1,) * 3))
        g.camera((0, .5, 3), (0, 0, 0), .2)
        scene = g.save(daemon.folder, "below.gltf")
        for display, spp, tolerance in (("vertex", 1, .015), ("gather", 16, .01)):
            picture = daemon.radiosity(scene, 1600, (8, 8), spp, display=display, rays=1024)
            value = picture.mean() * math.pi / .5
            print(f"{display}: {value:.5f}")
            self.assertLess(abs(value / .75227 - 1), tolerance)


def means(function, patches, half, finer=24):
    """Of a function of x, z over each patch of a floor, seen from above with -z upwards."""
    at = (numpy.arange(patches * finer) + .5) / (patches * finer) * 2 * half - half
    x, z = numpy.meshgrid(at, at)
    return function(x, z).reshape(patches, finer, patches, finer).mean(axis=(1, 3))


class Lights(unittest.TestCase):
    """A floor of 8 x 8 patches of 1.25 m seen from above, a pixel for each: the mean irradiance of each, by quadrature."""

    def floor(self, kind):
        scene = make.lit_floor(daemon.folder, kind, 3.0)
        picture = daemon.radiosity(scene, 64, (8, 8), camera=ABOVE, arguments=["--orthographic", "10"], display="constant", points=256)
        self.assertEqual(figures(picture)["patches"], 64)
        return picture.radiance.astype(numpy.float64).mean(axis=2) * math.pi / .5

    def check(self, kind, irradiance, tolerance):
        seen, expected = self.floor(kind), means(irradiance, 8, 5)
        print(f"{kind}: largest error {numpy.abs(seen - expected).max() / expected.max():.1e} of the most, mean {seen.mean() / expected.mean() - 1:+.1e}")
        self.assertLess(float(numpy.abs(seen - expected).max() / expected.max()), tolerance)
        self.assertLess(abs(float(seen.mean() / expected.mean()) - 1), tolerance)

    def test_point(self):
        self.check("point", lambda x, z: 3 * 2 / (x * x + z * z + 4) ** 1.5, .01)

    def test_spot(self):
        def irradiance(x, z):
            cosine = 2 / numpy.sqrt(x * x + z * z + 4)
            inner, outer = (math.cos(math.radians(a)) for a in (15, 30))
            return 3 * cosine ** 3 / 4 * numpy.clip((cosine - outer) / (inner - outer), 0, 1) ** 2
        self.check("spot", irradiance, .02)

    def test_sun(self):
        self.check("directional", lambda x, z: 3 + 0 * x, 1e-5)

    def test_corners_between_patches(self):
        """What is between the corners is nearer the truth than patches are, and four times as near with patches half as long."""
        scene = make.lit_floor(daemon.folder, "point", 3.0)
        x, z = numpy.meshgrid(*[(numpy.arange(64) + .5) / 6.4 - 5] * 2)
        expected = 6 / (x * x + z * z + 4) ** 1.5
        errors = {}
        for display, patches in (("constant", 400), ("vertex", 400), ("vertex", 1600)):
            seen = daemon.radiosity(scene, patches, (64, 64), camera=ABOVE, arguments=["--orthographic", "10"], display=display, points=64)
            self.assertEqual(figures(seen)["patches"], patches)
            errors[display, patches] = numpy.sqrt(((seen.radiance.mean(axis=2) * math.pi / .5 - expected) ** 2).mean()) / expected.mean()
        print(errors)
        self.assertLess(errors["vertex", 400], .6 * errors["constant", 400])
        self.assertLess(errors["vertex", 1600], .3 * errors["vertex", 400])


class Skies(unittest.TestCase):
    def test_open_floor_is_its_albedo(self):
        scene = rooms.plane(daemon.folder, .7)
        for display in DISPLAYS:
            for arguments in (WHITE, ["--background", "0.5,1,2"]):
                picture = daemon.radiosity(scene, 16, arguments=arguments, display=display)
                expected = [.7 * float(c) for c in arguments[1].split(",")]
                numpy.testing.assert_allclose(picture.radiance[10:22, 10:22], numpy.broadcast_to(expected, (12, 12, 3)), rtol=1e-5)

    def test_nothing_but_background(self):
        picture = daemon.radiosity(make.furnace(daemon.folder), camera=(0, 0, 4, 0, 0, 9, 0, 1, 0, 40), arguments=WHITE)
        self.assertEqual((float(picture.radiance.min()), float(picture.radiance.max())), (1.0, 1.0))

    def test_convex_body_is_its_albedo(self):
        scene = make.furnace(daemon.folder, albedo=.6, name="convex.gltf")
        for display in DISPLAYS:
            picture = daemon.radiosity(scene, 320, arguments=WHITE, display=display)
            numpy.testing.assert_allclose(picture.radiance[12:20, 12:20], .6, rtol=1e-4)

    def test_picture_of_the_surroundings(self):
        w = skies.directions(64, 32)
        sky = (1 + w @ numpy.array([0.6, 0.3, 0.7]))[:, :, None] ** 4 * numpy.array([1, 0.5, 0.25])
        path = os.path.join(daemon.folder, "sky.exr")
        images.write(path, sky)
        expected = .7 / math.pi * skies.irradiance(sky, (0, 1, 0))
        for display, tolerance in (("constant", .01), ("vertex", .01), ("gather", .03)):
            picture = daemon.radiosity(rooms.plane(daemon.folder, .7), 16, (16, 16), 4, arguments=["--background", path], display=display)
            ratio = picture.radiance[5:11, 5:11].mean(axis=(0, 1), dtype=numpy.float64) / expected
            print(f"{display}: {ratio}")
            self.assertLess(float(numpy.abs(ratio - 1).max()), tolerance)

    def test_turned_and_scaled(self):
        """A wall, whose front sees one half of a sky that is bright on one side."""
        w = skies.directions(32, 16)
        sky = numpy.repeat(numpy.maximum(w @ numpy.array([0, 0, 1.0]), 0)[:, :, None], 3, axis=2)
        path = os.path.join(daemon.folder, "side.exr")
        images.write(path, sky)
        g = Gltf()
        g.place(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("wall", (.5,) * 3))
        g.camera((0, 0, 3), (0, 0, 0), 20)
        wall = g.save(daemon.folder, "wall.gltf")
        straight, half, away = (daemon.radiosity(wall, 4, (8, 8), arguments=["--background", path, *more]).mean()
                                for more in ([], ["--background-scale", "0.5"], ["--background-turn", "180"]))
        self.assertLess(abs(straight * math.pi / .5 / skies.irradiance(sky, (0, 0, 1))[0] - 1), .01)
        self.assertLess(abs(half / straight - .5), 1e-4)
        self.assertLess(away, 1e-4 * straight)


class Textures(unittest.TestCase):
    COLOURS = [[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]]

    def board(self):
        """A quad whose quarters are red green / blue white from the top; pixel columns and rows 0-7 and 8-15."""
        g = Gltf()
        texture = g.image(png(2, 2, lambda x, y: self.COLOURS[y][x]), magFilter=9728)
        mesh = g.mesh(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), g.material("board", texture=texture), uvs=make.PICTURE_UVS)
        g.node(mesh=mesh)
        g.camera((0, 0, 2), (0, 0, 0), 53.13)
        g.light("directional", math.pi, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
        return g.save(daemon.folder, "board.gltf")

    def test_they_are_in_the_picture(self):
        expected = numpy.repeat(numpy.repeat(numpy.array(self.COLOURS) / 255, 8, axis=0), 8, axis=1)
        for display in DISPLAYS:
            picture = daemon.radiosity(self.board(), 1, (16, 16), display=display, arguments=["--orthographic", "2"])
            numpy.testing.assert_allclose(picture.radiance[2:-2, 2:-2][:, [0, 1, 2, -3, -2, -1]],
                                          expected[2:-2, 2:-2][:, [0, 1, 2, -3, -2, -1]], rtol=1e-4, atol=1e-6)

    def test_a_patch_reflects_their_mean(self):
        shown = daemon.radiosity(self.board(), 1, (16, 16), show="albedo", arguments=["--orthographic", "2"])
        self.assertEqual(figures(shown)["patches"], 1)
        numpy.testing.assert_allclose(shown.radiance, .5, rtol=1e-5)
        sent = daemon.radiosity(self.board(), 1, (16, 16), show="b", arguments=["--orthographic", "2"])
        numpy.testing.assert_allclose(sent.radiance, .5 * math.pi, rtol=1e-4)


class Sums(unittest.TestCase):
    def test_doubled_emission_doubles_every_pixel(self):
        once, twice = (daemon.radiosity(make.cornell(daemon.folder, radiance=r, name=f"radiance_{r}.gltf"), 200, rays=64).radiance
                       for r in (15.0, 30.0))
        self.assertGreater(float(once.max()), 0)
        numpy.testing.assert_array_equal(twice, 2 * once)

    def test_lights_apart_add_up(self):
        """Of each patch: what is extrapolated at borders is more than one light tells."""
        box, sun = make.cornell(daemon.folder), ["--light", "point:at=.5,1.5,.5,intensity=2"]
        off = ["--material", "lamp:emission=0,0,0"]
        both, lamp, light, sky, lamp_and_sky = (
            daemon.radiosity(box, 200, rays=64, arguments=a, residual=1e-7, display="constant").radiance.astype(numpy.float64)
            for a in (sun + ["--background", ".2,.3,.4"], [], sun + off, off + ["--background", ".2,.3,.4"], ["--background", ".2,.3,.4"]))
        numpy.testing.assert_allclose(lamp + light + sky, both, rtol=1e-4, atol=1e-5)
        numpy.testing.assert_allclose(lamp + sky, lamp_and_sky, rtol=1e-4, atol=1e-5)


if __name__ == "__main__":
    unittest.main()
