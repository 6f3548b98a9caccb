-- What an operator noted with a verdict.
ALTER TABLE luggage ADD COLUMN note TEXT;
