# The pages of missions: their list, one of them, and the retrieval in it.

missions-title = Missions
missions-of = Mission { $id }
missions-times = Times are in { $zone }.
missions-pages = Pages

## The list

missions-newest-first = Missions, the newest first
missions-none = No mission has begun yet. Press START on the console.
missions-none-older = There are no older missions.
missions-began = Began
missions-archived = Archived
missions-came-to = Outcome
missions-pieces = Pieces
missions-dangerous = Dangerous
missions-not-yet = not yet
missions-newest = The newest
missions-older = Older missions

## What a mission came to

missions-searched = The whole hall was searched
missions-searched-of = Everything that can be reached from the start was searched: { $reachable } of { $free } free cells
missions-searched-reachable = Everything that can be reached from the start was searched
missions-bomb-located = A bomb was located
missions-bomb-secured = The bomb was fetched and secured
missions-under-way = Under way: { $phase }
missions-archived-while = Put away while { $phase }
missions-left = { $outcome }; luggage { $which } was left in place

## One of them

missions-luggage = Luggage
missions-luggage-count = { $count }, of them dangerous: { $dangerous }
missions-zone = Times
missions-in-zone = in { $zone }
missions-its-trees = Behaviour trees of the retrieval
receipts-link = Hand-overs
receipts-title = Hand-overs of mission { $mission }
receipts-none = This mission has not been handed over.
receipts-no-later = There is no later hand-over.
receipts-later = Later hand-overs
receipt-to = Receipt for the hand-over to { $to }
receipt-time = When
receipt-by = Handed over by
receipt-code = Code
receipt-no-code = none, because this journal is not kept on disk
receipt-how = To check that the record up to this hand-over was not changed:
receipt-handed-over = Signature of who hands over
receipt-received = Signature of who takes over
missions-conditions = Conditions
missions-report = Download the report
missions-cells-visited = Cells visited
missions-missing = What is missing here
missions-damaged = Part of this mission's record is damaged. This page shows the rest, without what depends on the damaged part:
missions-replay = Replay this mission
missions-hall-known = The known part of the hall
missions-no-luggage = None was met.
missions-not-kept = The map and the luggage of this mission are not stored.
missions-happened = What happened, oldest first
missions-show-main = What was done and found
missions-show-commands = Commands only
missions-show-all = Every step
missions-nothing = There are no events of this kind.
missions-as-it-stood = the hall at that moment
missions-by = by { $who }:
missions-from-beginning = From the beginning
missions-further = Further events

## The legend of its hall


## The retrieval

missions-retrieval-in = Retrieval in mission { $id }
missions-fetched-by-pair = Retrieval of luggage #{ $luggage } by the pair
missions-fetched-alone = Retrieval of luggage #{ $luggage } by the robot that searched
missions-trees-stood = Behaviour trees
missions-moment = { $seconds } s after the retrieval began, moment { $moment } of { $last }
missions-incomplete = Only part of this retrieval's record can be shown: the record is too long or damaged.
missions-no-trees = This retrieval used no behaviour trees.
missions-moment-first = First
missions-moment-previous = Previous
missions-moment-next = Next
missions-moment-last = Last
missions-seconds-since = Times are in seconds since the retrieval began. The same data for programs:
bundle-photo-lost = Photo { $take } of luggage #{ $id } is lost.
bundle-readme =
    Mission { $mission }, as hallsweep has recorded it.

    report.html    the report: the hall, all pieces with photos and verdicts, alarms, commands, events
    entries.jsonl  every entry of this mission, one JSON object in each line
    photos         all photos, named by the piece and by the number of the photo
    SHA256SUMS     the SHA-256 of each of these files

    To check the files, hallsweep is not needed. Unpack them, and in this folder run

    sha256sum -c SHA256SUMS

    This shows that the files belong to this list. Whether it is the list that was handed over is shown by the
    SHA-256 of the list itself, which was written down when the bundle was made:

    sha256sum SHA256SUMS

    On Windows, certutil -hashfile FILE SHA256 computes the SHA-256 of one file.

    Whoever has the journal can also compare the report with it: hallsweep journal check --report report.html
