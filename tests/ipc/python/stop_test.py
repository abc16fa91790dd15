"""Stoppers of a live stream."""

import time
import unittest

import splinecast
from fixture import MS, PATIENCE, StreamTest


class Stops(StreamTest):
    def setUp(self):
        super().setUp()
        self.producer = splinecast.Producer(self.name)
        self.addCleanup(self.producer.close)
        solver = splinecast.Solver(self.name).start()
        self.addCleanup(solver.close)
        self.assertTrue(self.producer.wait_for_solver(PATIENCE))
        self.addCleanup(self.release)

    def release(self):
        for name in ("panel", "second"):
            with splinecast.Stopper(self.name, name) as stopper:
                stopper.release()

    def append(self):
        """Appends a waypoint 200 ms from now."""
        return self.producer.append(time.monotonic_ns() + 200 * MS, [1.0])

    def test_a_stop_outlives_with_and_ends_with_the_release(self):
        with splinecast.Stopper(self.name, "panel") as stopper:
            self.assertFalse(stopper.is_latched)
            number = stopper.stop(wait=PATIENCE)
            self.assertTrue(stopper.is_latched)
            self.assertEqual(stopper.stop(wait=PATIENCE), number)
        self.assertTrue(stopper.is_closed)
        self.assertEqual(self.producer.stopped_by(), ["panel"])
        with self.assertRaises(splinecast.Refused) as refused:
            self.append()
        self.assertIs(refused.exception.status, splinecast.AppendStatus.STOPPED)
        self.assertIn("panel", str(refused.exception))
        with splinecast.Stopper(self.name, "panel") as stopper:
            self.assertTrue(stopper.is_latched)
            self.assertEqual(stopper.release(wait=PATIENCE), number + 1)
        self.append()

    def test_a_refusal_has_the_name(self):
        self.append()
        with splinecast.Stopper(self.name, "second") as stopper:
            stopper.stop(wait=PATIENCE)
        self.assertEqual(self.producer.stopped_by(), ["second"])
        self.producer.finish()
        self.assertTrue(self.producer.wait_until_consumed(PATIENCE))
        for refusal in self.producer.refusals():
            self.assertIs(refusal.reason, splinecast.Refusal.STOPPED)
            self.assertEqual(refusal.by, "second")
            self.assertIn("stopped by 'second'", str(refusal))

    def test_a_stop_without_a_solver_is_a_timeout_and_remains(self):
        other = f"{self.name}-other"
        with splinecast.Stopper(other, "panel") as stopper:
            with self.assertRaises(TimeoutError):
                stopper.stop(wait=0.01)
            self.assertTrue(stopper.is_latched)
            self.assertEqual(stopper.stream, other)
            self.assertEqual(stopper.stopper, "panel")
            stopper.release()
        splinecast.remove(other)

    def test_a_stopper_has_one_living_object_and_a_valid_name(self):
        with splinecast.Stopper(self.name, "panel"):
            with self.assertRaises(splinecast.StreamBusy):
                splinecast.Stopper(self.name, "panel")
        with self.assertRaises(splinecast.BadRequest):
            splinecast.Stopper(self.name, "a!b")


if __name__ == "__main__":
    unittest.main()
