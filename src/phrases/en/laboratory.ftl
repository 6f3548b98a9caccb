# The laboratory: the Roomba and the pallet.

laboratory-title = Laboratory
laboratory-moves-nothing = What is shown here is computed and moves nothing in the hall. STOP halts the hall's robots, as on every page.
laboratory-roomba = Roomba
laboratory-pallet = Pallet
laboratory-seed = Seed
laboratory-run = Run
laboratory-at-the-end = At the end

## The Roomba

laboratory-about-roomba = A round robot in an empty room: 3 s forward, then 20 s in a growing spiral, and again; at a wall half a second back and a turn by a random angle. Once it is driven by a state machine, once by a behaviour tree. With the same seed both do the same.
laboratory-seconds = Seconds
laboratory-room = The room from above, with the way of the robot
laboratory-machine = Machine
laboratory-tree = Tree
laboratory-state-machine = State machine
laboratory-behaviour-tree = Behaviour tree
laboratory-column-machine = machine
laboratory-column-tree = tree
laboratory-diagram-machine = The state machine: MoveForward and MoveInSpiral follow one another in time; a wall leads from both to GoBack, then Rotate, then MoveForward
laboratory-diagram-tree = The behaviour tree: a Selector over two Sequences, MoveForward and MoveInSpiral, GoBack and Rotate
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
laboratory-parting = machine and tree part after { $common } transitions: the machine { $machine }, the tree { $tree }
laboratory-goes = goes from { $from } to { $to } at { $seconds } s
laboratory-turns = goes from { $from } to { $to } by { $angle } rad at { $seconds } s
laboratory-goes-no-further = has no further transition
laboratory-path = path
laboratory-squares = squares of 5 cm
laboratory-of = { $part } of { $whole }
laboratory-walls-met = walls met
laboratory-transitions = transitions
laboratory-about-floor = Floor: squares of 5 cm whose centre the robot was over, of those that it can reach. The same in numbers:

## The pallet

laboratory-about-pallet = Two mobile manipulators carry parcels from a pallet to a target area, each parcel between them. Three behaviour trees lead them: one each, and a Supervisor. When something goes wrong they call the operator, and go on after START.
laboratory-parcels = Parcels
laboratory-goes-wrong = Goes wrong:
laboratory-mishap-lost = lost on the way
laboratory-mishap-lostLifting = lost while lifted
laboratory-mishap-unrecognised = not recognised
laboratory-mishap-blocked = target closed
laboratory-mishap-jammed = gripper jams
laboratory-mishap-absent = no operator
laboratory-at-parcel = at parcel
laboratory-yard = The yard from above, with both robots and the parcels; what happens stands in words beside it
laboratory-yard-drawn = The yard from above, with the ways of both robots and of the parcels
laboratory-key-parcel = parcel
laboratory-key-pallet = pallet
laboratory-key-target = target area
laboratory-key-way = way of a parcel
laboratory-held-force = Force
laboratory-held-angle = Angle
laboratory-held-gap = Gap
laboratory-what-happens = What happens
laboratory-happens-by-time = What happens, by its time
laboratory-with-parcel = parcel { $parcel } ·
laboratory-trees-at-the-end = The trees as they stood at the end
laboratory-ends-here = The run ends here: { $why }.
laboratory-ends = The run ends: { $why }
laboratory-not-happened = Did not happen: { $what } ({ $why }).
laboratory-missed-nobodyCalled = the operator was never called
laboratory-missed-runEnded = the run ended before it could happen
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
laboratory-about-errors = Errors: how far gripping force, angle of the paddles and distance of the bases were from what is wanted while a parcel was off the floor. The same in numbers:

## What happens at the pallet

laboratory-began = phase { $phase }: { $what }
laboratory-phase-1 = SRM1 finds the pallet and tells where it is
laboratory-phase-2 = both come to the pallet, SRM2 when it has been told where it is
laboratory-phase-3 = the parcel is identified, both stand beside it
laboratory-phase-4 = the grippers close; force and angle are held
laboratory-phase-5 = the parcel is lifted and carried to the target area
laboratory-phase-6 = the parcel is put down and let go
laboratory-phase-7 = both go back to the pallet
laboratory-phase-8 = the same for the next parcel
laboratory-alarm = ALARM: { $what }
laboratory-event-acknowledged = the operator has acknowledged the alarm
laboratory-event-start = START is pressed
laboratory-event-lost = the parcel slips out of the grippers
laboratory-event-stop = STOP: both robots are halted
laboratory-event-restart = the program was started again
laboratory-fault-operatorAbsent = the operator was called and has not come
laboratory-fault-notAllThere = the trees ended, and not all parcels are in the target area
laboratory-fault-runTakesTooLong = the run takes longer than it ever should
