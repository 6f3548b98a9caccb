-- The journal: what happened, in order. This is the truth: no entry is ever changed. Nor is any removed that was said to be kept;
-- only what was said to be lost, and turns out to be on the disk all the same, is taken back (see losses).
CREATE TABLE events (
    seq      INTEGER PRIMARY KEY,   -- its place, from 1
    mission  INTEGER,               -- the mission it belongs to; null between two
    at_ms    INTEGER NOT NULL,      -- when: milliseconds since 1970 and
    offset_s INTEGER NOT NULL,      -- seconds east of UTC
    kind     TEXT NOT NULL,         -- as in body, for the indices
    body     TEXT NOT NULL          -- the fact as JSON
) STRICT;

CREATE TRIGGER events_stay_as_they_are BEFORE UPDATE ON events
BEGIN
    SELECT raise(ABORT, 'the journal is never changed');
END;

CREATE INDEX events_of_mission ON events (mission, seq);

-- Everything that stood at that moment: reading begins at the last of these.
CREATE INDEX standings ON events (seq) WHERE kind = 'standing';

-- What the tables below follow from.
CREATE INDEX milestones ON events (seq)
    WHERE kind IN ('standing', 'missionBegan', 'missionArchived', 'phase', 'luggage', 'verdict');

-- After a failure the store goes on behind the last entry that it had kept: the numbers up to the next entry were lost.
CREATE TABLE losses (
    kept  INTEGER PRIMARY KEY,  -- that entry
    times INTEGER NOT NULL      -- how often going on was tried
) STRICT;

-- From here on: what follows from the journal, written with it, and rebuilt from it by `hallsweep journal rebuild`.
CREATE TABLE missions (
    id                INTEGER PRIMARY KEY,
    strategy          TEXT NOT NULL,
    began_ms          INTEGER NOT NULL,
    began_offset_s    INTEGER NOT NULL,
    archived_ms       INTEGER,
    archived_offset_s INTEGER,
    archived_seq      INTEGER,      -- the entry before which the mission stood as it ended
    phase             TEXT NOT NULL,
    left_in_place     TEXT NOT NULL DEFAULT '[]'
) STRICT;

CREATE TABLE photos (
    digest     TEXT PRIMARY KEY,    -- SHA-256, hexadecimal: the name of the file
    media_type TEXT NOT NULL,
    bytes      INTEGER NOT NULL
) STRICT;

CREATE TABLE luggage (
    id               INTEGER PRIMARY KEY,
    mission          INTEGER,
    record           TEXT NOT NULL, -- as JSON, without the verdict
    photo            TEXT REFERENCES photos (digest),
    verdict          TEXT,
    decided_by       TEXT,
    decided_ms       INTEGER,
    decided_offset_s INTEGER
) STRICT;

CREATE INDEX luggage_of_mission ON luggage (mission);
