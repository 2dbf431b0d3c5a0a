"""Files that other programs write, read by planish and compared with what was written.

python3 tests/interop/mesh-files.py target/release/planish

Needs trimesh, numpy and pymeshlab (PyPI) and the command assimp (Debian: assimp-utils); nothing of it is part of the build. Two
meshes, the elephant and the torus of the examples, are written by each program in each of its
formats; planish reads the files, merges equal places, and tells counts, area and volume.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import pymeshlab
import trimesh

PLANISH = Path(sys.argv[1]).resolve()
ROOT = Path(__file__).resolve().parents[2]
JOBS = {"animal": "animal-catmull-clark-glb", "torus": "torus-word-uccp-stats"}
ASSIMP = [("obj", "obj"), ("ply", "ply"), ("plyb", "ply"), ("stl", "stl"), ("stlb", "stl"), ("glb2", "glb"), ("gltf2", "gltf")]
TEXT, BINARY = {"binary": False}, {"binary": True}
MESHLAB = [("obj", {}), ("ply", BINARY), ("ply", TEXT), ("stl", BINARY), ("stl", TEXT), ("off", {})]
TOLERANCE = 1e-5  # formats in f32, or in text of six digits


def planish(*arguments):
    return subprocess.run([PLANISH, *map(str, arguments)], capture_output=True, text=True, check=False)


def stats(path):
    done = planish("render", path, "--weld", "0", "-o", "-", "--format", "stats")
    return json.loads(done.stdout) if done.returncode == 0 else done.stderr.strip()


def by_trimesh(mesh, folder):
    files = {kind: mesh.export(file_type=kind) for kind in ["obj", "ply", "stl", "stl_ascii", "off", "glb"]}
    files["ply ascii"] = trimesh.exchange.ply.export_ply(mesh, encoding="ascii")
    whole = trimesh.exchange.gltf.export_gltf(mesh.scene(), embed_buffers=True, merge_buffers=True)
    files["gltf"] = whole["model.gltf"]
    for kind, content in files.items():
        path = folder / f"trimesh-{kind.replace(' ', '-')}.{kind.split('_')[0].split(' ')[0]}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        yield f"trimesh {kind}", path


def by_meshlab(source, folder):
    server = pymeshlab.MeshSet()
    server.load_new_mesh(str(source))
    for kind, options in MESHLAB:
        path = folder / f"meshlab-{'-'.join([kind, *map(str, options.values())])}.{kind}"
        server.save_current_mesh(str(path), **options)
        yield " ".join(["meshlab", kind, *(f"{name} {value}" for name, value in options.items())]), path


def by_assimp(source, folder):
    for kind, extension in ASSIMP:
        path = folder / f"assimp-{kind}.{extension}"
        done = subprocess.run(["assimp", "export", source, path, f"-f{kind}"], capture_output=True, text=True, check=False)
        assert path.exists(), done.stdout
        yield f"assimp {kind}", path


def net(path):
    return json.loads(planish("render", path, "--weld", "0", "-o", "-", "--format", "json").stdout)


def cuts_the_same_faces(path, source):
    """Whether each triangle of a file joins three corners of one face of the source."""
    found, given = net(path), net(source)
    key = lambda p: tuple(round(x, 4) for x in p)
    numbers = {key(p): v for v, p in enumerate(given["positions"])}
    assert len(numbers) == len(given["positions"])
    faces = {}
    for f, face in enumerate(given["faces"]):
        for v in face:
            faces.setdefault(v, set()).add(f)
    image = [numbers.get(key(p)) for p in found["positions"]]
    return None not in image and all(set.intersection(*(faces[image[v]] for v in face)) for face in found["faces"])


def verdict(path, source, expected):
    found = stats(path)
    if isinstance(found, str):
        return found.splitlines()[-1].strip()
    off = max(abs(found[name] - expected[name]) / abs(expected[name]) for name in ["area", "volume"])
    exact = ["vertices", "triangles", "closed", "euler_characteristic", "components"]
    wrong = [f"{name} {found[name]}, not {expected[name]}" for name in exact if found[name] != expected[name]]
    if wrong or off < TOLERANCE:
        return "; ".join(wrong) or "agrees"
    same = cuts_the_same_faces(path, source)
    return "agrees, faces cut along other diagonals" if same else f"area or volume off by {off:.1e}"


def main():
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, job in JOBS.items():
            mesh = folder / name
            mesh.mkdir()
            text = json.loads((ROOT / f"api/examples/jobs/{job}.json").read_text())
            whole = mesh / "whole.json"
            whole.write_text(json.dumps({"input": text["input"], "outputs": [{"format": "obj"}]}))
            source = mesh / "source.obj"
            assert planish("render", whole, "-o", source).returncode == 0
            expected = stats(source)
            written = [*by_trimesh(trimesh.load(source, process=False), mesh), *by_assimp(source, mesh), *by_meshlab(source, mesh)]
            rows += [(name, what, verdict(path, source, expected)) for what, path in written]
    for row in rows:
        print("| " + " | ".join(row) + " |")
    refused = [row for row in rows if not row[2].startswith("agrees")]
    sys.exit(bool(refused))


main()
