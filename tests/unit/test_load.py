"""What the loader makes of sound scenes: counts, bounds, nodes, vertices, cameras, lights, units and orientation."""
import base64
import json
import math
import os
import shutil
import struct
import subprocess
import unittest

import numpy as np

import images
import make
from loaded import FLAGS, LOADER, POWER, WANTS_IMAGES, LoadCase
from writers import Gltf, Obj, look_at, png, quad, save


class Load(LoadCase):
    def test_a_file_in_a_deeper_folder_has_its_side_files_there(self):
        os.mkdir(os.path.join(self.folder, "deep"))
        deep = os.path.join(self.folder, "deep")
        positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
        save(deep, "corners.bin", positions)
        save(deep, "scene.gltf", json.dumps({
            "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "corners.bin"}]}).encode())
        done = subprocess.run([LOADER, "--describe", "--dir", self.folder, "--file", "deep/scene.gltf"],
                              capture_output=True, timeout=120, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(done.stdout)
        self.assertEqual((info["file"], info["triangles"]), ("deep/scene.gltf", 1))

    def test_the_decoder_of_images_is_linked_for_images_alone(self):
        alone = shutil.copy(LOADER, self.folder)  # without what lies beside it
        plain = save(self.folder, "plain.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n")
        save(self.folder, "a.mtl", b"newmtl a\nmap_Kd a.png\n")
        save(self.folder, "a.png", png(1, 1, lambda x, y: (255, 0, 0)))
        with_image = save(self.folder, "image.obj", b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n")
        for path, more, code, said in ((plain, [], 0, ""), (with_image, [], WANTS_IMAGES, "add --images"),
                                       (with_image, ["--images"], 127, "candil-images.so: cannot open")):
            done = subprocess.run([alone, "--describe", "--dir", self.folder, "--file", os.path.basename(path), *more],
                                  capture_output=True, timeout=120, text=True)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(said, done.stderr)
        self.assertEqual(self.load(with_image, "--images")[0]["textures"], 1)

    def test_formats_in_the_sandbox(self):
        """What load_many says of each the loader itself says, too, with all that its sandbox refuses."""
        names = ["a.png", "a.jpg", "a.bmp", "a.tif", "a.tga"]
        for name in names:
            images.write(os.path.join(self.folder, name), np.full((8, 8, 3), .5, np.float32))
        save(self.folder, "all.mtl", "".join(f"newmtl {name}\nmap_Kd {name}\n" for name in names).encode())
        faces = "".join(f"usemtl {name}\nf 1/1 2/1 3/1\n" for name in names)
        pictures = save(self.folder, "all.obj", ("mtllib all.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n" + faces).encode())
        broken = save(self.folder, "broken.glb", b"glTF")
        for path, textures in ((make.furnace(self.folder), 0), (make.furnace_glb(self.folder), 0), (make.cornell_obj(self.folder), 0),
                               (make.textured_quad(self.folder), 1), (pictures, len(names)), (broken, None)):
            with self.subTest(path):
                loaded, said = self.try_load(path)
                command = [LOADER, "--describe", "--dir", self.folder, "--file", os.path.basename(path)]
                done = subprocess.run(command, capture_output=True, timeout=120, text=True)
                if textures:
                    self.assertEqual(done.returncode, WANTS_IMAGES, done)
                    done = subprocess.run([*command, "--images"], capture_output=True, timeout=120, text=True)
                self.assertEqual((done.returncode, done.stdout or done.stderr), (0 if loaded else 1, said))
                self.assertEqual(loaded, textures is not None)
                if loaded:
                    self.assertEqual((json.loads(said)["textures"], json.loads(said)["warnings"]), (textures, []))

    def test_every_scene_loads_without_a_warning(self):
        for name, write in make.SCENES.items():
            info, _ = self.load(write(self.folder))
            if name != "offset_in_vertices":
                self.assertEqual(info["warnings"], [], name)
            self.assertEqual(info["ignored"], [], name)
            self.assertEqual(info["dropped_degenerate"] + info["dropped_non_finite"] + info["dropped_out_of_range"], 0, name)

    def test_the_same_file_gives_the_same_blob(self):
        path = make.cornell(self.folder)
        unit = ("--unit", "1")
        self.assertEqual(self.load(path, *unit)[1].data, self.load(path, *unit)[1].data)  # by two processes
        self.assertEqual(self.load(path)[1].data, self.load(path)[1].data)

    def test_gltf_and_glb_say_the_same(self):
        one, a = self.load(make.furnace(self.folder))
        two, b = self.load(make.furnace_glb(self.folder))
        self.assertEqual(one["hash"], two["hash"])
        self.assertEqual(a.data, b.data)

    def test_hierarchy(self):
        info, blob = self.load(make.hierarchy(self.folder))
        got = sorted(tuple(round(x, 5) for x in v[:3]) for v in blob.vertices)
        self.assertEqual(got, sorted([(1, 2, 3), (1, 4, 3), (-1, 2, 3), (1, 2, 4)]))
        self.assertEqual(info["origin"], [0, 0, 0])

    def test_negative_scale_keeps_the_front(self):
        _, blob = self.load(make.negative_scale(self.folder))
        normal = blob.normal(blob.emitters[0][0])
        self.assertGreater(normal[1], 0)
        self.assertEqual((normal[0], normal[2]), (0, 0))

    def test_instances_are_separate_nodes_bit_for_bit(self):
        translations = [(.1, .2, .3), (-4, 5, 6.5), (0, 0, -9)]
        rotations = [(0, 0, 0, 2), (.6, 0, 0, .8), (.1, -.2, .3, .4)]
        scales = [(1, 1, 1), (2, .5, 3), (-1, 1, 1)]

        def scene(name, place):
            g = Gltf()
            positions, triangles = make.icosphere(1)
            mesh = g.mesh(positions, triangles, g.material("lamp", (.5,) * 3, (1, 2, 3)), normals=positions)
            place(g, mesh, {"translation": [7, 8, 9], "rotation": [0, .6, 0, .8], "scale": [1.5, 1.5, .1]})
            return self.load(g.save(self.folder, name))

        def together(g, mesh, where):
            g.instances(g.node(mesh=mesh, **where), translations, rotations, scales)

        def apart(g, mesh, where):
            # What a list of single floats holds, each in a node.
            short = [[struct.unpack("<f", struct.pack("<f", x))[0] for x in row] for rows in (translations, rotations, scales) for row in rows]
            parts = [g.node(False, mesh=mesh, translation=short[i], rotation=short[3 + i], scale=short[6 + i]) for i in range(3)]
            g.node(children=parts, **where)
        info, one = scene("together.gltf", together)
        apart_info, other = scene("apart.gltf", apart)
        self.assertEqual((info["triangles"], info["ignored"], info["warnings"]), (240, [], []))
        self.assertEqual((info["node_count"], apart_info["node_count"]), (1, 4))
        for section in ("vertices", "triangles", "emitters"):
            self.assertEqual(getattr(one, section), getattr(other, section), section)
        self.assertEqual(info["bounds_max"], apart_info["bounds_max"])

    def test_instances_of_one_attribute(self):
        g = Gltf()
        node = g.place(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), g.material("m"))
        g.instances(node, scales=[(1, 1, 1), (2, 2, 2)])
        info, _ = self.load(g.save(self.folder, "scaled.gltf"))
        self.assertEqual((info["triangles"], info["bounds_max"]), (4, [2, 2, 0]))

    def test_normals_go_by_the_inverse_transpose(self):
        for scale in ([1, 4, 1], [-1, 4, 1], [1, 4, -1], [-1, -4, -1]):
            g = Gltf()
            slope = math.sqrt(0.5)
            mesh = g.mesh([[0, 0, 0], [0, 0, 1], [1, -1, 0]], [(0, 1, 2)], g.material("m"), normals=[[slope, slope, 0]] * 3)
            g.node(mesh=mesh, scale=scale)
            _, blob = self.load(g.save(self.folder, "slope.gltf"))
            normal = blob.normal(0)
            length = math.sqrt(sum(x * x for x in normal))
            self.near(blob.corner(0, 0)[3:6], [x / length for x in normal])

    def test_strips_and_fans_keep_their_winding(self):
        for mode, positions in ((5, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]), (6, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])):
            g = Gltf()
            g.place(positions, [(0, 1, 2), (3,)])
            g.json["meshes"][0]["primitives"][0]["mode"] = mode
            _, blob = self.load(g.save(self.folder, "strip.gltf"))
            self.assertEqual(len(blob.triangles), 2)
            for i in range(2):
                self.assertGreater(blob.normal(i)[2], 0)

    def test_offset_by_node_keeps_every_bit(self):
        info, far = self.load(make.offset_by_node(self.folder))
        _, near = self.load(make.offset_by_node(self.folder, offset=(0, 0, 0)))
        self.assertEqual(info["origin"][0], 1e5)
        self.assertEqual(info["warnings"], [])
        shift = info["origin"]
        for a, b in zip(far.vertices, near.vertices):
            self.near(a[:3], (b[0], b[1] - shift[1], b[2] - shift[2]), 12)

    def test_offset_in_vertices_is_said(self):
        info, _ = self.load(make.offset_in_vertices(self.folder))
        self.assertIn("put the offset into a node", info["warnings"][0])

    def test_cameras(self):
        g = Gltf()
        g.place(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)))
        g.camera((1, 2, 3), (1, 2, -4), 50, name="straight")
        wide = g.add("cameras", {"type": "orthographic", "orthographic": {"xmag": 4, "ymag": 2, "znear": 0, "zfar": 9}})
        g.node(camera=wide, name="flat", matrix=look_at((0, 9, 0), (0, 0, 0), (0, 0, -1)))
        info, _ = self.load(g.save(self.folder, "cameras.gltf"))
        straight, flat = info["cameras"]
        self.assertEqual((straight["name"], flat["name"]), ("straight", "flat"))
        self.near(straight["eye"], (1, 2, 3))
        self.near(straight["target"], (1, 2, 2))
        self.near(straight["up"], (0, 1, 0))
        self.assertAlmostEqual(straight["vfov_degrees"], 50, 9)
        self.near(flat["target"], (0, 8, 0))
        self.near(flat["up"], (0, 0, -1))
        self.assertEqual(flat["vfov_degrees"], 0)

    def test_punctual_lights(self):
        for kind, number in (("point", 0), ("spot", 1), ("directional", 2)):
            info, blob = self.load(make.lit_floor(self.folder, kind, 3.0))
            light = blob.lights[0]
            self.assertEqual(light[3], number)
            self.near(light[8:11], (3, 3, 3))
            self.assertEqual(light[13], 0)
            self.assertEqual(light[14], 1.0)
            if kind != "directional":
                self.near(light[:3], (0, 2, 0))
            if kind != "point":
                self.near(light[4:7], (0, -1, 0))
            if kind == "spot":
                self.near((light[11], light[7]), (1 - math.cos(math.radians(15)), 1 - math.cos(math.radians(30))))
            self.assertIn(kind + " lights", info["facts"])
            self.assertIn("1 cd as 1 W/sr", info["light_units"])

    def test_emission(self):
        info, blob = self.load(make.cornell(self.folder, 15.0))
        lamp = blob.materials[-1]
        self.near(lamp[4:7], (15, 15, 15), 5)
        self.assertAlmostEqual(lamp[POWER], 15 * math.pi, 4)
        self.assertEqual([e[3] for e in blob.emitters], [0.5, 0.5])
        _, twice = self.load(make.cornell(self.folder, 30.0))
        self.assertEqual(blob.emitters, twice.emitters)

    def test_double_sided_emitters_weigh_twice(self):
        g = Gltf()
        g.place(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), g.material("one", emission=(1, 1, 1)))
        g.place(*quad((2, 0, 0), (3, 0, 0), (3, 1, 0), (2, 1, 0)), g.material("two", emission=(1, 1, 1), both_sides=True))
        _, blob = self.load(g.save(self.folder, "sides.gltf"))
        self.near([e[3] for e in blob.emitters], [1 / 6, 1 / 6, 1 / 3, 1 / 3])
        self.assertEqual([m[FLAGS] for m in blob.materials], [0, 1])

    def test_texture(self):
        _, blob = self.load(make.textured_quad(self.folder, magFilter=9728, wrapS=33071, wrapT=33648))
        offset, width, height, flags = blob.textures[0][:4]
        self.assertEqual((width, height), (2, 2))
        self.assertEqual(flags, 1 | 2 << 2 | 1 << 4 | 1 << 5)  # clamp, mirror, nearest, sRGB
        self.assertEqual(blob.texels, [(0xFF0000FF,), (0xFF00FF00,), (0xFFFF0000,), (0xFFFFFFFF,)])
        self.assertEqual(blob.materials[0][3], 0)
        self.near(blob.corner(0, 0)[6:8], (0, 1))

    def test_textures_share_their_texels(self):
        g = Gltf()
        image = png(3, 1, lambda x, y: (x, x, x))
        one = g.image(image, magFilter=9728)
        two = g.add("textures", {"source": g.json["textures"][one]["source"]})
        for texture in (one, two):
            g.place(*quad((0, 0, texture), (1, 0, texture), (1, 1, texture), (0, 1, texture)), g.material("m", texture=texture))
        _, blob = self.load(g.save(self.folder, "shared.gltf"))
        self.assertEqual(len(blob.textures), 2)
        self.assertEqual(len(blob.texels), 3)

    def test_obj(self):
        info, blob = self.load(make.cornell_obj(self.folder))
        one, _ = self.load(make.cornell(self.folder))
        for key in ("triangles", "emissive_triangles", "bounds_min", "bounds_max"):
            self.assertEqual(info[key], one[key], key)
        for e in blob.emitters:
            self.assertLess(blob.normal(e[0])[1], 0)  # the lamp looks down

    def test_obj_corners_that_are_the_same_are_one_vertex(self):
        # Four quads around a middle: nine places, of which the middle has two pairs of texture coordinates.
        lines = [f"v {x} {y} 0" for y in range(3) for x in range(3)] + ["vt 0 0", "vt 1 1"]
        for at, corners in ((1, (1, 2, 5, 4)), (1, (2, 3, 6, 5)), (1, (4, 5, 8, 7)), (2, (5, 6, 9, 8))):
            lines.append("f " + " ".join(f"{c}/{at if c == 5 else 1}" for c in corners))
        path = os.path.join(self.folder, "grid.obj")
        with open(path, "w", encoding="ascii") as file:
            file.write("\n".join(lines) + "\n")
        info, blob = self.load(path)
        self.assertEqual((info["triangles"], len(blob.vertices), len(set(blob.vertices))), (8, 10, 10))
        self.assertEqual({blob.normal(i) > [0, 0, 0] for i in range(8)}, {True})

    def test_obj_axes_and_units(self):
        o = Obj()
        o.material("m", (.5, .5, .5))
        o.mesh([(0, 0, 0), (1, 0, 0), (0, 2, 3)], [(0, 1, 2)], "m")
        path = o.save(self.folder, "axes.obj")
        info, _ = self.load(path, "--up", "z", "--unit", "0.5")
        self.near(info["bounds_min"], (0, 0, -1))
        self.near(info["bounds_max"], (0.5, 1.5, 0))
        info, _ = self.load(path, "--up", "y")
        self.near(info["bounds_max"], (1, 2, 3))

    def test_data_uris_of_every_form(self):
        corners = b"".join(struct.pack("<3f", *c) for c in ((-1.4e-3, 3.7, -.37), (1.9991, .12, -77.1), (.33, -9.9, .77)))
        plain = base64.b64encode(corners).decode()
        picture = png(1, 1, lambda x, y: (255, 0, 0))
        percents = "".join("%%%02X" % b for b in picture)
        heads = ("data:;base64,", "data:application/octet-stream;base64,", "DATA:Application/Octet-Stream;BASE64,",
                 "data:application/gltf-buffer;charset=x;base64,", "data:model/x;a=b;c=d;base64,")
        uris = [head + plain for head in heads]
        self.assertTrue("+" in plain and "/" in plain)
        for head in ("data:; base64,", "data:x/y;base64 ,", heads[0], heads[1]):
            uris += [head + plain.replace("+", "%2B").replace("/", "%2f"), head + plain.replace("+", "-").replace("/", "_"),
                     head + plain[:9] + " \n" + plain[9:]]
        uris += [heads[0] + plain.replace("=", ""), heads[0] + plain.replace("=", "%3D").replace("+", "%2B").replace("/", "%2F"),
                 heads[0] + plain[:9] + " \n" + plain[9:], heads[0] + plain.replace("+", "-").replace("/", "_"),
                 "data:," + "".join("%%%02x" % b for b in corners), heads[0] + base64.b64encode(corners + b"more").decode()]
        pictures = ["data:image/png;base64," + base64.b64encode(picture).decode(), "data:image/png," + percents, "Data:," + percents,
                    "data:image/PNG;x=y;base64," + base64.b64encode(picture).decode().replace("+", "%2b"),
                    "data:image/jpeg;base64," + base64.urlsafe_b64encode(picture).decode(), "data:image/png;base64," +
                    base64.encodebytes(picture).decode()]
        for i, uri in enumerate(uris):
            scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                     "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
                     "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}],
                     "images": [{"uri": pictures[i % len(pictures)]}],
                     "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                     "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": uri}]}
            info, blob = self.load(save(self.folder, "uri.gltf", json.dumps(scene).encode()))
            self.assertEqual((info["triangles"], blob.texels, info["warnings"]), (1, [(0xFF0000FF,)], []), uri)
            for k in range(3):
                got = [blob.vertices[k][c] + info["origin"][c] for c in range(3)]
                self.near(got, struct.unpack_from("<3f", corners, 12 * k), 4)

    def test_vertex_colours(self):
        for width in (3, 4):
            info, blob = self.load(make.vertex_colours(self.folder, width))
            self.assertEqual(blob.colors, [(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)])
            self.assertIn("vertex colours", info["facts"])

    def test_colours_as_integers(self):
        for kind, layout, full in ((5121, "<4B", 255), (5123, "<4H", 65535)):
            g = Gltf()
            g.place(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), g.material("m"))
            data = b"".join(struct.pack(layout, full, full // 5, 0, full) for _ in range(4))
            accessor = {"bufferView": g.view(data), "componentType": kind, "normalized": True, "count": 4, "type": "VEC4"}
            g.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = g.add("accessors", accessor)
            _, blob = self.load(g.save(self.folder, "integers.gltf"))
            for colour in blob.colors:
                self.near(colour, (1, .2, 0, 1))

    def test_white_vertices_take_no_room(self):
        g = Gltf()
        g.node(mesh=g.mesh(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), g.material("m"), colors=[(1, 1, 1)] * 4))
        _, blob = self.load(g.save(self.folder, "white.gltf"))
        self.assertEqual(blob.colors, [])

    def test_primitives_with_and_without(self):
        g = Gltf()
        m = g.material("m")
        for x, colours in ((0, None), (2, [(.5, .5, .5)] * 4), (4, None)):
            g.node(mesh=g.mesh(*quad((x, 0, 0), (x + 1, 0, 0), (x + 1, 1, 0), (x, 1, 0)), m, colors=colours))
        _, blob = self.load(g.save(self.folder, "some.gltf"))
        self.assertEqual(blob.colors, [(1, 1, 1, 1)] * 4 + [(.5, .5, .5, 1)] * 4 + [(1, 1, 1, 1)] * 4)

    def test_tangents(self):
        for mirrored, want in ((False, (1, 0, 0, 1)), (True, (-1, 0, 0, -1))):
            _, blob = self.load(make.normal_mapped_quad(self.folder, mirrored=mirrored))
            self.assertEqual(len(blob.tangents), 4)
            for tangent in blob.tangents:
                self.near(tangent, want)

    def test_tangents_follow_their_node(self):
        # The file's own, and made ones, under a mirror: both must come out the same.
        for given in (None, [(2, 0, 0, 1)] * 4):
            for scale, want in (([1, 3, 1], (1, 0, 0, 1)), ([-1, 1, 1], (-1, 0, 0, -1)), ([1, -1, 1], (1, 0, 0, -1)),
                                ([1, 1, -1], (1, 0, 0, -1)), ([-1, -1, 1], (-1, 0, 0, 1))):
                path = make.normal_mapped_quad(self.folder, tangents=given)
                with open(path) as file:
                    root = json.load(file)
                root["nodes"][0]["scale"] = scale
                _, blob = self.load(save(self.folder, "turned.gltf", json.dumps(root).encode()))
                for tangent in blob.tangents:
                    self.near(tangent, want)

    def test_wrong_arguments(self):
        for arguments in ([], ["--describe"], ["--file", "x"] + ["--up", "x"], ["--describe", "--dir", ".", "--file", "x", "--unit", "0"],
                          ["--describe", "--dir", "/nonexistent", "--file", "x"], ["--describe", "--dir", ".", "--file", "x", "y"]):
            done = subprocess.run([LOADER] + arguments, capture_output=True, timeout=60)
            self.assertEqual(done.returncode, 2, arguments)


if __name__ == "__main__":
    unittest.main()
