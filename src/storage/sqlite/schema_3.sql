-- What an operator noted with a verdict.
ALTER TABLE luggage ADD COLUMN note TEXT;

-- Every photo that was taken of a piece, the newest among them: follows from the journal like the tables before.
CREATE TABLE takes (
    luggage INTEGER NOT NULL,
    take    INTEGER NOT NULL,       -- from 1
    photo   TEXT NOT NULL REFERENCES photos (digest),
    PRIMARY KEY (luggage, take)
) STRICT;

INSERT OR REPLACE INTO takes (luggage, take, photo)
    SELECT body ->> '$.luggage.id', body ->> '$.luggage.photo.taken.take', digest
    FROM (SELECT seq, iif(json_valid(body), body, '{}') AS body FROM events WHERE kind = 'luggage')
    JOIN photos ON digest = body ->> '$.picture.digest'
    WHERE json_type(body, '$.luggage.id') = 'integer' AND json_type(body, '$.luggage.photo.taken.take') = 'integer'
    ORDER BY seq;
