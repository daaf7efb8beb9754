"""What radiosity wrote as a file is taken back in place of being made: the same bits of files and pictures, by numbers that are
nowhere but in the file, and refusals of what it is not of."""
import json
import os
import re
import subprocess
import time
import unittest

import numpy

from render import Daemon, Failed
from writers import Gltf, box, quad

daemon = Daemon()
OPTIONS = {"radiosity.patches": 200, "radiosity.rays": 256}
MAKING = {"surfaces", "import", "patch-light", "factors", "solve", "corners"}


def setUpModule():
    unittest.enterModuleContext(daemon)


def place(name):
    return os.path.join(daemon.folder, name)


def load(path, name):
    daemon.candil("load", path, "--name", name)
    return name


def settings(options):
    return [word for name, value in options.items() for word in ("--set", f"{name}={value}")]


def write(scene, file, *arguments, **options):
    """Have radiosity write a file. Its bytes."""
    path = place(file)
    daemon.candil("render", scene, "-o", path, "--technique", "radiosity", "--no-default-light", *settings({**OPTIONS, **options}),
                  *arguments)
    with open(path, "rb") as written:
        return written.read()


def picture(scene, *arguments, camera=None, size=(48, 48), **options):
    return daemon.render(scene, size=size, spp=1, camera=camera, arguments=["--technique", "radiosity", *arguments],
                         options={**OPTIONS, **options})


def figures(report):
    return {f["name"]: f["value"] for f in report["figures"]}


def stages(report):
    return {s["name"] for s in report["stages"]}


def bits(shown):
    return {name: values.tobytes() for name, values in shown.channels.items()}


def room(folder, name, lamp=(9, 8, 7), wall=(.7, .2, .1), mirror=False):
    g = Gltf()
    positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
    for i, albedo in enumerate(((.7, .7, .7), wall, (.2, .7, .3))):
        g.place(positions, triangles[4 * i:4 * i + 4], g.material(f"wall {i}", albedo))
    g.place(*box((-.5, 0, -.5), (.1, .6, .1)), g.material("box", (.4, .5, .6)))
    g.place([(.3, .2, 0), (.8, .2, 0), (.5, .9, -.3)], [(0, 1, 2)], g.material("sail", (.3, .6, .9)))
    g.place(*quad((-.3, 1.99, -.3), (.3, 1.99, -.3), (.3, 1.99, .3), (-.3, 1.99, .3)), g.material("lamp", (0, 0, 0), lamp))
    g.camera((0, 1, .95), (0, .9, -1), 75)
    return g.save(folder, name)


def refusal(*arguments):
    try:
        daemon.candil("render", *arguments)
    except Failed as failed:
        return failed.text
    raise AssertionError(f"not refused: {arguments}")


class Back(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = load(room(daemon.folder, "room.gltf"), "room")
        cls.ply, cls.mtx = write(cls.scene, "room.ply"), write(cls.scene, "room.mtx")
        cls.made = picture(cls.scene)
        load(place("room.ply"), "solution")
        load(place("room.mtx"), "factors")

    def test_files_give_themselves(self):
        for name in ("room.mtx", "factors"):
            self.assertEqual(write(self.scene, "again.mtx", **{"radiosity.import": place(name) if "." in name else name}), self.mtx)
        self.assertEqual(write(self.scene, "again.ply", **{"radiosity.import": "solution"}), self.ply)

    def test_pictures_have_the_same_bits(self):
        for options in ({}, {"radiosity.display": "constant"}, {"radiosity.display": "gather", "radiosity.gather": 4},
                        {"radiosity.show": "b"}, {"radiosity.show": "albedo"}):
            made = picture(self.scene, **options)
            self.assertGreater(made.mean(), 0)
            for name in ("solution", "factors"):
                taken = picture(self.scene, **options, **{"radiosity.import": name})
                self.assertEqual(bits(taken), bits(made), (options, name))
        row = {"radiosity.show": "row", "radiosity.row": 3}
        self.assertEqual(bits(picture(self.scene, **row, **{"radiosity.import": "factors"})), bits(picture(self.scene, **row)))

    def test_what_makes_factors_counts_for_nothing(self):
        for options in ({"radiosity.rays": 16}, {"radiosity.factors": "hemicube"}, {"radiosity.factors": "analytic"}):
            self.assertEqual(bits(picture(self.scene, **{**options, "radiosity.import": "factors"})), bits(self.made), options)

    def test_a_background(self):
        """What a row lacks of 1 escapes: but for the rounding of its sum the same light."""
        sky = ["--background", "1,2,3"]
        g = Gltf()
        g.place(*box((-.5, 0, -.5), (.1, .6, .1)), g.material("box", (.4, .5, .6)))
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.7, .7, .7)))
        g.camera((0, 2, 3), (0, .3, 0), 50)
        scene = load(g.save(daemon.folder, "yard.gltf"), "yard")
        write(scene, "yard.mtx", *sky)
        made, taken = picture(scene, *sky), picture(scene, *sky, **{"radiosity.import": place("yard.mtx")})
        numpy.testing.assert_allclose(taken.radiance, made.radiance, rtol=1e-5)
        self.assertEqual(bits(picture(scene, *sky, **{"radiosity.import": self.yard_ply(scene, sky)})), bits(made))

    @staticmethod
    def yard_ply(scene, sky):
        write(scene, "yard.ply", *sky)
        return place("yard.ply")

    def test_mirrors(self):
        """Rows whose sums are more than 1, and a limit that cuts light off."""
        g = Gltf()
        positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
        g.place(positions, triangles[:4], g.material("mirror", (.9, .9, .9), metallic=1, roughness=0))
        g.place(positions, triangles[4:], g.material("wall", (.5, .6, .7)))
        g.place(*quad((-.3, 1.9, -.3), (.3, 1.9, -.3), (.3, 1.9, .3), (-.3, 1.9, .3)), g.material("lamp", (0, 0, 0), (5, 5, 5)))
        g.camera((0, 1, .9), (0, .9, -1), 75)
        scene = load(g.save(daemon.folder, "mirrors.gltf"), "mirrors")
        few = {"radiosity.bounces": 2}
        files = {kind: write(scene, "mirrors." + kind, **few) for kind in ("mtx", "ply")}
        made = picture(scene, **few)
        for kind, data in files.items():
            file = {"radiosity.import": place("mirrors." + kind)}
            self.assertEqual(write(scene, "again." + kind, **few, **file), data)
            self.assertEqual(bits(picture(scene, **few, **file)), bits(made), kind)

    def test_a_second_picture_makes_nothing(self):
        other = (0, 1, .9, .3, .5, -1, 0, 1, 0, 60)
        seen = picture(self.scene, camera=other)
        for name in ("solution", "factors"):
            # Of the same content, whatever it is called.
            for called in (name, place("room.ply" if name == "solution" else "room.mtx")):
                first, again = (picture(self.scene, camera=camera, **{"radiosity.import": called}) for camera in (None, other))
                self.assertFalse(MAKING & stages(again.report), stages(again.report))
                self.assertEqual(figures(again.report)["rows.imported"], 0)
                self.assertEqual((bits(first), bits(again)), (bits(self.made), bits(seen)))

    def test_what_is_told(self):
        scene = load(room(daemon.folder, "told.gltf", wall=(.6, .3, .1)), "told")
        write(scene, "told.mtx"), write(scene, "told.ply")
        daemon.candil("unload", "told")
        load(place("told.gltf"), "told")
        factors = picture(scene, **{"radiosity.import": place("told.mtx")})
        self.assertEqual(figures(factors.report)["rows.imported"], figures(factors.report)["rows"])
        self.assertIn("factors", stages(factors.report))
        solution = picture(scene, **{"radiosity.import": place("told.ply")})
        self.assertEqual(figures(solution.report)["rows.imported"], 0)
        self.assertTrue({"surfaces", "import"} <= stages(solution.report))
        self.assertFalse({"patch-light", "factors", "solve"} & stages(solution.report))
        for shown in (factors, solution):
            self.assertTrue([note for note in shown.report["notes"] if "imported file" in note], shown.report["notes"])
            self.assertRegex(shown.metadata["candil/import_hash"], "^[0-9a-f]{32}$")
        self.assertNotIn("candil/import_hash", self.made.metadata)

    def test_a_sweep_and_a_quote(self):
        cameras = place("cameras.json")
        with open(cameras, "w") as file:
            json.dump([{"eye": [0, 1, .95], "target": [0, .9, -1], "vfov": 75}, {"eye": [0, 1, .9], "target": [.3, .5, -1], "vfov": 60}],
                      file)
        common = ["--technique", "radiosity", "--size", "48x48", "--spp", "1", "--no-default-light",
                  *settings({**OPTIONS, "radiosity.import": "factors"})]
        daemon.candil("sweep", self.scene, "-o", place("s-{index}.exr"), "--cameras", cameras, "--float", *common)
        self.assertEqual(sorted(f for f in os.listdir(daemon.folder) if f.startswith("s-")), ["s-0.exr", "s-1.exr"])
        _, out, _ = daemon.candil("quote", self.scene, "--json", *common[:4], *common[7:])
        self.assertEqual(json.loads(out)["technique"], "radiosity")


class Numbers(unittest.TestCase):
    def test_factors_by_hand(self):
        """Two plates that see each other by factors that nobody would find: B of each is what a system of two says."""
        g = Gltf()
        g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("floor", (.5, .25, .125)))
        g.place(*quad((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1)), g.material("lid", (.25, .5, .75), (2, 4, 8)))
        g.camera((0, 1, 3), (0, 1, 0), 90)
        scene = load(g.save(daemon.folder, "plates.gltf"), "plates")
        one = {"radiosity.patches": 2, "radiosity.emitters": "factors", "radiosity.residual": 1e-7}
        head = write(scene, "plates.mtx", **one).decode()
        self.assertIn("\n4 4 ", head)
        with open(place("by-hand.mtx"), "w") as file:
            file.write("%%MatrixMarket matrix coordinate real general\n4 4 2\n2 1 0.375\n1 2 0.625\n")
        shown = picture(scene, **one, **{"radiosity.import": place("by-hand.mtx"), "radiosity.show": "b"})
        emitted = numpy.pi * numpy.array((2, 4, 8))
        floor, lid = numpy.array((.5, .25, .125)), numpy.array((.25, .5, .75))
        b_lid = emitted / (1 - floor * lid * .625 * .375)
        b_floor = floor * .625 * b_lid
        for expected in (b_lid, b_floor):
            apart = numpy.abs(shown.radiance - expected).max(axis=2)
            self.assertGreater((apart < 1e-5 * expected.max()).sum(), 20, expected)

    def test_light_by_hand(self):
        """H of a file that was doubled is what is shown, whatever lights the request has."""
        scene = load(room(daemon.folder, "hand.gltf"), "hand")
        data = write(scene, "hand.ply")
        head, end, body = data.partition(b"end_header\n")
        vertices = int(re.search(rb"element vertex (\d+)", head).group(1))
        names = [line.split()[1:] for line in head.decode().splitlines() if line.startswith("property ")][4:]
        kinds = numpy.dtype([(name, {"uchar": "u1", "uint": "<u4", "float": "<f4"}[kind]) for kind, name in names])
        doubled, at = bytearray(body), vertices * 24
        while at < len(body):
            at += 1 + 4 * body[at]
            of = numpy.frombuffer(doubled, kinds, 1, at)
            for c in "rgb":
                of["h_" + c] *= 2
                of["b_" + c] = of["m_" + c] + of["rho_" + c] * of["h_" + c]
            at += kinds.itemsize
        with open(place("doubled.ply"), "wb") as file:
            file.write(head + end + doubled)
        for more in ([], ["--light", "point:at=0,1,0,intensity=100"]):
            flat = {"radiosity.display": "constant"}
            once = picture(scene, *more, **flat, **{"radiosity.import": place("hand.ply")})
            twice = picture(scene, *more, **flat, **{"radiosity.import": place("doubled.ply")})
            lamps = once.radiance.max(axis=2) > 6.9
            self.assertGreater((~lamps).sum(), 1000)
            numpy.testing.assert_allclose(twice.radiance[~lamps], 2 * once.radiance[~lamps], rtol=1e-6)
            numpy.testing.assert_array_equal(twice.radiance[lamps], once.radiance[lamps])


class Refused(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = load(room(daemon.folder, "refusing.gltf"), "refusing")
        cls.other = load(room(daemon.folder, "other.gltf", lamp=(1, 1, 1)), "other")
        for kind in ("ply", "mtx"):
            write(cls.scene, "r." + kind)
            load(place("r." + kind), "r-" + kind)

    def ask(self, scene, file, *arguments, technique="radiosity", **options):
        return refusal(scene, "-o", place("x.exr"), "--size", "8x8", "--technique", technique,
                       *settings({**(OPTIONS if technique == "radiosity" else {}), **options}), *settings({"radiosity.import": file}),
                       *arguments)

    def test_other_patches(self):
        for file in ("r-ply", "r-mtx"):
            said = self.ask(self.scene, file, **{"radiosity.patches": 400})
            self.assertIn("radiosity.patches", said)
            self.assertEqual(len(re.findall(r"\b\d{3,}\b", said)), 2, said)

    def test_other_scenes(self):
        self.assertIn("emits other light", self.ask(self.other, "r-ply"))
        self.assertIn("reflects otherwise", self.ask(self.scene, "r-ply", "--material", "wall 1:color=.1,.2,.3"))
        self.assertIn("elsewhere", self.ask(self.scene, "r-ply", "--node", "#0:translate=0,.25,0"))
        self.assertIn("emits other light", self.ask(self.scene, "r-ply", "--effects", "auto,-emitters"))

    def test_other_kinds(self):
        self.assertIn("radiosity.import", self.ask("r-mtx", "r-mtx"))
        for name in ("r-ply", "r-mtx"):
            self.assertIn("no scene", refusal(name, "-o", place("x.exr"), "--size", "8x8"))
            self.assertIn("needs radiosity", self.ask(self.scene, name, technique="pt"))
            self.assertIn("no picture of surroundings", refusal(self.scene, "-o", place("x.exr"), "--background", name))
        self.assertIn("no file of patches", self.ask(self.scene, self.other))
        self.assertIn("no file named", self.ask(self.scene, place("nowhere.mtx")))

    def test_without_factors(self):
        self.assertIn("no form factors", self.ask(self.scene, "r-ply", **{"radiosity.show": "row"}))
        self.assertIn("no form factors", refusal(self.scene, "-o", place("x.mtx"), "--technique", "radiosity",
                                                 *settings({**OPTIONS, "radiosity.import": "r-ply"})))

    def test_files_that_are_none(self):
        with open(place("r.ply"), "rb") as file:
            data = file.read()
        for name, broken in (("cut.ply", data[:-7]), ("cut.mtx", b"%%MatrixMarket matrix coordinate real general\n4 4 9\n1 1 .5\n"),
                             ("nan.mtx", b"%%MatrixMarket matrix coordinate real general\n4 4 1\n1 1 nan\n")):
            with open(place(name), "wb") as file:
                file.write(broken)
            self.assertTrue(self.ask(self.scene, place(name)))
        self.assertEqual(daemon.stats()["worker_starts"], 1)

    def test_twice(self):
        status, _, said = daemon.candil("render", self.scene, "-o", place("x.exr"), *settings({"radiosity.import": "a"}),
                                        "--set", "radiosity.import=b", check=False)
        self.assertEqual(status, 2, said)


class Gone(unittest.TestCase):
    def test_unloaded_and_replaced_while_in_use(self):
        """A job keeps what it began with, and a name means what was loaded last."""
        scene = load(room(daemon.folder, "used.gltf"), "used")
        first, second = load(room(daemon.folder, "first.gltf"), "first"), place("used.mtx")
        write(scene, "used.mtx")
        expected = picture(scene)
        file = load(second, "file")
        slow = {**OPTIONS, "radiosity.display": "gather", "radiosity.gather": 64, "radiosity.import": "file"}
        command = ["render", scene, "--technique", "radiosity", "--no-default-light", "--float", "--spp", "2", *settings(slow)]
        job = subprocess.Popen([os.path.join(daemon.programs, "candil"), "--connect", daemon.socket, *command, "--size", "160x160",
                                "-o", place("slow.exr")], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
        while job.poll() is None and daemon.stats()["jobs"] == 0:
            time.sleep(0.01)
        daemon.candil("unload", file)
        self.assertIsNone(job.poll())
        # Another file of that name: of the same scene with another lamp, so that its picture is another.
        with open(second, "rb") as source:
            lines = source.read().split(b"\n")
        with open(place("half.mtx"), "wb") as half:
            start = next(i for i, line in enumerate(lines) if not line.startswith(b"%"))
            for line in lines[:start + 1]:
                half.write(line + b"\n")
            for line in filter(None, lines[start + 1:]):
                i, j, value = line.split()
                half.write(b"%s %s %.9g\n" % (i, j, float(value) / 2))
        load(place("half.mtx"), "file")
        dimmer = picture(scene, **{"radiosity.import": "file"})
        self.assertLess(dimmer.mean(), 0.9 * expected.mean())
        self.assertEqual(job.wait(timeout=590), 0, job.stderr.read())
        job.stderr.close()
        self.assertEqual(bits(picture(scene, **{"radiosity.import": second})), bits(expected))
        self.assertTrue(first)


if __name__ == "__main__":
    unittest.main()
