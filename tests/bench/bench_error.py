"""The estimated error and its 90 % interval beside the true error, over frames of many scenes.

    bench_error.py [--part WORD] [--seeds N] [--first-seed N] [--reference SAMPLES] [--keep FOLDER]

A line a frame: scene, samples, seed, estimate, interval, true relMSE, and whether that lies inside; then the summary, for all and for
each kind of scenes: `diffuse`, `hard` (small lamps, hidden lamps, caustics), `tuned` (the estimate was made with their first seeds) and
`new`. The truth is by the mean of four pictures of other seeds, less what their own noise adds. --keep keeps those for another run.
PART picks scenes. With CANDIL_BUILD, CANDIL_SOURCE and PYTHONPATH as tests have them."""
import argparse
import math
import os
import statistics

import numpy

import bench_caustics
import gallery
import hidden
import images
import make
import rooms
import skies
from render import Daemon

SIZE = (48, 48)
PARTS = 4  # of a reference


def ring(folder):
    return bench_caustics.yard(folder, lambda g: bench_caustics.ring(g, bench_caustics.metal(g, .15)), .05)


def dusk_sky(folder):
    path = folder + "/dusk.exr"
    images.write(path, skies.sunset(256))
    return ["--background", path]


WHITE = ("--background", "1,1,1")
CHANCE = ("--effects", "auto,-caustics")
# Name: kind, the scene's function, the samples of its frames, further arguments or a function of the folder that gives them.
SCENES = {
    # Those that the estimate was made with.
    "cornell": ("diffuse", make.cornell, (4, 16, 64), ()),
    "stage": ("diffuse", make.stage, (4, 16, 64), ()),
    "furnace, rough": ("diffuse", lambda f: make.ggx_furnace(f, roughness=.4), (4, 16), WHITE),
    "white box": ("diffuse", gallery.cornell_white, (8, 32), ()),
    "empty box": ("diffuse", gallery.cornell_empty, (4, 16, 64), ()),
    "glossy room": ("hard", hidden.brushed, (2, 8, 32, 128), ()),
    "shade": ("hard", hidden.shade, (4, 16, 64), ()),
    "door ajar": ("hard", hidden.ajar, (4, 16, 64), ()),
    "glass ball": ("hard", make.cornell_glass, (4, 16, 64), ()),
    "bulb": ("hard", bench_caustics.bulb, (8, 32), ()),
    "glass ball by chance": ("hard", bench_caustics.ball, (4, 16, 64), CHANCE),
    "many lamps": ("hard", make.many_lamps, (4, 16), ()),
    "plates": ("hard", make.plates, (4, 16, 64), ()),
    # Those that it was not.
    "light box": ("diffuse", rooms.light_box, (4, 16, 64), ()),
    "village": ("diffuse", gallery.village, (4, 16, 64), tuple(gallery.SKY)),
    "saturated box": ("diffuse", gallery.cornell_saturated, (4, 16, 64), ()),
    "cube in the sun": ("diffuse", gallery.cube, (4, 16), tuple(gallery.SKY)),
    "coats": ("diffuse", make.coats, (4, 16, 64), ()),
    "slats in the sun": ("diffuse", hidden.tree_shade, (4, 16), tuple(gallery.SKY)),
    "metal shade": ("hard", hidden.metal_shade, (4, 16, 64), ()),
    "keyhole": ("hard", hidden.keyhole, (4, 16, 64), ()),
    "metal ring": ("hard", ring, (4, 16, 64), ()),
    "metal ring by chance": ("hard", ring, (4, 16, 64), CHANCE),
    "rough metals": ("hard", hidden.rough_metals, (4, 16, 64), ()),
    "lantern": ("hard", hidden.panes, (4, 16, 64), ()),
    "glossy box": ("hard", gallery.cornell_glossy, (4, 16, 64), ()),
    "dusk": ("hard", hidden.balls_at_dusk, (4, 16, 64), dusk_sky),
}


TUNED = 13  # so many of them


def reference(daemon, path, more, samples, keep):
    """The mean of PARTS pictures, and the square of its own standard error, for each number of it."""
    if keep and os.path.exists(keep):
        parts = numpy.load(keep)
    else:
        parts = numpy.stack([daemon.render(path, SIZE, samples // PARTS, arguments=[*more, "--seed", str(900 + i)])
                             .radiance.astype("f8") for i in range(PARTS)])
        if keep:
            numpy.save(keep, parts)
    mean = parts.mean(axis=0)
    return mean, ((parts - mean) ** 2).sum(axis=0) / (PARTS * (PARTS - 1))


def frames(daemon, name, more, options):
    """(samples, seed, estimate, low, high or infinity, truth) of each frame of a scene."""
    kind, scene, counts, _ = SCENES[name]
    path = scene(daemon.folder)
    keep = options.keep and os.path.join(options.keep, name.replace(" ", "_") + ".npy")
    truth, noise = reference(daemon, path, more, options.reference, keep)
    of_reference = float((noise / (truth ** 2 + 0.01)).mean())
    for samples in counts:
        for seed in range(options.first_seed, options.first_seed + options.seeds):
            picture = daemon.render(path, SIZE, samples, arguments=[*more, "--seed", str(seed)])
            told = picture.report
            high = math.inf if told["relmse_high"] is None else told["relmse_high"]
            true = images.relmse(picture.radiance.astype("f8"), truth) - of_reference
            yield samples, seed, told["estimated_relmse"], told["relmse_low"], high, true


def summary(title, rows):
    if not rows:
        return
    inside = sum(low <= true <= high for _, _, _, low, high, true in rows) / len(rows)
    width = statistics.median(high / low for _, _, _, low, high, _ in rows)
    sided = sum(math.isinf(high) for _, _, _, _, high, _ in rows)
    ratios = [estimate / true for _, _, estimate, _, _, true in rows]
    near = sum(max(r, 1 / r) <= 1.5 for r in ratios)
    print(f"| {title} | {len(rows)} | {100 * inside:.0f} % | {width:.2f} | {sided} | {near} | {statistics.geometric_mean(ratios):.2f} | "
          f"{min(ratios):.2f} to {max(ratios):.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--part", default="")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=11)
    parser.add_argument("--reference", type=int, default=2048)
    parser.add_argument("--keep")
    options = parser.parse_args()
    every, kinds = [], {"diffuse": [], "hard": [], "tuned": [], "new": []}
    print("| scene | samples | seed | estimate | 90 % interval | true | true / estimate | inside |\n| --- | ---: | ---: | ---: | --- | ---: | ---: | --- |")
    with Daemon() as daemon:
        for index, name in enumerate(SCENES):
            if options.part not in name:
                continue
            kind, more = SCENES[name][0], SCENES[name][3]
            for row in frames(daemon, name, more(daemon.folder) if callable(more) else more, options):
                samples, seed, estimate, low, high, true = row
                for rows in (every, kinds[kind], kinds["tuned" if index < TUNED else "new"]):
                    rows.append(row)
                print(f"| {name} | {samples} | {seed} | {estimate:.2e} | {low:.2e} … {'' if math.isinf(high) else f'{high:.2e}'} | "
                      f"{true:.2e} | {true / estimate:.2f} | {'yes' if low <= true <= high else 'no'} |", flush=True)
    print("\n| frames | number | true one inside | median of high / low | without upper end | estimate within 1.5 | estimate / true, mean | "
          "least to greatest |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |")
    summary("all", every)
    for kind, rows in kinds.items():
        summary(kind, rows)


if __name__ == "__main__":
    main()
