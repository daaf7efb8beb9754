"""A scene as the loader leaves it: what `--describe` says, and the blob, for tests to look into."""
import json
import os
import struct
import subprocess
import tempfile
import unittest

WANTS_IMAGES = 3  # exit code of the loader
LOADER = os.path.join(os.environ["CANDIL_BUILD"], "libexec", "candil", "candil-loader")
MANY = os.path.join(os.environ["CANDIL_BUILD"], "tests", "load_many")
SECTIONS = ["nodes", "leaf_triangles", "triangles", "vertices", "materials", "textures", "texels", "emitters", "lights",
            "cameras", "names", "uv1", "colors", "tangents"]
FORMATS = {"triangles": "<4I", "vertices": "<8f", "materials": "<3fI3fI3fIfIffIIffIfffIf3f3f3If", "textures": "<4I3f3f", "texels": "<I",
           "emitters": "<IfIf", "lights": "<3fI3ff3fffIff", "uv1": "<2f", "colors": "<4f", "tangents": "<4f"}
# Where a material's fields lie in its tuple.
(ALBEDO, EMISSION, SPECULAR, WEIGHT, WEIGHT_TEXTURE, METALLIC, ROUGHNESS, SURFACE, NORMAL, SCALE, CUTOFF, FLAGS, POWER, ALPHA, TRANSMISSION,
 CLEAR_TEXTURE, IOR, ABSORPTION, MATTE, COAT, COAT_ROUGHNESS, COAT_TEXTURE, COAT_ROUGHNESS_TEXTURE, COAT_NORMAL,
 COAT_SCALE) = (0, 4, 8, *range(12, 27), *range(29, 36))
NONE = 0xFFFFFFFF


class Blob:
    """The sections of a blob that the tests read, as lists of tuples (server/scene/blob.h)."""

    def __init__(self, data):
        self.data = data
        ranges = struct.unpack_from("<%dQ" % (2 * len(SECTIONS)), data, 24)
        for i, name in enumerate(SECTIONS):
            if name in FORMATS:
                size = struct.calcsize(FORMATS[name])
                setattr(self, name, [struct.unpack_from(FORMATS[name], data, ranges[2 * i] + k * size)
                                     for k in range(ranges[2 * i + 1])])

    def corner(self, triangle, k):
        return self.vertices[self.triangles[triangle][k]]

    def normal(self, triangle):
        a, b, c = (self.corner(triangle, k)[:3] for k in range(3))
        u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
        return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


class LoadCase(unittest.TestCase):
    """Has the loader in a process that stays (load_many.c), and a folder."""

    @classmethod
    def setUpClass(cls):
        cls.many = subprocess.Popen([MANY], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(cls.end_many)

    @classmethod
    def end_many(cls):
        cls.many.communicate()
        assert cls.many.returncode == 0, "load_many ended with %d" % cls.many.returncode

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def try_load(self, path):
        """Whether a file loads, and what the loader says: a description in JSON, or what is wrong."""
        self.many.stdin.write("\t".join((os.path.dirname(path), os.path.basename(path), os.path.join(self.folder, "blob"))) + "\n")
        self.many.stdin.flush()
        lines = []
        for line in self.many.stdout:
            if line in ("loaded\n", "refused\n"):
                return line == "loaded\n", "".join(lines)
            lines.append(line)
        self.fail("load_many ended over " + path)

    def load(self, path, *more):
        """Load a file; with more arguments, by candil-loader itself."""
        blob = os.path.join(self.folder, "blob")
        if more:
            done = subprocess.run([LOADER, "--describe", "--dir", os.path.dirname(path), "--file", os.path.basename(path), "--blob", blob,
                                   *more], capture_output=True, timeout=120, text=True)
            loaded, said = done.returncode == 0, done.stdout or done.stderr
        else:
            loaded, said = self.try_load(path)
        self.assertTrue(loaded, said)
        with open(blob, "rb") as file:
            return json.loads(said), Blob(file.read())

    def near(self, got, want, places=6):
        self.assertEqual(len(got), len(want))
        for g, w in zip(got, want):
            self.assertAlmostEqual(g, w, places, (got, want))
