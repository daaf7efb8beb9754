"""The patches and the form factors of a scene as files: read back by numpy they are what the figures say, what pictures show, and
solve the system that radiosity is. And loaded by the service itself they are what numpy has read, bit for bit."""
import json
import os
import re
import subprocess
import unittest

import numpy

import make
import rooms
from images import rgb
from loader import LOADER
from render import Daemon, Failed
from writers import Gltf, box, quad

daemon = Daemon()
TYPES = {"uchar": "u1", "uint": "<u4", "float": "<f4", "double": "<f8"}


def setUpModule():
    unittest.enterModuleContext(daemon)


class Ply:
    """A binary PLY of polygons: `corners` (n, 3), `faces`, a list of arrays of numbers of corners, and the faces' other properties
    by name."""

    def __init__(self, data):
        head, _, body = data.partition(b"end_header\n")
        lines = head.decode().splitlines()
        assert lines[:2] == ["ply", "format binary_little_endian 1.0"], lines[:2]
        count = {name: int(number) for name, number in re.findall(r"^element (\w+) (\d+)$", head.decode(), re.MULTILINE)}
        names = [line.split()[1:] for line in lines if line.startswith("property ")]
        assert names[:3] == [["double", axis] for axis in "xyz"] and names[3] == ["list", "uchar", "uint", "vertex_indices"]
        kinds = numpy.dtype([(name, TYPES[kind]) for kind, name in names[4:]])
        self.corners = numpy.frombuffer(body, "<f8", 3 * count["vertex"]).reshape(-1, 3)
        at = self.corners.nbytes
        self.faces, rows = [], []
        for _ in range(count["face"]):
            self.faces.append(numpy.frombuffer(body, "<u4", body[at], at + 1))
            at += 1 + self.faces[-1].nbytes
            rows.append(numpy.frombuffer(body, kinds, 1, at)[0])
            at += kinds.itemsize
        assert at == len(body), (at, len(body))
        self.of = numpy.array(rows, dtype=kinds)

    def colour(self, name):
        return numpy.stack([self.of[f"{name}_{c}"] for c in "rgb"], axis=1)

    def area(self, face):
        """And normal, seen counter-clockwise."""
        points = self.corners[self.faces[face]]
        cross = sum(numpy.cross(points[i] - points[0], points[i + 1] - points[0]) for i in range(1, len(points) - 1))
        return numpy.linalg.norm(cross) / 2, cross / numpy.linalg.norm(cross)


def read_mtx(text):
    """(dense matrix of float32, number of entries)"""
    lines = text.splitlines()
    assert lines[0] == "%%MatrixMarket matrix coordinate real general"
    lines = [line for line in lines if not line.startswith("%")]
    rows, columns, entries = map(int, lines[0].split())
    assert rows == columns and len(lines) == entries + 1
    matrix = numpy.zeros((rows, columns), dtype=numpy.float32)
    for line in lines[1:]:
        i, j, value = line.split()
        assert matrix[int(i) - 1, int(j) - 1] == 0
        matrix[int(i) - 1, int(j) - 1] = numpy.float32(value)
    return matrix, entries


# As server/scene/patch_format.h has an element, a row and an entry, and the numbers of their sections in a blob.
COLOURS = ("b", "m", "d", "rho", "h")
ELEMENT = numpy.dtype([("corner", "<f8", (4, 3)), ("patch", "<u4"), ("material", "<u4"), ("area", "<f4"), *((name, "<f4", 3) for name in COLOURS),
                       ("escaped", "<f4"), ("cut", "<f4"), ("corners", "u1"), ("side", "u1"), ("straight", "u1"), ("reached", "u1"), ("", "<u4")])
ROW, ENTRY = numpy.dtype([("first", "<u4"), ("count", "<u4")]), numpy.dtype([("column", "<u4"), ("value", "<f4")])
ELEMENTS, ROWS, ENTRIES = 22, 23, 24


def section_of(path, *wanted):
    """Sections of the blob that the loader makes of a file: of each (number, dtype) an array."""
    blob = os.path.join(daemon.folder, "blob")
    subprocess.run([LOADER, "--describe", "--dir", daemon.folder, "--file", os.path.basename(path), "--blob", blob], check=True,
                   stdout=subprocess.DEVNULL)
    with open(blob, "rb") as file:
        data = file.read()
    for number, kind in wanted:
        offset, count = numpy.frombuffer(data, "<u8", 2, 24 + 16 * number)
        yield numpy.frombuffer(data, kind, int(count), int(offset))


def load(path, name):
    daemon.candil("load", path, "--name", name)
    return name


def file_of(scene, extension, *arguments, **options):
    """Its bytes, and the report."""
    path = os.path.join(daemon.folder, "file." + extension)
    settings = [word for name, value in options.items() for word in ("--set", f"radiosity.{name}={value}")]
    _, out, _ = daemon.candil("render", scene, "-o", path, "--technique", "radiosity", "--json", "--no-default-light", *settings,
                              *arguments)
    with open(path, "rb") as file:
        return file.read(), json.loads(out)


def shown(scene, options):
    """Its patches, b of each, with the figures that go with them."""
    return daemon.render(scene, size=(64, 64), spp=1, arguments=["--technique", "radiosity"],
                         options={"radiosity.show": "b", **{"radiosity." + name: value for name, value in options.items()}})


def figures(report):
    return {f["name"]: f["value"] for f in report["figures"]}


def lit_room(folder):
    """A room with a lamp, a box and a triangle in it, walls of three colours."""
    g = Gltf()
    positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
    for i, albedo in enumerate(((.7, .7, .7), (.7, .2, .1), (.2, .7, .3))):
        g.place(positions, triangles[4 * i:4 * i + 4], g.material(f"wall {i}", albedo))
    g.place(*box((-.5, 0, -.5), (.1, .6, .1)), g.material("box", (.4, .5, .6)))
    g.place([(.3, .2, 0), (.8, .2, 0), (.5, .9, -.3)], [(0, 1, 2)], g.material("sail", (.3, .6, .9)))
    g.place(*quad((-.3, 1.99, -.3), (.3, 1.99, -.3), (.3, 1.99, .3), (-.3, 1.99, .3)), g.material("lamp", (0, 0, 0), (9, 8, 7)))
    g.camera((0, 1, .95), (0, .9, -1), 75)
    return g.save(folder, "lit_room.gltf")


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = load(lit_room(daemon.folder), "lit")
        options = dict(patches=300, rays=256, residual=1e-6)
        cls.ply_bytes, cls.ply_report = file_of(cls.scene, "ply", **options)
        cls.ply = Ply(cls.ply_bytes)
        cls.mtx_bytes, cls.mtx_report = file_of(cls.scene, "mtx", **options)
        cls.matrix, cls.entries = read_mtx(cls.mtx_bytes.decode())
        cls.picture = shown(cls.scene, options)
        cls.found = figures(cls.picture.report)

    def test_as_many_as_the_figures_say(self):
        patches = self.found["patches"]
        self.assertEqual((len(self.ply.faces), self.matrix.shape), (2 * patches, (2 * patches, 2 * patches)))
        self.assertEqual(self.entries, self.found["check.factors"])
        self.assertEqual(int(self.ply.of["reached"].sum()), self.found["check.rows"])
        for report, kind in ((self.ply_report, "ply"), (self.mtx_report, "mtx")):
            self.assertEqual(report["format"], kind)
            self.assertIsNone(report["verdict"])
            self.assertIn("write", {s["name"] for s in report["stages"]})

    def saved(self, name, data):
        path = os.path.join(daemon.folder, name)
        with open(path, "wb") as file:
            file.write(data)
        return path

    def test_the_loader_reads_the_patches(self):
        path = self.saved("again.ply", self.ply_bytes)
        info = json.loads(daemon.candil("load", path, "--name", "patches", "--json")[1])
        self.assertEqual((info["patch_elements"], info["factor_rows"], info["facts"]), (len(self.ply.faces), 0, ["patches"]))
        self.assertIn(f"patches     of a radiosity solution, {len(self.ply.faces)} sides", daemon.candil("describe", "patches")[1])
        (found,) = section_of(path, (ELEMENTS, ELEMENT))
        for name in ("patch", "side", "material", "area", "straight", "reached", "escaped", "cut"):
            numpy.testing.assert_array_equal(found[name], self.ply.of[name], name)
        for name in COLOURS:
            self.assertEqual(found[name].tobytes(), numpy.ascontiguousarray(self.ply.colour(name)).tobytes(), name)
        for element, face in zip(found, self.ply.faces):
            self.assertEqual(element["corners"], len(face))
            numpy.testing.assert_array_equal(element["corner"][:len(face)], self.ply.corners[face])
        self.assertEqual({3, 4}, set(found["corners"].tolist()))
        # B is what it is said to be of H.
        numpy.testing.assert_array_equal(found["b"], found["m"] + found["rho"] * found["h"])

    def test_the_loader_reads_the_factors(self):
        path = self.saved("again.mtx", self.mtx_bytes)
        info = json.loads(daemon.candil("load", path, "--name", "factors", "--json")[1])
        self.assertEqual((info["patch_elements"], info["factor_rows"], info["factor_entries"], info["facts"], info["warnings"]),
                         (0, len(self.matrix), self.entries, ["form factors"], []))
        self.assertIn(f"{len(self.matrix)} rows, {self.entries} entries", daemon.candil("describe", "factors")[1])
        rows, entries = section_of(path, (ROWS, ROW), (ENTRIES, ENTRY))
        matrix = numpy.zeros_like(self.matrix)
        for i, (first, count) in enumerate(rows):
            matrix[i, entries["column"][first:first + count]] = entries["value"][first:first + count]
        self.assertEqual(matrix.tobytes(), self.matrix.tobytes())
        # Another program may sort them by columns.
        lines = self.mtx_bytes.splitlines(True)
        begin = sum(line.startswith(b"%") for line in lines) + 1
        head, lines = lines[:begin], lines[begin:]
        sorted_path = self.saved("sorted.mtx", b"".join(head + sorted(lines, key=lambda line: int(line.split()[1]))))
        again = section_of(sorted_path, (ROWS, ROW), (ENTRIES, ENTRY))
        for was, now in zip((rows, entries), again):
            self.assertEqual(was.tobytes(), now.tobytes())

    def test_row_sums_are_those_of_the_figures(self):
        reached = self.ply.of["reached"] == 1
        sums = self.matrix.sum(axis=1, dtype=numpy.float64)
        self.assertEqual(float(numpy.abs(sums[~reached]).max()), 0)
        for name, value in (("least", sums[reached].min()), ("mean", sums[reached].mean()), ("most", sums[reached].max())):
            self.assertAlmostEqual(self.found["sum." + name], value, delta=1e-12)
        all_of_it = (sums + self.ply.of["escaped"] + self.ply.of["cut"])[reached]
        numpy.testing.assert_allclose(all_of_it, 1, atol=1e-5)
        self.assertAlmostEqual(self.found["sum.all.mean"], all_of_it.mean(), delta=1e-12)

    def test_reciprocity_is_that_of_the_figures(self):
        # Hemicubes see whole patches. Rows by rays are of what is open of them, which a file does not tell.
        options = dict(patches=300, factors="hemicube", hemicube=16, origins=1)
        ply = Ply(file_of(self.scene, "ply", **options)[0])
        matrix = read_mtx(file_of(self.scene, "mtx", **options)[0].decode())[0]
        found = figures(shown(self.scene, options).report)
        reached = ply.of["reached"] == 1
        flux = ply.of["area"].astype(numpy.float64)[:, None] * matrix
        flux[~reached] = flux[:, ~reached] = 0
        numpy.fill_diagonal(flux, 0)
        larger = numpy.maximum(flux, flux.T)
        self.assertAlmostEqual(found["reciprocity.mean"], numpy.abs(flux - flux.T).sum() / larger.sum(), delta=1e-9)
        self.assertEqual(found["reciprocity.pairs"], int((larger > 0).sum()) / 2)

    def test_values_are_those_of_the_figures(self):
        values = self.matrix[self.matrix > 0]
        self.assertEqual(self.found["values.1e-1"], int((values >= numpy.float32(1e-1)).sum()))
        self.assertEqual(self.found["values.1e-2"],
                         int(((values >= numpy.float32(1e-2)) & (values < numpy.float32(1e-1))).sum()))

    def test_patches_are_what_they_are(self):
        count = len(self.ply.faces) // 2
        total = 0
        for i in range(2 * count):
            area, normal = self.ply.area(i)
            self.assertAlmostEqual(area, self.ply.of["area"][i], delta=1e-6)
            self.assertEqual((self.ply.of["patch"][i], self.ply.of["side"][i]), (i % count, i // count))
            numpy.testing.assert_allclose(normal, -self.ply.area((i + count) % (2 * count))[1], atol=1e-6)
            total += area
        # Two sides of a room of 2 x 2 x 2, of a box, a triangle and a lamp.
        sail = numpy.linalg.norm(numpy.cross((.5, 0, 0), (.2, .7, -.3))) / 2
        self.assertAlmostEqual(total / 2, 6 * 4 + 6 * .36 + sail + .36, delta=1e-5)
        self.assertEqual(sorted({len(face) for face in self.ply.faces}), [3, 4])

    def test_they_solve_the_system(self):
        """B = M + rho (D + F (B - s M)), which nothing but the two files says; light of lamps straight from them and by F."""
        sun = ["--light", "directional:direction=-1,-3,-2,intensity=2"]
        for emitters, more in (("points", []), ("factors", []), ("factors", sun), ("points", ["--background", ".1,.2,.3"])):
            options = dict(patches=200, rays=256, residual=1e-6, emitters=emitters)
            ply = Ply(file_of(self.scene, "ply", *more, **options)[0])
            matrix = read_mtx(file_of(self.scene, "mtx", *more, **options)[0].decode())[0].astype(numpy.float64)
            b, m, d, rho = (ply.colour(name).astype(numpy.float64) for name in ("b", "m", "d", "rho"))
            straight = ply.of["straight"][:, None].astype(numpy.float64)
            self.assertEqual(set(straight[:, 0]), {float(emitters == "points")})
            solved = numpy.empty_like(b)
            for c in range(3):
                given = m[:, c] + rho[:, c] * (d[:, c] - matrix @ (straight[:, 0] * m[:, c]))
                solved[:, c] = numpy.linalg.solve(numpy.eye(len(b)) - rho[:, c, None] * matrix, given)
            numpy.testing.assert_allclose(b, solved, atol=1e-4 * solved.max())
            self.assertAlmostEqual(float(m.max()), 9 * numpy.pi, delta=1e-4)
            if more:
                continue
            # Light is neither lost nor gained: what arrives in a closed room and is not reflected is what the lamp sends.
            area = ply.of["area"].astype(numpy.float64)[:, None]
            arrived = d + matrix @ (b - straight * m)
            numpy.testing.assert_allclose((area * (1 - rho) * arrived).sum(axis=0), (area * m).sum(axis=0), rtol=0.1)

    def test_a_picture_shows_the_same_floats(self):
        known = {row.tobytes() for row in self.ply.colour("b")}
        seen = {pixel.tobytes() for pixel in self.picture.radiance.reshape(-1, 3)}
        self.assertGreater(len(seen), 50)
        self.assertLessEqual(seen, known)

    def test_the_residual_that_a_picture_shows(self):
        """|B - M - rho (D + F (B - s M))| by the two files, element by element, of a solver that ended early; and less of it where
        it goes on."""
        most = []
        for residual, emitters in ((1e-1, "factors"), (1e-3, "points"), (1e-5, "factors")):
            options = dict(patches=200, rays=256, emitters=emitters, solver="jacobi", residual=residual)
            ply = Ply(file_of(self.scene, "ply", **options)[0])
            matrix = read_mtx(file_of(self.scene, "mtx", **options)[0].decode())[0].astype(numpy.float64)
            b, m, d, rho = (ply.colour(name).astype(numpy.float64) for name in ("b", "m", "d", "rho"))
            right = numpy.abs(b - m - rho * (d + matrix @ (b - ply.of["straight"][:, None] * m)))
            seen = {what: daemon.render(self.scene, size=(48, 48), spp=1, arguments=["--technique", "radiosity"],
                                        options={f"radiosity.{k}": v for k, v in {**options, "show": what}.items()})
                    for what in ("b", "residual")}
            self.assertIn("residual", {s["name"] for s in seen["residual"].report["stages"]})
            self.assertNotIn("residual", {s["name"] for s in seen["b"].report["stages"]})
            elements = {}
            for element, row in enumerate(ply.colour("b")):
                elements.setdefault(row.tobytes(), []).append(element)
            compared = 0
            for of, value in zip(seen["b"].radiance.reshape(-1, 3), seen["residual"].radiance.reshape(-1, 3)):
                errors = [float(numpy.abs(right[element] - value).max()) for element in elements.get(of.tobytes(), ())]
                if of.any() and errors:
                    self.assertLess(min(errors), 1e-6 * float(b.max()))
                    compared += 1
            self.assertGreater(compared, 1000)
            most.append(float(seen["residual"].radiance.max()) / float(b.max()))
            self.assertLess(most[-1], residual)
        self.assertGreater(most[0], 1e-4)
        print("largest residual over the largest B:", most)
        self.assertEqual(most, sorted(most, reverse=True))

    def test_the_same_bytes_whatever_was_asked_for_before(self):
        options = dict(patches=100, rays=64)
        g = Gltf()
        g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("floor", (.5,) * 3))
        g.place(*quad((-1, 2, 1), (1, 2, 1), (1, 2, -1), (-1, 2, -1)), g.material("shelf", (.5,) * 3))
        g.camera((0, 1, 3), (0, 1, 0), 60)
        path = g.save(daemon.folder, "shelves.gltf")
        above, below = (["--light", f"point:at=0,{y},0,intensity=1"] for y in (3, 1))
        fresh = [file_of(load(path, "fresh"), kind, *above, **options)[0] for kind in ("ply", "mtx")]
        used = load(path, "used")
        file_of(used, "mtx", *below, **options)
        self.assertEqual([file_of(used, kind, *above, **options)[0] for kind in ("ply", "mtx")], fresh)


class Command(unittest.TestCase):
    def test_inspect_writes_both(self):
        scene = load(rooms.uniform_room(daemon.folder, .5), "room")
        prefix = os.path.join(daemon.folder, "i")
        status, out, _ = daemon.candil("inspect", scene, "--technique", "radiosity", "-o", prefix, "--set", "radiosity.patches=54",
                                       "--set", "radiosity.row=0", "--size", "16x16")
        self.assertIn("i-patches.ply", out)
        with open(prefix + ".json") as file:
            answer = json.load(file)
        found = figures(answer)
        self.assertEqual([os.path.basename(f["file"]) for f in answer["files"]], ["i-patches.ply", "i-factors.mtx"])
        for entry in answer["files"]:
            self.assertEqual(os.path.getsize(entry["file"]), entry["bytes"])
        with open(answer["files"][0]["file"], "rb") as file:
            ply = Ply(file.read())
        with open(answer["files"][1]["file"]) as file:
            matrix, entries = read_mtx(file.read())
        self.assertEqual(entries, found["check.factors"])
        reached = ply.of["reached"] == 1
        self.assertAlmostEqual(matrix.sum(axis=1, dtype=numpy.float64)[reached].min(), found["sum.least"], delta=1e-12)
        # Every wall sends radiance 1, from 24 m² of fronts.
        flux = (ply.of["area"][:, None] * ply.colour("b")).sum(axis=0, dtype=numpy.float64)
        numpy.testing.assert_allclose(flux, 24 * numpy.pi, rtol=1e-4)

    def test_the_technique_that_writes_them_is_taken(self):
        scene = rooms.uniform_room(daemon.folder, .5)
        for more in ([], ["--technique", "auto"]):
            path = os.path.join(daemon.folder, "auto.ply")
            _, out, _ = daemon.candil("render", scene, "-o", path, "--json", "--set", "radiosity.patches=54",
                                      "--set", "radiosity.rays=16", *more)
            self.assertEqual(json.loads(out)["technique"], "radiosity")
            with open(path, "rb") as file:
                self.assertEqual(len(Ply(file.read()).faces), 108)

    def test_what_cannot_be(self):
        scene = make.cornell(daemon.folder)
        for arguments, word in ((["-o", "x.ply", "--technique", "pt"], "needs radiosity"), (["-o", "x.mtx", "--technique", "vct"], "needs radiosity"),
                                (["-o", "x.ply", "--technique", "radiosity", "--time", "1000"], "leave --progressive and --time out"),
                                (["-o", "x.ply", "--technique", "radiosity", "--aov", "id"], "--aov"),
                                (["-o", "x.ply", "--technique", "radiosity", "--exposure", "1"], "PNG"),
                                (["-o", "x.obj", "--technique", "radiosity"], ".mtx")):
            with self.assertRaises(Failed) as caught:
                daemon.candil("render", scene, *arguments)
            self.assertIn(word, caught.exception.text)
        for command in (["sweep", "--orbit", "3", "-o", "x-%d.ply"], ["inspect", "-o", "x", "--format", "ply"],
                        ["quote", "--format", "mtx"]):
            status, _, said = daemon.candil(command[0], scene, *command[1:], check=False)
            self.assertEqual(status, 2, said)


if __name__ == "__main__":
    unittest.main()
