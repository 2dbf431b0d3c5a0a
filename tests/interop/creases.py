"""Compares random meshes with creases and corners with OpenSubdiv.

usage: creases.py PLANISH SUBDIVIDE CASES; the second program is built from opensubdiv/subdivide.cpp.
"""

import json
import random
import subprocess
import sys


def torus(n, m):
    at = lambda i, j: (j % m) * n + i % n
    faces = [[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)] for j in range(m) for i in range(n)]
    return n * m, faces


def grid(n, m):
    faces = [[j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i]
             for j in range(m) for i in range(n)]
    return (n + 1) * (m + 1), faces


def prism(n):
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return 2 * n, sides + [list(reversed(range(n))), list(range(n, 2 * n))]


def fans(faces):
    return [[face[0], face[i], face[i + 1]] for face in faces for i in range(1, len(face) - 1)]


def sharpness(draw):
    return draw.choice([0.0, 10.0, 1.0, 2.0, round(draw.uniform(0, 4), 3)])


def differs(creases):
    """Whether OpenSubdiv gives an edge another weight than its sharpness, at most 1, under Chaikin's rule."""
    semi_sharp = [(a, b, s) for a, b, s in creases if 0 < s < 10]
    for edge in semi_sharp:
        halves = []
        for v in edge[:2]:
            others = [s for a, b, s in semi_sharp if v in (a, b) and (a, b) != edge[:2]]
            halves.append(0.75 * edge[2] + 0.25 * sum(others) / len(others) - 1 if others else edge[2] - 1)
        if edge[2] > 1 and min(halves) <= 0 or edge[2] < 1 and min(halves) > 0:
            return True
    return False


def case(seed):
    draw = random.Random(seed)
    n, faces = draw.choice([lambda: torus(draw.randint(3, 5), draw.randint(3, 5)),
                            lambda: grid(draw.randint(1, 4), draw.randint(1, 4)),
                            lambda: prism(draw.randint(3, 8))])()
    loop = draw.random() < 0.4
    if loop or draw.random() < 0.3:
        faces = fans(faces)
    sides = {tuple(sorted((face[j], face[j - 1]))) for face in faces for j in range(len(face))}
    share = draw.choice([0.1, 0.4, 0.9])
    creases = [(a, b, sharpness(draw)) for a, b in sorted(sides) if draw.random() < share]
    corners = [(v, sharpness(draw)) for v in range(n) if draw.random() < share / 3]
    positions = [[round(draw.uniform(-1, 1), 6) for _ in range(3)] for _ in range(n)]
    creasing = "uniform" if differs(creases) else draw.choice(["uniform", "chaikin"])
    # whether they differ is told for the first level
    levels = 1 if creasing == "chaikin" else draw.randint(1, 3)
    triangles = "catmark" if loop else draw.choice(["catmark", "smooth"])
    boundary = draw.choice(["edge", "edgecorner"])
    return dict(loop=loop, faces=faces, positions=positions, creases=creases, corners=corners, creasing=creasing,
                levels=levels, triangles=triangles, boundary=boundary)


def by_planish(program, c):
    parameters = {"creasing": c["creasing"]}
    if not c["loop"]:
        parameters["triangle_rule"] = c["triangles"]
    plan = {"preset": "loop" if c["loop"] else "catmull-clark", "parameters": parameters,
            "boundary": {"edge": "edge-only", "edgecorner": "edge-and-corner"}[c["boundary"]]}
    mesh = {"positions": c["positions"], "faces": c["faces"],
            "creases": [{"edge": [a, b], "sharpness": s} for a, b, s in c["creases"]],
            "corners": [{"vertex": v, "sharpness": s} for v, s in c["corners"]]}
    job = {"input": {"mesh": mesh}, "plan": plan, "levels": c["levels"], "outputs": [{"format": "json"}]}
    done = subprocess.run([program, "render", "-", "-o", "-"], input=json.dumps(job).encode(), capture_output=True)
    if done.returncode:
        sys.exit(done.stderr.decode())
    return json.loads(done.stdout)["positions"]


def by_opensubdiv(program, c):
    rows = [["loop" if c["loop"] else "catmark", c["boundary"], c["creasing"], c["triangles"], c["levels"],
             len(c["positions"]), len(c["faces"]), len(c["creases"]), len(c["corners"])]]
    rows += c["positions"] + [[len(face)] + face for face in c["faces"]] + c["creases"] + c["corners"]
    text = "\n".join(" ".join(map(str, row)) for row in rows)
    out = subprocess.run([program], input=text.encode(), capture_output=True, check=True).stdout.decode()
    return [list(map(float, line.split())) for line in out.splitlines()]


def largest_difference(found, expected):
    if len(found) != len(expected):
        return float("inf")
    off, left = 0.0, list(expected)
    for p in found:
        distance, i = min((max(abs(x - y) for x, y in zip(p, q)), i) for i, q in enumerate(left))
        left.pop(i)
        off = max(off, distance)
    return off


def main():
    planish, opensubdiv, cases = sys.argv[1], sys.argv[2], int(sys.argv[3])
    worst = {}
    for seed in range(cases):
        c = case(seed)
        off = largest_difference(by_planish(planish, c), by_opensubdiv(opensubdiv, c))
        key = ("loop" if c["loop"] else "catmull-clark", c["creasing"])
        n, most = worst.get(key, (0, 0.0))
        worst[key] = (n + 1, max(most, off))
        if off > 1e-6:
            sys.exit(f"case {seed}: off by {off}: {json.dumps(c)}")
    for key, (n, most) in sorted(worst.items()):
        print(*key, n, "cases, largest difference", f"{most:.1e}")


main()
