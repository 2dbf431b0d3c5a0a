"""What attackers and strangers ask for. Every body holds a number of its own, so that nothing is answered from a cache."""

import json
import math

BODY_BYTES = 4_190_000  # 4 MiB, an eighth of the longest body that is read

CUBE = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
CUBE_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def text(job):
    return json.dumps(job, separators=(",", ":")).encode()


def grid(n, shift):
    points = [[x, y, 0.3 * (x * y % 2) + shift] for y in range(n + 1) for x in range(n + 1)]
    corner = [y * (n + 1) + x for y in range(n) for x in range(n)]
    return {"positions": points, "faces": [[i, i + 1, i + n + 2, i + n + 1] for i in corner]}


def cube(i, plan, levels, output, far=1.0):
    points = [*CUBE[:6], [far, 1 + i * 1e-6, 1], CUBE[7]]
    mesh = {"positions": points, "faces": CUBE_FACES}
    return text({"input": {"mesh": mesh}, "plan": {"preset": plan}, "levels": levels, "outputs": [{"format": output}]})


def small(i):
    return cube(i, "catmull-clark", 2, "json")


def open_dual(i):
    job = {"input": {"mesh": grid(3, i * 1e-6)}, "plan": {"word": "UD"}, "levels": 10 + i % 2}
    return text(job | {"outputs": [{"format": "json"}]})


def gltf(document):
    return text({"input": {"text": {"format": "gltf", "data": document}}, "outputs": [{"format": "stats"}]})


def zeros(i):
    accessor = {"componentType": 5126, "count": 999_999 - 3 * i, "type": "VEC3"}
    primitive = {"attributes": {"POSITION": 0}, "mode": 4}
    document = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}]}
    return gltf(json.dumps(document | {"meshes": [{"primitives": [primitive]}], "accessors": [accessor]}))


def nodes(i):
    return gltf('{"asset":{"version":"2.0","generator":"%09d"},"nodes":[' % i + "{}," * (BODY_BYTES // 3 - 99) + "{}]}")


def picture(i, positions, faces, options):
    positions = positions.replace("SHIFT", "0.%06d" % i)
    mesh = '{"input":{"mesh":{"positions":[%s],"faces":[%s]}},' % (positions, faces)
    return (mesh + '"plan":{"preset":"%s"},"levels":%d,"outputs":[{%s}]}' % options).encode()


def stacked():
    """40,000 quads, one before the other, each as large as the picture."""
    square = "[0,0,%d],[9e5,0,%d],[9e5,9e5,%d],[0,9e5,%d]"
    positions = ",".join(square % (z, z, z, z) for z in range(1, 40_000))
    faces = ",".join("[%d,%d,%d,%d]" % (i, i + 1, i + 2, i + 3) for i in range(0, 160_000, 4))
    camera = '"camera":{"projection":"orthographic","azimuth_deg":0,"elevation_deg":0}'
    options = ("bilinear", 0, '"format":"png","width":2048,"height":2048,' + camera)
    return "[0,0,SHIFT],[9e5,0,0],[9e5,9e5,0],[0,9e5,0]," + positions, faces, options


def ring(n):
    angles = (2 * math.pi * i / n for i in range(n))
    return ",".join("[%.4f,%.4f,0]" % (9 * math.cos(a), 9 * math.sin(a)) for a in angles)


def one_face():
    return ring(99_999) + ",[9.1,0,SHIFT]", "[%s]" % ",".join(map(str, range(100_000))), ("bilinear", 0, '"format":"png"')


def high_valence():
    faces = ",".join("[0,%d,%d]" % (1 + i, 1 + (i + 1) % 10_000) for i in range(10_000))
    return "[0,0,SHIFT]," + ring(10_000), faces, ("loop", 1, '"format":"json","positions":"limit"')


def badly_forecast():
    """The three jobs in turn."""
    jobs = [stacked(), one_face(), high_valence()]
    return lambda i: picture(i, *jobs[i % 3])


def searched(i):
    """Half of them ask the same again."""
    return cube(i * (i % 2), "catmull-clark", {"tolerance": 0.05}, "stats", far=1e6)


def slow_picture(i):
    job = {"input": {"mesh": grid(10, i * 1e-6)}, "plan": {"preset": "catmull-clark"}, "levels": 7}
    return text(job | {"outputs": [{"format": "png", "width": 2048, "height": 2048}]})


def request(method, path, body=b"", *headers):
    lines = [f"{method} {path} HTTP/1.1", "Host: 127.0.0.1", "Connection: close", *headers]
    if body:
        lines += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
    return "\r\n".join([*lines, "", ""]).encode() + body
