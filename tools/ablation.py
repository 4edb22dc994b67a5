#!/usr/bin/env python3
"""Measures the gain of each optimisation ("device") of the sampler, and writes docs/developer/ablation.md.

Usage: ablation.py [--scenes NAME,..] [--devices NAME,..] [--samples 16,128] [--repeat 5] [--jobs 2] [--built] [--page] [--check]

Builds the command from a copy of the sources, in build/ablation, in which tools/ablation_devices.py has put a switch at each device,
and renders each scene with all devices and with one of them off, in turn and with the same seeds. Error is the relative RMSE against a
picture of many more samples and another seed. Time is processor time of one thread, without compiling the scene. Ratios are of the
shortest times, which other programs disturb least, and of root mean squares of errors. --check only tests whether the switches fit the
sources. Results that are not measured again stay on the page.
"""

import argparse
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from ablation_devices import COMMON, DEVICES  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "ablation"
COMMAND = WORK / "source" / "build" / "release" / "app" / "cli" / "plenoflame"
PAGE = ROOT / "docs" / "developer" / "ablation.md"
BEGIN, END = "<!-- figures begin -->\n", "<!-- figures end -->\n"
PATHS = ("CMakeLists.txt", "CMakePresets.json", "cmake", "core", "volumes", "app", "packaging", "tests", "tools", "docs", "examples", "LICENSE",
         "README.md", "CITATION.cff", "CHANGELOG.md")
REFERENCE_FACTOR, REFERENCE_SEED = 16, 1000000

# Name: (file, generated as, window); windows keep runs of some seconds.
FLAME = '[[flames]]\npreset = "paper-layered"\nposition = ["1 m", "0 m", "-29 mm"]\n'
R29 = 'camera.preset = "raytrix-r29"\ncamera.focus = { mode = "best", object_distance = "1 m", conjugate = "array" }\n' + FLAME
SPARSE = ('camera.preset = "paper-plenoptic2"\ncamera.focus = { mode = "best", object_distance = "4 m", conjugate = "type2" }\n'
          '[[flames]]\nkind = "vdb"\nfile = "layered.vdb"\nposition = ["4 m", "0 m", "-29 mm"]\n')
GRID = ('camera.preset = "paper-plenoptic2"\ncamera.focus = { mode = "best", object_distance = "1 m", conjugate = "type2" }\n'
        '[[flames]]\nkind = "vdb"\nfile = "layered.vdb"\nposition = ["1 m", "0 m", "-29 mm"]\n')
SCENES = {
    "paper-flame-1m": (None, "1300,1300,400,400"),
    "paper-previous-60x60": (None, None),
    "raytrix-r29": (R29, "3100,2000,400,400"),
    "candle": (None, "300,300,400,400"),
    "lenslets-30": (None, None),
    "sparse": (SPARSE, None),
    "grid": (GRID, "1300,1300,400,400"),
    "smoke": (None, "120,120,60,60"),
}
GRIDS = ["candle", "sparse", "grid"]
# The scenes in which a device has anything to do; all, where nothing is said.
WHICH = {"roulette of walks": ["smoke"], "control variate": GRIDS, "constant bricks": GRIDS, "empty bricks": GRIDS}


def switch(name):
    return f'(without("{name}"))'


def put_switches(text, what):
    return re.sub(r"WITHOUT\(([^()]*)\)", lambda m: switch(m.group(1)), text)


def edited_sources():
    """{path: text} of all files with switches. Ends the program where a switch does not fit."""
    texts, faults = {}, []
    for device, edits in [("common", COMMON)] + [(d.name, d.edits) for d in DEVICES]:
        for path, old, new in edits:
            text = texts.get(path) or (ROOT / path).read_text()
            if text.count(old) != 1:
                faults.append(f"{path}: {device}: occurs {text.count(old)} times, not once: {old.strip()}")
                continue
            texts[path] = text.replace(old, put_switches(new, device))
    for path, text in texts.items():
        if "without(" in text:
            texts[path] = text.replace("namespace plenoflame", '#include "base/ablation.h"\nnamespace plenoflame', 1) \
                if not path.endswith(".inl.h") else text
    if faults:
        sys.exit("\n".join(faults))
    texts["core/src/base/ablation.h"] = (
        "#pragma once\n#include <cstdlib>\n#include <cstring>\nnamespace plenoflame {\n"
        "inline bool without(const char* device) {\n"
        "  static const char* const off = std::getenv(\"PLENOFLAME_WITHOUT\");\n"
        "  return off != nullptr && std::strcmp(off, device) == 0;\n}\n}  // namespace plenoflame\n")
    return texts


def build(jobs):
    source = WORK / "source"
    texts = edited_sources()
    for path in subprocess.run(["git", "ls-files", "-z", "--", *PATHS], cwd=ROOT, check=True, capture_output=True,
                               text=True).stdout.split("\0"):
        if path and path not in texts and (ROOT / path).is_file():
            copy_if_other(source / path, (ROOT / path).read_bytes())
    for path, text in texts.items():
        copy_if_other(source / path, text.encode())
    folder = COMMAND.parent.parent.parent  # as deep as the usual one: ccache then knows what is the same
    with open(WORK / "build.log", "w") as log:
        for command in (["cmake", "--preset", "release", "-DPLENOFLAME_WITH_VTK=OFF", "-DPLENOFLAME_WITH_DESKTOP=OFF"],
                        ["ninja", "-C", folder, f"-j{jobs}", "plenoflame"]):
            if subprocess.run(command, cwd=source, stdout=log, stderr=log).returncode != 0:
                sys.exit(f"the build failed: see {WORK / 'build.log'}")
    return COMMAND


def copy_if_other(path, content):
    if path.is_file() and path.read_bytes() == content:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def run(command, *arguments, without=""):
    environment = dict(os.environ, PLENOFLAME_WITHOUT=without)
    done = subprocess.run([command, *map(str, arguments)], capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        sys.exit(f"{command} {' '.join(map(str, arguments))}\n{done.stderr}")
    return done.stdout


def prepare(command):
    folder = WORK / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "candle.vdb").exists():
        run(command, "flame", "candle", "-o", folder / "candle.vdb")
    if not (folder / "layered.vdb").exists():
        run(command, "flame", "layered", "-o", folder / "layered.vdb", "--voxel-size", "0.5 mm")
    for name, (text, _) in SCENES.items():
        if text is None:
            shutil.copy(ROOT / "examples" / f"{name}.toml", folder)
        else:
            (folder / f"{name}.toml").write_text(text)
    return folder


def render(command, folder, scene, samples, seed, picture, without=""):
    window = SCENES[scene][1]
    stats = picture.with_suffix(".json")
    run(command, "render", folder / f"{scene}.toml", "-o", picture, "--samples", samples, "--seed", seed, "--threads", 1, "--quiet",
        "--stats", stats, *(["--window", window] if window else []), without=without)
    return json.loads(stats.read_text())


def error_of(command, picture, reference):
    return json.loads(run(command, "compare", picture, reference, "--json"))["relative_rmse"]


def measure(command, folder, scene, samples, devices, repeat, results):
    """Adds {device: {"time", "error", "gain"}} for a scene: ratios without the device to with it."""
    names = [d.name for d in devices if scene in WHICH.get(d.name, SCENES)]
    if not names:
        return
    reference = folder / f"{scene}-{samples}.exr"
    if not reference.exists():
        render(command, folder, scene, samples * REFERENCE_FACTOR, REFERENCE_SEED, reference)
    pairs = {name: [] for name in names}
    for turn in range(repeat):
        for name in names:
            both = []
            for off in ("", name):  # in turn: the machine's speed changes slowly
                picture = folder / "picture.exr"
                figures = render(command, folder, scene, samples, turn + 1, picture, off)
                both.append((figures["seconds"], error_of(command, picture, reference), figures["peak_memory"]))
            pairs[name].append(both)
    for name, measured in pairs.items():
        time = min(off[0] for _, off in measured) / min(on[0] for on, _ in measured)
        square = sum(off[1] ** 2 for _, off in measured) / sum(on[1] ** 2 for on, _ in measured)
        results.setdefault(name, {})[f"{scene} {samples}"] = {
            "time": time, "error": math.sqrt(square), "gain": time * square,
            "memory": statistics.median(off[2] / on[2] for on, off in measured)}
        print(f"{scene:22} {samples:4} {name:30} time {time:.3f} error {math.sqrt(square):.3f} gain {time * square:.3f}", flush=True)


def lines_of(parts):
    count = 0
    for part in parts:
        if isinstance(part, str):
            count += len((ROOT / part).read_text().splitlines())
            continue
        path, first, last = part
        lines = (ROOT / path).read_text().splitlines()
        begin = next((i for i, line in enumerate(lines) if line.startswith(first) or line.strip().startswith(first)), None)
        if begin is None:
            sys.exit(f"{path}: no line begins with: {first}")
        count += next(i for i in range(begin, len(lines)) if lines[i] == last) - begin + 1
    return count


NOTHING_TO_DO = "-"
GAIN = "### Gain in error^2 x time"


def results_on(page):
    """{device: {"SCENE SAMPLES": {"gain", "time"}}} of the table that page_of() wrote."""
    results = {}
    table = page.split(f"{GAIN}\n")[1].split("\n\n")[1].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    for row in cells[2:]:
        for key, cell in zip(cells[0][1:-1], row[1:-1]):
            if found := re.fullmatch(r"([\d.]+)(?: \(([\d.]+)\))?", cell):
                results.setdefault(row[0], {})[key.replace(",", "")] = {"gain": float(found[1]), "time": float(found[2] or found[1])}
    return results


def cell_of(figures):
    if figures is None:
        return ""
    gain, time = f"{figures['gain']:.2f}", f"{figures['time']:.2f}"
    return gain if gain == time else f"{gain} ({time})"


def page_of(results):
    keys = sorted({key for of_device in results.values() for key in of_device},
                  key=lambda key: (list(SCENES).index(key.split()[0]), int(key.split()[1])))
    text = f"{GAIN}\n\nEach number is error^2 x time without the optimisation, divided by the same with it. In brackets: the ratio of the times, if it differs.\nThe last column has the lines of code.\n\n"
    text += "| optimisation | " + " | ".join(f"{key.split()[0]}, {key.split()[1]}" for key in keys) + " | lines |\n"
    text += "|---" * (len(keys) + 2) + "|\n"
    for device in DEVICES:
        of_device = results.get(device.name, {})
        cells = [NOTHING_TO_DO if key.split()[0] not in WHICH.get(device.name, SCENES) else cell_of(of_device.get(key)) for key in keys]
        text += f"| {device.name} | " + " | ".join(cells) + f" | {lines_of(device.parts) or ''} |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--devices", default=",".join(d.name for d in DEVICES))
    parser.add_argument("--samples", default="16,128")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--check", action="store_true", help="only look whether the switches fit the sources")
    parser.add_argument("--built", action="store_true", help="measure what was built last")
    parser.add_argument("--page", action="store_true", help="only write the page from what was measured")
    options = parser.parse_args()
    edited_sources()
    for device in DEVICES:
        lines_of(device.parts + device.tests)
    if options.check:
        return
    before, rest = PAGE.read_text().split(BEGIN)
    old, after = rest.split(END)
    kept = WORK / "results.json"
    results = results_on(old)
    if kept.exists():  # with more digits
        for device, cells in json.loads(kept.read_text()).items():
            results.setdefault(device, {}).update(cells)
    if not options.page:
        WORK.mkdir(parents=True, exist_ok=True)
        command = COMMAND if options.built else build(options.jobs)
        folder = prepare(command)
        chosen = [d for d in DEVICES if d.name in options.devices.split(",")]
        for scene in options.scenes.split(","):
            for samples in map(int, options.samples.split(",")):
                measure(command, folder, scene, samples, chosen, options.repeat, results)
                kept.write_text(json.dumps(results, indent=1))
    PAGE.write_text(before + BEGIN + page_of(results) + END + after)


if __name__ == "__main__":
    main()
