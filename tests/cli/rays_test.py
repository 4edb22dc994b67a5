"""plenoflame rays: the three formats hold the same rays, and these make the pixel of `render`."""

import ast
import base64
import csv
import io
import json
import math
import os
import re
import struct
import xml.etree.ElementTree
import zipfile

from command import CommandTest, main
from exr import read_exr

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
PIXELS = ("--pixel", "1500,1490", "--pixel", "1506,1493")
FORMATS = {"Float64": "d", "Int64": "q", "Int32": "i"}


def read_vtp(data):
    """(counts, {section: {array name: (components, values)}}) of a .vtp, by a parser of XML: arrays are inline, in base64,
    the number of bytes in front."""
    piece = xml.etree.ElementTree.fromstring(data).find("PolyData/Piece")
    counts = {name: int(n) for name, n in piece.attrib.items()}
    sections = {}
    for section in ("PointData", "CellData", "Points", "Lines"):
        arrays = sections[section] = {}
        for array in piece.find(section):
            raw = base64.b64decode(array.text.strip(), validate=True)
            (size,) = struct.unpack_from("<Q", raw)
            assert array.get("format") == "binary" and size == len(raw) - 8, array.attrib
            code = FORMATS[array.get("type")]
            values = struct.unpack_from(f"<{size // struct.calcsize(code)}{code}", raw, 8)
            arrays[array.get("Name")] = (int(array.get("NumberOfComponents")), values)
    return counts, sections


def read_npz(data):
    """{name: (shape, values)} of a .npz."""
    kinds = {"<f4": "f", "<f8": "d", "<i4": "i", "<i2": "h", "|i1": "b"}
    arrays = {}
    archive = zipfile.ZipFile(io.BytesIO(data))
    for name in archive.namelist():
        raw = archive.read(name)
        (size,) = struct.unpack_from("<H", raw, 8)
        header = ast.literal_eval(raw[10:10 + size].decode())
        if header["descr"] in kinds:
            count = (len(raw) - 10 - size) // struct.calcsize(kinds[header["descr"]])
            arrays[name[:-4]] = header["shape"], struct.unpack_from(f"<{count}{kinds[header['descr']]}", raw, 10 + size)
    return arrays


class Rays(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", SCENE)

    def test_formats_hold_the_same(self):
        for ending in ("vtp", "csv", "json"):
            self.succeeds("rays", "a.toml", *PIXELS, "--rays", "128", "--flame-samples", "3", "-o", "r." + ending)
        self.assertEqual(self.files(), ["a.toml", "r.csv", "r.json", "r.vtp"])
        rays = json.loads(self.read("r.json"))["rays"]
        counts, vtp = read_vtp(self.read("r.vtp"))
        self.assertEqual(counts["NumberOfLines"], len(rays))
        self.assertEqual(counts["NumberOfPoints"], sum(len(ray["vertices"]) for ray in rays))
        cells = vtp["CellData"]
        for name in ("pixel", "microlens", "radiance"):
            self.assertEqual(list(cells[name][1]), [value for ray in rays for value in ray[name]], name)
        for name in ("type", "weight", "ended_at", "optical_thickness"):
            self.assertEqual(list(cells[name][1]), [ray[name] for ray in rays], name)
        names = ["reached", "vignetted", "total_internal_reflection", "missed"]
        status = [re.sub(r"\W", "_", ray["status"]) for ray in rays]
        self.assertEqual([names[s] for s in cells["status"][1]], status)
        vertices = [vertex for ray in rays for vertex in ray["vertices"]]
        self.assertEqual(list(vtp["Points"]["Points"][1]), [x for v in vertices for x in v["position"]])
        for name in ("surface", "refractive_index", "distance", "temperature", "absorption"):
            self.assertEqual(list(vtp["PointData"][name][1]), [v[name] for v in vertices], name)
        self.assertEqual(vtp["Lines"]["connectivity"][1], tuple(range(len(vertices))))
        lengths = [len(ray["vertices"]) for ray in rays]
        self.assertEqual(vtp["Lines"]["offsets"][1], tuple(sum(lengths[:i + 1]) for i in range(len(rays))))
        rows = list(csv.DictReader(io.StringIO(self.read("r.csv").decode())))
        self.assertEqual(len(rows), len(vertices))
        for row, vertex in zip(rows, vertices):
            self.assertEqual([float(row[axis]) for axis in "xyz"], vertex["position"])
            self.assertEqual(float(row["distance"]), vertex["distance"])
        self.assertEqual([float(row["radiance.total"]) for row in rows],
                         [ray["radiance"][0] for ray in rays for _ in ray["vertices"]])

    def test_info_says_what_rays_said(self):
        for ending in ("csv", "json"):
            name = "r." + ending
            figures = self.json_of("rays", "a.toml", *PIXELS, "--rays", "128", "--flame-samples", "3", "-o", name)
            self.assertGreater(figures["vignetted"], 0)
            info = self.json_of("info", name)
            self.assertEqual((info.pop("file"), info.pop("type")), (name, "ray paths"))
            flux = figures.pop("flux.total")
            self.assertGreater(flux, 0)
            self.assertLess(abs(info.pop("flux.total") / flux - 1), 1e-12)
            self.assertEqual(info, figures)
        lines = self.read("r.csv").split(b"\n")
        self.write("cut.csv", b"\n".join(lines[:7] + [lines[7][:30]]))
        self.fails(1, "info", "cut.csv", mentions=["cut.csv:8", "cells"])
        self.write("word.csv", b"\n".join([lines[0], lines[1].replace(b"reached", b"lost").replace(b"vignetted", b"lost")]))
        self.fails(1, "info", "word.csv", mentions=["word.csv:2", "'lost'"])
        self.write("few.csv", b"ray,column,row,q\n1,2,3,4\n")
        self.fails(1, "info", "few.csv", mentions=["few.csv:1", "'status'"])
        self.write("cut.json", self.read("r.json")[:-200])
        self.fails(1, "info", "cut.json", mentions=["cut.json", "not a file of ray paths"])
        self.write("other.json", b'{"channels": []}')
        self.fails(1, "info", "other.json", mentions=["other.json", "not a file of ray paths"])

    def test_make_the_pixel_of_render(self):
        figures = self.json_of("rays", "a.toml", "--pixel", "1500,1490", "--rays", "64", "--seed", "3", "-o", "r.json")
        rays = json.loads(self.read("r.json"))["rays"]
        flux = math.fsum(ray["weight"] * ray["radiance"][0] for ray in rays)
        self.assertGreater(flux, 0)
        self.assertEqual(figures["rays"], len(rays))
        self.succeeds("render", "a.toml", "--window", "1500,1490,1,1", "--samples", "64", "--seed", "3", "--quiet")
        pixel = read_exr(self.path("a.exr"))[1]["total"][0][0]
        # The image is made and kept in single precision.
        self.assertLess(abs(flux / pixel - 1), 2e-5)

    def test_windows_and_files_of_pixels(self):
        def pixels_of(name="r.json"):
            return [tuple(ray["pixel"]) for ray in json.loads(self.read(name))["rays"]]
        named = self.json_of("rays", "a.toml", "--pixel", "1500,1490", "--pixel", "1501,1490", "--pixel", "1500,1491",
                             "--pixel", "1501,1491", "--rays", "4", "-o", "r.json")
        flux = named.pop("flux.total")
        self.assertEqual(set(pixels_of()), {(1500, 1490), (1501, 1490), (1500, 1491), (1501, 1491)})
        self.write("p.csv", "column,row\n1500,1490\n 1501 , 1490  # a remark\n\n1500,1491\n1501,1491\n1500,1490\n")
        for arguments in (("--window", "1500,1490,2,2"), ("--pixels", "p.csv"),
                          ("--window", "1500,1490,2,2", "--pixels", "p.csv", "--pixel", "1501,1491"),
                          ("--window", "1500,1490,2,1", "--window", "1500,1490,2,2")):
            figures = self.json_of("rays", "a.toml", *arguments, "--rays", "4", "-o", "r.json")
            # The same rays; those of --pixel come first, which rounds the sum otherwise.
            self.assertLess(abs(figures.pop("flux.total") / flux - 1), 1e-12)
            self.assertEqual(figures, named, arguments)
        # The sum over a window is the flux of the picture.
        figures = self.json_of("rays", "a.toml", "--window", "1490,1480,12,10", "--rays", "8", "-o", "r.npz")
        self.succeeds("render", "a.toml", "--window", "1490,1480,12,10", "--samples", "8", "--quiet")
        flux = math.fsum(v for row in read_exr(self.path("a.exr"))[1]["total"] for v in row)
        self.assertLess(abs(figures["flux.total"] / flux - 1), 2e-5)
        # Rays of a microlens that the pixels have already are not there twice.
        self.succeeds("rays", "a.toml", "--pixel", "1500,1500", "--rays", "4", "-o", "r.json")
        lens = json.loads(self.read("r.json"))["rays"][0]["microlens"]
        both = self.json_of("rays", "a.toml", "--pixel", "1500,1500", "--microlens", "%d,%d" % tuple(lens), "--microlens",
                            "%d,%d" % tuple(lens), "--rays", "4", "-o", "r.json")
        text = {json.dumps(ray) for ray in json.loads(self.read("r.json"))["rays"]}
        self.assertEqual(len(text), both["rays"])

    def test_numpy_arrays_of_the_ends(self):
        self.succeeds("rays", "a.toml", *PIXELS, "--rays", "128", "-o", "r.json")
        rays = json.loads(self.read("r.json"))["rays"]
        self.succeeds("rays", "a.toml", *PIXELS, "--rays", "128", "-o", "r.npz")
        arrays = read_npz(self.read("r.npz"))

        def same(name, values):
            self.assertEqual(arrays[name][1], tuple(values), name)

        def single(values):
            values = list(values)
            return struct.unpack(f"<{len(values)}f", struct.pack(f"<{len(values)}f", *values))
        self.assertEqual(arrays["start"][0], (len(rays), 3))
        same("start", single(x for ray in rays for x in ray["vertices"][0]["position"]))
        same("end", single(x for ray in rays for x in ray["vertices"][-1]["position"]))
        fronts = [[v["position"] for v in ray["vertices"] if v["surface"] == 0] for ray in rays]
        self.assertTrue(any(fronts) and not all(fronts))
        for k, front in enumerate(fronts):
            values = arrays["front"][1][3 * k:3 * k + 3]
            self.assertEqual(values, single(front[0])) if front else self.assertTrue(all(map(math.isnan, values)))
        same("pixel", (x for ray in rays for x in ray["pixel"]))
        same("microlens", (x for ray in rays for x in ray["microlens"]))
        same("type", (ray["type"] for ray in rays))
        names = ["reached", "vignetted", "total internal reflection", "missed"]
        same("status", (names.index(ray["status"]) for ray in rays))
        same("weight", single(ray["weight"] for ray in rays))
        same("optical_thickness", single(ray["optical_thickness"] for ray in rays))
        self.assertEqual(arrays["radiance"][0], (len(rays), 1))
        same("radiance", single(ray["radiance"][0] for ray in rays))
        # All of them: "a ray in less than 64 bytes".
        self.succeeds("rays", "a.toml", "--window", "1490,1480,20,20", "--rays", "16", "-o", "r.npz")
        count = read_npz(self.read("r.npz"))["weight"][0][0]
        self.assertGreater(count, 5000)
        self.assertLess(len(self.read("r.npz")), 64 * count)

    def test_random_and_chief(self):
        figures = self.json_of("rays", "a.toml", "--random", "5", "--rays", "4", "-o", "r.json")
        self.assertGreater(figures["rays"], 0)
        self.assertLessEqual(len({tuple(ray["pixel"]) for ray in json.loads(self.read("r.json"))["rays"]}), 5)
        self.write("tiny.toml", SCENE.replace('[[flames]]', '[camera.sensor]\ncolumns = 4\nrows = 3\n[[flames]]'))
        self.succeeds("rays", "tiny.toml", "--random", "12", "--rays", "2", "-o", "r.json")
        self.assertEqual(len({tuple(ray["pixel"]) for ray in json.loads(self.read("r.json"))["rays"]}), 12)
        self.fails(2, "rays", "tiny.toml", "--random", "13", "-o", "t.json", mentions=["12 pixels", "13"])
        figures = self.json_of("rays", "a.toml", "--chief", "-o", "c.vtp")
        self.assertEqual(figures["reached"], figures["rays"])
        # Drawn for no pixel, they carry radiance, but no flux that could be 0 W.
        self.assertEqual(figures["of_images"], 0)
        said = self.succeeds("rays", "a.toml", "--chief", "-o", "c.csv")
        self.assertIn("none: without a share of a pixel", said)
        self.assertIn("none: without a share of a pixel", self.succeeds("info", "c.csv"))
        self.assertIn("carried by these rays", self.succeeds("info", "r.json"))
        self.assertEqual(self.json_of("info", "c.vtp")["lines"], figures["rays"])

    def rays_of(self, *arguments):
        self.succeeds("rays", "a.toml", *arguments, "-o", "r.json")
        return json.loads(self.read("r.json"))["rays"]

    def test_microlens(self):
        rays = self.rays_of("--microlens", "2,-1", "--rays", "4")
        self.assertEqual({tuple(ray["microlens"]) for ray in rays}, {(2, -1)})
        self.assertEqual({ray["type"] for ray in rays}, {0})  # (q - r) mod 3
        self.assertGreater(len({tuple(ray["pixel"]) for ray in rays}), 20)

    def test_point(self):
        rays = self.rays_of("--point", "1 m, 0 m, 4 mm", "--rays", "50")
        self.assertEqual(len(rays), 50)
        for ray in rays:
            self.assertEqual(ray["vertices"][0]["position"], [1, 0, 0.004])
            self.assertEqual(ray["weight"], 0)
        # The lens inverts and the readout turns back: a point above the axis lies in the picture's upper half.
        rows = [ray["pixel"][1] for ray in rays if ray["status"] == "reached" and ray["pixel"][1] >= 0]
        self.assertGreater(len(rows), 5)
        self.assertLess(sorted(rows)[len(rows) // 2], 1450)

    def test_selection(self):
        everything = self.rays_of(*PIXELS, "--rays", "256")
        kept = self.rays_of(*PIXELS, "--rays", "256", "--status", "vignetted")
        self.assertEqual(kept, [ray for ray in everything if ray["status"] == "vignetted"])
        self.assertGreater(len(kept), 0)
        kept = self.rays_of(*PIXELS, "--rays", "256", "--type", "1", "--type", "2", "--status", "reached")
        self.assertEqual(kept, [ray for ray in everything if ray["type"] in (1, 2) and ray["status"] == "reached"])
        self.assertEqual(len(self.rays_of(*PIXELS, "--rays", "32", "--most", "9")), 9)

    def test_messages(self):
        def refused(status, *arguments, mentions):
            self.fails(status, "rays", "a.toml", *arguments, mentions=mentions)
        refused(2, "-o", "r.vtp", mentions=["--pixel", "--random", "--chief"])
        self.write("p.csv", "1500,1500\n1500,x\n")
        refused(1, "--pixels", "p.csv", "-o", "r.vtp", mentions=["p.csv:2", "column,row"])
        self.write("p.csv", "1500,1500.5\n")
        refused(1, "--pixels", "p.csv", "-o", "r.vtp", mentions=["p.csv:1", "whole numbers"])
        os.remove(self.path("p.csv"))
        refused(1, "--pixels", "none.csv", "-o", "r.vtp", mentions="none.csv")
        refused(2, "--window", "1,2,3", "-o", "r.vtp", mentions="--window")
        refused(2, "--window", "2990,0,20,1", "-o", "r.vtp", mentions="3000 x 3000")
        refused(2, "--pixel", "1", "-o", "r.vtp", mentions="X,Y")
        refused(2, "--pixel", "1,-2", "-o", "r.vtp", mentions="--pixel")
        refused(2, "--pixel", "1,2x", "-o", "r.vtp", mentions="--pixel")
        refused(2, "--pixel", "3000,0", "-o", "r.vtp", mentions="3000 x 3000")
        refused(2, "--chief", "-o", "r.txt", mentions=".vtp")
        refused(2, "--chief", "--type", "3", "-o", "r.vtp", mentions=["type 3", "has 3"])
        refused(2, "--chief", "-o", "a.toml", mentions="this command reads")
        refused(2, "--pixel", "1,2", "--rays", "1", "-o", "r.vtp", mentions="--rays")
        refused(2, "--microlens", "1", "-o", "r.vtp", mentions="Q,R")
        refused(1, "--point", "-1 m,0 m,0 m", "-o", "r.vtp", mentions="in front of")
        refused(2, "--point", "1,0,0", "-o", "r.vtp", mentions="unit")
        refused(2, "--chief", "--status", "lost", "-o", "r.vtp", mentions="--status")
        refused(2, "--chief", "--most", "0", "-o", "r.vtp", mentions="--most")
        refused(1, "--chief", "-o", "none/r.vtp", mentions="none")
        self.assertEqual(self.files(), ["a.toml"])


if __name__ == "__main__":
    main()
