"""Files of surroundings: what is read, what is mended and told, what is refused in words; and that a picture and a scene are
not taken for each other."""
import json
import math
import os
import struct
import unittest

import numpy
import OpenImageIO as oiio

import images
import make
import skies
from render import Daemon, Failed

daemon = Daemon()
EXIT_USAGE, EXIT_SCENE = 2, 4
AWAY = (0, 0, 50, 0, 0, 0, 0, 1, 0, 40)


def setUpModule():
    unittest.enterModuleContext(daemon)


def at(name):
    return os.path.join(daemon.folder, name)


def saved(name, pixels, kind="float", window=None):
    pixels = numpy.ascontiguousarray(pixels, dtype=numpy.float32)
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, kind)
    if window:
        spec.full_x, spec.full_y, spec.full_width, spec.full_height = window
    out = oiio.ImageOutput.create(at(name))
    assert out and out.open(at(name), spec) and out.write_image(pixels), name
    out.close()
    return at(name)


def kept(name, data):
    with open(at(name), "wb") as f:
        f.write(data)
    return at(name)


def seen(path, *arguments):
    """Its texels, by a panorama of as many pixels; the mean over each of what is bilinear."""
    _, width, height = described(path)
    picture = daemon.render(make.furnace(daemon.folder), (width, height), 16, AWAY,
                            arguments=["--background", path, "--panorama", *arguments])
    return picture.radiance


def described(path):
    """Warnings, width and height of a picture."""
    info = json.loads(daemon.candil("load", path, "--name", "picture", "--json")[1])
    return info["warnings"], info["environment_width"], info["environment_height"]


class Read(unittest.TestCase):
    def test_each_format(self):
        w = skies.directions(32, 16)
        sky = 0.5 + 0.3 * w
        floats = (("sky.exr", "half", 2e-3), ("sky.hdr", "float", 1e-2), ("sky.tif", "float", 1e-3))
        for name, kind, tolerance in floats + (("sky8.png", "uint8", 0.02), ("sky16.png", "uint16", 2e-3),
                                               ("sky.jpg", "uint8", 0.06)):
            stored = sky if (name, kind, tolerance) in floats else numpy.where(
                sky <= 0.0031308, sky * 12.92, 1.055 * numpy.maximum(sky, 1e-9) ** (1 / 2.4) - 0.055)
            warnings, width, height = described(saved(name, stored, kind))
            self.assertEqual((warnings, width, height), ([], 32, 16), name)
            error = numpy.abs(seen(at(name)) - images.box_down(skies.finer(sky, 4), 4))
            error[7:9, 15:17] = 0  # the sphere in the middle
            print(f"{name}: at most {error.max():.4f} off")
            self.assertLess(error.max(), tolerance + 0.01, name)

    def test_one_channel_is_grey_and_alpha_is_not_read(self):
        grey = seen(saved("grey.exr", numpy.full((8, 16, 1), 0.25)))
        numpy.testing.assert_allclose(grey[0], 0.25, rtol=1e-5)
        clear = numpy.full((8, 16, 4), 0.5)
        clear[:, :, 3] = 0
        numpy.testing.assert_allclose(seen(saved("alpha.exr", clear))[0], 0.5, rtol=1e-5)

    def test_a_shape_that_is_unusual_is_told(self):
        self.assertRegex(described(saved("square.exr", numpy.ones((8, 8, 3))))[0][0], "8 x 8 .* twice as wide as high")


class Mended(unittest.TestCase):
    def test_what_is_no_radiance(self):
        sky = numpy.full((8, 16, 3), 0.5, dtype=numpy.float32)
        sky[1, 2] = math.nan
        sky[2, 3] = -4
        sky[3, 4] = math.inf
        sky[4, 5] = -math.inf
        sky[5, 6] = 3e30
        sky[0, 0] = 7
        warnings, _, _ = described(saved("mended.exr", sky))
        print("\n".join(warnings))
        for pattern in ("no numbers: 3", "below it: 6", r"largest finite one, 3e\+30: 3", r"cut to 1e\+12: 6"):
            self.assertTrue(any(__import__("re").search(pattern, w) for w in warnings), (pattern, warnings))
        picture = seen(at("mended.exr"))
        self.assertTrue(numpy.isfinite(picture).all())
        self.assertGreater(float(picture[3, 4, 0]), 1e11)

    def test_black(self):
        self.assertEqual(described(saved("black.exr", numpy.zeros((8, 16, 3))))[0], ["the picture is black"])


class Refused(unittest.TestCase):
    def refuse(self, path, pattern, code=EXIT_SCENE):
        with self.assertRaises(Failed) as failure:
            daemon.candil("load", path, "--name", "bad")
        print(failure.exception.text.strip())
        self.assertEqual(failure.exception.status, code)
        self.assertRegex(failure.exception.text, pattern)

    def test_files_that_are_none(self):
        with open(saved("whole.exr", skies.sunset(64)), "rb") as f:
            whole = f.read()
        self.refuse(kept("cut.exr", whole[:len(whole) // 2]), "cut.exr.*(damaged|cannot be read)")
        self.refuse(kept("head.exr", whole[:40]), "head.exr.*cannot be read")
        self.refuse(kept("empty.exr", b""), "empty")
        self.refuse(kept("text.hdr", b"no picture at all"), "no exr, hdr, tiff, png or jpeg file")
        self.refuse(kept("scene.exr", b'{"asset": {"version": "2.0"}}'), "no exr, hdr")
        noise = numpy.random.default_rng(3).integers(0, 256, len(whole), dtype=numpy.uint8).tobytes()
        self.refuse(kept("noise.exr", whole[:300] + noise[300:]), "noise.exr")

    def test_sizes(self):
        head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"
        self.refuse(kept("huge.hdr", head + b"-Y 40000 +X 80000\n"), "a side may have 16384")
        self.refuse(kept("wide.hdr", head + b"-Y 8192 +X 16384\n"), "33554432 together are the most")
        self.refuse(kept("none.hdr", head + b"-Y 0 +X 16\n"), "(no pixels|cannot be read)")
        self.refuse(kept("less.hdr", head + b"-Y -4 +X -8\n"), "(no pixels|cannot be read)")
        chunk = b"IHDR" + struct.pack(">IIBBBBB", 2 ** 31 - 1, 2 ** 31 - 1, 8, 2, 0, 0, 0)
        self.refuse(kept("huge.png", b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + bytes(4)),
                    "(cannot be read|a side may have)")

    def test_pixels_that_are_not_the_window(self):
        self.refuse(saved("part.exr", numpy.ones((4, 8, 3)), window=(0, 0, 16, 8)), "another window")

    def test_a_scene_is_no_picture_and_the_other_way_round(self):
        furnace, sky = make.furnace(daemon.folder), saved("sky.exr", skies.even(8, 4))
        daemon.candil("load", furnace, "--name", "furnace")
        daemon.candil("load", sky, "--name", "even")
        for arguments, pattern in ((("furnace", "--background", "furnace"), "is a scene, no picture"),
                                   ((furnace, "--background", furnace), "is a scene, no picture"),
                                   (("furnace", "--background", "nowhere"), "no scene and no file named nowhere"),
                                   (("furnace", "--background", "1,2"), "three numbers"),
                                   (("furnace", "--background", "even", "--background-scale", "0"), "a number above 0"),
                                   (("furnace", "--background", "even", "--background-scale", "1e12"), "scale is between"),
                                   (("furnace", "--background", "even", "--background-turn", "1e9"), "is turned by")):
            with self.assertRaises(Failed) as failure:
                daemon.render(arguments[0], (8, 8), 1, arguments=arguments[1:])
            self.assertRegex(failure.exception.text, pattern)
            self.assertIn(failure.exception.status, (EXIT_USAGE, EXIT_SCENE))
        # By name, twice, and once more after a picture of that name was loaded anew.
        one = daemon.render("furnace", (8, 8), 1, arguments=["--background", "even"])
        two = daemon.render("furnace", (8, 8), 1, arguments=["--background", "even"])
        self.assertEqual(one.radiance.tobytes(), two.radiance.tobytes())
        self.assertIn("candil/environment_hash", one.metadata)
        daemon.candil("load", saved("other.exr", skies.even(8, 4, 3.0)), "--name", "even")
        three = daemon.render("furnace", (8, 8), 1, arguments=["--background", "even"])
        numpy.testing.assert_allclose(three.radiance, 3 * one.radiance, rtol=1e-6)
        daemon.candil("unload", "even")
        with self.assertRaises(Failed):
            daemon.render("furnace", (8, 8), 1, arguments=["--background", "even"])


if __name__ == "__main__":
    unittest.main()
