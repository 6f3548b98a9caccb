"""A whole mission by a client that openapi-python-client made of the description: every piece is called safe, until the hall
is explored. Called as `mission.py FOLDER ADDRESS TOKEN`, with the folder of the made package."""

import sys
import time

folder, address, token = sys.argv[1:]
sys.path.insert(0, folder)

from hallsweep_client import AuthenticatedClient
from hallsweep_client.api.commands import back_home, reset, start, verdict
from hallsweep_client.api.missions import get_mission_events, get_mission_record, get_missions
from hallsweep_client.api.state import get_state
from hallsweep_client.models import Answer, EpochBody, Problem, VerdictBody, VerdictWord

PATIENCE_S = 60

client = AuthenticatedClient(base_url=address, token=token, raise_on_unexpected_status=True)


def until(phases):
    """The state once the mission stands in one of these phases."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        state = get_state.sync(client=client)
        if state.mission.phase.value in phases:
            return state
        time.sleep(0.01)
    raise SystemExit(f"it never was {phases}: {state}")


refused = back_home.sync(client=client, body=EpochBody())
assert isinstance(refused, Problem) and refused.status == 409, refused
assert isinstance(start.sync(client=client, body=EpochBody()), Answer)
safe = 0
while True:
    state = until({"inspecting", "explored"})
    if state.mission.phase.value == "explored":
        break
    waiting = [piece for piece in state.luggage if piece.verdict.value == "pending"]
    for piece in waiting:
        answer = verdict.sync(piece.id, client=client, body=VerdictBody(verdict=VerdictWord.SAFE, note="a lunch box"))
        assert isinstance(answer, Answer) and answer.luggage.verdict.value == "safe", answer
        safe += 1
record = get_missions.sync(client=client).missions[0]
whole = get_mission_record.sync(record.id, client=client)
assert len(whole.luggage) == record.pieces == safe and record.dangerous == 0, whole
events = get_mission_events.sync(record.id, client=client).events
verdicts = [event for event in events if event.kind == "verdict"]
assert [event["verdict"] for event in verdicts] == ["safe"] * safe, verdicts
assert all(piece.decided.note == "a lunch box" for piece in whole.luggage)
assert isinstance(reset.sync(client=client, body=EpochBody()), Answer)
until({"idle"})
print(f"explored, {safe} safe")
