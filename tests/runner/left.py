"""Finds the files of splinecast in /dev/shm that tests have not removed."""

import fcntl
import os
import re
import struct
import time

FOLDER = "/dev/shm"
OF_A_TEST = re.compile(r"splinecast\.test\.(\d+)\.")
PATIENCE = 20.0  # seconds, for processes that end


def names(folder=FOLDER):
    """The names of splinecast's files."""
    return {name for name in os.listdir(folder) if name.startswith("splinecast.")}


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


def left(before, is_own, folder=FOLDER):
    """New names of streams without an owner. In a shared folder: those of tests whose process has ended."""
    present = names(folder)
    owned = {name.rsplit(".", 2)[0] for name in present
             if name.endswith(".lock") and is_locked(os.path.join(folder, name))}
    new = [name for name in sorted(present - before) if name.removesuffix(".lock").rsplit(".", 1)[0] not in owned]
    if is_own:
        return new
    tests = ((name, OF_A_TEST.match(name)) for name in new)
    return [name for name, test in tests if test and not os.path.exists(f"/proc/{test.group(1)}")]


def wait_for_removal(before, is_own, folder=FOLDER, patience=PATIENCE):
    """What is left when the last processes have had time to end."""
    end = time.monotonic() + patience
    while (found := left(before, is_own, folder)) and time.monotonic() < end:
        time.sleep(0.1)
    return found
