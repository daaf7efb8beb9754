"""Nodes moved by a request or an animation: the picture is that of a file with the nodes there, by what each ray hits."""
import math
import unittest

import numpy

import make
import wire
from edited import Refused, Stage, node, pb, point, vec
from writers import Gltf, icosphere

stage = Stage()


def setUpModule():
    unittest.enterModuleContext(stage)


MOVES = {
    "pushed": dict(translation=[.5, .25, -1]),
    "turned": dict(rotation=make.turned((0, 1, 0), 50)),
    "scaled": dict(scale=[.5, 2, 1.5]),
    "all": dict(translation=[.3, .9, .1], rotation=make.turned((.6, 0, .8), 130), scale=[1.5, .5, 2]),
    "mirrored": dict(scale=[-1, 1, 1]),
}


class Case(unittest.TestCase):
    def alike(self, a, b, what=""):
        """Two pictures of what should be the same geometry, built in two ways: positions differ by roundings, so that rays by
        an edge may fall to either side."""
        (radiance, channels, _), (wanted, wanted_channels, _) = a, b
        hits = channels["id"] == wanted_channels["id"]
        self.assertGreater(float(hits.mean()), 0.995, what)
        # Pixels with an edge in them mix two depths.
        depth = numpy.isclose(channels["Z"], wanted_channels["Z"], rtol=1e-5)
        self.assertGreater(float(depth[hits].mean()), 0.99, what)
        close = numpy.isclose(radiance, wanted, rtol=1e-3, atol=1e-4).all(axis=2)
        self.assertGreater(float(close.mean()), 0.95, what)
        self.assertLess(abs(float(radiance.mean() / wanted.mean()) - 1), 0.005, what)

    def check(self, part, move, **more):
        scene = stage.load(make.stage(stage.folder))
        there = stage.load(make.stage(stage.folder, **{part: move}, name="there.gltf"))
        moved = stage.render(scene, nodes=[node(part, **move)], **more)
        self.alike(moved, stage.render(there, **more), f"{part} {move}")
        return moved


class Nodes(Case):
    def test_a_block_moves(self):
        still = stage.render(stage.load(make.stage(stage.folder)))
        for name, move in MOVES.items():
            with self.subTest(name):
                moved = self.check("block", move)
                self.assertGreater(float((moved[1]["id"] != still[1]["id"]).mean()), 0.01)

    def test_children_follow(self):
        for name, move in MOVES.items():
            with self.subTest(name):
                self.check("arm", move)

    def test_instances_go_with_their_node(self):
        def scene(name, **place):
            g = Gltf()
            positions, triangles = icosphere(1)
            tree = g.node(mesh=g.mesh(positions, triangles, g.material("leaf", (.5, .6, .3)), normals=positions), name="tree", **place)
            g.instances(tree, [(-1, 0, 0), (1, 0, 0), (0, 1.5, 0)], scales=[(.5, .5, .5), (.4, .8, .4), (.5, .2, .5)])
            g.light("point", 30, (2, 4, 4))
            g.camera((0, 0, 6), (0, 0, 0), 40)
            return stage.load(g.save(stage.folder, name))
        still = scene("grove.gltf")
        for name in ("pushed", "all"):
            with self.subTest(name):
                moved = stage.render(still, nodes=[node("tree", **MOVES[name])])
                self.alike(moved, stage.render(scene("there.gltf", **MOVES[name])), name)
                self.assertGreater(float((moved[1]["id"] != stage.render(still)[1]["id"]).mean()), 0.01)

    def test_an_emitter_moves_with_its_power(self):
        for name in ("pushed", "scaled", "mirrored"):
            with self.subTest(name):
                self.check("lamp", dict(MOVES[name], translation=[.5, 2.5, 0]), spp=32)

    def test_an_emitters_area_counts(self):
        # Light straight below the middle of a 2 x 2 lamp at height 2 is that of a 1 x 1 lamp at height 1.
        scene = stage.load(make.lamp_over_floor(stage.folder))
        edit = node("#1", (0, 0, 0), scale=(2, 2, 2))
        camera = pb.Camera(eye=vec(0, .5, 3), target=vec(0, 0, 0), up=vec(0, 1, 0), vfov_degrees=.05)
        picture = stage.radiance(scene, spp=256, size=16, depth=1, camera=camera, nodes=[edit])
        self.assertLess(abs(float(picture.mean()) * math.pi / .5 / .75227 - 1), 0.005)

    def test_a_light_moves(self):
        self.check("bulb", dict(translation=[1, 1.5, .5]))

    def test_the_scenes_camera_follows(self):
        self.check("rig", dict(translation=[.5, .5, 0], rotation=make.turned((0, 1, 0), 10)))

    def test_smooth_normals_and_normal_maps_turn_along(self):
        for make_scene, more in ((make.ggx_furnace, dict(metallic=1)), (make.normal_mapped_quad, {})):
            scene = stage.load(make_scene(stage.folder, **more))
            eye = make.transformed([(0, 0, 2.5)], make.rotation((0, 1, 0), 90))[0]
            straight, aside = (pb.Camera(eye=vec(*e), target=vec(0, 0, 0), up=vec(0, 1, 0), vfov_degrees=45)
                               for e in ((0, 0, 2.5), eye))
            # The whole turns: node, camera and light.
            still = stage.render(scene, camera=straight, lights=[point((1, 2, 2), 5)], replace_lights=True)
            light = make.transformed([(1, 2, 2)], make.rotation((0, 1, 0), 90))[0]
            turned = stage.render(scene, camera=aside, lights=[point(light, 5)], replace_lights=True,
                                  nodes=[node("#0", rotation=make.turned((0, 1, 0), 90))])
            self.assertGreater(float(still[0].max()), 0.05)
            close = numpy.isclose(still[0], turned[0], rtol=1e-2, atol=1e-3).all(axis=2)
            self.assertGreater(float(close.mean()), 0.97)

    def test_far_from_zero_nothing_is_lost(self):
        offset = (1e5, -3e4, 2e4)
        scene = stage.load(make.offset_by_node(stage.folder, offset))
        still = stage.render(scene)
        pushed = stage.render(scene, nodes=[node("#0", [offset[0] + .25, offset[1], offset[2]])])
        back = stage.render(scene, nodes=[node("#0", offset)])
        self.assertTrue(numpy.array_equal(still[0], back[0]))
        self.assertGreater(float((pushed[1]["id"] != still[1]["id"]).mean()), 0.01)

    def test_a_tree_that_suffers_is_told(self):
        g = make.Gltf()
        for i in range(24):
            g.place(*make.icosphere(0, .02), g.material("m"), name=f"ball {i}", translation=[i % 6, i // 6, 0])
        g.camera((2.5, 1.5, 12), (2.5, 1.5, 0))
        scene = stage.load(g.save(stage.folder, "balls.gltf"))
        # Neighbours come to stand far from each other: boxes over two of them grow to the whole scene.
        far = [node(f"ball {i}", [i * 11 % 24 % 6, i * 11 % 24 // 6, 0]) for i in range(24)]
        notes = lambda replies: list(next(r.body for r in replies if r.kind == wire.ACCEPTED).notes)
        self.assertEqual(notes(stage.render(scene, spp=1)[2]), [])
        self.assertEqual(notes(stage.render(scene, spp=1, nodes=[node("ball 3", [3, 0, .1])])[2]), [])
        self.assertIn("rays cost about", " ".join(notes(stage.render(scene, spp=1, nodes=far)[2])))


class Animations(Case):
    def pose(self, t):
        share = min(max(t / 2, 0), 1)
        grown = 2.0 if t >= 1 else 1.0
        return dict(arm=dict(rotation=make.turned((0, 1, 0), 90 * share)), block=dict(scale=[grown] * 3),
                    lamp=dict(translation=[0, 3 - (3 * share ** 2 - 2 * share ** 3), 0]), rig=dict(translation=[share, 0, 0]))

    def test_describe_tells_it(self):
        scene = stage.load(make.stage(stage.folder))
        info = stage.loaded[scene]
        self.assertEqual([(a.name, a.duration_s) for a in info.animations], [("play", 2.0)])
        self.assertEqual(list(info.nodes), ["floor", "arm", "block", "lamp", "bulb", "rig", "camera"])
        self.assertEqual((info.node_count, info.animation_count), (7, 1))

    def test_at_each_time_it_is_the_pose(self):
        scene = stage.load(make.stage(stage.folder))
        for t in (-1, 0, .5, .999, 1, 1.7, 2, 99):
            with self.subTest(t):
                animated = stage.render(scene, animation="play", time_s=t)
                edits = [node(part, **move) for part, move in self.pose(t).items()]
                self.alike(animated, stage.render(scene, nodes=edits), f"t = {t}")
        there = stage.load(make.stage(stage.folder, **self.pose(1.3), name="there.gltf"))
        self.alike(stage.render(scene, animation="#0", time_s=1.3), stage.render(there), "in a file")

    def test_at_rest_it_is_the_scene_to_the_bit(self):
        scene = stage.load(make.stage(stage.folder))
        self.assertTrue(numpy.array_equal(stage.radiance(scene, animation="play", time_s=0), stage.radiance(scene)))

    def test_a_nodes_edit_comes_on_top(self):
        scene = stage.load(make.stage(stage.folder))
        both = stage.render(scene, animation="play", time_s=2, nodes=[node("arm", rotation=(0, 0, 0, 1))])
        pose = dict(self.pose(2), arm=dict(rotation=[0, 0, 0, 1]))
        self.alike(both, stage.render(scene, nodes=[node(p, **m) for p, m in pose.items()]))

    def sweep(self, scene, times, cameras, **edits):
        request = stage.request(scene, **edits)
        sweep = pb.Sweep(render=request, cameras=cameras, times=times)
        return stage.finish(stage.connection.send(wire.SWEEP, sweep))

    def test_a_sweep_over_times_has_the_bits_of_single_renders(self):
        scene = stage.load(make.stage(stage.folder))
        times = [0, .4, 1.1, 2]
        frames = self.sweep(scene, times, [pb.Camera()], animation="play")
        self.assertEqual(len(frames), len(times))
        for t, frame in zip(times, frames):
            self.assertTrue(numpy.array_equal(frame[0], stage.radiance(scene, animation="play", time_s=t)), f"t = {t}")
        fixed = pb.Camera(eye=vec(0, 2, 6), target=vec(0, 1, 0), up=vec(0, 1, 0), vfov_degrees=40)
        own = self.sweep(scene, times[:2], [pb.Camera(), fixed], animation="play")
        self.assertTrue(numpy.array_equal(own[0][0], frames[0][0]))
        self.assertTrue(numpy.array_equal(own[1][0], stage.radiance(scene, camera=fixed, animation="play", time_s=.4)))

    def test_sweeps_that_do_not_fit_together(self):
        scene = stage.load(make.stage(stage.folder))
        for words, times, cameras, edits in (("needs an animation", [1], 1, {}),
                                             ("takes as many cameras", [1, 2, 3], 2, dict(animation="play")),
                                             ("a time is finite", [1, float("nan")], 1, dict(animation="play"))):
            with self.assertRaises(Refused) as caught:
                self.sweep(scene, times, [pb.Camera()] * cameras, **edits)
            self.assertIn(words, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
