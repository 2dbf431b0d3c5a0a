"""Control meshes that planish writes as USD, refined by OpenSubdiv as their tags say: the positions are planish's.

    g++ -O1 tests/interop/opensubdiv/subdivide.cpp -o subdivide-opensubdiv -losdCPU   # libosd-dev
    python tests/interop/usda-surface.py target/release/planish ./subdivide-opensubdiv

needs `pip install usd-core numpy`. OpenSubdiv is told of the layer alone, and compared with planish's JSON of the job.
"""

import json
import subprocess
import sys
import tempfile
from itertools import accumulate
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom

ROOT = Path(__file__).resolve().parents[2]
BOUNDARIES = {"none": "none", "edgeOnly": "edge", "edgeAndCorner": "edgecorner"}
LEVELS = 2


def rendered(planish, folder, job, output, levels):
    written, out = folder / "job.json", folder / f"result.{output}"
    written.write_text(json.dumps({**job, "levels": levels, "outputs": [{"format": output}]}))
    subprocess.run([planish, "render", written, "-o", out], check=True, stderr=subprocess.DEVNULL)
    return out


def refined(opensubdiv, path):
    """The positions of a layer's mesh after some levels, as its attributes ask for them."""
    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetDefaultPrim().GetChild("mesh"))
    get = lambda name: getattr(mesh, f"Get{name}Attr")().Get()
    points, counts, indices = get("Points"), get("FaceVertexCounts"), get("FaceVertexIndices")
    lengths, crease = get("CreaseLengths") or [], get("CreaseIndices") or []
    values = get("CreaseSharpnesses") or []
    edges = []
    for start, n, sharpness in zip([0, *accumulate(lengths)], lengths, values):
        edges += [(crease[i], crease[i + 1], sharpness) for i in range(start, start + n - 1)]
    corners = list(zip(get("CornerIndices") or [], get("CornerSharpnesses") or []))
    scheme = {"catmullClark": "catmark", "loop": "loop"}[get("SubdivisionScheme")]
    triangles = get("TriangleSubdivisionRule") or "catmullClark"
    text = [scheme, BOUNDARIES[get("InterpolateBoundary")], "uniform", "smooth" if triangles == "smooth" else "catmark"]
    text += [LEVELS, len(points), len(counts), len(edges), len(corners)]
    text += [x for point in points for x in point]
    for start, n in zip([0, *accumulate(counts)], counts):
        text += [n, *indices[start : start + n]]
    text += [x for edge in edges for x in edge] + [x for corner in corners for x in corner]
    done = subprocess.run([opensubdiv], input=" ".join(map(str, text)), capture_output=True, text=True, check=True)
    return np.array([list(map(float, line.split())) for line in done.stdout.splitlines()])


def farthest(found, expected):
    """The largest distance of a point of one list from the nearest of the other, in shares of the size."""
    apart = lambda a, b: max(np.linalg.norm(b - point, axis=1).min() for point in a)
    return max(apart(found, expected), apart(expected, found)) / np.ptp(expected, axis=0).max()


def main(planish, opensubdiv):
    n, worst = 0, 0.0
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for file in sorted((ROOT / "api/examples/jobs").glob("*.json")):
            given = json.loads(file.read_text()).get("input", {})
            mesh = given.get("mesh")
            if not mesh or any(name in mesh for name in ("frames", "latitude", "longitude", "parameters", "holes")):
                continue
            if len(mesh["faces"]) > 200:
                continue
            for preset in ("catmull-clark", "loop"):
                if preset == "loop" and any(len(face) != 3 for face in mesh["faces"]):
                    continue
                for boundary in ("edge-only", "edge-and-corner"):
                    job = {"input": given, "plan": {"preset": preset, "boundary": boundary}}
                    layer = rendered(planish, folder, job, "usda", 0)
                    # each layer by a name of its own, as OpenUSD keeps them by theirs
                    layer = layer.rename(folder / f"layer-{n}.usda")
                    expected = json.loads(rendered(planish, folder, job, "json", LEVELS).read_text())
                    off = farthest(refined(opensubdiv, layer), np.array(expected["positions"]))
                    assert off < 1e-6, (file.name, preset, boundary, off)
                    n, worst = n + 1, max(worst, off)
    print(f"{n} layers refined by OpenSubdiv are planish's to {worst:.1e} of the size")


if __name__ == "__main__":
    main(*sys.argv[1:])
