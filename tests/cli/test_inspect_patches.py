"""What radiosity computes with, as `candil inspect` tells it: figures that a closed room and an open square have in closed form."""
import json
import os
import unittest

import numpy

import make
import rooms
from images import rgb
from render import Daemon
from writers import Gltf, quad

daemon = Daemon()
RHO = 0.5
VIEWS = ("b", "e", "albedo", "id", "normal", "residual", "row")


def setUpModule():
    unittest.enterModuleContext(daemon)


def figures(answer):
    return {f["name"]: f["value"] for f in answer["figures"]}


def stages(answer):
    return {s["name"] for s in answer["stages"]}


def load(path, name):
    """Keep a scene, and what is made of it, from one render to the next."""
    daemon.candil("load", path, "--name", name)
    return name


def inspect(scene, *arguments, check=True, prefix="i"):
    done = daemon.candil("inspect", scene, "--technique", "radiosity", "-o", os.path.join(daemon.folder, prefix), *arguments,
                         check=check)
    return json.loads(done[1]) if "--json" in arguments and done[0] == 0 else done


def show(scene, what, *arguments, **options):
    options = {"radiosity." + name: value for name, value in {"show": what, **options}.items()}
    return daemon.render(scene, size=(32, 32), spp=1, options=options, arguments=["--technique", "radiosity", *arguments])


class Figures(unittest.TestCase):
    def test_a_closed_room(self):
        found = figures(show(rooms.uniform_room(daemon.folder, RHO), "b", patches=54, rays=4096).report)
        # Its walls shine inwards: the fronts of nine patches a side. Nobody sees the other patches of its own side.
        self.assertEqual((found["patches"], found["check.rows"]), (54, 54))
        self.assertEqual(found["check.factors"], 54 * 45)
        self.assertEqual(sum(found[f"values.1e-{n}"] for n in range(1, 8)) + found["values.0"], 54 * 45)
        self.assertEqual(found["reciprocity.pairs"], 54 * 45 / 2)
        for name in ("sum.least", "sum.mean", "sum.most", "sum.all.least", "sum.all.mean", "sum.all.most"):
            self.assertAlmostEqual(found[name], 1, delta=1e-6, msg=name)
        # 4,096 rays of a low-discrepancy set: a factor of 1/50 is off by some percent.
        self.assertLess(found["reciprocity.mean"], 0.1)
        self.assertLess(found["reciprocity.most"], 1)
        # Of all factors the sum is one a row: the mean is 1 / 45.
        self.assertGreater(found["values.1e-2"], 54 * 20)

    def test_an_open_square_sees_nothing_and_all_escapes(self):
        found = figures(show(rooms.plane(daemon.folder), "b", "--background", "1,1,1", patches=16, rays=64).report)
        self.assertEqual((found["check.rows"], found["check.factors"], found["reciprocity.pairs"]), (32, 0, 0))
        self.assertEqual((found["sum.least"], found["sum.most"]), (0, 0))
        self.assertEqual((found["sum.all.least"], found["sum.all.most"]), (1, 1))
        self.assertEqual((found["reciprocity.mean"], found["reciprocity.most"]), (0, 0))

    def test_they_tell_of_the_rows_that_this_light_reaches(self):
        """A square in the light, and one that faces away from it: each is lit from its own side alone."""
        g = Gltf()
        g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("floor", (.5,) * 3))
        g.camera((0, 3, .01), (0, 0, 0), 40)
        scene = load(g.save(daemon.folder, "sides.gltf"), "sides")
        above, below = (["--light", f"directional:direction=0,{y},0,intensity=1"] for y in (-1, 1))
        first = figures(show(scene, "b", *above, patches=4).report)
        second = figures(show(scene, "b", *below, patches=4).report)
        again = figures(show(scene, "e", *above, patches=4).report)
        self.assertEqual((first["check.rows"], second["check.rows"], again["check.rows"]), (4, 4, 4))
        self.assertEqual((first["rows"], second["rows"]), (4, 8))    # kept with the scene

    def test_only_views_of_patches_are_checked(self):
        scene = load(rooms.uniform_room(daemon.folder, RHO), "room")
        self.assertIn("check", stages(show(scene, "b", patches=60, rays=64).report))
        # It was looked at before.
        self.assertNotIn("check", stages(show(scene, "e", patches=60, rays=64).report))
        picture = show(scene, "none", patches=66, rays=64).report
        self.assertNotIn("check", stages(picture))
        self.assertNotIn("sum.mean", figures(picture))


class Command(unittest.TestCase):
    def test_files_and_figures(self):
        scene = rooms.uniform_room(daemon.folder, RHO)
        answer = inspect(scene, "--set", "radiosity.patches=54", "--size", "40x30", "--format", "exr", "--json")
        self.assertEqual(figures(answer)["patches"], 54)
        self.assertLessEqual({"lookup", "check", "factors"}, stages(answer))
        images = {os.path.basename(i["image"]): i for i in answer["images"]}
        self.assertEqual(set(images), {f"i-{view}.exr" for view in VIEWS})
        for image in images.values():
            self.assertEqual(os.path.getsize(image["image"]), image["bytes"])
            self.assertEqual((image["kind"], image["width"], image["height"]), ("patches", 40, 30))
            self.assertNotIn("level", image)
        picture = {view: rgb(images[f"i-{view}.exr"]["image"]) for view in VIEWS}
        # All surfaces send radiance 1, half of it their own, and all are albedo 1/2.
        numpy.testing.assert_allclose(picture["b"], numpy.pi, rtol=2e-3)
        numpy.testing.assert_allclose(picture["e"], numpy.pi * (1 - RHO), rtol=2e-3)
        numpy.testing.assert_allclose(picture["albedo"], RHO, rtol=2e-3)
        self.assertEqual(len(numpy.unique(picture["row"].max(axis=(0, 1)))), 1)

    def test_pictures_and_lines(self):
        _, out, _ = inspect(rooms.uniform_room(daemon.folder, RHO), "--set", "radiosity.patches=54", "--size", "16x16",
                            "--set", "radiosity.row=3")
        for word in ("images     7", "patches    54", "factors", "row sums", "reciprocal", "solved", "time"):
            self.assertIn(word, out)
        with open(os.path.join(daemon.folder, "i.json")) as file:
            self.assertEqual(len(json.load(file)["images"]), 7)
        for view in VIEWS:
            with open(os.path.join(daemon.folder, f"i-{view}.png"), "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_light_is_as_bright_as_a_picture_can_show(self):
        """Of B 2 W/m² and more a PNG would show nothing but white: its exposure is chosen, and told; or it is the user's."""
        g = Gltf()
        for part, colour, corners in make.CORNELL:
            g.place(*quad(*corners), g.material(part, colour))
        g.place(*quad((-.3, 1.98, -.3), (.3, 1.98, -.3), (.3, 1.98, .3), (-.3, 1.98, .3)), g.material("lamp", (.3,) * 3, (200,) * 3))
        g.camera((0, 1, 3.9), (0, 1, 0), 39)
        scene = load(g.save(daemon.folder, "bright.gltf"), "bright")
        options = ["--set", "radiosity.patches=200", "--set", "radiosity.rays=64", "--size", "64x64"]
        _, out, _ = inspect(scene, *options)
        with open(os.path.join(daemon.folder, "i.json")) as file:
            answer = json.load(file)
        white = {i["show"]: i["white"] for i in answer["images"] if "white" in i}
        found = figures(answer)
        self.assertEqual(set(white), {"b", "e", "residual"})
        self.assertAlmostEqual(white["b"], found["reflected.most"], delta=1e-6 * white["b"])
        self.assertAlmostEqual(white["e"], found["b.most"], delta=1e-6 * white["e"])
        self.assertGreater(white["b"], 2)
        self.assertLess(white["b"], .9 * white["e"])
        self.assertLess(white["residual"], 1e-3 * white["b"])
        self.assertIn("W/m² in residual", out)
        for show in ("b", "residual"):
            pixels = rgb(os.path.join(daemon.folder, f"i-{show}.png"))
            # The largest residual may be where the camera does not look.
            self.assertGreater(float(pixels.max()), .94 if show == "b" else .3, show)
            if show == "b":
                self.assertLess(float((pixels.max(axis=2) >= 1).mean()), .05)
        answer = inspect(scene, *options, "--exposure", "-3", "--json")
        self.assertEqual({i["white"] for i in answer["images"] if "white" in i}, {8})

    def test_the_time_is_of_all_pictures_and_files(self):
        answer = inspect(rooms.uniform_room(daemon.folder, RHO), "--set", "radiosity.patches=54", "--size", "16x16", "--json")
        parts = answer["images"] + answer["files"]
        self.assertEqual(answer["elapsed_us"], sum(part["elapsed_us"] for part in parts))
        for stage in answer["stages"]:
            self.assertEqual(stage["us"], sum(s["us"] for part in parts for s in part["stages"] if s["name"] == stage["name"]))

    def test_what_is_imported(self):
        """Form factors have all pictures; a solution has none of form factors, and the answer says so."""
        scene = rooms.uniform_room(daemon.folder, RHO)
        arguments = ["--set", "radiosity.patches=54", "--size", "16x16"]
        made = inspect(scene, *arguments, "--json", prefix="made")
        self.assertEqual(made["left_out"], [])
        files = {file["file"].rsplit(".")[-1]: file["file"] for file in made["files"]}
        for kind, lacks in (("mtx", []), ("ply", ["residual", "row", "factors"])):
            answer = inspect(scene, *arguments, "--set", "radiosity.import=" + files[kind], "--json", prefix=kind)
            self.assertEqual(answer["left_out"], lacks, kind)
            self.assertEqual([i["show"] for i in answer["images"]], [i["show"] for i in made["images"] if i["show"] not in lacks])
            self.assertEqual(len(answer["files"]), 1 if lacks else 2)
            for file in answer["files"]:
                self.assertEqual(os.path.getsize(file["file"]), file["bytes"])
        # The patches of the solution are the file's to the bit.
        with open(files["ply"], "rb") as first, open(answer["files"][0]["file"], "rb") as second:
            self.assertEqual(first.read(), second.read())
        _, out, _ = inspect(scene, *arguments, "--set", "radiosity.import=" + files["ply"], prefix="ply")
        self.assertIn("left out   residual, row, factors: ", out)
        self.assertNotIn("nan", out)

    def test_wrong_command_lines(self):
        scene = rooms.uniform_room(daemon.folder, RHO)
        for wrong, word in ((["--set", "radiosity.show=b"], "radiosity.show is set by inspect"), (["-o", "-"], "several"),
                            (["--set", "radiosity.row=108", "--set", "radiosity.patches=54"], "elements 0 to 107"),
                            (["--set", "vct.level=1"], "vct.level"), (["--technique", "pt"], "patches")):
            status, _, said = inspect(scene, *wrong, check=False)
            self.assertEqual(status, 2, wrong)
            self.assertIn(word, said)


if __name__ == "__main__":
    unittest.main()
