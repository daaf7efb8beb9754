"""OBJ and MTL as their specifications have them and as exporters write them: every statement, option, default and way to write it
is read, or told."""
import math
import os
import random
import unittest

from loaded import (ALPHA, EMISSION, FLAGS, METALLIC, NONE, NORMAL, ROUGHNESS, SCALE, SURFACE, TRANSMISSION,
                    LoadCase)
from writers import png, save

SQUARE = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0"]
CORNERS = ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
LAMP = "newmtl lamp\nKd 0 0 0\nKe 2 3 4\n"


class ObjCase(LoadCase):
    def obj(self, text, **libraries):
        """Load a text, or lines, as a.obj, beside libraries, such as a="newmtl …" for a.mtl."""
        for name, content in libraries.items():
            save(self.folder, name + ".mtl", content if isinstance(content, bytes) else content.encode())
        text = text if isinstance(text, (str, bytes)) else "\n".join(text) + "\n"
        return self.load(save(self.folder, "a.obj", text if isinstance(text, bytes) else text.encode()))

    def refusal(self, text):
        loaded, said = self.try_load(save(self.folder, "a.obj", text.encode()))
        self.assertFalse(loaded)
        return said

    def material(self, statements, extra=(), ignored=(), warnings=0):
        """The material "m" of a square, of these statements of MTL."""
        text = "newmtl m\n" + (statements if isinstance(statements, str) else "\n".join(statements)) + "\n"
        info, blob = self.obj(["mtllib a.mtl"] + SQUARE + CORNERS + ["usemtl m", "f 1/1 2/2 3/3 4/4"] + list(extra), a=text)
        self.assertEqual((info["ignored"], len(info["warnings"])), (list(ignored), warnings), (statements, info["warnings"]))
        self.info, self.blob = info, blob
        return blob.materials[0]

    def picture(self, name="a.png", colour=(255, 0, 0)):
        save(self.folder, name, png(1, 1, lambda x, y: colour))

    def lamp_square(self, text, **libraries):
        """Check that a text is a square of the material lamp, and nothing is told."""
        libraries = libraries or {"a": LAMP}
        info, blob = self.obj(text, **libraries)
        self.assertEqual((info["triangles"], info["emissive_triangles"], info["warnings"], info["ignored"]), (2, 2, [], []), text)
        self.near(blob.materials[blob.triangles[0][3]][EMISSION:EMISSION + 3], (2, 3, 4))

    def areas(self, faces, extra=()):
        """The area of each face, one group each, from lists of positions."""
        lines, count = list(extra), 0
        for i, corners in enumerate(faces):
            lines += ["v %.17g %.17g %.17g" % tuple(c) for c in corners]
            lines += ["g face%d" % i, "usemtl m%d" % i, "f " + " ".join(str(count + k + 1) for k in range(len(corners)))]
            count += len(corners)
        _, blob = self.obj(lines)
        found = [0.] * len(faces)
        for t in range(len(blob.triangles)):
            found[blob.triangles[t][3]] += .5 * math.sqrt(sum(x * x for x in blob.normal(t)))
        return found


class Statements(ObjCase):
    def test_comments(self):
        text = "\n".join(["mtllib a.mtl # the library"] + SQUARE + ["v 5 5 5 # not used", "usemtl lamp # bright", "f 1 2 3 4%s"]) + "\n"
        for comment in (" # quad", "\t# quad", " #", "#quad", "# 5", " # 5 \\", " ## f 1 2 3"):
            self.lamp_square(text % comment)
        self.lamp_square(text.replace("1 1 0\n", "1. 1 0.# third\n") % "")
        self.lamp_square("# head\n#\n  # indented\n" + text % "", a="#\nnewmtl lamp # a lamp\nKd 0 0 0 # black\nKe 2 3 4#bright\n")

    def test_a_comment_is_not_continued(self):
        self.lamp_square("\n".join(["# \\", "mtllib a.mtl", "#\\"] + SQUARE + ["# a \\", "usemtl lamp", "f 1 2 3 4 # \\"]))

    def test_a_hash_before_a_digit_is_part_of_a_name(self):
        info, blob = self.obj(["mtllib a.mtl"] + SQUARE + ["usemtl Material #2", "f 1 2 3", "usemtl Material #1 # again", "f 1 3 4"],
                              a="newmtl Material #1\nKd 0 0 0\nnewmtl Material #2\nKd 1 1 1\n")
        self.assertEqual(([t[3] for t in blob.triangles], info["warnings"]), ([1, 0], []))

    def test_blanks_and_tabs(self):
        lines = ["mtllib a.mtl"] + SQUARE + ["usemtl lamp", "f 1 2 3 4"]
        for before, between, after in ((" ", " ", ""), ("\t", "\t", "\t"), ("", "  ", "   "), (" \t ", " \t", " \t "), ("\v", "\f", ""),
                                       ("", " ", "\r")):
            self.lamp_square("\n".join(before + line.replace(" ", between) + after for line in lines),
                             a="\n".join(before + line.replace(" ", between) + after for line in LAMP.splitlines()))

    def test_ends_of_lines(self):
        lines = ["mtllib a.mtl"] + SQUARE + ["", "usemtl lamp", "f 1 2 3 4"]
        for end in ("\n", "\r\n", "\r", "\n\n", "\r\n\r\n"):
            self.lamp_square(end.join(lines), a=LAMP.replace("\n", end))
            self.lamp_square(end.join(lines + [""]), a=LAMP.replace("\n", end).rstrip())

    def test_byte_order_marks(self):
        mark = b"\xef\xbb\xbf"
        text = "\n".join(["mtllib a.mtl"] + SQUARE + ["usemtl lamp", "f 1 2 3 4"]).encode()
        for head, library in ((mark, b""), (b"", mark), (mark, mark), (mark + b" ", mark + b"\t"), (mark + b"# x\n", mark + b"#\r\n"),
                              (mark + b"\r\n", mark + b"\n")):
            self.lamp_square(head + text, a=library + LAMP.encode())
        info, _ = self.obj(text, a=LAMP.encode("utf-16"))
        self.assertIn("UTF-16", "".join(info["warnings"]))

    def test_continued_lines(self):
        for joint in ("\\\n", " \\\n", " \\\r\n ", "\\ \n\t", " \\\n\\\n "):
            self.lamp_square("mtllib%sa.mtl\n" % (joint + " ") + "\n".join(SQUARE) + "\nusemtl lamp\nf 1 2%s 3%s 4" % (joint, joint),
                             a="newmtl lamp\nKd 0 0%s 0\nKe 2%s 3 4\\" % (joint, joint))

    def test_case(self):
        self.lamp_square("\n".join(["MTLLIB a.mtl"] + [line.upper() for line in SQUARE] + ["UseMtl lamp", "F 1 2 3 4"]),
                         a="NEWMTL lamp\nKD 0 0 0\nkE 2 3 4\n")

    def test_corners_of_every_form(self):
        head = "\n".join(SQUARE + CORNERS + ["vn 0 0 1"]) + "\n"
        for face in ("1 2 3", "1/1 2/2 3/3", "1//1 2//1 3//1", "1/1/1 2/2/1 3/3/1", "1/ 2/ 3/", "1// 2// 3//", "1/1/ 2/2/ 3/3/",
                     "-4 -3 -2", "-4/-4 -3/-3 -2/-2", "-4//-1 -3//-1 -2//-1", "1 2/2 3//1", "+1 02 3"):
            for keyword in ("f", "fo"):
                info, blob = self.obj(head + keyword + " " + face + "\n")
                self.assertEqual((info["triangles"], info["ignored"], len(info["warnings"])), (1, [], 1), face)
                self.near(blob.corner(0, 2)[:3], (1, 1, 0))
        for face in ("9/9 2/2 3/3", "0 1 2", "-5 1 2", "1 2 x", "1 2 3/x", "1 2 3/1/1/1", "1.5 2 3", "1 2 99999999999999999999"):
            self.assertIn("line 10 of the OBJ file", self.refusal(head + "f " + face + "\n"))

    def test_a_face_may_stand_before_its_vertices(self):
        info, _ = self.obj(["f 1 2 3"] + SQUARE + ["f -4 -2 -1"])
        self.assertEqual(info["triangles"], 2)

    def test_coordinates_that_are_not_there(self):
        for face, told in (("1/1/1 2/2/2 3/3/3", 0), ("1/7 2/2 3/3", 1), ("1//9 2//9 3//9", 0)):
            lists = CORNERS if told else []
            info, _ = self.obj(SQUARE + lists + ["f " + face])
            self.assertEqual(info["triangles"], 1)
            self.assertIn("not there", "".join(info["warnings"]))

    def test_numbers(self):
        info, _ = self.obj(["v .5 -.5 +.5", "v 1e0 1.E+0 1.", "v 00 -0 0e9", "v 1.#QNAN 0 0", "v 1.#INF 0 0", "v 1", "v x y z",
                            "vt", "f 1 2 3", "f 1 2 4", "f 1 2 5", "f 1 2 6", "f 1 2 7"])
        self.assertEqual((info["triangles"], info["dropped_non_finite"]), (1, 4))
        self.assertEqual([w[:7] for w in info["warnings"] if w.startswith("line")], ["line 6:", "line 7:", "line 8:"])

    def test_what_is_left_out_is_told(self):
        square = SQUARE + ["f 1 2 3 4"]
        for line, told in (("p 1 2", "points"), ("l 1 2 3", "lines"), ("f 1 2", "lines"), ("f 1", "points"), ("vp 0 1", "curves"),
                           ("cstype rat bspline", "curves"), ("curv2 1 2", "curves"), ("surf 0 1 0 1 1 2 3", "curves"),
                           ("call b.obj", "call"), ("lod 3", "lod"), ("bevel on", "bevel"), ("usemap x", "usemap"),
                           ("shadow_obj b.obj", "shadow_obj"), ("v 1 1 1 .5", "weights"), ("mg 1 .5", "curves")):
            info, _ = self.obj(square + [line])
            self.assertEqual(len(info["ignored"]), 1, line)
            self.assertIn(told, info["ignored"][0])
        info, _ = self.obj(SQUARE + ["s 1", "f 1 2 3 4"])
        self.assertEqual(info["ignored"], ["smoothing groups"])
        info, _ = self.obj(square + ["#MRGB ff00ff00ffffffffff00ff00ffffffff", "# MRGB", "#MRGBA 1"])
        self.assertEqual(info["ignored"], ["vertex colours in comments (#MRGB)"])
        for off in ("s off", "s 0", "s"):
            self.assertEqual(self.obj(SQUARE + [off, "f 1 2 3 4"])[0]["ignored"], [])
        info, _ = self.obj(square + ["", "wibble 1 2 3", "  @!"])
        self.assertEqual([w for w in info["warnings"] if "line 7" in w or "line 8" in w], info["warnings"][:2])
        self.assertEqual(info["triangles"], 2)

    def test_groups_of_one_name_are_one_node(self):
        info, blob = self.obj(SQUARE + ["f 1 2 3", "g a", "f 1 2 4", "o b", "f 2 3 4", "g  a ", "f 1 3 4", "o", "f 1 2 3"])
        self.assertEqual((info["nodes"], info["triangles"]), (["defaultobject", "a", "b", "node 3"], 5))
        self.near(blob.corner(2, 1)[:3], (1, 1, 0))


class Libraries(ObjCase):
    def test_several_on_a_line(self):
        tail = SQUARE + ["usemtl lamp", "f 1 2 3 4"]
        other = "newmtl other\nKd 1 0 0\n"
        for line in ("b.mtl a.mtl", "a.mtl b.mtl", "b.mtl\ta.mtl # both", "b.mtl \\\na.mtl", '"b.mtl" "a.mtl"', "b.mtl\nmtllib a.mtl",
                     "./b.mtl .\\a.mtl", "b.MTL a.mtl"):
            save(self.folder, "b.MTL", other.encode())
            self.lamp_square("\n".join(["mtllib " + line] + tail), a=LAMP, b=other)
        os.rename(os.path.join(self.folder, "a.mtl"), os.path.join(self.folder, "my own lamps.mtl"))
        self.lamp_square("\n".join(["mtllib b.mtl my own lamps.mtl"] + tail), b=other)
        self.lamp_square("\n".join(["mtllib my own lamps.mtl"] + tail), b=other)

    def test_the_first_definition_counts(self):
        info, blob = self.obj(["mtllib a.mtl b.mtl"] + SQUARE + ["usemtl lamp", "f 1 2 3 4"], a=LAMP,
                              b="newmtl lamp\nKe 9 9 9\nmap_Kd none.png\n")
        self.near(blob.materials[0][EMISSION:EMISSION + 3], (2, 3, 4))
        self.assertIn("b.mtl, line 1: material 'lamp' is defined again", info["warnings"][0])

    def test_missing(self):
        lines = ["mtllib b.mtl c.mtl"] + SQUARE + ["usemtl lamp", "f 1 2 3 4"]
        info, _ = self.obj(lines, d="")
        self.assertEqual(sum("left out" in w for w in info["warnings"]), 2)
        info, _ = self.obj(lines, a=LAMP)  # called as the OBJ file
        self.assertIn("'b.mtl' is taken from 'a.mtl'", "".join(info["warnings"]))
        self.assertEqual(info["emissive_triangles"], 2)
        info, _ = self.obj(["mtllib C:\\work\\b.mtl"] + lines[1:], b=LAMP)
        self.assertIn("is taken from 'b.mtl'", "".join(info["warnings"]))
        self.assertEqual(info["emissive_triangles"], 2)

    def test_a_library_in_a_folder_has_its_maps_there(self):
        for name in ("sub/b.mtl", "sub\\b.mtl", "./sub/b.mtl"):
            save(self.folder, "sub/b.mtl", b"newmtl lamp\nmap_Kd maps\\red.png\n")
            self.picture("sub/maps/red.png")
            info, blob = self.obj(["mtllib " + name] + SQUARE + ["usemtl lamp", "f 1 2 3 4"])
            self.assertEqual((info["warnings"], blob.texels), ([], [(0xFF0000FF,)]))


class Mtl(ObjCase):
    def test_colours(self):
        for statement, colour in (("Kd .5", (.5,) * 3), ("Kd 0.25 # grey", (.25,) * 3), ("Kd .25 .5 1", (.25, .5, 1)), ("Kd 1 0 0", (1, 0, 0)),
                                  ("Kd\t.5\t.5\t0", (.5, .5, 0)), ("Kd xyz .475232 .5 .544452", (.5,) * 3)):
            self.near(self.material(statement)[:3], colour, 3)
        for statement in ("Kd", "Kd red", "Kd .1 .2", "Kd spectral file.rfl 1", "Ke", "Ns x", "d", "illum", "illum 11", "map_Kd", "wibble 3"):
            self.material("Kd .5\n" + statement, warnings=1)
            self.assertIn("a.mtl, line 3: '%s'" % statement.split()[0], self.info["warnings"][0])
        self.assertEqual(self.material("Ka 1 1 1\nKd .5")[:3], (.5,) * 3)
        info, _ = self.obj(["mtllib a.mtl"] + SQUARE + ["f 1 2 3 4"], a="#\nKd 1 0 0\nnewmtl m\n")
        self.assertIn("a.mtl, line 2: 'Kd' stands before any newmtl", info["warnings"][0])

    def test_glass_of_nothing_is_what_maya_writes_of_what_is_opaque(self):
        for statements, clear, alpha in (("Ni 1.00\nTf 1.00 1.00 1.00", 0, 1), ("Ni 1", 0, 1), ("Ni 1\nd .25", 0, .25), ("Ni 1.01\nTf 1", 1, 1),
                                         ("Ni 1\nTf .9 1 1", 1, 1), ("Tf 1 1 1", 1, 1)):
            m = self.material("illum 4\nKd .50 .50 .50\nKa 0.00 0.00 0.00\n" + statements)
            self.assertEqual((m[TRANSMISSION], m[ALPHA]), (clear, alpha), statements)

    def test_defaults(self):
        self.near(self.material("illum 1")[:3], (.8,) * 3)
        self.picture()
        self.assertEqual(self.material("map_Kd a.png")[:3], (1, 1, 1))
        # A map of opacities is none of colours.
        for statements, albedo in (("map_d a.png", .8), ("map_d -imfchan r a.png", .8), ("map_d a.png\nmap_Kd a.png", 1),
                                   ("map_d a.png\nKd .25", .25), ("map_Kd gone.png\nmap_d a.png", .8), ("map_Bump a.png", .8)):
            self.near(self.material(statements, warnings="gone" in statements)[:3], (albedo,) * 3)
        self.assertEqual(self.material("map_Ke a.png")[EMISSION:EMISSION + 3], (1, 1, 1))
        self.assertEqual(self.material("map_Ke a.png\nKe 0 0 0")[EMISSION:EMISSION + 3], (0, 0, 0))

    def test_what_is_left_out_is_told(self):
        for statement in ("map_Ka a.png", "map_Ns a.png", "map_Tr a.png", "disp a.png", "decal a.png", "refl -type sphere a.png",
                          "map_aat on", "aniso .5", "map_ORM a.png", "map_refl a.png", "sharpness 60", "d -halo .5"):
            self.material(statement, ignored=["d -halo" if "halo" in statement else statement.split()[0]])

    def test_names_of_maps(self):
        self.picture("tex.png")
        self.picture("my tex #1.png")
        self.picture("in/here/tex 2.png")
        for name in ("tex.png ", "tex.png\t", "tex.png \t ", "tex.png\r", "tex.png \r", "tex.png # red", "  tex.png", '"tex.png"',
                     "'tex.png'", "./tex.png", ".\\tex.png", "tex.png\\", "my tex #1.png", '"my tex #1.png" ', "in/here/tex 2.png",
                     "in\\here\\tex 2.png", "in\\\\here\\\\tex 2.png", "-clamp on tex.png ", "tex.png -clamp on"):
            self.material("map_Kd " + name)
            self.assertEqual(self.info["textures"], 1, name)
        for keyword in ("MAP_KD", "map_kd", "map_Ks", "map_ke"):
            self.material(keyword + " tex.png\nillum 2")
            self.assertEqual(self.info["textures"], 1, keyword)
        for name in ("C:\\maps\\tex.png", "/home/me/tex.png", "..\\tex.png", "gone/tex.png"):
            self.material("map_Kd " + name, warnings=1)
            self.assertEqual((self.info["textures"], self.info["missing_textures"]), (1, 0))
            self.assertIn("is taken from 'tex.png'", self.info["warnings"][0])

    def rows(self, options, **more):
        m = self.material("map_Kd " + options, **more)
        texture = self.blob.textures[m[3]]
        return texture[4:7] + texture[7:10]

    def test_offset_and_scale(self):
        self.picture()
        self.picture("2")
        moved = (1, 0, .25, 0, 1, -.5)  # v runs down here
        for options in ("-o .25 .5 a.png", "-o .25 .5 0 a.png", "a.png -o .25 .5 0", "-O .25 .5 a.png", "-o\t.25  .5 0\ta.png ",
                        "-s 1 1 1 -o .25 .5 a.png", "-blendu on -o .25 .5 -clamp off a.png", "-o .25 .5 2"):
            self.near(self.rows(options), moved)
        self.near(self.rows("-o .25 a.png"), (1, 0, .25, 0, 1, 0))
        for options in ("-s 2 3 1 a.png", "-s 2 3 a.png", "a.png -s 2 3 1", "-s 9 9 9 -s 2 3 a.png"):
            self.near(self.rows(options), (2, 0, 0, 0, 3, -2))
        self.near(self.rows("-s 2 a.png"), (2, 0, 0, 0, 1, 0))
        for options in ("-s 2 3 -o .5 .25 a.png", "-o .5 .25 -s 2 3 a.png", "-o .5 .25 0 a.png -s 2 3 1"):
            self.near(self.rows(options), (2, 0, .5, 0, 3, -2.25))
        self.near(self.rows("-s nan 1 a.png", warnings=1), (1, 0, 0, 0, 1, 0))
        m = self.material("map_Ke -s 2 2 1 a.png\nmap_Kd -o .5 0 0 a.png\nmap_Bump -s 4 4 a.png")
        self.assertEqual([self.blob.textures[m[i]][4] for i in (3, 7, NORMAL)], [1, 2, 4])

    def texels(self, texture):
        """Rows of (r, g, b, a)."""
        offset, width, height = self.blob.textures[texture][:3]
        texels = [self.blob.texels[offset + i][0] for i in range(width * height)]
        return [tuple(t >> 8 * c & 255 for c in range(4)) for t in texels]

    def test_opacity_by_a_map(self):
        """The alpha of a picture that has one, else its brightness, or what -imfchan says; with the colours of map_Kd."""
        save(self.folder, "kd.png", png(2, 1, lambda x, y: (10, 20, 30 + x)))
        save(self.folder, "grey.png", png(2, 1, lambda x, y: (99 * x, 99 * x, 99 * x)))
        save(self.folder, "alpha.png", png(2, 1, lambda x, y: (1, 2, 3, 200 * x + 5)))
        save(self.folder, "rgb.png", png(2, 1, lambda x, y: (30, 60, 90 + x)))
        for statements, expected in (
                ("map_d grey.png", [(255, 255, 255, 0), (255, 255, 255, 99)]),
                ("map_Kd kd.png\nmap_d grey.png", [(10, 20, 30, 0), (10, 20, 31, 99)]),
                ("map_d alpha.png\nmap_Kd kd.png", [(10, 20, 30, 5), (10, 20, 31, 205)]),
                ("map_Kd alpha.png\nmap_d alpha.png", [(1, 2, 3, 5), (1, 2, 3, 205)]),
                ("map_d -imfchan r alpha.png", [(255, 255, 255, 1)] * 2),
                ("map_d -imfchan l alpha.png", [(255, 255, 255, 2)] * 2),
                ("map_d -imfchan g rgb.png", [(255, 255, 255, 60)] * 2),
                ("map_d -imfchan b rgb.png", [(255, 255, 255, 90), (255, 255, 255, 91)]),
                ("map_d rgb.png -imfchan m", [(255, 255, 255, 255)] * 2),
                ("map_Kd -s 2 2 kd.png\nmap_d -s 2 2 grey.png", [(10, 20, 30, 0), (10, 20, 31, 99)])):
            m = self.material(statements)
            self.assertEqual((m[FLAGS] & 8, self.texels(m[3])), (8, expected), statements)
        m = self.material("map_Kd kd.png\nmap_d grey.png\nd .5")
        self.assertEqual((m[ALPHA], self.texels(m[3])[1][3]), (.5, 99))
        self.assertIn("alpha blending", self.info["facts"])
        # A picture that is opaque everywhere blends nothing.
        save(self.folder, "white.png", png(1, 1, lambda x, y: (255,) * 3))
        self.material("map_d white.png")
        self.assertEqual([f for f in self.info["facts"] if f in ("textures", "alpha blending")], [])
        save(self.folder, "large.png", png(4, 1, lambda x, y: (9, 9, 9)))
        for statements in ("map_Kd kd.png\nmap_d large.png", "map_Kd kd.png\nmap_d -o .5 0 grey.png"):
            self.material(statements, ignored=["map_d of another size or place than map_Kd"])
        self.material("illum 4\nNi 1.5\nmap_d grey.png", ignored=["map_d"])
        self.material("map_d nowhere.png", warnings=1)

    def test_maps_of_the_same_pictures_are_made_once(self):
        save(self.folder, "kd.png", png(4, 4, lambda x, y: (10, 20, 30 + x)))
        save(self.folder, "d.png", png(4, 4, lambda x, y: (x, y, 9, 255 - x)))
        save(self.folder, "p.png", png(4, 4, lambda x, y: (x, y, 9)))
        maps = "map_Kd %skd.png\nmap_d %sd.png\nmap_Pr %sp.png\nmap_Pm -imfchan g %sp.png\nbump %sp.png\n"
        def load(places, more=""):
            info, blob = self.obj(["mtllib a.mtl"] + SQUARE + ["usemtl m%d\nf 1 2 3" % i for i in range(len(places))],
                                  a="".join("newmtl m%d\n" % i + maps % ((place,) * 5) + more for i, place in enumerate(places)))
            self.assertEqual((info["materials"], info["warnings"]), (len(places), []))
            return len(blob.texels), len(blob.textures)
        self.assertEqual(load([""])[0], 6 * 16)  # three pictures, and what is made of two, one and one
        self.assertEqual(load([""] * 5), load([""]))
        texels, textures = load(["", "-s 2 2 ", "-o .5 0 "])
        self.assertEqual((texels, textures), (6 * 16, 3 * load([""])[1]))

    def test_roughness_and_metalness_by_maps(self):
        save(self.folder, "r.png", png(2, 1, lambda x, y: (50 + x,) * 3))
        save(self.folder, "m.png", png(2, 1, lambda x, y: (200 + x,) * 3))
        for statements, expected, factors in (
                ("map_Pr r.png\nmap_Pm m.png", [(255, 50, 200, 255), (255, 51, 201, 255)], (1, 1)),
                ("map_Pr r.png\nPr .5", [(255, 50, 255, 255), (255, 51, 255, 255)], (.5, 0)),
                ("Pm .25\nmap_Pm m.png\nPr .5", [(255, 255, 200, 255), (255, 255, 201, 255)], (.5, .25)),
                ("map_Pr -imfchan g r.png", [(255, 50, 255, 255), (255, 51, 255, 255)], (1, 0))):
            m = self.material(statements)
            self.assertEqual((self.texels(m[SURFACE]), (m[ROUGHNESS], m[METALLIC])), (expected, factors), statements)
        save(self.folder, "large.png", png(4, 1, lambda x, y: (9, 9, 9)))
        m = self.material("map_Pr r.png\nmap_Pm large.png", ignored=["map_Pm of another size or place than map_Pr"])
        self.assertEqual(self.texels(m[SURFACE])[1], (255, 51, 255, 255))

    def test_files_whose_case_differs(self):
        self.picture("Maps/Red.PNG")
        for name in ("maps/red.png", "MAPS\\RED.png", "Maps/red.png"):
            self.material("map_Kd " + name, warnings=1)
            self.assertEqual((self.info["textures"], self.info["missing_textures"]), (1, 0))
            self.assertIn("is taken from 'Maps/Red.PNG'", self.info["warnings"][0])
        self.picture("Blue.png")
        self.material("map_Kd c:/gone/BLUE.PNG", warnings=1)
        self.assertIn("is taken from 'Blue.png'", self.info["warnings"][0])
        # Two that differ in case alone: which one is meant is nobody's to guess.
        self.picture("one.png")
        self.picture("ONE.png")
        self.material("map_Kd One.png", warnings=1)
        self.assertEqual(self.info["missing_textures"], 1)
        self.material("map_Kd one.png")
        # A folder or file that has the very name is meant, whatever else differs from it in case alone.
        for folder in ("Tex", "tex", "TEX"):
            self.picture(folder + "/%s.PNG" % folder, (len(folder), 0, 0))
        for name, found in (("Tex/tex.png", "Tex/Tex.PNG"), ("tex\\TEX.PNG", "tex/tex.PNG"), ("TEX/tex.PNG", "TEX/TEX.PNG"),
                            ("c:/gone/Tex/tex.png", None), ("teX/tex.png", None)):
            self.material("map_Kd " + name, warnings=1)
            self.assertEqual((self.info["textures"], self.info["missing_textures"]), (1, 0) if found else (0, 1), name)
            self.assertIn("is taken from '%s'" % found if found else "is taken as white", self.info["warnings"][0])
        self.picture("Tex/one.png")
        self.picture("Tex/ONE.png")
        self.material("map_Kd Tex/ONE.png")
        self.picture("lone/two.png")
        self.picture("lone/TWO.png")
        self.material("map_Kd Lone/two.png", warnings=1)
        self.assertIn("is taken from 'lone/two.png'", self.info["warnings"][0])
        # Nothing above the scene's folder.
        self.material("map_Kd ../%s/BLUE.png" % os.path.basename(self.folder), warnings=1)
        self.assertIn("is taken from 'Blue.png'", self.info["warnings"][0])
        save(self.folder, "Sub/Lamps.MTL", LAMP.encode())
        for name in ("sub/lamps.mtl", "SUB\\LAMPS.mtl"):
            info, blob = self.obj(["mtllib " + name] + SQUARE + ["usemtl lamp", "f 1 2 3 4"])
            self.assertEqual((info["emissive_triangles"], len(info["warnings"])), (2, 1))
            self.assertIn("is taken from 'Sub/Lamps.MTL'", info["warnings"][0])

    def test_other_options(self):
        self.picture()
        for options in ("-blendu on -blendv on", "-boost 0", "-cc off", "-clamp off", "-mm 0 1", "-t 0 0 0", "-texres 256"):
            self.near(self.rows(options + " a.png"), (1, 0, 0, 0, 1, 0))
        for options in ("-blendu off", "-blendv off", "-boost 2", "-cc on", "-mm .5 1", "-mm 0 2", "-t 1", "-imfchan r", "-type cube_top"):
            self.rows(options + " a.png", ignored=["map option " + options.split()[0]])
        for options, clamp in (("-clamp on a.png", 5), ("-clamp a.png", 5), ("-clamp -s 1 1 a.png", 5), ("-clamp off a.png", 0)):
            m = self.material("map_Kd " + options)
            self.assertEqual(self.blob.textures[m[3]][3] & 15, clamp, options)
        for statement, scale in (("map_Bump -bm .25 a.png", .25), ("bump a.png -bm 2", 2), ("norm -bm -1 a.png", -1), ("bump a.png", 1),
                                 ("map_bump -o 1 0 0 -bm .5 a.png", .5), ("map_Bump -bm 3 gone.png\nmap_Bump -bm .5 a.png", .5)):
            m = self.material(statement)
            self.assertEqual((m[SCALE], m[NORMAL] == NONE), (scale, False))


class Colours(ObjCase):
    def colours(self, lines, ignored=(), told="", **libraries):
        info, blob = self.obj(lines, **libraries)
        self.assertEqual(info["ignored"], list(ignored))
        self.assertIn(told, "".join(info["warnings"]))
        return [tuple(round(c, 4) for c in colour[:3]) for colour in blob.colors], blob

    def square(self, *numbers):
        return ["%s %s" % (v, n) for v, n in zip(SQUARE, list(numbers) * 4)] + ["f 1 2 3 4"]

    def test_of_vertices(self):
        found, blob = self.colours(self.square("1 0 0"))
        self.assertEqual((found, blob.materials[0][:3]), ([(1, 0, 0)] * 4, (1, 1, 1)))  # all of it, not eight tenths
        found, _ = self.colours(self.square("1 0 0", "0 .5 0", "0 0 1", ".25 .25 .25"))
        self.assertEqual(found, [(1, 0, 0), (0, .5, 0), (0, 0, 1), (.25, .25, .25)])
        found, _ = self.colours(self.square("1 0 0", ""))  # without: white
        self.assertEqual(found, [(1, 0, 0), (1, 1, 1)] * 2)
        found, _ = self.colours(self.square("", "0 1 0"))
        self.assertEqual(found, [(1, 1, 1), (0, 1, 0)] * 2)
        self.assertEqual(self.colours(self.square("0 1 0 1"))[0], [(0, 1, 0)] * 4)
        self.assertEqual(self.colours(self.square("0 1 0 .5"), ["opacities of vertices"])[0], [(0, 1, 0)] * 4)
        found, blob = self.colours(["mtllib a.mtl", "usemtl m"] + self.square("1 0 0"), a="newmtl m\nKd .5\n")
        self.assertEqual((found, blob.materials[0][:3]), ([(1, 0, 0)] * 4, (.5, .5, .5)))

    def test_out_of_range(self):
        self.assertEqual(self.colours(self.square("255 0 51"), told="0 to 255")[0], [(1, 0, .2)] * 4)
        self.assertEqual(self.colours(self.square("1.5 0 .5"), told="clamped")[0], [(1, 0, .5)] * 4)
        self.assertEqual(self.colours(self.square("-1 0 nan"))[0], [(0, 0, 0)] * 4)
        for rest in (".5 .5", "1 0 0 1 1", "1 0 red"):
            self.assertEqual(self.colours(self.square(rest), told="is no colour")[0], [])


class Faces(ObjCase):
    def check_areas(self, faces, want):
        for got, area in zip(self.areas(faces), want):
            self.assertAlmostEqual(got, area, 5)

    def test_concave_faces_from_every_corner(self):
        shapes = {
            "arrow": ([(0, 0), (2, -1), (1, 0), (2, 1)], 1),
            "letter": ([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (0, 3)], 7),
            "stairs": ([(0, 0), (4, 0), (4, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 4), (0, 4)], 10),
            "on a line": ([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)], 4),
            "comb": ([(x, 0 if x % 2 else 2) for x in range(8)] + [(7, -1), (0, -1)], 14),
            "hole": ([(0, 0), (3, 0), (3, 3), (0, 3), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)], 8),
            "holes": ([(0, 0), (6, 0), (6, 3), (0, 3), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1), (4, 1), (4, 2), (5, 2), (5, 1), (4, 1),
                       (1, 1)], 16),  # the second is reached along a side of the first
            "twice": ([(0, 0), (1, 0), (1, 0), (2, 0), (3, 0), (3, 2), (1.5, 2), (1.5, 1), (1.5, 1), (1.5, .5), (1, .5), (1, 2), (0, 2)], 5.25),
            "spike": ([(0, 0), (4, 0), (4, 2), (2, 2), (2, 5), (2, 4), (2, 2), (0, 2)], 8),
            "slit": ([(0, 0), (4, 0), (4, 2), (2, 2), (2, 1), (2, 2), (0, 2)], 8),
            "house": ([(0, 0), (1, 0), (1, .5), (2, .5), (2, 0), (3, 0), (3, 1), (1.5, 2), (0, 1)], 4),
        }
        for name, (shape, area) in shapes.items():
            with self.subTest(name):
                faces = []
                for start in range(len(shape)):
                    turned = shape[start:] + shape[:start]
                    for way in (turned, turned[::-1]):
                        faces += [[(x, y, 7) for x, y in way], [(x, .5 * x, y) for x, y in way], [(5, x, y) for x, y in way]]
                wanted = [area, area * math.sqrt(1.25), area] * (2 * len(shape))
                self.check_areas(faces, wanted)

    def test_stars(self):
        random.seed(3)
        faces, areas = [], []
        for count in range(4, 60):
            ring = [(random.uniform(.2, 2), 2 * math.pi * i / count) for i in range(count)]
            points = [(r * math.cos(a), r * math.sin(a)) for r, a in ring]
            areas.append(.5 * sum(points[i - 1][0] * points[i][1] - points[i - 1][1] * points[i][0] for i in range(count)))
            faces.append([(x, y, 0) for x, y in points])
        self.check_areas(faces, areas)

    def test_as_many_triangles_as_there_must_be(self):
        info, _ = self.obj(["v %d %d 0" % p for p in ((0, 0), (4, 0), (4, 4), (2, 1), (0, 4))] + ["f 1 2 3 4 5", "f 4 5 1 2 3"])
        self.assertEqual((info["triangles"], info["dropped_degenerate"]), (6, 0))

    def test_many(self):
        """Large counts are linear: these took minutes where each looked at all others."""
        n = 60000
        ring = ["v %.9g %.9g 0" % (math.cos(2 * math.pi * i / n) * (2 + i % 2), math.sin(2 * math.pi * i / n) * (2 + i % 2))
                for i in range(n)]
        self.assertGreater(self.obj(ring + ["f " + " ".join(map(str, range(1, n + 1)))])[0]["triangles"], n * .9)
        self.assertEqual(self.obj(SQUARE + ["f " + "1 2 3 " * (n // 3)])[0]["triangles"], n // 3)
        self.assertEqual(self.obj(SQUARE + ["g a%d\nf 1 2 3" % i for i in range(n)])[0]["node_count"], n)
        self.assertEqual(self.obj(SQUARE + ["o a%d\nf 1 2 3" % (i % 7) for i in range(n)])[0]["node_count"], 7)
        info, _ = self.obj(["mtllib a.mtl"] + SQUARE + ["usemtl a%d\nf 1 2 3" % i for i in range(n)],
                           a="\n".join("newmtl a%d\nKd .5" % i for i in range(n)))
        self.assertEqual((info["materials"], info["warnings"]), (n, []))
        self.assertIn("line 131", self.refusal("\n".join(SQUARE + ["usemtl a%d\nf 1 2 3" % i for i in range(70000)])))


if __name__ == "__main__":
    unittest.main()
