-- The chain of digests: of each page, the entries that one input put on record, by which a change is found out. How it is made of them
-- stands in chain.rs; no page is ever changed, and only those of entries that are taken back go with them.
CREATE TABLE pages (
    last   INTEGER PRIMARY KEY,     -- its last entry
    digest BLOB NOT NULL            -- SHA-256 of the digest of the page before and of its entries
) STRICT;

CREATE TRIGGER pages_stay_as_they_are BEFORE UPDATE ON pages
BEGIN
    SELECT raise(ABORT, 'the journal is never changed');
END;
