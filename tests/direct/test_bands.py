"""Where a picture is worked on in bands of rows it has the bits that it has at once: the passes that look at pixels near by, lamps'
points shared by neighbours and cones of every second row, see across."""
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, icosphere, quad

daemon = Daemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def glossy_room():
    """A lamp over a rough mirror of a floor and a sphere."""
    g = Gltf()
    g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("floor", (.7, .6, .5), metallic=1, roughness=.4))
    g.place(*icosphere(2, .5), g.material("sphere", (.6,) * 3), translation=[0, .7, 0])
    g.place(*quad((-.4, 2, -.4), (.4, 2, -.4), (.4, 2, .4), (-.4, 2, .4)), g.material("lamp", (0, 0, 0), (15,) * 3))
    g.camera((0.3, 1.2, 3), (0, .5, 0), 45)
    return g.save(daemon.folder, "glossy.gltf")


def blades():
    """Slim blades, about a pixel broad and turned in many ways, one behind the other before a wall: silhouettes everywhere."""
    g = Gltf()
    g.place(*quad((-3, -3, -2), (3, -3, -2), (3, 3, -2), (-3, 3, -2)), g.material("wall", (.7, .6, .5)))
    blade = g.material("blade", (.5, .6, .7), both_sides=True)
    random = numpy.random.default_rng(1)
    for _ in range(120):
        middle, along, across = random.uniform((-1.5, -1.2, -1), (1.5, 1.2, 1)), random.normal(size=3), random.normal(size=3)
        along, across = .5 * along / numpy.linalg.norm(along), .03 * across / numpy.linalg.norm(across)
        g.place(*quad(*(tuple(map(float, middle + i * along + j * across)) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1)))), blade)
    g.light("point", 30.0, (.5, 1, 3))
    g.camera((0, 0, 4), (0, 0, 0), 45)
    return g.save(daemon.folder, "blades.gltf")


class Bands(unittest.TestCase):
    def check(self, technique, scene, size=(40, 50), spp=1, **options):
        def render(**more):
            named = {**options, **more}
            return daemon.render(scene, size=size, spp=spp, options={k.replace("_", ".", 1): v for k, v in named.items()},
                                 arguments=["--technique", technique, "--aov", "depth,normal,albedo,id"])
        whole = render()
        self.assertGreater(float(whole.radiance.max()), 0.01)
        for rows in (8, 17):
            banded = render(direct_rows=rows)
            for name, channel in whole.channels.items():
                numpy.testing.assert_array_equal(banded.channels[name], channel, f"{technique} {options} {rows} rows, {name}")
            self.assertEqual(banded.report["rays"], whole.report["rays"])

    def test_lamps_shared_by_neighbours(self):
        self.check("direct", make.cornell(daemon.folder))
        self.check("direct", glossy_room())

    def test_more_samples(self):
        self.check("direct", make.cornell(daemon.folder), spp=5)

    def test_cones_of_every_second_row(self):
        self.check("vct", make.cornell(daemon.folder), vct_resolution=16, vct_bounces=1)
        self.check("vct", glossy_room(), spp=2, vct_resolution=16, vct_bounces=1)

    def test_rays_shared_by_neighbours(self):
        """Also at silhouettes, where a pixel takes those of places farther off."""
        for detail in ("half", "full"):
            self.check("vct", blades(), (64, 50), vct_resolution=32, vct_bounces=1, vct_gather="rays", vct_rays=4, vct_detail=detail)

    def test_cones_of_every_pixel(self):
        self.check("vct", make.cornell(daemon.folder), vct_resolution=16, vct_bounces=1, vct_detail="full")

    def test_a_band_takes_less_memory_than_the_whole(self):
        cornell = make.cornell(daemon.folder)
        some, all_at_once = (daemon.render(cornell, size=(256, 256), spp=1, options=options,
                                           arguments=["--technique", "direct"]).report["job_bytes"]
                             for options in ({"direct.rows": 64}, {}))
        self.assertLess(some, 0.8 * all_at_once)


if __name__ == "__main__":
    unittest.main()
