"""candil-compare as a program: its figures against numpy's, its pictures, its exit codes."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import images

PROGRAM = pathlib.Path(os.environ["CANDIL_BUILD"]) / "libexec" / "candil" / "candil-compare"
NOBODY = 65534


def run(*arguments, **more):
    return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, timeout=120, **more)


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        random = np.random.default_rng(7)
        self.b = random.uniform(0, 2, (24, 32, 3)).astype(np.float32)
        self.a = (self.b + random.normal(0, 0.1, self.b.shape)).astype(np.float32)

    def path(self, name):
        return pathlib.Path(self.folder.name) / name

    def figures(self, a, b, *more):
        images.write(self.path("a.exr"), a)
        images.write(self.path("b.exr"), b)
        done = run(self.path("a.exr"), self.path("b.exr"), "--json", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def check(self, got, a, b):
        a, b = a.astype(np.float64), b.astype(np.float64)
        self.assertAlmostEqual(got["rmse"], images.rmse(a, b), delta=1e-6)
        self.assertAlmostEqual(got["relmse"], images.relmse(a, b), delta=1e-6 * images.relmse(a, b))
        self.assertAlmostEqual(got["mean_difference"], (a - b).mean(), delta=1e-7)
        self.assertAlmostEqual(got["mean_difference_relative"], (a - b).mean() / b.mean(), delta=1e-7)
        self.assertAlmostEqual(got["max_abs"], np.abs(a - b).max(), delta=1e-6)
        self.assertAlmostEqual(got["mean_a"], a.mean(), delta=1e-7)
        self.assertAlmostEqual(got["mean_b"], b.mean(), delta=1e-7)

    def test_figures(self):
        got = self.figures(self.a, self.b)
        self.check(got, self.a, self.b)
        self.assertEqual((got["width"], got["height"], got["pixels"], got["masked"]), (32, 24, 768, 0))
        self.assertIsNone(got["mask_above"])

    def test_identical(self):
        got = self.figures(self.b, self.b)
        self.assertEqual((got["rmse"], got["relmse"], got["max_abs"], got["flip"], got["flip_max"]), (0,) * 5)

    def test_mask(self):
        got = self.figures(self.a, self.b, "--mask-above", "1.5")
        keep = ~(self.b > 1.5).any(axis=2)
        self.check(got, self.a[keep], self.b[keep])
        self.assertEqual(got["masked"], int((~keep).sum()))
        self.assertEqual(got["pixels"], int(keep.sum()))

    def test_reference_of_a_multiple_of_the_size(self):
        got = self.figures(self.a[:6, :8], self.b)
        self.check(got, self.a[:6, :8], images.box_down(self.b.astype(np.float64), 4))
        self.assertEqual((got["width"], got["height"]), (8, 6))

    def test_not_finite(self):
        self.a[0, 0, 1] = np.nan
        self.a[5, 5, 0] = np.inf
        got = self.figures(self.a, self.b)
        keep = np.isfinite(self.a).all(axis=2)
        self.check(got, self.a[keep], self.b[keep])
        self.assertEqual((got["non_finite_a"], got["non_finite_b"], got["pixels"]), (2, 0, 766))

    def test_png_is_decoded(self):
        codes = np.zeros((4, 4, 3)) + 188 / 255
        images.write(self.path("a.png"), codes)
        images.write(self.path("b.exr"), np.zeros((4, 4, 3)) + 0.5)
        done = run(self.path("a.png"), self.path("b.exr"), "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(json.loads(done.stdout)["max_abs"], 0.004)

    def test_flip_is_that_of_its_authors(self):
        # Their tool, version 1.6, at 67 pixels a degree: 96 x 96 pictures of a room against a converged one.
        folder = pathlib.Path(__file__).parent / "flip"
        for name, mean, largest in (("noise.exr", 0.209986, 0.788085), ("grey.exr", 0.402741, 0.961842),
                                    ("noise.png", 0.103440, 0.610075), ("grey.png", 0.182912, 0.443912)):
            done = run(folder / f"room-{name}", folder / f"room-reference{name[-4:]}", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            got = json.loads(done.stdout)
            self.assertAlmostEqual(got["flip"], mean, delta=2e-6, msg=name)
            self.assertAlmostEqual(got["flip_max"], largest, delta=2e-5, msg=name)
            if name.endswith("exr"):
                self.assertAlmostEqual(got["flip_exposures"]["low"], -2.8741, delta=1e-4)
                self.assertAlmostEqual(got["flip_exposures"]["high"], 4.7791, delta=1e-4)
                self.assertEqual(got["flip_exposures"]["count"], 8)
            else:
                self.assertIsNone(got["flip_exposures"])

    def test_flip_has_no_seams(self):
        # A tall picture is worked on in bands. Turned on its side it is one band: the filters know no direction.
        random = np.random.default_rng(11)
        b = np.repeat(np.repeat(random.uniform(0, 1, (100, 12, 3)), 4, axis=0), 4, axis=1)
        a = b + random.normal(0, 0.05, b.shape)
        tall, wide = self.figures(a, b), self.figures(a.swapaxes(0, 1), b.swapaxes(0, 1))
        self.assertAlmostEqual(tall["flip"], wide["flip"], delta=1e-6)
        self.assertAlmostEqual(tall["flip_max"], wide["flip_max"], delta=1e-5)

    def test_flip_leaves_masked_pixels_out(self):
        self.b[:, :16] = 5
        self.assertEqual(self.figures(self.b, self.b * np.float32(1), "--mask-above", "4")["flip"], 0)
        self.a[:, 16:] = self.b[:, 16:]
        got = self.figures(self.a, self.b, "--mask-above", "4")
        self.assertEqual((got["flip"], got["relmse"]), (0, 0))

    def test_pictures(self):
        self.a[3, 4] = self.b[3, 4] = 5
        self.a[7, 9, 0] = np.nan
        got = self.figures(self.a, self.b, "--mask-above", "4", "--error-image", self.path("e.png"),
                           "--side-by-side", self.path("s.png"))
        self.assertEqual(got["masked"], 1)
        error, side = images.rgb(self.path("e.png")), images.rgb(self.path("s.png"))
        self.assertEqual(error.shape, (24, 32, 3))
        self.assertEqual(side.shape, (24, 96, 3))
        np.testing.assert_allclose(error[3, 4] * 255, [0x77] * 3, atol=0.01)
        np.testing.assert_allclose(error[7, 9] * 255, [0, 255, 0], atol=0.01)
        np.testing.assert_array_equal(side[:, 64:], error)
        clipped = np.clip(self.b, 0, 1)
        curve = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
        np.testing.assert_allclose(side[:, 32:64], curve, atol=0.51 / 255)

    def test_text(self):
        images.write(self.path("b.exr"), self.b)
        done = run(self.path("b.exr"), self.path("b.exr"), "--error-image", self.path("e.png"))
        self.assertEqual(done.returncode, 0, done.stderr)
        for words in ("RMSE", "relMSE", "mean difference", "FLIP", "logarithmic"):
            self.assertIn(words, done.stdout)

    def test_pictures_that_make_no_pair_are_told(self):
        about = {"scene_hash": "1" * 32, "technique": "pt", "seed": "7", "first_sample": "0", "samples": "16", "camera_eye": "0,1,4"}
        images.write(self.path("a.exr"), self.b, about)
        images.write(self.path("b.exr"), np.repeat(np.repeat(self.b, 2, 0), 2, 1), {**about, "camera_eye": "0,1,5"})
        done = run(self.path("a.exr"), self.path("b.exr"), "--json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        camera, shared = json.loads(done.stdout)["warnings"]
        self.assertIn("two cameras", camera)
        self.assertIn("seed 7 and share samples 0 to 15", shared)
        images.write(self.path("b.exr"), self.b, {**about, "seed": "8", "made_of": "11x6"})
        scaled, = json.loads(run(self.path("a.exr"), self.path("b.exr"), "--json").stdout)["warnings"]
        self.assertIn("time for 11x6 pixels", scaled)
        # What is as long as no file of ours has it is not told.
        images.write(self.path("b.exr"), self.b, {**about, "camera_eye": "9" * 300, "samples": "x" * 300})
        images.write(self.path("a.exr"), self.b, {"scene_hash": "2" * 32})
        done = run(self.path("a.exr"), self.path("b.exr"))
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertTrue(done.stderr.startswith("warning    the pictures are of two scenes"), done.stderr)

    def test_could_not(self):
        images.write(self.path("b.exr"), self.b)
        images.write(self.path("odd.exr"), self.b[:7])
        self.path("text.exr").write_text("no picture")
        for a in ("missing.exr", "odd.exr", "text.exr"):
            done = run(self.path(a), self.path("b.exr"))
            self.assertEqual(done.returncode, 1, a)
            self.assertIn("candil-compare: ", done.stderr)
            self.assertEqual(done.stdout, "")
            done = run(self.path(a), self.path("b.exr"), "--json")
            self.assertEqual((done.returncode, json.loads(done.stdout)["exit"]), (1, 1), a)
            self.assertIn(json.loads(done.stdout)["error"]["message"], done.stderr)
        done = run(self.path("b.exr"), self.path("b.exr"), "--error-image", self.path("no/such/folder.png"), "--json")
        self.assertEqual((done.returncode, json.loads(done.stdout)["exit"]), (1, 1))
        done = run(self.path("b.exr"), self.path("b.exr"), "--mask-above", "-1")
        self.assertEqual(done.returncode, 1)

    def test_files_that_are_there(self):
        """What cannot be replaced is written over; what its owner wants to keep is kept."""
        images.write(self.path("b.exr"), self.b)
        # Root may write anywhere: it becomes somebody else.
        somebody = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.geteuid() == 0 else {}
        os.chmod(self.folder.name, 0o755)
        locked, shared = self.path("locked"), self.path("shared")
        for folder, mode in ((locked, 0o666), (shared, 0o444)):
            folder.mkdir()
            for name in ("e.png", "p.html"):
                (folder / name).write_text("before")
                (folder / name).chmod(mode)
        locked.chmod(0o555)
        shared.chmod(0o777)
        self.addCleanup(locked.chmod, 0o700)
        for option, name in (("--error-image", "e.png"), ("--side-by-side", "e.png"), ("--html", "p.html")):
            inode = (locked / name).stat().st_ino
            done = run(self.path("b.exr"), self.path("b.exr"), option, locked / name, **somebody)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual((locked / name).stat().st_ino, inode)
            self.assertIn((locked / name).read_bytes()[:5], (b"\x89PNG\r", b"<!DOC"))
            done = run(self.path("b.exr"), self.path("b.exr"), option, shared / name, **somebody)
            self.assertEqual(done.returncode, 1, done)
            self.assertIn("Permission denied", done.stderr)
            self.assertEqual((shared / name).read_text(), "before")
        # Of a link what it leads to, and the link itself if it leads nowhere.
        for name, whole in (("b.exr", True), ("nothing", False)):
            link = self.path("to-" + name)
            link.symlink_to(name)
            self.assertEqual(run(self.path("b.exr"), self.path("b.exr"), "--error-image", link).returncode, 0)
            self.assertEqual((link.is_symlink(), self.path(name).exists()), (whole, whole))
            self.assertEqual(link.read_bytes()[:4], b"\x89PNG")
            images.write(self.path("b.exr"), self.b)

    def test_usage(self):
        for arguments in ([], ["a"], ["a", "b", "c"], ["a", "b", "--mask-above", "bright"], ["a", "b", "--what"]):
            self.assertEqual(run(*arguments).returncode, 2, arguments)
        self.assertEqual(run("--help").returncode, 0)


if __name__ == "__main__":
    unittest.main()
