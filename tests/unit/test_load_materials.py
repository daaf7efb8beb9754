"""What the loader makes of materials: glTF's and its extensions', MTL's, and what it says that it left out."""
import math
import unittest

import make
from loaded import (ABSORPTION, ALPHA, CLEAR_TEXTURE, COAT, COAT_NORMAL, COAT_ROUGHNESS, COAT_ROUGHNESS_TEXTURE, CUTOFF, EMISSION, FLAGS,
                    IOR, MATTE, METALLIC, NONE, NORMAL, POWER, ROUGHNESS, SCALE, SPECULAR, SURFACE, TRANSMISSION, WEIGHT,
                    WEIGHT_TEXTURE, LoadCase)
from writers import Gltf, Obj, png, quad, save


class Materials(LoadCase):
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
            pictures = [g.image(png(1, 1, lambda x, y: (i, i, i))) for i in range(6)]
            m["pbrMetallicRoughness"]["baseColorTexture"] = {"index": pictures[0]}
            m["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {"index": pictures[1], "texCoord": 1}
            m["normalTexture"] = {"index": pictures[2], "scale": -.5}
            m["emissiveTexture"] = {"index": pictures[3]}
            m["emissiveFactor"] = [1, 1, 1]
            m["extensions"]["KHR_materials_specular"] = {"specularColorTexture": {"index": pictures[4], "texCoord": 1},
                                                         "specularTexture": {"index": pictures[5]}}
        info, m = self.material(edit)
        picture = [self.blob.texels[self.blob.textures[m[i]][0]][0] & 255 for i in (3, SURFACE, NORMAL, 7, 11, WEIGHT_TEXTURE)]
        self.assertEqual(picture, [0, 1, 2, 3, 4, 5])
        flags = [self.blob.textures[m[i]][3] for i in (3, SURFACE, NORMAL, 7, 11, WEIGHT_TEXTURE)]
        self.assertEqual(flags, [32, 64, 0, 32, 96, 0])  # sRGB for colours, second coordinates where asked
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
        self.assertNotIn("alpha masks", info["facts"])
        _, m = self.material(cutoff=.25, alpha=.5)
        self.assertEqual(m[CUTOFF], .5)
        info, m = self.material(cutoff=.25, alpha=0)
        self.assertGreater(m[CUTOFF], 1e38)
        self.assertIn("alpha masks", info["facts"])
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
        self.assertEqual((info["emissive_triangles"], info["facts"]), (0, ["unlit surfaces"]))

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
        self.assertEqual(dull[SPECULAR:WEIGHT + 4], (0, 0, 0, NONE, 0, NONE, 0, 1))
        self.near(shiny[SPECULAR:SPECULAR + 3] + (shiny[WEIGHT], shiny[METALLIC], shiny[ROUGHNESS]), (.5, .25, 0, .5, 0, .5))
        self.assertEqual(blob.textures[shiny[11]][3], 32)
        self.assertEqual((blob.textures[shiny[NORMAL]][3], shiny[SCALE]), (0, .25))
        self.assertEqual(blob.texels[blob.textures[shiny[NORMAL]][0]], (0xFFFF8080,))
        self.assertEqual(normal[NORMAL], shiny[NORMAL])
        made = blob.texels[blob.textures[bumpy[NORMAL]][0] + 1][0]  # rises to the right by 60 of 255 a texel
        slope = 60 / 255
        self.assertEqual(made & 255, round(255 * (.5 - .5 * slope / math.hypot(slope, 1))))
        self.assertEqual((made >> 8 & 255, bumpy[SCALE]), (128, 1))
        self.near(blob.tangents[blob.triangles[place[1]][0]], (1, 0, 0, 1))

    def test_a_file_called_as_the_normals_of_another(self):
        """What is made of a bump map is no file, whatever a file is called."""
        save(self.folder, "heights.png", png(4, 4, lambda x, y: (60 * x,) * 3))
        o = Obj()
        o.material("missing", (.5,) * 3, None, "map_Kd normals of heights.png")
        o.material("bumpy", (.5,) * 3, None, "map_Bump heights.png")
        o.lines += ["vt 0 0", "vt 1 0", "vt 1 1"]
        for i, name in enumerate(("missing", "bumpy")):
            o.lines += ["v %d 0 0" % (2 * i), "v %d 0 0" % (2 * i + 1), "v %d 1 0" % (2 * i + 1), "usemtl " + name,
                        "f %d/1 %d/2 %d/3" % (3 * i + 1, 3 * i + 2, 3 * i + 3)]
        info, blob = self.load(o.save(self.folder, "named.obj"))
        self.assertEqual(info["missing_textures"], 1)
        normals = [blob.textures[blob.materials[t[3]][NORMAL]] for t in blob.triangles
                   if blob.materials[t[3]][NORMAL] != NONE]
        self.assertEqual([texture[1:3] for texture in normals], [(4, 4)])


if __name__ == "__main__":
    unittest.main()
