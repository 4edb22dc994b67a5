"""Writes uncompressed scan-line EXR files, reads these and what RLE or ZIP packed, and reads PNG files, with the standard library only.

Written from the file format's documentation, so that the tests share no code with what they test.
"""

import struct
import zlib


# Numbers of the ways to pack that the format has.
NONE, RLE, ZIP = 0, 1, 3


def _attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def _string_vector(texts):
    return b"".join(struct.pack("<i", len(t.encode())) + t.encode() for t in texts)


def write_exr(path, sensor, window, images, attributes):
    """images: {name: rows of floats}; attributes: {name: str, int, float or list of str}."""
    x, y, width, height = window
    names = sorted(images)
    channels = b"".join(n.encode() + b"\0" + struct.pack("<iBBBBii", 2, 0, 0, 0, 0, 1, 1)
                        for n in names) + b"\0"
    header = struct.pack("<ii", 20000630, 2 | 0x400)
    header += _attribute("channels", "chlist", channels)
    header += _attribute("compression", "compression", b"\0")
    header += _attribute("dataWindow", "box2i", struct.pack("<4i", x, y, x + width - 1, y + height - 1))
    header += _attribute("displayWindow", "box2i", struct.pack("<4i", 0, 0, sensor[0] - 1, sensor[1] - 1))
    header += _attribute("lineOrder", "lineOrder", b"\0")
    header += _attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += _attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    for name, value in attributes.items():
        if isinstance(value, str):
            header += _attribute(name, "string", value.encode())
        elif isinstance(value, int):
            header += _attribute(name, "int", struct.pack("<i", value))
        elif isinstance(value, float):
            header += _attribute(name, "double", struct.pack("<d", value))
        else:
            header += _attribute(name, "stringvector", _string_vector(value))
    header += b"\0"
    line_bytes = 8 + 4 * width * len(names)
    start = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header)
        file.write(struct.pack("<%dQ" % height, *(start + i * line_bytes for i in range(height))))
        for row in range(height):
            file.write(struct.pack("<ii", y + row, line_bytes - 8))
            for name in names:
                file.write(struct.pack("<%df" % width, *images[name][row]))


def write_light_field(path, flux, error=None, sensor=None, origin=(0, 0), name="total", **changes):
    """A light field with one channel. flux, error: rows of floats. changes: attributes without prefix;
    None leaves one out."""
    height, width = len(flux), len(flux[0])
    images = {name: flux}
    if error is not None:
        images[name + ".error"] = error
    attributes = {"format": 1, "channels": [name], "layers": [], "samples": 64.0, "complete": 1, "unit": "W",
                  "version": "0.1.0", "scene": "", "estimator": "backward", "seed": "1"}
    attributes.update(changes)
    write_exr(path, sensor or (width, height), (*origin, width, height), images,
              {"plenoflame." + key: value for key, value in attributes.items() if value is not None})


def read_exr(path):
    """Attributes as {name: (type, bytes)}, and images as {name: rows of floats}."""
    with open(path, "rb") as file:
        data = file.read()
    assert struct.unpack_from("<i", data)[0] == 20000630
    at = 8
    attributes = {}
    while data[at]:
        end = data.index(b"\0", at)
        name = data[at:end].decode()
        kind_end = data.index(b"\0", end + 1)
        size = struct.unpack_from("<i", data, kind_end + 1)[0]
        attributes[name] = (data[end + 1:kind_end].decode(), data[kind_end + 5:kind_end + 5 + size])
        at = kind_end + 5 + size
    packing = attributes["compression"][1][0]
    assert packing in (NONE, RLE, ZIP), "only files that are not packed, or by RLE or ZIP"
    lines = 16 if packing == ZIP else 1
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    names = [part[-1] for part in _channels(attributes["channels"][1])]
    offsets = struct.unpack_from("<%dQ" % ((height + lines - 1) // lines), data, at + 1)
    images = {name: [None] * height for name in names}
    for offset in offsets:
        first, size = struct.unpack_from("<ii", data, offset)
        first -= y0
        count = min(lines, height - first)
        block = _unpacked(data[offset + 8:offset + 8 + size], packing, 4 * width * len(names) * count)
        for row in range(count):
            for i, name in enumerate(names):
                at = 4 * width * (row * len(names) + i)
                images[name][first + row] = list(struct.unpack_from("<%df" % width, block, at))
    return attributes, images


def _unpacked(packed, packing, size):
    """A block's bytes. Blocks that would not become smaller are stored as they are."""
    if packing == NONE or len(packed) == size:
        return packed
    if packing == ZIP:
        coded = zlib.decompress(packed)
    else:
        coded, at = bytearray(), 0
        while at < len(packed):
            run = struct.unpack_from("b", packed, at)[0]
            if run < 0:
                coded += packed[at + 1:at + 1 - run]
                at += 1 - run
            else:
                coded += packed[at + 1:at + 2] * (run + 1)
                at += 2
    # Differences of neighbouring bytes, then the halves of even and odd bytes.
    plain = bytearray(coded)
    for i in range(1, len(plain)):
        plain[i] = (plain[i - 1] + plain[i] - 128) & 255
    result = bytearray(len(plain))
    half = (len(plain) + 1) // 2
    result[0::2] = plain[:half]
    result[1::2] = plain[half:]
    assert len(result) == size
    return bytes(result)


def _channels(data):
    at = 0
    while data[at]:
        end = data.index(b"\0", at)
        kind = struct.unpack_from("<i", data, end + 1)[0]
        assert kind == 2, "only FLOAT channels"
        yield (kind, data[at:end].decode())
        at = end + 1 + 16


def read_png(path):
    """(width, height, bits, channels, rows of samples, {chunk type: data}) of a PNG without interlacing."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks, packed = 8, {}, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        assert zlib.crc32(kind + body) == struct.unpack_from(">I", data, at + 8 + size)[0]
        if kind == b"IDAT":
            packed += body
        else:
            chunks.setdefault(kind.decode(), body)
        at += 12 + size
    width, height, bits, colour, _, _, interlace = struct.unpack(">IIBBBBB", chunks["IHDR"])
    assert interlace == 0 and colour in (0, 2)
    channels = 3 if colour == 2 else 1
    step = channels * bits // 8
    raw = zlib.decompress(packed)
    stride = width * step
    before = bytearray(stride)
    rows = []
    for y in range(height):
        kind = raw[y * (stride + 1)]
        line = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = line[i - step] if i >= step else 0
            b = before[i]
            c = before[i - step] if i >= step else 0
            line[i] = (line[i] + (0, a, b, (a + b) // 2, _paeth(a, b, c))[kind]) & 255
        before = line
        rows.append(list(struct.unpack(">%dH" % (width * channels), line) if bits == 16 else line))
    return width, height, bits, channels, rows, chunks


def _paeth(a, b, c):
    p = a + b - c
    return min(((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c)))[2]
