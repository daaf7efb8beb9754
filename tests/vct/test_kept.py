"""What is kept from request to request: stages tell what was made again. Other lights leave the voxels, another camera leaves all, and
that goes for edited scenes too, which share what their edits leave alone. Each picture has the bits that it has by itself."""
import unittest

import numpy

import make
import rooms
from common import VctDaemon
from render import Daemon
from writers import Gltf, box, quad

daemon = VctDaemon()
VOXELS, LIGHT, GATHER = "voxelise", "voxel-light", "voxel-gather"
LAMP_A, LAMP_B = (["--light", f"point:at={at},intensity=3"] for at in ("-.5,1.5,.3", ".5,1.2,.3"))
MOVED = ["--node", "block:translate=.3,.4,0"]


def room():
    g = Gltf()
    for part, colour, corners in make.CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    g.place(*box((-.2, -.2, -.2), (.2, .2, .2)), g.material("block", (.6,) * 3), name="block", translation=[0, .4, 0])
    g.light("point", 5.0, (0, 1.7, 0))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g.save(daemon.folder, "room.gltf")


def setUpModule():
    unittest.enterModuleContext(daemon)


def made(picture):
    return {s["name"] for s in picture.report["stages"]} & {VOXELS, LIGHT, GATHER}


class Kept(unittest.TestCase):
    def render(self, *arguments, wanted=None, **options):
        picture = daemon.vct(self.scene, arguments=arguments, **options)
        if wanted is not None:
            self.assertEqual(made(picture), set(wanted), arguments)
        return picture

    def setUp(self):
        daemon.candil("load", room(), "--name", "room")
        self.scene = "room"

    def tearDown(self):
        daemon.candil("unload", "room")

    def test_other_lights_leave_the_voxels(self):
        self.render(wanted=[VOXELS, LIGHT, GATHER])
        self.render(*LAMP_A, wanted=[LIGHT, GATHER])
        self.render(*LAMP_B, wanted=[LIGHT, GATHER])
        self.render(*LAMP_B, "--replace-lights", wanted=[LIGHT, GATHER])

    def test_even_when_the_scene_itself_was_never_rendered(self):
        self.render(*LAMP_A, wanted=[VOXELS, LIGHT, GATHER])
        self.render(*LAMP_B, wanted=[LIGHT, GATHER])
        self.render(wanted=[LIGHT, GATHER])

    def test_back_and_forth_between_two_lights_nothing_is_made_again(self):
        self.render()
        self.render(*LAMP_A)
        self.render(wanted=[])
        self.render(*LAMP_A, "--camera", "0,1,3,0,1,0,0,1,0,39", wanted=[])

    def test_what_moved_or_changed_is_voxelised(self):
        self.render()
        self.render(*MOVED, wanted=[VOXELS, LIGHT, GATHER])
        self.render(*MOVED, *LAMP_A, wanted=[LIGHT, GATHER])
        self.render(*MOVED, "--material", "block:color=.9,.1,.1", wanted=[VOXELS, LIGHT, GATHER])
        self.render(wanted=[LIGHT, GATHER])

    def test_each_has_the_bits_that_it_has_alone(self):
        every = ([], LAMP_A, [*MOVED, *LAMP_B], MOVED, ["--material", "block:color=.9,.1,.1"], LAMP_B)
        together = [self.render(*arguments).radiance for arguments in every]
        self.assertGreater(min(float(numpy.abs(together[0] - other).max()) for other in together[1:]), 1e-3)
        for arguments, picture in zip(every, together):
            self.tearDown()
            self.setUp()
            numpy.testing.assert_array_equal(self.render(*arguments).radiance, picture, str(arguments))

    def test_the_fullest_account_has_every_stage(self):
        picture = self.render(*MOVED, *LAMP_A, "--light", "spot:at=0,1.9,0,to=0,0,0,cone=20,30,intensity=5", "--aov", "depth",
                              "--material", "block:emission=2,2,2", shadows="map")
        stages = [s["name"] for s in picture.report["stages"]]
        self.assertGreater(len(stages), 16, stages)
        self.assertLessEqual({"queue", "edit", "upload", "shadow-maps", "aov", "resolve", "encode"}, set(stages))

    def test_a_volume_that_other_options_need_too(self):
        self.render()
        self.render(bounces=1, wanted=[LIGHT])
        self.render(shadows="march", wanted=[LIGHT, GATHER])
        self.render(resolution=16, wanted=[VOXELS, LIGHT, GATHER])


class Compiled(unittest.TestCase):
    def test_programs_are_a_stage_of_their_own_and_once(self):
        with Daemon() as daemon:
            path = rooms.light_box(daemon.folder)
            reports = [daemon.render(path, size=(16, 16), spp=1, options={"vct.resolution": 16, "vct.bounces": bounces},
                                     arguments=["--technique", "vct"]).report for bounces in (2, 2, 3, 1)]
            self.assertEqual(["compile" in {s["name"] for s in r["stages"]} for r in reports], [True, False, False, False])


if __name__ == "__main__":
    unittest.main()
