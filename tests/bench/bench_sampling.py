"""What each way of sampling is worth on the Cornell box: relMSE at equal samples, and at the time that the default takes for
them."""
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


def main():
    with Daemon() as daemon:
        daemon.render(make.unlit(daemon.folder), size=(8, 8), spp=1)  # the worker is started by its first job
        bench.header(daemon.stats()["device"])
        bench.table(["way", ">relMSE", ">behind a Gaussian of 1.5 pixels", ">ms a sample", ">samples in the same time", ">relMSE then"], ways(daemon))


if __name__ == "__main__":
    main()
