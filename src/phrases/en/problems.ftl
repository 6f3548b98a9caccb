# What was not done, and why. In English that is the detail, with which programs are answered too.

## The titles of the page that says a problem, by status.

astray-400 = The request was not understood
astray-401 = You are not signed in
astray-403 = This request is not allowed
astray-404 = Page not found
astray-nothing = No page of hallsweep has this address. Perhaps it was mistyped, or what it led to is gone.
astray-408 = The request came too slowly
astray-409 = This request is not possible now
astray-421 = hallsweep does not have this name
astray-500 = Something went wrong in hallsweep
astray-503 = This request cannot be carried out now

## By code: what the core refuses in words of another version.

problem-refused = { $detail }

## What never reaches it.

problem-malformed = { $detail }
problem-moreOpen = { $detail }
problem-unusable = { $detail }
problem-tooLarge = { $detail }
problem-tooSlow = { $detail }
problem-unsupportedMediaType = { $detail }
problem-methodNotAllowed = { $detail }
problem-notAcceptable = { $detail }
problem-notFound = { $detail }
problem-noHall = { $detail }
problem-notSignedIn = { $detail }
problem-foreignOrigin = { $detail }
problem-foreignHost = { $detail }
problem-tooManyStreams = { $detail }
problem-tooManyRuns = { $detail }
problem-tooManyReports = { $detail }
problem-noPlace = { $detail }
problem-noDate = { $detail }
problem-internal = { $detail }
problem-shuttingDown = { $detail }
problem-unreadable = { $detail }

## Of the simulator.

problem-boundToHall = { $detail }
problem-notSimulated = { $detail }
problem-exerciseRunning = { $detail }
problem-notPaused = { $detail }
problem-nothingUnderWay = { $detail }
problem-unusableHall = { $detail }
problem-notBlocked = { $detail }
problem-hallNotKept = { $detail }
problem-notAName = { $detail }
problem-nameTaken = { $detail }
problem-tooManyKept = { $detail }
problem-noDataFolder = { $detail }
problem-cannotChangeKept = { $detail }
problem-anotherKept = { $detail }
