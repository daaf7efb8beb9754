"""What the tests of voxel cone tracing share: a daemon and a folder for scenes a test program, and a shorter render()."""
import tempfile

from render import Daemon

WHITE = ["--background", "1,1,1"]


class Fixture:
    """Open it in setUpModule, close it in tearDownModule."""

    def open(self, *arguments):
        self.temporary = tempfile.TemporaryDirectory(prefix="candil-scenes-")
        self.folder = self.temporary.name
        self.daemon = Daemon(*arguments).__enter__()

    def close(self):
        self.daemon.__exit__(None, None, None)
        self.temporary.cleanup()

    def vct(self, scene, resolution=32, size=(32, 32), spp=1, camera=None, arguments=(), **options):
        """options: bounces=2 for vct.bounces=2."""
        named = {"vct." + name: value for name, value in {"resolution": resolution, **options}.items()}
        picture = self.daemon.render(scene, size=size, spp=spp, camera=camera, options=named,
                                     arguments=["--technique", "vct", *arguments])
        assert picture.report["non_finite_samples"] == 0
        return picture
