#!/usr/bin/env python3
"""How good quotes of radiosity are: of a scene that was just loaded, of the same from another camera once it is solved, and with
other options of the picture alone, beside what renders took.

    bench_quote_radiosity.py [--short] [--pilot MS] [--json FILE]

Each case is a scene under a new name, of which a worker keeps nothing, in one daemon, which learns from each. A case is quoted
(with --pilot: by one), rendered, quoted and rendered from another camera, and its patches are made as a file. What compiling takes
is in none of the times. Prints a table and a summary; judges nothing. CANDIL_BUILD, CANDIL_SOURCE and PYTHONPATH as for a test.
"""
import argparse
import json
import os
import statistics
import time

import make
from render import Daemon, Failed

SIZE = "160x160"
OTHER = "--camera=0.2,0.9,2.6,0,0.9,0,0,1,0,50"


def cases(short):
    """Options by name."""
    def of(patches, **more):
        return {"patches": patches, **more}
    all_of = [of(500, rays=64), of(500, rays=1024), of(4096, rays=64), of(4096, rays=1024), of(4096, rays=1024, display="gather"),
              of(500, factors="hemicube"), of(500, factors="analytic", rays=64), of(4096, factors="hemicube", hemicube=32)]
    return all_of[:-2] if short else [*all_of, of(20000, rays=64), of(20000, rays=1024)]


class Bench:
    def __init__(self, daemon, pilot):
        self.daemon, self.pilot, self.rows = daemon, pilot, []

    def options(self, case):
        return [w for key, value in case.items() for w in ("--set", f"radiosity.{key}={value}")]

    def quote(self, name, arguments):
        # Programs are compiled beside, and the pilot comes back: what is asked is how good a quote is after it.
        end = time.monotonic() + 60
        while True:
            said = json.loads(self.daemon.candil("quote", name, "--json", "--size", SIZE, "--spp", "4", "--technique", "radiosity",
                                                 *arguments, *(["--pilot", str(self.pilot)] if self.pilot else []))[1])
            waits = said["records"] == 0 or any("not back" in note for note in said["notes"])
            if not waits or time.monotonic() > end:
                return said
            time.sleep(0.3)

    def render(self, name, arguments, output="out.exr"):
        return json.loads(self.daemon.candil("render", name, "-o", os.path.join(self.daemon.folder, output), "--json", "--size", SIZE,
                                             "--spp", "4", "--technique", "radiosity", *arguments)[1])

    def row(self, scene, what, case, said, frame):
        took = (frame["elapsed_us"] - frame["cold_us"]) / 1000
        self.rows.append({"scene": scene, "what": what, "case": case, "said": said, "ms": took})
        print(f"| {scene} | {', '.join(f'{k} {v}' for k, v in case.items())} | {what} | {said['time_ms']:.0f} "
              f"({said['time_ms_low']:.0f} … {said['time_ms_high']:.0f}) | {took:.0f} | {said['time_ms'] / took:.2f} | "
              f"{'' if said['time_ms_low'] <= took <= said['time_ms_high'] else 'outside'} | "
              f"{said['relmse'] if said['relmse'] is not None else 'unknown'} |", flush=True)

    def case(self, scene, path, case, camera):
        name = f"{scene}-{len(self.rows)}"
        self.daemon.candil("load", path, "--name", name)
        options = self.options(case)
        said = self.quote(name, options)
        try:
            frame = self.render(name, options)
        except Failed as failure:
            print(f"| {scene} | {', '.join(f'{k} {v}' for k, v in case.items())} | first picture | {said['time_ms']:.0f} | none | | "
                  f"{str(failure).split(':')[1]} | |", flush=True)
            return
        self.row(scene, "first picture", case, said, frame)
        said = self.quote(name, [*options, camera])
        self.row(scene, "another camera", case, said, self.render(name, [*options, camera]))
        # A file asks for the same solution, which is there.
        self.render(name, options, "out.ply")
        self.daemon.candil("unload", name)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--pilot", type=int, metavar="MS")
    parser.add_argument("--json", metavar="FILE", help="write every row here")
    options = parser.parse_args()
    with Daemon() as daemon:
        bench = Bench(daemon, options.pilot)
        scenes = {"cornell": make.cornell(daemon.folder),
                  "first": os.path.join(os.environ["CANDIL_SOURCE"], "deploy", "first.gltf")}
        print("| scene | radiosity | | said, ms | took, ms | said / took | | error said |\n| --- | --- | --- | ---: | ---: | ---: | --- | ---: |")
        for scene, path in scenes.items():
            for case in cases(options.short):
                bench.case(scene, path, case, OTHER)
    ratios = [max(r["said"]["time_ms"] / r["ms"], r["ms"] / r["said"]["time_ms"]) for r in bench.rows]
    inside = sum(r["said"]["time_ms_low"] <= r["ms"] <= r["said"]["time_ms_high"] for r in bench.rows)
    print(f"\n{len(ratios)} quotes: factor {statistics.median(ratios):.2f} in the median, {max(ratios):.2f} at most; {inside} inside")
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(bench.rows, file)


if __name__ == "__main__":
    main()
