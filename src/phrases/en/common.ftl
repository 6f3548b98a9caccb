# What every page has.

list = { $first } and { $last }
to-console = To the console

## The rail at the left, and its menu.

rail = Pages of hallsweep
rail-operate = Operate
rail-interface = API
rail-menu = Settings
colours = Colours
colours-system = as the system
colours-light = light
colours-dark = dark
colours-contrast = high contrast

## STOP. Where a value belongs, its script puts it in place of {}.

stop-note = halts all robots
stop-soon = STOP is on its way…
stop-confirmed = STOP is confirmed.
stop-unconfirmed = STOP is not confirmed: { "{}" }. Use the robot's own switch. This page continues to send STOP.
stop-left = the page was left before an answer came
stop-says = hallsweep says: { "{}" }
stop-silent = no answer came
stop-cut = there is no connection

## The bar of other pages than the console.

bar-as-of = as of { $time } ({ $zone })
bar-over = You are not signed in any more. Sign in again, in another tab if you still need this page.
bar-silent = hallsweep does not answer: what this page shows may no longer be true.

## Months, in short.

month-Jan = Jan
month-Feb = Feb
month-Mar = Mar
month-Apr = Apr
month-May = May
month-Jun = Jun
month-Jul = Jul
month-Aug = Aug
month-Sep = Sep
month-Oct = Oct
month-Nov = Nov
month-Dec = Dec
