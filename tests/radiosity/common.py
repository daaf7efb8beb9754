"""What the tests of radiosity share: a daemon with a shorter render(), and what its account says."""
from render import Daemon

WHITE = ["--background", "1,1,1"]


class RadiosityDaemon(Daemon):
    def radiosity(self, scene, patches=None, size=(32, 32), spp=1, camera=None, arguments=(), render=None, **options):
        """options: rays=64 for radiosity.rays=64. `render`: how, if not by render()."""
        if patches is not None:
            options["patches"] = patches
        named = {"radiosity." + name: value for name, value in options.items()}
        picture = (render or self.render)(scene, size=size, spp=spp, camera=camera, options=named,
                                          arguments=["--technique", "radiosity", *arguments])
        assert picture.report["non_finite_samples"] == 0
        return picture


def figures(picture):
    """By name."""
    return {figure["name"]: figure["value"] for figure in picture.report["figures"]}


def stages(picture):
    return {stage["name"] for stage in picture.report["stages"]}
