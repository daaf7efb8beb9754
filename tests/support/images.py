"""Pictures for tests: read, write and measure them. Arrays are numpy float64, height x width x 3, row 0 at the top."""
import OpenImageIO as oiio
import numpy as np


def _open(path):
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    return source


def channels(path):
    """{channel name: height x width array}; whole-number channels (id) keep their type, others are float32."""
    source = _open(path)
    spec = source.spec()
    result = {}
    # One read a type: the library converts all channels of a read to one.
    for kind in ("float", "uint"):
        pixels = source.read_image(0, 0, 0, spec.nchannels, kind)
        if pixels is None:
            raise OSError(f"{path}: {source.geterror()}")
        pixels = np.asarray(pixels).reshape(spec.height, spec.width, spec.nchannels)
        for i, name in enumerate(spec.channelnames):
            whole = str(spec.channelformat(i)) in ("uint", "uint32")
            if whole == (kind == "uint"):
                result[name] = pixels[:, :, i].copy()
        if all(str(spec.channelformat(i)) not in ("uint", "uint32") for i in range(spec.nchannels)):
            break
    source.close()
    return result


def channel_types(path):
    """{channel name: "half", "float", "uint", "uint8"…}"""
    source = _open(path)
    spec = source.spec()
    return {name: str(spec.channelformat(i)) for i, name in enumerate(spec.channelnames)}


def rgb(path):
    """R, G and B as stored (EXR: linear radiance; PNG: sRGB codes over 255)."""
    c = channels(path)
    return np.stack([c["R"], c["G"], c["B"]], axis=2).astype(np.float64)


def metadata(path):
    """{attribute name: value}, for example "candil/technique"."""
    source = _open(path)
    return {a.name: a.value for a in source.spec().extra_attribs}


def write(path, pixels, candil=None):
    """Write height x width x 3 as float EXR, or as 8-bit codes of values 0…1 for a PNG. `candil`: of its own metadata."""
    pixels = np.ascontiguousarray(pixels, dtype=np.float32)
    height, width, count = pixels.shape
    out = oiio.ImageOutput.create(str(path))
    if out is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    kind = "float" if str(path).endswith(".exr") else "uint8"
    spec = oiio.ImageSpec(width, height, count, kind)
    for key, value in (candil or {}).items():
        spec.attribute("candil/" + key, value)
    if not out.open(str(path), spec) or not out.write_image(pixels):
        raise OSError(f"{path}: {out.geterror()}")
    out.close()


def box_down(pixels, factor):
    """Scale down by a whole factor, every pixel the mean of factor x factor."""
    height, width, count = pixels.shape
    assert height % factor == 0 and width % factor == 0, "the size must be a multiple of the factor"
    return pixels.reshape(height // factor, factor, width // factor, factor, count).mean(axis=(1, 3))


def rmse(x, reference):
    return float(np.sqrt(np.mean((x - reference) ** 2)))


def relmse(x, reference):
    return float(np.mean((x - reference) ** 2 / (reference ** 2 + 0.01)))


def blurred(x, sigma):
    """A Gaussian over pixels; the picture goes on at its other side."""
    reach = int(3 * sigma + 0.5)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    for axis in (0, 1):
        x = sum(w * np.roll(x, i - reach, axis) for i, w in enumerate(weights / weights.sum()))
    return x


def luminance(pixels):
    return pixels @ np.array([0.2126, 0.7152, 0.0722])
