"""What each effect of the path tracer costs: scene by scene what it takes where it is simulated, what leaving it out saves where
it is not, and how far the picture is from the planned one if it is forced on there. Times are the service's own
(pt.effect_times=all): by difference, on a small probe, so a share below a few percent of the job is noise, either way.
Scenes: those of the project, and what CANDIL_SCENES has of a list of public ones."""
import os

import numpy

import bench
import make
from render import Daemon

PUBLIC = ("ref-cornell-box/cornell-box.gltf", "ref-veach-mis/veach-mis.gltf", "sponza/Sponza.gltf",
          "gltf/DamagedHelmet/DamagedHelmet.gltf")
WHITE = ["--background", "1,1,1"]
COLUMNS = ["scene", "effect", ">simulated: ms (share)", ">left out, saves: ms (share)", ">forced: greatest relative difference"]
TIMED = {"size": (256, 256), "spp": 16}
FORCED = {"size": (64, 64), "spp": 4}


def scenes(folder):
    """(name, file, arguments)"""
    yield "cornell", make.cornell(folder), []
    yield "textured quad", make.textured_quad(folder), WHITE
    yield "floor, point light", make.lit_floor(folder, "point"), []
    yield "alpha mask", make.alpha_mask(folder), WHITE
    yield "alpha blend", make.alpha_blend(folder), WHITE
    yield "glass", make.cornell_glass(folder), []
    yield "coats", make.coats(folder), []
    root = os.environ.get("CANDIL_SCENES", "")
    for name in PUBLIC:
        path = os.path.join(root, name)
        if root and os.path.exists(path):
            plain = "cornell" in name or "veach" in name
            yield os.path.splitext(os.path.basename(name))[0], path, [] if plain else WHITE


def difference(daemon, file, arguments, effect):
    """Forced on against the plan's picture: relative to the pixel, or to 1e-3 of black ones."""
    auto = daemon.render(file, **FORCED, arguments=arguments).radiance
    forced = daemon.render(file, **FORCED, arguments=[*arguments, "--effects", f"+{effect}"]).radiance
    return float((numpy.abs(forced - auto) / numpy.maximum(numpy.abs(auto), 1e-3)).max())


def rows(daemon, name, file, arguments):
    report = daemon.render(file, **TIMED, options={"pt.effect_times": "all"}, arguments=arguments).report
    for effect in report["effects"]:
        if "cost_us" not in effect:
            yield name, effect["name"], "unknown" if effect["state"] == "simulated" else "", "unknown", ""
            continue
        cost = f"{effect['cost_us'] / 1e3:.0f} ({100 * effect['share']:.0f} %)"
        if effect["state"] == "simulated":
            yield name, effect["name"], cost, "", ""
        else:
            yield name, effect["name"], "", cost, f"{difference(daemon, file, arguments, effect['name']):.1e}"


def main():
    with Daemon() as daemon:
        daemon.render(make.unlit(daemon.folder), size=(8, 8), spp=1)  # the worker is started by its first job
        bench.header(daemon.stats()["device"])
        bench.table(COLUMNS, (row for scene in scenes(daemon.folder) for row in rows(daemon, *scene)))


if __name__ == "__main__":
    main()
