"""Times and arrays: types, ranges, and memory that is not copied."""

import array
import gc
import time
import tracemalloc
import unittest

import numpy as np

import splinecast
from fixture import MS, StreamTest, solve


class Times(StreamTest):
    def setUp(self):
        super().setUp()
        _, _, self.reader = self.recorded()

    def test_an_instant_is_an_int_of_ns_or_a_float_of_seconds(self):
        for t in (250 * MS, 0.25, np.int64(250 * MS), np.uint32(250 * MS), np.float64(0.25)):
            with self.subTest(repr(t)):
                self.assertEqual(self.reader.preview(t).time, 250 * MS)
        self.assertEqual(self.reader.preview(0.1).time, 100 * MS)

    def test_other_types_are_refused(self):
        for t in (True, np.bool_(True), "1", None, 1j, [1], np.array([1, 2])):
            with self.subTest(repr(t)), self.assertRaisesRegex(TypeError, "int .ns. or a float .s."):
                self.reader.sample(t)
        for times in ([1, 0.5], np.array([True]), ["1"], np.zeros(2, "M8[ns]")):
            with self.subTest(repr(times)), self.assertRaises(TypeError):
                self.reader.sample_many(times)

    def test_floats_that_do_not_hold_an_instant_are_refused(self):
        for of in (np.float16, np.float32):
            with self.subTest(of), self.assertRaisesRegex(TypeError, f"{of.__name__}.*too coarse.*float64"):
                self.reader.sample(of(0.25))
            with self.subTest(of), self.assertRaisesRegex(TypeError, f"{of.__name__}.*too coarse.*float64"):
                self.reader.sample_many(np.array([0.25], of))

    def test_times_of_another_clock_are_refused(self):
        producer = splinecast.Producer(self.name + ".live", dimensions=1)
        self.addCleanup(splinecast.remove, self.name + ".live")
        solver = splinecast.Solver(self.name + ".live")
        self.assertTrue(solver.attach())
        now = time.monotonic()
        producer.append_many(now + 0.1 + 0.01 * np.arange(5), np.zeros((5, 1)))
        solve(solver)
        reader = splinecast.Reader(self.name + ".live")
        for t in (now - 3500, now, now + 0.12, now + 3500):
            reader.sample_many([t])
            reader.preview(t)
        wall = time.time()
        for t, text in ((wall, "it looks like CLOCK_REALTIME"),
                        (now + 3700, "more than an hour from now"), (-1e6, "CLOCK_MONOTONIC")):
            for call in (reader.sample, reader.preview, lambda t: reader.sample_many([now + 0.12, now + 100, t])):
                with self.subTest(t), self.assertRaisesRegex(splinecast.BadRequest, text):
                    call(t)

    def test_waypoints_of_another_clock_are_refused_by_name(self):
        name = self.name + ".clock"
        producer = splinecast.Producer(name, dimensions=1, horizon=60)
        self.addCleanup(splinecast.remove, name)
        now, wall = time.monotonic(), time.time()
        calls = (lambda t: producer.append(t, [0.0]), lambda t: producer.append_many([t], [[0.0]]),
                 lambda t: producer.replace_from(now + 1, [t], [[0.0]]),
                 lambda t: producer.start_from(t, [0.0], [0.0], [0.0]))
        for t, text in ((wall, "it looks like CLOCK_REALTIME$"), (int(wall * 1e9), "CLOCK_REALTIME$"),
                        (now + 61, "s after now, .* s of CLOCK_MONOTONIC")):
            for call in calls:
                with self.subTest(t), self.assertRaisesRegex(splinecast.Refused, "too far ahead.*" + text) as raised:
                    call(t)
                self.assertIs(raised.exception.status, splinecast.AppendStatus.TOO_FAR_AHEAD)
        before = [(int(wall), "CLOCK_REALTIME in s"), (int(wall * 1e3), "CLOCK_REALTIME in ms"),
                  (0, "a time that counts from 0"), (int(now), "CLOCK_MONOTONIC in s as an integer")]
        for t, text in before:
            if t > time.monotonic_ns():
                continue  # this host has run for less than that
            with self.subTest(t), self.assertRaisesRegex(splinecast.Refused, "waypoint refused: past.*" + text):
                producer.append(t, [0.0])
        with self.assertRaisesRegex(splinecast.Refused, "stop refused: too far ahead|too far ahead"):
            producer.replace_from(wall)
        self.assertEqual(producer.appended, 0)
        producer.append(time.monotonic() + 59, [0.0])
        with self.assertRaisesRegex(splinecast.BadRequest, "horizon must be above 0, not 0 ns"):
            splinecast.Producer(name + ".zero", dimensions=1, horizon=0)

    def test_a_blend_in_milliseconds_is_refused(self):
        producer = splinecast.Producer(self.name + ".blend", dimensions=1)
        self.addCleanup(splinecast.remove, self.name + ".blend")
        for call in (producer.replace_from, producer.preview_replace):
            with self.assertRaisesRegex(splinecast.BadRequest, "blend is in seconds, at most 60, not 80"):
                call(time.monotonic(), [time.monotonic() + 1], [[0.0]], blend=80)
        self.assertEqual(producer.appended, 0)

    def test_values_out_of_range_are_named(self):
        for t, text in ((float("nan"), "nan"), (float("inf"), "inf"), (1e10, r"1e\+10"), (2**62, str(2**62)),
                        (-(2**70), str(2**70))):
            with self.subTest(t), self.assertRaisesRegex(splinecast.BadRequest, text):
                self.reader.sample(t)
        for times in (np.array([2**63], np.uint64), np.array([2**62]), np.array([np.nan]), np.full(100, np.inf)):
            with self.subTest(repr(times)), self.assertRaisesRegex(ValueError, "is not within"):
                self.reader.sample_many(times)

    def test_zero_mixes_with_both_units(self):
        block = self.reader.sample_many([0, 0.5])
        np.testing.assert_array_equal(block.values, self.reader.sample_many([0, 500 * MS]).values)

    def test_durations_are_seconds(self):
        for timeout, error in ((-1, ValueError), (float("nan"), ValueError), ("1", TypeError), (True, TypeError)):
            with self.subTest(timeout), self.assertRaisesRegex(error, "timeout"):
                self.reader.wait(timeout)


class Arrays(StreamTest):
    def test_every_array_like_is_read(self):
        producer = splinecast.Producer(self.name, dimensions=3, clock="recorded")
        wide = np.arange(12.0).reshape(3, 4)
        inputs = [
            [1, 2.0, 3], (1, 2, 3), np.array([1.0, 2, 3]), np.array([1, 2, 3], np.int8), wide[:, 1], wide[0, ::-1][:3],
            np.array([1, 2, 3], ">f8"), np.array([1, 2, 3], np.float32), array.array("d", [1, 2, 3]),
            [np.float64(1), np.float32(2), np.int64(3)], memoryview(np.ones(3)),
        ]
        for i, x in enumerate(inputs):
            producer.append(i * MS, x)
        producer.finish()
        solver = splinecast.Solver(self.name)
        solver.attach()
        while solver.step().consumed:
            pass
        reader = splinecast.Reader(self.name)
        for i, x in enumerate(inputs):
            np.testing.assert_allclose(reader.preview(i * MS).position, np.asarray(x, float), 1e-13, err_msg=str(x))

    def test_what_is_not_real_numbers_is_refused(self):
        producer = splinecast.Producer(self.name, dimensions=1, clock="recorded")
        for x in ("1", [1j], ["1"], [None], [True], np.array([True]), object()):
            with self.subTest(repr(x)), self.assertRaises(TypeError):
                producer.append(0, x)
        with self.assertRaisesRegex(splinecast.BadRequest, r"shape \(1, 1\)"):
            producer.append(0, [[1]])
        with self.assertRaisesRegex(splinecast.BadRequest, "65 values"):
            producer.append(0, np.zeros(65))
        with self.assertRaisesRegex(splinecast.BadRequest, "3 rows of 1 values, not 2 of 1"):
            producer.append_many([0, 1], [1, 2, 3])
        self.assertEqual(producer.appended, 0)

    def test_rows_with_any_strides_are_read_where_they_are(self):
        producer = splinecast.Producer(self.name, dimensions=2, clock="recorded", capacity=8192)
        x = np.random.default_rng(1).normal(size=(2, 4000))
        times = np.arange(1000) * MS
        tracemalloc.start()
        producer.append_many(times, x[:, ::4].T)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        self.assertLess(peak, 4000)
        self.assertEqual(producer.appended, 1000)

    def test_states_are_views_of_one_memory(self):
        state = splinecast.State(3)
        state.values[:] = np.arange(12).reshape(4, 3)
        for row, part in enumerate((state.position, state.velocity, state.acceleration, state.jerk)):
            self.assertTrue(np.shares_memory(part, state.values))
            np.testing.assert_array_equal(part, 3 * row + np.arange(3))
        position = state.position
        del state, part
        gc.collect()
        np.testing.assert_array_equal(position, [0, 1, 2])
        for dimensions in (0, 65):
            with self.assertRaisesRegex(ValueError, str(dimensions)):
                splinecast.State(dimensions)

    def test_sampling_into_a_state_or_block_allocates_nothing(self):
        _, _, reader = self.recorded()
        state = splinecast.State(2)
        times = np.arange(1000) * MS
        seconds = times * 1e-9
        block = reader.sample_many(seconds)
        values = block.values

        def work():
            for _ in range(100):
                reader.sample(0, state)
                reader.sample_many(times, block)
                reader.sample_many(seconds, block)

        work()
        tracemalloc.start()
        work()
        current, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        self.assertLess(current, 500)
        self.assertLess(peak, 2000)
        self.assertTrue(np.shares_memory(values, block.values))
        with self.assertRaisesRegex(ValueError, "1000 times, not for 999"):
            reader.sample_many(times[1:], block)


if __name__ == "__main__":
    unittest.main()
