"""USD that planish writes, read by OpenUSD and compared with the result as JSON, and USD that OpenUSD writes, read by
planish.

python3 tests/interop/usda.py target/release/planish

Needs usd-core (PyPI). Each mesh of the example jobs is written by each of the schemes as a cage and after two levels; every attribute
of the mesh is compared, and OpenUSD's own validators have nothing to say.
"""

import json
import random
import subprocess
import sys
import tempfile
from itertools import accumulate
from pathlib import Path

from pxr import Gf, Usd, UsdGeom, UsdShade

PLANISH = Path(sys.argv[1]).resolve()
ROOT = Path(__file__).resolve().parents[2]
SCHEMES = {"catmull-clark": "catmullClark", "loop": "loop", "bilinear": "bilinear", "doo-sabin": "none"}
PLACES = 60  # scenes of nested transforms
SINGLE = 2.0**-23  # relative precision of f32


def rendered(job, output):
    done = subprocess.run([PLANISH, "render", "-", "-o", "-"], input=json.dumps({**job, "outputs": [output]}).encode(), capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def same(found, expected):
    if isinstance(expected, (list, tuple)):
        return len(found) == len(expected) and all(same(a, b) for a, b in zip(found, expected))
    return abs(found - expected) <= SINGLE * max(abs(expected), 1e-30)


def corners(name, mesh):
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar(name)
    return list(primvar.ComputeFlattened()) if primvar else None


def check(job, path):
    """Writes a job as USD and compares it with the same result as JSON."""
    path.write_bytes(rendered(job, {"format": "usda"}))
    told = json.loads(rendered(job, {"format": "json"}))
    stage = Usd.Stage.Open(str(path))
    prim = stage.GetDefaultPrim().GetChild("mesh")
    mesh = UsdGeom.Mesh(prim)
    counts, indices, points = mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get(), mesh.GetPointsAttr().Get()
    ok, why = UsdGeom.Mesh.ValidateTopology(indices, counts, len(points))
    assert ok, why
    assert same(points, told["positions"])
    holes = set(mesh.GetHoleIndicesAttr().Get() or [])
    starts = [0, *accumulate(counts)]
    faces = [list(indices[s : s + n]) for s, n in zip(starts, counts)]
    assert [face for f, face in enumerate(faces) if f not in holes] == told["faces"]
    scheme = mesh.GetSubdivisionSchemeAttr().Get()
    if scheme != "none":
        check_cage(job, mesh)
    extent = UsdGeom.Boundable(prim).GetExtentAttr().Get()
    assert same(extent, [list(end) for end in UsdGeom.PointBased.ComputeExtent(points)])
    unit = {"m": 1, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}[job["input"].get("unit", "m")]
    assert UsdGeom.GetStageMetersPerUnit(stage) == unit
    assert UsdGeom.GetStageUpAxis(stage) == job["input"].get("up", "y").upper()
    for family in ("materialBind", "group"):
        subsets = UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, family)
        names = [subset.GetPrim().GetDisplayName() or subset.GetPrim().GetName() for subset in subsets]
        if subsets:
            key = {"materialBind": "materials", "group": "groups"}[family]
            assert names == [entry["name"] for entry in told[key]], names
        for subset in subsets:
            assert max(subset.GetIndicesAttr().Get(), default=0) < len(counts)
        ok, why = UsdGeom.Subset.ValidateFamily(mesh, UsdGeom.Tokens.face, family) if subsets else (True, "")
        assert ok, why
        if family == "materialBind":
            for subset in subsets:
                material, _ = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()
                shader = material.ComputeSurfaceSource()[0]
                assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    validate(stage)
    check_back(job, stage, path)
    return scheme


def check_back(job, stage, path):
    """Has OpenUSD write a layer anew, in its own words, and planish read it."""
    again = path.with_suffix(".again.usda")
    stage.GetRootLayer().Export(str(again))
    found = converted(again)
    expected = json.loads(rendered(job, {"format": "json"}))
    # vertices where holes leave two fans are two
    corners = lambda mesh: [[mesh["positions"][v] for v in face] for face in mesh["faces"]]
    assert same(corners(found), corners(expected))
    if job["levels"] > 0:
        return
    tags = lambda mesh: {tuple(sorted(tag["edge"])): tag["sharpness"] for tag in mesh.get("creases", [])}
    told, given = tags(found), tags(expected)
    assert told.keys() == given.keys() and all(same(told[edge], given[edge]) for edge in given)
    for key in ("groups", "materials"):
        sets = lambda mesh: {entry["name"]: entry["faces"] for entry in mesh.get(key, [])}
        assert sets(found) == sets(expected), (sets(found), sets(expected))


def converted(path):
    done = subprocess.run([PLANISH, "render", path, "-o", "-", "--format", "json"], capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    return json.loads(done.stdout)


def check_places(path, rng):
    """Nested prims with transforms of all kinds, whose points are those that OpenUSD computes."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, rng.choice([1.0, 0.001]))
    number = lambda: rng.uniform(-3, 3)
    triple = lambda: Gf.Vec3d(number(), number(), number())
    parent, expected = "", []
    for depth in range(3):
        parent += f"/node{depth}"
        mesh = UsdGeom.Mesh.Define(stage, parent)
        for kind in rng.sample(["translate", "rotate", "axis", "scale", "orient", "transform", "pivot"], 3):
            if kind == "translate":
                mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(triple())
            elif kind == "rotate":
                name = rng.choice(["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
                getattr(mesh, f"AddRotate{name}Op")(UsdGeom.XformOp.PrecisionDouble).Set(triple() * 90)
            elif kind == "axis":
                getattr(mesh, f"AddRotate{rng.choice('XYZ')}Op")(UsdGeom.XformOp.PrecisionDouble).Set(rng.choice([90, 180, -90, 33.3]))
            elif kind == "scale":
                mesh.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(triple())
            elif kind == "orient":
                mesh.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(number(), triple()).GetNormalized())
            elif kind == "transform":
                matrix = Gf.Matrix4d(1).SetRotate(Gf.Rotation(triple(), 77)) * Gf.Matrix4d(1).SetTranslate(triple())
                mesh.AddTransformOp().Set(matrix)
            else:
                pivot = mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, "pivot")
                pivot.Set(triple())
                mesh.AddRotateXOp(UsdGeom.XformOp.PrecisionDouble, "turn").Set(number() * 90)
                mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, "pivot", True)
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        mesh.CreatePointsAttr(points)
        mesh.CreateFaceVertexCountsAttr([3, 3, 3, 3])
        mesh.CreateFaceVertexIndicesAttr([0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2])
        world = UsdGeom.XformCache().GetLocalToWorldTransform(mesh.GetPrim())
        expected += [list(world.Transform(Gf.Vec3d(point))) for point in points]
    stage.GetRootLayer().Save()
    found = converted(path)["positions"]
    size = max(abs(x) for point in expected for x in point)
    assert len(found) == len(expected)
    for a, b in zip(found, expected):
        assert all(abs(x - y) <= 1e-12 * size for x, y in zip(a, b)), (path.read_text(), a, b)


def check_cage(job, mesh):
    given = job["input"]["mesh"]
    creases = list(zip(*[iter(mesh.GetCreaseIndicesAttr().Get() or [])] * 2))
    sharpness = dict(zip([tuple(sorted(edge)) for edge in creases], mesh.GetCreaseSharpnessesAttr().Get() or []))
    expected = {tuple(sorted(c["edge"])): min(c["sharpness"], 10) for c in given.get("creases", [])}
    assert sharpness.keys() == expected.keys() and all(same(sharpness[e], expected[e]) for e in expected)
    corners_found = dict(zip(mesh.GetCornerIndicesAttr().Get() or [], mesh.GetCornerSharpnessesAttr().Get() or []))
    corners_given = {c["vertex"]: min(c["sharpness"], 10) for c in map(lambda c: c if isinstance(c, dict) else {"vertex": c, "sharpness": 10}, given.get("corners", []))}
    assert corners_found.keys() == corners_given.keys() and all(same(corners_found[v], corners_given[v]) for v in corners_given)
    assert list(mesh.GetHoleIndicesAttr().Get() or []) == sorted(given.get("holes", []))
    if "uvs" in given:
        flat = [given["uvs"]["values"][v] for face in given["uvs"]["faces"] for v in face]
        assert same(corners("st", mesh), flat)


def validate(stage):
    """What OpenUSD's own validators find, where this build of it has them."""
    try:
        from pxr import UsdValidation
    except ImportError:
        return
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    found = [error.GetMessage() for error in context.Validate(stage)]
    assert not found, found


def main():
    n = 0
    with tempfile.TemporaryDirectory() as folder:
        for file in sorted((ROOT / "api/examples/jobs").glob("*.json")):
            job = json.loads(file.read_text())
            mesh = job.get("input", {}).get("mesh")
            if not mesh or "frames" in mesh or any(name in mesh for name in ("latitude", "longitude", "parameters")):
                continue
            for preset, token in SCHEMES.items():
                tagged = any(name in mesh for name in ("creases", "corners", "holes", "groups", "materials", "uvs"))
                if preset == "loop" and any(len(face) != 3 for face in mesh["faces"]) or preset == "doo-sabin" and (tagged or "channels" in mesh):
                    continue
                sharpness = [tag["sharpness"] for name in ("creases", "corners") for tag in mesh.get(name, []) if isinstance(tag, dict)]
                if preset == "bilinear" and any(0 < s < 10 for s in sharpness):
                    continue
                base = {"input": job["input"], "plan": {"preset": preset}}
                for levels in (0, 2):
                    if levels and len(mesh["faces"]) > 100:
                        continue
                    # a name for each, as layers are kept by theirs
                    scheme = check({**base, "levels": levels}, Path(folder) / f"mesh-{n}.usda")
                    assert scheme == (token if levels == 0 else "none"), (file.name, preset, scheme)
                    n += 1
        rng = random.Random(1)
        for i in range(PLACES):
            check_places(Path(folder) / f"places-{i}.usda", rng)
    print(f"{n} files agree with OpenUSD {'.'.join(map(str, Usd.GetVersion()))}, and {PLACES} scenes stand where it puts them")


main()
