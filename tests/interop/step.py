"""Solids that planish writes as STEP, read by Open CASCADE: valid, closed, smooth, and of the certified volume.

    python tests/interop/step.py target/release/planish [name ...]

needs `pip install cadquery-ocp` (7.9 or 8.0; `cadquery-ocp-novtk` is enough). Where `gmsh` is installed too, it meshes the
faces of every solid. Every case states what it has to be; all are tried before the script fails.
"""

import importlib.util
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomLProp import GeomLProp_SLProps
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS

try:
    from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape as Neighbours
except ImportError:  # version 8
    from OCP.collections import IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as Neighbours

edge_of = getattr(TopoDS, "Edge_s", None) or TopoDS.Edge
face_of = getattr(TopoDS, "Face_s", None) or TopoDS.Face

ROOT = Path(__file__).resolve().parents[2]
INFINITE = 10


def cube(h=10.0):
    points = [[x, y, z] for x in (-h, h) for y in (-h, h) for z in (-h, h)]
    return points, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def torus(n, m):
    def at(i, j):
        a, b = math.tau * i / n, math.tau * j / m
        return [(30 + 10 * math.cos(b)) * math.cos(a), (30 + 10 * math.cos(b)) * math.sin(a), 10 * math.sin(b)]

    def number(i, j):
        return i % n * m + j % m

    points = [at(i, j) for i in range(n) for j in range(m)]
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return points, [[number(i + a, j + b) for a, b in corners] for i in range(n) for j in range(m)]


def plus():
    """A cross of five cubes, with vertices of valence 5 where its arms meet."""
    cells, points, faces, numbers = {(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)}, [], [], {}

    def vertex(*p):
        if p not in numbers:
            numbers[p] = len(points)
            points.append([10.0 * x for x in p])
        return numbers[p]

    sides = {(1, 0): ((1, 0), (1, 1)), (-1, 0): ((0, 1), (0, 0)), (0, 1): ((1, 1), (0, 1)), (0, -1): ((0, 0), (1, 0))}
    for x, y in sorted(cells):
        faces.append([vertex(x + a, y + b, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))])
        faces.append([vertex(x + a, y + b, 0) for a, b in ((0, 0), (0, 1), (1, 1), (1, 0))])
        for (dx, dy), (a, b) in sides.items():
            if (x + dx, y + dy) not in cells:
                ends = [(x + a[0], y + a[1], 0), (x + b[0], y + b[1], 0), (x + b[0], y + b[1], 1), (x + a[0], y + a[1], 1)]
                faces.append([vertex(*end) for end in ends])
    return points, faces


def prism(n):
    ring = [[10 * math.cos(math.tau * i / n), 10 * math.sin(math.tau * i / n)] for i in range(n)]
    points = [[x, y, z] for z in (-10.0, 10.0) for x, y in ring]
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return points, [list(range(n - 1, -1, -1)), list(range(n, 2 * n)), *sides]


def trapezohedron(n):
    """Two vertices of valence n over a zigzag that no symmetry makes too smooth."""
    ring = [[10 * math.cos(math.pi * i / n), 10 * math.sin(math.pi * i / n), 3.3 * (-1) ** i] for i in range(2 * n)]
    points = [[x, y, z + 1.2 * math.sin(2.3 * i)] for i, (x, y, z) in enumerate(ring)]
    upper = [[2 * n, i, i + 1, (i + 2) % (2 * n)] for i in range(0, 2 * n, 2)]
    lower = [[2 * n + 1, (i + 2) % (2 * n), (i + 1) % (2 * n), i] for i in range(1, 2 * n, 2)]
    return [*points, [1, 0.5, 10], [0, 0, -10]], upper + lower


def sheet(n=4, m=3):
    points = [[10 * i, 10 * j, 4 * math.sin(i * 1.3) * math.cos(j * 0.9)] for i in range(n + 1) for j in range(m + 1)]
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return points, [[(i + a) * (m + 1) + j + b for a, b in corners] for i in range(n) for j in range(m)]


def elephant():
    net = json.loads((ROOT / "tests/nets/animal.json").read_text())
    return net["mesh"]["positions"], net["mesh"]["faces"]


TOP = [(1, 3), (3, 7), (7, 5), (5, 1)]
ALL = sorted({tuple(sorted((f[i], f[(i + 1) % 4]))) for f in cube()[1] for i in range(4)})

# name: net, creases with one sharpness, boundary rule, options; then the most faces, and whether all caps are smooth
CASES = {
    "cube-1e-4": (cube(), None, None, {"tolerance": 1e-4}, 24, True),
    "cube-1e-5": (cube(), None, None, {"tolerance": 1e-5}, 32, True),
    "cube-1e-6": (cube(), None, None, {"tolerance": 1e-6}, 80, True),
    "cube-bicubic": (cube(), None, None, {"tolerance": 1e-4, "continuity": "bicubic"}, 100, False),
    "cube-unpacked": (cube(), None, None, {"tolerance": 1e-4, "pack": "none"}, 100, True),
    "cube-by-face": (cube(), None, None, {"tolerance": 1e-5, "pack": "face"}, 42, True),
    "torus": (torus(12, 8), None, None, {}, 4, True),
    "torus-48x32": (torus(48, 32), None, None, {}, 4, True),
    "plus": (plus(), None, None, {"tolerance": 1e-5}, 200, True),
    "box": (cube(), (ALL, INFINITE), None, {}, 6, True),
    "creased": (cube(), (TOP, INFINITE), None, {"tolerance": 1e-4}, 100, False),
    "dart": (cube(), ([(1, 3)], INFINITE), None, {"tolerance": 1e-4}, 120, False),
    "semi-sharp": (cube(), (TOP, 1.5), None, {"tolerance": 1e-4}, 300, True),
    "pentagons": (prism(5), None, None, {"tolerance": 1e-4}, 200, True),
    "prism-of-12": (prism(12), None, None, {"tolerance": 1e-4}, 168, True),
    **{
        f"valence-{n}": (trapezohedron(n), None, None, {"tolerance": 1e-4}, most, True)
        for n, most in {3: 24, 5: 40, 6: 60, 7: 84, 8: 112, 9: 126, 10: 140, 11: 154, 12: 192}.items()
    },
    "sheet": (sheet(), None, None, {}, 4, True),
    "sheet-round": (sheet(), None, "edge-only", {"tolerance": 1e-4}, 60, False),
    "elephant": (elephant(), None, None, {"tolerance": 1e-4}, 20_000, True),
}


def job(net, creases, boundary, options, form):
    points, faces = net
    mesh = {"positions": points, "faces": faces}
    if creases:
        mesh["creases"] = [{"edge": list(edge), "sharpness": creases[1]} for edge in creases[0]]
    plan = {"preset": "catmull-clark"} | ({"boundary": boundary} if boundary else {})
    output = {"format": form} | options
    return {"input": {"mesh": mesh, "unit": "mm"}, "plan": plan, "levels": 0, "outputs": [output]}


def rendered(planish, folder, name, form, case):
    written = folder / f"{name}.{form}.job.json"
    written.write_text(json.dumps(job(*case[:4], form)))
    out = folder / f"{name}.{form}"
    subprocess.run([planish, "render", str(written), "--output", str(out)], check=True)
    return out


def normal(face, edge, t):
    """The unit normal of a face at a parameter of an edge."""
    curve = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 1.0)
    uv = curve.Value(t)
    found = GeomLProp_SLProps(BRep_Tool.Surface_s(face), uv.X(), uv.Y(), 1, 1e-12)
    return found.Normal() if found.IsNormalDefined() else None


def worst_angle(neighbours):
    """Degrees between the normals of two faces, at nine places of every edge."""
    worst = 0.0
    for i in range(1, neighbours.Extent() + 1):
        faces = [face_of(shape) for shape in neighbours.FindFromIndex(i)]
        if len(faces) != 2:
            continue
        edge = edge_of(neighbours.FindKey(i))
        curve = BRepAdaptor_Curve(edge)
        first, last = curve.FirstParameter(), curve.LastParameter()
        for k in range(9):
            t = first + (last - first) * (0.02 + 0.96 * k / 8)
            a, b = (normal(face, edge, t) for face in faces)
            if a is not None and b is not None:
                worst = max(worst, math.degrees(a.Angle(b)))
    return worst


# By a process of its own, as gmsh brings another Open CASCADE: prints faces without triangles, and all triangles.
MESH = """
import sys, gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeFactor", 4)
gmsh.open(sys.argv[1])
gmsh.model.mesh.generate(2)
counts = [sum(map(len, gmsh.model.mesh.getElements(2, face)[1])) for _, face in gmsh.model.getEntities(2)]
print(counts.count(0), sum(counts))
"""


def triangles(path):
    """Triangles that gmsh cuts the faces of a file into, and what is wrong with them; None where there is no gmsh."""
    if importlib.util.find_spec("gmsh") is None:
        return None, []
    try:
        done = subprocess.run([sys.executable, "-c", MESH, path], capture_output=True, text=True, timeout=60)
    except subprocess.TimeoutExpired:
        return None, ["gmsh takes more than a minute"]
    if done.returncode != 0:
        return None, [f"gmsh: {done.stderr.strip()[-200:]}"]
    empty, all_of_them = map(int, done.stdout.split()[-2:])
    return all_of_them, [f"{empty} faces without triangles"] if empty else []


def check(planish, folder, name, case):
    faults = []
    options, most_faces, is_smooth = case[3:]
    path = rendered(planish, folder, name, "step", case)
    certificate = json.loads(rendered(planish, folder, name, "certificate", case).read_text())
    start = time.time()
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    shape = reader.OneShape()
    seconds = time.time() - start
    neighbours = Neighbours()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, neighbours)
    edges = range(1, neighbours.Extent() + 1)
    free = sum(1 for i in edges if len(list(neighbours.FindFromIndex(i))) != 2)
    tolerance = max(BRep_Tool.Tolerance_s(edge_of(neighbours.FindKey(i))) for i in edges)

    def count(kind):
        explorer, n = TopExp_Explorer(shape, kind), 0
        while explorer.More():
            n += 1
            explorer.Next()
        return n

    n_faces = count(TopAbs_FACE)
    closed = certificate["is_closed"]
    if not BRepCheck_Analyzer(shape).IsValid():
        faults.append("not valid")
    if n_faces != certificate["faces"] or n_faces > most_faces:
        faults.append(f"{n_faces} faces, certified {certificate['faces']}, at most {most_faces}")
    if neighbours.Extent() != certificate["edges"]:
        faults.append(f"{neighbours.Extent()} edges, certified {certificate['edges']}")
    if closed and (free or count(TopAbs_SOLID) != len(certificate["shells"])):
        faults.append(f"{free} free edges, {count(TopAbs_SOLID)} solids")
    if tolerance > 1.001e-7:
        faults.append(f"tolerance {tolerance}")
    if certificate["deviation_of_size"] > options.get("tolerance", 1e-5):
        faults.append(f"deviation {certificate['deviation_of_size']}")
    if certificate["gap"] > 1e-12 * certificate["size"]:
        faults.append(f"gap {certificate['gap']}")
    off = 0.0
    if closed:
        found = GProp_GProps()
        BRepGProp.VolumeProperties_s(shape, found, 1e-10)
        off = abs(found.Mass() / certificate["volume"] - 1)
        if off > 1e-9:
            faults.append(f"volume off by {off:.1e}")
    angle = worst_angle(neighbours) if is_smooth and name != "box" else math.nan
    if angle > 1e-6:
        faults.append(f"angle {angle:.1e}")
    n_triangles, more_faults = triangles(path)
    faults += more_faults
    print(
        f"{name:14} {n_faces:5} faces {path.stat().st_size / 1e3:8.0f} kB read in {seconds:5.1f} s, "
        f"volume off {off:.0e}, angle {angle:.1e}, deviation {certificate['deviation_of_size']:.1e} "
        f"({certificate['bound_method']}), {n_triangles} triangles {'; '.join(faults)}",
        flush=True,
    )
    return faults


def main(planish, *names):
    with tempfile.TemporaryDirectory() as folder:
        wrong = [name for name in names or CASES if check(planish, Path(folder), name, CASES[name])]
    if wrong:
        sys.exit(f"not as they should be: {', '.join(wrong)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
