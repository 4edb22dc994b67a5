"""Renders one example scene as its own header comment says, at reduced size, and checks that light arrives.

    render_example.py PLENOFLAME SCENE.toml

The whole sensor with two samples would take long for the large cameras: the middle of it is rendered. The error that a
run states must fall when it takes more samples, and two runs with different seeds must agree within what they state.
"""
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile


def run(*arguments, cwd):
    result = subprocess.run(arguments, cwd=cwd, capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}: status {result.returncode}\n{result.stderr}")
    return result.stdout


def names_of(text):
    """Names of a scene's flames without .vdb; those of a series stand in its comment."""
    for name in re.findall(r'file = "([^"]+)\.vdb"', text):
        if "#" in name:
            digits = re.sub("#+", lambda run: rf"\d{{{len(run[0])}}}", name)
            yield from re.findall(rf"-o examples/({digits})\.vdb", text)
        else:
            yield name


def main():
    plenoflame, scene = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(scene, folder)
        text = scene.read_text()
        for table in re.findall(r'time_table = "([^"]+)"', text):
            shutil.copy(scene.parent / table, folder)
        for name in names_of(text):
            # As its comment makes it: a candle with lines is a candle, too.
            said = re.search(rf"plenoflame flame (.*) -o examples/{name}\.vdb", text)
            flame = shlex.split(said[1]) if said else [name]
            run(plenoflame, "flame", *flame, "-o", f"{name}.vdb", "--voxel-size", "1 mm", cwd=folder)
        info = json.loads(run(plenoflame, "info", scene.name, "--json", cwd=folder))
        for camera in info.get("cameras", [info]):
            check_camera(plenoflame, folder, scene.name, camera)


def check_camera(plenoflame, folder, scene, camera):
    columns, rows = camera["sensor"]
    chosen = ["--camera", camera["name"]] if "name" in camera else []
    width, height = min(columns, 100), min(rows, 100)
    window = f"{(columns - width) // 2},{(rows - height) // 2},{width},{height}"
    errors = []
    for samples, seed in ((16, 1), (256, 1), (256, 2)):
        output = run(plenoflame, "render", scene, *chosen, "-o", f"{samples}-{seed}.exr", "--samples", str(samples),
                     "--seed", str(seed), "--window", window, "--json", cwd=folder)
        figures = json.loads(output)
        if not figures["flux"] > 0:
            sys.exit("no light in the middle of the sensor")
        errors.append(figures["relative_error"])
    if not errors[1] < 0.6 * errors[0]:
        sys.exit(f"16 times the samples took the error from {errors[0]} to {errors[1]} only")
    compared = json.loads(run(plenoflame, "compare", "256-1.exr", "256-2.exr", "--json", cwd=folder))
    expected = (errors[1] ** 2 + errors[2] ** 2) ** 0.5
    if not 0.5 * expected < compared["relative_rmse"] < 2 * expected:
        sys.exit(f"two seeds differ by {compared['relative_rmse']}, their stated errors say {expected}")


main()
