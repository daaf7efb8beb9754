"""More scenes than the memory budget holds: the least recently used leaves the device, and comes back when it is asked for."""
import json
import unittest

import make
from render import Daemon, Failed
from writers import Gltf, png, quad

SIDE = 2048   # texels: 16 MiB a scene


def textured(folder, name, shade):
    g = Gltf()
    texture = g.image(png(SIDE, SIDE, lambda x, y: (shade, shade, x * 255 // SIDE)))
    positions, triangles = quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
    g.node(mesh=g.mesh(positions, triangles, g.material("picture", texture=texture), uvs=[(0, 1), (1, 1), (1, 0), (0, 0)]))
    g.camera((0, 0, 2), (0, 0, 0), 40)
    return g.save(folder, name)


class Residency(unittest.TestCase):
    def test_least_recently_used_makes_room(self):
        with Daemon("--memory-budget", "40") as daemon:
            for name, shade in (("a", 60), ("b", 120), ("c", 240)):
                daemon.candil("load", textured(daemon.folder, name + ".gltf", shade), "--name", name)
            seen = {}
            # Two fit: every third render has to push one out.
            for name in "abcacbabc":
                picture = daemon.render(name, size=(32, 32), spp=2, arguments=["--background", "1,1,1"])
                seen.setdefault(name, set()).add(picture.radiance.tobytes())
                self.assertLessEqual(daemon.stats()["device_bytes"], 40 << 20)
            self.assertEqual([len(s) for s in seen.values()], [1, 1, 1])
            self.assertEqual(daemon.stats()["loader_starts"], 3)

    def test_what_cannot_fit_is_refused_and_the_rest_goes_on(self):
        with Daemon("--memory-budget", "8") as daemon:
            large = textured(daemon.folder, "large.gltf", 9)
            with self.assertRaises(Failed) as refused:
                daemon.render(large, size=(32, 32), spp=1, arguments=["--background", "1,1,1"])
            self.assertEqual(refused.exception.status, 6)
            self.assertIn("memory", refused.exception.text)
            with self.assertRaises(Failed) as refused:
                daemon.render(make.cornell(daemon.folder), size=(2000, 2000), spp=1)
            self.assertEqual(refused.exception.status, 6)
            self.assertGreater(float(daemon.render(make.cornell(daemon.folder), size=(32, 32), spp=1).radiance.max()), 0)

    def test_voxels_push_out_what_nobody_renders(self):
        """How many voxels there are turns out in the midst of a job. Then, too, idle scenes make room."""
        with Daemon("--memory-budget", "42") as daemon:
            daemon.candil("load", textured(daemon.folder, "idle.gltf", 60), "--name", "idle")
            daemon.candil("load", make.cornell(daemon.folder), "--name", "room")
            daemon.render("idle", size=(32, 32), spp=1, arguments=["--background", "1,1,1"])
            self.assertGreater(daemon.stats()["device_bytes"], 16 << 20)
            picture = daemon.render("room", size=(32, 32), spp=1, arguments=["--technique", "vct"])
            self.assertGreater(float(picture.radiance.min()), 0)
            self.assertLessEqual(daemon.stats()["device_bytes"], 42 << 20)

    def test_what_nobody_renders_makes_room_for_a_pilot(self):
        with Daemon("--memory-budget", "40") as daemon:
            for name, shade in (("a", 60), ("b", 120), ("c", 240)):
                daemon.candil("load", textured(daemon.folder, name + ".gltf", shade), "--name", name)
            for name in "ab":
                daemon.render(name, size=(32, 32), spp=1, arguments=["--background", "1,1,1"])
            said = json.loads(daemon.candil("quote", "c", "--background", "1,1,1", "--pilot", "50", "--json")[1])
            self.assertEqual((said["technique"], said["from"]), ("pt", "pilot"), said)

    def test_voxels_that_no_job_uses_make_room_for_a_job_of_their_scene(self):
        with Daemon("--memory-budget", "40") as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "room")
            daemon.render("room", size=(32, 32), spp=1, arguments=["--technique", "vct"])
            held = daemon.stats()["device_bytes"]
            self.assertGreater(held, 10 << 20)
            # It fits the budget, but not beside the voxels.
            picture = daemon.render("room", size=(768, 768), spp=1)
            self.assertGreater(float(picture.radiance.max()), 0)


if __name__ == "__main__":
    unittest.main()
