"""What the tests of voxel cone tracing share: a daemon with a shorter render()."""
from render import Daemon

WHITE = ["--background", "1,1,1"]


class VctDaemon(Daemon):
    def vct(self, scene, resolution=32, size=(32, 32), spp=1, camera=None, arguments=(), render=None, **options):
        """options: bounces=2 for vct.bounces=2. `render`: how, if not by render()."""
        named = {"vct." + name: value for name, value in {"resolution": resolution, **options}.items()}
        picture = (render or self.render)(scene, size=size, spp=spp, camera=camera, options=named, arguments=["--technique", "vct", *arguments])
        assert picture.report["non_finite_samples"] == 0
        return picture
