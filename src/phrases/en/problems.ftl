# What was not done, and why. In English that is the detail, with which programs are answered too.

## The titles of the page that says a problem, by status.

astray-400 = That was not understood
astray-401 = Nobody is signed in
astray-403 = You may not do that
astray-404 = There is nothing here
astray-408 = It came too slowly
astray-409 = That is not possible now
astray-421 = hallsweep is not called so
astray-500 = Something went wrong in hallsweep
astray-503 = That cannot be done just now

## By code: what the core refuses.

problem-held = { $detail }
problem-outdated = { $detail }
problem-sentBefore = { $detail }
problem-notInPhase = { $detail }
problem-verdictPending = { $detail }
problem-driving = { $detail }
problem-notStopped = { $detail }
problem-intoObstacle = { $detail }
problem-notCapable = { $detail }
problem-moving = { $detail }
problem-unrecorded = { $detail }
problem-bombUnfetched = { $detail }
problem-unknownLuggage = { $detail }
problem-nothingPending = { $detail }
problem-decided = { $detail }
problem-noPhoto = { $detail }
problem-notInspected = { $detail }
problem-photoUnderWay = { $detail }
problem-unknownAlarm = { $detail }
problem-noRetrievalRobot = { $detail }
problem-fetcherUnreached = { $detail }
problem-fetcherAbroad = { $detail }
problem-faultStands = { $detail }
problem-storeDown = { $detail }
problem-notKept = { $detail }
problem-otherContent = { $detail }
problem-unknownSensor = { $detail }
problem-notAllowed = { $detail }

## What never reaches it.

problem-malformed = { $detail }
problem-unusable = { $detail }
problem-tooLarge = { $detail }
problem-tooSlow = { $detail }
problem-unsupportedMediaType = { $detail }
problem-methodNotAllowed = { $detail }
problem-notAcceptable = { $detail }
problem-notFound = { $detail }
problem-notSignedIn = { $detail }
problem-foreignOrigin = { $detail }
problem-foreignHost = { $detail }
problem-tooManyStreams = { $detail }
problem-tooManyRuns = { $detail }
problem-noPlace = { $detail }
problem-noDate = { $detail }
problem-internal = { $detail }
problem-shuttingDown = { $detail }
problem-unreadable = { $detail }

## Of the simulator.

problem-boundToHall = { $detail }
problem-notSimulated = { $detail }
problem-notPaused = { $detail }
problem-nothingUnderWay = { $detail }
problem-unusableHall = { $detail }
problem-notBlocked = { $detail }
problem-hallNotKept = { $detail }
