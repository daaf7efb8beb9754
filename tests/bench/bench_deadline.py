"""How well deadlines are kept, from a request's arrival to its image's last byte: warm frames, alone on the device.

    bench_deadline.py [--scenes WORD,…] [--techniques pt,…] [--times 50,200,…] [--sizes 64,…] [--frames N]

A row for each technique, size and deadline, over the scenes, PNG and EXR, with and without --error (pt): overrun in ms beyond the deadline,
median and 95th percentile, and the share of frames that were kept: by less than 10 % or 20 ms, the greater of both. `scaled`: frames made of
fewer pixels than asked for, and their share of them in the median. `none`: those that had no picture. `early`: frames that had all their samples
before. Deadlines of 5 s are asked for once where others are N times.

Then by technique how far the work on the device overran its own end, which leaves time for reading, encoding and sending: the worker's log
tells. Beside it what a tile of a whole picture takes, of the scene and size where that is most."""
import argparse
import itertools
import re

import bench
import make
import wire
from render import Daemon
from wire import pb

EVER = 1 << 20
TRIES = 30
ALLOWED = .1, 20.  # of the deadline; ms
DEVICE = ("trace", "caustics", "visibility", "light", "soften", "cones", "sum")  # stages that a sample takes


def scenes(folder):
    return {"cornell": make.cornell(folder), "first": bench.SOURCE + "/deploy/first.gltf"}


def ask(connection, **fields):
    """(its Done, the share of its pixels that were made); (None, 0) if the deadline left no picture"""
    replies = connection.follow(connection.send(wire.RENDER, pb.Render(**fields)))
    if not isinstance(replies[-1].body, pb.Done):
        assert replies[-1].body.name == "deadline", replies[-1].body
        return None, 0
    frame, _ = wire.images(replies)[-1]
    return replies[-1].body, frame.made_width * frame.made_height / (frame.width * frame.height)


def warm(connection, **fields):
    """Until a deadline leaves a picture: all sizes that it may be made of are compiled, and the scene's voxels are there."""
    for _ in range(TRIES):
        done, _ = ask(connection, **fields, deadline_ms=1000)
        if done and not any(s.name == "compile" and s.us > 1000 for s in done.stages):
            return


class Row:
    def __init__(self):
        self.over, self.made, self.none, self.early, self.allowed = [], [], 0, 0, 0

    def add(self, done, made, deadline):
        if not done:
            self.none += 1
        elif done.reason != "time":
            self.early += 1
        else:
            self.over.append(done.elapsed_us / 1e3 - deadline)
            self.made += [made] if made < 1 else []
            self.allowed = max(ALLOWED[0] * deadline, ALLOWED[1])

    def cells(self):
        if not self.over:
            return "", "", "", "", "", "", self.none, self.early
        kept = sum(over <= self.allowed for over in self.over)
        return (f"{bench.median(self.over):+.1f}", f"{bench.percentile(self.over, .95):+.1f}", f"{max(self.over):+.1f}",
                f"{kept} of {len(self.over)}", len(self.made), f"{100 * bench.median(self.made):.2g} %" if self.made else "", self.none, self.early)


def past_the_end(log):
    """µs, of each time that work on the device ended by its end."""
    # Where handing over leaves no time at all, the end is the clock's beginning.
    return [us for us in map(int, re.findall(r"pixels: (-?[0-9]+) us past the end", log)) if us < 10**8]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="cornell,first")
    parser.add_argument("--techniques", default="pt,direct,vct")
    parser.add_argument("--times", default="50,200,1000,5000")
    parser.add_argument("--sizes", default="64,256,512")
    parser.add_argument("--frames", type=int, default=4)
    options = parser.parse_args()
    rows, all_over, ends, seen = [], Row(), [], 0
    tile_us = dict.fromkeys(options.techniques.split(","), 0)
    with Daemon(environment={"CANDIL_LOG": "debug"}) as daemon, wire.Connection(daemon.socket) as connection:
        for name, path in scenes(daemon.folder).items():
            daemon.candil("load", path, "--name", name)
        bench.header(daemon.stats()["device"])
        for technique, size in itertools.product(options.techniques.split(","), map(int, options.sizes.split(","))):
            ways = [({"format": f}, {"target_error": e} if e else {}) for f in (pb.FORMAT_PNG, pb.FORMAT_EXR_FLOAT)
                    for e in ((0, 1e-9) if technique == "pt" else (0,))]
            by_time = {int(t): Row() for t in options.times.split(",")}
            for scene, way in itertools.product(options.scenes.split(","), ways):
                base = dict(scene=scene, width=size, height=size, technique=pb.Technique.Value("TECHNIQUE_" + technique.upper()), **way[0])
                warm(connection, **base, **way[1], samples=EVER)
                ask(connection, **base, samples=1)
                took = [ask(connection, **base, samples=4)[0].stages for _ in range(2)]
                us = min(sum(s.us for s in stages if s.name in DEVICE) / 4 for stages in took)
                tile_us[technique] = max(tile_us[technique], us / (size / 8) ** 2)
                for deadline, row in by_time.items():
                    for seed in range(1 if deadline >= 5000 else options.frames):
                        done, made = ask(connection, **base, **way[1], samples=EVER, deadline_ms=deadline, seed=seed)
                        row.add(done, made, deadline)
                        if done and done.reason == "time" and row.over[-1] > max(ALLOWED[0] * deadline, ALLOWED[1]):
                            print(f"# {technique} {scene} {size} {way} {deadline} ms: {row.over[-1]:+.1f}: "
                                  + ", ".join(f"{s.name} {s.us / 1e3:.1f}" for s in done.stages), flush=True)
            rows += [(technique, size, deadline, *row.cells()) for deadline, row in by_time.items()]
            past = past_the_end(daemon.read_log())
            ends.append((technique, past[seen:]))
            seen = len(past)
            for row in by_time.values():
                all_over.over += [over / max(row.allowed, 1) for over in row.over]
    bench.table(("technique", ">side", ">deadline, ms", ">overrun, median", ">p95", ">most", ">kept", ">scaled", ">made of", ">none", ">early"), rows)
    ends = [(t, [us for technique, past in ends if technique == t for us in past], us) for t, us in tile_us.items()]
    bench.table(("technique", ">ends", ">past the end, µs, median", ">p95", ">most", ">a tile, µs"),
                [(t, len(past), f"{bench.median(past):.0f}", f"{bench.percentile(past, .95):.0f}", max(past), f"{us:.0f}") for t, past, us in ends if past])
    if all_over.over:
        print(f"{sum(over <= 1 for over in all_over.over)} of {len(all_over.over)} kept; overrun over what is allowed: "
              f"median {bench.median(all_over.over):.2f}, p95 {bench.percentile(all_over.over, .95):.2f}")


if __name__ == "__main__":
    main()
