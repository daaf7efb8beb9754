"""Writers of small scene files: a glTF (or GLB) and an OBJ builder. Deterministic: the same calls give the same bytes."""
import base64
import json
import math
import os
import struct


def sub(a, b):
    return [a[i] - b[i] for i in range(3)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def look_at(eye, target, up=(0, 1, 0)):
    """A node's matrix, column by column, for something at `eye` that looks along its own -Z at `target`."""
    z = unit(sub(eye, target))
    x = unit(cross(list(up), z))
    y = cross(z, x)
    return [*x, 0, *y, 0, *z, 0, *eye, 1]


class Gltf:
    """Builds one glTF file with everything inside it. Add materials, meshes and nodes; then save."""

    def __init__(self):
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": "candil tests"}, "scene": 0, "scenes": [{"nodes": []}]}

    def add(self, section, item):
        """Append to a top-level list; returns the index."""
        self.json.setdefault(section, []).append(item)
        return len(self.json[section]) - 1

    def view(self, data):
        while len(self.bytes) % 4:
            self.bytes.append(0)
        offset = len(self.bytes)
        self.bytes += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": offset, "byteLength": len(data)})

    def floats(self, rows, kind):
        """An accessor of float vectors; min and max as POSITION wants them."""
        flat = [x for row in rows for x in row]
        accessor = {"bufferView": self.view(struct.pack("<%df" % len(flat), *flat)), "componentType": 5126,
                    "count": len(rows), "type": kind}
        if kind == "VEC3":
            rounded = [struct.unpack("<3f", struct.pack("<3f", *row)) for row in rows]
            if all(math.isfinite(x) for row in rounded for x in row):
                accessor["min"] = [min(row[i] for row in rounded) for i in range(3)]
                accessor["max"] = [max(row[i] for row in rounded) for i in range(3)]
        return self.add("accessors", accessor)

    def indices(self, values):
        return self.add("accessors", {"bufferView": self.view(struct.pack("<%dI" % len(values), *values)),
                                      "componentType": 5125, "count": len(values), "type": "SCALAR"})

    def material(self, name, albedo=(1, 1, 1), emission=(0, 0, 0), both_sides=False, texture=None, metallic=0, roughness=1,
                 specular=0, ior=None, alpha=1, cutoff=None, blend=False, unlit=False, clear=0, volume=None, coat=None, matte=0,
                 priority=0):
        """Emission is a radiance; above 1 it goes through KHR_materials_emissive_strength. `specular` is the factor of
        KHR_materials_specular: at 0, as here, and without metal the surface is a pure Lambert one, which closed forms need;
        1 is glTF's own default. `cutoff` makes it an alpha mask, `blend` blends it. `clear` is its transmission, and
        `volume` what KHR_materials_volume says of its inside; without, it is thin. `coat` is what KHR_materials_clearcoat says, `matte`
        the roughness of the diffuse part (KHR_materials_diffuse_roughness), `priority` our own candil_priority. A texture is an index or a whole textureInfo."""
        pbr = {"baseColorFactor": [*albedo, alpha], "metallicFactor": metallic, "roughnessFactor": roughness}
        if texture is not None:
            pbr["baseColorTexture"] = texture if isinstance(texture, dict) else {"index": texture}
        material = {"name": name, "pbrMetallicRoughness": pbr}
        if specular != 1:
            self.extend(material, "KHR_materials_specular", {"specularFactor": specular})
        if ior is not None:
            self.extend(material, "KHR_materials_ior", {"ior": ior})
        if unlit:
            self.extend(material, "KHR_materials_unlit", {})
        if cutoff is not None:
            material.update(alphaMode="MASK", alphaCutoff=cutoff)
        if blend:
            material["alphaMode"] = "BLEND"
        if clear:
            self.extend(material, "KHR_materials_transmission", {"transmissionFactor": clear})
        if volume is not None:
            self.extend(material, "KHR_materials_volume", volume)
        if coat is not None:
            self.extend(material, "KHR_materials_clearcoat", coat)
        if matte:
            self.extend(material, "KHR_materials_diffuse_roughness", {"diffuseRoughnessFactor": matte})
        if priority:
            material["extras"] = {"candil_priority": priority}
        strength = max(emission)
        if strength > 1:
            material["emissiveFactor"] = [e / strength for e in emission]
            self.extend(material, "KHR_materials_emissive_strength", {"emissiveStrength": strength})
        elif strength > 0:
            material["emissiveFactor"] = list(emission)
        if both_sides:
            material["doubleSided"] = True
        return self.add("materials", material)

    def extend(self, item, extension, content):
        """Put an extension into any object of the file."""
        item.setdefault("extensions", {})[extension] = content
        self.use(extension)
        return item

    def use(self, extension):
        used = self.json.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def mesh(self, positions, triangles, material=None, uvs=None, normals=None, uvs1=None, colors=None, tangents=None):
        attributes = {"POSITION": self.floats(positions, "VEC3")}
        if normals:
            attributes["NORMAL"] = self.floats(normals, "VEC3")
        if uvs:
            attributes["TEXCOORD_0"] = self.floats(uvs, "VEC2")
        if uvs1:
            attributes["TEXCOORD_1"] = self.floats(uvs1, "VEC2")
        if colors:
            attributes["COLOR_0"] = self.floats(colors, "VEC%d" % len(colors[0]))
        if tangents:
            attributes["TANGENT"] = self.floats(tangents, "VEC4")
        primitive = {"attributes": attributes, "indices": self.indices([i for t in triangles for i in t])}
        if material is not None:
            primitive["material"] = material
        return self.add("meshes", {"primitives": [primitive]})

    def node(self, root=True, **properties):
        index = self.add("nodes", properties)
        if root:
            self.json["scenes"][0]["nodes"].append(index)
        return index

    def instances(self, node, translations=None, rotations=None, scales=None):
        """EXT_mesh_gpu_instancing: the node's mesh as often as the lists are long."""
        attributes = {name: self.floats(rows, kind) for name, kind, rows in (
            ("TRANSLATION", "VEC3", translations), ("ROTATION", "VEC4", rotations), ("SCALE", "VEC3", scales)) if rows}
        self.extend(self.json["nodes"][node], "EXT_mesh_gpu_instancing", {"attributes": attributes})

    def place(self, positions, triangles, material=None, **properties):
        """A mesh under a node of its own."""
        return self.node(mesh=self.mesh(positions, triangles, material), **properties)

    def animation(self, name, *channels):
        """Channels are (node, path, times, values) with LINEAR, or with an interpolation behind."""
        animation = {"name": name, "samplers": [], "channels": []}
        for node, path, times, values, *more in channels:
            keys = self.floats([(t,) for t in times], "SCALAR")
            self.json["accessors"][keys].update(min=[min(times)], max=[max(times)])
            animation["samplers"].append({"input": keys, "output": self.floats(values, "VEC%d" % len(values[0])),
                                          "interpolation": more[0] if more else "LINEAR"})
            animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})
        return self.add("animations", animation)

    def camera(self, eye, target, vfov=40.0, name="camera", up=(0, 1, 0)):
        camera = self.add("cameras", {"type": "perspective", "name": name,
                                      "perspective": {"yfov": math.radians(vfov), "znear": 0.01}})
        return self.node(camera=camera, matrix=look_at(eye, target, up), name=name)

    def light(self, kind, intensity, eye=(0, 0, 0), target=(0, -1, 0), colour=(1, 1, 1), cone=None, up=(0, 0, 1)):
        light = {"type": kind, "intensity": intensity, "color": list(colour)}
        if kind == "spot":
            light["spot"] = {"innerConeAngle": cone[0], "outerConeAngle": cone[1]}
        self.use("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        return self.node(matrix=look_at(eye, target, up), extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def image(self, png, **sampler):
        """A texture over an embedded PNG."""
        source = self.add("images", {"bufferView": self.view(png), "mimeType": "image/png"})
        texture = {"source": source}
        if sampler:
            texture["sampler"] = self.add("samplers", sampler)
        return self.add("textures", texture)

    def text(self):
        """The whole file as JSON text, its buffer within."""
        out = dict(self.json)
        if self.bytes:
            data = base64.b64encode(bytes(self.bytes)).decode()
            out["buffers"] = [{"byteLength": len(self.bytes), "uri": "data:application/octet-stream;base64," + data}]
        return json.dumps(out, indent=1).encode()

    def glb(self):
        out = dict(self.json)
        binary = bytes(self.bytes) + bytes(-len(self.bytes) % 4)
        if binary:
            out["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(out).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        if binary:
            chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks

    def save(self, folder, name):
        return save(folder, name, self.glb() if name.endswith(".glb") else self.text())


class Obj:
    """Builds an OBJ file with its MTL."""

    def __init__(self):
        self.lines = []
        self.materials = []
        self.vertices = 0

    def material(self, name, albedo=(1, 1, 1), emission=None, *more):
        self.materials += ["newmtl " + name, "Kd %.9g %.9g %.9g" % tuple(albedo)]
        if emission:
            self.materials.append("Ke %.9g %.9g %.9g" % tuple(emission))
        self.materials += more

    def mesh(self, positions, faces, material):
        self.lines += ["v %.9g %.9g %.9g" % tuple(p) for p in positions]
        self.lines.append("usemtl " + material)
        self.lines += ["f " + " ".join(str(i + 1 + self.vertices) for i in face) for face in faces]
        self.vertices += len(positions)

    def save(self, folder, name):
        mtl = name.replace(".obj", ".mtl")
        save(folder, mtl, ("\n".join(self.materials) + "\n").encode())
        return save(folder, name, ("\n".join(["mtllib " + mtl] + self.lines) + "\n").encode())


def save(folder, name, data):
    path = os.path.join(folder, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as out:
        out.write(data)
    return path


def png(width, height, pixel):
    """An 8-bit PNG; pixel(x, y) gives (r, g, b) or (r, g, b, a)."""
    import zlib

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 6 if len(pixel(0, 0)) == 4 else 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


# ---- shapes: (positions, triangles), front faces outside unless said otherwise ----

def quad(a, b, c, d):
    """Counter-clockwise seen from the front."""
    return [list(a), list(b), list(c), list(d)], [(0, 1, 2), (0, 2, 3)]


def box(low, high, inward=False):
    x0, y0, z0 = low
    x1, y1, z1 = high
    p = [[x, y, z] for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    return p, [(a, c, b) for a, b, c in triangles] if inward else triangles


def pit_box(low, high, pit_low, pit_high):
    """A box with a pit, which is open where both end above: pit_low[1] is its floor, and pit_high[1] counts for nothing."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    (u0, v0, w0), (u1, _, w1) = pit_low, pit_high
    outside, outside_faces = box(low, high)
    inside, inside_faces = box((u0, v0, w0), (u1, y1, w1), inward=True)
    # Without their lids, between which a ring goes.
    outside_faces, inside_faces = ([t for t in faces if not all(p[i][1] == y1 for i in t)]
                                   for p, faces in ((outside, outside_faces), (inside, inside_faces)))
    outer, inner = ([[a, y1, c], [b, y1, c], [b, y1, d], [a, y1, d]] for a, b, c, d in ((x0, x1, z1, z0), (u0, u1, w1, w0)))
    ring = [t for i in range(4) for t in ((i, (i + 1) % 4, 4 + (i + 1) % 4), (i, 4 + (i + 1) % 4, 4 + i))]
    points, faces = outside + inside + outer + inner, list(outside_faces)
    faces += [tuple(i + len(outside) for i in t) for t in inside_faces]
    faces += [tuple(i + len(outside) + len(inside) for i in t) for t in ring]
    return points, faces


def icosphere(subdivisions, radius=1.0, inward=False):
    t = (1 + math.sqrt(5)) / 2
    points = [unit(p) for p in ([-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t], [0, -1, -t],
                                [0, 1, -t], [t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1])]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7),
             (9, 8, 1)]
    for _ in range(subdivisions):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                points.append(unit([points[a][i] + points[b][i] for i in range(3)]))
                middles[key] = len(points) - 1
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    scaled = [[radius * x for x in p] for p in points]
    return scaled, [(a, c, b) for a, b, c in faces] if inward else faces


def disc(sides, radius, height):
    """A flat disc at y = height whose front looks down."""
    p = [[0, height, 0]] + [[radius * math.cos(2 * math.pi * i / sides), height, radius * math.sin(2 * math.pi * i / sides)]
                            for i in range(sides)]
    return p, [(0, 1 + i, 1 + (i + 1) % sides) for i in range(sides)]


def transformed(points, matrix=((1, 0, 0), (0, 1, 0), (0, 0, 1)), scale=1.0, offset=(0, 0, 0)):
    return [[scale * sum(matrix[r][c] * p[c] for c in range(3)) + offset[r] for r in range(3)] for p in points]


def rotation(axis, degrees):
    """Rows of the rotation about an axis."""
    x, y, z = unit(axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    k = 1 - c
    return ((c + x * x * k, x * y * k - z * s, x * z * k + y * s), (y * x * k + z * s, c + y * y * k, y * z * k - x * s),
            (z * x * k - y * s, z * y * k + x * s, c + z * z * k))
