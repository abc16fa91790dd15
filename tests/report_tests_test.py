#!/usr/bin/env python3
"""Tests of the last steps of `./run test`: report_tests.py and shared_memory_left.py."""

import fcntl
import os
import struct
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))

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
    """Tests of report_tests.py."""

    def report(self, cases, allowed):
        """Exit code and output of report_tests.py for test cases and a list."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("a.xml", f"<testsuite>{''.join(cases)}</testsuite>"),
                               ("list", allowed)):
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write(text)
            ended = subprocess.run(
                [sys.executable, os.path.join(HERE, "report_tests.py"), "a.xml", "list"],
                cwd=folder, check=False, capture_output=True, text=True)
            return ended.returncode, ended.stdout.splitlines()

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
            code, said = self.report([PASSED, case], "* |  | anything\n".replace("|  |", "| x |"))
            self.assertEqual(code, 1)
            self.assertEqual(said[-1], "1 passed, 1 failed, 0 skipped")

    def test_fails_if_no_test_ran(self):
        """A filter that selects no test is an error."""
        self.assertEqual(self.report([], "")[0], 1)


class Left(unittest.TestCase):
    """Tests of shared_memory_left.py."""

    def test_finds_new_names_without_a_living_owner(self):
        """Old names, names of other programs and names of living owners do not count."""
        with tempfile.TemporaryDirectory() as folder:
            def touch(name):
                path = os.path.join(folder, name)
                with open(path, "w", encoding="utf-8"):
                    return path

            def run(what, text=""):
                return subprocess.run(
                    [sys.executable, os.path.join(HERE, "shared_memory_left.py"), what, folder],
                    check=False, capture_output=True, text=True, input=text,
                    env=os.environ | {"PATIENCE": "0"})

            touch("splinecast.old.spline")
            before = run("list").stdout
            self.assertEqual(before, "splinecast.old.spline\n")
            touch("others")
            touch("splinecast.a.b.spline")
            lock = os.open(touch("splinecast.a.b.spline.lock"), os.O_RDWR)
            fcntl.fcntl(lock, fcntl.F_OFD_SETLK,
                        struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))
            self.assertEqual(run("check", before).returncode, 0)
            os.close(lock)
            ended = run("check", before)
            self.assertEqual(ended.returncode, 1)
            self.assertIn("splinecast.a.b.spline\n", ended.stdout)


if __name__ == "__main__":
    unittest.main()
