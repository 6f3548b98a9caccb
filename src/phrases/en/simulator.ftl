# The page of the simulator's controls.

simulator-title = Simulator
simulator-viewer = You are signed in as a viewer: you see the simulator and may press STOP. Everything else asks for an operator's key.
simulator-about = What is done here is done to the simulated hall and its robots, and not to the mission: a paused simulator is a robot that does not get on. STOP halts it all the same, at once.

## Time.

simulator-time = Time
simulator-paused = Paused: simulated time stands still.
simulator-runs = Running at { $factor } times real time.
simulator-runs-max = Running as fast as it can.
simulator-go-on = Go on
simulator-pause = Pause
simulator-step = One step<small>to the end of the order under way</small>
simulator-step-unpaused = One step<small>while it is paused</small>
simulator-speed = Speed
simulator-speed-max = as fast as it can
simulator-set-speed = Set the speed

## Faults of the robot, by the name of what is so.

simulator-faults = Faults of the robot
simulator-well-linkLost = Link: well
simulator-failing-linkLost = Link: failing
simulator-means-linkLost = without it the robot halts by itself and the mission is held
simulator-bring-linkLost = Lose the link
simulator-mend-linkLost = Restore the link
simulator-well-noThermometer = Thermometer: well
simulator-failing-noThermometer = Thermometer: failing
simulator-means-noThermometer = without it no reading of the robot comes
simulator-bring-noThermometer = Take the thermometer away
simulator-mend-noThermometer = Give the thermometer back
simulator-well-cameraFails = Camera: well
simulator-failing-cameraFails = Camera: failing
simulator-means-cameraFails = when it fails, no photo succeeds
simulator-bring-cameraFails = Let the camera fail
simulator-mend-cameraFails = Mend the camera

## A blocked way.

simulator-way = A blocked way
simulator-way-about = An obstacle that is not in the hall. Where a robot is, it is put as soon as the robot has left.
simulator-block-ahead = Block the way ahead
simulator-block = Block this cell
simulator-free = Clear { $cell }
simulator-nothing-blocked = Nothing is in the way.

## The hall.

simulator-hall = Hall
simulator-hall-now = The robots are in <b>{ $hall }</b>: { $columns } × { $rows } cells of { $side } m, { $pieces ->
    [one] { $pieces } piece
   *[other] { $pieces } pieces
} of luggage; seed { $seed }.
simulator-seed = Seed
simulator-put-down = Put the robots down there
simulator-bound = Just now: { $why }.
simulator-to-editor = Edit the hall
simulator-start = START the search
