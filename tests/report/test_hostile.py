"""Broken and hostile folders: candil-report refuses them or names what is missing, and reads and writes nothing outside."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import images
from studies import NOISY, PROGRAM, Study, point, report, technique


class Hostile(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "study"
        self.study = Study(self.folder).usual()

    def missing(self, results):
        return {entry["run"]: entry["why"] for entry in results["missing"]}

    def test_torn_and_broken_lines(self):
        self.study.write(tail='{"id": "torn", "kind": "poi')
        results = report(self.folder)
        self.assertEqual(results["missing"], [])
        self.study.write(tail='[]\n"text"\n{"id": 1}\nnothing\n\n\x00\n{"id":"twice","id":"twice"}\n')
        results = report(self.folder)
        self.assertEqual(len(results["missing"]), 6)
        self.assertEqual(len(technique(results, NOISY)["points"]), 4)

    def test_values_of_wrong_types(self):
        wrong = {"kind": "other", "view": 7, "technique": "", "settings": [1], "seed": -1, "id": ""}
        for key, value in wrong.items():
            line = {**self.study.lines[1], "id": f"wrong-{key}", key: value}
            self.study.lines.append(line)
        for k, settings in enumerate(({"samples": {}}, {"x" * 100: 1}, {f"s{i}": i for i in range(25)}, {"samples": None})):
            self.study.lines.append({**self.study.lines[1], "id": f"settings-{k}", "settings": settings})
        results = self.study.run()
        self.assertEqual(len(results["missing"]), 10)
        self.assertEqual(len(technique(results, NOISY)["points"]), 4)

    def test_reports_of_wrong_types_are_unknown(self):
        for k, report_of in enumerate((None, [], {"elapsed_us": "1"}, {"elapsed_us": -5, "stages": {}}, {"elapsed_us": 1e308 * 10, "stages": [1, None, {"name": 1, "us": "x"}]},
                                       {"error_kind": 5, "estimated_relmse": "x", "elapsed_us": 0}, {"stages": [{"name": "a", "us": 1}] * 100, "samples": -1})):
            self.study.add(f"odd-{k}", self.study.noisy(.1), settings={"samples": 1000 + k}, report={})["report"] = report_of
        self.study.write()
        text = (self.folder / "runs.jsonl").read_text().replace("Infinity", "1e300")
        (self.folder / "runs.jsonl").write_text(text)
        results = report(self.folder)
        for k in (0, 1, 2, 3, 5, 6):
            self.assertIsNone(point(results, NOISY, 1000 + k)["seconds"], k)
            self.assertIsNotNone(point(results, NOISY, 1000 + k)["relmse"], k)

    def test_an_error_that_does_not_say_how_it_is_known_is_unknown(self):
        for kind in ("unknown", "guessed", None):
            self.study.lines[0]["report"]["error_kind"] = kind
            results = self.study.run()
            self.assertEqual(results["views"][0]["reference"]["kind"], "unknown")
            self.assertIsNone(results["views"][0]["reference"]["relmse"])

    def test_what_is_missing_counts_once(self):
        self.study.json["missing"] = [{"run": "lost", "why": "it ran out of time"}, {"run": None, "why": "one"}, {"run": None, "why": "two"}]
        self.study.add("lost", None, failed={"code": 1, "name": "x", "message": "it ran out of time"})
        results = self.study.run()
        self.assertEqual([entry["run"] for entry in results["missing"]], ["lost", None, None])
        self.assertTrue(any("3 things are missing" in word for word in results["words"]))

    def test_text_that_is_cut_in_a_character_stays_text(self):
        for line in self.study.lines:
            line["settings"] = {**line["settings"], "x": "\u00e9\u20ac" * 100}
        self.study.json["views"][0]["name"] = "a" + "\u00e9" * 60
        self.study.json["views"].append({"name": "b" + "\u20ac" * 60})
        self.study.add("lost", None, failed={"code": 1, "name": "x", "message": "\u20ac" * 900})
        results = self.study.run()
        self.assertTrue(any("is the most accurate" in word and "\u20ac" in word for word in results["words"]))
        self.assertFalse([entry for entry in results["missing"] if "no UTF-8" in entry["why"]])

    def test_no_path_leads_out(self):
        outside = self.folder.parent / "outside.exr"
        images.write(outside, self.study.noisy(.1))
        (self.folder / "images" / "link.exr").symlink_to(outside)
        (self.folder / "way").symlink_to(self.folder.parent)
        os.mkfifo(self.folder / "images" / "pipe.exr")
        for k, image in enumerate(("../outside.exr", str(outside), "images/../../outside.exr", "images/link.exr", "way/outside.exr", "images/pipe.exr", "images", "",
                                   ".", "/dev/zero", "images/none.exr", "x" * 5000)):
            self.study.add(f"out-{k}", None, settings={"samples": 500 + k}, image=image)
        results = self.study.run()
        for k in range(12):
            self.assertIsNone(point(results, NOISY, 500 + k)["relmse"], k)
            self.assertIn(f"out-{k}", self.missing(results))
        self.assertEqual([path.name for path in self.folder.parent.iterdir() if path.suffix == ".png"], [])

    def test_links_at_the_names_of_its_temporaries_are_not_followed(self):
        outside = self.folder.parent / "outside"
        outside.write_text("years of work")
        self.study.write()
        names = ("results.json", "results.csv", "report.html", "images/reference.png")
        for name in names[:3]:
            (self.folder / name).write_text("what is there before takes a name in passing to replace")
        planted = [self.folder / part / ".candil-PID-0.tmp" for part in ("", "images")]
        plant = "".join(f'ln -s "$1" "{path}"\n'.replace("PID", "$$") for path in planted)
        done = subprocess.run(["sh", "-c", f'{plant}exec "$0" "$2"', PROGRAM, outside, self.folder], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(outside.read_text(), "years of work")
        for name in names:
            self.assertFalse((self.folder / name).is_symlink(), name)
            self.assertGreater((self.folder / name).stat().st_size, 100)
        left = list(self.folder.rglob(".*"))
        self.assertEqual(sorted(path.parent for path in left), sorted(path.parent for path in planted))
        self.assertTrue(all(path.is_symlink() for path in left))

    def test_images_that_are_none_or_have_another_size(self):
        (self.folder / "images" / "text.exr").write_text("no picture")
        images.write(self.folder / "images" / "small.exr", np.ones((8, 8, 3)))
        for name in ("text", "small"):
            self.study.lines.append({**self.study.lines[1], "id": name, "settings": {"samples": 7}, "image": f"images/{name}.exr"})
        broken = self.study.noisy(.1)
        broken[0, 0] = np.nan
        self.study.add("nan", broken, settings={"samples": 8})
        results = self.study.run()
        self.assertIn("8 x 8", self.missing(results)["small"])
        self.assertIn("text", self.missing(results))
        self.assertIn("not finite", self.missing(results)["nan"])
        self.assertIsNone(point(results, NOISY, 7)["relmse"])
        self.assertIsNotNone(point(results, NOISY, 8)["relmse"])

    def test_seeds_that_have_no_pixel_in_common_cost_the_noise_alone(self):
        for seed in range(2):
            broken = self.study.noisy(.1)
            broken[:, seed * self.study.width // 2:][:, :self.study.width // 2] = np.nan
            self.study.add(f"half-{seed}", broken, settings={"samples": 8}, seed=seed)
        got = point(self.study.run(), NOISY, 8)
        self.assertIsNotNone(got["relmse"])
        self.assertIsNone(got["relmse_noise"])

    def test_a_reference_that_is_lost_costs_the_errors_alone(self):
        (self.folder / "images" / "reference.exr").unlink()
        results = self.study.run()
        self.assertIn("reference", self.missing(results))
        self.assertIsNone(point(results, NOISY, 4)["relmse"])
        self.assertGreater(point(results, NOISY, 4)["seconds"], 0)
        self.assertIsNone(results["views"][0]["reference"])

    def test_the_last_line_of_an_id_counts(self):
        failed = {**self.study.lines[1], "failed": {"code": 9, "name": "worker-lost", "message": "it died"}, "report": None}
        later = self.study.lines[1]
        self.study.lines.insert(0, failed)
        self.assertEqual(self.study.run()["missing"], [])
        self.study.lines.append(failed)
        results = self.study.run()
        self.assertEqual(results["missing"], [{"run": later["id"], "why": "it died"}])
        self.assertEqual(point(results, NOISY, 1)["seeds"], 7)

    def test_study_json_that_does_not_hold_is_refused(self):
        for change, words in (({"version": 2}, "version"), ({"size": [0, 5]}, "size"), ({"size": [100000, 2]}, "size"), ({"size": [16384, 16384]}, "too large"),
                              ({"size": "x"}, "size"), ({"views": []}, "views"), ({"views": [{}] * 100}, "views")):
            self.study.json = {**Study(self.folder).json, **change}
            self.assertIn(words, self.study.run(expect=1), change)
        (self.folder / "study.json").write_text("[" * 100000)
        self.assertIn("study.json", report(self.folder, expect=1))
        (self.folder / "study.json").write_text(" " * (1 << 20) + "{}")
        self.assertIn("limit", report(self.folder, expect=1))
        (self.folder / "study.json").unlink()
        self.assertIn("study.json", report(self.folder, expect=1))
        self.assertIn("cannot read", report(self.folder / "nothing", expect=1))
        self.assertFalse((self.folder / "report.html").exists())

    def test_too_many_runs_are_refused_and_long_lines_left_out(self):
        self.study.write(tail="x" * (1 << 20) + "xx\n")
        self.assertIn("cannot be read", report(self.folder)["missing"][0]["why"])
        self.study.write(tail="{}\n" * 66000)
        self.assertIn("limit", report(self.folder, expect=1))

    def test_a_folder_that_cannot_be_written_keeps_the_old_report(self):
        self.study.run()
        before = (self.folder / "report.html").read_bytes()
        (self.folder / "results.csv").unlink()
        (self.folder / "results.csv").mkdir()
        self.assertIn("results.csv", self.study.run(expect=1))
        self.assertEqual((self.folder / "report.html").read_bytes(), before)
        self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith(".")], [])

    def test_usage(self):
        for arguments in ([], ["a", "b"], ["--what"]):
            self.assertEqual(subprocess.run([PROGRAM, *arguments], capture_output=True, timeout=60).returncode, 2)
        self.assertEqual(subprocess.run([PROGRAM, "--help"], capture_output=True, timeout=60).returncode, 0)


if __name__ == "__main__":
    unittest.main()
