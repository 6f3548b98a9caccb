# What scripts say: a line each, and in it only values.

## attention

attention-waits = Luggage #{ $id } waits for your verdict.
attention-denied = This browser blocks notifications from this page: check the browser's settings for this address.
attention-unknown = This browser offers no notifications here: notifications need https.

## console

console-changed = The page changed just before you pressed: nothing was sent. Check the page, then press again.
console-judged-safe = Your question is closed: luggage #{ $id } was judged SAFE by { $by } at { $time }.
console-judged-danger = Your question is closed: luggage #{ $id } was judged DANGER by { $by } at { $time }.
console-kept-back = Your answer about luggage #{ $id } is recorded. It stays hidden until another judge has answered.
console-withdrawn = Your question is closed: luggage #{ $id } no longer waits for a verdict.
console-twice = This press came too soon after the last press and was not sent. Press again.
console-refused = hallsweep refused the command ({ $status }).
console-silent = No answer came. The command may still be carried out: look at the robot before you try again.
console-cut = No connection: the command did not get through.

## editor

editor-at = column { $x }, row { $y }: { $text }
editor-floor = floor
editor-wall = wall
editor-home = home
editor-luggage = luggage
editor-marked = luggage { $mark }
editor-dangerous = dangerous luggage { $mark }
editor-begun-brush = brush started
editor-begun-line = line started
editor-begun-rectangle = rectangle started
editor-area-name = Area { $number }
editor-in-area = in the area { $name }
editor-begun-outline = outline with { $corners } corners started
editor-area-discard = Delete area { $name }
editor-rest = Probability outside the areas: { $rest }
editor-probability = Give the area a probability from 0 to 1.
editor-corners = An area has at most { $most } corners: press on the first corner.
editor-sound = The hall is valid: everything in the hall can be reached.
editor-unsound = The hall can be used, but a search does not reach everything:
editor-unchecked = The hall is not checked yet.
editor-found-pieceUnreached = the { $name } cannot be reached: no free cell beside it leads home
editor-found-cellUnreached = this free cell cannot be reached from home
editor-found-more = { $count } more places cannot be reached
editor-found-noLuggage = the hall contains no luggage: a search has nothing to inspect
editor-large = The file has { $bytes } bytes, more than the limit of { $most }: start hallsweep with --hall FILE.
editor-cut = hallsweep cannot be reached: try again
editor-refused = { $detail }
editor-letters = All 26 letters are in use: change one of the marked pieces to floor first.
editor-undrawable = This hall cannot be drawn here: edit the text below.
editor-sides = A hall here has 1 to { $most } columns and rows.
editor-home-outside = Home would be outside the hall: move home first.
editor-open = { $file } is open: { $width } × { $height } cells, { $pieces } pieces of luggage

## hall

hall-ruler-metres = { $length } m
hall-ruler-cells = { $length } cells
hall-go = Go to column { $x }, row { $y }
hall-cell = column { $x }, row { $y }

## laboratory

laboratory-start = Play
laboratory-pause = Pause
laboratory-speed = Speed
laboratory-clock = { $time } of { $seconds } s
laboratory-clock-said = { $time } of { $seconds } seconds
laboratory-answered = hallsweep answered { $status }
laboratory-cannot-move = The animation cannot play: { $why }.

## pallet

pallet-slider = Time of the pallet, in seconds
pallet-player = Player of the pallet
pallet-show = Show { $time }
pallet-nothing-held = no parcel in the grippers
pallet-lifted = the parcel is lifted
pallet-on-floor = the parcel is on the floor
pallet-phase = Phase { $phase } of 8, parcel { $parcel } of { $parcels }
pallet-before = Before the first phase
pallet-at-the-start = both robots are at their start positions
pallet-where = { $delivered } of { $parcels } in the target area; { $parcel }
pallet-all-there = All parcels are in the target area
pallet-acknowledged = The alarm is acknowledged; both robots wait for START
pallet-nothing-waits = Nothing waits for the operator

## photo

## replay

replay-slider = Time of the retrieval, in seconds
replay-player = Player of the retrieval
replay-cannot-move = The replay cannot play: { $why }.

## roomba

roomba-slider = Time of the Roomba, in seconds
roomba-player = Player of the Roomba
roomba-now = { $phase } · floor { $share } % · walls met { $walls }

## simulator

simulator-unsent = The command was not sent: hallsweep cannot be reached. Try again.

## time

time-moment = { $time }, entry { $seq } of mission { $mission }
time-now = now
time-pause = Pause
time-play = Play
time-cut = No connection: the past cannot be shown now.

## trees

trees-idle = idle
trees-running = running
trees-success = success
trees-failure = failure
trees-skipped = skipped
trees-empty = empty
trees-tick = tick { $tick }

## verdict
