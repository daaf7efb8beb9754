"""The noise of blended surfaces: their decisions are as well stratified as the others of a path, seen directly, in a mirror, by
texture, through several sheets and on a shadow ray; and the mean is that of the alphas. Beside coin tosses at the same alpha."""
import math
import unittest

import numpy

import make
from render import Daemon
from writers import Gltf, png, quad

daemon = Daemon()
SIZE = (16, 16)


def setUpModule():
    unittest.enterModuleContext(daemon)


def view(path, spp, camera=(0, 0, 5, 0, 0, 0, 0, 1, 0, 11), background="1,1,1", **options):
    picture = daemon.render(path, SIZE, spp, camera=camera, arguments=["--background", background], **options)
    return picture.radiance[..., 0].astype(numpy.float64)


def coin(chance, spp):
    """Standard deviation of the mean of `spp` tosses."""
    return math.sqrt(chance * (1 - chance) / spp)


class Noise(unittest.TestCase):
    def check(self, pixels, mean, spp, share, scale=1.0):
        """`share` of what coin tosses of this mean would leave."""
        tosses = scale * coin(mean / scale, spp)
        print(f"mean {pixels.mean():.5f} of {mean:.5f}, deviation {pixels.std():.5f}, tosses {tosses:.5f}")
        self.assertLess(abs(pixels.mean() - mean), 3 * share * tosses / math.sqrt(pixels.size))
        self.assertLess(pixels.std(), share * tosses)

    def test_one_sheet(self):
        for alpha in (.1, .25, .5, .9):
            sheet = make.alpha_blend(daemon.folder, alpha=alpha, name=f"sheet{alpha}.gltf")
            self.check(view(sheet, 256), 1 - alpha, 256, .45)

    def test_the_error_falls_faster_than_that_of_tosses(self):
        sheet = make.alpha_blend(daemon.folder, alpha=.3, name="sheet.gltf")
        few, many = (view(sheet, spp).std() for spp in (64, 1024))
        self.assertLess(many, few / 4 / 1.2)

    def test_independent_samples_are_tosses(self):
        """The sampler that knows no strata is as it is called: what the others have is theirs."""
        sheet = make.alpha_blend(daemon.folder, alpha=.25, name="tossed.gltf")
        pixels = view(sheet, 256, options={"pt.sampler": "independent"})
        self.assertLess(abs(pixels.std() / coin(.75, 256) - 1), .15)

    def test_blue_samples(self):
        sheet = make.alpha_blend(daemon.folder, alpha=.25, name="blue.gltf")
        self.check(view(sheet, 256, options={"pt.sampler": "blue"}), .75, 256, .5)

    def test_sheets_behind_each_other_are_independent(self):
        """Were their decisions tied, a product of alphas would be wrong in every pixel."""
        for sheets in (2, 5):
            stack = make.alpha_blend(daemon.folder, alpha=.4, sheets=sheets, name=f"stack{sheets}.gltf")
            pixels = view(stack, 1024)
            self.assertLess(abs(pixels.mean() - .6 ** sheets), 3 * coin(.6 ** sheets, 1024) / 16)
            self.assertLess(numpy.abs(pixels - .6 ** sheets).max(), 4.5 * coin(.6 ** sheets, 1024))

    def test_alpha_by_texture(self):
        g = Gltf()
        image = g.image(png(4, 4, lambda x, y: (0, 0, 0, 64)))
        sheet = g.material("sheet", (0, 0, 0), texture={"index": image}, blend=True)
        g.place(*quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)), sheet)
        self.check(view(g.save(daemon.folder, "texture.gltf"), 256), 1 - 64 / 255, 256, .45)

    def test_in_a_mirror(self):
        """The second event of a path: the camera looks down at a mirror, which shows the sheet above and the sky behind it."""
        g = Gltf()
        g.place(*quad((-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)), g.material("mirror", (1, 1, 1), metallic=1, roughness=0, specular=1))
        g.place(*quad((-9, 4, -9), (9, 4, -9), (9, 4, 9), (-9, 4, 9)), g.material("sheet", (0, 0, 0), alpha=.25, blend=True))
        pixels = view(g.save(daemon.folder, "mirrored.gltf"), 256, camera=(0, 3, .5, 0, 0, 0, 0, 1, 0, 8))
        self.check(pixels, .75, 256, .5)

    def test_on_a_shadow_ray(self):
        """A floor under a sun and a black sheet: the sheet's alpha is the shadow, and nothing else is noisy."""
        g = Gltf()
        g.place(*quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)), g.material("floor", (.5, .5, .5)))
        g.place(*quad((-9, 4, -9), (9, 4, -9), (9, 4, 9), (-9, 4, 9)), g.material("sheet", (0, 0, 0), alpha=.25, blend=True))
        g.light("directional", math.pi, (0, 5, 0), (0, 0, 0))
        pixels = view(g.save(daemon.folder, "shadow.gltf"), 256, camera=(0, 3, .5, 0, 0, 0, 0, 1, 0, 8), background="0,0,0",
                      options={"pt.depth": 1})
        self.check(pixels, .5 * .75, 256, .5, scale=.5)


if __name__ == "__main__":
    unittest.main()
