"""Whatever was mended or left out of a scene and shows in its picture is in the reply to a render, each once; what does not show is
told by describe alone."""
import json
import os
import unittest

from render import Daemon
from writers import Gltf, png, quad, save

daemon = Daemon()
SMALL = ("--size", "4x4", "--spp", "1")
CAMERA = ("--camera", "0,2,4,0,0,0,0,1,0,40")


def setUpModule():
    unittest.enterModuleContext(daemon)


def floor(g, material=None, **more):
    positions, triangles = quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))
    return g.node(mesh=g.mesh(positions, triangles, g.material("floor") if material is None else material, **more))


def obj(name, text, mtl=None):
    if mtl is not None:
        save(daemon.folder, name + ".mtl", mtl.encode())
    return save(daemon.folder, name + ".obj", text.encode())


FACE = "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n%s\nf 1/1 2/2 3/3 4/4\n"


class Warnings(unittest.TestCase):
    def told(self, scene, *more):
        """The warnings of the reply; the command line prints the same, a line each."""
        arguments = ("render", scene, "-o", os.path.join(daemon.folder, "out.png"), *SMALL, *CAMERA, *more)
        status, out, err = daemon.candil(*arguments, "--json")
        answer = json.loads(out)
        self.assertEqual(answer["warnings_more"], 0)
        self.assertNotIn("warning", err)
        self.assertEqual(len(set(answer["warnings"])), len(answer["warnings"]))
        _, out, err = daemon.candil(*arguments)
        self.assertEqual([line for line in err.splitlines() if "warning" in line], ["warning    " + w for w in answer["warnings"]])
        self.assertNotIn("warning", out)
        return answer["warnings"]

    def check(self, scene, *parts):
        """There is one warning for each part, and no other."""
        warnings = self.told(scene)
        self.assertEqual(len(warnings), len(parts), warnings)
        for part in parts:
            self.assertEqual(sum(part in w for w in warnings), 1, (part, warnings))

    def test_a_sound_scene_has_none(self):
        g = Gltf()
        floor(g)
        self.check(g.save(daemon.folder, "sound.gltf"))

    def test_what_is_mended_and_what_is_left_out(self):
        g = Gltf()
        floor(g)
        m = g.json["materials"][0]
        m["pbrMetallicRoughness"]["baseColorFactor"] = [7, .5, .5, 1]
        g.extend(m, "KHR_materials_sheen", {"sheenColorFactor": [1, 1, 1]})
        g.extend(m, "KHR_materials_iridescence", {"iridescenceFactor": 1})
        g.json["images"] = [{"uri": "nowhere.png"}]
        g.json["textures"] = [{"source": 0}]
        m["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        self.check(g.save(daemon.folder, "mended.gltf"), "clamped", "taken as white", "KHR_materials_iridescence, KHR_materials_sheen")

    def test_what_no_picture_shows_is_for_describe(self):
        g = Gltf()
        floor(g)
        g.place([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [(0, 1, 2)])
        g.json["materials"][0]["occlusionTexture"] = {"index": g.image(png(1, 1, lambda x, y: (9, 9, 9)))}
        g.json["scenes"].append({"nodes": [0]})
        path = g.save(daemon.folder, "harmless.gltf")
        self.check(path)
        info = json.loads(daemon.candil("describe", path, "--json")[1])
        self.assertEqual((info["dropped_degenerate"], len(info["warnings"])), (1, 1))
        self.assertEqual(set(info["ignored"]), {"occlusionTexture", "scenes other than the default one"})

    def test_more_than_a_reply_holds_are_counted(self):
        lines = "".join(f"nonsense{i} 1\n" for i in range(45))
        path = obj("many", FACE % "" + lines)
        out = json.loads(daemon.candil("render", path, "-o", os.path.join(daemon.folder, "many.png"), *SMALL, "--json")[1])
        # 45 statements, and faces without a material.
        self.assertEqual((len(out["warnings"]), out["warnings_more"]), (32, 14))
        err = daemon.candil("render", path, "-o", os.path.join(daemon.folder, "many.png"), *SMALL, "--quiet")[2].splitlines()
        self.assertEqual((len(err), err[-1]), (33, "warning    14 more"))

    def test_those_of_the_surroundings_too(self):
        g = Gltf()
        floor(g)
        around = save(daemon.folder, "square.png", png(4, 4, lambda x, y: (99, 99, 99)))
        warnings = self.told(g.save(daemon.folder, "around.gltf"), "--background", around)
        self.assertEqual(["twice as wide" in w for w in warnings], [True])

    def test_a_loaded_scene_tells_each_render(self):
        path = obj("loaded", FACE % "usemtl nowhere")
        daemon.candil("load", path, "--name", "held")
        for _ in range(2):
            self.check("held", "'nowhere' is not defined")
        daemon.candil("unload", "held")

    def test_a_sweep_tells_them_once(self):
        path = obj("swept", FACE % "usemtl nowhere")
        out = os.path.join(daemon.folder, "turn.{index}.png")
        arguments = ("sweep", path, "-o", out, "--orbit", "3", *SMALL, "--force")
        answer = json.loads(daemon.candil(*arguments, "--json")[1])
        self.assertEqual((answer["written"], len(answer["warnings"]), answer["warnings_more"]), (3, 1, 0))
        err = daemon.candil(*arguments)[2]
        self.assertEqual(err.count("'nowhere' is not defined"), 1, err)

    def test_inspect_tells_them_too(self):
        path = obj("inspected", FACE % "usemtl nowhere")
        out = json.loads(daemon.candil("inspect", path, "-o", os.path.join(daemon.folder, "v"), "--set", "vct.resolution=16", "--json")[1])
        self.assertEqual(len(out["warnings"]), 1)


if __name__ == "__main__":
    unittest.main()
