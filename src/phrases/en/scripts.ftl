# What scripts say: a line each, and in it only values.

## attention

attention-waits = Luggage #{ $id } waits for your verdict.
attention-denied = This browser allows no notifications of this page: its settings for this address say so.
attention-unknown = This browser has no notifications for this address: it wants https for that.

## console

console-changed = The piece has just changed: this was not sent. Look, then press again.
console-twice = This came with the press before it: it was not sent. Press again.
console-refused = It was refused ({ $status }).
console-silent = No answer came. It may still be carried out: look at the robot before you try again.
console-cut = No connection: it did not get through.

## editor

## hall

hall-ruler-metres = { $length } m
hall-ruler-cells = { $length } cells
hall-go = Go to column { $x }, row { $y }
hall-cell = column { $x }, row { $y }

## laboratory

## pallet

## photo

## replay

## roomba

## simulator

## time

time-moment = { $time }, entry { $seq } of mission { $mission }
time-now = now
time-pause = Pause
time-play = Play
time-cut = No connection: the past cannot be shown just now.

## trees

## verdict
