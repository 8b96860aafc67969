#!/usr/bin/env python3
"""Checks what `reality-sim dataset` writes against pycocotools, Pillow and numpy.

    python3 -m venv venv && venv/bin/pip install pycocotools pillow numpy
    cargo build --release && venv/bin/python scripts/formats/check_dataset.py target/release/reality-sim assets/walk

Give the name of a picture as a third argument to see pictures side by side there with their labels drawn over them; that of
docs/dataset.md is made by

    venv/bin/python scripts/formats/check_dataset.py target/release/reality-sim assets/walk docs/images/dataset.jpg
"""

import contextlib
import io
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from pycocotools.coco import COCO

COUNT = 6
SHOWN = (2, 4, 5)
FIELD = 100
COLORS = {1: (60, 200, 90), 2: (255, 60, 160), 3: (255, 210, 0), 4: (255, 120, 0), 5: (40, 140, 255)}


def run(program, *arguments):
    """Runs the program and returns the JSON object that it prints."""
    command = [program, *map(str, arguments), "--json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def check(name, good, what):
    print(f"{'ok  ' if good else 'FAIL'} {name}: {what}")
    if not good:
        raise SystemExit(1)


def bounds(mask):
    """Returns the box around the pixels of a mask, as COCO has it."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return [columns[0], rows[0], columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1]


def check_masks(coco, folder):
    """Run lengths decode to the pixels of the masks, boxes bound them, areas count them."""
    count = 0
    for image in coco.imgs.values():
        mask = np.array(Image.open(folder / "masks" / image["mask"]))
        instances = np.array(Image.open(folder / "instances" / image["instances"]))
        together = {number: np.zeros_like(mask, dtype=bool) for number in range(1, 6)}
        for annotation in coco.imgToAnns[image["id"]]:
            decoded = coco.annToMask(annotation).astype(bool)
            category = annotation["category_id"]
            assert annotation["bbox"] == bounds(decoded), annotation["id"]
            assert annotation["area"] == decoded.sum(), annotation["id"]
            if "instance" in annotation:
                assert (decoded == (instances == annotation["instance"])).all(), annotation["id"]
                assert 0 < annotation["visibility"] <= 1 and 0 <= annotation["truncation"] < 1, annotation["id"]
            if category == FIELD:
                assert (decoded == np.isin(mask, (1, 2))).all(), annotation["id"]
            else:
                assert not (together[category] & decoded).any(), annotation["id"]
                together[category] |= decoded
            count += 1
        for number, pixels in together.items():
            assert (pixels == (mask == number)).all(), (image["id"], number)
    check("masks", count > 4 * len(coco.imgs), f"{count} annotations are the pixels of {len(coco.imgs)} masks")


def check_keypoints(coco):
    """Keypoints are named, and are where the lines cross."""
    field = coco.cats[FIELD]
    seen = 0
    for annotation in (annotation for annotation in coco.anns.values() if annotation["category_id"] == FIELD):
        points = np.array(annotation["keypoints"]).reshape(-1, 3)
        image = coco.imgs[annotation["image_id"]]
        assert len(points) == len(field["keypoints"]) == len(field["keypoint_places_m"])
        assert annotation["num_keypoints"] == (points[:, 2] > 0).sum() == len(image["crossings"])
        inside = points[points[:, 2] > 0, :2]
        assert ((0 <= inside) & (inside <= (image["width"] - 1, image["height"] - 1))).all()
        mask_points = [crossing["pixel"] for crossing in image["crossings"]]
        assert np.allclose(inside, mask_points)
        seen += (points[:, 2] == 2).sum()
    check("keypoints", seen > 0, f"{seen} visible ones of {len(field['keypoints'])} names")


def check_depth(coco, folder):
    """Distances of the ground are those of pinhole or fisheye rays, computed here, at the middle of the picture."""
    worst = 0.0
    for image in coco.imgs.values():
        depth = np.array(Image.open(folder / "depth" / image["depth"]))
        mask = np.array(Image.open(folder / "masks" / image["mask"]))
        assert depth.dtype in (np.uint16, np.int32), depth.dtype
        pose, camera = image["pose"], image["camera"]
        # The optical axis meets the ground at height / sin(pitch), whatever yaw and roll.
        row, column = round(camera["cy"]), round(camera["cx"])
        if mask[row, column] in (1, 2) and pose["pitch_rad"] > 0.2:
            expected = pose["height_m"] / np.sin(pose["pitch_rad"])
            worst = max(worst, abs(depth[row, column] / 1000 / expected - 1))
    # Half a pixel beside the optical axis is 2 mrad, and 1 % at a depression of 0.2 rad.
    check("depth", worst < 0.02, f"the ground on the optical axis, {100 * worst:.2f} % at worst")


def drawn(coco, folder, image):
    """Returns a picture with its labels drawn over it."""
    picture = Image.open(folder / "images" / image["file_name"]).convert("RGB")
    mask = np.array(Image.open(folder / "masks" / image["mask"]))
    pixels = np.array(picture, dtype=float)
    for number, color in COLORS.items():
        pixels[mask == number] = 0.55 * pixels[mask == number] + 0.45 * np.array(color)
    picture = Image.fromarray(pixels.round().astype(np.uint8))
    pen = ImageDraw.Draw(picture)
    for line in image["lines"]:
        pen.line([tuple(pixel) for pixel in line["pixels"]], fill=(120, 0, 90))
    for crossing in image["crossings"]:
        u, v = crossing["pixel"]
        pen.ellipse((u - 4, v - 4, u + 4, v + 4), outline=(255, 0, 0) if crossing["visible"] else (0, 0, 0), width=2)
    for annotation in coco.imgToAnns[image["id"]]:
        if "instance" in annotation:
            left, top, width, height = annotation["bbox"]
            pen.rectangle((left, top, left + width - 1, top + height - 1), outline=(255, 255, 255))
            text = f"{annotation['name']} {100 * annotation['visibility']:.0f} %"
            pen.text((left + 2, max(top - 12, 0)), text, fill=(255, 255, 255))
    return picture


def draw(coco, folder, out):
    """Draws some pictures with their labels side by side."""
    pictures = [drawn(coco, folder, coco.imgs[number]) for number in SHOWN]
    width, height = pictures[0].size
    sheet = Image.new("RGB", (len(pictures) * width, height))
    for place, picture in enumerate(pictures):
        sheet.paste(picture, (place * width, 0))
    sheet.save(out, quality=85)


def main():
    program, sequence = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        database, out = folder / "walk.db", folder / "dataset"
        run(program, "build", sequence, "--out", database)
        options = ("--count", COUNT, "--seed", 3, "--depth", "--instances", "--balls", "1..2", "--robots", "1..3")
        report = run(program, "dataset", database, *options, "--out", out)
        with contextlib.redirect_stdout(io.StringIO()):
            coco = COCO(str(out / "annotations.json"))
        whole = len(coco.imgs) == report["pictures"] == COUNT and len(coco.anns) == report["annotations"]
        known = all(annotation["category_id"] in coco.cats for annotation in coco.anns.values())
        check("pycocotools", whole and known, f"{len(coco.anns)} annotations of {len(coco.cats)} categories")
        check_masks(coco, out)
        check_keypoints(coco)
        check_depth(coco, out)
        if len(sys.argv) > 3:
            draw(coco, out, Path(sys.argv[3]))
    print("all is as it should be")


if __name__ == "__main__":
    main()
