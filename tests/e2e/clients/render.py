"""Renders every example job with the client that openapi-python-client makes of the OpenAPI document."""

import io
import json
import sys
import zipfile
from pathlib import Path

from planish_client import Client
from planish_client.api.jobs import archive, artifact, batch, list_batches, post_batch, render
from planish_client.api.questions import estimate, validate
from planish_client.models import BatchRequest, JobRequest, ProblemAnswer, RenderFormat, RenderPreset
from planish_client.types import File

FIRST = {
    "image/png": b"\x89PNG",
    "model/gltf-binary": b"glTF",
    "model/ply": b"ply\n",
    "image/svg+xml": b"<",
    "application/json": b"{",
    "model/gltf+json": b"{",
}


def check(holds, what):
    if not holds:
        sys.exit(what)


def rendered(client, name, job):
    """Sends one job with one output, and looks at what comes by every other way that tells of it."""
    body = JobRequest.from_dict(job)
    # what the model does not know, and what it reads as something else, would get lost on the way back
    check(body.to_dict() == job, f"{name}: the model of the job is another job")
    answer = render.sync_detailed(client=client, body=body)
    check(answer.status_code == 200, f"{name}: {answer.status_code} {answer.content[:500]!r}")
    content = answer.parsed.payload.read()
    media_type = answer.headers["content-type"]
    check(content.startswith(FIRST.get(media_type, b"")) and content, f"{name}: the bytes are no {media_type}")
    file = answer.headers["content-location"].removeprefix("/v1/artifacts/")
    kept = artifact.sync_detailed(file, client=client)
    check(kept.parsed.payload.read() == content, f"{name}: the artifact has other bytes")
    told = estimate.sync(client=client, body=body)
    # a compressed variant has a tag of its own behind the key
    check(answer.headers["etag"].startswith(f'"{told.outputs[0].key}'), f"{name}: the estimate has another key")


def posted(client):
    """Sends a mesh file as the body, and the rest of the job in the query. As bytes of any type are `File` to the client,
    it says of all that they are of the last type, USD."""
    job = {"input": {"text": {"format": "obj", "data": Path("api/examples/meshes/nut.obj").read_text()}}}
    usd = render.sync(client=client, body=JobRequest.from_dict({**job, "outputs": [{"format": "usda"}]}))
    query = {"preset": RenderPreset.CATMULL_CLARK, "levels": 2, "format_": RenderFormat.PNG, "output_width": 64,
             "output_height": 48, "output_show": "surface,wireframe", "output_camera_azimuth_deg": 40}
    answer = render.sync_detailed(client=client, body=File(payload=usd.payload), **query)
    check(answer.status_code == 200, f"a file: {answer.status_code} {answer.content[:500]!r}")
    check(answer.parsed.payload.read().startswith(FIRST["image/png"]), "a file: the bytes are no picture")


def batched(client, jobs):
    """Has a list of jobs done, and a template with a grid, and reads their archives."""
    template = {"input": {"polygon": {"points": [[0, 0], [1, 0], [1, 1]], "closed": True}},
                "plan": {"preset": "four-point"}, "outputs": [{"format": "svg"}]}
    axes = [{"pointer": "/levels", "values": [1, 2]}, {"pointer": "/plan/parameters/w", "values": [0, 0.05, "1/16"]}]
    grid = {"template": {**template, "plan": {**template["plan"], "parameters": {}}}, "grid": axes}
    for name, said, n in [("a list", {"jobs": jobs}, len(jobs)), ("a grid", grid, 6)]:
        body = BatchRequest.from_dict(said)
        check(body.to_dict() == said, f"{name}: the model of the batch is another batch")
        answer = post_batch.sync_detailed(client=client, body=body, prefer="wait=60")
        check(answer.status_code == 200, f"{name}: {answer.status_code} {answer.content[:500]!r}")
        told = batch.sync(answer.parsed.id, client=client)
        counts = told.counts
        check(told.state == "done" and (counts.total, counts.done, len(told.items)) == (n, n, n), f"{name}: {told}")
        listed = list_batches.sync(client=client)
        check(told.id in [other.id for other in listed.batches], f"{name} is not listed")
        file = archive.sync_detailed(told.id, client=client)
        check(file.status_code == 200, f"{name}: {file.status_code} {file.content[:500]!r}")
        with zipfile.ZipFile(io.BytesIO(file.content)) as results:
            made = [output.bytes_ for item in told.items for output in item.outputs]
            check(results.testzip() is None, f"{name}: a file of the archive is damaged")
            check([info.file_size for info in results.infolist()][1:] == made, f"{name}: {results.namelist()}")
    wrong = BatchRequest.from_dict({"jobs": [jobs[0], {**jobs[0], "levels": 60}]})
    problem = post_batch.sync(client=client, body=wrong)
    check(isinstance(problem, ProblemAnswer) and problem.errors[0].pointer == "/jobs/1/levels", "a fault has its place")


def main():
    client = Client(base_url=sys.argv[1], timeout=60)
    n_jobs = n_results = 0
    for file in sorted(Path("api/examples/jobs").glob("*.json")):
        job = json.loads(file.read_text())
        for output in job["outputs"]:
            rendered(client, file.stem, {**job, "outputs": [output]})
            n_results += 1
        told = validate.sync(client=client, body=JobRequest.from_dict(job))
        check(told.valid and not told.errors, f"{file.stem}: {told.errors}")
        n_jobs += 1
    posted(client)
    names = ["letters-chaikin-svg", "cube-faces-png"]
    batched(client, [json.loads(Path(f"api/examples/jobs/{name}.json").read_text()) for name in names])
    wrong = JobRequest.from_dict({"input": {"polygon": {"points": [[0], [1]]}}, "plan": {"word": "P"}, "levels": 1})
    problem = render.sync(client=client, body=wrong)
    check(isinstance(problem, ProblemAnswer) and problem.errors[0].pointer == "/plan/word", "a problem has its type")
    check(n_results > 100, f"only {n_results} results")
    print(f"Python client: {n_results} results of {n_jobs} example jobs")


if __name__ == "__main__":
    main()
