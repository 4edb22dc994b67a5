"""Pictures without a window, under a virtual display."""

import os
import struct
import time
import zlib

import numpy
from package import EXAMPLE, PackageTest, main

import plenoflame


def read_png(path):
    """8-bit RGB, not interlaced: what VTK writes. Shares nothing with it."""
    data = path.read_bytes()
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert (depth, kind) == (8, 2)
    packed, at = b"", 8
    while at < len(data):
        (size,), name = struct.unpack(">I", data[at:at + 4]), data[at + 4:at + 8]
        packed += data[at + 8:at + 8 + size] if name == b"IDAT" else b""
        at += 12 + size
    raw = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 3 * width)
    out = numpy.zeros((height, 3 * width), int)
    for row in range(height):
        line, above = raw[row, 1:].astype(int), out[row - 1] if row else numpy.zeros(3 * width, int)
        for i, value in enumerate(line):
            left = out[row, i - 3] if i > 2 else 0
            corner = above[i - 3] if i > 2 else 0
            choice = raw[row, 0]
            estimate = left + above[i] - corner
            paeth = min((left, above[i], corner), key=lambda v: abs(estimate - v))
            out[row, i] = (value + (0, left, above[i], (left + above[i]) // 2, paeth)[choice]) & 255
    return out.reshape(height, width, 3)


class Pictures(PackageTest):
    size = (600, 400)

    def drawn(self, **options):
        return plenoflame.picture(self.scene(60), size=self.size, **options)

    def test_flame_is_bright_on_dark_and_can_be_left_out(self):
        """Its coolest part, half of it, is purple (inferno at 0.4: 148, 38, 102)."""
        def warm(picture):
            red, green, blue = (picture[..., k].astype(int) for k in range(3))
            return (red > green + 40) & (blue > green) & (red > 60)

        with_flame = self.drawn(view="flame", axes=False)
        self.assertEqual(with_flame.shape, (400, 600, 3))
        self.assertGreater(warm(with_flame[:320]).mean(), 0.05)
        self.assertLess(with_flame[:320, :60].max(), 20)  # beside it nothing shines
        self.assertLess(warm(self.drawn(view="camera", flame=False, axes=False)).mean(), 0.001)

    def test_rays_have_the_colours_of_their_types(self):
        scene = self.scene(60)
        for number, colour in enumerate(((0, 114, 178), (230, 159, 0), (0, 158, 115))):
            rays = scene.rays(random=30, rays=4, lens_type=number)
            self.assertGreater(len(rays), 5)
            picture = plenoflame.picture(scene, view="camera", rays=rays, size=self.size, axes=False)
            near = numpy.abs(picture.astype(int) - colour).max(axis=2) < 40
            self.assertGreater(near.sum(), 50, number)

    def test_close_up_shows_microlenses_at_a_metre(self):
        """A microlens of the paper is 0.1 mm wide, the flame 1 m away."""
        scene = plenoflame.Scene(EXAMPLE.parent / "paper-flame-1m.toml")
        picture = plenoflame.picture(scene, view="array", size=self.size, axes=False)
        # Lens colours, of all three types: blue, orange, green tints.
        for colour in ((0, 114, 178), (230, 159, 0), (0, 158, 115)):
            tint = numpy.array(colour) - numpy.mean(colour)
            values = picture.reshape(-1, 3).astype(float)
            own = values - values.mean(axis=1, keepdims=True)
            strength = own @ tint / numpy.linalg.norm(tint)
            length = numpy.linalg.norm(own, axis=1)
            self.assertGreater(((strength > 0.9 * length) & (length > 15)).mean(), 0.005)

    def test_solid_surfaces_are_grey_as_they_reflect(self):
        """A ball in the middle, first dark, then bright; without surfaces the camera is all there is."""
        text = EXAMPLE.read_text().replace("[[flames]]", """[[surfaces]]
name = "ball"
shape = "sphere"
position = ["1 m", "0 m", "0 m"]
radius = "0.1 m"
material.reflectivity = %g

[[flames]]""", 1)
        middles = []
        for reflectivity in (0.05, 0.8):
            scene = plenoflame.Scene(text=text % reflectivity)
            picture = plenoflame.picture(scene, view="flame", flame=False, size=self.size, axes=False)
            middle = picture[150:250, 250:350].reshape(-1, 3).astype(int)
            self.assertLess(numpy.ptp(middle, axis=1).max(), 3)  # grey
            middles.append(middle.mean())
        self.assertGreater(middles[1], middles[0] + 60)
        without = plenoflame.picture(scene, view="flame", flame=False, surfaces=False, size=self.size, axes=False)
        self.assertGreater(numpy.ptp(without.reshape(-1, 3).astype(int), axis=1).max(), 20)  # coloured: the camera

    def test_light_field_is_on_the_sensor(self):
        scene = self.scene(60)
        field = scene.render(samples=4)
        field.flux[:] = 0
        dark = plenoflame.picture(scene, view="array", light_field=field, size=self.size, axes=False)
        field.flux[:] = 1
        bright = plenoflame.picture(scene, view="array", light_field=field, size=self.size, axes=False)
        self.assertGreater(bright.astype(int).sum(), 1.05 * dark.astype(int).sum())

    def test_command_draws_the_whole_scene(self):
        self.scene(60).save(self.folder / "a.toml")
        start = time.monotonic()
        self.command("picture", "a.toml", "--pixel", "30,30", "--size", "300x200", "-o", "p.png")
        print(f"command: {time.monotonic() - start:.2f} s")
        picture = read_png(self.folder / "p.png")
        self.assertEqual(picture.shape, (200, 300, 3))
        self.assertGreater(len(numpy.unique(picture.reshape(-1, 3), axis=0)), 200)

    def test_bad_input(self):
        with self.assertRaisesRegex(plenoflame.Error, "view 'moon'"):
            self.drawn(view="moon")
        with self.assertRaisesRegex(plenoflame.Error, "coloured by 'mood'"):
            self.drawn(colour_by="mood")
        self.scene(60).save(self.folder / "a.toml")
        self.assertIn("outside of the sensor",
                      self.command("picture", "a.toml", "--pixel", "70,3", "-o", "p.png", status=1))
        self.assertIn("must end in .png", self.command("picture", "a.toml", "-o", "p.jpg", status=2))
        self.assertIn("missing.exr",
                      self.command("picture", "a.toml", "--image", "missing.exr", "-o", "p.png", status=1))


class NoDisplay(PackageTest):
    def test_message_names_xvfb_run(self):
        self.scene(60).save(self.folder / "a.toml")
        before = os.environ.pop("DISPLAY", None)
        try:
            self.assertIn("xvfb-run", self.command("picture", "a.toml", "-o", "p.png", status=1))
            with self.assertRaisesRegex(plenoflame.Error, "xvfb-run"):
                plenoflame.picture(self.scene(60), self.folder / "p.png")
            os.environ["DISPLAY"] = ":4711"
            self.assertIn("':4711' cannot be opened",
                          self.command("picture", "a.toml", "-o", "p.png", status=1))
        finally:
            os.environ.pop("DISPLAY", None)
            if before is not None:
                os.environ["DISPLAY"] = before
        self.assertFalse((self.folder / "p.png").exists())


if __name__ == "__main__":
    main()
