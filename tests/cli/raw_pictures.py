"""Writes pictures as cameras do: TIFF, PNG, PGM, JPEG and numbers without header, with the standard library only.

Written from the formats' documentation, so that the tests share no code with what they test.
"""

import struct
import zlib


def _entry(order, tag, kind, values):
    """An entry of a TIFF's directory: its tag, type, count and bytes."""
    code = {3: "H", 4: "I", 2: "c"}[kind]
    data = values if kind == 2 else struct.pack(order + code * len(values), *values)
    return tag, kind, len(data) if kind == 2 else len(values), data


def _packed(order, rows, bits):
    """Rows of numbers as TIFF stores them: 8 or 16 bits, or the highest bit first without gaps."""
    out = b""
    for row in rows:
        if bits == 16:
            out += struct.pack(order + "H" * len(row), *row)
        elif bits == 8:
            out += bytes(row)
        else:
            text = "".join(format(value, f"0{bits}b") for value in row)
            text += "0" * (-len(text) % 8)
            out += bytes(int(text[i:i + 8], 2) for i in range(0, len(text), 8))
    return out


def tiff(pages, bits=16, order="<", tile=None, rows_per_strip=3, deflate=False, channels=1, planar=False,
         photometric=None, extra=()):
    """pages: each rows of numbers, channels interleaved. tile: (columns, rows)."""
    data = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, 0)
    link = 4
    for rows in pages:
        height, width = len(rows), len(rows[0]) // channels
        planes = [[row[c::channels] for row in rows] for c in range(channels)] if planar else [rows]
        step = 1 if planar else channels
        parts = []
        for plane in planes:
            if tile:
                columns, lines = tile
                for y in range(0, height, lines):
                    for x in range(0, width, columns):
                        block = [row[x * step:(x + columns) * step] for row in plane[y:y + lines]]
                        block = [row + [0] * (columns * step - len(row)) for row in block]
                        block += [[0] * (columns * step)] * (lines - len(block))
                        parts.append(_packed(order, block, bits))
            else:
                for y in range(0, height, rows_per_strip):
                    parts.append(_packed(order, plane[y:y + rows_per_strip], bits))
        offsets, sizes = [], []
        for part in parts:
            part = zlib.compress(part) if deflate else part
            offsets.append(len(data))
            sizes.append(len(part))
            data += part + b"\0" * (len(part) % 2)
        meaning = photometric if photometric is not None else (2 if channels == 3 else 1)
        entries = [_entry(order, 256, 4, [width]), _entry(order, 257, 4, [height]),
                   _entry(order, 258, 3, [bits] * channels), _entry(order, 259, 3, [8 if deflate else 1]),
                   _entry(order, 262, 3, [meaning]), _entry(order, 277, 3, [channels]),
                   _entry(order, 284, 3, [2 if planar else 1]), *(_entry(order, *each) for each in extra)]
        if tile:
            entries += [_entry(order, 322, 4, [tile[0]]), _entry(order, 323, 4, [tile[1]]),
                        _entry(order, 324, 4, offsets), _entry(order, 325, 4, sizes)]
        else:
            entries += [_entry(order, 273, 4, offsets), _entry(order, 278, 4, [rows_per_strip]),
                        _entry(order, 279, 4, sizes)]
        table = b""
        for tag, kind, count, content in sorted(entries):
            if len(content) > 4:
                place = struct.pack(order + "I", len(data))
                data += content + b"\0" * (len(content) % 2)
            else:
                place = content + b"\0" * (4 - len(content))
            table += struct.pack(order + "HHI", tag, kind, count) + place
        start = len(data)
        data = data[:link] + struct.pack(order + "I", start) + data[link + 4:]
        data += struct.pack(order + "H", len(entries)) + table
        link = len(data)
        data += struct.pack(order + "I", 0)
    return data


def png(rows, bits=16, significant=0):
    height, width = len(rows), len(rows[0])

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    lines = b"".join(b"\0" + _packed(">", [row], bits) for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) +
            (chunk(b"sBIT", bytes([significant])) if significant else b"") +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def jpeg(blocks, width, height):
    """A baseline JPEG whose pixels are exact: each block of 8 x 8 has one value (or three: red, green, blue), which is its
    first coefficient alone, undivided."""
    colours = len(blocks[0][0]) if isinstance(blocks[0][0], tuple) else 1

    def segment(marker, content):
        return bytes([0xff, marker]) + struct.pack(">H", len(content) + 2) + content
    bits, before = [], [0] * colours
    for line in blocks:
        for block in line:
            for c, value in enumerate(block if colours > 1 else (block,)):
                step = 8 * (value - 128) - before[c]
                before[c] += step
                size = abs(step).bit_length()
                # The number of bits, the bits (of a negative number less one), and the end of the block.
                bits.append(format(size, "04b"))
                if size:
                    bits.append(format(step if step > 0 else step + (1 << size) - 1, f"0{size}b"))
                bits.append("0")
    stream = "".join(bits)
    stream += "1" * (-len(stream) % 8)
    packed = bytes(int(stream[i:i + 8], 2) for i in range(0, len(stream), 8)).replace(b"\xff", b"\xff\0")
    parts = range(1, colours + 1)
    return (b"\xff\xd8" + (segment(0xee, b"Adobe" + bytes([0, 100, 0, 0, 0, 0, 0])) if colours > 1 else b"") +
            segment(0xdb, bytes([0] + 64 * [1])) +
            segment(0xc0, struct.pack(">BHHB", 8, height, width, colours) + b"".join(bytes([p, 0x11, 0]) for p in parts)) +
            segment(0xc4, bytes([0x00] + [0, 0, 0, 12] + 12 * [0] + list(range(12)))) +
            segment(0xc4, bytes([0x10] + [1] + 15 * [0] + [0])) +
            segment(0xda, bytes([colours]) + b"".join(bytes([p, 0]) for p in parts) + bytes([0, 63, 0])) +
            packed + b"\xff\xd9")


def pgm(rows, largest):
    return (f"P5\n# a camera's\n{len(rows[0])} {len(rows)}\n{largest}\n".encode() +
            _packed(">", rows, 16 if largest > 255 else 8))


def headerless(pages, order="<", bits=16):
    return b"".join(_packed(order, rows, 8 if bits <= 8 else 16) for rows in pages)
