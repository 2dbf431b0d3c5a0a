#!/usr/bin/env python3
"""Compares SVG and PDF drawings, painted by librsvg and poppler, with planish's own PNG of the same drawing.

Usage: drawings.py PLANISH [JOB.json ...]

Needs rsvg-convert, pdftoppm and the font DejaVu Sans. Prints for each drawing the mean difference of a colour (0 to
255) and the share of pixels of which one differs by more than 96, and fails beyond the bounds below. PNG of meshes
show surfaces, so of meshes SVG and PDF are compared with each other.
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

# Painters place edges of lines and letters differently by up to half a pixel, which changes the colours of pixels along
# them: half of these bounds fails for drawings full of thin lines, twice of them passes a line that is missing.
MEAN, FAR, SHARE = 4.0, 96, 0.012
JOBS = pathlib.Path(__file__).resolve().parents[2] / "api" / "examples" / "jobs"


def pixels(path):
    """Width, height and rows of red, green and blue of a PNG file of 8 bits, over white."""
    data = path.read_bytes()
    at, packed, head = 8, b"", None
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", data[at + 8 : at + 21])
        if kind == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    width, height, _, kind = head[:4]
    n = {0: 1, 2: 3, 4: 2, 6: 4}[kind]
    raw, rows, last = zlib.decompress(packed), [], bytearray(width * n)
    for y in range(height):
        how, row = raw[y * (width * n + 1)], bytearray(raw[y * (width * n + 1) + 1 : (y + 1) * (width * n + 1)])
        for i in range(len(row)):
            left, up, corner = (row[i - n] if i >= n else 0), last[i], (last[i - n] if i >= n else 0)
            near = min((left, up, corner), key=lambda x: abs(left + up - corner - x))
            row[i] = (row[i] + [0, left, up, (left + up) // 2, near][how]) % 256
        rows.append(row)
        last = row
    def color(row, x):
        p = row[x * n : x * n + n]
        gray = n < 3
        rgb = [p[0]] * 3 if gray else list(p[:3])
        alpha = p[-1] if n in (2, 4) else 255
        return [(c * alpha + 255 * (255 - alpha)) // 255 for c in rgb]
    return [[color(row, x) for x in range(width)] for row in rows]


def compare(name, a, b):
    """Prints how much two pictures differ, and whether that is too much."""
    height, width = min(len(a), len(b)), min(len(a[0]), len(b[0]))
    total = far = 0
    for y in range(height):
        for x in range(width):
            apart = [abs(p - q) for p, q in zip(a[y][x], b[y][x])]
            total += sum(apart)
            far += max(apart) > FAR
    mean, share = total / (3 * width * height), far / (width * height)
    fine = mean <= MEAN and share <= SHARE and abs(len(a) - len(b)) <= 1 and abs(len(a[0]) - len(b[0])) <= 1
    print(f"{'ok  ' if fine else 'FAIL'} {name}: mean {mean:.2f}, {100 * share:.2f} % differ by more than {FAR}")
    return fine


def main():
    planish, jobs = sys.argv[1], [pathlib.Path(job) for job in sys.argv[2:]] or sorted(JOBS.glob("drawing-*-svg.json"))
    fine = True
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for path in jobs:
            job = json.loads(path.read_text())
            drawn = {}
            for kind in ["svg", "pdf"] + ([] if "mesh" in job["input"] or "blob" in job["input"] else ["png"]):
                output = {**job["outputs"][0], "format": kind}
                if kind == "png":
                    output.pop("text", None)
                (folder / "job.json").write_text(json.dumps({**job, "outputs": [output]}))
                file = folder / f"drawing.{kind}"
                subprocess.run([planish, "render", "-q", folder / "job.json", "-o", file], check=True)
                picture = folder / f"{kind}.png"
                if kind == "svg":
                    subprocess.run(["rsvg-convert", file, "-o", picture], check=True)
                elif kind == "pdf":
                    subprocess.run(["pdftoppm", "-png", "-r", "96", "-singlefile", file, folder / "pdf"], check=True)
                else:
                    picture = file
                drawn[kind] = pixels(picture)
            ours = drawn.get("png", drawn["svg"])
            for kind in drawn:
                if drawn[kind] is not ours:
                    fine &= compare(f"{path.stem} {kind}", ours, drawn[kind])
    sys.exit(not fine)


main()
