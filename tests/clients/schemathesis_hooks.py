"""What schemathesis has to be told of hallsweep beside its description. Run by tests/service/openapi.rs."""

import re
import uuid

import requests.adapters
import schemathesis

NAME = re.compile("[!-~]{1,128}")

send = requests.adapters.HTTPAdapter.send


def first_events(adapter, request, **asked):
    """A stream of events has no end: its answer is what has come with its first event."""
    response = send(adapter, request, **{**asked, "stream": True})
    if response.headers.get("content-type", "").startswith("text/event-stream"):
        come = b""
        for part in response.iter_content(1):
            come += part
            if come.endswith(b"\n\n"):
                break
        response._content = come
        response._content_consumed = True
        response.close()
    return response


requests.adapters.HTTPAdapter.send = first_events


@schemathesis.hook
def before_call(context, case, asked):
    """A command has a name of its own: one that was given to another before is refused, as it should be."""
    name = (case.headers or {}).get("Idempotency-Key")
    if isinstance(name, str) and NAME.fullmatch(name):
        case.headers["Idempotency-Key"] = uuid.uuid4().hex
