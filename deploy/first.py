"""Writes first.gltf beside itself: a small room with an oil lamp, the scene of deploy/run. The room is 2 m a side, the lamp
a surface of revolution with a flame on its spout. All from numbers here; nothing but Python is needed."""
import base64
import json
import math
import pathlib
import struct

meshes = []   # (material index, positions, normals or None, triangles)


def quad(material, a, b, c, d):
    """Counter-clockwise seen from its front."""
    meshes.append((material, [a, b, c, d], None, [(0, 1, 2), (0, 2, 3)]))


def box(material, centre, half, degrees):
    """A box on its base, turned about the vertical."""
    angle = math.radians(degrees)
    c, s = math.cos(angle), math.sin(angle)

    def corner(x, y, z):
        x, z = x * half[0], z * half[2]
        return (centre[0] + c * x + s * z, centre[1] + y * half[1], centre[2] - s * x + c * z)

    for face in ([(-1, 1), (1, 1)], [(1, 1), (1, -1)], [(1, -1), (-1, -1)], [(-1, -1), (-1, 1)]):
        (x0, z0), (x1, z1) = face
        quad(material, corner(x0, 0, z0), corner(x1, 0, z1), corner(x1, 2, z1), corner(x0, 2, z0))
    quad(material, corner(-1, 2, 1), corner(1, 2, 1), corner(1, 2, -1), corner(-1, 2, -1))


def lathe(material, origin, profile, segments=28, stretch=0.0):
    """Turn a profile of (radius, height), from its lower outside upwards. `stretch` pulls one side of it out to a spout."""
    positions, normals, triangles = [], [], []
    rings = len(profile)
    for j, (radius, height) in enumerate(profile):
        r0, h0 = profile[max(j - 1, 0)]
        r1, h1 = profile[min(j + 1, rings - 1)]
        length = math.hypot(h1 - h0, r1 - r0)
        for i in range(segments):
            angle = 2 * math.pi * i / segments
            x, z = math.cos(angle), math.sin(angle)
            pull = 1 + stretch * math.exp(-((min(angle, 2 * math.pi - angle) / 0.35) ** 2))
            positions.append((origin[0] + radius * x * pull, origin[1] + height, origin[2] + radius * z))
            out, up = (h1 - h0) / length, -(r1 - r0) / length
            normals.append((out * x, up, out * z))
    for j in range(rings - 1):
        for i in range(segments):
            k = (i + 1) % segments
            a, b, c, d = j * segments + i, j * segments + k, (j + 1) * segments + k, (j + 1) * segments + i
            triangles += [(a, c, b), (a, d, c)]
    meshes.append((material, positions, normals, triangles))


WHITE, CLAY, TEAL, BRASS, CEILING_LAMP, FLAME = range(6)
materials = [
    {"name": "lime wash", "colour": (0.73, 0.71, 0.68)},
    {"name": "clay", "colour": (0.60, 0.16, 0.08)},
    {"name": "teal", "colour": (0.08, 0.30, 0.34)},
    {"name": "brass", "colour": (0.89, 0.67, 0.32), "metallic": 1, "roughness": 0.3},
    {"name": "skylight", "colour": (0, 0, 0), "emission": (1.0, 0.93, 0.82), "strength": 15},
    {"name": "flame", "colour": (0, 0, 0), "emission": (1.0, 0.55, 0.18), "strength": 26},
]

quad(WHITE, (-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1))          # floor
quad(WHITE, (-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1))          # ceiling
quad(WHITE, (-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1))        # back
quad(CLAY, (-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1))         # left
quad(TEAL, (1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1))             # right
quad(CEILING_LAMP, (-0.25, 1.998, -0.3), (0.25, 1.998, -0.3), (0.25, 1.998, 0.1), (-0.25, 1.998, 0.1))
box(WHITE, (-0.4, 0, -0.4), (0.28, 0.62, 0.28), 18)
box(WHITE, (0.36, 0, 0.22), (0.30, 0.27, 0.30), -17)
lamp = (0.32, 0.541, 0.24)
lathe(BRASS, lamp, [(0.001, 0.0), (0.09, 0.0), (0.095, 0.01), (0.05, 0.03), (0.035, 0.06), (0.06, 0.085), (0.12, 0.105),
                    (0.155, 0.14), (0.16, 0.17), (0.15, 0.172), (0.14, 0.145), (0.10, 0.12), (0.001, 0.112)], stretch=0.55)
lathe(FLAME, (lamp[0] + 0.215, lamp[1] + 0.165, lamp[2]),
      [(0.0005, 0.0), (0.02, 0.014), (0.026, 0.036), (0.021, 0.065), (0.011, 0.096), (0.0005, 0.125)], segments=12)

data = bytearray()
views, accessors, primitives = [], [], []


def accessor(rows, code, kind, component, target):
    while len(data) % 4:
        data.append(0)
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 0, "target": target})
    flat = [v for row in rows for v in row]
    data.extend(struct.pack(f"<{len(flat)}{code}", *flat))
    views[-1]["byteLength"] = len(data) - views[-1]["byteOffset"]
    width = len(rows[0])
    entry = {"bufferView": len(views) - 1, "componentType": component, "type": kind,
             "count": len(rows) if kind != "SCALAR" else len(flat)}
    if code == "f":
        single = [struct.unpack("<f", struct.pack("<f", v))[0] for v in flat]
        entry["min"] = [min(single[i::width]) for i in range(width)]
        entry["max"] = [max(single[i::width]) for i in range(width)]
    accessors.append(entry)
    return len(accessors) - 1


for material, positions, normals, triangles in meshes:
    attributes = {"POSITION": accessor(positions, "f", "VEC3", 5126, 34962)}
    if normals:
        attributes["NORMAL"] = accessor([tuple(c / math.hypot(*n) for c in n) for n in normals], "f", "VEC3", 5126, 34962)
    primitives.append({"attributes": attributes, "indices": accessor(triangles, "H", "SCALAR", 5123, 34963),
                       "material": material})


def gltf_material(m):
    result = {"name": m["name"], "pbrMetallicRoughness":
              {"baseColorFactor": [*m["colour"], 1], "metallicFactor": m.get("metallic", 0),
               "roughnessFactor": m.get("roughness", 1)}}
    if "metallic" not in m:
        # Matt paint: no gloss at all.
        result["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
    if "emission" in m:
        result["emissiveFactor"] = list(m["emission"])
        result.setdefault("extensions", {})["KHR_materials_emissive_strength"] = {"emissiveStrength": m["strength"]}
    return result


scene = {
    "asset": {"version": "2.0", "generator": "deploy/first.py"},
    "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_specular"],
    "scene": 0,
    "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"name": "room", "mesh": 0}, {"name": "view", "camera": 0, "translation": [0, 1, 4.2]}],
    "cameras": [{"name": "view", "type": "perspective",
                 "perspective": {"yfov": 2 * math.atan(0.985 / 3.2), "aspectRatio": 1, "znear": 0.01}}],
    "meshes": [{"primitives": primitives}],
    "materials": [gltf_material(m) for m in materials],
    "accessors": accessors,
    "bufferViews": views,
    "buffers": [{"byteLength": len(data),
                 "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
}
path = pathlib.Path(__file__).with_name("first.gltf")
path.write_text(json.dumps(scene, separators=(",", ":")) + "\n")
print(f"{path}: {sum(len(m[3]) for m in meshes)} triangles")
