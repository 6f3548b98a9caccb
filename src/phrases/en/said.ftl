# What the core says.

## Phases of a mission

phase-idle = idle
phase-exploring = exploring
phase-inspecting = inspecting luggage
phase-driving = driving by hand
phase-returningHome = returning home
phase-atHome = waiting at home
phase-returningWithAlarm = returning home with an alarm
phase-bombLocated = home, bomb located
phase-retrieving = retrieving the bag
phase-bagSecured = bag secured
phase-explored = hall explored
phase-fault = in fault

## What holds the robots, and what is said when it does not any more

hold-operator = stopped by the operator
hold-tooHigh = temperature too high (button): press OK first
hold-temperature = a reading is above the threshold: every source must read cool again
hold-temperatureStale = the temperature sensor is silent: mend it first
hold-robotLink = the robot cannot be reached: mend the link first
hold-store = nothing can be recorded: mend the disk first
hold-restart = the program was started again; everything is as it was
hold-alarm = an alarm is open: acknowledge it first (or say danger again, where a danger could not be recorded)
hold-awaitingStart = waiting for START
hold-over-operator = no longer stopped by the operator
hold-over-tooHigh = temperature OK (button)
hold-over-temperature = every reading is cool again
hold-over-temperatureStale = the temperature sensors are heard again
hold-over-robotLink = the robot is reached
hold-over-store = everything is recorded again
hold-over-restart = going on after the restart
hold-over-alarm = the alarm that held is acknowledged, or the danger on record
hold-over-awaitingStart = started
hold-brief-operator = stopped by the operator
hold-brief-tooHigh = temperature too high (button)
hold-brief-temperature = a reading is above the threshold
hold-brief-temperatureStale = the temperature sensor is silent
hold-brief-robotLink = the robot cannot be reached
hold-brief-store = nothing can be recorded
hold-brief-restart = the program was started again
hold-brief-alarm = an alarm is open
hold-brief-awaitingStart = waiting for START

## Words for one thing

heading-north = north
heading-east = east
heading-south = south
heading-west = west
verdict-safe = safe
verdict-danger = danger
verdict-pending = pending
role-viewer = viewer
role-operator = operator
strategy-auto = auto
strategy-scored = scored
strategy-frontier = frontier
strategy-columns = columns
strategy-spiral = spiral
strategy-snail = snail
move-w = forward
move-s = backward
move-a = left
move-d = right
move-z = a little left
move-x = a little right
part-base = wheels
part-camera = camera
part-sonar = sonar
part-led = LED
part-thermometer = thermometer
part-bump = bumper
part-arm = arm
part-gripper = gripper
part-acknowledgedMoves = acknowledged moves
instead-camera = a drawing, which says that it is one
instead-sonar = driving into what is there
instead-led = the console alone shows it
instead-thermometer = the operator's buttons and the hall's sensors
instead-acknowledgedMoves = moves are timed

## Why a command was refused

refused-held = not possible while held: { $holds }
refused-held-store = nothing can be recorded: { $why }
refused-outdated = outdated: it was sent at epoch { $sent }, but a STOP has since raised it to { $now }; look again, then repeat it
refused-sentBefore = outdated: it was sent before, and a STOP or a restart may have come since; look again, then give it anew
refused-notInPhase = not possible while { $phase }
refused-verdictPending = luggage #{ $id } waits for its verdict: answer safe or danger first
refused-driving = the robot is being driven by hand: wait for the end of the move, or press STOP
refused-notStopped = the robot is on its mission: press STOP before driving it by hand
refused-intoObstacle = there is an obstacle at { $cell }
refused-notCapable = this robot has no small corrective turns
refused-moving = the robot is moving: press STOP first
refused-unrecorded = a piece of luggage is being recorded: wait for its photo
refused-bombUnfetched = luggage #{ $id } is dangerous and still in the hall: acknowledge its alarm first
refused-unknownLuggage = there is no luggage #{ $id }
refused-notABomb = luggage #{ $id } is not a bomb in the hall: name a dangerous piece that has not been fetched yet
refused-openPoints = open points: { $open }; to close the mission with them, send openPoints { $code }
refused-otherMission = mission { $mission } is under way now: look again, then name that one
refused-exerciseOver = the test pieces of this exercise are known by now: start hallsweep again for another exercise
refused-nothingSearched = no searched cell lies in this area: name two corners of an area that the robot has searched
refused-unknownArea = the hall has no area { $area }: name one of its areas
refused-areaClosed = the area { $area } is closed already: to open it, search it again
refused-areaTooLarge = too many cells: at most { $most } can wait to be searched again
refused-nothingPending = no luggage waits for a verdict
refused-decided = luggage #{ $id } was already found { $verdict }: a verdict is final
refused-noPhoto = luggage #{ $id } has no usable photo: take it again, or answer danger
refused-hotUnanswered = luggage #{ $id } cannot be declared safe yet: first answer whether it is hidden, obviously suspicious or typical of this place
refused-notInspected = luggage #{ $id } is not the one being inspected
refused-photoUnderWay = the photo is being taken
refused-unknownAlarm = there is no alarm { $id }
refused-noRetrievalRobot = no retrieval robot is there
refused-fetcherUnreached = { $robot } cannot be reached, and the retrieval needs it: mend its link first
refused-fetcherAbroad = { $robot } is not back yet: press START, so that the retrieval goes on
refused-faultStands = the fault still stands: { $fault }
refused-storeDown = the record cannot be written, so nothing was decided: try again when the store is back
refused-notKept = it could not be put on record, because the store has failed: look at the state before you repeat it
refused-notOnRecord = what was done last is not on record yet: wait a moment
refused-otherContent = the id { $id } was used before, for another command: give each command an id of its own
refused-unknownSensor = there is no sensor { $sensor }: name it in the setting temperature.sensor
refused-notAllowed = { $detail }

## Faults

fault-noWayHome = no known way leads home: clear the way, or fetch the robot
fault-undecided = the search finds no next step: press RESET and begin anew
fault-unanswered = the robot did not finish its order in time: look after it, then press START
fault-notFetched = the piece was not fetched: { $why }
fault-robot = the robot could not carry out its order ({ $words }): look after it, then press START
not-fetched-nothingToFetch = the pair does not know what to fetch
not-fetched-noWayToParcel = the pair finds no way to take hold of the parcel from two sides and carry it off
not-fetched-noWayToTarget = the pair finds no way to carry the parcel to where it is to go
not-fetched-noWayBack = the pair finds no way back to the pallet
not-fetched-wrongParcel = the pair has taken hold of another parcel than the one it was sent for
not-fetched-robotFails = a robot of the pair cannot do what it is told: look after it
not-fetched-lostTooOften = the pair has lost the parcel too often
not-fetched-notAligned = the pair cannot bring the parcel exactly to where it is to be put down
not-fetched-takesTooLong = one step of the pair's work takes longer than it ever should
not-fetched-tree = a behaviour tree cannot be performed as it is written
not-fetched-and = { $why } ({ $words })
saying-callOperator = the pair recognises no parcel: look what stands there, then acknowledge and press START
saying-packageLost = the pair has lost the parcel: look where it lies, then acknowledge and press START

## What the simulator says, and what was done to what is simulated.

simulated = simulator { $changes }
simulated-paused = paused
simulated-going-on = going on
simulated-speed = speed { $speed }
simulated-speed-max = speed max
simulated-linkLost = link lost: yes
simulated-linked = link lost: no
simulated-noThermometer = no thermometer: yes
simulated-thermometer = no thermometer: no
simulated-cameraFails = camera fails: yes
simulated-camera = camera fails: no
simulated-blocked = blocked { $cells }
simulated-nothing-blocked = no way blocked
simulated-step = simulator one step
simulated-put-down = put down in the hall { $hall }
simulated-is-put-down = it is put down in the hall { $hall }
simulated-keeps = simulator keeps the hall { $hall }
simulated-discards = simulator discards the hall { $hall }
simulated-lost = the simulator keeps it lost
simulated-no-photo = the shutter did not open: take the photo again

## What qualifies what a mission came to

robots = Robots
robots-and-seed = { $robots }; seed { $seed }
robots-not-on-record = not on record
searched-of = { $reachable } of { $free } free cells
search-ended-there = the search ended there
unsearched = { $count ->
    [one] 1 known place not searched
   *[other] { $count } known places not searched
}
unsearched-kept-out = { $count ->
    [one] 1 known place not searched, inside a keep-out ring
   *[other] { $count } known places not searched, { $inside } of them inside a keep-out ring
}
engine-sim = simulated
engine-virtual = virtual robot
engine-other = { $kind } robot
engine-not-on-record = not on record whether simulated
