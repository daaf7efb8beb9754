"""The sky's light through openings (scenes/openings.py) by `vct`, with cones and with rays, beside `pt` of as many events: relMSE, the
error of the mean, and the device's milliseconds for the voxels' light and for a picture over kept voxels."""
import argparse
import os

import bench
import images
import openings
import skies
from judge import mean_error, relmse
from render import Daemon

WAYS = ({"gather": "cones"}, {"gather": "rays", "rays": 4}, {"gather": "rays", "rays": 16}, {"gather": "rays", "rays": 64})
VOXELS = ("voxel-light", "voxel-gather", "pyramid")
PICTURE = ("cones", "rays", "share", "blend")


def scenes(folder):
    for depth in (.25, .5, 1, 2, 4):
        yield f"well {depth:g} m", openings.well(folder, depth, .8, .8)
    yield "window", openings.window(folder)
    yield "courtyard", openings.courtyard(folder)


def milliseconds(report, names):
    return sum(stage["us"] for stage in report["stages"] if stage["name"] in names) / 1000


def rows(daemon, given):
    sunset = os.path.join(daemon.folder, "sunset.exr")
    images.write(sunset, skies.sunset(128))
    named = {"even": "1,1,1", "sunset": sunset}
    size = (given.side, given.side)
    for sky in given.skies.split(","):
        for name, scene in scenes(daemon.folder):
            if given.only and given.only not in name:
                continue
            background = ["--background", named[sky]]
            truth = daemon.render(scene, size=size, spp=given.spp, options={"pt.depth": 3}, arguments=["--technique", "pt", *background]).radiance
            for resolution in given.resolutions.split(","):
                for way in WAYS:
                    options = {"vct.resolution": resolution, **{"vct." + key: value for key, value in way.items()}}
                    made, kept = (daemon.render(scene, size=size, spp=1, options=options, arguments=["--technique", "vct", *background]) for _ in range(2))
                    mask = truth.min(axis=2) >= 0
                    yield [sky, name, f"{resolution}³", " ".join(str(value) for value in way.values()), f"{relmse(kept.radiance, truth, mask):.2g}",
                           f"{100 * mean_error(kept.radiance, truth, mask):+.1f}", f"{milliseconds(made.report, VOXELS):.0f}",
                           f"{milliseconds(kept.report, PICTURE):.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--resolutions", default="64,128", help="default %(default)s")
    parser.add_argument("--skies", default="even,sunset", help="default %(default)s")
    parser.add_argument("--side", type=int, default=64, help="pixels, default %(default)s")
    parser.add_argument("--spp", type=int, default=256, help="of the reference, default %(default)s")
    parser.add_argument("--only", help="scenes with this in their name")
    given = parser.parse_args()
    with Daemon() as daemon:
        bench.header(daemon.stats()["device"])
        bench.table(["sky", "scene", ">voxels", "gather", ">relMSE", ">mean %", ">voxels' light ms", ">picture ms"], rows(daemon, given))


if __name__ == "__main__":
    main()
