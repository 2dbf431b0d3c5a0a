"""3MF that planish writes, read by lib3mf, and 3MF that lib3mf writes, read by planish.

python3 tests/interop/threemf.py target/release/planish

Needs lib3mf (PyPI). Meshes of the example jobs are written after no and after two levels, whole and in parts; lib3mf reads them in
its strict mode and finds the points (to f32), triangles, unit, materials and colours of the result as JSON. Then lib3mf writes them
with a transform of the build, and planish reads the same points.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import lib3mf
from lib3mf import get_wrapper

PLANISH = Path(sys.argv[1]).resolve()
ROOT = Path(__file__).resolve().parents[2]
SINGLE = 2.0**-23  # relative precision of f32
UNITS = {"m": "Meter", "mm": "MilliMeter", "cm": "CentiMeter", "in": "Inch"}
WRAPPER = get_wrapper()


def rendered(job, output):
    done = subprocess.run([PLANISH, "render", "-", "-o", "-"], input=json.dumps({**job, "outputs": [output]}).encode(), capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def near(found, expected, scale):
    return len(found) == len(expected) and all(abs(a - b) <= 2 * SINGLE * scale for p, q in zip(found, expected) for a, b in zip(p, q))


def fan(face):
    return [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]


def opened(path):
    model = WRAPPER.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    warnings = [reader.GetWarning(i) for i in range(reader.GetWarningCount())]
    assert not warnings, warnings
    return model


def objects(model):
    found, meshes = [], model.GetMeshObjects()
    while meshes.MoveNext():
        found.append(meshes.GetCurrentMeshObject())
    return found


def check_written(job, parts, path):
    path.write_bytes(rendered(job, {"format": "3mf", "parts": parts}))
    told = json.loads(rendered(job, {"format": "json"}))
    model = opened(path)
    assert model.GetUnit() == getattr(lib3mf.ModelUnit, UNITS[job["input"].get("unit", "m")])
    scale = max(abs(x) for p in told["positions"] for x in p)
    all_triangles = [triangle for face in told["faces"] for triangle in fan(face)]
    found = objects(model)
    if parts == "one":
        (mesh,) = found
        assert near([list(p.Coordinates) for p in mesh.GetVertices()], told["positions"], scale)
        assert [list(t.Indices) for t in mesh.GetTriangleIndices()] == all_triangles
    assert sum(mesh.GetTriangleCount() for mesh in found) == len(all_triangles)
    names = {m["name"] for m in told.get("materials", [])}
    if names and "color" not in told.get("channels", {}):
        groups = model.GetBaseMaterialGroups()
        assert groups.MoveNext()
        group = groups.GetCurrentBaseMaterialGroup()
        assert names <= {group.GetName(i) for i in group.GetAllPropertyIDs()}
    items = model.GetBuildItems()
    assert items.Count() == len(found)
    return [mesh.IsManifoldAndOriented() for mesh in found]


def check_read(mesh, path):
    """Has lib3mf write a mesh with a transform, and planish read it."""
    model = WRAPPER.CreateModel()
    model.SetUnit(lib3mf.ModelUnit.Inch)
    target = model.AddMeshObject()
    triangles = [triangle for face in mesh["faces"] for triangle in fan(face)]
    positions = [lib3mf.Position((lib3mf.ctypes.c_float * 3)(*p)) for p in mesh["positions"]]
    target.SetGeometry(positions, [lib3mf.Triangle((lib3mf.ctypes.c_uint32 * 3)(*t)) for t in triangles])
    transform = WRAPPER.GetTranslationTransform(1.0, 2.0, -3.0)
    model.AddBuildItem(target, transform)
    model.QueryWriter("3mf").WriteToFile(str(path))
    done = subprocess.run([PLANISH, "render", path, "-o", "-", "--format", "json"], capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    told = json.loads(done.stdout)
    moved = [[x + 1, y + 2, z - 3] for x, y, z in mesh["positions"]]
    # lib3mf writes six digits
    assert all(abs(a - b) < 2e-5 * (3 + abs(b)) for p, q in zip(told["positions"], moved) for a, b in zip(p, q))
    assert told["faces"] == triangles


def main():
    written = read = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.3mf"
        seen = set()
        for file in sorted((ROOT / "api/examples/jobs").glob("*.json")):
            job = json.loads(file.read_text())
            mesh = job.get("input", {}).get("mesh")
            if not mesh or "frames" in mesh or any(name in mesh for name in ("latitude", "longitude", "parameters")):
                continue
            key = json.dumps(job["input"], sort_keys=True)
            if key in seen:
                continue
            seen.add(key)
            for levels in (0, 2):
                for parts in ("one", "components"):
                    # lib3mf keeps the coordinates of the object, before the transform of its item
                    check_written({"input": job["input"], "plan": {"preset": "catmull-clark"}, "levels": levels}, parts, path)
                    written += 1
            check_read(mesh, path)
            read += 1
    print(f"{written} files are read by lib3mf {'.'.join(map(str, WRAPPER.GetLibraryVersion()))}, {read} of its files by planish")


main()
