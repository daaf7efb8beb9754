#!/usr/bin/env python3
"""Scene files that are broken, each in one way, for the loader to refuse or to mend.

    bad.py FOLDER    write them all, print their paths

As a module: BAD names the writers; each takes a folder of its own and returns the path of the scene file.
"""
import base64
import json
import math
import os
import struct
import sys
import zlib

from writers import Gltf, box, png, save

NAN = float("nan")
INF = float("inf")


def checker():
    return png(8, 8, lambda x, y: (255, 255, 255) if (x + y) % 2 else (32, 64, 96))


def boxed(edit=None, texture=False, corner=None):
    """A sound box as Gltf, after edit(json). `corner` replaces the first position."""
    g = Gltf()
    positions, triangles = box((0, 0, 0), (1, 1, 1))
    if corner:
        positions[0] = corner
    material = g.material("box", (.5, .5, .5), texture=g.image(checker()) if texture else None)
    uvs = [(p[0], p[1]) for p in positions] if texture else None
    g.node(mesh=g.mesh(positions, triangles, material, uvs=uvs))
    if edit:
        edit(g.json)
    return g


def gltf(edit=None, **keywords):
    return lambda folder: boxed(edit, **keywords).save(folder, "scene.gltf")


def instanced(translations, edit=None, **attributes):
    """A box as often as there are translations; edit(json, its extension's attributes)."""
    def write(folder):
        g = boxed()
        attributes["TRANSLATION"] = g.floats(translations, "VEC3") if translations else g.add(
            "accessors", {"componentType": 5126, "count": 0, "type": "VEC3"})
        g.extend(g.json["nodes"][0], "EXT_mesh_gpu_instancing", {"attributes": attributes})
        if edit:
            edit(g.json, attributes)
        return g.save(folder, "scene.gltf")
    return write


def sparse_of(count, **more):
    """An edit: the instances are as many zeros as no byte of the file stands for."""
    def edit(root, attributes):
        root["accessors"].append({"componentType": 5126, "count": count, "type": "VEC3", **more})
        attributes["TRANSLATION"] = len(root["accessors"]) - 1
    return edit


def many_times_much(root, attributes):
    """A million instances of five boxes: more than a scene may have, out of a file of a few kilobytes."""
    root["meshes"][0]["primitives"] *= 5
    sparse_of(1 << 20)(root, attributes)


def many_nodes_of_many(root, attributes):
    """Each node's instances are within the limit, those of all nodes are not."""
    sparse_of(1 << 19)(root, attributes)
    node = root["nodes"][0]
    for number in range(60):
        root["nodes"].append(dict(node))
        root["scenes"][0]["nodes"].append(len(root["nodes"]) - 1)


def with_scale(root, attributes):
    root["accessors"].append({"componentType": 5126, "count": 3, "type": "VEC3"})
    attributes["SCALE"] = len(root["accessors"]) - 1


def text(data, name="scene.gltf"):
    return lambda folder: save(folder, name, data if isinstance(data, bytes) else data.encode())


def buffer_of(uri):
    buffers = [{"byteLength": 36, "uri": uri}]
    return text(json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}], "buffers": buffers}))


def obj(lines, name="scene.obj", **others):
    def write(folder):
        for other, content in others.items():
            save(folder, other.replace("_mtl", ".mtl"), content.encode())
        return save(folder, name, (lines if isinstance(lines, str) else "\n".join(lines) + "\n").encode())
    return write


def glb(edit):
    return lambda folder: save(folder, "scene.glb", edit(bytearray(boxed(texture=True).glb())))


def glb_word(offset, value):
    def edit(data):
        data[offset:offset + 4] = struct.pack("<I", value & 0xFFFFFFFF)
        return data
    return glb(edit)


def set_in(*path_and_value):
    """An edit that sets json[path…] = value."""
    *path, last, value = path_and_value

    def edit(root):
        at = root
        for key in path:
            at = at[key]
        at[last] = value
    return edit


def external(name="scene.bin", keep=None, write=True, longer=0):
    """The box with its buffer in a file, of which only `keep` bytes are there."""
    def make(folder):
        g = boxed()
        if write:
            data = bytes(g.bytes) + bytes(longer)
            save(folder, name, data if keep is None else data[:keep])
        root = dict(g.json, buffers=[{"byteLength": len(g.bytes), "uri": name}])
        return save(folder, "scene.gltf", json.dumps(root).encode())
    return make


def outside_buffer(folder):
    """A buffer that exists, beside the scene's folder."""
    inner = os.path.join(folder, "inner")
    g = boxed()
    save(folder, "secret.bin", bytes(g.bytes))
    root = dict(g.json, buffers=[{"byteLength": len(g.bytes), "uri": "../secret.bin"}])
    return save(inner, "scene.gltf", json.dumps(root).encode())


def linked_buffer(folder):
    """A link in the scene's folder that leads out of it."""
    path = outside_buffer(folder)
    with open(path) as file:
        root = json.load(file)
    root["buffers"][0]["uri"] = "link.bin"
    link = os.path.join(folder, "inner", "link.bin")
    if not os.path.islink(link):
        os.symlink("../secret.bin", link)
    return save(os.path.join(folder, "inner"), "scene.gltf", json.dumps(root).encode())


def fifo_buffer(folder):
    path = external(name="pipe.bin", write=False)(folder)
    pipe = os.path.join(folder, "pipe.bin")
    if not os.path.exists(pipe):
        os.mkfifo(pipe)
    return path


def image_uri(uri, content=None, name=None):
    def make(folder):
        if content is not None:
            save(folder, name or uri, content)

        def edit(root):
            root["images"][0] = {"uri": uri}
        return boxed(edit, texture=True).save(folder, "scene.gltf")
    return make


def data_uri(content, mime="image/png"):
    return "data:%s;base64,%s" % (mime, base64.b64encode(content).decode())


def texture_info(content):
    """The base colour's textureInfo, with more in it."""
    return gltf(lambda root: root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].update(content), texture=True)


def attribute(name, count, width, value=1.0, texture=False, info=None, normal_map=False):
    """The box with one more attribute of `count` vectors; it has 8 vertices."""
    def make(folder):
        g = boxed(texture=texture)
        accessor = g.floats([[value] * width] * count, "VEC%d" % width)
        g.json["accessors"][accessor].pop("min", None)
        g.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor
        if info:
            g.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].update(info)
        if normal_map:
            g.json["materials"][0]["normalTexture"] = {"index": 0}
        return g.save(folder, "scene.gltf")
    return make


def deep_nodes(count):
    """The box below a chain of nodes."""
    def edit(root):
        root["nodes"] = [{"children": [i + 1]} for i in range(count - 1)] + [{"mesh": 0}]
    return gltf(edit)


def deep_json(depth):
    def make(folder):
        data = boxed().text()
        return save(folder, "scene.gltf", data[:-2] + b', "extras": ' + b"[" * depth + b"]" * depth + b"}")
    return make


def sparse(indices_at, value=(0.25, 0.25, 0.25)):
    """One position replaced by a sparse accessor's."""
    def make(folder):
        g = boxed()
        accessor = g.json["accessors"][g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
        accessor["sparse"] = {"count": 1,
                              "indices": {"bufferView": g.view(struct.pack("<H", indices_at)), "componentType": 5123},
                              "values": {"bufferView": g.view(struct.pack("<3f", *value))}}
        return g.save(folder, "scene.gltf")
    return make


def huge_image(folder):
    """A picture that says it is larger than any that may be read."""
    small = checker()
    ihdr = struct.pack(">IIBBBBB", 100000, 100000, 8, 2, 0, 0, 0)
    huge = small[:8] + struct.pack(">I", 13) + b"IHDR" + ihdr + struct.pack(">I", zlib.crc32(b"IHDR" + ihdr)) + small[33:]
    return image_uri(data_uri(huge))(folder)


def lights(*items):
    def edit(root):
        root["extensionsUsed"] = ["KHR_lights_punctual"]
        root["extensions"] = {"KHR_lights_punctual": {"lights": list(items)}}
        root["nodes"] += [{"extensions": {"KHR_lights_punctual": {"light": i}}} for i in range(len(items))]
        root["scenes"][0]["nodes"] += [1 + i for i in range(len(items))]
    return gltf(edit)


def primitive_mode(mode):
    return gltf(set_in("meshes", 0, "primitives", 0, "mode", mode))


def own_parent(root):
    root["nodes"][0]["children"] = [0]


def two_parents(root):
    root["nodes"] = [{"children": [2]}, {"children": [2]}, {"mesh": 0}]
    root["scenes"][0]["nodes"] = [0, 1]


def bad_index(folder):
    g = Gltf()
    positions, triangles = box((0, 0, 0), (1, 1, 1))
    g.place(positions, triangles[:-1] + [(0, 1, 99)], g.material("box", (.5, .5, .5)))
    return g.save(folder, "scene.gltf")


QUAD = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0"]
STAR = ["v %.6f %.6f 0" % ((1 if i % 2 == 0 else 0.4) * math.cos(i * math.pi / 5), (1 if i % 2 == 0 else 0.4) * math.sin(i * math.pi / 5))
        for i in range(10)]

BAD = {
    # ---- the container and its text
    "empty_glb": text(b"", "scene.glb"),
    "empty_gltf": text(b""),
    "empty_obj": text(b"", "scene.obj"),
    "blank_obj": text(b" \n\t\n", "scene.obj"),
    "not_a_glb": text(b"this is not a GLB file at all....", "scene.glb"),
    "unknown_ending": text(b"solid", "scene.stl"),
    "glb_header_only": glb(lambda d: d[:12]),
    "glb_cut_in_json": glb(lambda d: d[:60]),
    "glb_cut_in_binary": glb(lambda d: d[:-40]),
    "glb_version_1": glb_word(4, 1),
    "glb_length_below_header": glb_word(8, 13),
    "glb_length_zero": glb_word(8, 0),
    "glb_length_too_big": glb_word(8, 0x7FFFFFFF),
    "glb_json_chunk_too_big": glb_word(12, 0xFFFFFFF0),
    "glb_json_chunk_empty": glb_word(12, 0),
    "glb_wrong_chunk_type": glb_word(16, 0x12345678),
    "glb_binary_chunk_too_big": lambda folder: save(folder, "scene.glb", _binary_chunk_too_big()),
    "glb_second_buffer_without_bytes": lambda folder: save(folder, "scene.glb", _second_buffer()),
    "glb_second_buffer_with_an_empty_uri": lambda folder: save(folder, "scene.glb", _second_buffer(uri="")),
    "gltf_syntax": text("{]"),
    "gltf_cut": lambda folder: save(folder, "scene.gltf", boxed().text()[:-100]),
    "gltf_root_is_a_list": text("[1, 2, 3]"),
    "gltf_not_utf8": text(b'{"asset": {"version": "2.0", "generator": "\xff\xfe"}}'),
    "gltf_number_too_big": lambda folder: save(folder, "scene.gltf", boxed(set_in(
        "nodes", 0, "translation", [12345678, 0, 0])).text().replace(b"12345678", b"1e999")),
    "gltf_version_1": gltf(set_in("asset", "version", "1.0")),
    "gltf_no_asset": gltf(lambda root: root.pop("asset")),
    "gltf_no_scene": text('{"asset": {"version": "2.0"}, "scene": 0}'),
    "gltf_deep_json": deep_json(100000),
    "gltf_required_extension": gltf(set_in("extensionsRequired", ["KHR_draco_mesh_compression"])),
    # ---- instances
    "instances_differ_in_number": instanced([(0, 0, 0), (1, 0, 0)], with_scale),
    "instances_too_many": instanced([(0, 0, 0)], sparse_of(1 << 21)),
    "instances_many_times_much": instanced([(0, 0, 0)], many_times_much),
    "instances_of_many_nodes": instanced([(0, 0, 0)], many_nodes_of_many),
    "buffer_is_no_base64": buffer_of("data:;base64,AA*A"),
    "buffer_without_a_comma": buffer_of("data:;base64"),
    "buffer_is_short": buffer_of("data:;base64,AAAA"),
    "instances_of_a_wrong_type": instanced([(0, 0, 0)], lambda root, a: a.update(TRANSLATION=0, ROTATION=0)),
    "instances_not_there": instanced([(0, 0, 0)], lambda root, a: a.update(TRANSLATION=99)),
    "instances_no_number": instanced([(0, 0, 0)], lambda root, a: a.update(TRANSLATION="0")),
    # ---- wrong types and indices
    "scene_wrong_type": gltf(set_in("scene", "0")),
    "scene_out_of_range": gltf(set_in("scene", 7)),
    "scene_negative": gltf(set_in("scene", -1)),
    "matrix_of_15": gltf(set_in("nodes", 0, "matrix", [1] * 15)),
    "scale_of_strings": gltf(set_in("nodes", 0, "scale", ["1", "1", "1"])),
    "factor_wrong_type": gltf(set_in("materials", 0, "pbrMetallicRoughness", "metallicFactor", "much")),
    "nodes_wrong_type": gltf(set_in("nodes", {"0": {}})),
    "mesh_out_of_range": gltf(set_in("nodes", 0, "mesh", 5)),
    "mesh_index_huge": gltf(set_in("nodes", 0, "mesh", 1 << 40)),
    "child_out_of_range": gltf(set_in("nodes", 0, "children", [12])),
    "material_out_of_range": gltf(set_in("meshes", 0, "primitives", 0, "material", 99)),
    "texture_out_of_range": gltf(set_in("materials", 0, "pbrMetallicRoughness", "baseColorTexture", {"index": 9})),
    "image_out_of_range": gltf(set_in("textures", 0, "source", 9), texture=True),
    "sampler_out_of_range": gltf(set_in("textures", 0, "sampler", 9), texture=True),
    "accessor_out_of_range": gltf(set_in("meshes", 0, "primitives", 0, "attributes", "POSITION", 77)),
    "view_out_of_range": gltf(set_in("accessors", 0, "bufferView", 77)),
    "buffer_out_of_range": gltf(set_in("bufferViews", 0, "buffer", 77)),
    "accessor_past_end": gltf(set_in("accessors", 0, "count", 6000)),
    "accessor_count_huge": gltf(set_in("accessors", 0, "count", 2147483647)),
    "index_accessor_past_end": gltf(set_in("accessors", 1, "count", 36000)),
    "view_past_end": gltf(set_in("bufferViews", 0, "byteLength", 1 << 30)),
    "view_offset_past_end": gltf(set_in("bufferViews", 0, "byteOffset", 2147483647)),
    "offset_past_end": gltf(set_in("accessors", 0, "byteOffset", 1 << 30)),
    "stride_below_element": gltf(set_in("bufferViews", 0, "byteStride", 4)),
    "positions_wrong_type": gltf(set_in("accessors", 0, "type", "VEC2")),
    "component_unknown": gltf(set_in("accessors", 0, "componentType", 1234)),
    "mode_unknown": primitive_mode(9),
    "sparse_index_out_of_range": sparse(60000),
    "spot_without_cone": lights({"type": "spot"}),
    "light_out_of_range": gltf(lambda root: root["nodes"][0].update({"extensions": {"KHR_lights_punctual": {"light": 4}}})),
    # ---- materials
    "alpha_mode_wrong_type": gltf(set_in("materials", 0, "alphaMode", 1)),
    "cutoff_wrong_type": gltf(set_in("materials", 0, "alphaCutoff", "half")),
    "normal_texture_out_of_range": gltf(set_in("materials", 0, "normalTexture", {"index": 9})),
    "normal_scale_wrong_type": gltf(set_in("materials", 0, "normalTexture", {"index": 0, "scale": "1"}), texture=True),
    "surface_texture_out_of_range": gltf(set_in(
        "materials", 0, "pbrMetallicRoughness", "metallicRoughnessTexture", {"index": 9})),
    "material_extensions_are_a_list": gltf(set_in("materials", 0, "extensions", ["KHR_materials_unlit"])),
    "ior_wrong_type": gltf(set_in("materials", 0, "extensions", {"KHR_materials_ior": {"ior": "glass"}})),
    "ior_is_a_number": gltf(set_in("materials", 0, "extensions", {"KHR_materials_ior": 1.5})),
    "specular_colour_of_two": gltf(set_in(
        "materials", 0, "extensions", {"KHR_materials_specular": {"specularColorFactor": [1, 1]}})),
    "specular_texture_without_index": gltf(set_in(
        "materials", 0, "extensions", {"KHR_materials_specular": {"specularColorTexture": {"index": "first"}}})),
    "specular_texture_out_of_range": gltf(set_in(
        "materials", 0, "extensions", {"KHR_materials_specular": {"specularColorTexture": {"index": 2147483647}}})),
    "transform_offset_of_three": texture_info({"extensions": {"KHR_texture_transform": {"offset": [0, 0, 0]}}}),
    "transform_rotation_wrong_type": texture_info({"extensions": {"KHR_texture_transform": {"rotation": [0]}}}),
    "transform_set_negative": texture_info({"extensions": {"KHR_texture_transform": {"texCoord": -1}}}),
    "transform_is_a_list": texture_info({"extensions": {"KHR_texture_transform": []}}),
    "set_huge": texture_info({"texCoord": 1 << 40}),
    "colours_wrong_type": attribute("COLOR_0", 8, 2),
    "colours_too_few": attribute("COLOR_0", 7, 4),
    "colours_out_of_range": gltf(set_in("meshes", 0, "primitives", 0, "attributes", "COLOR_0", 99)),
    "second_set_too_short": attribute("TEXCOORD_1", 5, 2, texture=True, info={"texCoord": 1}),
    "tangents_too_few": attribute("TANGENT", 3, 4, texture=True, normal_map=True),
    # ---- the hierarchy
    "node_is_its_parent": gltf(own_parent),
    "node_with_two_parents": gltf(two_parents),
    "nodes_too_deep": deep_nodes(5000),
    # ---- side files
    "missing_bin": external(write=False),
    "truncated_bin": external(keep=100),
    "bin_is_a_fifo": fifo_buffer,
    "bin_outside": outside_buffer,
    "bin_behind_a_link": linked_buffer,
    "bin_absolute": external(name="/etc/passwd", write=False),
    "bin_no_base64": lambda folder: save(folder, "scene.gltf", json.dumps(dict(
        boxed().json, buffers=[{"byteLength": 264, "uri": "data:application/octet-stream;base64,!!!!"}])).encode()),
    # ---- OBJ
    "obj_utf16": text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".encode("utf-16-be"), "scene.obj"),
    "obj_utf16_mark": text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".encode("utf-16"), "scene.obj"),
    "obj_is_gltf": text(json.dumps({"asset": {"version": "2.0"}}), "scene.obj"),
    "obj_index_out_of_range": obj(QUAD + ["f 1 2 99"]),
    "obj_index_zero": obj(QUAD + ["f 0 1 2"]),
    "obj_index_too_negative": obj(QUAD + ["f -1 -2 -9"]),
}

# Broken in a way that can be mended, or merely odd: these load.
ODD = {
    "index_out_of_range": bad_index,
    "nan_position": gltf(corner=[NAN, 0, 0]),
    "infinite_position": gltf(corner=[INF, 0, 0]),
    "far_position": gltf(corner=[1e30, 0, 0]),
    "zero_scale_node": gltf(set_in("nodes", 0, "scale", [0, 0, 0])),
    "deep_nodes_500": deep_nodes(500),
    "bin_longer_than_said": external(longer=100),
    "missing_image": image_uri("no_such_image.png"),
    "image_outside": image_uri("../../../../../../../../etc/passwd"),
    "image_absolute": image_uri("/etc/passwd"),
    "image_truncated": image_uri(data_uri(checker()[:60])),
    "image_is_text": image_uri(data_uri(b"no picture at all")),
    "image_empty": image_uri("empty.png", b""),
    "image_too_large": huge_image,
    "image_view_past_end": gltf(set_in("bufferViews", 0, "byteOffset", 2147483647), texture=True),
    "image_percent_encoded": image_uri("a%20picture.png", checker(), "a picture.png"),
    "sparse_position": sparse(0),
    "points": primitive_mode(0),
    "lines": primitive_mode(1),
    "strip": primitive_mode(5),
    "fan": primitive_mode(6),
    "bad_lights": lights({"type": "point", "intensity": -1}, {"type": "area"}, {"type": "point", "color": [-1, 0, 0]},
                         {"type": "spot", "spot": {"innerConeAngle": 1, "outerConeAngle": 0.5}}, {"type": "point"}),
    "colour_above_one": gltf(set_in("materials", 0, "pbrMetallicRoughness", "baseColorFactor", [2, .5, -1, 1])),
    "no_nodes": gltf(set_in("scenes", 0, {})),
    "used_extension": gltf(set_in("extensionsUsed", ["KHR_materials_sheen"])),
    "read_extensions_required": gltf(set_in("extensionsRequired", ["KHR_texture_transform", "KHR_materials_unlit",
                                                                    "KHR_materials_specular", "KHR_materials_ior"])),
    "factors_out_of_range": gltf(lambda root: root["materials"][0]["pbrMetallicRoughness"].update(
        metallicFactor=-1, roughnessFactor=7)),
    "ior_negative": gltf(set_in("materials", 0, "extensions", {"KHR_materials_ior": {"ior": -1}})),
    "cutoff_negative": gltf(lambda root: root["materials"][0].update(alphaMode="MASK", alphaCutoff=-1e300)),
    "cutoff_over_tiny_alpha": gltf(lambda root: (root["materials"][0].update(alphaMode="MASK", alphaCutoff=1e300), root[
        "materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[1, 1, 1, 1e-300]))),
    "normal_scale_huge": gltf(set_in("materials", 0, "normalTexture", {"index": 0, "scale": 1e300}), texture=True),
    "normal_map_without_coordinates": gltf(set_in("materials", 0, "normalTexture", {"index": 0, "texCoord": 1}), texture=True),
    "transform_huge": texture_info({"extensions": {"KHR_texture_transform": {"scale": [1e300, 1]}}}),
    "colours_nan": attribute("COLOR_0", 8, 4, NAN),
    "colours_negative": attribute("COLOR_0", 8, 3, -INF),
    "second_set_nan": attribute("TEXCOORD_1", 8, 2, NAN, texture=True, info={"texCoord": 1}),
    "tangents_nan": attribute("TANGENT", 8, 4, NAN, texture=True, normal_map=True),
    "sheen": gltf(set_in("materials", 0, "extensions", {"KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1]}})),
    "coat_out_of_range": gltf(set_in("materials", 0, "extensions", {"KHR_materials_clearcoat": {"clearcoatFactor": 1e300}})),
    "coat_is_no_object": gltf(set_in("materials", 0, "extensions", {"KHR_materials_clearcoat": 7})),
    "instances_of_nothing": instanced([]),
    "instances_nan": instanced([(0, 0, 0), (NAN, 0, 0)]),
    "instances_without_attributes": gltf(set_in("nodes", 0, "extensions", {"EXT_mesh_gpu_instancing": {"attributes": 3}})),
    "alpha_blend": gltf(set_in("materials", 0, "alphaMode", "BLEND")),
    "specular_alpha_texture": gltf(set_in("materials", 0, "extensions", {"KHR_materials_specular": {
        "specularTexture": {"index": 0}}}), texture=True),
    "obj_point_cloud": obj(["v %d %d %d" % (i, i * i % 7, i * 3 % 5) for i in range(9)]),
    "obj_degenerate": obj(QUAD + ["f 1 2 3", "f 1 1 2", "f 1 2 1", "f 2 2 2"]),
    "obj_concave": obj(STAR + ["f " + " ".join(str(i + 1) for i in range(10))]),
    "obj_nan": obj(QUAD + ["v nan 0 0", "f 1 2 3", "f 1 2 5"]),
    "obj_missing_mtl": obj(["mtllib not_there.mtl"] + QUAD + ["usemtl red", "f 1 2 3 4"]),
    "obj_mtl_outside": obj(["mtllib ../../../etc/passwd"] + QUAD + ["f 1 2 3 4"]),
    "obj_undefined_usemtl": obj(["mtllib some.mtl"] + QUAD + ["usemtl missing", "f 1 2 3", "usemtl known", "f 1 3 4"],
                                some_mtl="newmtl known\nKd 0.1 0.2 0.3\n"),
    "obj_missing_texture": obj(["mtllib some.mtl"] + QUAD + ["usemtl known", "f 1 2 3 4"],
                               some_mtl="newmtl known\nKd 1 1 1\nmap_Kd ../../nothing.png\n"),
    "obj_bright_and_wild": obj(["mtllib some.mtl"] + QUAD + ["usemtl known", "f 1 2 3 4"],
                               some_mtl="newmtl known\nKd 3 -1 nan\nKe 17 12 4\nKs 1 1 1\nNs 50\nNi 1.5\nd 0.5\nillum 7\nmap_bump x.png\n"),
    "obj_number_formats": obj(["v 1e2 2.e1 .5", "v +1.5E+1 -2 3", "v 1.e-2 00012 -.25", "vt .5 .5", "f 1/1 2/1 3/1"]),
    "obj_carriage_returns": obj("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n"),
    "obj_negative_indices": obj(QUAD + ["f -4 -3 -2 -1"]),
    "obj_lines": obj(QUAD + ["l 1 2", "f 1 2 3"]),
}


def _binary_chunk_too_big():
    data = bytearray(boxed(texture=True).glb())
    json_bytes = struct.unpack_from("<I", data, 12)[0]
    at = 20 + json_bytes
    # Eight more than is there: the chunk's own header, which a careless reader forgets.
    struct.pack_into("<I", data, at, struct.unpack_from("<I", data, at)[0] + 8)
    return data


def _second_buffer(**more):
    g = boxed()
    g.json["buffers"] = []
    data = g.glb()
    root = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])
    length = root["buffers"][0]["byteLength"]
    root["buffers"] = [{"byteLength": length, **more}] * 3
    body = json.dumps(root).encode()
    body += b" " * (-len(body) % 4)
    binary = bytes(g.bytes) + bytes(-len(g.bytes) % 4)
    chunks = struct.pack("<II", len(body), 0x4E4F534A) + body + struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: bad.py FOLDER")
    for name, write in {**BAD, **ODD}.items():
        print(write(os.path.join(sys.argv[1], name)))


if __name__ == "__main__":
    main()
