#!/usr/bin/env python3
"""Tests of the last steps of `./run test`: report.py and left.py."""

import contextlib
import fcntl
import io
import os
import struct
import subprocess
import tempfile
import threading
import unittest
from unittest import mock

import left
import report
import run

PASSED = '<testcase name="A.Passes" status="run"><system-out>fine</system-out></testcase>'
FAILED = '<testcase name="A.Fails" status="fail"><failure message="Failed"/></testcase>'
SKIPPED = ('<testcase name="A.IsSkipped" status="notrun">'
           '<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/><system-out>'
           '/x/a_test.cpp:7: Skipped\nneeds root, which\ncan act\n\n[  SKIPPED ] A.IsSkipped\n'
           '</system-out></testcase>')
PROGRAM = ('<testcase name="Model.Holds" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/>'
           '<system-out>spin is not on this machine\n</system-out></testcase>')
MISSING = ('<testcase name="A.Missing" status="notrun">'
           '<skipped message="Unable to find executable"/></testcase>')


class Report(unittest.TestCase):
    """Tests of report.py."""

    def report(self, cases, allowed):
        """Exit code and output for test cases and a list."""
        with tempfile.TemporaryDirectory() as folder:
            junit, allowed_path = os.path.join(folder, "a.xml"), os.path.join(folder, "list")
            for path, text in ((junit, f"<testsuite>{''.join(cases)}</testsuite>"), (allowed_path, allowed)):
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text)
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                code = report.write(report.read(junit), allowed_path)
            return code, said.getvalue().splitlines()

    def test_counts_skipped_tests_separately(self):
        """A skipped test does not count as passed."""
        code, said = self.report([PASSED, SKIPPED, PROGRAM],
                                 "A.* | needs root | only root\nModel.* | not on | no spin\n")
        self.assertEqual(code, 0)
        self.assertEqual(said[-1], "1 passed, 0 failed, 2 skipped")
        self.assertIn("skipped: A.IsSkipped: needs root, which can act (only root)", said)
        self.assertIn("skipped: Model.Holds: spin is not on this machine (no spin)", said)

    def test_fails_for_a_skipped_test_that_is_not_on_the_list(self):
        """Both the name and the message of a skipped test must be on the list."""
        for allowed in ("", "B.* | needs root | r\n", "A.* | needs a kernel | r\n"):
            code, said = self.report([PASSED, SKIPPED], "# none\n" + allowed)
            self.assertEqual(code, 1, said)
            self.assertIn("NOT ON THE LIST", said[0])
            self.assertEqual(said[-1], "1 passed, 0 failed, 1 skipped")

    def test_fails_for_failed_tests_and_those_that_cannot_be_started(self):
        """ctest also reports tests as skipped that it could not start."""
        for case in (FAILED, MISSING):
            code, said = self.report([PASSED, case], "* | x | anything\n")
            self.assertEqual(code, 1)
            self.assertEqual(said[-1], "1 passed, 1 failed, 0 skipped")

    def test_fails_if_no_test_ran(self):
        """A filter that selects no test is an error."""
        self.assertEqual(self.report([], "")[0], 1)

    def test_fails_if_ctest_did_not_run_to_its_end(self):
        """A ctest that was killed writes no file. Its exit code is negative."""
        case = report.Case("A.Passes", "passed", "")
        self.assertEqual(report.judge_end(0, [case]), [])
        self.assertEqual(report.judge_end(8, [case]), [])
        for code, cases in ((-9, []), (-9, [case]), (0, []), (1, [case])):
            self.assertEqual([found.outcome for found in report.judge_end(code, cases)], ["failed"])


class Left(unittest.TestCase):
    """Tests of left.py."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        ended = subprocess.Popen(["true"])
        ended.wait()
        self.ended = ended.pid

    def touch(self, name):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8"):
            return path

    def left(self, before, is_own):
        return left.wait_for_removal(before, is_own, self.folder, patience=0)

    def test_finds_new_names_without_an_owner(self):
        """Old names, names of other programs and names with an owner do not count."""
        self.touch("splinecast.old.spline")
        before = left.names(self.folder)
        self.assertEqual(before, {"splinecast.old.spline"})
        self.touch("others")
        self.touch("splinecast.a.b.spline")
        lock = os.open(self.touch("splinecast.a.b.spline.lock"), os.O_RDWR)
        fcntl.fcntl(lock, fcntl.F_OFD_SETLK, struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))
        self.assertEqual(self.left(before, True), [])
        os.close(lock)
        self.assertEqual(self.left(before, True), ["splinecast.a.b.spline", "splinecast.a.b.spline.lock"])

    def test_finds_only_names_of_ended_tests_in_a_shared_folder(self):
        """Streams of other programs, and of tests that run, do not count."""
        self.touch("splinecast.arm.spline")
        self.touch(f"splinecast.test.{os.getpid()}.0.spline")
        self.assertEqual(self.left(set(), False), [])
        name = f"splinecast.test.{self.ended}.0.spline"
        self.touch(name)
        self.assertEqual(self.left(set(), False), [name])


class Watch(unittest.TestCase):
    """Tests of the look for progress in run.py."""

    def test_counts_the_time_of_descendants_that_have_ended(self):
        """A shell that waits for one busy command after the other makes progress."""
        busy = "i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done"
        with subprocess.Popen(["sh", "-c", f"sh -c '{busy}'; echo ended; read x"], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE) as shell:
            shell.stdout.readline()
            self.assertGreater(run.used(run.processes(), shell.pid), 0)
            run.kill_tree(run.processes(), shell.pid)
        self.assertLess(shell.returncode, 0)

    @mock.patch.multiple(run, STALL=0.3, LOOK=0.05)
    def test_kills_a_test_whose_processes_use_no_cpu_time(self):
        """Each child of ctest is a test; here it never ends, so that ctest ends only if it is killed."""
        with subprocess.Popen(["sh", "-c", "sh -c 'sleep inf; true'; echo $?"], stdout=subprocess.PIPE, text=True) as ctest:
            ended, said = threading.Event(), io.StringIO()
            with contextlib.redirect_stdout(said):
                watcher = threading.Thread(target=run.watch, args=(ctest.pid, ended))
                watcher.start()
                code = ctest.stdout.read().strip()
                ended.set()
                watcher.join()
        self.assertEqual(code, "137")
        self.assertIn("sleep inf", said.getvalue())


if __name__ == "__main__":
    unittest.main()
