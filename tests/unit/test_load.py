"""What the loader makes of sound scenes: counts, bounds, cameras, lights, units and orientation, as `--describe` shows them and
as they lie in the blob."""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.environ["CANDIL_SOURCE"], "tests", "scenes"))
import make  # noqa: E402
from writers import Gltf, Obj, look_at, png, quad, save  # noqa: E402

LOADER = os.path.join(os.environ["CANDIL_BUILD"], "libexec", "candil", "candil-loader")
SECTIONS = ["nodes", "leaf_triangles", "triangles", "vertices", "materials", "textures", "texels", "emitters", "lights",
            "cameras", "names", "uv1", "colors", "tangents"]
FORMATS = {"triangles": "<4I", "vertices": "<8f", "materials": "<3fI3fI3fI3fIIffIfffIf3f3f3If", "textures": "<4I3f3f", "texels": "<I",
           "emitters": "<IfIf", "lights": "<3fI3ff3fffIff", "uv1": "<2f", "colors": "<4f", "tangents": "<4f"}
# Where a material's fields lie in its tuple.
(ALBEDO, EMISSION, SPECULAR, WEIGHT, METALLIC, ROUGHNESS, SURFACE, NORMAL, SCALE, CUTOFF, FLAGS, POWER, ALPHA, TRANSMISSION,
 CLEAR_TEXTURE, IOR, ABSORPTION, MATTE, COAT, COAT_ROUGHNESS, COAT_TEXTURE, COAT_ROUGHNESS_TEXTURE, COAT_NORMAL,
 COAT_SCALE) = (0, 4, 8, *range(12, 26), *range(28, 35))
NONE = 0xFFFFFFFF


class Blob:
    """The sections of a blob that the tests read, as lists of tuples (server/scene/blob.h)."""

    def __init__(self, data):
        self.data = data
        ranges = struct.unpack_from("<%dQ" % (2 * len(SECTIONS)), data, 24)
        for i, name in enumerate(SECTIONS):
            if name in FORMATS:
                size = struct.calcsize(FORMATS[name])
                setattr(self, name, [struct.unpack_from(FORMATS[name], data, ranges[2 * i] + k * size)
                                     for k in range(ranges[2 * i + 1])])

    def corner(self, triangle, k):
        return self.vertices[self.triangles[triangle][k]]

    def normal(self, triangle):
        a, b, c = (self.corner(triangle, k)[:3] for k in range(3))
        u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
        return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


class Load(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def load(self, path, *more):
        blob = os.path.join(self.folder, "blob")
        command = [LOADER, "--describe", "--dir", os.path.dirname(path), "--file", os.path.basename(path), "--blob", blob]
        done = subprocess.run(command + list(more), capture_output=True, timeout=120, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(blob, "rb") as file:
            return json.loads(done.stdout), Blob(file.read())

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

    def near(self, got, want, places=6):
        self.assertEqual(len(got), len(want))
        for g, w in zip(got, want):
            self.assertAlmostEqual(g, w, places, (got, want))

    def test_every_scene_loads_without_a_warning(self):
        for name, write in make.SCENES.items():
            info, _ = self.load(write(self.folder))
            if name != "offset_in_vertices":
                self.assertEqual(info["warnings"], [], name)
            self.assertEqual(info["ignored"], [], name)
            self.assertEqual(info["dropped_degenerate"] + info["dropped_non_finite"] + info["dropped_out_of_range"], 0, name)

    def test_the_same_file_gives_the_same_blob(self):
        path = make.cornell(self.folder)
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
                self.near((light[11], light[7]), (math.cos(math.radians(15)), math.cos(math.radians(30))))
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

    def test_mtl(self):
        save(self.folder, "picture.png", png(1, 2, lambda x, y: (255, 0, 0) if y == 0 else (0, 0, 255)))
        o = Obj()
        o.material("lamp", (.25, .5, .75), (17, 12, 4))
        o.material("picture", (1, 1, 1), None, "map_Kd picture.png", "Ns 10", "illum 1")
        o.lines += ["vt 0 0", "vt 1 0", "vt 1 1"]
        o.mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1, 2)], "lamp")
        o.lines += ["usemtl picture", "f 1/1 2/2 3/3"]
        info, blob = self.load(o.save(self.folder, "mtl.obj"))
        materials = {blob.triangles[i][3] for i in range(2)}
        lamp, picture = sorted((blob.materials[m] for m in materials), key=lambda m: -m[4])
        self.near(lamp[:3], (.25, .5, .75))
        self.near(lamp[4:7], (17, 12, 4))
        self.assertEqual(lamp[FLAGS], 0)
        self.assertEqual(picture[3], 0)
        self.assertEqual(blob.texels, [(0xFF0000FF,), (0xFFFF0000,)])
        textured = next(i for i in range(2) if blob.triangles[i][3] == blob.materials.index(picture))
        self.near(blob.corner(textured, 0)[6:8], (0, 1))  # vt 0 0 is the lower left: our last row
        self.near(blob.corner(textured, 2)[6:8], (1, 0))
        self.assertEqual(info["ignored"], [])

    def material(self, edit=None, ignored=(), **keywords):
        """The one material of a quad with all that a primitive can have, after edit(gltf, its JSON), and that `ignored` is all
        that the loader left out of it."""
        g = Gltf()
        number = g.material("m", (.5, .5, .5), **keywords)
        if edit:
            edit(g, g.json["materials"][number])
        uvs = [(0, 1), (1, 1), (1, 0), (0, 0)]
        g.node(mesh=g.mesh(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), number, uvs=uvs, uvs1=[(v, u) for u, v in uvs],
                           normals=[(0, 0, 1)] * 4))
        info, blob = self.load(g.save(self.folder, "material.gltf"))
        self.assertEqual(info["ignored"], list(ignored))
        self.blob = blob
        return info, blob.materials[0]

    def test_a_surface_is_pure_lambert_where_the_file_says_so(self):
        info, m = self.material()
        self.near(m[SPECULAR:SPECULAR + 3], (0, 0, 0))
        self.assertEqual((m[WEIGHT], m[METALLIC], m[ROUGHNESS]), (0, 0, 1))
        self.assertNotIn("glossy surfaces", info["facts"])

    def test_metal_roughness_and_specular(self):
        info, m = self.material(metallic=.25, roughness=.5, specular=1)
        self.assertEqual((m[WEIGHT], m[METALLIC], m[ROUGHNESS]), (1, .25, .5))
        self.near(m[SPECULAR:SPECULAR + 3], (.04,) * 3)
        self.assertIn("glossy surfaces", info["facts"])
        _, m = self.material(specular=.5, ior=2)
        self.near(m[SPECULAR:SPECULAR + 3], (1 / 18,) * 3)
        self.assertEqual(m[WEIGHT], .5)

        def colours(g, m):
            m["extensions"]["KHR_materials_specular"]["specularColorFactor"] = [.5, 0, 100]
        _, m = self.material(colours, specular=.5)
        self.near(m[SPECULAR:SPECULAR + 3], (.01, 0, .5))  # clamped before the factor
        _, m = self.material(specular=1, ior=0)
        self.near(m[SPECULAR:SPECULAR + 3], (1, 1, 1))

    def test_the_default_material(self):
        g = Gltf()
        g.place(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)))
        _, blob = self.load(g.save(self.folder, "default.gltf"))
        m = blob.materials[0]
        self.near(m[:3] + m[EMISSION:EMISSION + 3] + m[SPECULAR:SPECULAR + 3], (1, 1, 1, 0, 0, 0, .04, .04, .04))
        self.assertEqual((m[WEIGHT], m[METALLIC], m[ROUGHNESS], m[FLAGS]), (1, 1, 1, 0))

    def test_maps_and_their_spaces(self):
        def edit(g, m):
            pictures = [g.image(png(1, 1, lambda x, y: (i, i, i))) for i in range(5)]
            m["pbrMetallicRoughness"]["baseColorTexture"] = {"index": pictures[0]}
            m["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {"index": pictures[1], "texCoord": 1}
            m["normalTexture"] = {"index": pictures[2], "scale": -.5}
            m["emissiveTexture"] = {"index": pictures[3]}
            m["emissiveFactor"] = [1, 1, 1]
            m["extensions"]["KHR_materials_specular"] = {"specularColorTexture": {"index": pictures[4], "texCoord": 1}}
        info, m = self.material(edit)
        picture = [self.blob.texels[self.blob.textures[m[i]][0]][0] & 255 for i in (3, SURFACE, NORMAL, 7, 11)]
        self.assertEqual(picture, [0, 1, 2, 3, 4])
        flags = [self.blob.textures[m[i]][3] for i in (3, SURFACE, NORMAL, 7, 11)]
        self.assertEqual(flags, [32, 64, 0, 32, 96])  # sRGB for colours, second coordinates where asked
        self.assertEqual(m[SCALE], -.5)
        self.near(self.blob.uv1[self.blob.triangles[0][0]], (1, 0))
        self.assertIn("normal maps", info["facts"])

    def test_what_is_hidden_is_not_read(self):
        def edit(g, m):
            m["emissiveTexture"] = {"index": g.image(png(1, 1, lambda x, y: (9, 9, 9)))}
        self.material(edit)
        self.assertEqual(len(self.blob.textures) + len(self.blob.uv1) + len(self.blob.tangents) + len(self.blob.colors), 0)

    def test_alpha_mask(self):
        info, m = self.material(cutoff=.25)
        self.assertEqual((m[FLAGS], m[CUTOFF]), (2, .25))
        self.assertIn("alpha masks", info["facts"])
        _, m = self.material(cutoff=.25, alpha=.5)
        self.assertEqual(m[CUTOFF], .5)
        _, m = self.material(cutoff=.25, alpha=0)
        self.assertGreater(m[CUTOFF], 1e38)
        _, m = self.material(cutoff=0, alpha=0)
        self.assertEqual(m[CUTOFF], 0)
        _, blob = self.load(make.alpha_mask(self.folder))
        self.assertEqual(blob.texels, [(0xFFFFFFFF,), (0x00FFFFFF,)])
        info, _ = self.material(alpha=.5)
        self.assertNotIn("alpha masks", info["facts"])

    def test_alpha_blend(self):
        def edit(g, m):
            m["alphaMode"] = "BLEND"
        info, m = self.material(edit, alpha=.25)
        self.assertEqual((m[FLAGS], m[ALPHA], info["ignored"]), (8, .25, []))
        self.assertIn("alpha blending", info["facts"])
        _, m = self.material(edit, alpha=.25, unlit=True)
        self.assertEqual((m[FLAGS], m[ALPHA]), (12, .25))

    def test_clear_coat(self):
        def coat(base=None, **content):
            def edit(g, m):
                for key in [k for k in content if k.endswith("Texture")]:
                    info = content[key] if isinstance(content[key], dict) else {}
                    content[key] = {**info, "index": g.image(png(1, 1, lambda x, y: (9, 9, len(g.json.get("images", ())))))}
                if base is not None:
                    m["normalTexture"] = {"index": g.image(png(1, 1, lambda x, y: (128, 128, 255))), **base}
                g.extend(m, "KHR_materials_clearcoat", content)
            return edit
        info, m = self.material(coat(clearcoatFactor=.5, clearcoatRoughnessFactor=.25))
        self.assertEqual(m[COAT:], (.5, .25, NONE, NONE, NONE, 1))
        self.assertEqual((info["ignored"], info["warnings"]), ([], []))
        self.assertIn("clear coats", info["facts"])
        maps = dict(clearcoatTexture=1, clearcoatRoughnessTexture=1, clearcoatNormalTexture={"scale": .5})
        info, m = self.material(coat(clearcoatFactor=1, clearcoatRoughnessFactor=1, **maps))
        self.assertEqual(m[COAT:], (1, 1, 0, 1, 2, .5))
        self.assertIn("normal maps", info["facts"])
        # Without the coat, or without its roughness, nobody would see them.
        self.assertEqual(self.material(coat(**maps))[1][COAT:], (0, 0, NONE, NONE, NONE, 1))
        self.assertEqual(self.material(coat(clearcoatFactor=1, **maps))[1][COAT_ROUGHNESS_TEXTURE], NONE)
        # Both normal maps share a vertex's tangents.
        info, m = self.material(coat({}, clearcoatFactor=1, clearcoatNormalTexture={}))
        self.assertEqual((m[NORMAL] == NONE, m[COAT_NORMAL] == NONE, info["ignored"]), (False, False, []))
        other = ["clearcoatNormalTexture with its own coordinates"]
        info, m = self.material(coat({"texCoord": 1}, clearcoatFactor=1, clearcoatNormalTexture={}), other)
        self.assertEqual((m[NORMAL] == NONE, m[COAT_NORMAL]), (False, NONE))
        info, m = self.material(coat(clearcoatFactor=7, clearcoatRoughnessFactor=-1))
        self.assertEqual((m[COAT], m[COAT_ROUGHNESS], len(info["warnings"])), (1, 0, 1))
        self.material(coat(clearcoatFactor=1), ["clearcoat over transmission"], clear=1)
        info, m = self.material(coat(clearcoatFactor=1), unlit=True)
        self.assertEqual((m[COAT], "clear coats" in info["facts"]), (0, False))

    def test_diffuse_roughness(self):
        for name in ("KHR_materials_diffuse_roughness", "EXT_materials_diffuse_roughness"):
            info, m = self.material(lambda g, m: g.extend(m, name, {"diffuseRoughnessFactor": .75}))
            self.assertEqual((m[MATTE], info["ignored"], info["warnings"]), (.75, [], []))
            self.assertIn("rough diffuse surfaces", info["facts"])
            self.assertEqual(self.material(lambda g, m: g.extend(m, name, {}))[1][MATTE], 0)
        info, m = self.material(lambda g, m: g.extend(m, name, {"diffuseRoughnessFactor": 2, "diffuseRoughnessTexture": {"index": 0}}),
                                ["diffuseRoughnessTexture"])
        self.assertEqual((m[MATTE], len(info["warnings"])), (1, 1))

    def test_priorities(self):
        solid = {"thicknessFactor": 1}
        for given, flags, warnings in ((3, 3, 0), (255, 255, 0), (2.0, 2, 0), (1.5, 1, 1), (-1, 0, 1), (1e300, 255, 1), ("1", 0, 0),
                                       ([1], 0, 0)):
            info, m = self.material(clear=1, volume=solid, priority=given)
            self.assertEqual((m[FLAGS], len(info["warnings"])), (flags << 8, warnings), given)
        told = ["candil_priority of what is no clear body"]
        self.assertEqual(self.material(ignored=told, clear=1, priority=1)[1][FLAGS], 16)
        self.assertEqual(self.material(ignored=told, priority=1)[1][FLAGS], 0)
        self.assertEqual(self.material(clear=1, volume=solid, priority=1, unlit=True)[1][FLAGS], 4)

        def edit(g, m):
            m["extras"] = [1, "candil_priority"]
        self.assertEqual(self.material(edit, clear=1, volume=solid)[1][FLAGS], 0)

    def test_a_thickness_map_is_told(self):
        def edit(g, m):
            g.extend(m, "KHR_materials_transmission", {"transmissionFactor": 1})
            g.extend(m, "KHR_materials_volume", {"thicknessFactor": 1, "thicknessTexture": {"index": 0}})
        self.material(edit, ["thicknessTexture"])

    def test_glass(self):
        def glass(volume=None, texture=False, **transmission):
            def edit(g, m):
                if texture:
                    transmission["transmissionTexture"] = {"index": g.image(png(1, 1, lambda x, y: (9, 9, 9)))}
                g.extend(m, "KHR_materials_transmission", transmission)
                if volume is not None:
                    g.extend(m, "KHR_materials_volume", volume)
            return edit
        info, m = self.material(glass(transmissionFactor=.5))
        self.assertEqual((m[TRANSMISSION], m[FLAGS], m[IOR], m[CLEAR_TEXTURE]), (.5, 16, 1.5, NONE))
        self.assertEqual((info["ignored"], info["warnings"]), ([], []))
        self.assertIn("glass", info["facts"])
        info, m = self.material(glass(transmissionFactor=1, texture=True), ior=1.25)
        self.assertEqual((m[TRANSMISSION], m[IOR], m[CLEAR_TEXTURE]), (1, 1.25, 0))
        solid = {"thicknessFactor": .1, "attenuationDistance": 2, "attenuationColor": [1, .5, .25]}
        info, m = self.material(glass(solid, transmissionFactor=1))
        self.assertEqual(m[FLAGS], 0)
        self.near(m[ABSORPTION:ABSORPTION + 3], (0, math.log(2) / 2, math.log(4) / 2))
        # Without thickness, distance or transmission there is no inside, no absorption, no glass.
        self.assertEqual(self.material(glass({"attenuationDistance": 2, "attenuationColor": [0, 0, 0]}, transmissionFactor=1))[1][FLAGS], 16)
        self.assertEqual(self.material(glass({"thicknessFactor": 1, "attenuationColor": [0, 0, 0]}, transmissionFactor=1))[1][ABSORPTION], 0)
        self.assertNotIn("glass", self.material(glass({"thicknessFactor": 1}))[0]["facts"])
        self.assertNotIn("glass", self.material(glass(transmissionFactor=1), ior=0)[0]["facts"])

    def test_glass_out_of_range(self):
        def edit(g, m):
            g.extend(m, "KHR_materials_transmission", {"transmissionFactor": 3})
            g.extend(m, "KHR_materials_volume", {"thicknessFactor": 1, "attenuationDistance": 0, "attenuationColor": [0, 2, -1]})
        info, m = self.material(edit, ior=1e9)
        self.assertEqual((m[TRANSMISSION], m[IOR]), (1, 10))
        self.near([a / 1e9 for a in m[ABSORPTION:ABSORPTION + 3]], (1, 0, 1))
        self.assertEqual(len(info["warnings"]), 1)

    def test_unlit(self):
        def edit(g, m):
            m.update(emissiveFactor=[1, 1, 1], doubleSided=True)
            m["normalTexture"] = {"index": g.image(png(1, 1, lambda x, y: (128, 128, 255)))}
        info, m = self.material(edit, unlit=True, metallic=1, specular=1, cutoff=.5)
        self.assertEqual(m[FLAGS], 6)
        self.near(m[:3], (.5, .5, .5))
        self.assertEqual(m[EMISSION:EMISSION + 3] + m[SPECULAR:SPECULAR + 3] + (m[WEIGHT], m[METALLIC], m[POWER]), (0,) * 9)
        self.assertEqual((info["emissive_triangles"], info["facts"]), (0, ["alpha masks", "unlit surfaces"]))

    def test_texture_transform(self):
        def rows(**transform):
            _, blob = self.load(make.second_uvs(self.folder, **transform))
            self.assertEqual(blob.textures[0][3], 16 | 32 | 64)
            return blob.textures[0][4:7], blob.textures[0][7:10]
        for override in (True, False):
            u, v = rows(offset=(.25, .5), rotation=0, scale=(2, -3), override=override)
            self.assertEqual((u, v), ((2, 0, .25), (0, -3, .5)))
        u, v = rows()  # the extension's own example: the lower left quarter
        for corner in ((0, 0), (1, 0), (0, 1), (1, 1)):
            at = [row[0] * corner[0] + row[1] * corner[1] + row[2] for row in (u, v)]
            self.assertTrue(-1e-6 <= at[0] <= .5 + 1e-6 and .5 - 1e-6 <= at[1] <= 1 + 1e-6, at)
        u, v = rows(offset=(0, 0), rotation=math.radians(30), scale=(2, 3))
        self.near(u, (2 * math.cos(math.radians(30)), 3 * math.sin(math.radians(30)), 0))
        self.near(v, (-2 * math.sin(math.radians(30)), 3 * math.cos(math.radians(30)), 0))

    def test_third_coordinates_are_ignored(self):
        g = Gltf()
        texture = {"index": g.image(png(1, 1, lambda x, y: (9, 9, 9))), "texCoord": 2}
        g.place(*quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), g.material("m", texture=texture))
        info, blob = self.load(g.save(self.folder, "third.gltf"))
        self.assertEqual(info["ignored"], ["TEXCOORD_2"])
        self.assertEqual(blob.textures[0][3] & 64, 0)

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

    def test_mtl_surfaces(self):
        save(self.folder, "flat.png", png(2, 2, lambda x, y: (128, 128, 255)))
        save(self.folder, "heights.png", png(4, 4, lambda x, y: (60 * x,) * 3))
        o = Obj()
        o.material("dull", (.5,) * 3, None, "Ks 0.5 0.5 0.5", "Ns 30", "illum 1")
        o.material("shiny", (.5,) * 3, None, "Ks 0.5 0.25 0", "Ns 30", "illum 2", "map_Ks flat.png", "map_Bump -bm 0.25 flat.png")
        o.material("bumpy", (.5,) * 3, None, "bump heights.png")
        o.material("normal", (.5,) * 3, None, "norm flat.png")
        o.lines += ["vt 0 0", "vt 1 0", "vt 1 1"]
        names = ("dull", "shiny", "bumpy", "normal")
        for i, name in enumerate(names):
            o.lines += ["v %d 0 0" % (2 * i), "v %d 0 0" % (2 * i + 1), "v %d 1 0" % (2 * i + 1), "usemtl " + name,
                        "f %d/1 %d/2 %d/3" % (3 * i + 1, 3 * i + 2, 3 * i + 3)]
        info, blob = self.load(o.save(self.folder, "surfaces.obj"))
        self.assertEqual((info["ignored"], info["warnings"]), ([], []))
        place = {round(blob.corner(t, 0)[0]) // 2: t for t in range(4)}
        dull, shiny, bumpy, normal = (blob.materials[blob.triangles[place[i]][3]] for i in range(4))
        self.assertEqual(dull[SPECULAR:WEIGHT + 3], (0, 0, 0, NONE, 0, 0, 1))
        self.near(shiny[SPECULAR:SPECULAR + 3] + shiny[WEIGHT:WEIGHT + 3], (.5, .25, 0, .5, 0, .5))
        self.assertEqual(blob.textures[shiny[11]][3], 32)
        self.assertEqual((blob.textures[shiny[NORMAL]][3], shiny[SCALE]), (0, .25))
        self.assertEqual(blob.texels[blob.textures[shiny[NORMAL]][0]], (0xFFFF8080,))
        self.assertEqual(normal[NORMAL], shiny[NORMAL])
        made = blob.texels[blob.textures[bumpy[NORMAL]][0] + 1][0]  # rises to the right by 60 of 255 a texel
        slope = 60 / 255
        self.assertEqual(made & 255, round(255 * (.5 - .5 * slope / math.hypot(slope, 1))))
        self.assertEqual((made >> 8 & 255, bumpy[SCALE]), (128, 1))
        self.near(blob.tangents[blob.triangles[place[1]][0]], (1, 0, 0, 1))

    def test_wrong_arguments(self):
        for arguments in ([], ["--describe"], ["--file", "x"] + ["--up", "x"], ["--describe", "--dir", ".", "--file", "x", "--unit", "0"],
                          ["--describe", "--dir", "/nonexistent", "--file", "x"], ["--describe", "--dir", ".", "--file", "x", "y"]):
            done = subprocess.run([LOADER] + arguments, capture_output=True, timeout=60)
            self.assertEqual(done.returncode, 2, arguments)


if __name__ == "__main__":
    unittest.main()
