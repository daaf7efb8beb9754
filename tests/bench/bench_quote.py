#!/usr/bin/env python3
"""How good quotes are: of requests for scenes that nothing is known of, and for views of them that frames have shown by then.

    bench_quote.py [--short] [--reference SPP] [--json FILE]

For each scene: a view nobody has seen, at two sizes and numbers of samples; another camera; another light; then direct and vct,
which are looked at by --pilot. Each request is quoted and then rendered; its true error is that beside a converged picture, whose
own estimated error is taken off. Straight after it the same is rendered with another seed: how far two frames of one request are
apart is what no quote can know, of the machine's time and of luck. Then auto: its error beside the best of what fits the same time, and
how late it is. Prints tables; judges nothing. Needs a machine with nothing else to do: CANDIL_BUILD, CANDIL_SOURCE and PYTHONPATH as for
a test. Some 10 minutes on two cores, --short 2.
"""
import argparse
import json
import math
import time

import numpy

import gallery
import hidden
import make
from render import Daemon, Picture

SMALL, OTHER = (64, 64), (88, 66)


def scenes(folder):
    """(name, file, arguments)"""
    made = [(f.__name__, f(folder), []) for f in (make.cornell, make.cornell_glass, make.many_lamps, make.coats, hidden.brushed,
                                                  hidden.panes)]
    return made + [(name, gallery.SCENES[name](folder), gallery.arguments(name)) for name in (
        "village", "mirror_floor", "cut_out", "cornell_mirror", "cornell_spheres", "cornell_weekend")]


def relmse(x, r):
    x, r = x.astype(numpy.float64), r.astype(numpy.float64)
    return float(((x - r) ** 2 / (r ** 2 + 0.01)).mean())


class Bench:
    def __init__(self, daemon, reference_spp):
        self.daemon, self.spp = daemon, reference_spp
        self.references, self.rows, self.waits, self.guesses = {}, [], [], 0

    def camera(self, info, turn):
        """The scene's own camera, or one beside it: turned about its target, a little nearer."""
        c = info["cameras"][0]
        eye, target = numpy.array(c["eye"]), numpy.array(c["target"])
        a = math.radians(turn)
        way = numpy.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]]) @ (eye - target)
        eye = target + way * (1 if turn == 0 else 0.92)
        return [*eye, *target, *c["up"], c["vfov_degrees"] or 40]

    def reference(self, scene, size, camera, arguments):
        key = (scene, size, tuple(camera), tuple(arguments))
        if key not in self.references:
            picture = self.daemon.render(scene, size, self.spp, camera, arguments=[*arguments, "--technique", "pt", "--seed", "91"],
                                         default_light=True)
            self.references[key] = picture.radiance, max(picture.report["estimated_relmse"] or 0, 0)
        return self.references[key]

    def truth(self, picture, scene, size, camera, arguments):
        reference, noise = self.reference(scene, size, camera, arguments)
        found = relmse(picture.radiance, reference)
        # A reference that is not converged tells nothing.
        return found - noise if noise < 0.3 * found else math.nan

    def quote(self, scene, size, camera, arguments, *more):
        start = time.monotonic()
        _, out, _ = self.daemon.candil("quote", scene, "--json", "--size", f"{size[0]}x{size[1]}", "--camera",
                                       ",".join(repr(float(c)) for c in camera), *arguments, *more)
        if "--pilot" not in more:
            self.waits.append(time.monotonic() - start)
        return json.loads(out)

    def guess(self, scene, size, camera, arguments, more):
        """The answer within a second; then wait for what it has set going."""
        said = self.quote(scene, size, camera, arguments, *more)
        self.guesses += said["from"] == "model"
        records, end = said["records"], time.monotonic() + 60
        while said["from"] == "model" and said["records"] <= records and time.monotonic() < end:
            time.sleep(0.2)
            said = self.quote(scene, size, camera, arguments, *more)

    def request(self, kind, scene, size, spp, camera, arguments, technique="pt", pilot=None):
        more = ["--technique", technique, "--spp", str(spp), *(["--pilot", str(pilot)] if pilot else [])]
        if kind != "seen" and not pilot:
            # Programs are compiled, and the pilot comes back: what is asked is how good a quote is after it, not how it guesses.
            self.guess(scene, size, camera, arguments, more)
        said = self.quote(scene, size, camera, arguments, *more)
        found = []
        for seed in ("7", "8"):
            picture = self.daemon.render(scene, size, spp, camera, default_light=True,
                                         arguments=[*arguments, "--technique", technique, "--seed", seed])
            found.append(((picture.report["elapsed_us"] - picture.report["cold_us"]) / 1000,
                          self.truth(picture, scene, size, camera, arguments)))
        (took, true), twin = found
        self.rows.append({"kind": kind, "scene": scene, "technique": technique, "spp": spp, "size": size, "from": said["from"],
                          "ms": took, "true": true, "twin": twin, "said": said})
        r = self.rows[-1]
        print(f"{scene:16} {kind:16} {technique:6} {size[0]:3}x{size[1]:<3} {spp:3} {said['from']:5}  "
              f"{said['time_ms']:8.1f} ms said, {took:8.1f} took ({said['time_ms'] / took:5.2f})   "
              f"{said['relmse']:.2e} said, {true:.2e} true ({said['relmse'] / true:5.2f})"
              f"{'' if inside(r, 'time') else '  time outside'}{'' if inside(r, 'error') else '  error outside'}", flush=True)

    def scene(self, scene, arguments):
        info = json.loads(self.daemon.candil("describe", scene, "--json")[1])
        here, there = self.camera(info, 0), self.camera(info, 14)
        low, high = numpy.array(info["bounds_min"]), numpy.array(info["bounds_max"])
        at = ",".join(f"{x:.4g}" for x in (low + high) / 2 + (high - low) * (0, .2, .15))
        lit = [*arguments, "--light", f"point:at={at},intensity=2"]
        self.request("unseen", scene, SMALL, 16, here, arguments)
        self.request("seen", scene, OTHER, 8, here, arguments)
        self.request("seen", scene, SMALL, 48, here, arguments)
        self.request("other camera", scene, SMALL, 16, there, arguments)
        self.request("other light", scene, SMALL, 12, here, lit)
        self.request("seen", scene, SMALL, 40, there, arguments)
        for technique in ("direct", "vct"):
            self.request("unseen", scene, SMALL, 1, here, arguments, technique, pilot=200)

    def regret(self, scene, arguments, milliseconds):
        """auto's error at a time over the least of what took no longer."""
        info = json.loads(self.daemon.candil("describe", scene, "--json")[1])
        camera = self.camera(info, 0)
        auto = self.daemon_render(scene, camera, [*arguments, "--time", str(milliseconds)])
        found = {auto.report["technique"]: self.truth(auto, scene, SMALL, camera, arguments)}
        mine = found[auto.report["technique"]]
        for technique in ("pt", "direct", "vct"):
            other = self.daemon_render(scene, camera, [*arguments, "--technique", technique, "--time", str(milliseconds)])
            if other.report["elapsed_us"] <= max(auto.report["elapsed_us"], 1000 * milliseconds) * 1.1:
                error = self.truth(other, scene, SMALL, camera, arguments)
                found[technique] = min(found.get(technique, error), error)
        print(f"{scene:16} {milliseconds:5} ms: auto is {auto.report['technique']} ({auto.report['quote']['why']}), regret "
              f"{mine / min(found.values()):.2f}; " + ", ".join(f"{t} {e:.2e}" for t, e in found.items()), flush=True)
        return mine / min(found.values())

    def daemon_render(self, scene, camera, arguments):
        # --time ends with status 7: the picture is what counts.
        status, out, err = self.daemon.candil("render", scene, "-o", self.daemon.folder + "/auto.exr", "--json", "--size",
                                              f"{SMALL[0]}x{SMALL[1]}", "--camera", ",".join(repr(float(c)) for c in camera),
                                              "--seed", "7", *arguments, check=False)
        if status not in (0, 7):
            raise RuntimeError(err)
        return Picture(self.daemon.folder + "/auto.exr", json.loads(out))


def ratio(row, which):
    said, true = (row["said"]["time_ms"], row["ms"]) if which == "time" else (row["said"]["relmse"], row["true"])
    return max(said / true, true / said) if true > 0 else math.inf


def apart(row, which):
    """What `ratio` is if the next frame of the same request is taken for the quote."""
    one, other = (row["ms"], row["twin"][0]) if which == "time" else (row["true"], row["twin"][1])
    return max(one / other, other / one) if min(one, other) > 0 else math.inf


def inside(row, which):
    key, true = ("time_ms", row["ms"]) if which == "time" else ("relmse", row["true"])
    return row["said"][key + "_low"] <= true <= row["said"][key + "_high"]


def width(row, which):
    key = "time_ms" if which == "time" else "relmse"
    return math.sqrt(row["said"][key + "_high"] / row["said"][key + "_low"])


def share(rows, condition):
    return f"{100 * sum(map(condition, rows)) / max(len(rows), 1):5.1f} %"


def summary(rows):
    groups = [("seen, pt", [r for r in rows if r["kind"] == "seen"]),
              ("unseen view, pt", [r for r in rows if r["kind"] != "seen" and r["technique"] == "pt"]),
              ("direct", [r for r in rows if r["technique"] == "direct"]), ("vct", [r for r in rows if r["technique"] == "vct"]),
              ("all", rows)]
    print("\n| requests | | time ±10 % | ±25 % | inside | median width | error ×1.3 | ×1.5 | inside | median width |\n"
          "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, group in groups:
        if group:
            known = [r for r in group if not math.isnan(r["true"])]
            print(f"| {name} | {len(group)}, {len(known)} with a converged reference | {share(group, lambda r: ratio(r, 'time') <= 1.1)} | "
                  f"{share(group, lambda r: ratio(r, 'time') <= 1.25)} | {share(group, lambda r: inside(r, 'time'))} | "
                  f"±{100 * (numpy.median([width(r, 'time') for r in group]) - 1):.0f} % | "
                  f"{share(known, lambda r: ratio(r, 'error') <= 1.3)} | {share(known, lambda r: ratio(r, 'error') <= 1.5)} | "
                  f"{share(known, lambda r: inside(r, 'error'))} | ×{numpy.median([width(r, 'error') for r in group]):.2f} |")
            print(f"| its next frame | | {share(group, lambda r: apart(r, 'time') <= 1.1)} | "
                  f"{share(group, lambda r: apart(r, 'time') <= 1.25)} | | | {share(known, lambda r: apart(r, 'error') <= 1.3)} | "
                  f"{share(known, lambda r: apart(r, 'error') <= 1.5)} | | |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--reference", type=int, default=384, metavar="SPP")
    parser.add_argument("--json", metavar="FILE", help="write every request here")
    options = parser.parse_args()
    with Daemon() as daemon:
        bench = Bench(daemon, options.reference)
        known = scenes(daemon.folder)[:: 4 if options.short else 1]
        for name, path, arguments in known:
            daemon.candil("load", path, "--name", name)
            bench.scene(name, arguments)
        summary(bench.rows)
        print(f"\n{len(bench.rows)} requests, {len(known)} scenes; a quote without --pilot took at most "
              f"{max(bench.waits):.2f} s of the clock with its command; {bench.guesses} were guesses, for their pilots "
              "compiled or came late\n")
        regrets = [bench.regret(name, arguments, ms) for name, _, arguments in known for ms in (50, 400, 1500)]
        unknown = len(regrets)
        regrets = [r for r in regrets if not math.isnan(r)]
        print(f"{unknown - len(regrets)} of them have no converged reference")
        print(f"\nregret of auto: at most 1.2 in {share(regrets, lambda r: r <= 1.2)} of {len(regrets)}, median "
              f"{numpy.median(regrets):.2f}, most {max(regrets):.2f}\n")
        name, _, arguments = known[0]
        camera = bench.camera(json.loads(daemon.candil("describe", name, "--json")[1]), 0)
        for ms in (50, 200, 1000, 5000):
            late = [bench.daemon_render(name, camera, [*arguments, "--time", str(ms)]).report["elapsed_us"] / 1000 - ms
                    for _ in range(3 if ms == 5000 or options.short else 12)]
            print(f"auto --time {ms}: late by {numpy.percentile(late, 95):.1f} ms at the 95th percentile, {max(late):.1f} at most, "
                  f"{max(20, ms / 10):.0f} allowed", flush=True)
        if options.json:
            with open(options.json, "w", encoding="utf-8") as file:
                json.dump(bench.rows, file)


if __name__ == "__main__":
    main()
