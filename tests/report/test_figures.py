"""The figures of candil-report against numpy's: errors, intervals, floors, the Pareto front, bias, who wins, predictions."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import images
from studies import BIASED, NOISY, PROGRAM, Study, point, technique


class Figures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.study = Study(folder.name)

    def seeds(self, name, samples, of):
        prefix = {NOISY: "n", BIASED: "b"}[name]
        return [of(self.study.pictures[f"{prefix}-{samples}-{seed}"]) for seed in range(8 if name == NOISY else 2)]

    def test_errors_are_numpys_less_the_references_own(self):
        results = self.study.usual().run()
        reference = self.study.pictures["reference"]
        own = results["views"][0]["reference"]["relmse"]
        self.assertGreater(own, 0)
        for name, samples in ((NOISY, 1), (NOISY, 64), (BIASED, 4)):
            got = point(results, name, samples)
            measured = np.mean(self.seeds(name, samples, lambda x: images.relmse(x, reference)))
            self.assertAlmostEqual(got["relmse_measured"], measured, delta=1e-6 * measured)
            self.assertAlmostEqual(got["relmse"], measured - own, delta=1e-6 * measured)
            self.assertAlmostEqual(got["rmse"], np.mean(self.seeds(name, samples, lambda x: images.rmse(x, reference))), delta=1e-6)
            self.assertAlmostEqual(got["mean_difference"], np.mean(self.seeds(name, samples, lambda x: (x - reference).mean())), delta=1e-7)
            self.assertTrue(got["resolved"])

    def test_flip_is_that_of_compare(self):
        results = self.study.usual().run()
        for name, prefix in ((NOISY, "n"), (BIASED, "b")):
            done = subprocess.run([PROGRAM.parent / "candil-compare", self.study.folder / f"images/{prefix}-4-0.exr",
                                   self.study.folder / "images/reference.exr", "--json"], capture_output=True, text=True, timeout=120, check=True)
            self.assertAlmostEqual(point(results, name, 4)["flip"], json.loads(done.stdout)["flip"], delta=1e-8)

    def test_an_error_within_the_references_own_is_not_resolved(self):
        study = self.study
        study.add("reference", study.noisy(.1), kind="reference", settings={"samples": 64}, error=(images.relmse(study.noisy(.1), study.truth), None, None))
        for seed in range(8):
            study.add(f"n-64-{seed}", study.noisy(.01), settings={"samples": 64}, seed=seed)
        got = point(study.run(), NOISY, 64)
        self.assertFalse(got["resolved"])
        self.assertGreaterEqual(got["relmse"], 0)
        self.assertGreater(got["relmse_measured"], got["relmse"])
        self.assertGreaterEqual(got["relmse_low"], 0)

    def test_an_unknown_error_of_the_reference_is_not_taken_off(self):
        self.study.usual()
        self.study.lines[0]["report"].update(error_kind="unknown", estimated_relmse=None, relmse_low=None, relmse_high=None)
        results = self.study.run()
        self.assertIsNone(results["views"][0]["reference"]["relmse"])
        self.assertEqual(results["views"][0]["reference"]["kind"], "unknown")
        got = point(results, NOISY, 4)
        self.assertEqual(got["relmse"], got["relmse_measured"])

    def test_bands_are_the_bootstraps(self):
        results = self.study.usual().run()
        reference, random = self.study.pictures["reference"], np.random.default_rng(5)
        own = results["views"][0]["reference"]["relmse"]
        for samples in (1, 16):
            got = point(results, NOISY, samples)
            values = np.array(self.seeds(NOISY, samples, lambda x: images.relmse(x, reference)))
            low, high = np.percentile(values[random.integers(0, 8, (20000, 8))].mean(axis=1), (2.5, 97.5)) - own
            width = high - low
            self.assertAlmostEqual(got["relmse_low"], low, delta=.08 * width)
            self.assertAlmostEqual(got["relmse_high"], high, delta=.08 * width)
        # Without noise the seeds say the same: no band.
        got = point(results, BIASED, 4)
        self.assertEqual((got["relmse_low"], got["relmse_high"]), (got["relmse"], got["relmse"]))

    def test_a_seed_that_ran_twice_counts_once(self):
        study = self.study.usual()
        once = point(study.run(), NOISY, 4)
        for seed in range(8):
            study.add(f"again-{seed}", study.pictures[f"n-4-{seed}"], settings={"samples": 4}, seed=seed, seconds=.4)
        twice = point(study.run(), NOISY, 4)
        self.assertEqual((twice["runs"], twice["seeds"]), (16, 8))
        for key in ("relmse", "relmse_low", "relmse_high"):
            self.assertEqual(once[key], twice[key])

    def test_time_is_the_median_of_the_warm_runs(self):
        study = self.study.usual()
        study.lines[-1]["report"].update(elapsed_us=9_000_000, cold_us=8_000_000)
        results = study.run()
        self.assertAlmostEqual(point(results, NOISY, 16)["seconds"], 1.6 * 1.035, delta=1e-6)
        got = point(results, BIASED, 4)
        self.assertAlmostEqual(got["seconds"], .2, delta=1e-6)
        self.assertAlmostEqual(got["cold_seconds"], 9, delta=1e-6)
        self.assertEqual(got["stages"][0], {"name": "trace", "seconds": .16})
        self.assertAlmostEqual(got["efficiency"], 1 / (got["relmse"] * got["seconds"]), delta=1e-6 * got["efficiency"])

    def test_a_time_that_nobody_measured_is_null(self):
        self.study.usual()
        for line in self.study.lines:
            line["report"]["cold_us"] = line["report"]["elapsed_us"] // 2
        results = self.study.run()
        self.assertIsNone(point(results, NOISY, 4)["seconds"])
        self.assertIsNone(point(results, NOISY, 4)["efficiency"])
        self.assertGreater(point(results, NOISY, 4)["cold_seconds"], 0)
        self.assertEqual(results["views"][0]["best"], [])

    def test_floor_is_the_error_at_most_samples(self):
        study = self.study.usual()
        # A finer setting with a lower floor, whose quick point is worse; and one whose quick point alone is good by luck.
        for samples, factor in ((1, 1.2), (4, 1.05)):
            study.add(f"fine-{samples}", (study.truth * factor).astype(np.float32), technique=BIASED, settings={"samples": samples, "vct.resolution": 128})
        for samples, factor in ((1, 1.0), (4, 1.5)):
            study.add(f"odd-{samples}", (study.truth * factor).astype(np.float32), technique=BIASED, settings={"samples": samples, "vct.resolution": 16})
        results = study.run()
        expected = next(p for p in technique(results, BIASED)["points"] if p["settings"] == {"samples": 4, "vct.resolution": 128})
        self.assertEqual(technique(results, BIASED)["floor"], expected["relmse"])
        self.assertEqual(technique(results, BIASED)["floors"], [expected["relmse"]])
        self.assertIsNone(technique(results, NOISY)["floor"])

    def test_pareto_front_is_what_nothing_dominates(self):
        results = self.study.usual().run()
        points = [p for t in results["techniques"] for p in t["points"]]
        for p in points:
            beaten = any(q["seconds"] <= p["seconds"] and q["relmse"] <= p["relmse"] and q is not p for q in points)
            self.assertEqual(p["pareto"], not beaten, p["settings"])
        self.assertTrue(any(p["pareto"] for p in points) and not all(p["pareto"] for p in points))

    def test_who_wins_and_who_overtakes(self):
        results = self.study.usual().run()
        view = results["views"][0]
        self.assertEqual([span["technique"] for span in view["best"]], [BIASED, NOISY])
        floor = technique(results, BIASED)["floor"]
        expected = next(p for p in technique(results, NOISY)["points"] if p["relmse"] < floor)
        self.assertEqual(view["overtakes"], [{"technique": NOISY, "overtaken": BIASED, "seconds": expected["seconds"], "settings": expected["settings"]}])
        for row in view["equal_time"]:
            for p in row["points"]:
                self.assertLessEqual(p["seconds"], row["seconds"])
                best = min(q["relmse"] for q in technique(results, p["technique"])["points"] if q["seconds"] <= row["seconds"])
                self.assertEqual(p["relmse"], best)
        for row in view["equal_error"]:
            for p in row["points"]:
                self.assertLessEqual(p["relmse"], row["relmse"])
                first = min(q["seconds"] for q in technique(results, p["technique"])["points"] if q["relmse"] <= row["relmse"])
                self.assertEqual(p["seconds"], first)
        self.assertTrue(any(NOISY in word and "overtakes" in word for word in results["words"]))

    def test_noise_is_no_bias_and_bias_is_found_where_it_is(self):
        study = Study(self.study.folder, size=(384, 384), seed=3).usual(bias=.1)
        results = study.run()
        for samples in (1, 4, 16, 64):
            bias = point(results, NOISY, samples)["bias"]
            self.assertEqual(bias["tiles"], 48 * 48)
            # 2,304 tests at 5 %: 3 standard deviations are 1.4 %; the reference's own noise is common to seeds, and small.
            self.assertAlmostEqual(bias["share_uncorrected"], .05, delta=.016)
            self.assertLess(bias["share"], .005)
        self.assertAlmostEqual(point(results, BIASED, 4)["bias"]["share"], .5, delta=.03)

    def test_bias_is_unknown_without_a_second_seed(self):
        self.study.usual(seeds=1)
        results = self.study.run()
        self.assertIsNone(point(results, NOISY, 4)["bias"])
        self.assertIsNone(point(results, BIASED, 4)["bias"])
        self.assertIsNone(point(results, NOISY, 4)["relmse_low"])

    def test_predictions_beside_the_truth(self):
        study = self.study.usual()
        reference = study.pictures["reference"]
        own = study.lines[0]["report"]["estimated_relmse"]
        for line in study.lines[1:33]:
            true = images.relmse(study.pictures[line["id"]], reference) - own
            low = true * (.5 if line["seed"] < 6 else 1.1)
            line["report"].update(error_kind="measured", estimated_relmse=2 * true, relmse_low=low, relmse_high=3 * true)
            line["quote"] = {"technique": NOISY, "time_ms": 500 * line["report"]["elapsed_us"] * 1e-6, "time_ms_low": 1, "time_ms_high": 2,
                             "relmse": None, "relmse_low": None, "relmse_high": None, "from": "pilot"}
        summary = {(row["of"], row["from"]): row for row in study.run()["predictions"]["summary"]}
        self.assertEqual(set(summary), {("relmse", "reply"), ("seconds", "quote")})
        self.assertEqual(summary["relmse", "reply"]["runs"], 32)
        self.assertAlmostEqual(summary["relmse", "reply"]["median_ratio"], 2, delta=1e-3)
        self.assertAlmostEqual(summary["relmse", "reply"]["held"], .75, delta=1e-9)
        self.assertAlmostEqual(summary["seconds", "quote"]["median_ratio"], .5, delta=1e-6)
        self.assertAlmostEqual(summary["seconds", "quote"]["factor_90"], 2, delta=1e-6)

    def test_ablation_is_beside_the_point_with_all_effects(self):
        study = self.study.usual()
        for seed in range(8):
            study.add(f"without-{seed}", (study.pictures[f"n-16-{seed}"] * .8).astype(np.float32), kind="ablation", settings={"samples": 16}, seed=seed,
                      seconds=.8 * (1 + .01 * seed), effects="auto,-bounces")
        results = study.run()
        row, = results["ablation"]
        whole = point(results, NOISY, 16)
        self.assertEqual((row["effects"], row["technique"]), ("auto,-bounces", NOISY))
        self.assertAlmostEqual(row["share_saved"], .5, delta=1e-6)
        self.assertAlmostEqual(row["relmse_incurred"], row["relmse"] - whole["relmse"], delta=1e-9)
        self.assertLess(row["mean_difference"], -.1)

    def test_views_are_judged_apart(self):
        study = Study(self.study.folder, views=2).usual()
        for line in list(study.lines):
            study.lines.append({**line, "id": line["id"] + "-2", "view": 1})
        results = study.run()
        self.assertEqual(len(results["views"]), 2)
        self.assertEqual(len(technique(results, NOISY)["points"]), 8)
        self.assertEqual(results["views"][0]["overtakes"], results["views"][1]["overtakes"])

    def test_csv_has_a_row_a_point(self):
        study = self.study.usual()
        study.lines[1]["command"] = 'candil render "a, b.gltf"'
        results = study.run()
        with open(study.folder / "results.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), sum(len(t["points"]) for t in results["techniques"]))
        row = next(r for r in rows if r["technique"] == NOISY and r["settings"] == "samples 1")
        self.assertAlmostEqual(float(row["relmse"]), point(results, NOISY, 1)["relmse"], delta=1e-8)
        self.assertEqual(row["command"], 'candil render "a, b.gltf"')

    def test_same_folder_same_bytes(self):
        self.study.usual().run()
        names = ("results.json", "results.csv", "report.html")
        first = [(self.study.folder / name).read_bytes() for name in names]
        self.study.run()
        for name, bytes in zip(names, first):
            self.assertEqual((self.study.folder / name).read_bytes(), bytes, name)


if __name__ == "__main__":
    unittest.main()
