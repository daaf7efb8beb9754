"""Lamps whose light comes from few texels of a texture: each way of sampling gives the closed form's light, and points on them are
chosen where the texture is bright."""
import math
import struct
import unittest
import zlib

import numpy

from render import Daemon
from writers import Gltf, quad

daemon = Daemon()
NEAREST, LINEAR = 9728, 9729
REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
SIZE = 8
HEIGHT = 1.0


def setUpModule():
    unittest.enterModuleContext(daemon)


def grey_png(values):
    """Of a uint8 array of rows."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = numpy.concatenate((numpy.zeros((len(values), 1), numpy.uint8), values), axis=1).tobytes()
    head = struct.pack(">IIBBBBB", values.shape[1], values.shape[0], 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")


def one_bright(side, x, y):
    values = numpy.zeros((side, side), numpy.uint8)
    values[y, x] = 255
    return values


def panel(g, values, filtered=NEAREST, uvs=((0, 0), (1, 0), (1, 1), (0, 1)), wrap=REPEAT, parts=1, transform=None, radiance=100.0, up=False):
    """A square of 1 m that looks down, or `up`, at HEIGHT, of parts² quads. The texture's u goes along x and its v along z."""
    texture = g.image(grey_png(values), magFilter=filtered, minFilter=filtered, wrapS=wrap, wrapT=wrap)
    material = g.material("panel", (0, 0, 0), (radiance,) * 3)
    info = {"index": texture}
    if transform:
        g.extend(info, "KHR_texture_transform", transform)
    g.json["materials"][material]["emissiveTexture"] = info
    positions, coordinates, triangles = [], [], []
    (a, b, c, d) = (numpy.array(uv, float) for uv in uvs)
    for i in range(parts):
        for k in range(parts):
            first = len(positions)
            for p, q in ((i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)):
                s, t = p / parts, q / parts
                positions.append((s - 0.5, HEIGHT, t - 0.5))
                coordinates.append(tuple((1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d))
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    g.node(mesh=g.mesh(positions, [t[::-1] for t in triangles] if up else triangles, material, uvs=coordinates))


def floor(g):
    g.place(*quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), g.material("floor", (0.5,) * 3))


def expected(emission, fine=512, radiance=100.0):
    """Irradiance on the floor's middle square metre, of the panel's emission at fine² points, in SIZE² pixels' means."""
    at = (numpy.arange(fine) + 0.5) / fine - 0.5
    weight = emission(at + 0.5, at + 0.5)      # rows: z, columns: x
    rows, columns = numpy.nonzero(weight)
    x, z, w = at[columns], at[rows], weight[rows, columns] * radiance / fine ** 2
    out = numpy.zeros((SIZE, SIZE))
    sub = 3
    for row in range(SIZE * sub):
        for column in range(SIZE * sub):
            px, pz = ((column + 0.5) / (SIZE * sub) - 0.5), ((row + 0.5) / (SIZE * sub) - 0.5)
            d2 = (x - px) ** 2 + (z - pz) ** 2 + HEIGHT ** 2
            out[row // sub, column // sub] += (w * HEIGHT ** 2 / d2 ** 2).sum() / sub ** 2
    return out


def seen(g, name, spp=256, **options):
    scene = g if isinstance(g, str) else g.save(daemon.folder, name)
    picture = daemon.render(scene, (SIZE, SIZE), spp, (0, HEIGHT / 2, 0, 0, 0, 0, 0, 0, -1, 40),
                            {"pt.depth": 1, **options}, ["--orthographic", "1"])
    return picture.radiance[:, :, 1].astype(float) * math.pi / 0.5


def looked_up(values, wrap=REPEAT, scale=(1, 1), offset=(0, 0)):
    """What a texture of nearest texels shows at coordinates s (columns) and t (rows) of the panel."""
    n = len(values)

    def index(c):
        i = numpy.floor(c * n).astype(int)
        if wrap == CLAMP:
            return numpy.clip(i, 0, n - 1)
        if wrap == MIRROR:
            m = i % (2 * n)
            return numpy.where(m < n, m, 2 * n - 1 - m)
        return i % n
    linear = (values / 255.0)
    return lambda s, t: linear[numpy.ix_(index(t * scale[1] + offset[1]), index(s * scale[0] + offset[0]))]


class Texels(unittest.TestCase):
    def compare(self, g, emission, most, name="panel.gltf", **options):
        reference = expected(emission)
        got = seen(g, name, **options)
        error = float(numpy.sqrt(((got - reference) ** 2).mean()) / reference.mean())
        print(f"{self.id().split('.')[-1]} {options}: relative RMSE {error:.4f}, mean {got.mean() / reference.mean():.4f}")
        self.assertLess(error, most)
        self.assertLess(abs(float(got.mean() / reference.mean()) - 1), max(0.5 * most, 0.003))
        return error

    def test_one_bright_texel_of_256(self):
        """77 % noise where points are chosen evenly over the panel."""
        values = one_bright(16, 5, 11)
        for options in ({}, {"pt.light_tree": "on"}, {"pt.lights": "nee"}):
            g = Gltf()
            floor(g)
            panel(g, values)
            self.compare(g, looked_up(values), 0.03, **options)

    def test_ways_agree_about_a_smooth_panel(self):
        """By points, by chance and by both: half-bright stripes, filtered."""
        values = numpy.tile((128 + 127 * numpy.sin(numpy.arange(16) / 16 * 2 * math.pi)).astype(numpy.uint8), (16, 1))
        g = Gltf()
        floor(g)
        panel(g, values, LINEAR)
        scene = g.save(daemon.folder, "stripes.gltf")
        means = {way: float(seen(scene, "", 1024 if way == "none" else 256, **{"pt.lights": way}).mean()) for way in ("mis", "nee", "none")}
        print("means by way:", means)
        for way in ("mis", "nee"):
            self.assertLess(abs(means[way] / means["none"] - 1), 0.01)

    def test_a_filtered_texel(self):
        values = one_bright(16, 5, 11)
        tent = lambda c, at: numpy.maximum(1 - numpy.abs(c * 16 - 0.5 - at), 0)
        g = Gltf()
        floor(g)
        panel(g, values, LINEAR)
        self.compare(g, lambda s, t: numpy.outer(tent(t, 11), tent(s, 5)), 0.05)

    def test_repeated_mirrored_held_and_transformed(self):
        values = one_bright(8, 2, 5)
        for wrap, uvs, scale, offset, transform in (
                (REPEAT, ((0, 0), (7, 0), (7, 5), (0, 5)), (7, 5), (0, 0), None),
                (REPEAT, ((-3, -2), (0, -2), (0, 1), (-3, 1)), (3, 3), (-3, -2), None),
                (MIRROR, ((-1, -1), (2, -1), (2, 2), (-1, 2)), (3, 3), (-1, -1), None),
                (CLAMP, ((0.5, 0.5), (-0.5, 0.5), (-0.5, 1.5), (0.5, 1.5)), (-1, 1), (0.5, 0.5), None),
                (REPEAT, ((0, 0), (1, 0), (1, 1), (0, 1)), (0.5, 2), (0.125, 0.3), {"scale": [0.5, 2], "offset": [0.125, 0.3]})):
            g = Gltf()
            floor(g)
            panel(g, values, NEAREST, uvs, wrap, transform=transform)
            self.compare(g, looked_up(values, wrap, scale, offset), 0.08)

    def test_triangles_smaller_than_a_texel(self):
        values = one_bright(8, 2, 5)
        for tree in ("on", "off"):
            g = Gltf()
            floor(g)
            panel(g, values, parts=20)
            self.compare(g, looked_up(values), 0.05, **{"pt.light_tree": tree})

    def test_one_texel_of_four_millions(self):
        """More texels than there are cells: one of 2048 x 2048."""
        values = one_bright(2048, 700, 1500)
        g = Gltf()
        floor(g)
        panel(g, values, radiance=1e6)
        reference = 1e6 / 2048 ** 2 / (1 + (700.5 / 2048 - 0.5) ** 2 + (1500.5 / 2048 - 0.5) ** 2) ** 2
        picture = daemon.render(g.save(daemon.folder, "millions.gltf"), (SIZE, SIZE), 256, (0, 0.5, 0, 0, 0, 0, 0, 0, -1, 40), {"pt.depth": 1},
                                ["--orthographic", "1e-3"])
        got = picture.radiance[:, :, 1].astype(float) * math.pi / 0.5
        print(f"one of four millions: mean {got.mean() / reference:.4f}, spread {got.std() / reference:.4f}")
        self.assertLess(abs(got.mean() / reference - 1), 0.05)
        self.assertLess(got.std() / reference, 0.5)

    def test_coordinates_that_are_no_use(self):
        """All corners at one place of the texture, and a texture that is dark there."""
        values = one_bright(16, 5, 11)
        for at, level in (((5.5 / 16, 11.5 / 16), 1.0), ((0.9, 0.1), 0.0)):
            g = Gltf()
            floor(g)
            panel(g, values, uvs=(at,) * 4)
            got = seen(g, "point.gltf")
            reference = expected(lambda s, t: numpy.full((len(t), len(s)), level), fine=64)
            self.assertLess(float(numpy.abs(got - reference).max()), 0.05 * 100)

    def test_beside_a_plain_lamp(self):
        values = one_bright(16, 5, 11)
        for tree in ("on", "off"):
            g = Gltf()
            floor(g)
            panel(g, values)
            g.place(*quad((-0.5, 0.9, -2), (0.5, 0.9, -2), (0.5, 0.9, -1), (-0.5, 0.9, -1)), g.material("plain", (0, 0, 0), (0.3,) * 3))
            with_plain = seen(g, "both.gltf", 1024, **{"pt.light_tree": tree})
            g = Gltf()
            floor(g)
            g.place(*quad((-0.5, 0.9, -2), (0.5, 0.9, -2), (0.5, 0.9, -1), (-0.5, 0.9, -1)), g.material("plain", (0, 0, 0), (0.3,) * 3))
            alone = seen(g, "plain.gltf", 1024)
            self.assertLess(abs(float((with_plain - alone).mean() / expected(looked_up(values)).mean()) - 1), 0.01)

    def test_by_way_of_a_mirror(self):
        """Light paths start at the bright texel of a panel that looks up, and come down by way of a mirror beside it."""
        g = Gltf()
        floor(g)
        g.place(*quad((0.3, 2, -0.1), (0.85, 2, -0.1), (0.85, 2, 0.4), (0.3, 2, 0.4)), g.material("mirror", (1, 1, 1), metallic=1, roughness=0, specular=1))
        panel(g, one_bright(16, 5, 11), up=True)
        scene = g.save(daemon.folder, "mirror.gltf")
        x, z = numpy.meshgrid(*((numpy.arange(64) + 0.5) / 64 + low for low in (1.5, -0.5)))
        d2 = (x - (5.5 / 16 - 0.5)) ** 2 + (z - (11.5 / 16 - 0.5)) ** 2 + 9
        reference = float((100 / 256 * 9 / d2 ** 2).mean())
        for tree in ("on", "off"):
            picture = daemon.render(scene, (64, 64), 64, (2, 0.5, 0, 2, 0, 0, 0, 0, -1, 40), {"pt.depth": 2, "pt.light_tree": tree}, ["--orthographic", "1"])
            got = float(picture.radiance[:, :, 1].mean(dtype=numpy.float64)) * math.pi / 0.5
            print(f"by way of a mirror: {got / reference:.4f}")
            self.assertLess(abs(got / reference - 1), 0.03)


if __name__ == "__main__":
    unittest.main()
