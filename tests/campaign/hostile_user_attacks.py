#!/usr/bin/env python3
"""Attacks of a hostile local user in /dev/shm. hostile_user.py runs them in a mount namespace.

    hostile_user_attacks.py SECONDS SEED [--same-user] STREAM...

Prints a JSON object with the number of attacks of each kind. Attacks that the kernel refuses count too,
because the streams rely on the refusal.
"""

import ctypes
import fcntl
import json
import mmap
import os
import random
import signal
import socket
import struct
import sys
import threading
import time

SHM = b"/dev/shm/"
ENDS = [b".waypoints", b".spline", b".waypoints.lock", b".spline.lock"]
OFD_SETLK = 37
RENAME_EXCHANGE, AT_FDCWD = 2, -100
SYS_FUTEX, FUTEX_WAIT = 202, 0
CONTROL_OFFSET = 88  # of the header: where the commit word is
WAITERS = 500
LIBC = ctypes.CDLL(None, use_errno=True)


class Timespec(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long)]


class Attacker:
    def __init__(self, seed, streams, is_same_user):
        self.random = random.Random(seed)
        self.streams = [stream.encode() for stream in streams]
        self.is_same_user = is_same_user
        self.number = 0
        self.made = []
        self.held = []
        self.counts = {}

    def name(self, end=None):
        """A new path with a name that a stream could have."""
        self.number += 1
        return SHM + b"splinecast.evil%d" % self.number + (end or self.random.choice(ENDS))

    def file(self, path, content=b""):
        descriptor = os.open(path, os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW, self.random.choice([0o600, 0o644, 0o666]))
        os.write(descriptor, content)
        self.made.append(path)
        return descriptor

    def victims_region(self):
        return SHM + b"splinecast." + self.random.choice(self.streams) + self.random.choice(ENDS[:2])

    def copy_of_region(self, most=1 << 20):
        try:
            with open(self.victims_region(), "rb") as region:
                return region.read(most)
        except OSError:
            return bytes(16384)

    def clean(self):
        for descriptor in self.held:
            os.close(descriptor)
        self.held.clear()
        for path in self.made:
            try:
                os.unlink(path)
            except IsADirectoryError:
                os.rmdir(path)
            except FileNotFoundError:
                pass
        self.made.clear()

    # The attacks.

    def invalid_names(self):
        for middle in (b"a bad", b"\x1b[2Jx", b"new\nline", b".dot", b"\xff\xfe", b"", b"a;b", b"x" * 129):
            os.close(self.file(SHM + b"splinecast." + middle + self.random.choice(ENDS)))

    def names_of_255_bytes(self):
        for end in ENDS:
            os.close(self.file(SHM + b"splinecast." + b"n" * (255 - 11 - len(end)) + end))

    def empty_files(self):
        os.close(self.file(self.name()))

    def copies_of_regions(self):
        self.number += 1
        for end in ENDS[:2]:
            os.close(self.file(SHM + b"splinecast.copy%d" % self.number + end, self.copy_of_region()))

    def truncated_regions(self):
        descriptor = self.file(self.name(self.random.choice(ENDS[:2])), self.copy_of_region())
        for _ in range(50):
            os.ftruncate(descriptor, self.random.choice([0, 1, 100, 4095, 8192, 12287, 12288, 1 << 16, 1 << 22]))
        os.close(descriptor)

    def exchanged_fifos(self):
        path, other = self.name(self.random.choice(ENDS)), self.name(b".other")
        os.close(self.file(path, self.copy_of_region(16384)))
        os.mkfifo(other)
        self.made.append(other)
        end = time.monotonic() + 0.1
        while time.monotonic() < end:
            LIBC.renameat2(AT_FDCWD, path, AT_FDCWD, other, RENAME_EXCHANGE)

    def exchanged_links(self):
        path, other = self.name(self.random.choice(ENDS)), self.name(b".other")
        os.close(self.file(path, self.copy_of_region(16384)))
        os.symlink(self.random.choice([self.victims_region(), b"/dev/zero", other, b"/proc/self/mem"]), other)
        self.made.append(other)
        end = time.monotonic() + 0.1
        while time.monotonic() < end:
            LIBC.renameat2(AT_FDCWD, path, AT_FDCWD, other, RENAME_EXCHANGE)

    def fifos(self):
        path = self.name()
        os.mkfifo(path)
        self.made.append(path)

    def symbolic_links(self):
        for target in (self.victims_region(), b"/etc/passwd", b"/dev/shm", b"nothing"):
            path = self.name()
            os.symlink(target, path)
            self.made.append(path)

    def hard_links(self):
        self.number += 1
        for end in ENDS[:2]:
            path = SHM + b"splinecast.linked%d" % self.number + end
            try:
                os.link(SHM + b"splinecast." + self.random.choice(self.streams) + end, path)
                self.made.append(path)
            except OSError:
                pass

    def folders(self):
        path = self.name()
        os.mkdir(path)
        self.made.append(path)

    def sockets(self):
        path = self.name()
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(path)
        self.made.append(path)

    def held_locks(self):
        self.number += 1
        for end in ENDS:
            descriptor = self.file(SHM + b"splinecast.locked%d" % self.number + end, self.copy_of_region(16384))
            fcntl.fcntl(descriptor, OFD_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 0, 0, 0))
            self.held.append(descriptor)

    def leases(self):
        path = self.name()
        os.close(self.file(path, self.copy_of_region(16384)))
        os.chmod(path, 0o644)
        descriptor = os.open(path, os.O_RDWR)
        self.held.append(descriptor)
        try:
            fcntl.fcntl(descriptor, fcntl.F_SETLEASE, fcntl.F_WRLCK)
        except BlockingIOError:
            pass  # another process has the file open

    def locks_on_files_of_others(self):
        for stream in self.streams:
            for end in ENDS:
                try:
                    descriptor = os.open(SHM + b"splinecast." + stream + end, os.O_RDONLY)
                except OSError:
                    continue
                self.held.append(descriptor)
                for lock in (lambda f: fcntl.flock(f, fcntl.LOCK_EX | fcntl.LOCK_NB),
                             lambda f: fcntl.lockf(f, fcntl.LOCK_SH | fcntl.LOCK_NB),
                             lambda f: fcntl.fcntl(f, OFD_SETLK, struct.pack("hhqqi4x", fcntl.F_RDLCK, 0, 0, 0, 0))):
                    try:
                        lock(descriptor)
                    except OSError:
                        pass

    def attempts_on_files_of_others(self):
        if self.is_same_user:
            return  # they would succeed
        path = SHM + b"splinecast." + self.random.choice(self.streams) + self.random.choice(ENDS)
        for attempt in (lambda: os.unlink(path), lambda: os.rename(path, path + b".away"),
                        lambda: os.truncate(path, 0), lambda: os.close(os.open(path, os.O_RDWR)),
                        lambda: os.chmod(path, 0o666)):
            try:
                attempt()
            except PermissionError:
                continue
            except FileNotFoundError:
                continue
            sys.exit(f"the kernel lets this user change {path!r}")

    def floods_of_files(self):
        for _ in range(200):
            os.close(self.file(self.name()))

    def futex_waiters(self):
        """Starts many threads that each wait once for the next revision of a stream."""
        path = SHM + b"splinecast." + self.random.choice(self.streams) + b".spline"
        try:
            descriptor = os.open(path, os.O_RDONLY)
        except OSError:
            return
        region = mmap.mmap(descriptor, 12288, prot=mmap.PROT_READ)
        os.close(descriptor)
        control = struct.unpack_from("Q", region, CONTROL_OFFSET)[0]
        LIBC.mmap.restype = ctypes.c_void_p
        base = region_address(path)
        timeout = Timespec(0, 200_000_000)
        threading.stack_size(65536)

        def wait():
            seen = struct.unpack_from("I", region, control)[0]
            LIBC.syscall(SYS_FUTEX, ctypes.c_void_p(base + control), FUTEX_WAIT, ctypes.c_uint32(seen),
                         ctypes.byref(timeout), None, 0)

        waiters = [threading.Thread(target=wait) for _ in range(WAITERS)]
        for waiter in waiters:
            waiter.start()
        for waiter in waiters:
            waiter.join()
        self.count("futex waiters", WAITERS - 1)
        LIBC.munmap(ctypes.c_void_p(base), ctypes.c_size_t(12288))

    KINDS = [invalid_names, names_of_255_bytes, empty_files, copies_of_regions, truncated_regions, exchanged_fifos,
             exchanged_links, fifos, symbolic_links, hard_links, folders, sockets, held_locks, leases,
             locks_on_files_of_others, attempts_on_files_of_others, floods_of_files, futex_waiters]

    def count(self, kind, number=1):
        self.counts[kind] = self.counts.get(kind, 0) + number

    def run(self, seconds):
        end = time.monotonic() + seconds
        kinds = [kind for kind in self.KINDS
                 if not (self.is_same_user and kind is Attacker.attempts_on_files_of_others)]
        self.counts = {kind.__name__.replace("_", " "): 0 for kind in kinds}
        while time.monotonic() < end:
            self.random.shuffle(kinds)
            for kind in kinds:
                kind(self)
                self.count(kind.__name__.replace("_", " "))
                if time.monotonic() > end:
                    break
            if self.random.random() < 0.5:
                time.sleep(0.1)  # so that the solver sees the files
            self.clean()
        self.clean()
        return self.counts


def region_address(path):
    """Maps the beginning of a region read-only and returns its address."""
    descriptor = os.open(path, os.O_RDONLY)
    LIBC.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
    address = LIBC.mmap(None, 12288, mmap.PROT_READ, mmap.MAP_SHARED, descriptor, 0)
    os.close(descriptor)
    return address


def main(arguments):
    seconds, seed, *streams = arguments
    is_same_user = "--same-user" in streams
    signal.signal(signal.SIGIO, signal.SIG_IGN)  # the kernel sends it when a lease is broken
    attacker = Attacker(int(seed), [stream for stream in streams if stream != "--same-user"], is_same_user)
    print(json.dumps(attacker.run(float(seconds))))


if __name__ == "__main__":
    main(sys.argv[1:])
