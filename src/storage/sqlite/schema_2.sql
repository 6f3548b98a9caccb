-- The commands that carry an id of their sender's, by which a repeat is known after a restart: found without reading the rest.
CREATE INDEX named_commands ON events (seq)
    WHERE kind = 'command' AND iif(json_valid(body), body ->> 'id', NULL) IS NOT NULL;
