"""Renders with edits over the wire, as arrays. Node, material and light edits are given as protobuf messages."""
import os

import images
import wire
from render import skip
from wire import pb


def vec(x, y, z):
    return pb.Vec3(x=x, y=y, z=z)


def node(name, translation=None, rotation=None, scale=None):
    edit = pb.NodeEdit(name=name)
    if translation is not None:
        edit.translation.CopyFrom(vec(*translation))
    if rotation is not None:
        edit.rotation.CopyFrom(pb.Quaternion(**dict(zip("xyzw", rotation))))
    if scale is not None:
        edit.scale.CopyFrom(vec(*scale))
    return edit


def point(position, intensity):
    return pb.Light(kind=pb.LIGHT_KIND_POINT, position=vec(*position), intensity=vec(*([intensity] * 3)))


class Refused(Exception):
    def __init__(self, error):
        super().__init__(error.message)
        self.name = error.name


class Stage:
    """One daemon, one connection, a folder for scenes and pictures."""

    def __enter__(self):
        self.daemon = wire.Daemon().__enter__()
        self.connection = self.daemon.connect()
        self.folder = self.daemon.folder
        self.loaded = {}
        return self

    def __exit__(self, *_):
        self.connection.close()
        self.daemon.stop()

    def load(self, path):
        name = os.path.basename(path)
        self.loaded[name] = self.connection.load(name, self.folder, name)
        return name

    def request(self, scene, spp=4, size=48, depth=3, camera=None, **edits):
        r = pb.Render(scene=scene, width=size, height=size, samples=spp, format=pb.FORMAT_EXR_FLOAT,
                      options=[pb.Option(name="pt.depth", value=str(depth))], aovs=1 | 8)
        if camera:
            r.camera.CopyFrom(camera)
        if edits:
            r.edits.CopyFrom(pb.Edits(**edits))
        return r

    def picture(self, data):
        path = os.path.join(self.folder, "picture.exr")
        with open(path, "wb") as file:
            file.write(data)
        return images.rgb(path), images.channels(path)

    def finish(self, request):
        """(radiance, channels, messages) of a render that is under way, one a picture for a sweep."""
        replies = self.connection.follow(request)
        if replies[-1].kind == wire.ERROR:
            error = replies[-1].body
            if error.name == "device":
                self.__exit__()
                skip(error.message)
            raise Refused(error)
        found = [(*self.picture(bytes(data)), replies) for _, data in wire.images(replies)]
        return found if len(found) > 1 else found[0]

    def submit(self, scene, **more):
        return self.connection.send(wire.RENDER, self.request(scene, **more))

    def render(self, scene, **more):
        return self.finish(self.submit(scene, **more))

    def radiance(self, scene, **more):
        return self.render(scene, **more)[0]
