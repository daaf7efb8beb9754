"""The voxels themselves: cells, sides and figures of a cube are known in closed form, and each picture shows them where they
are. A cube of edge 2 spans resolution - 2.75 voxels from 1.5 on: cells 1 to resolution - 2 along each axis."""
import json
import math
import os
import unittest

import numpy

from images import rgb
from render import Daemon, Failed
from writers import Gltf, box

daemon = Daemon()
SCENE = "cube"
SIDES = {"-z": (.1, .2, .3), "+z": (.8, .1, .1), "-y": (.1, .8, .1), "+y": (.1, .1, .8), "-x": (.6, .6, .1), "+x": (.1, .6, .6)}
FRONT = [0, 0, 5, 0, 0, 0, 0, 1, 0, 40]     # looks at +z from outside
SUN = ["--light", f"directional:direction=0,0,-1,intensity={math.pi}"]


def cube(name="cube.gltf"):
    """Each side of its own colour, faces outwards; `box` lists two triangles a side in the order of SIDES."""
    g = Gltf()
    points, triangles = box((-1, -1, -1), (1, 1, 1))
    for i, (side, albedo) in enumerate(SIDES.items()):
        g.place(points, triangles[2 * i:2 * i + 2], g.material(side, albedo))
    g.camera(FRONT[:3], FRONT[3:6], 40)
    return g.save(daemon.folder, name)


def setUpModule():
    unittest.enterModuleContext(daemon)
    daemon.candil("load", cube(), "--name", SCENE)


def show(what, size=(32, 32), resolution=32, arguments=(), name=None, **options):
    options = {f"vct.{key}": value for key, value in options.items()}
    return daemon.render(name or SCENE, size=size, spp=1, arguments=["--technique", "vct", *arguments],
                         options={"vct.show": what, "vct.resolution": resolution, **options})


def figures(report):
    return {f["name"]: f["value"] for f in report["figures"]}


def stages(report):
    return {s["name"] for s in report["stages"]}


def shell(side, thickness=1):
    return side ** 3 - (side - 2 * thickness) ** 3


class Figures(unittest.TestCase):
    def test_a_cube_has_the_cells_of_its_six_sides(self):
        found = figures(show("radiance").report)
        # Exactly: no side of it lies on a border between cells. Layers: three sides face up their axis, three down.
        self.assertEqual(found["entries"], 2 * (30 ** 3 - 29 ** 3))
        self.assertEqual(found["occupied.0"], shell(30) / 32 ** 3)
        self.assertEqual(found["occupied.1"], shell(16) / 16 ** 3)
        self.assertEqual(found["occupied.2"], shell(8) / 8 ** 3)
        self.assertEqual(found["levels"], 2)
        self.assertEqual([found["grid." + axis] for axis in "xyz"], [32] * 3)
        self.assertAlmostEqual(found["voxel"], 2 / 29.25, delta=1e-6)
        for axis in "xyz":
            self.assertAlmostEqual(found["low." + axis], -1 - 1.5 * 2 / 29.25, delta=1e-6)

    def test_memory_is_what_the_device_holds_more(self):
        """Two scenes like it that nobody has used: each job of the second pair leaves what its figures say."""
        for resolution in (32, 64):
            name = f"fresh{resolution}"
            daemon.candil("load", cube(name + ".gltf"), "--name", name)
            # The picture alone, with its scene: what a job of one pixel less takes goes again with its end.
            show("albedo", name=name, resolution=16)
            before = daemon.stats()["device_bytes"]
            voxels = figures(show("albedo", name=name, resolution=resolution).report)
            between = daemon.stats()["device_bytes"]
            self.assertEqual(voxels["bytes.all"], voxels["bytes.voxels"])
            self.assertLess(abs(between - before - voxels["bytes.voxels"]), 0.01 * voxels["bytes.voxels"] + 4096)
            lit = figures(show("radiance", name=name, resolution=resolution).report)
            after = daemon.stats()["device_bytes"]
            self.assertEqual(lit["bytes.voxels"], voxels["bytes.voxels"])
            more = lit["bytes.all"] - lit["bytes.voxels"]
            self.assertGreater(more, lit["bytes.pyramid"] + lit["bytes.light"])
            # And the scene's tree, for shadow rays.
            self.assertLess(abs(after - between - more), 0.01 * more + 16384)

    def test_every_picture_of_voxels_tells_and_others_have_none(self):
        picture = daemon.render(SCENE, size=(16, 16), spp=1, arguments=["--technique", "vct", *SUN],
                                options={"vct.resolution": 32, "vct.bounces": 3, "vct.cones": 9})
        found = figures(picture.report)
        self.assertEqual((found["bounces"], found["cones"], found["entries"]), (3, 9, 2 * (30 ** 3 - 29 ** 3)))
        self.assertNotIn("occupied.0", found)
        self.assertEqual(daemon.render(SCENE, size=(16, 16), spp=1).report["figures"], [])


class Views(unittest.TestCase):
    def middle(self, picture):
        return picture.radiance[picture.radiance.shape[0] // 2, picture.radiance.shape[1] // 2]

    def test_each_quantity_of_the_side_that_is_seen(self):
        for what, expected in (("albedo", SIDES["+z"]), ("normal", (.5, .5, 1)), ("emission", (0, 0, 0)),
                               ("coverage", (0, 0, 1))):
            picture = show(what, arguments=SUN)
            self.assertLess(numpy.abs(self.middle(picture) - expected).max(), 1e-3, what)
            # No more than is asked for.
            self.assertFalse(stages(picture.report) & {"voxel-light", "pyramid", "voxel-gather", "light", "cones"})
            states = {e["name"]: e["state"] for e in picture.report["effects"]}
            self.assertEqual((states["lights"], states["bounces"]), ("unsupported", "unsupported"))

    def test_light_of_a_sun_that_faces_the_side(self):
        # What is convex sends itself nothing: E = pi, L = albedo, on every level.
        self.assertLess(numpy.abs(self.middle(show("irradiance", arguments=SUN)) / math.pi - 1).max(), 0.01)
        for level in (0, 1, 2):
            value = self.middle(show("radiance", arguments=SUN, level=level))
            self.assertLess(numpy.abs(value / SIDES["+z"] - 1).max(), 0.02, level)

    def test_each_side_has_its_own_colour(self):
        for eye, up, side in (((0, 0, -5), (0, 1, 0), "-z"), ((5, 0, 0), (0, 1, 0), "+x"), ((-5, 0, 0), (0, 1, 0), "-x"),
                              ((0, 5, 0), (0, 0, -1), "+y"), ((0, -5, 0), (0, 0, 1), "-y")):
            picture = daemon.render(SCENE, size=(16, 16), spp=1, camera=[*eye, 0, 0, 0, *up, 40],
                                    arguments=["--technique", "vct"],
                                    options={"vct.show": "albedo", "vct.resolution": 32})
            self.assertLess(numpy.abs(self.middle(picture) - SIDES[side]).max(), 1e-3, side)

    def test_the_cell_of_the_eye_is_looked_through(self):
        eye = [0, 0, 0.99, 0, 0, -5, 0, 1, 0, 40]
        picture = daemon.render(SCENE, size=(16, 16), spp=1, camera=eye, arguments=["--technique", "vct"],
                                options={"vct.show": "albedo", "vct.resolution": 32})
        self.assertLess(numpy.abs(self.middle(picture) - SIDES["-z"]).max(), 1e-3)

    def test_nothing_is_seen_beside_the_cube(self):
        picture = show("coverage", size=(64, 64))
        self.assertEqual(float(numpy.abs(picture.radiance[:4]).max()), 0)
        # A silhouette as large as the cube's own, to a voxel: its front is 4 m from the eye.
        wide = 64 * (1 / 4) / math.tan(math.radians(20))
        seen = int((picture.radiance.max(axis=2) > 0)[32].sum())
        self.assertLess(abs(seen - wide), 64 * (2 / 29.25 / 4) / math.tan(math.radians(20)) + 2)

    def test_the_same_bits_again(self):
        first, second = (show("radiance", level=1, arguments=SUN).radiance for _ in range(2))
        self.assertTrue((first == second).all())


class Slices(unittest.TestCase):
    def check(self, axis, left, right, top, bottom):
        picture = show("albedo", axis=axis, slice=16).radiance
        filled = picture.max(axis=2) > 0
        expected = numpy.zeros((32, 32), dtype=bool)
        expected[1:31, 1:31] = True
        expected[2:30, 2:30] = False
        self.assertTrue((filled == expected).all(), axis)
        for at, side in (((16, 1), left), ((16, 30), right), ((1, 16), top), ((30, 16), bottom)):
            self.assertLess(numpy.abs(picture[at] - SIDES[side]).max(), 1e-3, (axis, side))

    def test_walls_are_where_they_are(self):
        self.check("x", "+z", "-z", "+y", "-y")
        self.check("y", "-x", "+x", "-z", "+z")
        self.check("z", "-x", "+x", "+y", "-y")

    def test_a_wall_within_its_slice_fills_it(self):
        for axis, cell, side in (("x", 1, "-x"), ("x", 30, "+x"), ("y", 1, "-y"), ("z", 30, "+z")):
            picture = show("albedo", axis=axis, slice=cell).radiance
            self.assertEqual(int((picture.max(axis=2) > 0).sum()), 30 ** 2)
            self.assertLess(numpy.abs(picture[10:22, 10:22] - SIDES[side]).max(), 1e-3, (axis, cell))
        self.assertEqual(float(show("albedo", axis="x", slice=0).radiance.max()), 0)

    def test_a_cell_is_a_whole_number_of_pixels(self):
        small = show("albedo", axis="z", slice=30).radiance
        large = show("albedo", axis="z", slice=30, size=(101, 99)).radiance
        # 3 pixels a cell; 5 and 3 are left over, 2 and 1 of them before the slice.
        cells = large[1:97, 2:98]
        self.assertTrue((cells == numpy.repeat(numpy.repeat(small, 3, axis=0), 3, axis=1)).all())
        large[1:97, 2:98] = 0
        self.assertEqual(float(large.max()), 0)

    def test_slices_of_a_level(self):
        cover = show("coverage", axis="z", slice=8, level=1, size=(16, 16)).radiance
        expected = numpy.zeros((16, 16), dtype=bool)
        expected[[0, 15], :] = expected[:, [0, 15]] = True
        self.assertTrue(((cover.max(axis=2) > 0) == expected).all())
        # The left side hides its cells' faces across x, and no others.
        self.assertLess(numpy.abs(cover[8, 0] - (1, 0, 0)).max(), 1e-3)


class Refused(unittest.TestCase):
    def refused(self, words, what="albedo", **options):
        with self.assertRaises(Failed) as caught:
            show(what, **options)
        self.assertEqual(caught.exception.status, 2)
        for word in words:
            self.assertIn(word, caught.exception.text)

    def test_what_there_is_not(self):
        self.refused(["vct.show", "albedo", "coverage"], what="colour")
        self.refused(["x, y, z"], axis="w")
        self.refused(["vct.slice", "511"], slice=512)
        self.refused(["no slice 32", "has 32"], slice=32)
        self.refused(["no slice 16", "has 16"], what="coverage", level=1, slice=16)
        self.refused(["32 x 32 cells"], slice=16, size=(32, 31))
        self.refused(["no level 3", "0 to 2"], what="radiance", level=3)
        self.refused(["radiance and coverage"], level=1)
        self.refused(["vct.show"], what="none", slice=3)
        self.refused(["vct.show"], what="none", level=1)
        self.refused(["no option 'vct.look'", "show"], look=1)


class Command(unittest.TestCase):
    def inspect(self, *arguments, check=True):
        return daemon.candil("inspect", SCENE, "-o", os.path.join(daemon.folder, "i"), "--set", "vct.resolution=32",
                             *SUN, *arguments, check=check)

    def test_files_and_figures(self):
        _, out, _ = self.inspect("--size", "70x40", "--format", "exr", "--json")
        answer = json.loads(out)
        self.assertFalse(os.path.exists(os.path.join(daemon.folder, "i.json")))
        self.assertEqual(figures(answer)["entries"], 2 * (30 ** 3 - 29 ** 3))
        self.assertLessEqual({"show", "count"}, stages(answer))
        images = {os.path.basename(i["image"]): i for i in answer["images"]}
        names = {f"i-view-{s}.exr" for s in ("radiance", "albedo", "normal", "coverage")}
        names |= {f"i-slice-{a}-{s}.exr" for a in "xyz" for s in ("radiance", "coverage")}
        names |= {f"i-level-{n}-radiance.exr" for n in (1, 2)}
        self.assertEqual(set(images), names)
        for name, image in images.items():
            self.assertEqual(os.path.getsize(image["image"]), image["bytes"])
            # As many pixels as asked for; a slice as many as its cells have, here one each.
            self.assertEqual((image["width"], image["height"]), (32, 32) if "slice" in name else (70, 40))
            self.assertEqual(rgb(image["image"]).shape, (image["height"], image["width"], 3))
        middle = images["i-slice-z-radiance.exr"]
        self.assertEqual((middle["slice"], middle["axis"], middle["kind"]), (16, "z", "slice"))
        alone = show("radiance", axis="z", slice=16, arguments=SUN).radiance
        self.assertTrue((rgb(middle["image"]) == alone).all())

    def test_pictures_and_a_file_of_figures(self):
        _, out, _ = self.inspect("--size", "32x32")
        for word in ("images", "grid", "occupied", "memory", "time"):
            self.assertIn(word, out)
        with open(os.path.join(daemon.folder, "i.json")) as file:
            answer = json.load(file)
        self.assertEqual(len(answer["images"]), 12)
        for image in answer["images"]:
            with open(image["image"], "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_wrong_command_lines(self):
        for wrong in (["--technique", "pt"], ["--set", "vct.show=albedo"], ["--set", "vct.slice=3"], ["-o", "-"],
                      ["--set", "vct.resolution=31"], ["--progressive"]):
            self.assertEqual(self.inspect(*wrong, check=False)[0], 2, wrong)
        status, _, said = self.inspect("-o", "/nowhere/at/all", check=False)
        self.assertEqual(status, 1)
        self.assertIn("/nowhere/at/all", said)


if __name__ == "__main__":
    unittest.main()
