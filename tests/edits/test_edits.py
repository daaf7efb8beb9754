"""Lights and materials of one request: each picture is, to the bit where arithmetic allows, the one that a file with them
gives, and no other request sees them."""
import unittest

import numpy

import make
import wire
from edited import Refused, Stage, node, pb, point, vec
from writers import Gltf, icosphere, quad

stage = Stage()


def setUpModule():
    unittest.enterModuleContext(stage)


def states(replies):
    accepted = next(r.body for r in replies if r.kind == wire.ACCEPTED)
    return {e.effect: e.state for e in accepted.plan}


class Case(unittest.TestCase):
    def same(self, a, b):
        self.assertTrue(numpy.array_equal(a, b), f"they differ by up to {numpy.abs(a - b).max()}")

    def refused(self, name, words, scene, **edits):
        with self.assertRaises(Refused) as caught:
            stage.render(scene, **edits)
        self.assertEqual(caught.exception.name, name)
        self.assertIn(words, str(caught.exception))


class Lights(Case):
    def test_the_same_light_twice_doubles_every_pixel(self):
        scene = stage.load(make.lit_floor(stage.folder, "point"))
        once = stage.radiance(scene)
        self.assertGreater(float(once.max()), 0)
        self.same(stage.radiance(scene, lights=[point((0, 2, 0), 1)]), 2 * once)

    def test_a_light_in_place_of_the_scenes_is_as_the_file_would_have_it(self):
        for kind, light in (("point", point((0, 2, 0), 3)),
                            ("directional", pb.Light(kind=pb.LIGHT_KIND_DIRECTIONAL, direction=vec(0, -7, 0), intensity=vec(3, 3, 3))),
                            ("spot", pb.Light(kind=pb.LIGHT_KIND_SPOT, position=vec(0, 2, 0), direction=vec(0, -1, 0),
                                              intensity=vec(3, 3, 3), inner_degrees=15, outer_degrees=30))):
            weak, strong = (stage.load(make.lit_floor(stage.folder, kind, i, name=f"{kind}{i}.gltf")) for i in (1, 3))
            replaced = stage.radiance(weak, lights=[light], replace_lights=True)
            wanted = stage.radiance(strong)
            self.assertGreater(float(wanted.max()), 0)
            self.assertTrue(numpy.allclose(replaced, wanted, rtol=1e-5, atol=1e-7), kind)

    def test_no_light_in_place_of_the_scenes_is_dark(self):
        scene = stage.load(make.lit_floor(stage.folder, "point"))
        picture, _, replies = stage.render(scene, replace_lights=True)
        self.assertEqual(float(picture.max()), 0)
        self.assertEqual(states(replies)[pb.EFFECT_LIGHTS], pb.EFFECT_STATE_ABSENT)

    def test_a_light_in_a_scene_without_any_calls_for_the_effect(self):
        scene = stage.load(make.unlit(stage.folder))
        picture, _, replies = stage.render(scene, lights=[point((0, 4, 2), 10)])
        self.assertGreater(float(picture.mean()), 0.01)
        self.assertEqual(states(replies)[pb.EFFECT_LIGHTS], pb.EFFECT_STATE_SIMULATED)

    def test_point_light_in_closed_form(self):
        scene = stage.load(make.unlit(stage.folder))
        # Straight below the light, 3 m away, on the floor of albedo 0.5 beside the ball.
        camera = pb.Camera(eye=vec(3, 1, 3), target=vec(3, -1, 0), up=vec(0, 1, 0), vfov_degrees=0.01)
        picture = stage.radiance(scene, camera=camera, depth=1, lights=[point((3, 2, 0), 9)])
        self.assertAlmostEqual(float(picture.mean()), 0.5 / numpy.pi, delta=1e-4)


class Materials(Case):
    def test_doubled_emission_is_the_doubled_picture_and_the_doubled_file(self):
        scene, double = (stage.load(make.cornell(stage.folder, r, name=f"cornell{r}.gltf")) for r in (15, 30))
        once, more = stage.radiance(scene), dict(materials=[pb.MaterialEdit(name="lamp", emission=vec(30, 30, 30))])
        self.same(stage.radiance(scene, **more), 2 * once)
        self.same(stage.radiance(scene, **more), stage.radiance(double))

    def test_a_wall_begins_to_shine_and_the_lamp_goes_out(self):
        scene = stage.load(make.cornell(stage.folder))
        out = [pb.MaterialEdit(name="lamp", emission=vec(0, 0, 0))]
        self.assertEqual(float(stage.radiance(scene, materials=out).max()), 0)
        picture, _, replies = stage.render(scene, materials=out + [pb.MaterialEdit(name="back", emission=vec(1, 2, 3))])
        self.assertTrue(numpy.all(picture[15, 22:26] > (0.99, 1.99, 2.99)))
        self.assertEqual(states(replies)[pb.EFFECT_EMITTERS], pb.EFFECT_STATE_SIMULATED)

    def test_colour_and_gloss_are_those_of_a_file(self):
        plain = stage.load(make.ggx_furnace(stage.folder, 1, 0, 0, name="plain.gltf"))
        metal = stage.load(make.ggx_furnace(stage.folder, 0.25, 1, 0, 0.5, name="metal.gltf"))
        edit = pb.MaterialEdit(name="surface", base_color=vec(.5, .5, .5), metallic=1, roughness=0.25)
        lights = [point((3, 3, 3), 20)]
        picture, _, replies = stage.render(plain, materials=[edit], lights=lights)
        self.same(picture, stage.radiance(metal, lights=lights))
        self.assertEqual(states(replies)[pb.EFFECT_GLOSSY], pb.EFFECT_STATE_SIMULATED)
        self.assertEqual(states(stage.render(plain, lights=lights)[2])[pb.EFFECT_GLOSSY], pb.EFFECT_STATE_ABSENT)

    def test_coat_and_matte_facets_are_those_of_a_file(self):
        def ball(name, **more):
            g = Gltf()
            positions, triangles = icosphere(2)
            g.place(positions, triangles, g.material("surface", (.5, .4, .3), **more))
            g.camera((0, 0, 4), (0, 0, 0), 40)
            return stage.load(g.save(stage.folder, name))
        plain, lights = ball("plain.gltf"), [point((3, 3, 3), 20)]
        for material, edit, effect in (
                (dict(coat={"clearcoatFactor": .5, "clearcoatRoughnessFactor": .25}), dict(coat=.5, coat_roughness=.25), pb.EFFECT_CLEARCOAT),
                (dict(matte=.75), dict(diffuse_roughness=.75), pb.EFFECT_ROUGH_DIFFUSE)):
            wanted = stage.radiance(ball("wanted%d.gltf" % effect, **material), lights=lights)
            picture, _, replies = stage.render(plain, materials=[pb.MaterialEdit(name="surface", **edit)], lights=lights)
            self.same(picture, wanted)
            self.assertEqual(states(replies)[effect], pb.EFFECT_STATE_SIMULATED)
            without = stage.render(plain, lights=lights)
            self.assertEqual(states(without[2])[effect], pb.EFFECT_STATE_ABSENT)
            self.assertGreater(float(numpy.abs(without[0] - picture).max()), 1e-3)

    def test_by_number_and_only_the_fields_given(self):
        scene = stage.load(make.cornell(stage.folder))
        number = list(stage.loaded[scene].material_names).index("left")
        named = stage.radiance(scene, materials=[pb.MaterialEdit(name="left", base_color=vec(.1, .2, .9))])
        self.same(stage.radiance(scene, materials=[pb.MaterialEdit(name=f"#{number}", base_color=vec(.1, .2, .9))]), named)
        self.same(stage.radiance(scene, materials=[pb.MaterialEdit(name="left")]), stage.radiance(scene))

    def test_without_a_name_it_has_its_number_for_one(self):
        g = Gltf()
        for name in ("", "first", ""):
            g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material(name))
        g.camera((0, 3, 0), (0, 0, 0), 30, up=(0, 0, -1))
        scene = stage.load(g.save(stage.folder, "unnamed.gltf"))
        self.assertEqual(list(stage.loaded[scene].material_names), ["material 0", "first", "material 2"])
        stage.radiance(scene, materials=[pb.MaterialEdit(name="material 2", roughness=0.5)])


class Others(Case):
    def test_the_scene_is_as_before_afterwards(self):
        scene = stage.load(make.stage(stage.folder))
        before = stage.radiance(scene)
        edits = dict(lights=[point((0, 2, 0), 1)], materials=[pb.MaterialEdit(name="block", metallic=1)],
                     nodes=[node("arm", (1, 1, 1))])
        changed = stage.radiance(scene, **edits)
        self.assertGreater(float(numpy.abs(changed - before).max()), 0.01)
        self.same(stage.radiance(scene), before)
        self.same(stage.radiance(scene, **edits), changed)

    def test_two_at_once(self):
        scene = stage.load(make.stage(stage.folder))
        edits = dict(nodes=[node("block", scale=(2, 2, 2))], lights=[point((0, 2, 0), 1)])
        alone = stage.radiance(scene, spp=64), stage.radiance(scene, spp=64, **edits)
        for _ in range(2):
            jobs = stage.submit(scene, spp=64), stage.submit(scene, spp=64, **edits)
            for job, wanted in zip(jobs, alone):
                self.same(stage.finish(job)[0], wanted)

    def test_many_variants_leave_no_memory_behind(self):
        scene = stage.load(make.stage(stage.folder))

        def held(rounds):
            for i in rounds:
                stage.radiance(scene, spp=1, size=8, nodes=[node("arm", (i / 100, 1, 0))])
            return stage.connection.stats().device_bytes

        first = held(range(8))
        self.assertEqual(held(range(8, 24)), first)

    def test_an_edited_scene_may_be_unloaded_under_way(self):
        scene = stage.load(make.stage(stage.folder, name="gone.gltf"))
        wanted = stage.radiance(scene, spp=32, nodes=[node("arm", (1, 1, 1))])
        job = stage.submit(scene, spp=32, nodes=[node("arm", (1, 1, 1))])
        self.assertEqual(stage.connection.ask(wire.UNLOAD, pb.Unload(name=scene)).kind, wire.OK)
        self.same(stage.finish(job)[0], wanted)


class Wrong(Case):
    def test_names_that_are_not_there(self):
        scene = stage.load(make.stage(stage.folder))
        self.refused("bad-argument", "no material 'gold': `candil describe`", scene, materials=[pb.MaterialEdit(name="gold")])
        self.refused("bad-argument", "no node 'leg': `candil describe`", scene, nodes=[node("leg", (0, 0, 0))])
        self.refused("bad-argument", "no node '#99'", scene, nodes=[node("#99", (0, 0, 0))])
        self.refused("bad-argument", "no animation 'dance': `candil describe`", scene, animation="dance")

    def test_a_name_that_several_have(self):
        g = make.Gltf()
        for x in (-1, 1):
            g.place(*make.icosphere(0), g.material("same"), name="twin", translation=[x, 0, 0])
        g.camera((0, 0, 6), (0, 0, 0))
        scene = stage.load(g.save(stage.folder, "twins.gltf"))
        self.refused("bad-argument", "2 nodes that 'twin' names", scene, nodes=[node("twin", (0, 0, 0))])
        stage.render(scene, nodes=[node("#1", (0, 0, 0))])
        # Of materials all that have the name are meant.
        picture = stage.radiance(scene, materials=[pb.MaterialEdit(name="same", emission=vec(1, 1, 1))])
        for x in (13, 35):
            self.assertGreaterEqual(float(picture[24, x].min()), 1)

    def test_numbers_that_are_none(self):
        scene = stage.load(make.stage(stage.folder))
        for bad in (float("nan"), float("inf"), 1e300):
            self.refused("bad-argument", "translation", scene, nodes=[node("arm", (bad, 0, 0))])
            self.refused("bad-argument", "rotation", scene, nodes=[node("arm", rotation=(0, bad, 0, 1))])
            self.refused("bad-argument", "scale", scene, nodes=[node("arm", scale=(1, bad, 1))])
            self.refused("bad-argument", "time", scene, animation="play", time_s=bad)
            self.refused("bad-argument", "position", scene, lights=[point((0, bad, 0), 1)])
            self.refused("bad-argument", "intensity", scene, lights=[point((0, 0, 0), bad)])
            self.refused("bad-argument", "roughness", scene, materials=[pb.MaterialEdit(name="lamp", roughness=bad)])
            self.refused("bad-argument", "emission", scene, materials=[pb.MaterialEdit(name="lamp", emission=vec(bad, 0, 0))])
        self.refused("bad-argument", "flatten", scene, nodes=[node("arm", scale=(1, 0, 1))])
        self.refused("bad-argument", "quaternion", scene, nodes=[node("arm", rotation=(0, 0, 0, 0))])
        self.refused("bad-argument", "reach beyond", scene, nodes=[node("arm", (1e12, 0, 0), scale=(1e9, 1, 1))])

    def test_a_node_that_its_own_transform_flattens(self):
        g = make.Gltf()
        flat = g.place(*make.icosphere(1), g.material("flat"), name="flat", scale=[1, 0, 1])
        g.place(*make.icosphere(1), g.material("round"), name="round")
        g.camera((0, 2, 6), (0, 0, 0))
        scene = stage.load(g.save(stage.folder, "flat.gltf"))
        self.assertEqual(flat, 0)
        self.refused("bad-argument", "its own transform flattens it", scene, nodes=[node("flat", scale=(1, 1, 1))])


if __name__ == "__main__":
    unittest.main()
