"""What a scene file with a mistake gets: one line that names file, line and column, status 1, nothing written."""

import os
import shutil
import subprocess

import command
from command import CommandTest, main

CAMERA = """[camera]
preset = "paper-plenoptic2"
"""
FLAME = """[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
SOUND = CAMERA + FLAME  # five lines
WINDOW = ("--window", "1480,1490,8,8", "--samples", "2", "--quiet")


def layer(more):
    """A flame of one layer, whose keys begin at line 5."""
    keys = {"centre": '["0 m", "0 m", "0 m"]', "semi_axes": '["9 mm", "9 mm", "9 mm"]', "temperature": '"1500 K"',
            "absorption": '"30 1/m"', **more}
    lines = [name + " = " + value for name, value in keys.items()]
    return CAMERA + '[[flames]]\nposition = ["1 m", "0 m", "0 m"]\n[[flames.layers]]\n' + "\n".join(lines) + "\n"


def surface(number, **more):
    keys = {"radius": '"300 mm"' if number == 1 else '"-300 mm"', "thickness": '"24 mm"' if number == 1 else '"0 mm"',
            "index": "1.5" if number == 1 else "1", "diameter": '"120 mm"', "stop": "false" if number == 1 else "true",
            **more}
    return "[[camera.lens.surfaces]]\n" + "".join(name + " = " + value + "\n" for name, value in keys.items())


class BadScene(CommandTest):
    def refused(self, scene, where, *mentions):
        """The place "line:column" and the texts stand in the message of `render` and of `info`."""
        self.write("a.toml", scene)
        expected = ["a.toml:" + where + ": " if where else "a.toml: ", *mentions]
        self.fails(1, "render", "a.toml", *WINDOW, mentions=expected)
        self.fails(1, "info", "a.toml", mentions=expected)
        self.assertEqual(self.files(), ["a.toml"])

    def warned(self, scene, where, *mentions):
        """Rendered all the same, with one warning."""
        self.write("a.toml", scene)
        result = self.run_command("render", "a.toml", *WINDOW)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"\Aplenoflame: warning: [^\n]+\n\Z")
        for text in ["a.toml:" + where + ": ", *mentions]:
            self.assertIn(text, result.stderr)
        self.assertEqual(self.files(), ["a.exr", "a.toml"])
        os.remove(self.path("a.exr"))

    def test_unknown_and_misspelt_keys(self):
        self.refused(SOUND + "[camerra]\n", "6:2", 'unknown key "camerra"', 'did you mean "camera"?')
        self.refused(SOUND + '[camera.lens]\nmodle = "ideal"\n', "7:1", '"modle" in camera.lens', 'mean "model"?')
        self.refused(SOUND + "[camera.sensor]\nfrequency = 3\n", "7:1", "known are columns, rows, pixel_pitch")
        self.refused(SOUND + "[[flames]]\npositon = []\n", "7:1", 'in flames[1]; did you mean "position"?')
        self.refused('[camera]\npreset = "paper-plenoptc2"\n', "2:10", 'mean "paper-plenoptic2"?')
        self.refused(CAMERA + '[[flames]]\npreset = "paper-layerd"\n', "4:10", 'mean "paper-layered"?')
        self.refused(SOUND + '[camera.focus]\nmode = "bset"\n', "7:8", "distance, paraxial, best", 'mean "best"?')

    def test_not_a_scene(self):
        self.refused("[camera\n", "1:8", "not TOML")
        self.refused("PK\x03\x04" + "a.b" * 40 + "\0\0", "", "this file holds binary data, not a scene")
        self.refused("[camera]\na = = 2\n", "2:5", "not TOML")
        self.refused('[camera]\npreset = "r12"\npreset = "r12"\n', "3:10", "cannot redefine")
        self.refused(CAMERA + '[flames]\npreset = "paper-layered"\n', "3:1", "write [[flames]]")
        self.refused(CAMERA + '[[flames]]\nposition = ["1 m", "0 m"]\n', "4:12", "2 components, but 3")
        self.write("empty.toml", "")
        self.fails(1, "render", "empty.toml", mentions=["empty.toml: camera.sensor.columns is missing",
                                                        'preset = "paper-plenoptic2"'])

    def test_units(self):
        for value, column, message in (("0.1", 9, 'a unit is missing: write it in quotes with one of m, mm'),
                                       ('"0.1"', 9, "its unit is missing (one of m, mm, um, nm, cm, km)"),
                                       ('"0.1 K"', 9, 'the unit "K" is not one of m, mm'),
                                       ('"0.1 furlong"', 9, 'the unit "furlong" is not one of'),
                                       ("true", 9, 'this is true or false, but text such as "0.1 mm" is expected')):
            self.refused(SOUND + "[camera.array]\npitch = %s\n" % value, "7:%d" % column, "camera.array.pitch", message)
        self.refused(layer({"temperature": '"1500 1/m"'}), "8:15", 'the unit "1/m" is not one of K, degC')
        self.refused(layer({"absorption": '"30 mm"'}), "9:14", 'the unit "mm" is not one of 1/m')
        self.refused(SOUND + '[develop]\nsaturation = "5000"\n', "7:14", "its unit is missing (one of W, mW")
        self.refused(CAMERA + "up = [0, 0, \"1 m\"]\n", "3:13", "takes no unit")

    def test_not_a_number(self):
        self.refused(SOUND + "[camera.array]\npitch = nan\n", "7:9", "nan is not a number")
        self.refused(SOUND + '[camera.array]\npitch = "nan mm"\n', "7:9", "does not begin with a number")
        self.refused(SOUND + "[camera.array]\nrotation = inf\n", "7:12", "camera.array.rotation")
        self.refused(CAMERA + "look_direction = [nan, 0, 0]\n", "3:19", "nan is not a number")

    def test_negative_and_absurd_values(self):
        array = SOUND + "[camera.array]\n"
        self.refused(array + 'pitch = "-0.1 mm"\n', "7:9", "-100 um is not possible here; above 0 m, at most 1 m")
        self.refused(array + 'pitch = "100 m"\n', "7:9", "100 m is not possible here")
        self.refused(array + 'pitch = "inf"\n', "7:9", "inf is not possible here")
        sensor = SOUND + "[camera.sensor]\n"
        self.refused(sensor + "columns = -5\n", "7:11", "-5 is not possible here; 1 to 65536")
        self.refused(sensor + "columns = 10.5\n", "7:11", "a whole number is expected")
        self.refused(sensor + "columns = 65536\nrows = 65536\n", "7:11", "at most 1000 million are possible")
        self.refused(sensor + 'pixel_pitch = "1 m"\n', "7:15", "1 m is not possible here")
        self.refused(layer({"temperature": '"-300 degC"'}), "8:15", "-26.85 K is not possible here; above 0 K")
        self.refused(layer({"temperature": '"1e6 K"'}), "8:15", "1000000 K is not possible here")
        self.refused(layer({"absorption": '"-1 1/m"'}), "9:14", "-1 1/m is not possible here")
        self.refused(layer({"semi_axes": '["9 mm", "0 mm", "9 mm"]'}), "7:13", "above 0 m")
        self.refused(SOUND + "[render]\nsamples = 0\n", "7:11", "0 is not possible here; 1 to 1073741824")
        self.refused(SOUND + "[develop]\nbits = 99\n", "7:8", "1 to 16")
        self.refused(SOUND + "[[flames]]\nscale = -1\n", "7:9", "-1 is not possible here; above 0")
        self.refused(SOUND + '[[channels]]\nname = "red"\nkind = "band"\nwavelength = "650 nm"\nwidth = "-3 nm"\n',
                     "10:9", "-3 nm is not possible here")
        self.warned(layer({"temperature": '"150 K"'}), "5:1", "too cold to be seen")

    def test_surfaces(self):
        def lens(first=None, second=None):
            return SOUND + surface(1, **(first or {})) + surface(2, **(second or {}))
        self.refused(lens({"diameter": '"700 mm"'}, {"diameter": '"700 mm"'}), "10:12",
                     "a sphere of radius 300 mm allows at most 600 mm")
        # Each face is 6.061 mm deep at its rim: 12.12 mm are needed.
        self.refused(lens({"thickness": '"1 mm"'}), "8:13", "surfaces 0 and 1 of the main lens overlap by 11.12 mm",
                     "make the thickness 12.12 mm or more")
        self.refused(lens({"thickness": '"-1 mm"'}), "8:13", "-1 mm is not possible here")
        self.refused(lens({"index": "-1.5"}), "9:9", "1 to 5")
        self.refused(lens({"radius": '"0 mm"'}), "7:10", "any number but 0")
        self.refused(lens({}, {"stop": "false"}), "6:1", "set stop = true on one of them")
        self.refused(lens({"stop": "true"}), "17:8", "surfaces 0 and 1 of the main lens are both the stop")
        self.refused(lens({}, {"index": "1.5"}), "15:9", "must be 1: the light leaves it into air")
        self.refused(lens({"radius": '"-300 mm"'}, {"radius": '"300 mm"'}), "6:1", "does not converge")

        # As many as the program can trace, no more.
        many = "".join(surface(2, index="1.5" if i % 2 == 0 else "1", stop="false", thickness='"1 mm"') for i in range(62))
        self.refused(SOUND + surface(1) + many + surface(2) + surface(2, stop="false"), "6:1", "camera.lens.surfaces",
                     "0 to 64 are allowed")

    def test_array(self):
        array = SOUND + "[camera.array]\n"
        self.refused(array + 'pitch = "0.09 mm"\n', "7:9", "diameter of 100 um at a pitch of 90 um",
                     "make the diameter at most the pitch")
        self.refused(array + 'diameter = "0.11 mm"\n', "7:12", "diameter of 110 um at a pitch of 100 um")
        self.refused(array + 'sensor_distance = "1 um"\n', "7:19", "the sensor would lie inside the microlenses")
        self.refused(array + 'thickness = "5 um"\n', "7:13", "overlap at its rim")
        self.refused(array + "types = []\n", "7:9", "list 1 to 3")
        self.refused(array + 'diameter = "90 um"\n[[camera.array.types]]\nname = "a"\nradius_front = "40 um"\n', "10:16",
                     "too small for the diameter of 90 um")

    def test_focus(self):
        focus = SOUND + "[camera.focus]\n"
        self.refused(focus + 'conjugate = "typ2"\n', "7:13", "it can be array, type1, type2, type3")
        self.refused(focus + 'mode = "distance"\n', "6:1", "lens_distance is missing")
        self.refused(focus + 'object_distance = "20 cm"\n', "7:19", "the object plane at 200 mm lies inside the front "
                     "focal point at 295.9 mm", "virtual")
        self.warned(focus + 'object_distance = "29.6 cm"\n', "6:1", "the image lies 938.4 m behind the lens")
        self.refused(CAMERA + "up = [1, 0, 0]\n" + FLAME, "3:6", "parallel")
        self.refused(CAMERA + "look_direction = [0, 0, 0]\n" + FLAME, "3:18", "camera.look_direction is 0, 0, 0")

    def test_flames(self):
        def at(x):
            return CAMERA + FLAME.replace('"1 m"', '"%s"' % x)
        self.refused(at("5 mm"), "5:12", 'flame "paper-layered" reaches into the camera: it extends from -5 mm to 15 mm')
        self.refused(at("-5 m"), "5:12", "lies behind the front of the camera")
        self.warned(at("0.3 m"), "5:12", "inside the front focal point at 295.9 mm", "virtual")
        flames = CAMERA + "[[flames]]\n"
        self.refused(flames, "3:1", "flame 0 has no layers", 'preset = "paper-layered"')
        self.refused(flames + 'file = "a.vdb"\n', "4:8", 'set kind = "vdb"')
        self.refused(flames + 'kind = "vdb"\n', "3:1", 'needs a file; set file = "NAME.vdb"')
        self.refused(flames + 'kind = "vdb"\nfile = "a.vdb"\ntemperature.unit = "F"\n', "6:20", "one of K, degC")
        self.refused(flames + 'preset = "paper-layered"\n[[flames.layers]]\ntemperature = "9 K"\n', "5:1",
                     "semi_axes is missing")

    def test_channels(self):
        red = SOUND + '[[channels]]\nname = "red"\nkind = "band"\n'
        self.refused(red, "6:1", 'channel "red" is a band and needs a wavelength')
        self.refused(red + 'wavelength = "650 nm"\n', "6:1", "needs a width")
        self.refused(red + 'wavelength = "650"\n', "9:14", "its unit is missing")
        self.refused(red + 'wavelength = "650 nm"\nwidth = "2 um"\n', "10:9", "a wavelength of 0")

    def test_where_nothing_can_be_written(self):
        self.write("a.toml", SOUND)
        os.mkdir(self.path("folder.exr"))
        for name, message in (("none/a.exr", "folder 'none' does not exist; create it first"),
                              ("a.toml/a.exr", "folder 'a.toml' is not a folder"),
                              ("folder.exr", "it is a folder; give a file name"),
                              ("/proc/a.exr", "folder '/proc' takes no files")):
            self.fails(1, "render", "a.toml", *WINDOW, "-o", name, mentions=["cannot write '%s': " % name, message])
        self.fails(1, "render", "a.toml", *WINDOW, "--stats", "/dev/full", mentions="not a regular file")
        self.assertEqual(self.files(), ["a.toml", "folder.exr"])

    def test_folder_without_permission(self):
        self.write("a.toml", SOUND)
        os.mkdir(self.path("locked"))
        os.chmod(self.path("locked"), 0o555)
        # root may write everywhere unless it gives its capabilities up.
        drop = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"] if os.geteuid() == 0 else []
        if drop and (not shutil.which(drop[0]) or subprocess.run([*drop, "true"], check=False).returncode != 0):
            self.skipTest("root cannot give up its capabilities here")
        for arguments, message in (
                (("render", "a.toml", *WINDOW, "-o", "locked/a.exr"), "no permission to write in folder 'locked'"),
                (("rays", "a.toml", "--pixel", "9,9", "-o", "locked/a.csv"), "no permission to write in folder 'locked'"),
                (("bench", "a.toml", "--window", "1480,1490,8,8", "-o", "locked/b"), "ermission")):
            result = subprocess.run([*drop, command.COMMAND, *arguments], cwd=self.folder, capture_output=True, text=True,
                                    check=False)
            self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
            self.assertRegex(result.stderr, r"\Aplenoflame: error: [^\n]+\n\Z")
            self.assertIn(message, result.stderr)
        self.assertEqual(os.listdir(self.path("locked")), [])

    def test_full_disk(self):
        self.write("a.toml", SOUND)
        os.mkdir(self.path("disk"))
        script = ("mount -t tmpfs -o size=64k none disk && cd disk && "
                  "for c in 'render ../a.toml --window 1400,1400,200,200 --samples 1 --quiet -o a.exr' "
                  "'rays ../a.toml --pixel 1500,1500 --rays 999 -o a.vtp' 'rays ../a.toml --pixel 1500,1500 --rays 999 -o a.csv'; "
                  "do \"$0\" $c; echo status $?; done; ls -A")
        isolated = ["unshare", "--mount"] + ([] if os.geteuid() == 0 else ["--user", "--map-root-user"])
        if not shutil.which("unshare") or subprocess.run([*isolated, "mount", "-t", "tmpfs", "none", self.path("disk")],
                                                         capture_output=True, check=False).returncode != 0:
            self.skipTest("nothing can be mounted here")
        result = subprocess.run([*isolated, "sh", "-c", script, command.COMMAND], cwd=self.folder, capture_output=True,
                                text=True, check=False)
        self.assertEqual(result.stdout, "status 1\n" * 3, result.stderr)  # and no file is left
        self.assertEqual(result.stderr, "".join(
            "plenoflame: error: cannot write '%s': the disk is full; nothing was changed\n" % name
            for name in ("a.exr", "a.vtp", "a.csv")))

    def test_missing_scene(self):
        for command in ("render", "info", "design", "bench", "rays"):
            more = {"rays": ("--pixel", "1,1", "-o", "r.csv"), "bench": ("--window", "0,0,8,8")}.get(command, ())
            self.fails(1, command, "none.toml", *more, mentions=["none.toml", "No such file"])


if __name__ == "__main__":
    main()
