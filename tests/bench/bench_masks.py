"""The worker's memory over many sets of effects, each of which is code of its own: bench_masks.py [TECHNIQUE [COUNT]]. It rises until
as many are kept as may be (PIPELINES_MAX, GL_PROGRAMS_MAX) and is level from then on. With an empty shader cache each set is compiled
first, seconds of a processor; with a full one the time told is what a known set costs."""
import itertools
import random
import sys
import time

import make
import wire
from render import Daemon
from wire import pb

BITS = [pb.Effect.Value("EFFECT_" + name) for name in ("TEXTURES", "EMITTERS", "LIGHTS", "ENVIRONMENT", "GLOSSY", "NORMAL_MAPS",
                                                       "ALPHA_MASK", "VERTEX_COLORS", "UNLIT", "ALPHA_BLEND", "CLEARCOAT",
                                                       "ROUGH_DIFFUSE")]
TELL = 10


def sets(count):
    """The smallest sets, which are quick to compile, in an order that repeats."""
    smallest = itertools.chain.from_iterable(itertools.combinations(BITS, n) for n in range(len(BITS) + 1))
    chosen = list(itertools.islice(smallest, count))
    random.Random(1).shuffle(chosen)
    return [sum(1 << bit for bit in bits) for bits in chosen]


def resident_mib(pid):
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:")) / 1024


def main():
    technique = sys.argv[1] if len(sys.argv) > 1 else "pt"
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    print("| sets so far | worker, MiB | median of their times, ms | workers started |\n| --- | --- | --- | --- |")
    with Daemon() as daemon:
        daemon.candil("load", make.SCENES["furnace"](daemon.folder), "--name", "room")
        with wire.Connection(daemon.socket) as connection:
            times = []
            for i, effects in enumerate(sets(count)):
                render = pb.Render(scene="room", width=32, height=32, samples=1, effects_on=effects,
                                   technique=pb.Technique.Value("TECHNIQUE_" + technique.upper()))
                start = time.monotonic()
                done = connection.follow(connection.send(wire.RENDER, render))[-1]
                assert done.kind == wire.DONE, done
                times.append(time.monotonic() - start)
                if (i + 1) % TELL == 0 or i + 1 == count:
                    stats = connection.stats()
                    print(f"| {i + 1} | {resident_mib(stats.worker_pid):.0f} | {1e3 * sorted(times)[len(times) // 2]:.0f} "
                          f"| {stats.worker_starts} |", flush=True)
                    times = []


if __name__ == "__main__":
    main()
