"""What schemathesis does not know: the query of /v1/render says the rest of a job beside a mesh file, and beside a job in
JSON nothing. Without this, nearly every job would come with a query, and be refused for that alone."""

import schemathesis
from schemathesis import GenerationMode


@schemathesis.hook
def before_call(context, case, kwargs):
    is_job = case.media_type == "application/json" and case.operation.path == "/v1/render"
    if is_job and case.meta.generation.mode == GenerationMode.POSITIVE:
        case.query = {name: value for name, value in (case.query or {}).items() if name == "keep"}
