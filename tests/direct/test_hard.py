"""Where a raster and short floats could fail `direct`, and what must not change its bits."""
import os
import subprocess
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, box, quad

daemon = Daemon()
DIRECT = ["--technique", "direct"]


def setUpModule():
    unittest.enterModuleContext(daemon)


def direct(scene, spp=1, arguments=(), on=None, **more):
    return (on or daemon).render(scene, spp=spp, arguments=[*DIRECT, *arguments], **more)


def scaled(scale, offset=(0, 0, 0)):
    g = Gltf()
    more = {"scale": [scale] * 3, "translation": list(offset)}
    g.place(*quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), g.material("floor", (.5, .6, .7)), **more)
    g.place(*box((-.5, 0, -.5), (.5, .7, .5)), g.material("block", (.7, .5, .3)), **more)
    g.place(*quad((-.5, 3, -.5), (.5, 3, -.5), (.5, 3, .5), (-.5, 3, .5)), g.material("lamp", (0, 0, 0), (9,) * 3), **more)
    place = lambda p: tuple(c * scale + o for c, o in zip(p, offset))
    g.camera(place((1, 2, 4)), place((0, .4, 0)), 40)
    return g.save(daemon.folder, "scaled.gltf")


class Numbers(unittest.TestCase):
    def same_picture(self, a, b):
        """But at edges, where a rounding chooses between two surfaces."""
        close = numpy.isclose(a.radiance, b.radiance, rtol=2e-2, atol=1e-3).all(axis=2)
        self.assertGreater(float(close.mean()), 0.985)
        self.assertTrue(bool(numpy.isfinite(a.radiance).all()))

    def test_scales(self):
        one = direct(scaled(1))
        for scale in (1e-3, 1e3, 1e6):
            with self.subTest(scale=scale):
                self.same_picture(direct(scaled(scale)), one)

    def test_far_away_by_nodes(self):
        self.same_picture(direct(scaled(1, (1e5, 0, -1e5))), direct(scaled(1)))

    def test_camera_in_a_block(self):
        scene = make.cornell(daemon.folder)
        camera = (-.35, .5, -.3, 0, .5, -3, 0, 1, 0, 90)
        ours = direct(scene, camera=camera, arguments=["--aov", "depth"])
        theirs = daemon.render(scene, spp=1, camera=camera, options={"pt.depth": 1}, arguments=["--aov", "depth"])
        self.assertTrue(numpy.allclose(ours.channels["Z"], theirs.channels["Z"], rtol=1e-3))
        self.assertEqual(float(ours.radiance.max()), 0)

    def test_floor_through_the_eye_plane(self):
        """A floor that goes on behind the camera, which all but lies on it."""
        scene = scaled(1)
        camera = (0, 1e-4, 2.9, 0, 1e-4, -3, 0, 1, 0, 60)
        ours = direct(scene, camera=camera, size=(64, 65), arguments=["--aov", "id"])
        theirs = daemon.render(scene, spp=1, camera=camera, size=(64, 65), arguments=["--aov", "id"])
        same = ours.channels["id"] == theirs.channels["id"]
        self.assertGreater(float(same.mean()), 0.99)

    def test_nothing_visible(self):
        picture = direct(scaled(1), camera=(0, 2, 4, 0, 10, 10, 0, 1, 0, 20), arguments=["--aov", "depth,id"])
        self.assertEqual(float(picture.radiance.max()), 0)
        self.assertTrue(bool(numpy.isinf(picture.channels["Z"]).all()))

    def test_one_triangle(self):
        g = Gltf()
        g.place([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [(0, 1, 2)], g.material("only", (.8,) * 3))
        g.light("point", 10, (0, 0, 2))
        g.camera((0, 0, 3), (0, 0, 0), 60)
        picture = direct(g.save(daemon.folder, "one.gltf"), size=(33, 33))
        # 0.8 / pi * 10 / 4 straight below the light.
        self.assertAlmostEqual(float(picture.radiance[16, 16, 0]), .8 / numpy.pi * 2.5, delta=2e-3)
        self.assertEqual(float(picture.radiance[0, 0, 0]), 0)

    def test_parallel_rays(self):
        g = Gltf()
        g.place(*quad((-.5, -.5, 0), (.5, -.5, 0), (.5, .5, 0), (-.5, .5, 0)), g.material("plate", (.5,) * 3))
        # Behind the camera's plane: parallel rays begin there, and do not see it.
        g.place(*quad((-.5, -.5, 3), (.5, -.5, 3), (.5, .5, 3), (-.5, .5, 3)), g.material("behind", (.5,) * 3))
        g.light("directional", 1.0, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
        g.camera((0, 0, 2), (0, 0, 0), 40)
        g.json["cameras"][0] = {"type": "orthographic", "name": "camera",
                                "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 100}}
        scene = g.save(daemon.folder, "parallel.gltf")
        ours = direct(scene, size=(32, 32), arguments=["--aov", "depth,id"])
        theirs = daemon.render(scene, spp=1, size=(32, 32), arguments=["--aov", "depth,id"])
        self.assertTrue(numpy.array_equal(ours.channels["id"], theirs.channels["id"]))
        self.assertTrue(numpy.allclose(ours.channels["Z"], theirs.channels["Z"]))
        self.assertEqual(int((ours.channels["id"] != 0).sum()), 256)

    def test_surfaces_in_one_plane(self):
        """Two quads in the same place: both techniques show the first, everywhere."""
        g = Gltf()
        for name, colour in (("first", (.8, .1, .1)), ("second", (.1, .8, .1))):
            g.place(*quad((-9, -1, 9), (9, -1, 9), (9, -1, -90), (-9, -1, -90)), g.material(name, colour))
        g.light("directional", 1.0, (0, 5, 0), (1, 0, 0))
        g.camera((0, 0, 9), (0, -.5, 0), 40)
        scene = g.save(daemon.folder, "coplanar.gltf")
        ids = numpy.rint(direct(scene, arguments=["--aov", "id"]).channels["id"].astype(float) * 2 ** 32)
        self.assertEqual(set(numpy.unique(ids)), {0, 1})


class Bits(unittest.TestCase):
    def test_twice_and_in_other_slices(self):
        scene = make.cornell(daemon.folder)
        aov = ["--aov", "depth,normal"]
        for spp in (1, 3):
            once = direct(scene, spp=spp, size=(160, 120), arguments=aov)
            again = direct(scene, spp=spp, size=(160, 120), arguments=aov)
            with Daemon("--slice", "1") as other:
                sliced = direct(scene, spp=spp, size=(160, 120), arguments=aov, on=other)
            for name in once.channels:
                self.assertTrue(numpy.array_equal(once.channels[name], again.channels[name]), name)
                self.assertTrue(numpy.array_equal(once.channels[name], sliced.channels[name]), name)

    def test_beside_the_path_tracer(self):
        """Both APIs in one process, and turns taken: neither disturbs the other."""
        scene = make.cornell(daemon.folder)
        alone = direct(scene, size=(128, 128))
        pt = daemon.render(scene, size=(128, 128), spp=8)
        path = os.path.join(daemon.folder, "beside.exr")
        other = subprocess.Popen([os.environ["CANDIL_BUILD"] + "/bin/candil", "--connect", daemon.socket, "render", scene, "-o",
                                  path, "--spp", "64", "--size", "128x128"], stdout=subprocess.DEVNULL)
        beside = direct(scene, size=(128, 128))
        self.assertEqual(other.wait(timeout=300), 0)
        self.assertTrue(numpy.array_equal(alone.radiance, beside.radiance))
        self.assertTrue(numpy.array_equal(pt.radiance, daemon.render(scene, size=(128, 128), spp=8).radiance))


class Life(unittest.TestCase):
    def test_device_memory_stays_level(self):
        scene = make.cornell(daemon.folder)
        direct(scene, size=(64, 64))
        before = daemon.stats()
        for i in range(50):
            direct(scene, size=(16 + i, 64))
        direct(scene, size=(64, 64))
        self.assertEqual(daemon.stats()["device_bytes"], before["device_bytes"])

    def test_budget_is_kept(self):
        with Daemon("--memory-budget", "16") as small:
            status, _, text = small.candil("render", make.cornell(daemon.folder), "-o", daemon.folder + "/x.exr", *DIRECT, "--size",
                                           "1024x1024", check=False)
            self.assertEqual(status, 6, text)
            picture = direct(make.cornell(daemon.folder), size=(64, 64), on=small)
            self.assertGreater(float(picture.radiance.max()), 0)


if __name__ == "__main__":
    unittest.main()
