"""The figures of candil-report against numpy's: errors, intervals, floors, the Pareto front, bias, who wins, predictions."""
import csv
import itertools
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

    def test_a_reference_without_an_upper_end_resolves_nothing(self):
        """A reply whose interval is open above says that light may be missing: then the true error may be anything below what is measured."""
        study = self.study.usual()
        own = study.lines[0]["report"]["estimated_relmse"]
        self.assertTrue(point(study.run(), NOISY, 1)["resolved"], "no interval is stated: the error itself counts")
        study.lines[0]["report"].update(relmse_low=.5 * own)
        results = study.run()
        for p in (p for t in results["techniques"] for p in t["points"]):
            self.assertFalse(p["resolved"] or p["pareto"])
            self.assertEqual(p["relmse_low"], 0)
        self.assertIsNone(technique(results, BIASED)["floor"])
        self.assertIn("no upper end", next(entry["why"] for entry in results["missing"] if entry["run"] == "reference"))

    def test_an_unknown_error_of_the_reference_is_not_taken_off(self):
        self.study.usual()
        self.study.lines[0]["report"].update(error_kind="unknown", estimated_relmse=None, relmse_low=None, relmse_high=None)
        results = self.study.run()
        self.assertIsNone(results["views"][0]["reference"]["relmse"])
        self.assertEqual(results["views"][0]["reference"]["kind"], "unknown")
        got = point(results, NOISY, 4)
        self.assertEqual(got["relmse"], got["relmse_measured"])

    def test_bands_are_the_bootstraps(self):
        """Of eight seeds the studentised bootstrap's, of fewer Student's of the logarithm; never narrower for a stated own error's interval."""
        study = self.study.usual()
        own = study.lines[0]["report"]["estimated_relmse"]
        results = study.run()
        reference, random = study.pictures["reference"], np.random.default_rng(5)
        for samples in (1, 16):
            got = point(results, NOISY, samples)
            values = np.array(self.seeds(NOISY, samples, lambda x: images.relmse(x, reference)))
            drawn = values[random.integers(0, 8, (40000, 8))]
            error, errors = values.std(ddof=1) / 8 ** .5, drawn.std(axis=1, ddof=1) / 8 ** .5
            t = (drawn.mean(axis=1) - values.mean())[errors > 0] / errors[errors > 0]
            low, high = values.mean() - np.percentile(t, (97.5, 2.5)) * error - own
            self.assertAlmostEqual(got["relmse_low"], low, delta=.12 * (high - low))
            self.assertAlmostEqual(got["relmse_high"], high, delta=.12 * (high - low))
        # Equal pictures have no band but for the reference's own interval.
        got = point(results, BIASED, 4)
        self.assertEqual((got["relmse_low"], got["relmse_high"]), (got["relmse"], got["relmse"]))
        study.lines[0]["report"].update(relmse_low=.5 * own, relmse_high=2 * own)
        wider = point(study.run(), BIASED, 4)
        # The reply's interval is of 90 %.
        self.assertAlmostEqual(wider["relmse_low"], got["relmse"] - 1.96 / 1.645 * own, delta=1e-8)
        self.assertAlmostEqual(wider["relmse_high"], got["relmse"] + 1.96 / 1.645 * .5 * own, delta=1e-8)

    def test_a_few_seeds_have_students_band(self):
        study = self.study.usual(seeds=3)
        own = study.lines[0]["report"]["estimated_relmse"]
        got = point(study.run(), NOISY, 4)
        logs = np.log([images.relmse(study.pictures[f"n-4-{seed}"], study.pictures["reference"]) for seed in range(3)])
        v = logs.var(ddof=1)
        half = 4.302652729696142 * (v / 3 + v * v / 4) ** .5
        self.assertAlmostEqual(got["relmse_low"], np.exp(logs.mean() + v / 2 - half) - own, delta=1e-6 * got["relmse"])
        self.assertAlmostEqual(got["relmse_high"], np.exp(logs.mean() + v / 2 + half) - own, delta=1e-6 * got["relmse"])

    def test_noise_is_seen_from_the_pictures(self):
        """A technique that is not said to converge, whose seeds differ and whose mean is right, has a band and no bias."""
        study = Study(self.study.folder, size=(256, 256), seed=7).usual()
        for seed in range(3):
            study.add(f"s-{seed}", study.noisy(.1), technique=BIASED, settings={"samples": 2}, seed=seed)
        results = study.run()
        got = point(results, BIASED, 2)
        self.assertLess(got["relmse_low"], got["relmse"])
        self.assertLess(got["relmse"], got["relmse_high"])
        self.assertAlmostEqual(got["relmse_noise"], got["relmse"], delta=.1 * got["relmse"])
        self.assertAlmostEqual(got["bias"]["share_uncorrected"], .05, delta=.025)
        self.assertLess(got["bias"]["share"], .01)
        self.assertAlmostEqual(got["efficiency"], 1 / (got["relmse"] * got["seconds"]), delta=1e-6 * got["efficiency"])
        # Alone it has no floor: its error is noise, and no bias is said.
        study.lines = [line for line in study.lines if line["technique"] == NOISY or line["settings"] == {"samples": 2}]
        results = study.run()
        self.assertIsNone(technique(results, BIASED)["floor"])
        self.assertFalse([word for word in results["words"] if "that is bias" in word or "gets no lower" in word])

    def test_the_references_noise_is_that_of_its_own_settings(self):
        study = self.study.usual()
        for line in study.lines:
            if line["kind"] == "point" and line["technique"] == NOISY:
                line["settings"] = {**line["settings"], "depth": 2}
        results = study.run()
        self.assertEqual({p["bias"] is None for t in results["techniques"] for p in t["points"]}, {True})
        study.lines[0]["settings"] = {"samples": 4096, "depth": 2}
        self.assertIsNotNone(point(study.run(), BIASED, 4)["bias"])

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
        next(line for line in study.lines if line["id"] == "b-4-1")["report"].update(elapsed_us=9_000_000, cold_us=8_000_000)
        results = study.run()
        self.assertAlmostEqual(point(results, NOISY, 16)["seconds"], 1.6 * 1.035, delta=1e-6)
        got = point(results, BIASED, 4)
        self.assertAlmostEqual(got["seconds"], .2, delta=1e-6)
        self.assertAlmostEqual(got["cold_seconds"], 9, delta=1e-6)
        self.assertEqual(got["stages"][0], {"name": "trace", "seconds": .16})
        self.assertIsNone(got["efficiency"], "an error that is no noise does not fall with time")
        got = point(results, NOISY, 16)
        self.assertAlmostEqual(got["efficiency"], 1 / (got["relmse"] * got["seconds"]), delta=1e-6 * got["efficiency"])
        self.assertLess(got["efficiency_low"], got["efficiency"])
        self.assertLess(got["efficiency"], got["efficiency_high"])

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
        def add(name, resolution, factors):
            for (samples, factor), seed in itertools.product(factors, range(2)):
                study.add(f"{name}-{samples}-{seed}", (study.truth * factor).astype(np.float32), technique=BIASED, seed=seed,
                          settings={"samples": samples, "vct.resolution": resolution})
        add("fine", 128, ((1, 1.2), (4, 1.05), (16, 1.05)))
        add("odd", 16, ((1, 1.0), (4, 1.5)))
        results = study.run()
        expected = next(p for p in technique(results, BIASED)["points"] if p["settings"] == {"samples": 16, "vct.resolution": 128})
        self.assertEqual(technique(results, BIASED)["floor"], expected["relmse"])
        self.assertEqual(technique(results, BIASED)["floors"], [expected["relmse"]])
        self.assertIsNone(technique(results, NOISY)["floor"])
        self.assertTrue(any("gets no lower than" in word and "that is bias" in word for word in results["words"]))
        # Lower still with more samples: where it ends nobody knows.
        add("fine", 128, ((64, 1.04),))
        results = study.run()
        self.assertIsNone(technique(results, BIASED)["floor"])
        self.assertEqual(technique(results, BIASED)["lowest"][0]["with_samples"], "falling")
        self.assertTrue(any("still falling with samples 64" in word for word in results["words"]))
        self.assertFalse(any("gets no lower" in word or "that is bias" in word for word in results["words"]))

    def test_a_floor_is_without_the_noise_of_its_pictures(self):
        study = self.study.usual()
        study.lines = [line for line in study.lines if line["technique"] == NOISY]
        def add(samples, sigma, bias, **settings):
            for seed in range(8):
                picture = study.noisy(sigma) + study.truth * bias * (np.arange(study.width) >= study.width // 2)[:, None]
                study.add(f"f-{samples}-{bias}-{seed}", picture.astype(np.float32), technique=BIASED, seed=seed,
                          settings={"samples": samples, **settings})
        # A fifth of it is noise that more samples do not take away: where in a pixel they look is drawn.
        add(4, .025, .2)
        add(16, .025, .2)
        results = study.run()
        got, lowest = point(results, BIASED, 16), technique(results, BIASED)["lowest"][0]
        self.assertGreater(got["relmse_noise"], .1 * got["relmse"])
        floor = technique(results, BIASED)["floor"]
        self.assertAlmostEqual(floor, got["relmse"] - got["relmse_noise"], delta=1e-9)
        biased = study.truth * (1 + .2 * (np.arange(study.width) >= study.width // 2)[:, None])
        self.assertAlmostEqual(floor, images.relmse(biased, study.truth), delta=.03 * floor)
        self.assertAlmostEqual(lowest["level_low"], got["relmse_low"] - got["relmse_noise"], delta=1e-9)
        self.assertAlmostEqual(lowest["level_high"], got["relmse_high"] - got["relmse_noise"], delta=1e-9)
        word, = [word for word in results["words"] if "gets no lower" in word]
        self.assertRegex(word, "with the settings of this study, noise taken off: that is bias, .* From samples 4 to 16 it did not fall")
        # A better setting with one count of samples is judged by the others only where hardly any of its error is noise.
        add(1, .02, .1, **{"vct.resolution": 128})
        results = study.run()
        self.assertEqual((technique(results, BIASED)["lowest"][0]["with_samples"], technique(results, BIASED)["floor"]), ("unknown", None))
        self.assertFalse([word for word in results["words"] if "gets no lower" in word])
        add(1, .002, .11, **{"vct.resolution": 256})
        study.lines = [line for line in study.lines if line["settings"].get("vct.resolution") != 128]
        results = study.run()
        self.assertEqual(technique(results, BIASED)["lowest"][0]["with_samples"], "held")
        self.assertTrue([word for word in results["words"] if "gets no lower" in word and "with others more samples changed nothing" in word])

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
        expected = next(p for p in technique(results, NOISY)["points"] if p["relmse_high"] < floor)
        self.assertEqual(view["overtakes"], [{"technique": NOISY, "overtaken": BIASED, "seconds": expected["seconds"], "from_first": False,
                                              "closer": True, "settings": expected["settings"]}])
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
        self.assertEqual([span["not_told_from"] for span in view["best"]], [None, None])

    def test_what_intervals_do_not_tell_apart_is_not_ranked(self):
        study = self.study
        study.add("reference", study.truth.astype(np.float32), kind="reference", settings={"samples": 4096}, seed=999)
        for seed, sigma in enumerate((.1, .2, .4)):
            study.add(f"n-{seed}", study.noisy(sigma), seed=seed)
            study.add(f"b-{seed}", (study.truth * 1.25).astype(np.float32), technique=BIASED, seed=seed, seconds=.5)
        results = study.run()
        view = results["views"][0]
        best, = [span for span in view["best"] if span["best_seconds"] == min(s["best_seconds"] for s in view["best"])]
        self.assertEqual(best["technique"], BIASED)
        self.assertEqual(view["best"][-1]["not_told_from"], NOISY if view["best"][-1]["technique"] == BIASED else BIASED)
        self.assertIsNone(view["overtakes"][0]["seconds"])
        self.assertTrue(any("not told apart" in word for word in results["words"]))
        self.assertFalse(any("overtakes" in word for word in results["words"]))
        study.lines = [line for line in study.lines if line["seed"] in (0, 999)]
        results = study.run()
        self.assertTrue(any("interval is known" in word for word in results["words"]))
        self.assertFalse(any("overlap" in word for word in results["words"]))

    def test_an_overtaking_is_the_winners_whoever_came_last(self):
        study = self.study
        study.add("reference", study.truth.astype(np.float32), kind="reference", settings={"samples": 4096}, seed=999)
        def add(name, technique, samples, seconds, factors):
            for seed, factor in enumerate(factors):
                study.add(f"{name}-{seed}", (study.truth * factor).astype(np.float32), technique=technique, seed=seed, seconds=seconds,
                          settings={"samples": samples})
        # The loser's second picture is better than its first, but known so closely that the winner's, made before, is told apart.
        add("wide", BIASED, 1, .5, (1.1, 1.4))
        add("noisy", NOISY, 8, 1, (1.1, 1.1))
        add("close", BIASED, 4, 2, (1.15, 1.15))
        results = study.run()
        self.assertEqual(results["views"][0]["overtakes"], [{"technique": NOISY, "overtaken": BIASED, "seconds": 2, "from_first": False,
                                                             "closer": True, "settings": {"samples": 8}}])
        self.assertTrue(any(f"{NOISY} overtakes {BIASED} at 2.0 s, with samples 8, and" in word for word in results["words"]))
        # Without the first there is nothing to overtake.
        study.lines = [line for line in study.lines if not line["id"].startswith("wide")]
        results = study.run()
        self.assertEqual([(o["seconds"], o["from_first"]) for o in results["views"][0]["overtakes"]], [(1, True)])
        self.assertTrue(any(f"{NOISY} is ahead of {BIASED} from its first picture, at 1.0 s with samples 8, and" in word for word in results["words"]))
        self.assertFalse(any("overtakes" in word for word in results["words"]))

    def test_what_is_not_resolved_has_no_rank(self):
        study = self.study.usual()
        study.lines[0]["report"].update(estimated_relmse=.005, relmse_low=.004, relmse_high=.012)
        results = study.run()
        points = [(t["name"], p) for t in results["techniques"] for p in t["points"]]
        lost = [p for _, p in points if not p["resolved"]]
        self.assertTrue(lost and len(lost) < len(points))
        self.assertFalse(any(p["pareto"] for p in lost))
        for row in results["views"][0]["equal_error"]:
            self.assertFalse([q for q in row["points"] for p in lost if p["command"] == q["command"]])
        self.assertFalse(results["views"][0]["best"][-1]["resolved"])
        self.assertTrue(any("within the reference's own error" in word for word in results["words"]))

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
        # Beside a worse reference the most samples are not resolved: what is left of their errors is the reference's noise.
        study.lines[0]["report"].update(relmse_low=.5 * own, relmse_high=1.01 * point(study.run(), NOISY, 64)["relmse"])
        predictions = study.run()["predictions"]
        self.assertEqual(predictions["not_resolved"], 8)
        self.assertEqual({row["of"]: row["runs"] for row in predictions["summary"]}, {"relmse": 24, "seconds": 32})
        self.assertIn("8 predictions of an error are left out", (study.folder / "report.html").read_text())

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
        self.assertAlmostEqual(float(row["relmse_noise"]), point(results, NOISY, 1)["relmse_noise"], delta=1e-8)
        self.assertEqual(row["command"], 'candil render "a, b.gltf"')

    def test_csv_has_no_formula(self):
        study = self.study.usual()
        for line, start in zip([line for line in study.lines if line["id"].endswith("-0") and line["technique"] == NOISY], "=+-@"):
            line["command"] = start + "HYPERLINK(1)"
        study.json["views"][0]["name"] = "=1+1"
        study.run()
        with open(study.folder / "results.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["view"] for row in rows}, {"'=1+1"})
        self.assertEqual({row["command"] for row in rows if row["technique"] == NOISY}, {f"'{start}HYPERLINK(1)" for start in "=+-@"})

    def test_same_folder_same_bytes(self):
        self.study.usual().run()
        names = ("results.json", "results.csv", "report.html")
        first = [(self.study.folder / name).read_bytes() for name in names]
        self.study.run()
        for name, bytes in zip(names, first):
            self.assertEqual((self.study.folder / name).read_bytes(), bytes, name)


if __name__ == "__main__":
    unittest.main()
