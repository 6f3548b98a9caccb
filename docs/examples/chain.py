#!/usr/bin/env python3
"""Checks the chain of digests of a journal without hallsweep: python3 chain.py DIR/journal.db

Prints the head, or names the page that is not what it was. It reads while hallsweep runs, and writes nothing.
"""

import hashlib
import json
import sqlite3
import sys

journal = sqlite3.connect(f"file:{sys.argv[1]}?mode=ro", uri=True)
pages = journal.execute("SELECT last, digest FROM pages ORDER BY last").fetchall()
before, first = bytes(32), 1
begins = journal.execute("SELECT min(seq) FROM events").fetchone()[0] or 1
for last, digest in pages:
    if last < begins:  # what stands before is in an archive, whose last page this is
        before, first = digest, last + 1
        continue
    columns = "seq, mission, at_ms, offset_s, kind, body"
    page = hashlib.sha256(before)
    for entry in journal.execute(f"SELECT {columns} FROM events WHERE seq BETWEEN ? AND ? ORDER BY seq", (first, last)):
        line = json.dumps(entry, ensure_ascii=False, separators=(",", ":"))
        page.update(line.encode() + b"\n")
    if page.digest() != digest:
        sys.exit(f"entries {first} to {last} are not what was kept")
    before, first = digest, last + 1
print(f"entry {first - 1} sha256 {before.hex()}")
