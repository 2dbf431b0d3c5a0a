"""Prints the settings of openapi-python-client for the OpenAPI document: bodies that are neither text nor problems are
bytes to it, whatever their media type."""

import json
from pathlib import Path

document = json.loads(Path("api/openapi.json").read_text())
operations = [operation for path in document["paths"].values() for operation in path.values()]
bodies = [body for one in operations for body in [one.get("requestBody", {}), *one["responses"].values()]]
media_types = {media_type for body in bodies for media_type in body.get("content", {})}


def is_written(media_type):
    return media_type.startswith("text/") or media_type.startswith("application/") and media_type.endswith("json")


binary = [media_type for media_type in sorted(media_types) if not is_written(media_type)]
overrides = {media_type: "application/octet-stream" for media_type in binary}
print(json.dumps({"content_type_overrides": overrides, "post_hooks": []}, indent=2))
