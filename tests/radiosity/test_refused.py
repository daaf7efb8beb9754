"""What radiosity cannot do is refused in words, before or in the midst of it, and the next request is none the worse; and scenes of
nearly nothing are rendered."""
import math
import re
import unittest

import numpy

import make
import rooms
from common import WHITE, RadiosityDaemon, figures
from render import Failed
from writers import Gltf, box, quad

daemon = RadiosityDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


class Refusals(unittest.TestCase):
    def refused(self, status, words, scene, patches=100, arguments=(), **options):
        with self.assertRaises(Failed) as failure:
            daemon.radiosity(scene, patches, (16, 16), arguments=arguments, **{"rays": 64, **options})
        self.assertEqual(failure.exception.status, status, failure.exception.text)
        self.assertIn(words, failure.exception.text)

    def test_a_closed_room_that_keeps_all_light(self):
        scene = rooms.uniform_room(daemon.folder, 1.0)
        g = Gltf()
        g.place(*box((-1, -1, -1), (1, 1, 1), inward=True), g.material("wall", (1,) * 3, (.5,) * 3))
        g.camera((0, 0, .5), (0, 0, -1), 60)
        white = g.save(daemon.folder, "white.gltf")
        for solver in ("jacobi", "gauss-seidel", "gradient"):
            self.refused(2, "solution", white, solver=solver)
        # It has no light at all, so that nothing is to be solved.
        self.assertEqual(daemon.radiosity(scene, 54, (8, 8), rays=64).mean(), 0)
        # With one wall of another albedo it is a room like any other.
        self.assertGreater(daemon.radiosity(white, 100, (8, 8), rays=64, arguments=["--material", "wall:color=.9,.9,.9"]).mean(), 1)

    def test_a_white_body_in_the_open_is_no_closed_room(self):
        picture = daemon.radiosity(make.furnace(daemon.folder), 320, arguments=WHITE)
        numpy.testing.assert_allclose(picture.radiance[12:20, 12:20], 1, rtol=1e-4)

    def test_values(self):
        box = make.cornell(daemon.folder)
        for name, value in (("patches", 0), ("patches", "many"), ("edge", -1), ("edge", "nan"), ("rays", 15), ("rays", 4000001), ("rays", 20.5),
                            ("mirrors", "portals"), ("bounces", 33), ("points", 3), ("solver", "lu"), ("residual", 0), ("residual", 1),
                            ("display", "flat"), ("gather", 0), ("show", "beauty"), ("factors", "none"), ("slice", 1)):
            self.refused(2, "radiosity." + name, box, **{name: value})

    def test_rows(self):
        box = make.cornell(daemon.folder)
        self.refused(2, "radiosity.show=row", box, row=3)
        self.refused(2, "radiosity.show=row", box, row=3, show="b")
        shown = daemon.radiosity(box, 100, show="row", row=0, rays=64)
        last = int(2 * figures(shown)["patches"] - 1)
        self.assertGreater(shown.mean(), 0)
        daemon.radiosity(box, 100, show="row", row=last, rays=64)
        self.refused(2, f"0 to {last}", box, show="row", row=last + 1)
        self.refused(2, "middle", box, show="row", arguments=["--camera", "0,1,9,0,1,20,0,1,0,40"])

    def test_the_middle_of_the_picture_says_whose_row(self):
        """It is that of the element with this number: the same picture as by the number."""
        box, up = make.cornell(daemon.folder), ["--camera", "0,.5,0,0,2,.9,0,0,1,40"]
        numbers = daemon.radiosity(box, 100, (17, 17), show="row", rays=64, arguments=up)
        seen = daemon.radiosity(box, 100, (17, 17), show="id", rays=64, arguments=up)
        of = int(2 * figures(seen)["patches"])
        alike = [i for i in range(of) if numpy.array_equal(daemon.radiosity(box, 100, (17, 17), show="row", row=i, rays=64, arguments=up).radiance,
                                                           numbers.radiance)]
        self.assertIn(len(alike), range(1, of))

    def test_cameras_of_paths_alone(self):
        box = make.cornell(daemon.folder)
        for more in (["--panorama"], ["--lens", "0.1,1"], ["--filter", "bh"], ["--error", "0.1"]):
            self.refused(2, "unsupported", box, arguments=more)

    def test_options_of_others(self):
        self.refused(2, "vct.resolution", make.cornell(daemon.folder), arguments=["--set", "vct.resolution=32"])


class Memory(unittest.TestCase):
    def test_what_does_not_fit_is_refused_with_what_does(self):
        with RadiosityDaemon("--memory-budget", "24") as small:
            small.candil("load", make.cornell(small.folder), "--name", "box")
            before = small.radiosity("box", 64, rays=64).radiance
            for options in (dict(patches=200000), dict(edge=.004)):
                with self.assertRaises(Failed) as refused:
                    small.radiosity("box", rays=256, **options)
                self.assertEqual(refused.exception.status, 6, refused.exception.text)
                print(refused.exception.text.strip())
                fits = re.search(r"radiosity\.patches=(\d+)", refused.exception.text)
                self.assertIsNotNone(fits, refused.exception.text)
                self.assertGreater(int(fits.group(1)), 100)
                picture = small.radiosity("box", int(fits.group(1)), rays=256)
                self.assertGreater(picture.mean(), .05)
                self.assertLessEqual(small.stats()["device_bytes"], 24 << 20)
            numpy.testing.assert_array_equal(small.radiosity("box", 64, rays=64).radiance, before)
            self.assertEqual(small.stats()["worker_starts"], 1)


class NearlyNothing(unittest.TestCase):
    def finite(self, scene, **more):
        radiance = daemon.radiosity(scene, rays=64, **more).radiance
        self.assertTrue(bool(numpy.isfinite(radiance).all()))
        self.assertGreaterEqual(float(radiance.min()), 0)
        return radiance

    def triangle(self, name, *corners):
        g = Gltf()
        g.place([list(c) for c in corners], [(0, 1, 2)], g.material("triangle", (.5,) * 3))
        g.light("directional", 1.0, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
        g.camera((0, 0, 3), (0, 0, 0), 40)
        return g.save(daemon.folder, name)

    def test_empty_scene(self):
        g = Gltf()
        g.camera((0, 0, 3), (0, 0, 0), 40)
        daemon.candil("load", g.save(daemon.folder, "empty.gltf"), "--name", "empty")
        for options in ({}, {"display": "gather"}, {"display": "constant"}):
            self.assertEqual(float(self.finite("empty", arguments=WHITE, **options).min()), 1.0)
        self.assertEqual(float(self.finite("empty", show="b", arguments=WHITE).max()), 0)

    def test_only_lights(self):
        g = Gltf()
        g.light("point", 5, (0, 1, 0))
        g.camera((0, 0, 3), (0, 0, 0), 40)
        self.assertEqual(float(self.finite(g.save(daemon.folder, "lights.gltf")).max()), 0)

    def test_one_triangle(self):
        scene = self.triangle("one.gltf", (-1, -1, 0), (1, -1, 0), (0, 1, 0))
        for display in ("constant", "vertex", "gather"):
            for patches in (1, 2, 50):
                lit = self.finite(scene, patches=patches, display=display)
                self.assertLess(abs(float(lit[16, 16].mean()) * math.pi / .5 - 1), 1e-3)

    def test_needles_and_points(self):
        for i, width in enumerate((1e-3, 1e-6, 1e-12)):
            self.finite(self.triangle(f"needle{i}.gltf", (-1, 0, 0), (1, 0, 0), (1, width, 0)), arguments=WHITE)
        self.finite(self.triangle("point.gltf", (0, 0, 0), (0, 0, 0), (0, 0, 0)), arguments=WHITE)
        self.finite(self.triangle("line.gltf", (-1, 0, 0), (0, 0, 0), (1, 0, 0)), arguments=WHITE)

    def test_degenerate_triangles_among_others(self):
        """They are there in the file, and change nothing."""
        def scene(name, more):
            g = Gltf()
            points, triangles = quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))
            g.place(points, triangles + more, g.material("floor", (.5,) * 3))
            g.place(*quad((-.5, 1, -.5), (.5, 1, -.5), (.5, 1, .5), (-.5, 1, .5)), g.material("lamp", (0, 0, 0), (1,) * 3))
            g.camera((0, .5, 3), (0, 0, 0), 30)
            return g.save(daemon.folder, name)
        plain, odd = (self.finite(scene(f"degenerate{len(more)}.gltf", more), patches=50) for more in ([], [(0, 1, 1), (2, 2, 2)]))
        numpy.testing.assert_allclose(odd, plain, rtol=.05, atol=.01)

    def test_only_unlit(self):
        radiance = self.finite(make.unlit_quad(daemon.folder), patches=32)
        numpy.testing.assert_allclose(radiance[10, 16], (.25, .5, .75), rtol=1e-5)
        self.assertEqual(float(radiance[31].max()), 0)

    def test_no_light_is_black(self):
        self.assertEqual(float(self.finite(make.unlit(daemon.folder), patches=400).max()), 0)

    def test_fewer_patches_than_faces(self):
        picture = daemon.radiosity(make.cornell(daemon.folder), 1, rays=64)
        self.assertEqual(figures(picture)["patches"], 18)

    def test_camera_within_a_wall(self):
        scene = rooms.uniform_room(daemon.folder, .5)
        for z in (1.0, 1.0001, .9999, 1.5):
            self.finite(scene, patches=54, camera=(.01, .02, z, .1, .3, -1.5, 0, 1, 0, 60))


if __name__ == "__main__":
    unittest.main()
