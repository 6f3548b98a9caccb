# The operator's console.

## The bar and the frame

skip = To what waits and the controls
revision = rev
sign-out = Sign out
lost = <b>Connection lost.</b> What you see is from <span id="lost-since"></span> and may no longer be true. STOP is tried all the same.
viewer-notice = You are signed in as a viewer: you see everything and may press STOP. Everything else asks for an operator's key.
no-scripts = Scripts are off: this page shows what was so at <b>{ $time }</b>.
look-again = Look again
live-loaded = as loaded
live-opening = joining
live-on = live
live-lost = lost
live-unlinked = page only
not-known = not known
unknown-since = not known since { $time }, last: { $last }
side = What is wanted, controls, luggage and log
laboratory = laboratory
simulator = simulator
colours = Colours
colours-system = as the system
colours-light = light
colours-dark = dark
keys-open = keys (?)
no-emergency-stop = STOP on this page is an operational stop and no emergency stop: keep the robot's own switch within reach.
hall = Hall
hall-known = The hall as far as it is known
lens = Part of the hall that is shown
lens-closer = Closer
lens-closer-key = closer (+)
lens-wider = Wider
lens-wider-key = wider (−)
lens-whole = The whole hall
lens-whole-key = the whole hall (0)
legend = Legend
go-back = No, go back
past-now = <b>Past:</b> as it was at { $time }
goal-short = → goal { $cell }
halted = halted
led = LED { $state }
led-none = none
led-blinking = blinking
led-off = off
led-unknown = not known

## Why buttons are dead

dead-viewer = you are signed in as a viewer
dead-past = this is the past: go back to now first
dead-goes-on = the mission goes on already
dead-comes-home = the robot comes home already
dead-at-home = the robot is at home already
dead-no-too-high = there is no TOO HIGH to take back

## Mission

mission = Mission
start = START
back-home = BACK HOME
start-refused = START: { $reason }.
retrieve = RETRIEVE
retrieve-refused = RETRIEVE: { $reason }.
nothing-holds = Nothing holds the robots.
held-by = <b>Held:</b> { $what }
fault-is = <b>Fault:</b> { $what }
unrecorded = <b>Nothing can be recorded:</b> { $why }. The robot stands still until that is mended and START is pressed.
piece-waits = luggage #{ $id } waits for your verdict
interrupted = { $phase } (was { $before })
hold-fetchers-called = the robots that fetch have called: acknowledge their alarm first
hold-with-why = { $hold }: { $why }
hold-waits-for-operator = waiting for the operator
hold-too-hot = too hot: { $readings }; { $cool } or less is wanted
reading-of = { $source } { $reading }
next = <b>Next:</b> { $what }
next-retrieve = RETRIEVE has it brought into the container.
next-after-alarm = When the hall is safe again, acknowledge the alarm, then press RESET to put this mission away.
next-reset = When the hall is safe again, press RESET to put this mission away.
next-secured = { $what }. START begins a new search, RESET puts this mission away.
next-explored = Everything that can be reached from here has been searched. START searches it anew, RESET puts this mission away.
secured-one = luggage #{ $id } is in the container
secured-many = luggage { $ids } are in the container
announced-searched = At least { $count } cells are searched.
announced-waits = Luggage #{ $id } waits for your verdict.

## Progress

progress-searched = <b>{ $searched }</b> searched
progress-reach = { $reachable } of { $free } free cells can be reached from here
progress-none = The search has not begun.
progress-forecast = Driving alone, at the pace so far: photos and answers come on top. It held in 95 of 100 moments of searches of random halls, and in 83 of halls of corridors.
progress-gone = <b>{ $time }</b> gone
progress-gone-now = <b data-since="{ $since }">{ $time }</b> gone
progress-began = began { $time }
cells = { $count ->
    [one] { $count } cell
   *[other] { $count } cells
}
cells-and-area = { $cells }, { $area } m²
open-places = { $count ->
    [0] nothing is open: all that can be reached is searched
    [one] 1 place still open
   *[other] { $count } places still open
}
left-least = at least { $least } of driving left
left-range = { $least } to { $most } of driving left

## Alarms and the incident

alarms = Alarms
alarm-at = <b>⚠ Alarm</b> <time class="num">{ $time }</time><br>{ $text }
alarm-unrecorded = <b>⚠ Alarm</b> <time class="num">{ $time }</time> (not on record yet)<br>{ $text }
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
incident-alarm = <b>Alarm</b> at <time class="num">{ $time }</time>: { $text }.<br><b>Nobody has acknowledged it yet.</b>
incident-unrecorded = <b>Alarm</b> at <time class="num">{ $time }</time> (not on record yet): { $text }.
incident-bomb = <b>Luggage #{ $id }</b> at { $place }:<br>{ $from_home }
incident-bomb-held = <b>Luggage #{ $id }</b> is being carried ({ $now }); it was found at { $place }
incident-found = found dangerous by { $who } at { $time }
incident-more = And { $count } more: see the luggage below.
evacuate-no-circle = Keep { $metres } m away. No circle is drawn: the side of a cell is not known.
evacuate-all = Keep { $metres } m away: all of the hall that is known lies within.
evacuate-circle = Keep { $metres } m away: the red circle in the hall.
incident-next-home = The search has ended, the robot comes home. Then the piece can be fetched, or the hall be made safe.
incident-next-fetched = The piece is being fetched and brought into the container.
incident-next-fault = The robot is in fault, and nothing moves by itself.
incident-next-phase = The robot: { $phase }.
incident-halted-home = The robot's way home is halted: { $holds }.
incident-halted-fetched = The retrieval is halted: { $holds }.
goes-on-acknowledge = Acknowledge the alarm, then press START.
goes-on-ok = Press TEMPERATURE OK, then START.
goes-on-start = START goes on.
goes-on-later = When that is over, START goes on.

## Where something is

place = column { $column }, row { $row }
from-home-none = at home
from-home-metres = { $metres } m { $side }
from-home-cells = { $count ->
    [one] { $count } cell { $side }
   *[other] { $count } cells { $side }
}
from-home = { $sides } of home
from-home-straight = { $sides } of home, { $metres } m as the crow flies

## The piece that waits

inspect-title = Luggage #{ $id }
inspect-waits = waits <b>{ $time }</b>
inspect-waits-now = waits <b data-since="{ $since }">{ $time }</b>
photo-large = Large
photo-usual = Back
no-photo = There is no photo: { $why }.
no-photo-ask-again = There is no photo: { $why }. It can be taken again; DANGER needs none.
safe-button = ✓ SAFE #{ $id }
danger-button = ▲ DANGER #{ $id }…
danger-question = Is luggage #{ $id } dangerous?
danger-consequence = The search ends, the alarm is raised and the robot comes home. A verdict is final.
danger-yes = Yes: DANGER #{ $id }
key-safe = s
key-danger = d
note-label = Note, kept with the verdict
note-optional = (optional)
note-kept = Note, kept with the verdict: { $note }
photo-in-question = The photo in question
where-and-when = The bag is at { $place }: { $from_home }; seen from { $from }, facing { $heading }; { $time }
takes-earlier = Earlier photos of luggage #{ $id }
take-earlier = earlier photo { $take }
retake = Take the photo again
verdict-title = Verdict
nothing-waits = No luggage waits for a verdict. Its photo and the buttons SAFE and DANGER will be here.
nothing-waited = No luggage waited for a verdict.

## Luggage

luggage-title = Luggage
luggage-more = { $count } more on the page of the mission
simulator-is-paused = <b>Paused:</b> the time of the simulator stands still. <a href="/simulator">Go on</a>
luggage-none = None has been met yet.

## Temperature

temperature = Temperature
temperature-limit = limit { $threshold }
temperature-no-reading = no reading
temperature-unread = no thermometer was read: nobody says how warm it is
temperature-unheard = no thermometer is heard: nobody says how warm it is
reading-age = read <b data-since="{ $since }" data-old="{ $old }">{ $time }</b> ago
reading-on-record = on record since { $time }
reading-lost-then = not known then, last: { $last }
temperature-ok = ok
temperature-declared = too high by an operator's word: press OK to take it back
temperature-high = too high: nothing moves
temperature-stale = sensor silent: nothing moves
temperature-reported = An operator reported { $reading }. It counts until a reading of { $cool } or less is reported.
temperature-sensor = { $source } reads { $reading }. It must fall to { $cool } or less.
temperature-sensor-silent = { $source } read { $reading } last, and is silent. It must fall to { $cool } or less.
temperature-ok-button = OK
temperature-ok-act = TEMPERATURE OK
temperature-high-button = TOO HIGH
temperature-field = Reading in °C
temperature-report = Report

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
robot-instead = Instead of what is missing
robot-lacks = No { $part }
before-entrance = before the entrance
off-centre = { $place }, off centre
sonar-none = none
sonar-nothing = nothing near
parts-unknown = not known while there is no link
load-none = none
load-held = held
load-lifted = held, lifted
load-on-floor = held, on the floor
doing-held = held by STOP
doing-halting = halting …
doing-pair = the pair moves
doing-no-link = no link
doing-stopped = stands still
doing-movingForward = moves forward
doing-movingBackward = moves backward
doing-rotateLeft = turns left
doing-rotateRight = turns right
doing-takingPhoto = takes a photo
doing-sendingPhoto = sends the photo
doing-movingArm = moves its arm
hall-reckoned = No scene file: the robot counts its way by time. Walls and luggage may be a cell beside where they are shown.
hall-in-words = { $searched } searched, { $open }; { $robot }.
hall-robot-at = the robot at { $place }, facing { $heading }
hall-robot-outside = the robot before the entrance
hall-piece-waits = Luggage #{ $id } at { $place } waits for its verdict.
hall-piece-dangerous = Luggage #{ $id } at { $place } is dangerous.
hall-pieces = Pieces of luggage found: { $count }.

## Search order, putting away, driving by hand

more = Search order, putting away, driving by hand
strategy = Search order
strategy-choose = Choose
reset-question = Put this mission away?
reset-what = Put this mission away
reset-consequence = The mission is archived; at home the map is emptied too. Nothing moves.
reset-yes = Yes: RESET
reset-button = RESET…
drive = Drive by hand
drive-forward = forward
drive-left = left
drive-back = back
drive-right = right
drive-column = Column
drive-row = row
drive-go = Go there

## When a piece waits

attention-title = When a piece waits, or an alarm is raised
attention-notify = notify me while this page is not in view
attention-sound = make a sound

## Log

log-title = What happened
log-missions = All missions
log-lines = Log, the latest first

## Retrieval

retrieval-of = Retrieval of luggage #{ $id } <span class="quiet">by { $who }</span>
retrieval = Retrieval
retrieval-not = <b>It cannot be fetched:</b> { $why }
retrieval-secured = The bag is in the container.
retrieval-again = Look at the retrieval again, moment by moment
retrieval-robot = Robot { $robot }
retrieval-gripper = Gripper
gripper-open = open
gripper-closed = closed
retrieval-force = Force
retrieval-angle = Paddle from upright
retrieval-gap = Gap from wanted
fetcher-pair = the pair
fetcher-discovery = the robot that searched
fetcher-none = nobody
stage-pair-makingRoom = the robot that searched makes room
stage-pair-fetching = the pair fetches the piece
stage-pair-goingOut = the pair goes out
stage-pair-comingHome = the robot that searched comes home
stage-discovery-fetching = the robot that searched fetches the piece
stage-discovery-lettingGo = it puts the piece into the container
wanted-acknowledge = acknowledge, then START
wanted-ok = temperature OK, then START
wanted-start = START goes on
tree = Tree { $tree }
blackboard = Blackboard
blackboard-tick = tick { $tick }
blackboard-nothing = Nothing stands on the blackboard yet.
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
legend-fetcher = robot that fetches
legend-arm = arm that holds
legend-container = container
legend-sonar = sonar
legend-home = home
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
time-ends = The line ends here, after { $most } entries. What came then stands in the mission's record, each line of which leads to its moment.
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
replay-on = One entry on
replay-on-key = one entry on (→)
replay-speed = Speed of the replay
replay-from-beginning = Look at this mission from its beginning
back-to-now = Back to now
moment = { $time }, entry { $entry } of mission { $mission }
moment-none = No mission has begun yet.
moment-now = now

## Keys

keys = Keys
keys-stop = STOP, at any time
keys-safe = SAFE: the piece that waits is safe
keys-danger = DANGER: asks once more
keys-photo = the photo as large as the window, or back
keys-zoom = on the photo: larger, smaller, whole
keys-move = on the photo: move it
keys-hall = on the hall: larger, smaller, whole, and move it
keys-time = on the line of time: one entry, the beginning, the end, play
key-home = Home
key-end = End
key-space = space
keys-list = this list
keys-typing = While something is typed, and with Ctrl, Alt or ⌘, these keys do nothing here.
close = Close
