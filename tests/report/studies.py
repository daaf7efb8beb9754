"""Studies of made-up pictures: a folder as `candil study` leaves it, and candil-report on it."""
import json
import os
import pathlib
import subprocess

import numpy as np

import images

PROGRAM = pathlib.Path(os.environ["CANDIL_BUILD"]) / "libexec" / "candil" / "candil-report"
NOISY, BIASED = "pt", "vct"  # a technique that converges and one that does not, of protocol/names.h


class Study:
    """Runs are added one by one, then written; `truth` is what endless samples would give."""

    def __init__(self, folder, size=(48, 32), views=1, seed=1):
        self.folder = pathlib.Path(folder)
        (self.folder / "images").mkdir(parents=True, exist_ok=True)
        self.random = np.random.default_rng(seed)
        self.width, self.height = size
        smooth = self.random.uniform(0, 2, (self.height // 8, self.width // 8, 3))
        self.truth = np.repeat(np.repeat(smooth, 8, axis=0), 8, axis=1)
        self.lines = []
        self.pictures = {}
        self.json = {
            "version": 1, "title": "", "scene": {"file": "made.gltf", "hash": "00ff", "triangles": 12}, "command": "candil study made.gltf -o out",
            "candil": "0.2.0", "device": "none", "machine": {"cpu": "one", "cores": 2}, "started": "2026-01-01T00:00:00Z", "ended": "2026-01-01T00:01:00Z",
            "size": [self.width, self.height], "views": [{"name": f"view {i + 1}", "camera": None} for i in range(views)],
            "techniques": [NOISY, BIASED], "settings_varied": {}, "budget_s": 60, "seeds": 8, "complete": True, "missing": [], "skipped": [], "notes": [],
        }

    def noisy(self, sigma):
        return (self.truth + self.random.normal(0, sigma, self.truth.shape)).astype(np.float32)

    def add(self, id, picture, kind="point", technique=NOISY, settings=None, seed=0, seconds=1.0, error=None, **more):
        """Add a run. `error`: what the reply says of its error, (relmse, low, high)."""
        if picture is not None:
            images.write(self.folder / "images" / f"{id}.exr", picture)
            self.pictures[id] = picture.astype(np.float64)
        error = error or (None, None, None)
        settings = settings or {"samples": 1}
        report = {"elapsed_us": round(1e6 * seconds), "cold_us": 0, "samples": settings["samples"],
                  "stages": [{"name": "trace", "us": round(8e5 * seconds)}, {"name": "encode", "us": round(2e5 * seconds)}],
                  "error_kind": "measured" if error[0] is not None else "unknown",
                  "estimated_relmse": error[0], "relmse_low": error[1], "relmse_high": error[2]}
        report.update(more.pop("report", {}))
        line = {"id": id, "kind": kind, "view": 0, "technique": technique, "settings": settings, "effects": "auto", "seed": seed, "warm": True,
                "image": f"images/{id}.exr", "command": f"candil render made.gltf -o {id}.exr", "report": report, "quote": None, "failed": None}
        line.update(more)
        self.lines.append(line)
        return line

    def usual(self, sigma=0.25, bias=0.2, seeds=8):
        """A reference, a noisy technique that halves its error by doubling its time, and one with a bias in half the picture."""
        self.add("reference", self.noisy(sigma / 64), kind="reference", settings={"samples": 4096}, seed=999,
                 error=(float(np.mean((sigma / 64) ** 2 / (self.truth ** 2 + .01))), None, None))
        for samples in (1, 4, 16, 64):
            for seed in range(seeds):
                self.add(f"n-{samples}-{seed}", self.noisy(sigma / samples ** .5), settings={"samples": samples}, seed=seed,
                         seconds=.1 * samples * (1 + .01 * seed))
        for samples, more in ((1, .3), (4, 0), (16, 0)):
            wrong = self.truth.copy()
            wrong[:, self.width // 2:] *= 1 + bias + more
            for seed in range(2):
                self.add(f"b-{samples}-{seed}", wrong.astype(np.float32), technique=BIASED, settings={"samples": samples}, seed=seed,
                         seconds=.05 * samples)
        return self

    def write(self, tail=""):
        (self.folder / "study.json").write_text(json.dumps(self.json))
        (self.folder / "runs.jsonl").write_text("".join(json.dumps(line) + "\n" for line in self.lines) + tail)

    def run(self, *arguments, expect=0):
        self.write()
        return report(self.folder, *arguments, expect=expect)


def report(folder, *arguments, expect=0):
    """Run candil-report; its results.json, or what it said where it should fail."""
    done = subprocess.run([str(PROGRAM), str(folder), *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == expect, f"exit status {done.returncode}: {done.stderr}"
    return done.stderr if expect else json.loads((pathlib.Path(folder) / "results.json").read_text())


def technique(results, name):
    return next(t for t in results["techniques"] if t["name"] == name)


def point(results, name, samples):
    return next(p for p in technique(results, name)["points"] if p["settings"]["samples"] == samples)
