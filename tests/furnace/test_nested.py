"""Clear bodies that overlap: by their priorities each place has one of them, whichever way light comes."""
import os
import random
import unittest

import numpy

import images
import skies
from render import Daemon
from table import HardCase
from writers import Gltf, box, pit_box


daemon = Daemon()


def setUpModule():
    global sky
    unittest.enterModuleContext(daemon)
    sky = os.path.join(daemon.folder, "sky.exr")
    w = skies.directions(256, 128)
    images.write(sky, numpy.stack([1 + 0.8 * w[..., 1], 1 + 0.7 * w[..., 0], 1.2 - 0.9 * w[..., 2] ** 2], axis=-1))


def body(g, name, shape, colour=(1, 1, 1), ior=1.0, priority=0, **more):
    """What a metre of it lets through is `colour`."""
    g.place(*shape, g.material(name, roughness=0, ior=ior, clear=1, priority=priority, **more,
                               volume={"thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": list(colour)}))


def along(scene, up):
    """A narrow view through the origin, up or down, in a white world."""
    camera = (0, -9 if up else 9, 0, 0, 0, 0, 0, 0, 1, 0.002)
    return daemon.twice(scene, (8, 8), 1, camera, options={"pt.depth": 24, "pt.roulette": "off"}, arguments=["--background", "1,1,1"])


class Slabs(HardCase):
    """Of index 1, which light goes straight through: what each takes away tells where it is."""

    def seen(self, case, scene, expected):
        for up in (False, True):
            picture = along(scene, up)
            got = picture.radiance.mean(axis=(0, 1), dtype=numpy.float64)
            self.row("glass", f"{case}, seen from {'below' if up else 'above'}, its worst channel", picture, numpy.abs(got / expected - 1).max(), 0,
                     "Lambert and Beer", 1e-4)

    def check(self, slabs):
        """Slabs are (lower end, upper end, colour, priority), no two of one priority."""
        g = Gltf()
        for i, (low, high, colour, priority) in enumerate(slabs):
            body(g, f"slab {i}", box((-5, low, -5), (5, high, 5)), colour, priority=priority)
        scene = g.save(daemon.folder, "slabs.gltf")
        ends = sorted(end for low, high, _, _ in slabs for end in (low, high))
        expected = numpy.ones(3)
        for low, high in zip(ends, ends[1:]):
            there = [s for s in slabs if s[0] <= low and s[1] >= high]
            if there:
                expected *= numpy.array(max(there, key=lambda s: s[3])[2]) ** (high - low)
        self.seen(f"{len(slabs)} bodies that overlap, of priorities {', '.join(str(s[3]) for s in slabs)}", scene, expected)

    def test_the_higher_one_is_there_from_either_side(self):
        for first, second in ((1, 0), (0, 1), (255, 254)):
            self.check([(0, 1, (0.5, 0.9, 0.2), first), (0.4, 2, (0.9, 0.3, 0.8), second)])

    def test_any_four(self):
        chance = random.Random(4)
        for _ in range(4):
            priorities = chance.sample(range(256), 4)
            slabs = []
            for priority in priorities:
                low = chance.uniform(-1, 0.5)
                slabs.append((low, low + chance.uniform(0.3, 1.5), tuple(chance.uniform(0.2, 1) for _ in range(3)), priority))
            self.check(slabs)

    def test_a_hidden_face_leaves_light_as_it_is(self):
        """Tint, half a transmission and facets of what is within another of a higher priority: none of them is there."""
        g = Gltf()
        body(g, "outer", box((-5, 0, -5), (5, 2, 5)), (0.5, 0.7, 0.9), priority=2)
        g.place(*box((-4, 0.5, -4), (4, 1.5, 4)), g.material("inner", (0.5, 0, 1), ior=2, clear=0.5, roughness=0.7, priority=1,
                                                             volume={"thicknessFactor": 1}))
        self.seen("a body hidden in another of a higher priority", g.save(daemon.folder, "hidden.gltf"), numpy.array([0.5, 0.7, 0.9]) ** 2)


class Drink(unittest.TestCase):
    """An ice cube in a drink in a glass. As people model it the drink reaches into the wall and the ice into the drink; and with
    each interface where it is, which the rule for bodies without priorities does if they overlap by no more than a hair."""
    ICE = ((-0.35, 1.0, -0.4), (0.45, 2.0, 0.3))
    HAIR = 1e-4

    def picture(self, name, drink, priorities, seed=0):
        g = Gltf()
        shapes = {"glass": pit_box((-1, 0, -1), (1, 2.4, 1), (-0.8, 0.3, -0.8), (0.8, 2.4, 0.8)), "drink": drink, "ice": box(*self.ICE)}
        looks = {"glass": ((0.8, 0.95, 0.85), 1.5), "drink": ((0.9, 0.5, 0.2), 1.33), "ice": ((0.7, 0.85, 0.95), 1.2)}
        for part in ("glass", "drink", "ice"):
            body(g, part, shapes[part], *looks[part], priorities.get(part, 0))
        return daemon.render(g.save(daemon.folder, name + ".gltf"), (48, 48), 64, (2.2, 4, 4.5, 0, 1.1, 0, 0, 1, 0, 32),
                             {"pt.depth": 120}, ["--background", sky, "--seed", str(seed)]).radiance.astype(numpy.float64)

    def test_priorities_are_exact_interfaces(self):
        hair = self.HAIR
        pit = [[a + hair for a in self.ICE[0]], [a - hair for a in self.ICE[1]]]
        exact = pit_box((-0.8 - hair, 0.3 - hair, -0.8 - hair), (0.8 + hair, 1.6, 0.8 + hair), *pit)
        rough = box((-0.9, 0.15, -0.9), (0.9, 1.6, 0.9))
        order = {"glass": 3, "ice": 2, "drink": 1}
        pictures = {"exact": self.picture("exact", exact, {}), "again": self.picture("exact", exact, {}, 1),
                    "stated": self.picture("rough", rough, order, 2), "unstated": self.picture("rough", rough, {}, 3)}
        if "KEEP" in os.environ:
            for name, picture in pictures.items():
                images.write(f"{os.environ['KEEP']}{name}.png", numpy.clip(picture / 2, 0, 1) ** 0.45)
        blocks = {name: p.reshape(8, 6, 8, 6, 3).mean(axis=(1, 3)) for name, p in pictures.items()}
        noise, stated, unstated = (float(numpy.sqrt(((blocks[a] - blocks["exact"]) ** 2).mean()))
                                   for a in ("again", "stated", "unstated"))
        print(f"off the exact interfaces: by noise {noise:.5f}, with priorities {stated:.5f}, without {unstated:.5f}")
        self.assertLess(stated, 1.6 * noise)
        self.assertGreater(unstated, 3 * noise)


if __name__ == "__main__":
    unittest.main()
