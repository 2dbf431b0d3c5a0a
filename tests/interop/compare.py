"""Compares planish with another program: compare.py PLANISH SUBDIVIDE SCHEME..., the first two paths of programs.

Every mesh of tests/nets and some random ones are refined by both; the points are matched one to one and the faces as
cycles of matched points. The largest difference of a coordinate is printed for each, and the exit code is 1 when one is
above the tolerance or something does not match.
"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

TOLERANCE = 1e-12
NETS = pathlib.Path(__file__).resolve().parents[1] / "nets"


def other(program, scheme, levels, positions, faces):
    lines = ["OFF", f"{len(positions)} {len(faces)} 0"]
    lines += [" ".join(repr(float(x)) for x in p) for p in positions]
    lines += [" ".join(map(str, [len(f), *f])) for f in faces]
    run = subprocess.run([program, scheme, str(levels)], input="\n".join(lines) + "\n", text=True, capture_output=True, check=True)
    words = [line.split() for line in run.stdout.splitlines() if line.strip() and not line.startswith("#")]
    n_vertices, n_faces = int(words[1][0]), int(words[1][1])
    points = [tuple(map(float, w[:3])) for w in words[2 : 2 + n_vertices]]
    cycles = [list(map(int, w[1 : 1 + int(w[0])])) for w in words[2 + n_vertices : 2 + n_vertices + n_faces]]
    return points, cycles


def planish(program, scheme, levels, positions, faces):
    job = {
        "input": {"mesh": {"positions": positions, "faces": faces}},
        "plan": {"preset": scheme, "boundary": "edge-only"},
        "levels": levels,
        "outputs": [{"format": "json"}],
    }
    with tempfile.TemporaryDirectory() as folder:
        source, target = pathlib.Path(folder, "job.json"), pathlib.Path(folder, "mesh.json")
        source.write_text(json.dumps(job))
        subprocess.run([program, "render", source, "--output", target], check=True, capture_output=True)
        result = json.loads(target.read_text())
    return [tuple(p) for p in result["positions"]], result["faces"]


def difference(found, expected):
    """Largest difference of a coordinate, or a sentence."""
    (points, faces), (others, cycles) = found, expected
    if len(points) != len(others) or len(faces) != len(cycles):
        return f"{len(points)} vertices and {len(faces)} faces, not {len(others)} and {len(cycles)}"
    cell = 1e-7
    places = {}
    for i, p in enumerate(points):
        places.setdefault(tuple(int(x // cell) for x in p), []).append(i)
    image, worst = {}, 0.0
    for i, p in enumerate(others):
        at = [int(x // cell) for x in p]
        near = [j for d in range(27) for j in places.get((at[0] + d % 3 - 1, at[1] + d // 3 % 3 - 1, at[2] + d // 9 - 1), [])]
        off = [(max(abs(x - y) for x, y in zip(points[j], p)), j) for j in near]
        if not off:
            return f"{p} is missing"
        worst, image[i] = max(worst, min(off)[0]), min(off)[1]
    if len(set(image.values())) != len(points):
        return "points do not match one to one"
    turned = lambda f: f[f.index(min(f)) :] + f[: f.index(min(f))]
    if sorted(turned([image[v] for v in f]) for f in cycles) != sorted(map(turned, faces)):
        return "the faces differ"
    return worst


def prism(n, rng):
    positions = [[rng.uniform(-3, 3) for _ in range(3)] for _ in range(2 * n)]
    faces = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return positions, faces + [list(range(n - 1, -1, -1)), list(range(n, 2 * n))]


def fans(faces):
    return [[f[0], f[j], f[j + 1]] for f in faces for j in range(1, len(f) - 1)]


def is_closed(faces):
    sides = {(f[j], f[(j + 1) % len(f)]) for f in faces for j in range(len(f))}
    return all((b, a) in sides for a, b in sides)


def meshes():
    for name in ["cube", "tetrahedron", "torus", "barrel", "animal", "mixed", "grid", "t-junction"]:
        mesh = json.loads((NETS / f"{name}.json").read_text())["mesh"]
        yield name, mesh["positions"], mesh["faces"]
    rng = random.Random(1)
    for n in [3, 5, 7, 12, 30]:
        yield f"random prism {n}", *prism(n, rng)


def main(program, subdivide, *schemes):
    wrong = 0
    for name, positions, faces in meshes():
        cases = [(scheme, levels) for scheme in schemes for levels in range(1, 5 if scheme == "sqrt-3" else 4)]
        for scheme, levels in cases:
            # CGAL's Doo-Sabin is for closed meshes
            if scheme == "doo-sabin" and not is_closed(faces):
                continue
            list_of_faces = faces if scheme in ("doo-sabin", "catmull-clark") else fans(faces)
            expected = other(subdivide, scheme, levels, positions, list_of_faces)
            result = difference(planish(program, scheme, levels, positions, list_of_faces), expected)
            print(f"{scheme:10} level {levels}  {name:16} {len(expected[1]):7} faces  {result}", flush=True)
            wrong += isinstance(result, str) or result > TOLERANCE
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
