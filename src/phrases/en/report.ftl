# The report of a mission. Reports that were handed over say these words: see src/report/mod.rs before one is changed.

report-title = Report of mission { $id }
report-kind = Search of an evacuated hall by robots
report-reference = Reference
report-until = mission { $mission }, entry { $entry }
report-summary = Summary
report-cell = Side of a cell
report-rules = Rules of the team
report-threshold = Too hot above
report-began = Began
report-put-away = Put away
report-as-of = Not put away yet; as of
report-took = Took (h:mm:ss)
report-clock-set = The clock was changed
report-clock-sets = { $count } ×; what was taken is what the program measured while it ran
report-zone = Times are in
report-strategy = Order of the search
report-reckoned = How the map was made
report-reckoned-so = counted by time without a scene file: walls and luggage may be a cell beside where they are shown
report-searched = Searched
report-cells = { $cells } cells
report-cells-square = { $cells } cells, { $square } m²
report-reach = Can be reached
report-reach-cells = { $reachable } of { $free } free cells can be reached from the start
report-open = Known places not searched
report-pieces = { $count }: safe { $safe }, danger { $danger }, pending { $pending }
report-secured-count = Put into the container
report-finding = Finding
report-no-device = { $count ->
    [0] No piece was judged.
    [one] No device was found in 1 judged piece.
   *[other] No device was found in { $count } judged pieces.
}
report-devices = { $dangerous } of { $count } judged pieces were judged dangerous.
report-closed = Closed
report-not-closed = not closed
report-stops = STOP pressed
report-accepted = Commands accepted
report-refused = Commands refused
report-alarms = Alarms
report-alarms-seen = { $count }, acknowledged: { $seen }
report-range = { $least } to { $most }; the highest { $time }
report-constant = constant { $least }
report-starts = Restarts of the program

## What cannot be read

report-damage = What is missing here
report-damaged = Some of what is on record cannot be understood. What follows from it is not in this report:
report-damage-more = and { $count } more
report-not-kept = The hall and the luggage of this mission are not kept.

## The hall

report-hall-known = The hall as far as it was known, with what was found
report-hall-note = Cells are counted from home, columns to the east and rows to the south. A number in a sign is that of a piece of luggage.
report-visited = searched
report-unknown = unknown
report-wall = wall
report-todo = not inspected
report-luggage-cell = luggage
report-fetched = fetched, and not there any more
report-home = home

## Luggage

report-photo = Photo { $take }
report-photo-failed = There is no photo: { $why }
report-photo-spoilt = Photo { $take } is lost: its file is missing, or is not the one on record.
report-scaled = Photos are scaled down here, so that this page stays small. The originals are kept with the journal, and each SHA-256 is that of an original: hallsweep shows it under /api/v1/luggage/NUMBER/photo?take=PHOTO.
report-photo-unscaled = Photo { $take } is not shown here: it cannot be scaled down. The original is kept with the journal, SHA-256 { $digest }.
report-found = Found
report-where = Where
report-place = { $place }; from home { $east } m to the east, { $south } m to the south
report-verdict = Verdict
report-verdict-by = by { $who }, { $time }
report-no-verdict = none was given
report-waited = Decided after (h:mm:ss)
report-note = Note
report-secured = Put into the container

## The temperature

report-chart = The temperature over the mission
report-chart-note = The highest reading of each moment. Dashed: the line above which it is too hot.
report-no-readings = No reading is on record.

## Tables

report-entry = Entry
report-time = Time
report-what = What
report-by = By
report-why = Why
report-none = Nothing on record.
report-refusals = Refused commands
report-happened = What happened

## Lines to sign on

report-signatures = Signatures
report-signed-operator = Operator in charge
report-signed-receiver = Received by
report-signed-name = Name and office
report-signed-date = Place, date and time
report-signed-signature = Signature

## What it proves

report-evidence = Evidence
report-evidence-of = This report was made from the journal of hallsweep. It holds what is on record of mission { $mission } up to entry { $entry }, and nothing else.
report-head = Head of the journal
report-head-entry = at entry { $entry }
report-confirm = Whoever has the journal can hold this file against it:
report-proves = The file is confirmed only if not a byte of it, nor of what it was made from, was changed since. This does not prove that the journal was not made anew before this report was handed over, nor that a camera or a thermometer told the truth.
report-no-head = The journal was kept in memory alone: nothing can confirm this report later.

## The results of an exercise

score-title = How the pieces of the exercise were judged
score-key = Key
score-answers = Answers
score-hits = Test pieces found
score-misses = Test pieces missed
score-false-alarms = False alarms
score-correct-safe = Correctly judged safe
score-unsure = Unsure
score-median = Time to answer, median
score-longest = Time to answer, longest
score-rate = { $count } ({ $rate } %, 95 % interval: { $low }–{ $high } %)
score-note = Results appear at the end of the exercise. Rates begin at 10 pieces; their interval is that of Wilson.
