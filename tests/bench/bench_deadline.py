"""How well deadlines are kept, from a request's arrival to its image's last byte: warm frames, alone on the device.

    bench_deadline.py [--scenes WORD,…] [--techniques pt,…] [--times 50,200,…] [--sizes 64,…] [--frames N]

A row for each technique, size and deadline, over the scenes, PNG and EXR, with and without --error (pt): overrun in ms beyond the deadline,
median and 95th percentile, and the share of frames that were kept: by less than 10 % or 20 ms, the greater of both. A frame whose first
sample is later than the deadline by itself cannot be kept and is counted apart, `late`: what it takes is measured before, by a frame of
one sample. `early`: frames that had all their samples before. Deadlines of 5 s are asked for once where others are N times."""
import argparse
import itertools

import bench
import make
import wire
from render import Daemon
from wire import pb

EVER = 1 << 20
ALLOWED = .1, 20.  # of the deadline; ms


def scenes(folder):
    return {"cornell": make.cornell(folder), "first": bench.SOURCE + "/deploy/first.gltf"}


def ask(connection, **fields):
    done = connection.follow(connection.send(wire.RENDER, pb.Render(**fields)))[-1].body
    assert isinstance(done, pb.Done), done
    return done


class Row:
    def __init__(self):
        self.over, self.late, self.early, self.allowed = [], 0, 0, 0

    def add(self, done, deadline, first_ms):
        if done.reason != "time":
            self.early += 1
            return
        if first_ms > deadline:
            self.late += 1
            return
        self.over.append(done.elapsed_us / 1e3 - deadline)
        self.allowed = max(ALLOWED[0] * deadline, ALLOWED[1])

    def cells(self):
        if not self.over:
            return "", "", "", "", self.late, self.early
        kept = sum(over <= self.allowed for over in self.over)
        return (f"{bench.median(self.over):+.1f}", f"{bench.percentile(self.over, .95):+.1f}", f"{max(self.over):+.1f}",
                f"{kept} of {len(self.over)}", self.late, self.early)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="cornell,first")
    parser.add_argument("--techniques", default="pt,direct,vct")
    parser.add_argument("--times", default="50,200,1000,5000")
    parser.add_argument("--sizes", default="64,256,512")
    parser.add_argument("--frames", type=int, default=4)
    options = parser.parse_args()
    rows, all_over = [], Row()
    with Daemon() as daemon, wire.Connection(daemon.socket) as connection:
        for name, path in scenes(daemon.folder).items():
            daemon.candil("load", path, "--name", name)
        bench.header(daemon.stats()["device"])
        for technique, size in itertools.product(options.techniques.split(","), map(int, options.sizes.split(","))):
            ways = [({"format": f}, {"target_error": e} if e else {}) for f in (pb.FORMAT_PNG, pb.FORMAT_EXR_FLOAT)
                    for e in ((0, 1e-9) if technique == "pt" else (0,))]
            by_time = {int(t): Row() for t in options.times.split(",")}
            for scene, way in itertools.product(options.scenes.split(","), ways):
                base = dict(scene=scene, width=size, height=size, technique=pb.Technique.Value("TECHNIQUE_" + technique.upper()), **way[0])
                ask(connection, **base, **way[1], samples=EVER, deadline_ms=1000)
                ask(connection, **base, samples=1)
                first_ms = min(ask(connection, **base, samples=1).elapsed_us for _ in range(2)) / 1e3
                for deadline, row in by_time.items():
                    for seed in range(1 if deadline >= 5000 else options.frames):
                        done = ask(connection, **base, **way[1], samples=EVER, deadline_ms=deadline, seed=seed)
                        row.add(done, deadline, first_ms)
                        if row.over and done.reason == "time" and row.over[-1] > max(ALLOWED[0] * deadline, ALLOWED[1]):
                            print(f"# {technique} {scene} {size} {way} {deadline} ms: {row.over[-1]:+.1f}: "
                                  + ", ".join(f"{s.name} {s.us / 1e3:.1f}" for s in done.stages), flush=True)
            rows += [(technique, size, deadline, *row.cells()) for deadline, row in by_time.items()]
            for row in by_time.values():
                all_over.over += [over / max(row.allowed, 1) for over in row.over]
    bench.table(("technique", ">side", ">deadline, ms", ">overrun, median", ">p95", ">most", ">kept", ">late", ">early"), rows)
    if all_over.over:
        print(f"{sum(over <= 1 for over in all_over.over)} of {len(all_over.over)} kept; overrun over what is allowed: "
              f"median {bench.median(all_over.over):.2f}, p95 {bench.percentile(all_over.over, .95):.2f}")


if __name__ == "__main__":
    main()
