# What scripts say: a line each, and in it only values.

## attention

attention-waits = Luggage #{ $id } waits for your verdict.
attention-denied = This browser allows no notifications of this page: its settings for this address say so.
attention-unknown = This browser has no notifications for this address: it wants https for that.

## console

console-changed = The page changed just before your press: nothing was sent. Look, then press again.
console-judged-safe = Your question is closed: luggage #{ $id } was judged SAFE by { $by } at { $time }.
console-judged-danger = Your question is closed: luggage #{ $id } was judged DANGER by { $by } at { $time }.
console-withdrawn = Your question is closed: luggage #{ $id } waits for no verdict any more.
console-twice = This came with the press before it: it was not sent. Press again.
console-refused = It was refused ({ $status }).
console-silent = No answer came. It may still be carried out: look at the robot before you try again.
console-cut = No connection: it did not get through.

## editor

editor-at = column { $x }, row { $y }: { $text }
editor-floor = floor
editor-wall = wall
editor-home = home
editor-luggage = luggage
editor-marked = luggage { $mark }
editor-dangerous = dangerous luggage { $mark }
editor-begun-brush = brush begun
editor-begun-line = line begun
editor-begun-rectangle = rectangle begun
editor-sound = It is sound: everything in it can be reached.
editor-unsound = It can be used. A search of it does not come to everything:
editor-unchecked = Not checked yet.
editor-found-pieceUnreached = the { $name } cannot be reached: no free cell beside it leads home
editor-found-cellUnreached = this free cell cannot be reached from home
editor-found-more = and { $count } more that cannot be reached
editor-found-noLuggage = there is no luggage in it: a search has nothing to inspect
editor-large = The file has { $bytes } bytes, and { $most } are the most here: start hallsweep with --hall FILE.
editor-cut = hallsweep cannot be reached: try again
editor-refused = { $detail }
editor-letters = 26 pieces have a letter already, and there are no more: make one of them plain floor first.
editor-undrawable = This hall cannot be drawn here: change it as a text below.
editor-sides = A hall here has 1 to { $most } columns and rows.
editor-home-outside = Home would be outside: move it first.
editor-open = { $file } is open: { $width } × { $height } cells, { $pieces } pieces of luggage

## hall

hall-ruler-metres = { $length } m
hall-ruler-cells = { $length } cells
hall-go = Go to column { $x }, row { $y }
hall-cell = column { $x }, row { $y }

## laboratory

laboratory-start = Start
laboratory-pause = Pause
laboratory-speed = Speed
laboratory-clock = { $time } of { $seconds } s
laboratory-clock-said = { $time } of { $seconds } seconds
laboratory-answered = hallsweep says { $status }
laboratory-cannot-move = The picture cannot move: { $why }.

## pallet

pallet-slider = Time of the pallet, in seconds
pallet-player = Player of the pallet
pallet-show = Show { $time }
pallet-nothing-held = no parcel in the grippers
pallet-lifted = the parcel is lifted
pallet-on-floor = the parcel is on the floor
pallet-phase = Phase { $phase } of 8, parcel { $parcel } of { $parcels }
pallet-before = Before the first phase
pallet-at-the-start = both robots stand where they start
pallet-where = { $delivered } of { $parcels } in the target area; { $parcel }
pallet-all-there = All parcels are in the target area
pallet-acknowledged = The alarm is acknowledged; both wait for START
pallet-nothing-waits = Nothing waits for the operator

## photo

## replay

replay-slider = Time of the retrieval, in seconds
replay-player = Player of the retrieval
replay-cannot-move = The trees cannot move: { $why }.

## roomba

roomba-slider = Time of the Roomba, in seconds
roomba-player = Player of the Roomba
roomba-now = { $phase } · floor { $share } % · walls met { $walls }

## simulator

simulator-unsent = It was not sent: hallsweep cannot be reached. Try again.

## time

time-moment = { $time }, entry { $seq } of mission { $mission }
time-now = now
time-pause = Pause
time-play = Play
time-cut = No connection: the past cannot be shown just now.

## trees

trees-idle = idle
trees-running = running
trees-success = success
trees-failure = failure
trees-skipped = skipped
trees-empty = empty
trees-tick = tick { $tick }

## verdict
