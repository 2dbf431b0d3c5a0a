"""The pictures of docs/cad.md, off STEP files as Open CASCADE reads them: the patches of the elephant, and black and white
reflections in caps of each valence beside those in limit points and normals of the refined mesh.

    python tests/interop/step-pictures.py target/release/planish docs/solids

needs `pip install cadquery-ocp` (7.9 or 8.0), with which numpy and pillow come.
"""

import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from PIL import Image, ImageDraw

face_of = getattr(TopoDS, "Face_s", None) or TopoDS.Face
ROOT = Path(__file__).resolve().parents[2]


def rendered(planish, folder, mesh, output, levels=0):
    """What planish makes of a mesh under Catmull-Clark."""
    given, plan = {"mesh": mesh, "unit": "mm"}, {"preset": "catmull-clark"}
    job = {"input": given, "plan": plan, "levels": levels, "outputs": [output]}
    asked, out = folder / "job.json", folder / f"result.{output['format']}"
    asked.write_text(json.dumps(job))
    subprocess.run([planish, "render", str(asked), "--output", str(out)], check=True, stderr=subprocess.DEVNULL)
    return out


class Surface:
    """A face's B-spline: its degree, knots and control points."""

    def __init__(self, face):
        spline = BRep_Tool.Surface_s(face)
        self.degree = spline.UDegree()
        self.knots = [
            np.array([knots.Value(i) for i in range(1, knots.Length() + 1)])
            for knots in (spline.UKnotSequence(), spline.VKnotSequence())
        ]
        poles = [[spline.Pole(i, j) for j in range(1, spline.NbVPoles() + 1)] for i in range(1, spline.NbUPoles() + 1)]
        self.poles = np.array([[[p.X(), p.Y(), p.Z()] for p in row] for row in poles])

    def basis(self, knots, t):
        """Values and derivatives of the basis at parameters, by the recurrence of Cox and de Boor."""
        span = np.clip(np.searchsorted(knots, t, side="right") - 1, self.degree, len(knots) - self.degree - 2)
        values = (np.arange(len(knots) - 1)[None] == span[:, None]).astype(float)
        for d in range(1, self.degree + 1):
            before, n = values, len(knots) - 1 - d
            gaps = knots[d:] - knots[:-d]
            shares = np.divide(before, np.where(gaps > 0, gaps, 1.0)) * (gaps > 0)
            values = (t[:, None] - knots[None, :n]) * shares[:, :n] + (
                knots[None, d + 1 :] - t[:, None]
            ) * shares[:, 1:]
        return values, self.degree * (shares[:, :-1] - shares[:, 1:])

    def grid(self, n):
        """Points and unit normals at n x n parameters, the parameters from 0 to 1."""
        share = (np.arange(n) + 0.5) / n
        (u, du), (v, dv) = (self.basis(k, k[0] + (k[-1] - k[0]) * share) for k in self.knots)
        points, along, across = (np.einsum("ai,bj,ijk->abk", a, b, self.poles) for a, b in ((u, v), (du, v), (u, dv)))
        normals = np.cross(along, across)
        return points, normals / np.linalg.norm(normals, axis=2, keepdims=True), share


def surfaces(path):
    """The faces of a STEP file."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    explorer = TopExp_Explorer(reader.OneShape(), TopAbs_FACE)
    while explorer.More():
        yield Surface(face_of(explorer.Current()))
        explorer.Next()


def patches(planish, folder, out):
    """The elephant: exact patches in pale colours, caps in orange, their sides dark."""
    mesh = json.loads((ROOT / "tests/nets/animal.json").read_text())["mesh"]
    step = rendered(planish, folder, mesh, {"format": "step", "tolerance": 1e-4})
    width, height, fine = 720, 520, 2
    a, e = math.radians(58), math.radians(14)
    to_eye = np.array([math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a)])
    right = np.cross([0, 1, 0], to_eye)
    right /= np.linalg.norm(right)
    frame = np.array([right, np.cross(to_eye, right), to_eye])
    faces = list(surfaces(step))
    corners = np.concatenate([face.poles.reshape(-1, 3) for face in faces]) @ frame.T
    low, high = corners.min(0), corners.max(0)
    scale = fine * 0.94 * min(width / (high[0] - low[0]), height / (high[1] - low[1]))
    middle = (low + high) / 2
    depth = np.full(fine * fine * width * height, -np.inf)
    shown = np.full((fine * fine * width * height, 3), 255.0)
    pale = np.array([[198, 219, 239], [199, 233, 192], [218, 218, 235], [253, 224, 239], [217, 217, 217]], float)
    for number, face in enumerate(faces):
        spread = np.ptp(face.poles.reshape(-1, 3), axis=0).max() * scale
        points, normals, share = face.grid(int(2.4 * spread) + 16)
        side = np.minimum(share, 1 - share)
        color = np.array([253, 141, 60.0]) if face.degree == 5 else pale[number % len(pale)]
        # a side is drawn two subpixels wide
        steps = [np.linalg.norm(np.diff(points, axis=k), axis=2).mean() * len(share) * scale for k in (0, 1)]
        is_side = (side[:, None] * steps[0] < 1.5) | (side[None, :] * steps[1] < 1.5)
        light = 0.55 + 0.45 * np.abs(normals @ (frame.T @ np.array([-0.35, 0.5, 0.79])))
        colors = np.where(is_side[..., None], 50.0, color * light[..., None]).reshape(-1, 3)
        seen = (points.reshape(-1, 3) @ frame.T - middle) * [scale, -scale, scale]
        x, y = (np.floor(seen[:, k] + fine * size / 2).astype(int) for k, size in ((0, width), (1, height)))
        at = y * fine * width + x
        order = np.argsort(seen[:, 2], kind="stable")
        at, near, colors = at[order], seen[order, 2], colors[order]
        nearer = near > depth[at]
        depth[at[nearer]], shown[at[nearer]] = near[nearer], colors[nearer]
    image = shown.reshape(height, fine, width, fine, 3).mean((1, 3)).round().astype(np.uint8)
    picture = Image.fromarray(image).quantize(64, dither=Image.Dither.NONE)
    picture.save(out / "elephant-patches.png", optimize=True)
    print(f"{len(faces)} faces, {sum(face.degree == 5 for face in faces)} of them caps")


def star(n):
    """A closed net of quads with a vertex of valence n above and below, which no symmetry makes too smooth."""
    ring = [[math.cos(math.pi * i / n), math.sin(math.pi * i / n), 0.33 * (-1) ** i] for i in range(2 * n)]
    points = [[x, y, z + 0.12 * math.sin(2.3 * i)] for i, (x, y, z) in enumerate(ring)]
    upper = [[2 * n, i, i + 1, (i + 2) % (2 * n)] for i in range(0, 2 * n, 2)]
    lower = [[2 * n + 1, (i + 2) % (2 * n), (i + 1) % (2 * n), i] for i in range(1, 2 * n, 2)]
    return {"positions": [*points, [0.1, 0.05, 1.0], [0, 0, -1.0]], "faces": upper + lower}


def reflections(points, normals, frame, origin, radius, size):
    """Dark and light bands of a surface that is seen from above along its axis, as a picture."""
    x, y = (((points - origin) @ frame[k] / radius * (1, -1)[k] + 1) * size / 2 for k in (0, 1))
    mirrored = 2 * (normals @ frame[2])[:, None] * normals - frame[2]
    bands = np.floor((mirrored @ frame[0] + 1) * 8) % 2
    inside = (x >= 0) & (x < size) & (y >= 0) & (y < size) & ((points - origin) @ frame[2] > -radius)
    at = y[inside].astype(int) * size + x[inside].astype(int)
    count, sum_ = np.bincount(at, minlength=size**2), np.bincount(at, bands[inside], minlength=size**2)
    count, sum_ = (values.reshape(size, size).astype(float) for values in (count, sum_))
    for _ in range(12):  # pixels that no sample met take what is around them
        around = [sum(np.roll(values, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)) for values in (count, sum_)]
        count, sum_ = np.where(count > 0, (count, sum_), around)
    return Image.fromarray((40 + 200 * sum_ / np.maximum(count, 1)).round().astype(np.uint8))


def finer(mesh, n, origin, radius):
    """Points and normals of a refined mesh near a point, with n x n in each face."""
    corners = np.array(mesh["faces"])
    middles = np.array(mesh["positions"])[corners].mean(1)
    corners = corners[np.linalg.norm(middles - origin, axis=1) < radius]
    t = (np.arange(n) + 0.5) / n
    weights = np.stack([np.outer(1 - t, 1 - t), np.outer(t, 1 - t), np.outer(t, t), np.outer(1 - t, t)], -1)
    points, normals = (
        np.einsum("abk,fkd->fabd", weights, np.array(mesh[name])[corners]).reshape(-1, 3)
        for name in ("positions", "normals")
    )
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def zebra(planish, folder, out):
    """For each valence the bands of the solid, caps and what is around them, beside those of the limit."""
    valences, size = [3, 5, 6, 7, 8, 9, 10, 11, 12], 150
    picture = Image.new("L", (3 * (2 * size + 24), 3 * (size + 30)), 255)
    draw = ImageDraw.Draw(picture)
    for place, n in enumerate(valences):
        net = star(n)
        asked = {"tolerance": 1e-3, "pack": "none"}
        faces = list(surfaces(rendered(planish, folder, net, {"format": "step", **asked})))
        certificate = json.loads(rendered(planish, folder, net, {"format": "certificate", **asked}).read_text())
        pole = max((vertex for vertex in certificate["irregular"] if vertex["faces"] == n), key=lambda v: v["at"][2])
        origin = np.array(pole["at"])
        caps = [face for face in faces if face.degree == 5 and np.abs(face.poles[0, 0] - origin).max() < 1e-9]
        radius = 0.6 * max(np.linalg.norm(cap.poles[5, 5] - origin) for cap in caps)
        along, across = caps[0].poles[1, 0] - origin, caps[0].poles[0, 1] - origin
        up = np.cross(along, across) / np.linalg.norm(np.cross(along, across))
        first = np.cross([0, 1, 0], up) / np.linalg.norm(np.cross([0, 1, 0], up))
        view = (np.array([first, np.cross(up, first), up]), origin, radius, 2 * size)
        near = [face.grid(200) for face in faces if np.linalg.norm(face.poles.mean((0, 1)) - origin) < 4 * radius]
        own = [np.concatenate([grid[k].reshape(-1, 3) for grid in near]) for k in (0, 1)]
        asked = {"format": "json", "positions": "limit", "normals": "limit"}
        refined = json.loads(rendered(planish, folder, net, asked, 5).read_text())
        limit = finer(refined, 16, origin, 2.5 * radius)
        left, top = place % 3 * (2 * size + 24), place // 3 * (size + 30)
        for k, (points, normals) in enumerate((own, limit)):
            close = np.linalg.norm(points - origin, axis=1) < 2.5 * radius
            shown = reflections(points[close], normals[close], *view).resize((size, size), Image.Resampling.BOX)
            picture.paste(shown, (left + k * (size + 4), top + 20))
        # in shares of the size, as tolerances are; never less than what is certified
        share = math.ceil(pole["deviation"] / certificate["size"] * 1e5) / 1e5
        draw.text((left + 2, top + 4), f"valence {n}, within {share:.5f}", fill=0)
        draw.text((left + size + 6, top + 4), "limit surface", fill=0)
    picture.quantize(16).save(out / "zebra-caps.png", optimize=True)


def main(planish, out):
    folder = Path(out)
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        zebra(planish, Path(scratch), folder)
        patches(planish, Path(scratch), folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
