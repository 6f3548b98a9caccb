# The operator's console.

## The bar and the frame

skip = Skip to questions and controls
revision = rev
sign-out = Sign out
lost = <b>Connection lost.</b> This page shows the state at <span id="lost-since"></span>, which may be out of date. STOP still tries to reach hallsweep.
viewer-notice = You are signed in as a viewer: you see everything and may press STOP. Everything else needs an operator's key.
no-scripts = Scripts are off: this page shows the state at <b>{ $time }</b>.
look-again = Reload
live-loaded = as loaded
live-opening = connecting
live-on = live
live-lost = lost
live-unlinked = no robot
not-known = not known
unknown-since = not known since { $time }, last: { $last }
side = Questions, controls, luggage and log
tabs = What is shown below the luggage
sheet = Status, driving, log or trees
tab-status = Status
tab-drive = Drive
tab-log = Log
tab-trees = Trees
keys-open = Keys (?)
no-emergency-stop = STOP on this page is an operational stop, not an emergency stop: stay within reach of the robot's own switch.
hall = Hall
hall-known = The known part of the hall
lens = Part of the hall that is shown
lens-closer = Closer
lens-closer-key = closer (+)
lens-wider = Wider
lens-wider-key = wider (−)
lens-whole = The whole hall
lens-whole-key = the whole hall (0)
lens-follow = Follow the robot
legend = Legend
go-back = No, go back
past-now = <b>Past:</b> state at { $time }
goal-short = → goal { $cell }
halted = halted
led = LED { $state }
led-none = none
led-blinking = blinking
led-off = off
led-unknown = not known

## Why buttons are dead

dead-viewer = you are signed in as a viewer
dead-past = this page shows the past: go back to now first
dead-goes-on = the mission is already running
dead-comes-home = the robot is already coming home
dead-at-home = the robot is already at home
dead-no-too-high = there is no TOO HIGH to cancel

## Mission

mission = Mission
start = START
back-home = BACK HOME
start-refused = START: { $reason }.
retrieve = RETRIEVE
retrieve-one = RETRIEVE #{ $id }
retrieve-refused = RETRIEVE: { $reason }.
nothing-holds = Ready
held-by = <b>Held:</b> { $what }
fault-is = <b>Fault:</b> { $what }
unrecorded = <b>Nothing can be recorded:</b> { $why }. The robot does not move until recording works again and START is pressed.
piece-waits = luggage #{ $id } waits for your verdict
piece-waited = luggage #{ $id } was waiting for its verdict
interrupted = { $phase } (was { $before })
hold-fetchers-called = the retrieving robots have raised an alarm: acknowledge the alarm first
hold-with-why = { $hold }: { $why }
hold-declared = an operator has set the temperature to TOO HIGH
hold-waits-for-operator = waiting for the operator
hold-too-hot = too hot: { $readings }; required: { $cool } or less
reading-of = { $source } { $reading }
next = <b>Next:</b> { $what }
next-retrieve = Press RETRIEVE to bring the luggage into the container.
next-acknowledge = Acknowledge the alarm.
next-acknowledge-retrieve = Acknowledge the alarm, then press RETRIEVE to bring the luggage into the container.
next-go-on = Or press GO ON SEARCHING: there may be another bomb.
next-kept-out = When a bomb is in the container, the places inside its keep-out ring can be searched.
go-on = GO ON SEARCHING
go-on-what = There may be another bomb
close-what = State who ends the search.
close-link = Close the mission…
close-title = Close the mission
close-nothing-open = No point is open: every piece has its verdict, and every known place was searched. That does not prove that there is no device.
close-open = These points are open:
close-consequence = Closing records who ends the search, when, and what is left open. Nothing waits for it, and the robots stay as they are. It ends when a robot moves again or another piece is judged.
close-name = Name of the person in charge
close-note = Note
close-button = Close the mission
hand-over-link = Hand over…
hand-over-what = Record to whom this mission is handed over.
hand-over-none = No mission is under way, so there is nothing to hand over.
hand-over-title = Hand the mission over
hand-over-consequence = A hand-over records who hands over the mission and its record, to whom, and when. Its receipt has a code with which the record can be checked later. Nothing else changes.
hand-over-to = Person or office that takes over
hand-over-button = Hand over
closed-by = Closed by { $name } at { $time }.
next-reset = When the hall is safe again, press RESET to archive this mission.
next-secured = { $what }. START archives this mission and begins a new search, RESET only archives it.
next-explored = Everything reachable from here has been searched. START archives this mission and searches everything again, RESET only archives it.
secured-one = luggage #{ $id } is in the container
secured-many = pieces of luggage { $ids } are in the container
announced-searched = At least { $count } cells are searched.
announced-waits = Luggage #{ $id } waits for your verdict.

## Progress

progress-searched = <b>{ $searched }</b> searched
progress-reach = { $reachable } of { $free } free cells reachable
progress-none = The search has not begun.
progress-forecast = Estimated driving time at the pace so far, without photos and answers. The estimate was correct at 95 of 100 moments in random halls, and at 83 of 100 in halls of corridors.
progress-gone = <b>{ $time }</b> elapsed
progress-gone-now = <b data-since="{ $since }">{ $time }</b> elapsed
progress-began = began { $time }
cells = { $count ->
    [one] { $count } cell
   *[other] { $count } cells
}
cells-and-area = { $cells }, { $area } m²
open-places = { $count ->
    [0] no place left to search
    [one] 1 place left to search
   *[other] { $count } places left to search
}
kept-out-places = { $count ->
    [one] 1 place inside a keep-out ring
   *[other] { $count } places inside keep-out rings
}
left-least = at least { $least } of driving left
left-range = { $least } to { $most } of driving left

## Alarms and the incident

alarms = Alarms
alarm-at = <b>⚠ Alarm</b> <time class="num">{ $time }</time><br>{ $text }
alarm-unrecorded = <b>⚠ Alarm</b> <time class="num">{ $time }</time> (not recorded yet)<br>{ $text }
alarm-then = <b>Alarm</b> raised at <time class="num">{ $time }</time>, not acknowledged then:<br>{ $text }
acknowledge = Acknowledge
incident = { $count ->
    [one] ⚠ Danger: a bomb in the hall
   *[other] ⚠ Danger: { $count } bombs in the hall
}
incident-then = { $count ->
    [one] Danger then: a bomb was in the hall
   *[other] Danger then: { $count } bombs were in the hall
}
incident-acknowledged = Alarm at <time class="num">{ $raised }</time>; acknowledged by <b>{ $who }</b> at <time class="num">{ $seen }</time>
incident-alarm = <b>Alarm</b> at <time class="num">{ $time }</time>: { $text }. <b>Nobody has acknowledged this alarm yet.</b>
incident-unrecorded = <b>Alarm</b> at <time class="num">{ $time }</time> (not recorded yet): { $text }.
incident-bomb = <b>Luggage #{ $id }</b> at { $place }:<br>{ $from_home }
incident-bomb-held = <b>Luggage #{ $id }</b> is being carried ({ $now }); it was found at { $place }
incident-found = judged dangerous by { $who } at { $time }
incident-more = { $count } more: see the list of this mission.
evacuate-no-circle = Keep { $metres } m away. The page shows no circle because the cell size is unknown.
evacuate-all = Keep { $metres } m away: the whole known hall is within this distance.
evacuate-circle = Keep { $metres } m away: stay outside the red circle on the map.
evacuate-inner = Keep { $metres } m away, in buildings too: stay outside the inner red circle on the map.
evacuate-outdoors = Between { $from } m and { $to } m go into a building, away from windows and outer walls.
checklist = Checklist
checklist-floors = Clear the floors above and below this one, too.
checklist-radio = No radio and no telephone within 15 m of the piece.
checklist-second = Look for another device on the way out and where people gather.
checklist-hands = Nobody touches or moves the piece by hand.
size-ask = Size (optional)
size-unknown = not known
size-metres = or evacuation radius in m
size-legend = How large may the bomb be?
incident-next-home = The search has ended and the robot is coming home. When the robot is home, the luggage can be fetched or the hall can be made safe.
incident-next-search = The search goes on, because there may be another bomb. When the robot is home, the luggage can be fetched.
incident-next-back = The robot is coming home. When it is home, the luggage can be fetched.
incident-next-fetched = The piece is being fetched and brought into the container.
incident-next-fault = The robot has a fault, and nothing moves by itself.
incident-next-phase = The robot: { $phase }.
incident-halted-home = The robot's way home is halted: { $holds }.
incident-halted-search = The search is halted: { $holds }.
incident-halted-back = The robot's way home is halted: { $holds }.
incident-halted-fetched = The retrieval is halted: { $holds }.
goes-on-acknowledge = Acknowledge the alarm, then press START.
goes-on-ok = Press TEMPERATURE OK, then START.
goes-on-start = Press START to go on.
goes-on-later = When this cause is over, press START to go on.

## Where something is

place = column { $column }, row { $row }
from-home-none = at home
from-home-metres = { $metres } m { $side }
from-home-cells = { $count ->
    [one] { $count } cell { $side }
   *[other] { $count } cells { $side }
}
from-home = { $sides } of home
from-home-straight = { $sides } of home, { $metres } m in a straight line

## The piece that waits

inspect-title = Luggage #{ $id }
inspect-waits = waiting for <b>{ $time }</b>
inspect-waits-now = waiting for <b data-since="{ $since }">{ $time }</b>
photo-large = Enlarge
photo-usual = Reduce
no-photo = There is no photo: { $why }.
no-photo-ask-again = There is no photo: { $why }. Take the photo again, or press DANGER without a photo.
safe-button = ✓ SAFE #{ $id }
danger-button = ▲ DANGER #{ $id }…
unsure-button = ? UNSURE: look at #{ $id } again
danger-question = Is luggage #{ $id } dangerous?
danger-consequence = The search ends, the alarm is raised and the robot comes home. A verdict is final.
danger-consequence-goes-on = The alarm is raised and the search goes on. A verdict is final.
danger-yes = Yes: DANGER #{ $id }
key-safe = s
key-danger = d
key-unsure = u
hot-title = Three questions
hot-required = (required for SAFE)
hot-optional = (optional)
hot-question-hidden = Hidden?
hot-question-obvious = Obviously suspicious?
hot-question-typical = Typical of this place?
inspect-two = SAFE needs two judges with different keys. What the first one answers stays hidden from the second. One DANGER is enough.
inspect-views = Further photos from other places follow. You can answer meanwhile.
inspect-unsure = Better: another person judges now, if one is there.
kept-back = Your answer about luggage #{ $id } is recorded. It stays hidden until another judge has answered.
note-label = Note, saved with the verdict
note-optional = (optional)
note-kept = Note, saved with the verdict: { $note }
photo-in-question = The photo in question
where-and-when = The bag is at { $place }: { $from_home }; seen from { $from }, facing { $heading }; { $time }
takes-earlier = Earlier photos of luggage #{ $id }
take-earlier = earlier photo { $take }
retake = Take the photo again
verdict-title = Verdict
nothing-waits = No luggage waits for a verdict. When a piece waits, its photo and the buttons SAFE and DANGER appear here.
nothing-waited = No luggage waited for a verdict.

## Luggage

luggage-title = Luggage
luggage-more = { $count } more on the mission's page
simulator-is-paused = <b>Paused:</b> the simulated time is stopped. <a href="/simulator">Resume</a>
luggage-none = No luggage has been found yet.

## Temperature

temperature = Temperature
temperature-limit = limit { $threshold }
temperature-no-reading = no reading
temperature-unread = no thermometer was read: the temperature is unknown
temperature-unheard = no thermometer responds: the temperature is unknown
reading-age = read <b data-since="{ $since }" data-old="{ $old }">{ $time }</b> ago
reading-on-record = recorded at { $time }
reading-lost-then = not known then, last: { $last }
temperature-ok = normal
temperature-declared = too high (operator)
temperature-high = too high: nothing moves
temperature-stale = sensor silent: nothing moves
temperature-reported = An operator reported { $reading }. This reading applies until a reading of { $cool } or less is reported.
temperature-sensor = { $source } reads { $reading }; the reading must fall to { $cool } or less.
temperature-sensor-silent = { $source } last read { $reading } and is now silent; the reading must fall to { $cool } or less.
temperature-ok-button = OK
temperature-ok-act = TEMPERATURE OK
temperature-high-button = TOO HIGH
temperature-field = Reading in °C
temperature-report = Enter

## Robots

robot = Robot
robot-state = State
robot-heading = Heading
robot-position = Position
robot-sonar = Sonar
robot-load = Load
robot-no-link = No link
robot-kind = Kind
robot-address = Address
robot-parts = Parts
robot-instead = Replacements for missing parts
robot-lacks = No { $part }
before-entrance = before the entrance
off-centre = { $place }, off centre
sonar-none = none
sonar-nothing = nothing near
parts-unknown = not known while there is no link
load-none = none
load-lifted = held, lifted
load-on-floor = held, on the floor
doing-held = held by STOP
doing-halting = halting …
doing-pair = pair moving
doing-no-link = no link
doing-stopped = stopped
doing-movingForward = moving forward
doing-movingBackward = moving backward
doing-rotateLeft = turning left
doing-rotateRight = turning right
doing-takingPhoto = taking a photo
doing-sendingPhoto = sending the photo
doing-movingArm = moving its arm
hall-reckoned = No scene file: the robot estimates its position from driving time. Walls and luggage may be one cell away from where the map shows them.
hall-in-words = { $searched } searched, { $open }; { $robot }.
hall-robot-at = the robot at { $place }, facing { $heading }
hall-robot-outside = the robot before the entrance
hall-piece-waits = Luggage #{ $id } at { $place } waits for its verdict.
hall-piece-dangerous = Luggage #{ $id } at { $place } is dangerous.
hall-pieces = Pieces of luggage found: { $count }.

## Search order, putting away, driving by hand

more = Search order, archiving, driving by hand
strategy = Search order
strategy-choose = Set
reset-question = Archive this mission?
reset-what = Archive this mission
reset-consequence = RESET archives the mission; at home, RESET also empties the map. Nothing moves.
reset-yes = Yes: RESET
reset-button = RESET…
areas = Areas
areas-what = The search takes the areas in this order. Areas without a number come after the others, in an order that the search chooses.
areas-automatic = Leave the order to the search
area-open = open
area-closed = closed
area-closed-by = closed by { $name } at { $time }
area-earlier = Earlier
area-earlier-of = { $area }: earlier
area-later = Later
area-later-of = { $area }: later
area-again-of = { $area }: search again
area-close = Close…
area-close-of = { $area }: close…
area-close-title = Close the area { $area }
area-close-consequence = Closing records who ends the search of this area, when, and what is left open in it. The search leaves out the rest of the area. Nothing waits for it. To open the area again, search it again.
area-close-button = Close the area
area-close-none = This area cannot be closed now: no mission is under way, the area is closed already, or the hall does not have it.
again = Search an area again
again-what = The robot visits all searched cells between two corners once more. Corners can also be chosen on the map.
again-to-column = to column
again-to-row = to row
again-go = Search again
again-cells = { $count ->
    [one] 1 cell to search again
   *[other] { $count } cells to search again
}
drive = Drive by hand
drive-forward = forward
drive-left = left
drive-back = back
drive-right = right
drive-column = Column
drive-row = row
drive-go = Go there

## When a piece waits

attention-title = Notifications of waiting luggage and alarms
attention-notify = notify me while this page is not in view
attention-sound = make a sound

## Log

log-title = What happened
log-missions = All missions
log-lines = Log, the latest first

## Retrieval

retrieval-of = Retrieval of luggage #{ $id } <span class="quiet">by { $who }</span>
retrieval = Retrieval
retrieval-not = <b>The luggage cannot be fetched:</b> { $why }
retrieval-again = Replay the retrieval step by step
retrieval-gripper = Gripper
gripper-open = open
gripper-closed = closed
retrieval-force = Force
retrieval-angle = Paddle angle from vertical
retrieval-gap = Distance error
fetcher-pair = the pair
fetcher-discovery = the robot that searched
fetcher-none = nobody
stage-pair-makingRoom = searcher clears the way
stage-pair-fetching = pair fetches the bag
stage-pair-goingOut = pair carries it out
stage-pair-comingHome = searcher returns home
stage-discovery-fetching = searcher fetches the bag
stage-discovery-lettingGo = searcher puts the bag into the container
wanted-acknowledge = acknowledge, then press START
wanted-ok = press TEMPERATURE OK, then START
wanted-start = press START to go on
tree = Tree { $tree }
blackboard = Blackboard
blackboard-tick = tick { $tick }
blackboard-nothing = The blackboard is still empty.
blackboard-empty = empty
node-ticked = <b>thick edge</b>
node-ticked-last = ticked in the last tick
node-idle = idle
node-running = running
node-success = success
node-failure = failure
node-skipped = skipped

## The picture of the hall

mark-visited = visited
mark-unknown = unknown
mark-seen = seen by sonar
mark-frontier = frontier
mark-wall = wall
mark-todo = not inspected
legend-robot = robot
legend-fetcher = retrieving robot
legend-arm = arm with load
legend-container = container
legend-sonar = sonar
legend-home = home
legend-area = area
legend-area-closed = closed area
legend-again = to search again
legend-keep-out = keep-out ring
keep-out-of = keep-out ring of luggage #{ $id }
legend-goal = goal
legend-path = planned path
legend-trail = trail
goal-at = goal { $cell }
letter-safe = S
letter-danger = D
letter-pending = ?
piece-is = luggage #{ $id }: { $verdict }
pieces-are = { $count } pieces: { $what }
counted-danger = { $count } danger
counted-pending = { $count } pending
counted-safe = { $count } safe
container-empty = container: empty
container-holds = container: { $pieces }
luggage-number = luggage #{ $id }
container-more = and { $count } more

## Time

time = Time
time-of-mission = Moment of the mission
time-ends = The line shows only the first { $most } entries. The mission's record lists all entries, with a link to the moment of each entry.
lane-phase = phase
lane-luggage = luggage
lane-commands = commands
replay = Replay
replay-start = To the beginning
replay-start-key = to the beginning (Home)
replay-backwards = Play backwards
replay-backwards-key = play backwards
replay-back = One entry back
replay-back-key = one entry back (←)
replay-play = Play
replay-play-key = play or pause (space)
replay-on = One entry forward
replay-on-key = one entry forward (→)
replay-speed = Speed of the replay
replay-from-beginning = Replay this mission from the beginning
back-to-now = Back to now
moment = { $time }, entry { $entry } of mission { $mission }
moment-none = No mission has begun yet.
moment-now = now

## Keys

keys = Keys
keys-stop = STOP, at any time
keys-safe = SAFE: judges the waiting piece as safe
keys-unsure = UNSURE: has the waiting piece photographed from other sides
keys-danger = DANGER: asks for confirmation
keys-hot = go to the next answer to a question about the piece
keys-photo = shows the photo at window size, or at normal size
keys-zoom = on the photo: zooms in, out, or to the whole photo
keys-move = on the photo: moves the photo
keys-hall = on the hall: zooms in, out, or to the whole hall; moves the view
keys-time = on the time line: moves by one entry, to the beginning or to the end; plays
key-home = Home
key-end = End
key-space = space
keys-list = shows this list
keys-typing = These keys do nothing while you type text, or together with Ctrl, Alt or ⌘.
close = Close
