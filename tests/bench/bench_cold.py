"""What code that has to be compiled costs, whom it keeps waiting, and what is left of it the second time.

    bench_cold.py [--old BUILD] [--runs N]

First the whole of `candil render` of deploy/first.gltf, 64x64, without a daemon, once with an empty shader cache and then N times with
it full, of this build and in turns of another one. Then a second client's previews of a loaded scene: alone, and while the first
client's picture is compiled with an empty cache; how many slices of the daemon's they waited is told beside them."""
import argparse
import os
import subprocess
import tempfile
import threading
import time

import bench
import wire
from render import Daemon
from wire import pb

SCENE = os.path.join(bench.SOURCE, "deploy", "first.gltf")
SLICE_MS = 50
TECHNIQUES = ("pt", "vct", "direct")


def first_frame(build, technique, cache, folder):
    command = [os.path.join(build, "bin", "candil"), "render", SCENE, "-o", os.path.join(folder, "x.png"), "--size", "64x64", "--spp", "4",
               "--technique", technique]
    start = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                   env=dict(os.environ, MESA_SHADER_CACHE_DIR=cache))
    return 1e3 * (time.monotonic() - start)


def share(values, part):
    return sorted(values)[min(int(part * len(values)), len(values) - 1)]


def first_frames(builds, runs):
    print("| technique | build | empty cache, ms | full: least | median | most |\n| --- | --- | ---: | ---: | ---: | ---: |")
    for technique in TECHNIQUES:
        with tempfile.TemporaryDirectory() as folder:
            caches = {build: os.path.join(folder, str(i)) for i, build in enumerate(builds)}
            cold = {build: first_frame(build, technique, caches[build], folder) for build in builds}
            times = {build: [] for build in builds}
            for _ in range(runs):
                for build in builds:
                    times[build].append(first_frame(build, technique, caches[build], folder))
            for build in builds:
                t = times[build]
                print(f"| `{technique}` | {'this' if build == builds[0] else 'old'} | {cold[build]:.0f} | {min(t):.0f} | "
                      f"{share(t, .5):.0f} | {max(t):.0f} |", flush=True)


def preview(connection):
    start = time.monotonic()
    done = connection.follow(connection.send(wire.RENDER, pb.Render(scene="a", width=64, height=64, samples=1,
                                                                    technique=pb.TECHNIQUE_DIRECT)))[-1]
    assert done.kind == wire.DONE, done
    return 1e3 * (time.monotonic() - start)


def previews():
    with tempfile.TemporaryDirectory() as cache, Daemon(environment={"MESA_SHADER_CACHE_DIR": cache}) as daemon:
        daemon.candil("load", SCENE, "--name", "a")
        with wire.Connection(daemon.socket) as one, wire.Connection(daemon.socket) as two:
            preview(two)
            alone = [preview(two) for _ in range(40)]
            other = threading.Thread(target=lambda: one.follow(one.send(wire.RENDER, pb.Render(
                scene="a", width=64, height=64, samples=4, technique=pb.TECHNIQUE_PT))))
            start = time.monotonic()
            other.start()
            beside = []
            while other.is_alive():
                beside.append(preview(two))
            other.join()
            took = time.monotonic() - start
    print(f"\nPreviews, {len(beside)} in the {took:.1f} s that the first client's picture took with its compiling, ms:\n\n"
          "| | median | 95th percentile | most |\n| --- | ---: | ---: | ---: |")
    for name, values in (("alone", alone), ("beside", beside)):
        print(f"| {name} | {share(values, .5):.0f} | {share(values, .95):.0f} | {max(values):.0f} |")
    print(f"\nThe 95th percentile beside is {(share(beside, .95) - share(alone, .5)) / SLICE_MS:.1f} slices of {SLICE_MS} ms more than the median alone.")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--old", action="append", default=[])
    parser.add_argument("--runs", type=int, default=7)
    options = parser.parse_args()
    first_frames([wire.BUILD, *options.old], options.runs)
    previews()


if __name__ == "__main__":
    main()
