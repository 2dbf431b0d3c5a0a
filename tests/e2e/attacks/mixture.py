"""Everything that the service does, in one stream of requests of which no two ask for the same."""

import base64
import json

from attacks.jobs import cube, request, text

CYCLE = 10


def mixture(i):
    """The request of number `i`: renders, jobs, a batch, an analysis, a figure, an upload and a comparison in turn."""
    return KINDS[i % CYCLE](i)


def render(output, levels):
    return lambda i: request("POST", "/v1/render", cube(i, "catmull-clark", levels, output), "Prefer: wait=300")


def job(i):
    return request("POST", "/v1/jobs", cube(i, "doo-sabin" if i % 20 else "catmull-clark", 5, "stats"))


def batch(i):
    axis = {"pointer": "/input/mesh/positions/0/0", "values": [-1 - i * 1e-6, -1.1 - i * 1e-6, -1.2 - i * 1e-6]}
    template = json.loads(cube(i, "catmull-clark", 5, "glb"))
    return request("POST", "/v1/batches", text({"template": template, "grid": [axis]}))


def analysis(i):
    return request("POST", "/v1/analyses", text({"plan": {"preset": "four-point", "parameters": {"w": 0.05 + i * 1e-9}}}))


def figure(i):
    panels = [{"job": json.loads(cube(i, scheme, 5, "png"))} for scheme in ("catmull-clark", "doo-sabin")]
    return request("POST", "/v1/render", text({"figure": {"columns": 2, "panels": panels}, "outputs": [{"format": "png"}]}))


def upload(i):
    return request("POST", "/v1/blobs", base64.b64encode(i.to_bytes(8)) * 20_000)


def comparison(i):
    sides = [json.loads(cube(i, scheme, 4, "glb")) for scheme in ("catmull-clark", "bilinear")]
    return request("POST", "/v1/compare", text(dict(zip("ab", sides))))


KINDS = [render("glb", 6), render("png", 6), job, render("obj", 6), batch, analysis, render("ply", 7), figure, upload, comparison]
