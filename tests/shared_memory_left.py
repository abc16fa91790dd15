#!/usr/bin/env python3
"""Finds files of splinecast in /dev/shm that a run has not removed.

    shared_memory_left.py list [FOLDER]          prints their names
    shared_memory_left.py check [FOLDER] < LIST  exits with 1 if a name is not on LIST and has no
                                                 living owner

A living owner holds the lock of its lock file. Processes have $PATIENCE (5) seconds to end and to
remove their files.
"""

import fcntl
import os
import struct
import sys
import time

FOLDER = sys.argv[2] if len(sys.argv) > 2 else "/dev/shm"
PREFIX = "splinecast."
PATIENCE = float(os.environ.get("PATIENCE", "5"))


def names():
    """The names of splinecast's files."""
    return sorted(name for name in os.listdir(FOLDER) if name.startswith(PREFIX))


def is_locked(path):
    """Whether a process holds a file's lock."""
    query = struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW)
    except OSError:
        return False
    try:
        answer = fcntl.fcntl(descriptor, fcntl.F_OFD_GETLK, query)
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return struct.unpack("hhqqi", answer)[0] != fcntl.F_UNLCK


def left(before):
    """New names of streams without a held lock."""
    new = [name for name in names() if name not in before]
    living = {name.rsplit(".", 2)[0] for name in names()
              if name.endswith(".lock") and is_locked(os.path.join(FOLDER, name))}
    stream = {name: name.removesuffix(".lock").rsplit(".", 1)[0] for name in new}
    return [name for name in new if stream[name] not in living]


def main():
    """Runs the command."""
    if sys.argv[1] == "list":
        print("\n".join(names()))
        return 0
    before = set(sys.stdin.read().split("\n"))
    end = time.monotonic() + PATIENCE
    while (found := left(before)) and time.monotonic() < end:
        time.sleep(0.1)
    for name in found:
        print(f"not removed: {FOLDER}/{name}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
