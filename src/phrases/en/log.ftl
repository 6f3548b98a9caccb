# Log, journal and commands.

## Alarms and why a piece was not fetched

alarm-dangerous = luggage #{ $id } at { $cell } is dangerous
alarm-dangerous-unrecorded = luggage #{ $id } at { $cell } is said to be dangerous, but that could not be recorded
alarm-call = luggage #{ $id }: { $saying }
alone-OtherPiece = the robot has taken another piece than the one it was sent for
alone-PieceLost = the robot does not hold the piece any more, and it is not in the container
alone-NoWayHome = no known way leads home with the piece
alone-NoWayToPiece = no way leads to the piece
alone-CannotTake = the robot cannot take hold of the piece
alone-NotRecognised = the robot does not recognise the piece where it should stand
stuck-RobotFails = a robot that fetches cannot do what it is told
stuck-NoWayOut = no way leads the robots that fetch back outside

## Commands

asked-start = START
asked-stop = STOP
asked-backHome = BACK HOME
asked-goOn = GO ON
asked-retrieve = RETRIEVE
asked-reset = RESET
asked-move = move { $move }
asked-goto = goto { $cell }
asked-safe = safe
asked-danger = danger
asked-noted = { $asked } (note: { $note })
asked-retake = retake photo #{ $id }
asked-acknowledge = acknowledge alarm { $id }
asked-strategy = choose strategy { $strategy }
asked-ok = temperature OK
asked-too-high = temperature TOO HIGH
asked-reading = temperature reading { $celsius }
asked-sensor = a sensor's reading { $sensor } { $celsius }
asked-stops-at-once = STOP, { $count } times at once
asked-stops-within = STOP, { $count } times within { $seconds } s
asked-many = { $last }, and { $more } more that were refused
asked-of = { $asked } #{ $id }
issuer = { $who } ({ $door }, { $from })
issuer-local = { $who } ({ $door })

## The log

said-by = { $asked }, by { $issuer }
said-refused = { $asked } refused, by { $issuer }: { $refused }
said-overtaken = a safe was overtaken, and so refused: { $refused }
said-held = held: { $hold }
said-held-why = held: { $hold } ({ $why })
said-unheard = { $sensor } has not been heard yet
said-phase = { $before } → { $after }
said-fault = fault: { $fault }
said-found = luggage #{ $id } found at { $cell }
said-found-without-photo = luggage #{ $id } found at { $cell }, but its photo failed: take it again, or answer danger
said-photographed-again = luggage #{ $id } photographed again
said-photo-stays = photo of luggage #{ $id } could not be taken again; the first one stays
said-no-way = no way leads to { $cell }
said-home-through-rings = every known way home leads through a keep-out ring: the robot keeps as far from the bomb as it can
said-stands = the robot says that it stands at { $cell }, facing { $heading }
said-robot-stands = { $robot } says that it stands at { $cell }, facing { $heading }
said-too-far = { $robot } says that it stands at { $cell }, further from home than any hall reaches
said-no-thermometer = { $robot } has no thermometer now, and the last reading was too hot: report what the hall's is
said-still-unreached = { $robot }: { $why }
said-unreached = { $robot } cannot be reached ({ $why }): mend the link
said-met-obstacle = { $robot } met an obstacle at { $cell }
said-failed = { $robot } could not carry out its order ({ $why })
said-no-photo = { $robot } took no photo ({ $why })
said-unanswered = { $robot } did not finish its order in time: look after it
said-trees-anew = the pair's trees begin anew: { $why }
said-ended = the program was ended by { $by }: the robot halts
said-put-down = the robot was put down in another hall

## What the journal says

fact-started = program started, version { $version }
fact-conditions = hall: { $hall }, cells of { $side } m, too hot above { $threshold }
rule-goes-on = the search goes on after danger
rule-rings = keep-out rings of { $metres } m
fact-conditions-no-side = hall: { $hall }, too hot above { $threshold }
fact-conditions-reckoned = hall: { $hall }, reckoned without a scene file, too hot above { $threshold }
fact-written-out = missions { $first } to { $last }, entries up to { $until }, are in the archive { $file } alone, SHA-256 { $digest }
fact-unpacked = unpacked from the archive { $file }, SHA-256 { $digest }; begins behind entry { $behind }, the digest of whose page is { $page }
fact-clock-back = the clock was set back by { $by }
fact-clock-forward = the clock went forward by { $by }: it was set, or the machine slept
fact-ended = program ended by { $by }
fact-state = all that stands: mission { $mission }, { $cells } cells visited
fact-state-none = all that stands: no mission, { $cells } cells visited
fact-command = command { $asked } by { $issuer }: { $outcome }
fact-accepted = accepted
fact-refused = refused: { $why }
fact-mission-began = mission { $mission } began ({ $strategy })
fact-mission-archived = mission { $mission } put away, bombs left: { $left }
not-fetched-other-fetcher = it was begun with mission.retrieval = "{ $began }", which is "{ $set }" now: set it back
not-fetched-and-stuck = { $before }; and { $why }
fact-none-left = none
fact-phase = phase: { $phase }
fact-stage = { $phase }: { $stage }
stage-backing-up = backing up
stage-taking-photo = taking the photo
stage-recording = recording #{ $id }
stage-waits = #{ $id } waits for its verdict
stage-retaking = taking the photo of #{ $id } again
fact-nothing-holds = nothing holds the robot
fact-held = held: { $holds }
fact-epoch = stopped: epoch { $epoch }
fact-no-goal = no goal
fact-robot-at = robot at { $cell }, facing { $heading }
fact-other-at = { $robot } at { $cell }, facing { $heading }
fact-in-hall = { $robot } is in the hall
fact-outside = { $robot } is outside, { $steps } from home
fact-retrieval-ended = the retrieval has ended
fact-retrieval = retrieval of luggage #{ $id } by { $fetcher }: { $how }
by-pair = pair
by-discovery = discovery
by-none = none
fetching-room = room is made
fetching-fetched = it is fetched
fetching-let-go = it is put into the container
fetching-given-up = given up: { $why }
fetching-in-container = it is in the container
fetching-not = not fetched: { $why }
fact-met-again = piece { $piece } stands at { $cell }, too
fact-led-on = LED blinking
fact-led-off = LED off
fact-obstacle = obstacle at { $cell }, taken for { $kind }
obstacle-wall = wall
obstacle-luggage = luggage
obstacle-unknown = unknown
fact-cell = cell { $cell }: { $mark }
cell-unknown = unknown
cell-seen = seen
cell-visited = visited
cell-wall = wall
cell-luggage = luggage
cell-notInspected = not inspected
fact-luggage = luggage #{ $id } at { $cell }, seen from { $from } facing { $heading }; { $photo }
photographed = photographed
photographed-take = photographed, take { $take }
photographed-not = no photo: { $why }
fact-verdict = verdict on luggage #{ $id }: { $verdict }, by { $who }
fact-verdict-noted = verdict on luggage #{ $id }: { $verdict }, by { $who } (note: { $note })
fact-temperature = temperature { $celsius }, by { $source }
fact-thermometer-silent = the thermometer of { $source } fell silent
fact-alarm = alarm { $alarm } raised: { $cause }
fact-alarm-seen = alarm { $alarm } acknowledged by { $who }
fact-strategy = search order: { $strategy }
fact-map-emptied = map emptied, facing { $heading }
