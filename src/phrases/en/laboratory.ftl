# The laboratory: the Roomba and the pallet.

laboratory-title = Laboratory
laboratory-moves-nothing = This page shows computed runs that move nothing in the hall. STOP halts the hall's robots, as on every page.
laboratory-roomba = Roomba
laboratory-pallet = Pallet
laboratory-seed = Seed
laboratory-run = Run
laboratory-at-the-end = At the end

## The Roomba

laboratory-about-roomba = A round robot drives in an empty room, in turn 3 s forward and 20 s in a growing spiral. At a wall, the robot drives back for half a second and turns by a random angle. A state machine drives one run, a behaviour tree the other. With the same seed, both runs are the same.
laboratory-seconds = Seconds
laboratory-room = The room from above, with the robot's path
laboratory-machine = Machine
laboratory-tree = Tree
laboratory-state-machine = State machine
laboratory-behaviour-tree = Behaviour tree
laboratory-column-machine = machine
laboratory-column-tree = tree
laboratory-diagram-machine = The state machine: MoveForward and MoveInSpiral alternate with time; a wall changes both to GoBack, then to Rotate, then to MoveForward
laboratory-diagram-tree = The behaviour tree: a Selector over two Sequences: MoveForward with MoveInSpiral, and GoBack with Rotate
laboratory-wall = wall
laboratory-turned = turned
laboratory-wall-met = wall met
laboratory-floor-passed = floor passed over
laboratory-start-and-end = start; the circle is its end
laboratory-running = running
laboratory-succeeded = succeeded
laboratory-failed = failed
laboratory-drawn = { $who }, seed { $seed }, { $seconds } s
laboratory-summary = { $floor } % of the floor passed over, { $way } m driven, { $walls ->
    [one] wall met once
   *[other] walls met { $walls } times
}
laboratory-same = Machine and tree made the same { $transitions } transitions, with the same angles.
laboratory-parting = machine and tree differ after { $common } transitions: the machine { $machine }, the tree { $tree }
laboratory-goes = goes from { $from } to { $to } at { $seconds } s
laboratory-turns = goes from { $from } to { $to } at { $seconds } s with a turn of { $angle } rad
laboratory-goes-no-further = has no further transition
laboratory-path = path
laboratory-squares = squares of 5 cm
laboratory-of = { $part } of { $whole }
laboratory-walls-met = walls met
laboratory-transitions = transitions
laboratory-about-floor = Floor covered: the reachable 5 cm squares whose centre the robot passed over. The same data for programs:

## The pallet

laboratory-about-pallet = Two mobile manipulators together carry parcels from a pallet to a target area. Each robot has a behaviour tree, and the tree Supervisor coordinates both. When something goes wrong, the robots call the operator and go on after START.
laboratory-parcels = Parcels
laboratory-goes-wrong = What goes wrong:
laboratory-mishap-lost = lost on the way
laboratory-mishap-lostLifting = lost while lifted
laboratory-mishap-unrecognised = not recognised
laboratory-mishap-blocked = target closed
laboratory-mishap-jammed = gripper jams
laboratory-mishap-absent = no operator
laboratory-at-parcel = at parcel
laboratory-yard = The yard from above, with both robots and the parcels; a list beside the picture describes the events
laboratory-yard-drawn = The yard from above, with the paths of both robots and of the parcels
laboratory-key-parcel = parcel
laboratory-key-pallet = pallet
laboratory-key-target = target area
laboratory-key-way = path of a parcel
laboratory-held-force = Force
laboratory-held-angle = Angle
laboratory-held-gap = Gap
laboratory-what-happens = What happens
laboratory-happens-by-time = Events in order of time
laboratory-with-parcel = parcel { $parcel } ·
laboratory-trees-at-the-end = The trees at the end
laboratory-ends-here = The run ends here: { $why }.
laboratory-ends = The run ends: { $why }
laboratory-not-happened = Did not happen: { $what } ({ $why }).
laboratory-missed-nobodyCalled = the operator was never called
laboratory-missed-runEnded = the run ended earlier
laboratory-pair = The pair
laboratory-figure-parcels = parcels
laboratory-figure-time = time
laboratory-figure-losses = losses
laboratory-figure-force = worst force error
laboratory-figure-angle = worst angle error
laboratory-figure-gap = worst gap error
laboratory-figure-seed = seed
laboratory-delivered = { $delivered } of { $parcels } in the target area
laboratory-took = { $seconds } s, { $ticks } ticks
laboratory-error = { $worst } { $unit } (root mean square { $rms } { $unit })
laboratory-about-errors = Errors: deviations of gripping force, paddle angle and base distance from the wanted values while a parcel was off the floor. The same data for programs:

## What happens at the pallet

laboratory-began = phase { $phase }: { $what }
laboratory-phase-1 = SRM1 finds the pallet and reports its position
laboratory-phase-2 = both robots drive to the pallet, SRM2 after SRM1's report
laboratory-phase-3 = the parcel is identified, both robots stop beside the parcel
laboratory-phase-4 = the grippers close; the robots control force and angle
laboratory-phase-5 = the parcel is lifted and carried to the target area
laboratory-phase-6 = the parcel is put down and released
laboratory-phase-7 = both robots go back to the pallet
laboratory-phase-8 = phases 3 to 7 repeat for the next parcel
laboratory-alarm = ALARM: { $what }
laboratory-event-acknowledged = the operator has acknowledged the alarm
laboratory-event-start = START is pressed
laboratory-event-lost = the parcel slips out of the grippers
laboratory-event-stop = STOP: both robots are halted
laboratory-event-restart = the program was started again
laboratory-fault-operatorAbsent = the operator was called and has not come
laboratory-fault-notAllThere = the trees ended before all parcels were in the target area
laboratory-fault-runTakesTooLong = the run takes longer than its time limit
