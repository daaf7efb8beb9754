"""Light that leaks into a dark room beside a bright one, by the thickness of the wall between them in voxels (scenes/rooms.py): mean
and 99th percentile of the dark room's radiance over the bright room's mean, over three sub-voxel shifts the worst of each."""
import argparse

import bench
import rooms
from render import Daemon


def row(daemon, folder, resolution, turned, voxels, options):
    every = [rooms.leak(daemon, rooms.TwoRooms(folder, resolution, voxels, shift, turned), resolution, options=options)
             for shift in rooms.LEAK_SHIFTS]
    return [f"{resolution}", f"{turned}°", f"{voxels:g}", f"{100 * max(e[0] for e in every):.2f}", f"{100 * max(e[1] for e in every):.2f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--resolutions", default="64,128", help="default %(default)s")
    parser.add_argument("--set", action="append", default=[], metavar="vct.NAME=VALUE")
    given = parser.parse_args()
    with Daemon() as daemon:
        options = dict(pair.split("=") for pair in given.set)
        rooms.leak(daemon, rooms.TwoRooms(daemon.folder, 32, 2), 32)
        bench.header(daemon.stats()["device"])
        bench.table([">voxels", ">turned", ">wall, voxels", ">mean %", ">99th percentile %"],
                    (row(daemon, daemon.folder, int(resolution), turned, voxels, options) for resolution in given.resolutions.split(",")
                     for turned in (0, 30) for voxels in rooms.LEAK_THICKNESSES))


if __name__ == "__main__":
    main()
