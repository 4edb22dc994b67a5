#!/usr/bin/python3
"""Makes docs/images/overview.png, the README's figure: a turbulent flame, and what a camera like the Raytrix R29 records of it.

    tools/make_overview.py [FOLDER]     the flame and the light fields stay in FOLDER (out/poster) and are used again

Colours follow from the channels X, Y and Z of examples/python/turbulent.toml: CIE 1931 to linear sRGB, with a soft end of the scale as
on film and a tenth of the plain camera's light spread by the bloom. The flame has voxels of 0.5 mm: 57 million of them, which take
4 GB of memory for a minute. Needs what drawing.py says.
"""

import csv
import math
import shutil

from drawing import ROOT, run, turbulent_flame, working_folder

import numpy
import plenoflame
from PIL import Image, ImageColor, ImageDraw, ImageFont
from scipy import ndimage

EXPOSURE = 100e3    # [cd/m^2] becomes 80 % of the white of sRGB
VOXEL_SIZE = 0.5    # [mm] of the flame
TO_RGB = numpy.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
BLOOM = ((0.05, 6), (0.03, 20), (0.02, 60))  # share of the light, standard deviation in pixels
HEIGHT, GAP, SIDE = 1036, 8, 514             # pixels of the figure
SHOWN = (0.12, 0.87)                         # of the width of the plain picture, where the flame is
RAW = (6576, 4384)                           # columns and rows of the R29
DETAIL = (990, 2970, 249)                  # left, top and side of the enlarged part of the upright raw picture
CLOSE = (1010, 3068, 83)
TYPES = {"far": "#56b4e9", "middle": "#ffffff", "near": "#00d19a"}
FONT = "DejaVuSans.ttf"
SIZE = 24
SHADES = 220      # of the picture, beside TYPES, so that its file stays below 400 kB


def rendered(folder):
    """Paths of the plain picture, the raw picture, its detail and the list of micro-images; made where missing."""
    scene = folder / "turbulent.toml"
    shutil.copy(ROOT / "examples/python/turbulent.toml", scene)
    turbulent_flame(folder, VOXEL_SIZE)
    left, top, side = DETAIL
    window = f"{RAW[0] - top - side},{left},{side},{side}"
    for name, options in (("plain", ("--camera", "plain", "--samples", "8")),
                          ("raw", ("--camera", "r29", "--samples", "1")),
                          ("detail", ("--camera", "r29", "--samples", "48", "--window", window))):
        if not (folder / f"{name}.exr").exists():
            run("render", scene, *options, "--quiet", "-o", folder / f"{name}.exr")
    run("truth", folder / "detail.exr", "-o", folder / "micro-images.csv")
    return folder / "plain.exr", folder / "raw.exr", folder / "detail.exr", folder / "micro-images.csv"


def linear(path, pitch, f_number):
    """Linear sRGB of a light field: EXPOSURE is 1. Pixels of this pitch [m] see an aperture of this f-number."""
    field = plenoflame.read_light_field(path)
    xyz = numpy.stack([field[channel] for channel in "XYZ"], -1)
    etendue = math.pi / (4 * f_number ** 2) * pitch ** 2
    return numpy.clip(683 * xyz / etendue / EXPOSURE @ TO_RGB.T, 0, None)


def encoded(light):
    """sRGB as the desktop application's *As seen*: light beyond the exposure loses its colour by and by and ends at white."""
    luminance = light @ numpy.array([[0.2126], [0.7152], [0.0722]])
    light = light + 0.55 * (1 - numpy.exp(-luminance ** 2)) * (luminance - light)
    light = 1 - numpy.exp(-1.6 * numpy.maximum(light, 0))
    curve = numpy.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return Image.fromarray(numpy.round(255 * curve).astype(numpy.uint8))


def label(image, text, bar=0, length=""):
    """Writes what a panel shows at its top left, and a bar of this many pixels at its bottom left."""
    draw, font = ImageDraw.Draw(image), ImageFont.truetype(FONT, SIZE)
    draw.rectangle((0, 0, draw.textlength(text, font=font) + 36, 2 * SIZE), fill="black")
    draw.text((18, SIZE), text, font=font, fill="white", anchor="lm")
    if not bar:
        return image
    y = image.height - SIZE
    draw.rectangle((0, y - SIZE, bar + draw.textlength(length, font=font) + 50, image.height), fill="black")
    draw.line((18, y, 18 + bar, y), fill="white", width=4)
    draw.text((18 + bar + 14, y), length, font=font, fill="white", anchor="lm")
    return image


def plain_picture(path):
    light = linear(path, 22.2e-6, 1000 / 9 / 2)
    glow = sum(share * ndimage.gaussian_filter(light, (width, width, 0)) for share, width in BLOOM)
    light = (1 - sum(share for share, _ in BLOOM)) * light + glow
    picture = encoded(light)
    scale = HEIGHT / picture.height
    picture = picture.resize((round(picture.width * scale), HEIGHT), Image.LANCZOS)
    picture = picture.crop((round(SHOWN[0] * picture.width), 0, round(SHOWN[1] * picture.width), HEIGHT))
    return label(picture, "what the eye sees", 0.02 / 9 / 22.2e-6 * scale, "20 mm")


def raw_picture(path, width):
    """The raw picture at the scale of the plain one, upright, with a frame around the detail."""
    light = numpy.rot90(linear(path, 5.5e-6, 1200 / 165))
    scale = HEIGHT / (1450 * 22.2e-6) * 5.5e-6
    channels = [Image.fromarray(numpy.ascontiguousarray(light[..., k], numpy.float32)) for k in range(3)]
    size = (round(RAW[1] * scale), round(RAW[0] * scale))
    small = encoded(numpy.stack([numpy.asarray(c.resize(size, Image.BOX)) for c in channels], -1))
    x, y = round(size[0] / 2 - width * (0.5 - SHOWN[0]) / (SHOWN[1] - SHOWN[0])), (size[1] - HEIGHT) // 2
    picture = small.crop((x, y, x + width, y + HEIGHT))
    left, top, side = DETAIL
    box = (left * scale - x, top * scale - y, (left + side) * scale - x, (top + side) * scale - y)
    ImageDraw.Draw(picture).rectangle(box, outline="white", width=2)
    return label(picture, "what the camera sees", 0.002 / 5.5e-6 * scale, "2 mm")


def detail_picture(light, part):
    left, top, side = (part[0] - DETAIL[0], part[1] - DETAIL[1], part[2])
    picture = encoded(light[top:top + side, left:left + side])
    return picture.resize((SIDE, SIDE), Image.NEAREST)


def mark_types(picture, lenses):
    """A ring around each micro-image of the close view, in the colour of its type."""
    draw, font, scale = ImageDraw.Draw(picture), ImageFont.truetype(FONT, SIZE), SIDE / CLOSE[2]
    with open(lenses) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for row in rows:
        x = (float(row["row"]) - CLOSE[0]) * scale
        y = (RAW[0] - float(row["column"]) - CLOSE[1]) * scale
        r = float(row["radius"]) * scale - 2
        if -r < x < SIDE + r and -r < y < SIDE + r:
            draw.ellipse((x - r, y - r, x + r, y + r), outline=TYPES[row["type"]], width=3)
    draw.rectangle((0, SIDE - 2 * SIZE, draw.textlength("  ".join(TYPES), font=font) + 60, SIDE), fill="black")
    x = 18
    for name, colour in TYPES.items():
        draw.text((x, SIDE - SIZE), name, font=font, fill=colour, anchor="lm")
        x += draw.textlength(name, font=font) + 24


def main():
    plain, raw, detail, lenses = rendered(working_folder("poster"))
    flame = plain_picture(plain)
    sensor = raw_picture(raw, flame.width)
    light = numpy.rot90(linear(detail, 5.5e-6, 1200 / 165))
    wide = detail_picture(light, DETAIL)
    scale = SIDE / DETAIL[2]
    ImageDraw.Draw(wide).rectangle([(a - b) * scale for a, b in ((CLOSE[0], DETAIL[0]), (CLOSE[1], DETAIL[1]))] +
                                   [(a + CLOSE[2] - b) * scale for a, b in ((CLOSE[0], DETAIL[0]), (CLOSE[1], DETAIL[1]))],
                                   outline="white", width=2)
    label(wide, "micro-images", 0.0005 / 5.5e-6 * scale, "0.5 mm")
    close = detail_picture(light, CLOSE)
    mark_types(close, lenses)
    label(close, "three types of microlenses")
    figure = Image.new("RGB", (2 * flame.width + SIDE + 2 * GAP, HEIGHT), "#3c3c3c")
    figure.paste(flame, (0, 0))
    figure.paste(sensor, (flame.width + GAP, 0))
    figure.paste(wide, (2 * (flame.width + GAP), 0))
    figure.paste(close, (2 * (flame.width + GAP), HEIGHT - SIDE))
    target = ROOT / "docs/images/overview.png"
    palette = Image.new("P", (1, 1))
    palette.putpalette(figure.quantize(SHADES).getpalette()[:3 * SHADES] + [c for name in TYPES.values() for c in ImageColor.getrgb(name)])
    figure.quantize(palette=palette, dither=Image.Dither.NONE).save(target, optimize=True)
    print(target)


if __name__ == "__main__":
    main()
