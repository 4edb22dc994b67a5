#!/usr/bin/env python3
"""How often a reconstruction names what is wrong with its model: the table of docs/validation.md.

    tools/name_suspects.py --trials 10 --command build/release/app/cli/plenoflame

Three small cameras look at a flame that is drawn at random. The pictures are renderings on a grid that is five times finer than
the unknowns', with the sensor's noise. One thing is wrong in each trial.
"""

import argparse
import json
import math
import pathlib
import random
import subprocess
import tempfile

CAMERA = """
[camera]
preset = "paper-plenoptic2"
position = ["{x} m", "{y} m", "0 m"]
look_direction = [{lx}, {ly}, 0]
[camera.array]
pitch = "1 mm"
diameter = "1 mm"
thickness = "0.5 mm"
sensor_distance = "2.534 mm"
[[camera.array.types]]
name = "type1"
radius_front = "2.25 mm"
radius_back = "2.25 mm"
index = 1.50
[[camera.array.types]]
name = "type2"
radius_front = "2.25 mm"
radius_back = "2.25 mm"
index = 1.59
[[camera.array.types]]
name = "type3"
radius_front = "2.25 mm"
radius_back = "2.25 mm"
index = 1.69
[camera.sensor]
columns = 100
rows = 180
pixel_pitch = "100 um"
full_well = 20000
read_noise = 5
[camera.focus]
mode = "best"
object_distance = "{focus} m"
conjugate = "type2"
[[flames]]
kind = "vdb"
name = "flame"
file = "flame.vdb"
position = ["1 m", "0 m", "-16 mm"]
[[channels]]
name = "650nm"
kind = "band"
wavelength = "650 nm"
width = "10 nm"
{windows}
"""
WINDOW = """
[[windows]]
name = "pane"
shape = "plate"
position = ["{x} m", "{y} m", "0 m"]
rotation = ["0 deg", "90 deg", "{turn} deg"]
thickness = "3 mm"
diameter = "120 mm"
{kind}
"""
GLASS = 'glass = "N-BK7"\nfresnel = true'
GREY = 'index = 1\nabsorption = "17.1 1/m"'  # takes 5 %
# Each fault and the quantities by which a report may name it.
NAMES = {"nothing": set(), "shift": {"right"}, "exposure": {"exposure"}, "focus": {"focus", "forward"},
         "block": {"block"}, "glass": {"exposure", "forward"}}


def scene(angle, wrong=None):
    look = (math.cos(angle), math.sin(angle))
    right = (look[1], -look[0])
    aside = 0.5e-3 if wrong == "shift" else 0
    place = (1 - look[0] + aside * right[0], -look[1] + aside * right[1])
    pane = {"x": place[0] + 0.3 * look[0], "y": place[1] + 0.3 * look[1], "turn": math.degrees(angle),
            "kind": GLASS if wrong == "glass" else GREY}
    return CAMERA.format(x=place[0], y=place[1], lx=look[0], ly=look[1], focus=1.01 if wrong == "focus" else 1,
                         windows=WINDOW.format(**pane) if wrong in ("glass", "exposure") else "")


def trial(command, folder, wrong, seed, threads):
    draw = random.Random(seed)

    def run(*words):
        done = subprocess.run([command, *words], cwd=folder, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)

    if draw.random() < 0.5:
        run("flame", "candle", "-o", "flame.vdb", "--set", f"height={draw.uniform(26, 32):.2f} mm", "--set",
            f"bulge={draw.uniform(5, 8):.2f} mm")
    else:
        run("flame", "turbulent", "-o", "flame.vdb", "--seed", str(seed), "--set", "height=32 mm", "--set", "base_radius=3 mm",
            "--set", "voxel_size=0.3 mm", "--set", "smallest_scale=3 mm")
    spoilt = draw.randrange(3)
    pictures, scenes = [], []
    for k, angle in enumerate((0, math.pi / 4, math.pi / 2)):
        (folder / f"camera{k}.toml").write_text(scene(angle))
        (folder / f"true{k}.toml").write_text(scene(angle, wrong if k == spoilt else None))
        run("render", f"true{k}.toml", "--samples", "256", "-o", f"light{k}.exr", "--threads", threads, "--seed", str(10 * seed + k))
        run("develop", f"light{k}.exr", "--sensor", "--noise-seed", str(10 * seed + k), "-o", f"picture{k}.exr")
        pictures.append(f"picture{k}.exr")
        scenes.append(f"camera{k}.toml")
    block = ("--size", "5 mm, 5 mm, 12 mm") if wrong == "block" else ()
    run("reconstruct", *scenes, "--images", *pictures, "--grid", "20", "--rays", "32", "--draws", "2", "--probes", "4",
        "--absorption", "scene", "--threads", threads, "-o", "found.vdb", "--report", "found.json", *block)
    found = json.loads((folder / "found.json").read_text())
    named = [(s["quantity"], s.get("camera"), s["estimate"], s["deviation"]) for s in found["suspects"] if s["named"]]
    if max(found["light_outside"], default=0) > 0.01:
        named.insert(0, ("block", None, max(found["light_outside"]), 0))
    # Three cameras do not tell which one stands aside, and the report says so.
    own = [n for n in named if n[0] in NAMES[wrong] and (n[1] in (None, scenes[spoilt]) or n[0] == "right")]
    return named, bool(own) if NAMES[wrong] else not named


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", default="plenoflame")
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--threads", default="0")
    parser.add_argument("--wrong", nargs="+", default=list(NAMES), choices=list(NAMES))
    arguments = parser.parse_args()
    command = str(pathlib.Path(arguments.command).resolve()) if "/" in arguments.command else arguments.command
    for wrong in arguments.wrong:
        good = 0
        for seed in range(1, arguments.trials + 1):
            with tempfile.TemporaryDirectory() as folder:
                named, right = trial(command, pathlib.Path(folder), wrong, seed, arguments.threads)
            good += right
            print(f"{wrong} {seed}: {'right' if right else 'WRONG'}", *(f"{q} {c or ''} {e:.3g} +- {d:.1g}" for q, c, e, d in named),
                  sep="  ", flush=True)
        print(f"{wrong}: {good} of {arguments.trials}", flush=True)


if __name__ == "__main__":
    main()
