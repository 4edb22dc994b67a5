"""import: pictures in arrays of HDF5 and .mat files, in files of Lytro cameras and in folders."""

import json
import os
import struct

from command import CommandTest, main
from exr import read_exr
from import_test import camera
from raw_pictures import pgm

try:
    import h5py
    import numpy
    import scipy.io
except ImportError as missing:
    import sys
    print(f"{missing}: tools/setup.sh tests", file=sys.stderr)
    sys.exit(77)

WIDTH, HEIGHT = 32, 20


def numbers(bits=16, seed=1):
    return numpy.random.default_rng(seed).integers(0, 1 << bits, (HEIGHT, WIDTH))


def packed(rows, bits):
    """Numbers as the sensors of Lytro cameras give them: four of 10 bits in five bytes, two of 12 bits in three."""
    out = bytearray()
    flat = [int(v) for v in rows.ravel()]
    if bits == 10:
        for k in range(0, len(flat), 4):
            four = flat[k:k + 4]
            out += bytes(v >> 2 for v in four)
            out.append(sum((v & 3) << 2 * n for n, v in enumerate(four)))
    else:
        for k in range(0, len(flat), 2):
            out += (flat[k] << 12 | flat[k + 1]).to_bytes(3, "big")
    return bytes(out)


def section(kind, name, data):
    out = b"\x89LF" + kind + b"\r\n\x1a\n" + struct.pack(">II", 0, len(data))
    if kind == b"P":
        return out
    out += name.encode().ljust(80, b"\0") + data
    return out + b"\0" * (-len(out) % 16)


def metadata(bits, width=WIDTH):
    packing = {"pixelPacking": {"bitsPerPixel": bits, "endianness": "little" if bits == 10 else "big"}}
    image = {"width": width, "height": HEIGHT}
    image.update(packing if bits == 10 else {"rawDetails": packing})
    return json.dumps({"image": image}).encode()


def lytro(rows, bits, text=None):
    frame = {"frame": {"metadataRef": "sha1-m", "imageRef": "sha1-i"}}
    previews = [{"imageRef": "sha1-jpeg"}]
    table = {"frames": [frame]} if bits == 10 else {"picture": {"accelerationArray": previews, "frameArray": [frame]}}
    return (section(b"P", "", b"") + section(b"M", "sha1-t", json.dumps(table).encode()) +
            section(b"C", "sha1-i", packed(rows, bits)) + section(b"C", "sha1-m", text or metadata(bits)))


class ArrayPictures(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", camera("bits = 16\nfull_well = 1e9\n", WIDTH, HEIGHT))

    def same(self, rows, *words):
        result = self.run_command("import", *words, "--camera", "a.toml", "--unit", "DN", "-o", "field.exr")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = numpy.array(read_exr(self.path("field.exr"))[1]["650nm"])
        numpy.testing.assert_allclose(found, rows, rtol=1e-6)

    def refused(self, words, *files):
        self.fails(1, "import", *files, "--camera", "a.toml", "--unit", "DN", "-o", "field.exr", mentions=words)

    def test_hdf5(self):
        rows, other = numbers(), numbers(seed=2)
        with h5py.File(self.path("a.h5"), "w") as file:
            file["camera/frames"] = numpy.stack([rows, other]).astype("u2")
            file["camera/dark"] = other.astype("u2")
            file.create_dataset("camera/packed", data=rows.astype("f4"), chunks=(5, 8), compression="gzip")
            file["half"] = rows + 0.5
            file["views"] = numpy.zeros((2, 2, 4, 5))
        self.same((rows + other) / 2, "a.h5:/camera/frames")
        self.same(rows, "a.h5:camera/packed")
        self.refused("several arrays may be the picture; add one, FILE:ARRAY: /camera/dark (20 x 32)", "a.h5")
        self.refused("it has no array '/nothing'; it has", "a.h5:/nothing")
        self.refused("which is no count of a camera", "a.h5:/half")
        self.refused("views of a light field are no raw picture", "a.h5:/views")
        with h5py.File(self.path("b.h5"), "w") as file:
            file["only"] = numbers(8).astype("u1")
            file["time"] = 1.5
        self.same(numbers(8), "b.h5")
        with h5py.File(self.path("empty.h5"), "w"):
            pass
        self.refused("cannot read 'empty.h5': it holds no array of numbers", "empty.h5")
        self.write("text.h5", "numbers")
        self.refused("cannot read 'text.h5': it is no HDF5 file", "text.h5")
        self.write("none.h5", "")
        self.refused("cannot read 'none.h5': it is empty", "none.h5")
        # A file claims numbers that were never stored.
        for shape, chunks in [((1 << 14, 1 << 15), (64, 64)), ((1 << 50, 4, 4), (1, 4, 4))]:
            with h5py.File(self.path("claims.h5"), "w") as file:
                file.create_dataset("frames", shape, "u2", chunks=chunks)
            self.refused("/frames claims more numbers than the file can hold: damaged", "claims.h5")

    def test_mat(self):
        rows, other = numbers(), numbers(seed=2)
        content = {"raw": rows.astype("u2"), "series": numpy.stack([rows, other], 2).astype("f8"),
                   "options": {"a": 1.0}, "text": "words", "z": numpy.array([1j])}
        for packing in (False, True):
            scipy.io.savemat(self.path("a.mat"), content, do_compression=packing)
            self.same(rows, "a.mat:raw")
            self.same((rows + other) / 2, "a.mat:series")
        self.refused("several arrays may be the picture; add one, FILE:ARRAY: raw (20 x 32), series (20 x 32 x 2)", "a.mat")
        scipy.io.savemat(self.path("b.mat"), {"raw": numbers(8).astype("u1")})
        self.same(numbers(8), "b.mat")
        scipy.io.savemat(self.path("four.mat"), {"raw": numbers(8).astype("u1")}, format="4")
        self.refused("it is no .mat file of MATLAB 5 or later; save it there with '-v7'", "four.mat")
        # Damaged anywhere, a file is refused in one line.
        whole = self.read("a.mat")
        for end in [130, 140, len(whole) // 2, len(whole) - 9]:
            self.write("cut.mat", whole[:end])
            self.refused("holds no array" if end == 130 else "damaged or cut off", "cut.mat:raw")
        # Damage in one array does not keep others from being read.
        scipy.io.savemat(self.path("two.mat"), {"raw": content["raw"], "series": content["series"]}, do_compression=True)
        whole = self.read("two.mat")
        self.write("two.mat", whole[:-1] + bytes([whole[-1] ^ 255]))
        self.same(rows, "two.mat:raw")
        self.refused("damaged or cut off", "two.mat:series")
        # Grey frames in threes have a side of one colour.
        grey = numpy.stack([rows, other, rows], 2).astype("u2")
        scipy.io.savemat(self.path("grey.mat"), {"raw": grey[:, :, None]})
        self.same((2 * rows + other) / 3, "grey.mat")
        # MATLAB 7.3 is HDF5 with a block in front, rows fastest.
        with h5py.File(self.path("c.mat"), "w", userblock_size=512) as file:
            file["raw"] = numpy.ascontiguousarray(rows.T).astype("u2")
            file["raw"].attrs["MATLAB_class"] = numpy.bytes_("uint16")
        self.same(rows, "c.mat")

    def test_lytro(self):
        for bits in (10, 12):
            rows = numbers(bits, bits)
            self.write("a.lfr", lytro(rows, bits))
            self.same(rows, "a.lfr")
            whole = lytro(rows, bits)
            self.write("cut.lfr", whole[:-100])
            self.refused("is cut off", "cut.lfr")
        rows = numbers(12)
        files = [{"name": "MOD_0000.RAW", "dataRef": "sha1-r"}, {"name": "MOD_0000.TXT", "dataRef": "sha1-x"}]
        self.write("data.C.0", section(b"P", "", b"") + section(b"M", "t", json.dumps({"files": files}).encode()) +
                   section(b"C", "sha1-r", packed(rows, 12)) + section(b"C", "sha1-x", metadata(12)))
        self.same(rows, "data.C.0")
        # Pictures of several zooms and focal distances are no series.
        more = files + [{"name": "MOD_0001.RAW", "dataRef": "sha1-s"}, {"name": "MOD_0001.TXT", "dataRef": "sha1-x"}]
        other = numbers(12, seed=2)
        self.write("data.C.1", section(b"P", "", b"") + section(b"M", "t", json.dumps({"files": more}).encode()) +
                   section(b"C", "sha1-r", packed(rows, 12)) + section(b"C", "sha1-s", packed(other, 12)) +
                   section(b"C", "sha1-x", metadata(12)))
        self.same(other, "data.C.1:MOD_0001.RAW")
        self.refused("differ in zoom and focus; add one, FILE:NAME: MOD_0000.RAW, MOD_0001.RAW", "data.C.1")
        self.refused("it has no picture 'MOD_2.RAW'; it has MOD_0000.RAW, MOD_0001.RAW", "data.C.1:MOD_2.RAW")
        for text, words in [(b"{", "JSON is damaged"), (b'{"frame": 1e999}', "JSON is damaged"),
                            (b"[" * 100000 + b"]" * 100000, "JSON is nested too deeply")]:
            self.write("wrong.lfp", section(b"P", "", b"") + section(b"M", "t", text))
            self.refused(words, "wrong.lfp")
        for old, new, words in [(b'"bitsPerPixel": 12', b'"bitsPerPixel": 14', "pixels of 14 bits"),
                                (b'"width": 32', b'"width": 30', "30 pixels wide, and packed rows hold a multiple of 4"),
                                (b'"width": 32', b'"width": 4294967328', "its JSON has width 4.29497e+09, which no picture has"),
                                (b'"width": 32', b'"width": 32.5', "its JSON has width 32.5, which no picture has")]:
            self.write("other.lfp", lytro(rows, 12, metadata(12).replace(old, new)))
            self.refused(words, "other.lfp")
        # A raw file of the F01's size has no header.
        self.write("b.toml", camera("bits = 12\nfull_well = 1e9\n", 3280, 3280))
        line = numpy.arange(3280) % 4096
        self.write("b.raw", packed(line, 12) * 3280)
        result = self.run_command("import", "b.raw", "--camera", "b.toml", "--unit", "DN", "-o", "b.exr", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["largest"], 3279)

    def test_folder(self):
        rows = [numbers(16, seed) for seed in range(3)]
        os.mkdir(self.path("frames"))
        for k, own in enumerate(rows):
            self.write(f"frames/f{9 + k}.pgm", pgm(own.tolist(), 65535))
        self.same(sum(rows) / 3, "frames")
        # The same files as moments of a series.
        series = self.json_of("import", "frames", "--camera", "a.toml", "--unit", "DN", "--interval", "0.5 ms", "-o", "s.exr")
        self.assertEqual([moment["time_s"] for moment in series["light_fields"]], [0, 0.0005, 0.001])
        for moment, own in zip(series["light_fields"], rows):
            numpy.testing.assert_allclose(numpy.array(read_exr(self.path(moment["light_field"]))[1]["650nm"]), own, rtol=1e-6)
        self.fails(2, "import", "frames", "--camera", "a.toml", "--interval", "0 s", "-o", "t.exr", mentions="--interval: above 0")
        os.mkdir(self.path("empty"))
        self.refused("the folder 'empty' holds no file", "empty")


if __name__ == "__main__":
    main()
