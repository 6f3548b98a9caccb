# The page of the simulator's controls.

simulator-title = Simulator
simulator-viewer = You are signed in as a viewer: you see the simulator and may press STOP. Everything else needs an operator's key.
simulator-about = These controls change the simulated hall and its robots, not the mission: in a paused simulator, the robots do not move. STOP works at once, even in a paused simulator.

## Time.

simulator-time = Time
simulator-paused = Paused: the simulated time is stopped.
simulator-runs = Running at { $factor } times real time.
simulator-runs-max = Running as fast as it can.
simulator-go-on = Resume
simulator-pause = Pause
simulator-step = One step<small>to the end of the current order</small>
simulator-step-unpaused = One step<small>only while paused</small>
simulator-speed = Speed
simulator-speed-max = as fast as it can
simulator-set-speed = Set the speed

## Faults of the robot, by the name of what is so.

simulator-faults = Robot faults
simulator-well-linkLost = Link: working
simulator-failing-linkLost = Link: lost
simulator-means-linkLost = without the link, the robot halts by itself and the mission is held
simulator-bring-linkLost = Cut the link
simulator-mend-linkLost = Restore the link
simulator-well-noThermometer = Thermometer: working
simulator-failing-noThermometer = Thermometer: missing
simulator-means-noThermometer = without the thermometer, the robot sends no readings
simulator-bring-noThermometer = Remove the thermometer
simulator-mend-noThermometer = Restore the thermometer
simulator-well-cameraFails = Camera: working
simulator-failing-cameraFails = Camera: failing
simulator-means-cameraFails = when the camera fails, no photo succeeds
simulator-bring-cameraFails = Make the camera fail
simulator-mend-cameraFails = Repair the camera

## A blocked way.

simulator-way = Obstacles
simulator-way-about = You can add obstacles that are not part of the hall. In a cell with a robot, the obstacle appears when the robot has left.
simulator-block-ahead = Block the way ahead
simulator-block = Block this cell
simulator-free = Clear { $cell }
simulator-nothing-blocked = No cell is blocked.

## The hall.

simulator-hall = Hall
simulator-hall-now = The robots are in <b>{ $hall }</b>: { $columns } × { $rows } cells of { $side } m, { $pieces ->
    [one] { $pieces } piece
   *[other] { $pieces } pieces
} of luggage; seed { $seed }.
simulator-seed = Seed
simulator-put-down = Use this hall
simulator-bound = At the moment: { $why }.
simulator-to-editor = Edit the hall
simulator-start = START the search
