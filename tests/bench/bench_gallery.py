"""What the path tracer's pictures of the gallery cost: by samples, depth and resolution; accumulated; with directions by the cosine
or uniform; and what error so many samples leave. Beside our rows, where there are any, those of a hardware ray tracer (an RTX 2070
Super, 1280 x 720) and of a single-threaded path tracer on a CPU, as published: other machines and scenes much like these, so it
is the growth from row to row that compares, not the milliseconds.

    bench_gallery.py [--quick] [--pictures FOLDER]

`--quick` renders a quarter of the width and height; `--pictures` keeps a picture of each scene and of each depth."""
import argparse
import json
import os

import numpy

import bench
import gallery
from images import relmse, write
from render import Daemon

RESOLUTIONS = ((1280, 720), (1920, 1080), (2560, 1440))
ERROR_SIZE = (160, 90)
REFERENCE = 1024
# Published milliseconds: by samples, by depth with 10 samples, by resolution; and the two columns of the CPU's comparison.
BY_SAMPLES = {5: 12, 10: 20, 15: 28, 20: 35}
BY_DEPTH = {10: 19, 20: 24, 50: 28}
BY_SIZE = dict(zip(RESOLUTIONS, (9.6, 21, 36)))
BY_TIME = {1: (2.6, 1032), 5: (11, 3934), 10: (20.4, 7459), 20: (39, 14516), 100: (200, 69573), 1000: (2000, 688388)}

ACCUMULATED = ((1, 100), (10, 200))
EQUAL_TIME = {4: 5, 70: 100}


def trace_ms(picture):
    return next(stage["us"] for stage in picture.report["stages"] if stage["name"] == "trace") / 1e3


def grown(rows):
    """Rows of (label, ours in ms, theirs in ms) with each one's ratio to the first row's."""
    first = rows[0]
    for label, ours, theirs in rows:
        yield label, f"{ours:.1f}", f"{ours / first[1]:.2f}", theirs, f"{theirs / first[2]:.2f}"


COLUMNS = ("", ">ms", ">to the first", ">published ms", ">to the first")


class Bench:
    def __init__(self, daemon, quick):
        self.daemon, self.quick = daemon, quick

    def render(self, name, size=RESOLUTIONS[0], spp=1, options=None, exact=False, **more):
        size = size if exact or not self.quick else tuple(n // 4 for n in size)
        return self.daemon.render(gallery.SCENES[name](self.daemon.folder), size, spp, options=options,
                                  arguments=[*gallery.arguments(name), *more.get("arguments", [])])

    def by_samples(self):
        print("### By samples\n\nThe original box, depth 10.\n")
        rows = [(n, trace_ms(self.render("cornell_original", spp=n, options={"pt.depth": 10})), ms) for n, ms in BY_SAMPLES.items()]
        bench.table(("samples", *COLUMNS[1:]), grown(rows))

    def by_depth(self, pictures):
        print("### By depth\n\nThe box with spheres, 10 samples. Error: relMSE against the deepest, what is cut off and noise together.\n")
        rows = [(n, trace_ms(self.render("cornell_spheres", spp=10, options={"pt.depth": n})), ms) for n, ms in BY_DEPTH.items()]
        bench.table(("depth", *COLUMNS[1:]), grown(rows))
        whole = self.render("cornell_spheres", ERROR_SIZE, 512, {"pt.depth": 50}, exact=True).radiance
        shown = []
        for depth in (1, 2, 3, 4, 20, 50):
            picture = self.render("cornell_spheres", ERROR_SIZE, 64, {"pt.depth": depth}, exact=True).radiance
            shown.append((depth, f"{picture.mean() / whole.mean():.3f}", f"{relmse(picture, whole):.1e}"))
            keep(pictures, f"depth_{depth}", picture)
        bench.table(("depth", ">mean, of the whole", ">error, 64 samples"), shown)

    def by_size(self):
        print("### By resolution\n\nThe original box, 4 samples (published: some 5).\n")
        rows = [("%d x %d" % size, trace_ms(self.render("cornell_original", size, 4)), ms) for size, ms in BY_SIZE.items()]
        bench.table(("pixels", *COLUMNS[1:]), grown(rows))

    def by_time(self):
        print("### By the error that is left\n\nThe box with a ball and a metal block; time at 1280 x 720, error at "
              f"{ERROR_SIZE[0]} x {ERROR_SIZE[1]} against {REFERENCE} samples of another seed.\n")
        name = "cornell_weekend"
        reference = self.render(name, ERROR_SIZE, REFERENCE, arguments=["--seed", "77"], exact=True).radiance
        one = trace_ms(self.render(name, spp=8)) / 8
        rows = []
        for n, (gpu, cpu) in BY_TIME.items():
            ms = trace_ms(self.render(name, spp=n)) if n <= 20 else one * n
            error = relmse(self.render(name, ERROR_SIZE, n, exact=True).radiance, reference)
            rows.append((n, f"{ms:.0f}" if n <= 20 else f"{ms:.0f} (n times one)", f"{error:.1e}", gpu, cpu))
        bench.table(("samples", ">ms", ">error", ">published, GPU", ">published, CPU"), rows)

    def accumulated(self):
        print("### Accumulated\n\nThe box with spheres at "
              f"{ERROR_SIZE[0]} x {ERROR_SIZE[1]}: frames of a few samples each, every one a request of its own that goes on where the one "
              "before ended (`--first-sample`), and their mean; beside it one request for all.\n")
        name = "cornell_spheres"
        reference = self.render(name, ERROR_SIZE, REFERENCE, arguments=["--seed", "77"], exact=True).radiance
        rows = []
        for samples, frames in ACCUMULATED:
            total, ms = numpy.zeros_like(reference, dtype=numpy.float64), 0.0
            for frame in range(frames):
                picture = self.render(name, ERROR_SIZE, samples, arguments=["--first-sample", str(frame * samples)], exact=True)
                total += picture.radiance
                ms += picture.report["elapsed_us"] / 1e3
            mean = total / frames
            whole = self.render(name, ERROR_SIZE, samples * frames, exact=True)
            rows.append((f"{samples} x {frames}", f"{ms / frames:.1f}", f"{whole.report['elapsed_us'] / 1e3 / frames:.1f}",
                         f"{relmse(mean, reference):.1e}", f"{relmse(whole.radiance, reference):.1e}",
                         f"{numpy.max(numpy.abs(mean - whole.radiance) / (whole.radiance + 1e-3)):.0e}"))
        bench.table(("samples x frames", ">ms a frame", ">of one request", ">error", ">of one request", ">greatest difference"), rows)

    def equal_time(self):
        print("### By time\n\nThe box with a ball and a metal block, ended by `--time`; published are the samples that a single CPU thread "
              "took in that time.\n")
        name = "cornell_weekend"
        path = gallery.SCENES[name](self.daemon.folder)
        size = (320, 180) if self.quick else RESOLUTIONS[0]
        rows = []
        for seconds, cpu in EQUAL_TIME.items():
            _, out, _ = self.daemon.candil("render", path, "-o", os.path.join(self.daemon.folder, "timed.exr"), "--size", "%dx%d" % size,
                                           *gallery.arguments(name), "--spp", "65536", "--time", str(1000 * seconds), "--json", check=False)
            report = json.loads(out)
            rows.append((f"{seconds} s", report["samples"], f"{report['estimated_relmse']:.1e}", cpu))
        bench.table(("time", ">samples", ">estimated error", ">published, CPU"), rows)

    def hemisphere(self):
        print("### Directions by the cosine and uniform\n\n10 samples of the empty box, lamps found by directions alone, as in the published "
              "comparison; and by points too.\n")
        reference = self.render("cornell_empty", ERROR_SIZE, REFERENCE, arguments=["--seed", "77"], exact=True).radiance
        rows = []
        for lights in ("none", "mis"):
            for way in ("cosine", "uniform"):
                options = {"pt.lights": lights, "pt.hemisphere": way}
                picture = self.render("cornell_empty", ERROR_SIZE, 10, options, exact=True)
                rows.append((lights, way, f"{relmse(picture.radiance, reference):.2e}", f"{trace_ms(picture) / 10:.2f}"))
        bench.table(("pt.lights", "pt.hemisphere", ">error", ">ms a sample"), rows)

    def scenes(self, pictures):
        print("### All fourteen\n\n8 samples at 1280 x 720 for the time; 64 at 320 x 180 for the error that the renderer estimates.\n")
        rows = []
        for name, scene in gallery.SCENES.items():
            timely = self.render(name, spp=8)
            fine = self.render(name, (320, 180), 64, exact=True)
            keep(pictures, name, fine.radiance)
            rows.append((name, scene.__doc__.split(":")[0].split(".")[0], f"{trace_ms(timely) / 8:.1f}",
                         f"{fine.report['estimated_relmse']:.1e}", fine.report["non_finite_samples"]))
        bench.table(("scene", "what it is", ">ms a sample", ">estimated error", ">not finite"), rows)


def keep(folder, name, radiance):
    """A picture for people: sRGB, the brightest tenth just white."""
    if folder is None:
        return
    scale = 0.9 / max(float(numpy.percentile(radiance, 97)), 1e-9)
    x = numpy.clip(radiance * scale, 0, 1)
    write(os.path.join(folder, name + ".png"), numpy.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055).astype(numpy.float32))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--pictures", metavar="FOLDER")
    args = parser.parse_args()
    if args.pictures:
        os.makedirs(args.pictures, exist_ok=True)
    with Daemon() as daemon:
        bench.header(daemon.stats()["device"])
        b = Bench(daemon, args.quick)
        b.by_samples()
        b.by_depth(args.pictures)
        b.by_size()
        b.by_time()
        b.equal_time()
        b.accumulated()
        b.hemisphere()
        b.scenes(args.pictures)


if __name__ == "__main__":
    main()
