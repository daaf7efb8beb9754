"""What of a texture is seen at a place: repeated, mirrored and held at the edge, at sides of every kind, by every technique."""
import math
import struct
import unittest
import zlib

import numpy

from render import Daemon
from writers import Gltf, png

daemon = Daemon()
REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
NEAREST, LINEAR = 9728, 9729


def setUpModule():
    unittest.enterModuleContext(daemon)


def linear(byte):
    return ((byte / 255 + 0.055) / 1.055) ** 2.4 if byte > 10 else byte / 255 / 12.92


def wrapped(i, side, wrap):
    """Which texel stands at place i: what the specification says, by Python's own remainder."""
    if wrap == CLAMP:
        return min(max(i, 0), side - 1)
    if wrap == REPEAT:
        return i % side
    m = i % (2 * side)
    return m if m < side else 2 * side - 1 - m


class Wrap(unittest.TestCase):
    def strip(self, sides, u, v, wraps=(REPEAT, REPEAT), filtered=NEAREST):
        """An unlit square over the coordinates u[0]…u[1] and v[0]…v[1], left to right and top to bottom."""
        values = [[40 + (83 * x + 131 * y) % 200 for x in range(sides[0])] for y in range(sides[1])]
        g = Gltf()
        texture = g.image(png(*sides, lambda x, y: (values[y][x],) * 3), magFilter=filtered, minFilter=filtered, wrapS=wraps[0], wrapT=wraps[1])
        corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        g.node(mesh=g.mesh(corners, [(0, 1, 2), (0, 2, 3)], g.material("strip", texture=texture, unlit=True),
                           uvs=[(u[0], v[1]), (u[1], v[1]), (u[1], v[0]), (u[0], v[0])]))
        return g.save(daemon.folder, "strip.gltf"), numpy.array([[linear(b) for b in row] for row in values])

    def check(self, sides, u, v, size, wraps=(REPEAT, REPEAT), filtered=NEAREST, techniques=("pt", "direct")):
        scene, texels = self.strip(sides, u, v, wraps, filtered)
        expected = numpy.empty((size[1], size[0]))
        for y in range(size[1]):
            for x in range(size[0]):
                at = [(a[0] + (a[1] - a[0]) * (i + 0.5) / n) * side for a, i, n, side in zip((u, v), (x, y), size, sides)]
                if filtered == NEAREST:
                    parts = [[(math.floor(c), 1.0)] for c in at]
                else:
                    low = [math.floor(c - 0.5) for c in at]
                    parts = [[(l, 1 - (c - 0.5 - l)), (l + 1, c - 0.5 - l)] for l, c in zip(low, at)]
                expected[y, x] = sum(wx * wy * texels[wrapped(j, sides[1], wraps[1]), wrapped(i, sides[0], wraps[0])]
                                     for i, wx in parts[0] for j, wy in parts[1])
        for technique in techniques:
            # `pt` looks anywhere in a pixel, so that it is held to places where a pixel shows one texel.
            if technique == "pt" and filtered == LINEAR:
                continue
            with self.subTest(technique=technique, sides=sides, u=u, v=v, wraps=wraps, filtered=filtered):
                picture = daemon.render(scene, size, 1, (0, 0, 5, 0, 0, 0, 0, 1, 0, 40),
                                        arguments=["--technique", technique, "--orthographic", "2"])
                self.assertLess(float(numpy.abs(picture.radiance[:, :, 0] - expected).max()), 2e-3)

    def test_negative_coordinates_repeat_a_texture_of_any_side(self):
        for side in (1, 2, 3, 5, 6, 7, 9, 11, 13):
            self.check((side, side), (-1, 0), (-1, 0), (side, side))

    def test_many_turns_below_zero(self):
        for side, turns in ((3, 7), (5, 12), (6, 40), (7, 33), (10, 8)):
            self.check((side, side), (-turns, 1 - turns), (-turns, 1 - turns), (side, side))

    def test_across_zero(self):
        for side in (3, 5, 7):
            self.check((side, side), (-1, 2), (-2, 1), (3 * side, 3 * side), techniques=("pt", "direct", "vct"))

    def test_the_edge_of_a_filtered_texture_is_that_of_the_other_end(self):
        """Left of its first texel's middle, a texture that repeats is read at texel −1, with coordinates that are never negative."""
        for side in (3, 4, 5, 6, 7, 12):
            self.check((side, side), (0, 1), (0, 1), (8 * side, 8 * side), filtered=LINEAR)

    def test_mirrored_and_held(self):
        for side in (3, 5, 6):
            for wraps in ((MIRROR, MIRROR), (CLAMP, CLAMP), (MIRROR, REPEAT), (REPEAT, CLAMP)):
                for filtered in (NEAREST, LINEAR):
                    self.check((side, side), (-3, 0), (-3, 0), (3 * side, 3 * side), wraps, filtered)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_of(pixels, bits, kind, extra=b""):
    """A PNG of any kind and depth: `pixels` has rows of pixels, each a tuple of channel values."""
    lines = b""
    for row in pixels:
        values = "".join(format(v, f"0{bits}b") for p in row for v in p)
        values += "0" * (-len(values) % 8)
        lines += b"\0" + bytes(int(values[i:i + 8], 2) for i in range(0, len(values), 8))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), bits, kind, 0, 0, 0)) + extra +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def tiff_of(pixels):
    """A TIFF of three floats a pixel, or of three 16-bit numbers if they are whole."""
    whole = isinstance(pixels[0][0][0], int)
    data = b"".join(struct.pack("<3H" if whole else "<3f", *p) for row in pixels for p in row)
    bits = 16 if whole else 32
    tags = [(256, 4, 1, len(pixels[0])), (257, 4, 1, len(pixels)), (258, 3, 3, 8 + len(data)), (259, 3, 1, 1), (262, 3, 1, 2), (273, 4, 1, 14 + len(data)),
            (277, 3, 1, 3), (278, 4, 1, len(pixels)), (279, 4, 1, len(data)), (339, 3, 3, 8 + len(data) + 6)]
    head = struct.pack("<3H", bits, bits, bits)
    formats = struct.pack("<3H", *(1 if whole else 3,) * 3)
    place = 8 + len(head) + len(formats)
    tags = [(t, k, n, {258: 8, 339: 14, 273: place}.get(t, v)) for t, k, n, v in tags]
    directory = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *t) for t in tags) + b"\0\0\0\0"
    return b"II*\0" + struct.pack("<I", place + len(data)) + head + formats + data + directory


def decoded(v):
    """sRGB's curve, of numbers 0 … 1."""
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6
CORNERS = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
UVS = [(0, 1), (1, 1), (1, 0), (0, 0)]


class Depth(unittest.TestCase):
    """Each value of a file is on the surface as exactly as the file has it, whatever its kind and depth."""

    def shown(self, image, technique, size, slot="base"):
        g = Gltf()
        texture = g.image(image, magFilter=NEAREST, minFilter=NEAREST)
        if slot == "base":
            material = g.material("picture", texture=texture, unlit=True)
        else:
            material = g.material("picture", (0, 0, 0), (1, 1, 1))
            g.json["materials"][material]["emissiveTexture"] = {"index": texture}
        g.node(mesh=g.mesh(CORNERS, [(0, 1, 2), (0, 2, 3)], material, uvs=UVS))
        scene = g.save(daemon.folder, "depth.gltf")
        return self.look(scene, technique, size)

    def look(self, scene, technique, size):
        return daemon.render(scene, size, 1, (0, 0, 5, 0, 0, 0, 0, 1, 0, 40),
                             arguments=["--technique", technique, "--orthographic", repr(2 * size[1] / size[0])]).radiance

    def check(self, image, expected, techniques=("pt", "direct"), slot="base"):
        expected = numpy.array(expected)
        for technique in techniques:
            with self.subTest(technique=technique, slot=slot):
                seen = self.shown(image, technique, expected.shape[1::-1], slot)
                self.assertLess(float(numpy.abs(seen - expected).max() / expected.max()), 1e-6)
                self.assertLess(float((numpy.abs(seen - expected) / numpy.maximum(expected, 1e-6)).max()), 2e-5)

    def test_sixteen_bits_of_colour(self):
        """Numbers that are 257 times no byte, dark ones too: 8 bits would be off by up to half a step, as much as the value itself."""
        pixels = [[(9 + 7919 * (x + 8 * y) % 65536, 40 + 104729 * (x + 8 * y) % 65500, 3 + x + 8 * y) for x in range(8)] for y in range(8)]
        expected = [[[decoded(v / 65535) for v in p] for p in row] for row in pixels]
        self.check(png_of(pixels, 16, RGB), expected, ("pt", "direct", "vct"))
        self.check(png_of(pixels, 16, RGB), expected, ("pt",), "emission")

    def test_sixteen_bits_that_are_eight(self):
        pixels = [[(257 * (x * 31 % 256),) * 3 for x in range(8)]]
        self.check(png_of(pixels, 16, RGB), [[[decoded(v / 65535) for v in p] for p in row] for row in pixels])

    def test_grey_of_every_depth(self):
        for bits in (1, 2, 4, 8, 16):
            most = (1 << bits) - 1
            pixels = [[(most * x // 15,) for x in range(16)]]
            self.check(png_of(pixels, bits, GREY), [[[decoded(p[0] / most)] * 3 for p in pixels[0]]])

    def test_palettes(self):
        colours = [(17, 203, 90), (255, 0, 3), (64, 64, 200), (1, 130, 254)]
        for bits in (1, 2, 4, 8):
            count = min(4, 1 << bits)
            pixels = [[(x % count,) for x in range(8)]]
            palette = chunk(b"PLTE", bytes(v for c in colours[:count] for v in c))
            self.check(png_of(pixels, bits, PALETTE, palette), [[[linear(v) for v in colours[p[0]]] for p in pixels[0]]])

    def test_what_a_file_says_of_gamma_and_significant_bits_changes_nothing(self):
        pixels = [[(x * 4096 + 1000,) for x in range(16)]]
        for extra in (chunk(b"gAMA", struct.pack(">I", 100000)), chunk(b"sBIT", b"\x0c"), chunk(b"sRGB", b"\0")):
            self.check(png_of(pixels, 16, GREY, extra), [[[decoded(p[0] / 65535)] * 3 for p in pixels[0]]], ("pt",))

    def test_alpha_of_sixteen_bits(self):
        """Alpha 0.5 by 16 bits, and a cutoff between its two neighbours: a mask tells them apart, where 8 bits cannot."""
        for kind, colour in ((GREY_ALPHA, (65535,)), (RGBA, (65535,) * 3)):
            pixels = [[colour + (a,) for a in (32767, 32768, 32700, 32800)]]
            g = Gltf()
            texture = g.image(png_of(pixels, 16, kind), magFilter=NEAREST, minFilter=NEAREST)
            material = g.material("mask", texture=texture, unlit=True, cutoff=32767.5 / 65535)
            g.node(mesh=g.mesh(CORNERS, [(0, 1, 2), (0, 2, 3)], material, uvs=UVS))
            scene = g.save(daemon.folder, "mask.gltf")
            for technique in ("pt", "direct"):
                self.assertEqual(self.look(scene, technique, (4, 1))[0, :, 0].tolist(), [0, 1, 0, 1], (kind, technique))

    def test_a_colour_that_is_said_to_be_clear(self):
        """PNG's tRNS, of a grey level and of palette entries."""
        for image in (png_of([[(3,), (1,)]], 2, GREY, chunk(b"tRNS", b"\0\1")),
                      png_of([[(1,), (0,)]], 8, PALETTE, chunk(b"PLTE", bytes((255,) * 6)) + chunk(b"tRNS", b"\0")),
                      png_of([[(65535,), (4000,)]], 16, GREY, chunk(b"tRNS", struct.pack(">H", 4000)))):
            g = Gltf()
            material = g.material("mask", texture=g.image(image, magFilter=NEAREST, minFilter=NEAREST), unlit=True, cutoff=.5)
            g.node(mesh=g.mesh(CORNERS, [(0, 1, 2), (0, 2, 3)], material, uvs=UVS))
            self.assertEqual(self.look(g.save(daemon.folder, "clear.gltf"), "pt", (2, 1))[0, :, 0].tolist(), [1, 0])

    def test_a_normal_between_two_of_eight_bits(self):
        """A mirror that leans by a fifth of a degree, where the steps of 8 bits are more than twice that."""
        g = Gltf()
        lean = 0.5 * math.sin(math.radians(0.2)) + 0.5
        normal = g.image(png_of([[(round(65535 * lean), 32768, 65535)]], 16, RGB))
        material = g.material("mirror", (1, 1, 1), metallic=1, roughness=0)
        g.json["materials"][material]["normalTexture"] = {"index": normal}
        g.node(mesh=g.mesh(CORNERS, [(0, 1, 2), (0, 2, 3)], material, uvs=UVS))
        # A wall behind the camera whose colour is its place: what the mirror shows says where it looks.
        ramp = g.image(png_of([[(256 * x,) for x in range(256)]], 16, GREY), wrapS=CLAMP)
        g.node(mesh=g.mesh([(1, -1, 10), (-1, -1, 10), (-1, 1, 10), (1, 1, 10)], [(0, 1, 2), (0, 2, 3)],
                           g.material("ramp", texture=ramp, unlit=True), uvs=[(1, 1), (0, 1), (0, 0), (1, 0)]))
        scene = g.save(daemon.folder, "normal.gltf")
        seen = daemon.render(scene, (1, 1), 64, (0, 0, 5, 0, 0, 0, 0, 1, 0, 40), arguments=["--orthographic", "1e-3"]).radiance[0, 0, 0]
        at = 0.5 + 0.5 * 10 * math.tan(math.radians(0.4))
        texel = at * 256 - 0.5
        low = int(texel)
        expected = (1 - texel + low) * decoded(256 * low / 65535) + (texel - low) * decoded(256 * (low + 1) / 65535)
        self.assertLess(abs(float(seen) / expected - 1), 1e-3)

    def test_tiff_of_floats_and_of_whole_numbers(self):
        for pixels, most in (([[(0.1, 0.50001, 0.9), (1e-4, 0.03, 1.0)]], 1), ([[(7001, 32769, 59000), (77, 3000, 65535)]], 65535)):
            with open(daemon.folder + "/map.tif", "wb") as f:
                f.write(tiff_of(pixels))
            with open(daemon.folder + "/map.mtl", "w") as f:
                f.write("newmtl m\nKd 0 0 0\nKe 1 1 1\nmap_Ke map.tif\n")
            with open(daemon.folder + "/map.obj", "w") as f:
                f.write("mtllib map.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n")
            seen = daemon.render(daemon.folder + "/map.obj", (2, 1), 64, (0, 0, 5, 0, 0, 0, 0, 1, 0, 40), arguments=["--orthographic", "1"]).radiance
            # A filtered texture of two texels that repeats: its mean over either half is by an eighth that of the other.
            a, b = (numpy.array([decoded(round(v / most * 65535) / 65535) for v in p]) for p in pixels[0])
            for x, expected in enumerate((0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b)):
                self.assertLess(float(numpy.abs(seen[0, x] / expected - 1).max()), 0.02)


if __name__ == "__main__":
    unittest.main()
