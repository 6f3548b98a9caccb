"""Asks with the library aiocoap what its command cannot: to go on observing (aiocoap-client 0.4.12 and later end an observation
with its first answer), for a size of blocks, with options by number, and from an address that is to be proved by an Echo. Prints
the code of each answer to standard error, and what it carries to standard output, a line each where it observes."""

import argparse
import asyncio
import signal
import sys

import aiocoap
from aiocoap.numbers.optionnumbers import OptionNumber


def show(answer, end):
    print(answer.code.dotted, file=sys.stderr, flush=True)
    sys.stdout.buffer.write(answer.payload + end)
    sys.stdout.buffer.flush()


async def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("url")
    parser.add_argument("--method", default="GET")
    parser.add_argument("--payload", default="")
    parser.add_argument("--observe", action="store_true")
    parser.add_argument("--accept", type=int)
    parser.add_argument("--block", type=int, help="the exponent of the size of blocks")
    parser.add_argument("--option", action="append", default=[], help="NUMBER,HEX")
    given = parser.parse_args()

    asked = aiocoap.Message(code=aiocoap.Code[given.method], uri=given.url, payload=given.payload.encode())
    if given.accept is not None:
        asked.opt.accept = given.accept
    if given.block is not None:
        asked.opt.block2 = (0, False, given.block)
    for option in given.option:
        number, value = option.split(",")
        asked.opt.add_option(OptionNumber(int(number)).create_option(decode=bytes.fromhex(value)))
    if given.observe:
        asked.opt.observe = 0

    context = await aiocoap.Context.create_client_context()
    try:
        request = context.request(asked)
        first = await request.response
        if first.code == aiocoap.UNAUTHORIZED and first.opt.echo is not None:
            request = context.request(asked.copy(echo=first.opt.echo))
            first = await request.response
        show(first, b"\n" if given.observe else b"")
        if given.observe:
            async for answer in request.observation:
                show(answer, b"\n")
    finally:
        await context.shutdown()


# A shell that runs the tests in the background has them ignore interrupts, and Python leaves that so.
signal.signal(signal.SIGINT, signal.default_int_handler)
asyncio.run(main())
