"""Ticks behaviour trees with BehaviorTree.CPP (the library behaviortreepy), as a test tells it. Standard input is a line each:
`file LINE` (of a file of trees), `mock NAME SAYS` (what a leaf says: `RUNNING,SUCCESS`, the last one for ever; its kind is `Act` or
`Ask`), `entry NAME NUMBER` (what the blackboard holds at first), and `go TICKS`, upon which it is done and everything is forgotten. Prints
of each tick what the root said, who does not stand IDLE afterwards, what the leaves said and who was halted in their order, and the
blackboard: `SUCCESS | n2=RUNNING | n1:SUCCESS n3:halt | a=1.0`. Where the library does not want to, it says `refused WHY` or `fault
WHY`; `end` follows. `written` instead of `go` prints the file that the library itself writes of the tree."""

import os
import re
import sys
import tempfile

import behaviortreepy as bt

# Only its logger tells how nodes stand, and it prints to standard output.
answers = os.fdopen(os.dup(1), "w")
printed = tempfile.TemporaryFile()
os.dup2(printed.fileno(), 1)
os.dup2(os.open(os.devnull, os.O_WRONLY), 2)

COLOUR = re.compile(r"\x1b\[[0-9;]*m")
CHANGE = re.compile(r"\[[\d.]+\]: (\S+)\s+\w+ -> (\w+)")


def changes():
    """What the logger printed since the last time: node and status."""
    printed.seek(0)
    text = COLOUR.sub("", printed.read().decode())
    printed.seek(0)
    printed.truncate()
    return CHANGE.findall(text)


def held(board, key):
    """An entry as a text; None when it holds nothing that can be read."""
    for read in (board.get_double, board.get_int, board.get_string):
        try:
            value = read(key)
            return str(float(value)) if isinstance(value, (int, float)) else value
        except Exception:
            pass
    return None


def leaves(factory, mocks, events):
    """The two kinds of leaves, which say what they were told to."""
    ticks = {}

    def said(node):
        name = node.name()
        says = mocks[name]
        word = says[min(ticks.get(name, 0), len(says) - 1)]
        ticks[name] = ticks.get(name, 0) + 1
        events.append(f"{name}:{word}")
        return getattr(bt.NodeStatus, word)

    def halted(node):
        events.append(f"{node.name()}:halt")

    factory.register_simple_stateful_action("Act", said, said, halted)
    factory.register_simple_condition("Ask", said)


def run(text, mocks, entries, ticks):
    events, standing = [], {}
    factory = bt.BehaviorTreeFactory()
    leaves(factory, mocks, events)
    board = bt.Blackboard.create()
    for name, number in entries:
        board.set_int(name, int(number))
    try:
        tree = factory.create_tree_from_text(text, board)
    except Exception as error:
        yield f"refused {error}"
        return
    logger = bt.StdCoutLogger(tree)
    changes()
    for _ in range(ticks):
        try:
            root = str(tree.tick_exactly_once()).rsplit(".")[-1]
        except Exception as error:
            yield f"fault {error}"
            return
        logger.flush()
        standing.update(changes())
        stand = sorted(f"{name}={status}" for name, status in standing.items() if status != "IDLE")
        values = {key: held(board, key) for key in board.get_keys()}
        values = sorted(f"{key}={value}" for key, value in values.items() if value is not None)
        yield " | ".join([root, " ".join(stand), " ".join(events), " ".join(values)])
        events.clear()


def written(text):
    """The tree as the library writes it: its loggers put it in front of what they record."""
    factory = bt.BehaviorTreeFactory()
    leaves(factory, {}, [])
    tree = factory.create_tree_from_text(text, bt.Blackboard.create())
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "trees.btlog")
        logger = bt.FileLogger(tree, path)
        del logger
        with open(path, "rb") as log:
            recorded = log.read()
    end = b"</root>"
    yield from recorded[recorded.index(b"<root"):recorded.index(end) + len(end)].decode().splitlines()


file, mocks, entries = [], {}, []
for line in sys.stdin:
    word, _, rest = line.rstrip("\n").partition(" ")
    if word == "file":
        file.append(rest)
    elif word == "mock":
        name, says = rest.split(" ")
        mocks[name] = says.split(",")
    elif word == "entry":
        entries.append(rest.split(" "))
    else:
        text = "\n".join(file)
        for answer in written(text) if word == "written" else run(text, mocks, entries, int(rest)):
            print(answer.replace("\n", " "), file=answers)
        print("end", file=answers, flush=True)
        file, mocks, entries = [], {}, []
