"""What each way of sampling is worth on the Cornell box: relMSE at equal samples, and at the time that the default takes for
them. `--error` compares the estimated error with the true one instead, over frames of small scenes."""
import argparse

import numpy

import bench
import make
from images import blurred, relmse
from render import Daemon

SIZE = (128, 128)
SPP = 64
REFERENCE = 4096
WAYS = ({}, {"pt.sampler": "independent"}, {"pt.sampler": "blue"}, {"pt.hemisphere": "uniform"}, {"pt.lights": "nee"}, {"pt.lights": "none"},
        {"pt.roulette": "off"}, {"pt.sampler": "independent", "pt.hemisphere": "uniform", "pt.lights": "none"},
        {"pt.clamp": "4"})
FRAMES = (4, 16, 64)


def radiance(picture):
    return picture.radiance.astype(numpy.float64)


def trace_us(picture):
    return next(stage["us"] for stage in picture.report["stages"] if stage["name"] == "trace")


def fastest(daemon, path, options):
    """The picture of three runs that took the shortest: on a busy machine the least is the nearest to the work."""
    return min((daemon.render(path, SIZE, SPP, options=options) for _ in range(3)), key=trace_us)


def ways(daemon):
    path = make.cornell(daemon.folder)
    reference = radiance(daemon.render(path, SIZE, REFERENCE, arguments=["--seed", "99"]))
    usual = None
    for options in WAYS:
        picture = fastest(daemon, path, options)
        us = trace_us(picture)
        usual = usual or us
        spp = max(2, round(SPP * usual / us))
        error = relmse(radiance(picture), reference)
        timely = relmse(radiance(daemon.render(path, SIZE, spp, options=options)), reference)
        name = ", ".join(f"{k}={v}" for k, v in options.items()) or "the default"
        inner = slice(8, -8)
        smooth = relmse(blurred(radiance(picture), 1.5)[inner, inner], blurred(reference, 1.5)[inner, inner])
        yield name, f"{error:.2e}", f"{smooth:.2e}", f"{us / SPP / 1e3:.2f}", str(spp), f"{timely:.2e}"


def scenes(folder):
    white = ["--background", "1,1,1"]
    yield "cornell", make.cornell(folder), []
    yield "cornell, OBJ", make.cornell_obj(folder), []
    yield "stage", make.stage(folder), []
    yield "GGX furnace, rough", make.ggx_furnace(folder, 0.6, name="rough.gltf"), white
    yield "GGX furnace, 0.3", make.ggx_furnace(folder, 0.3, name="smooth.gltf"), white
    yield "closed sphere", make.closed_sphere(folder), []
    yield "lamp over floor", make.lamp_over_floor(folder), []
    yield "disc lamp", make.disc_lamp(folder), []
    yield "glass", make.cornell_glass(folder), []
    yield "coats", make.coats(folder), []


def errors(daemon):
    for name, path, more in scenes(daemon.folder):
        reference = radiance(daemon.render(path, (64, 64), 1024, arguments=[*more, "--seed", "99"]))
        for spp in FRAMES:
            picture = daemon.render(path, (64, 64), spp, arguments=more)
            true, told = relmse(radiance(picture), reference), picture.report["estimated_relmse"]
            yield name, str(spp), f"{true:.2e}", f"{told:.2e}", f"{told / true:.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--error", action="store_true")
    arguments = parser.parse_args()
    with Daemon() as daemon:
        daemon.render(make.unlit(daemon.folder), size=(8, 8), spp=1)  # the worker is started by its first job
        bench.header(daemon.stats()["device"])
        if arguments.error:
            bench.table(["scene", ">samples", ">relMSE", ">estimated", ">estimated / true"], errors(daemon))
        else:
            bench.table(["way", ">relMSE", ">behind a Gaussian of 1.5 pixels", ">ms a sample", ">samples in the same time", ">relMSE then"], ways(daemon))


if __name__ == "__main__":
    main()
