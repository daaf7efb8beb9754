"""Files of patches and of form factors, sound and broken, as bad.py has scenes: CASES names for each its writer, the code by which
it is refused (None: it loads) and a word of what is said then. The layout is stated here once more, apart from the service's."""
import math
import struct

from writers import save

CODES = {"char": "b", "uchar": "B", "int": "i", "uint": "I", "float": "f", "double": "d"}
AXES = [("double", axis) for axis in "xyz"]
COLOURS = {name: [("float", f"{name}_{c}") for c in "rgb"] for name in ("b", "m", "d", "rho", "h")}
FACE = [("uint", "patch"), ("uchar", "side"), ("uint", "material"), ("float", "area"), *COLOURS["b"], *COLOURS["m"], *COLOURS["d"],
        *COLOURS["rho"], ("uchar", "straight"), ("uchar", "reached"), ("float", "escaped"), ("float", "cut"), *COLOURS["h"]]
LIST = "list uchar uint vertex_indices"


class Patches:
    """A quad and a triangle: four faces. What a case changes is changed before bytes() is called."""

    def __init__(self):
        self.format = "binary_little_endian 1.0"
        self.axes, self.face = list(AXES), list(FACE)
        self.corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
        shapes = [[0, 1, 2, 3], [4, 5, 6]]
        self.faces = shapes + [shape[::-1] for shape in shapes]
        self.of = [dict(patch=i % 2, side=i // 2, area=1 - .5 * (i % 2), b_r=.25, h_r=.5, rho_r=.5, reached=1, escaped=.75,
                        red=7) for i in range(4)]
        self.counts = None  # of vertices and faces, if not those that are there
        self.end, self.behind = "end_header\n", b""

    def header(self):
        vertices, faces = self.counts or (len(self.corners), len(self.faces))
        lines = [f"format {self.format}", "comment a comment", f"element vertex {vertices}", *(f"property {t} {n}" for t, n in self.axes),
                 f"element face {faces}", *("property " + (LIST if p == LIST else "%s %s" % p) for p in self.properties())]
        return lines

    def properties(self):
        return self.face if LIST in self.face else [LIST, *self.face]

    def bytes(self):
        data = "".join(line + "\n" for line in ["ply", *self.header()]).encode() + self.end.encode()
        for corner in self.corners:
            of = dict(zip("xyz", corner))
            data += b"".join(struct.pack("<" + CODES[kind], of.get(name, 0)) for kind, name in self.axes)
        for face, of in zip(self.faces, self.of):
            for p in self.properties():
                data += struct.pack("<B%dI" % len(face), len(face), *face) if p == LIST else struct.pack("<" + CODES[p[0]], of.get(p[1], 0))
        return data + self.behind


def ply(edit=lambda patches: None, bytes_of=lambda data: data):
    """A file after edit(Patches), or the lines of its header, and bytes_of(its bytes)."""
    def write(folder):
        patches = Patches()
        edit(patches)
        return save(folder, "patches.ply", bytes_of(patches.bytes()))
    return write


def setting(**values):
    """An edit that sets attributes."""
    return lambda patches: patches.__dict__.update(values)


def value(name, number, face=3):
    return ply(lambda patches: patches.of[face].update({name: number}))


def changed(old, new):
    return ply(bytes_of=lambda data: data.replace(old, new, 1))


def mesh(folder):
    """A triangle as other programs write it."""
    lines = ["ply", "format binary_little_endian 1.0", "element vertex 3", *(f"property float {c}" for c in "xyz"), "element face 1",
             "property " + LIST, "end_header"]
    body = struct.pack("<9fB3I", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2)
    return save(folder, "mesh.ply", "".join(line + "\n" for line in lines).encode() + body)


def raw(name, data):
    return lambda folder: save(folder, name, data)


def without(name):
    return ply(lambda patches: patches.face.remove(next(p for p in FACE if p[1] == name)))


BANNER = "%%MatrixMarket matrix coordinate real general\n"
ROWS = "1 2 0.25\n1 4 0.75\n2 1 1\n3 4 0\n4 1 1e-45\n"


def mtx(entries=ROWS, sizes="4 4 5", head=BANNER + "% a comment\n"):
    return raw("factors.mtx", (head + sizes + "\n" + entries).encode())


def entry(text):
    """The file with another first entry."""
    return mtx(text + ROWS[ROWS.index("\n"):])


PLAIN = "scene-invalid"
OTHER = "scene-unsupported"
LIMIT = "scene-limit"
CASES = {
    "ply_sound": (ply(), None, ""),
    "ply_carriage_returns": (changed(b"ply\n", b"ply\r\n"), None, ""),
    "ply_further_numbers": (ply(lambda p: (p.face.insert(2, ("uchar", "red")), p.axes.insert(0, ("float", "weight")))), None, ""),
    "ply_another_order": (ply(setting(face=[*FACE[::-2], LIST, *FACE[-2::-2]], axes=AXES[::-1])), None, ""),
    "ply_other_names_of_types": (ply(bytes_of=lambda data: data.replace(b"uint patch", b"uint32 patch").replace(b"double y", b"float64 y")),
                                 None, ""),
    "ply_empty": (raw("a.ply", b""), PLAIN, "empty"),
    "ply_is_text": (raw("a.ply", b"v 0 0 0\n"), PLAIN, "not a PLY"),
    "ply_mesh": (mesh, OTHER, "no meshes"),
    "ply_ascii": (ply(setting(format="ascii 1.0")), OTHER, "no meshes"),
    "ply_big_endian": (ply(setting(format="binary_big_endian 1.0")), OTHER, "no meshes"),
    "ply_no_format": (changed(b"format binary_little_endian 1.0\n", b""), PLAIN, "no format"),
    "ply_header_without_end": (ply(setting(end="")), PLAIN, "header"),
    "ply_header_endless": (changed(b"comment a comment\n", b"comment\n" * (1 << 20)), PLAIN, "does not end"),
    "ply_line_endless": (changed(b"comment a comment\n", b"x" * (1 << 20)), PLAIN, "does not end"),
    "ply_line_of_nothing": (changed(b"comment a comment\n", b"\n"), PLAIN, "empty line"),
    "ply_line_of_nonsense": (changed(b"comment a comment", b"remark"), PLAIN, "line that is none"),
    "ply_another_element": (changed(b"end_header\n", b"element edge 0\nend_header\n"), OTHER, "alone"),
    "ply_faces_first": (changed(b"element vertex", b"element face"), OTHER, "alone"),
    "ply_property_of_nothing": (changed(b"element vertex", b"property uint early\nelement vertex"), PLAIN, "property"),
    "ply_property_twice": (ply(lambda p: p.face.append(("float", "cut"))), PLAIN, "twice"),
    "ply_property_without_type": (changed(b"property float cut", b"property cut"), PLAIN, "property"),
    "ply_second_list": (changed(b"property uint patch", b"property " + LIST.encode() + b"\nproperty uint patch"), OTHER, "list"),
    "ply_another_list": (changed(b"vertex_indices", b"texture_numbers"), OTHER, "list"),
    "ply_list_of_bytes": (changed(b"list uchar uint", b"list uchar uchar"), OTHER, "list"),
    "ply_wrong_type": (changed(b"property float area", b"property uint area"), OTHER, "type"),
    "ply_float_corners": (ply(setting(axes=[("float", axis) for axis in "xyz"])), OTHER, "type"),
    "ply_flat": (ply(setting(axes=AXES[:2])), OTHER, "without"),
    "ply_without_irradiance": (without("h_g"), OTHER, "h_g"),
    "ply_count_negative": (ply(setting(counts=(-7, 4))), PLAIN, "number"),
    "ply_count_huge": (ply(setting(counts=(7, 1 << 70))), PLAIN, "number"),
    "ply_count_missing": (changed(b"element vertex 7", b"element vertex"), OTHER, ""),
    "ply_faces_none": (ply(setting(counts=(7, 0))), PLAIN, "no faces"),
    "ply_faces_lied": (ply(setting(counts=(7, 5))), PLAIN, "ends before"),
    "ply_faces_few": (ply(setting(counts=(7, 3))), PLAIN, "goes on"),
    "ply_faces_million": (ply(setting(counts=(7, 1 << 20))), PLAIN, "ends before"),
    "ply_faces_billion": (ply(setting(counts=(7, 10**9))), LIMIT, "1000000000"),
    "ply_vertices_most": (ply(setting(counts=(2**32 - 1, 4))), PLAIN, "ends before"),
    "ply_cut": (ply(bytes_of=lambda data: data[:-1]), PLAIN, "ends before"),
    "ply_cut_in_vertices": (ply(bytes_of=lambda data: data[:data.index(b"end_header") + 40]), PLAIN, "ends before"),
    "ply_goes_on": (ply(setting(behind=b"\0")), PLAIN, "goes on"),
    "ply_list_of_two": (ply(lambda p: p.faces[3].pop()), PLAIN, "three corners"),
    "ply_list_of_255": (ply(lambda p: p.faces[3].extend([0] * 252)), PLAIN, "three corners"),
    "ply_vertex_not_there": (ply(lambda p: p.faces[3].__setitem__(0, 7)), PLAIN, "vertex"),
    "ply_vertex_huge": (ply(lambda p: p.faces[3].__setitem__(0, 2**32 - 1)), PLAIN, "vertex"),
    "ply_three_faces": (ply(lambda p: (p.faces.pop(), p.of.pop())), PLAIN, "two for each"),
    "ply_order": (value("patch", 0), PLAIN, "order"),
    "ply_side": (value("side", 0), PLAIN, "order"),
    "ply_side_two": (value("side", 2), PLAIN, "order"),
    "ply_corner_nan": (ply(lambda p: p.corners.__setitem__(6, (0, math.nan, 0))), PLAIN, "corner"),
    "ply_corner_far": (ply(lambda p: p.corners.__setitem__(6, (0, 2e12, 0))), PLAIN, "corner"),
    "ply_area_nan": (value("area", math.nan), PLAIN, "area"),
    "ply_area_negative": (value("area", -1), PLAIN, "area"),
    "ply_light_nan": (value("b_g", math.nan), PLAIN, "light"),
    "ply_light_infinite": (value("h_b", math.inf), PLAIN, "light"),
    "ply_light_negative": (value("m_r", -1e-40), PLAIN, "light"),
    "ply_light_huge": (value("d_r", 2e30), PLAIN, "light"),
    "ply_reflectance_above_one": (value("rho_b", 1.001), PLAIN, "reflectance"),
    "ply_share_above_one": (value("escaped", 1.001), PLAIN, "share"),
    "ply_share_of_nothing": (value("reached", 0), PLAIN, "share"),
    "ply_mark": (value("reached", 7), PLAIN, "mark"),
    "ply_straight_in_part": (value("straight", 1), PLAIN, "two ways"),
    "ply_material": (value("material", 65535), PLAIN, "material"),
    "mtx_sound": (mtx(), None, ""),
    "mtx_by_columns": (mtx("2 1 1\n4 1 1e-45\n1 2 0.25\n1 4 0.75\n3 4 0\n"), None, ""),
    "mtx_any_order": (mtx("1 4 0.75\n4 1 1e-45\n3 4 0\n2 1 1\n1 2 0.25"), None, ""),
    "mtx_spaced": (mtx("\n  1\t2 0.25 \r\n1 4 +7.5E-1\r\n\n2 1 1.\n3 4 .0\n4 1 1e-45\n \n", head=BANNER.upper().replace(
        "%%MATRIXMARKET", "%%MatrixMarket") + "%\n\n% and more\n"), None, ""),
    "mtx_of_nothing": (mtx("", "4 4 0"), None, ""),
    "mtx_row_of_two": (entry("1 2 1.25"), None, "more than 1, as they do with mirrors: 1"),
    "mtx_empty": (raw("a.mtx", b""), PLAIN, "empty"),
    "mtx_is_text": (raw("a.mtx", b"4 4 5\n" + ROWS.encode()), PLAIN, "not a Matrix Market"),
    "mtx_another_banner": (mtx(head=BANNER.replace("Market", "Markets")), PLAIN, "not a Matrix Market"),
    "mtx_symmetric": (mtx(head=BANNER.replace("general", "symmetric")), OTHER, "general"),
    "mtx_dense": (mtx(head=BANNER.replace("coordinate", "array")), OTHER, "general"),
    "mtx_pattern": (mtx(head=BANNER.replace("real", "pattern")), OTHER, "general"),
    "mtx_banner_alone": (raw("a.mtx", BANNER.strip().encode()), PLAIN, "numbers of rows"),
    "mtx_comments_alone": (raw("a.mtx", (BANNER + "% more" * 100).encode()), PLAIN, "numbers of rows"),
    "mtx_two_sizes": (mtx(sizes="4 4"), PLAIN, "numbers of rows"),
    "mtx_four_sizes": (mtx(sizes="4 4 5 6"), PLAIN, "numbers of rows"),
    "mtx_sizes_negative": (mtx(sizes="-4 -4 5"), PLAIN, "numbers of rows"),
    "mtx_sizes_huge": (mtx(sizes="99999999999999999999 4 5"), PLAIN, "numbers of rows"),
    "mtx_oblong": (mtx(sizes="4 5 5"), PLAIN, "square"),
    "mtx_no_rows": (mtx("", "0 0 0"), PLAIN, "square"),
    "mtx_billion_rows": (mtx(sizes="1000000000 1000000000 5"), LIMIT, "1000000000"),
    "mtx_billion_entries": (mtx(sizes="4 4 1000000000"), LIMIT, "1000000000"),
    "mtx_million_entries": (mtx(sizes="4 4 1000000"), PLAIN, "too short"),
    "mtx_fewer": (mtx(sizes="4 4 6"), PLAIN, "fewer"),
    "mtx_more": (mtx(sizes="4 4 4"), PLAIN, "more"),
    "mtx_comment_within": (mtx(ROWS + "% the end\n"), PLAIN, "row"),
    "mtx_cut": (mtx(ROWS.rstrip()[:-6]), PLAIN, "no number"),
    "mtx_row_zero": (entry("0 2 0.25"), PLAIN, "row"),
    "mtx_row_beyond": (entry("5 2 0.25"), PLAIN, "row"),
    "mtx_row_negative": (entry("-1 2 0.25"), PLAIN, "row"),
    "mtx_row_broken": (entry("1.0 2 0.25"), PLAIN, "row"),
    "mtx_row_huge": (entry("4294967297 2 0.25"), PLAIN, "row"),
    "mtx_column_zero": (entry("1 0 0.25"), PLAIN, "column"),
    "mtx_column_beyond": (entry("1 5 0.25"), PLAIN, "column"),
    "mtx_column_alone": (entry("1"), PLAIN, "column"),
    "mtx_value_missing": (entry("1 2"), PLAIN, "no number"),
    "mtx_value_twice": (entry("1 2 0.25 0.25"), PLAIN, "goes on"),
    "mtx_value_nan": (entry("1 2 nan"), PLAIN, "no number"),
    "mtx_value_infinite": (entry("1 2 inf"), PLAIN, "no number"),
    "mtx_value_overflows": (entry("1 2 1e99"), PLAIN, "no number"),
    "mtx_value_hexadecimal": (entry("1 2 0x1p-2"), PLAIN, "no number"),
    "mtx_value_two_points": (entry("1 2 0.2.5"), PLAIN, "no number"),
    "mtx_value_of_marks": (entry("1 2 e+-"), PLAIN, "no number"),
    "mtx_value_with_a_comma": (entry("1 2 0,25"), PLAIN, "no number"),
    "mtx_value_endless": (entry("1 2 0." + "3" * 100000), PLAIN, "no number"),
    "mtx_value_negative": (entry("1 2 -0.25"), PLAIN, "negative"),
    "mtx_zero_byte": (entry("1 2 0.\0"), PLAIN, ""),
    "mtx_zero_line": (mtx("\0\n" + ROWS), PLAIN, "row"),
    "mtx_place_twice": (entry("1 4 0.25"), PLAIN, "two form factors"),
    "mtx_place_twice_apart": (mtx("1 2 0.25\n2 1 1\n3 4 0\n4 1 1e-45\n1 2 0.25\n"), PLAIN, "two form factors"),
    "mtx_row_sums_up_to_more": (entry("1 2 33"), PLAIN, "mirrors"),
}
