"""Time laws: commanders, and streams that follow a law."""

import os
import time
import unittest

import splinecast
from fixture import MS, PATIENCE, StreamTest, wait_for
from splinecast import SampleStatus


class Law(StreamTest):
    def setUp(self):
        super().setUp()
        self.law = f"{self.name}-law"
        self.addCleanup(self.remove_law)
        self.operator = splinecast.RateCommander(self.law, "operator")
        self.operator.set_rate(1, ramp=0.005)

    def remove_law(self):
        self.operator.close()
        for solver in self.solvers:
            solver.close()
        splinecast.remove(self.law)

    solvers = ()

    def follow(self, largest_rate=None):
        """Starts the law and a stream that follows it. Returns its producer and a reader."""
        self.solvers = (splinecast.Solver(self.law, largest_rate=largest_rate).start(),
                        splinecast.Solver(self.name).start())
        splinecast.Reader(self.law, timeout=PATIENCE)
        producer = splinecast.Producer(self.name, law=self.law)
        self.assertTrue(producer.wait_for_solver(PATIENCE))
        producer.append(producer.now() + 1000 * 1000 * MS, [1.0])
        self.assertTrue(producer.wait_until_consumed(PATIENCE))
        return producer, splinecast.Reader(self.name, timeout=PATIENCE)

    def reach(self, reader, rate):
        """Samples until the rate is this; returns the LawRate."""
        def found():
            self.assertTrue(reader.sample(time.monotonic_ns()).status.has_values)
            return reader.rate() if reader.rate().rate == rate else None
        return wait_for(found)

    def test_a_stop_in_a_hold_begins_where_the_machine_rests(self):
        producer, reader = self.follow()
        self.operator.hold(0.005)
        held = self.reach(reader, 0).stream_time
        self.assertIsNone(producer.replacement_begin)

        def foreseen():
            preview = producer.preview_replace(0)
            return preview if preview.from_rest else None
        self.assertEqual(wait_for(foreseen).begin, held + 1)
        producer.replace_from(0)
        begin = wait_for(lambda: producer.replacement_begin)
        # The law may have settled only a part of the way that the solver looks ahead.
        self.assertGreater(begin.begin, held)
        if begin.from_rest:
            self.assertEqual(begin.begin, held + 1)

    def test_the_rate_is_the_least_that_is_requested(self):
        producer, reader = self.follow(largest_rate=2)
        self.assertEqual(reader.clock, "law")
        self.operator.set_rate(1.5, 0.005)
        self.assertEqual(self.reach(reader, 1.5).slope, 0)
        with splinecast.RateCommander(self.law, "estop") as stop:
            stop.hold(0.005)
            held = self.reach(reader, 0)
            self.assertEqual(producer.now(), held.stream_time)
            with self.assertRaisesRegex(splinecast.BadRequest, "largest rate"):
                self.operator.set_rate(50, 0.005)
            number = self.operator.set_rate(2, 0.005, wait=PATIENCE)
            self.assertEqual(self.operator.set_rate(2, 0.005), number + 1)
            self.assertEqual(self.reach(reader, 0).stream_time, held.stream_time)
            stop.release(0.005)
            self.reach(reader, 2)
        self.operator.release(0.005)
        self.reach(reader, 1)

    def test_the_stream_time_is_that_of_the_producer(self):
        producer, reader = self.follow()
        before = producer.now()
        self.assertIs(reader.sample(time.monotonic_ns()).status, SampleStatus.HOLDING)
        rate = reader.rate()
        self.assertLessEqual(before, rate.stream_time)
        self.assertLessEqual(rate.stream_time, producer.now())
        self.assertEqual(rate[1:], (1, 0))

    def test_a_commander_that_does_not_renew_holds_the_law(self):
        _, reader = self.follow()
        self.operator.set_dead_man(0.02, ramp=0.01)
        self.operator.set_rate(1, 0.005)
        self.reach(reader, 0)
        self.assertFalse(self.operator.renew())
        time.sleep(0.05)
        self.reach(reader, 0)
        self.operator.set_dead_man(0)
        self.operator.set_rate(1, 0.005, wait=PATIENCE)
        self.assertTrue(self.operator.renew())
        self.reach(reader, 1)

    def test_a_request_without_a_solver_is_not_in_force(self):
        with self.assertRaisesRegex(TimeoutError, "request 2 of 'operator' .* it remains"):
            self.operator.hold(0.005, wait=0.01)
        self.assertEqual(self.operator.release(0.005), 3)

    def test_a_commander_has_a_name_of_its_own(self):
        with self.assertRaisesRegex(splinecast.StreamBusy, "operator"):
            splinecast.RateCommander(self.law, "operator")
        for arguments, options, failure in [(("a@b",), {}, splinecast.BadRequest), (("a",), {"speed": 1}, TypeError),
                                            (("a",), {"mode": -1}, splinecast.BadRequest)]:
            with self.subTest(arguments, **options), self.assertRaises(failure):
                splinecast.RateCommander(self.law, *arguments, **options)
        self.assertEqual((self.operator.law, self.operator.commander), (self.law, "operator"))
        self.assertIn("'operator'", repr(self.operator))
        self.operator.close()
        self.operator.close()
        self.assertTrue(self.operator.is_closed)
        with self.assertRaisesRegex(RuntimeError, "is closed"):
            self.operator.renew()
        splinecast.RateCommander(self.law, "operator").close()

    def test_requests_out_of_range_are_refused(self):
        for request, value in [(lambda: self.operator.set_rate(-1, 1), "-1"),
                               (lambda: self.operator.set_rate(float("nan"), 1), "nan"),
                               (lambda: self.operator.set_rate(100.5, 1), "100.5"),
                               (lambda: self.operator.hold(1e-6), "1000 ns"),
                               (lambda: self.operator.release(-1.0), "-1"),
                               (lambda: self.operator.set_dead_man(4000), "4000000000000 ns"),
                               (lambda: self.operator.set_dead_man(1, ramp=0), "a ramp")]:
            with self.subTest(value), self.assertRaisesRegex(splinecast.BadRequest, value):
                request()
        with self.assertRaises(TypeError):
            self.operator.hold("soon")
        with self.assertRaises(TypeError):
            self.operator.set_rate("fast", 1)

    def test_options_of_a_law_are_checked(self):
        for options in (dict(clock="law"), dict(clock="monotonic", law=self.law), dict(clock="recorded", law=self.law)):
            with self.subTest(options), self.assertRaisesRegex(splinecast.BadRequest, "law"):
                splinecast.Producer(self.name, **options)
        with self.assertRaisesRegex(splinecast.NoSuchStream, "no-law"):
            splinecast.Producer(self.name, law=f"no-law-{os.getpid()}")
        for rate in (0, -1.0, 100.5):
            with self.subTest(rate), self.assertRaisesRegex(splinecast.BadRequest, "largest rate"):
                splinecast.Solver(self.name, largest_rate=rate)
        with splinecast.Solver(self.law) as solver:
            self.assertTrue(wait_for(solver.attach))
            solver.step()

    def test_other_streams_have_the_rate_1(self):
        _, _, reader = self.recorded()
        reader.sample(50 * MS)
        self.assertEqual(reader.rate().rate, 1)
        producer = splinecast.Producer(self.name + "-live")
        before = time.monotonic_ns()
        self.assertLessEqual(before, producer.now())
        self.assertLessEqual(producer.now(), time.monotonic_ns())
        producer.withdraw()


if __name__ == "__main__":
    unittest.main()
