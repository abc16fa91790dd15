"""Threads, fork, signals and the end of the interpreter."""

import os
import signal
import threading
import time
import unittest

import numpy as np

import splinecast
from fixture import MS, PATIENCE, StreamTest, child, interrupt, wait_for

INTERRUPTED = """
import sys, time, splinecast
try:
    {setup}
    print("ready", flush=True)
    {wait}
except KeyboardInterrupt:
    print("interrupted")
"""


class Threads(StreamTest):
    def runs_during(self, wait):
        """Whether this thread ran in the middle third of another thread's wait."""
        waited = []

        def measure():
            begin = time.monotonic()
            wait()
            waited.append((begin, time.monotonic()))

        thread = threading.Thread(target=measure)
        ran = []
        thread.start()
        while thread.is_alive():
            ran.append(time.monotonic())
        (begin, end) = waited[0]
        third = (end - begin) / 3
        return any(begin + third < t < end - third for t in ran)

    def test_waits_release_the_gil(self):
        producer = splinecast.Producer(self.name)
        solver = splinecast.Solver(self.name)
        solver.attach()
        reader = splinecast.Reader(self.name)
        producer.append(time.monotonic() + 100, 0.0)
        for wait in (lambda: producer.wait_until_consumed(0.1), lambda: reader.wait(0.1),
                     lambda: splinecast.Solver(self.name + "-2").wait(0.05),
                     lambda: self.assertRaises(splinecast.NoSuchStream, splinecast.Reader, "none", 0.1)):
            # On a busy machine another process may have the CPU during one wait.
            self.assertTrue(any(self.runs_during(wait) for _ in range(50)))

    def test_threads_share_a_reader(self):
        times, _, reader = self.recorded()
        expected = reader.sample_many(times).values
        failures = []

        def sample(seed):
            rng = np.random.default_rng(seed)
            state = splinecast.State(2)
            for _ in range(2000):
                i = int(rng.integers(20))
                if not np.array_equal(reader.preview(times[i], state).values, expected[i]):
                    failures.append(i)
                block = reader.sample_many(np.repeat(times[i], 70))
                if not np.array_equal(block.values[69], expected[i]):
                    failures.append(i)

        threads = [threading.Thread(target=sample, args=[seed]) for seed in range(3)]
        threads.append(threading.Thread(target=lambda: [reader.wait(0.01) for _ in range(10)]))
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])

    def test_a_thread_appends_while_another_one_waits(self):
        producer = splinecast.Producer(self.name, clock="recorded")
        producer.append(0, 0.0)
        waiting = threading.Thread(target=producer.wait_until_consumed, args=[PATIENCE])
        waiting.start()
        for i in range(1, 200):
            producer.append(i * MS, 0.0)
        self.assertTrue(waiting.is_alive())
        with splinecast.Solver(self.name).start():
            waiting.join()
        self.assertEqual(producer.consumed, 200)

    def test_closing_ends_the_wait_of_another_thread(self):
        producer = splinecast.Producer(self.name)
        producer.append(time.monotonic() + 100, 0.0)
        errors = []

        def wait():
            try:
                producer.wait_until_consumed()
            except RuntimeError as error:
                errors.append(str(error))

        waiting = threading.Thread(target=wait)
        waiting.start()
        producer.close()
        waiting.join()
        self.assertRegex(errors[0], "is closed")

    def test_a_running_solver_answers_and_stops(self):
        solver = splinecast.Solver(self.name).start()
        with self.assertRaisesRegex(RuntimeError, "already runs"):
            solver.start()
        splinecast.Producer(self.name).append(time.monotonic() + 1, 0.0)
        wait_for(lambda: solver.attached)
        solver.stop()
        self.assertFalse(solver.is_running)
        solver.start().close()
        with self.assertRaisesRegex(RuntimeError, "closed"):
            solver.start()


class Signals(StreamTest):
    def test_keyboard_interrupt_ends_every_wait(self):
        producer = f"p = splinecast.Producer('{self.name}'); t = time.monotonic() + 9; p.append(t, 0.0)"
        solver = f"s = splinecast.Solver('{self.name}')"
        reader = f"s.attach(); p.append(t + 1, 0.0); s.step(); r = splinecast.Reader('{self.name}'); r.wait(0)"
        full = f"p = splinecast.Producer('{self.name}', capacity=2, clock='recorded'); p.append(0, 0.0)"
        for setup, wait in [
            (producer, "p.wait_for_solver()"),
            (producer, "p.wait_until_consumed()"),
            (f"{producer}; {solver}; {reader}", "r.wait()"),
            ("pass", f"splinecast.Reader('{self.name}-none', timeout=None)"),
            (solver, "\n    while True: s.wait()"),
            (full, "\n    for i in range(1, 9): p.append(i * 10**6, 0.0, timeout=None)"),
            (full, "p.append_many([10**6 * i for i in range(1, 99)], [0.0] * 98, timeout=None)"),
        ]:
            with self.subTest(wait):
                out, err = interrupt(child(INTERRUPTED.format(setup=setup, wait=wait)))
                self.assertEqual((out, err), ("interrupted\n", ""))
                self.remove()

    def test_a_handler_may_use_the_object_that_waits(self):
        producer = splinecast.Producer(self.name)
        self.addCleanup(signal.signal, signal.SIGUSR1, signal.getsignal(signal.SIGUSR1))
        signal.signal(signal.SIGUSR1, lambda *_: producer.append(time.monotonic() + 1, 0.0))
        threading.Timer(0.1, os.kill, [os.getpid(), signal.SIGUSR1]).start()
        self.assertFalse(producer.wait_for_solver(0.5))
        self.assertEqual(producer.appended, 1)


class Fork(StreamTest):
    def test_a_child_cannot_use_the_objects_of_its_parent(self):
        producer = splinecast.Producer(self.name, clock="recorded")
        solver = splinecast.Solver(self.name).start()
        producer.append(0, 1.0)
        self.assertTrue(producer.wait_until_consumed(PATIENCE))
        reader = splinecast.Reader(self.name)
        pid = os.fork()
        if pid == 0:
            code = 0
            for use in (lambda: producer.append(1.0, 2.0), lambda: producer.wait_for_room(1), producer.close,
                        lambda: reader.sample(0), lambda: reader.wait(1), lambda: reader.sample_many(np.arange(99)),
                        solver.stop, solver.step, solver.close, lambda: solver.is_running):
                try:
                    use()
                    code = 1
                except RuntimeError as error:
                    if f"created before fork in process {os.getppid()}" not in str(error):
                        code = 2
            del producer, reader, solver, use
            os._exit(code)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 0)
        producer.append(1.0, 2.0)
        self.assertTrue(producer.wait_until_consumed(PATIENCE))
        solver.close()
        self.assertFalse(producer.solver_alive)

    def test_a_child_makes_objects_of_its_own(self):
        times, _, reader = self.recorded()
        expected = reader.sample(int(times[5])).values.copy()
        pid = os.fork()
        if pid == 0:
            same = np.array_equal(splinecast.Reader(self.name).sample(int(times[5])).values, expected)
            os._exit(0 if same else 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 0)


class Exit(StreamTest):
    def ends(self, code):
        process = child("import sys, threading, time, os, splinecast\n" + code)
        out, err = process.communicate(timeout=PATIENCE)
        self.assertEqual((process.returncode, err), (0, ""))
        self.remove()
        return out

    def test_the_interpreter_ends_while_a_solver_runs(self):
        self.ends(f"s = splinecast.Solver('{self.name}').start(); p = splinecast.Producer('{self.name}')")
        self.ends(f"splinecast.keep = splinecast.Solver('{self.name}').start()")

    def test_the_interpreter_ends_while_a_daemon_thread_waits(self):
        self.ends(f"""
p = splinecast.Producer('{self.name}')
p.append(time.monotonic() + 100, 0.0)
threading.Thread(target=p.wait_until_consumed, daemon=True).start()
threading.Thread(target=splinecast.Reader, args=('{self.name}-none', None), daemon=True).start()
time.sleep(0.1)
""")

    def test_a_child_of_a_process_with_a_solver_ends(self):
        self.ends(f"""
s = splinecast.Solver('{self.name}').start()
if os.fork() == 0:
    sys.exit(0)
if os.wait()[1] != 0:
    sys.exit("the child has crashed")
""")


if __name__ == "__main__":
    unittest.main()
