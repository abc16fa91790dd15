"""The three roles in one process."""

import contextlib
import time
import unittest

import numpy as np

import splinecast
from fixture import MS, PATIENCE, StreamTest, solve, wait_for
from splinecast import AppendStatus, OutcomeKind, OutcomeWay, Refusal, SampleStatus


class Roles(StreamTest):
    def test_a_reader_samples_the_waypoints(self):
        times, positions, reader = self.recorded(names=["x", "y"], units="m")
        for t, x in zip(times, positions):
            state = reader.sample(int(t))
            self.assertIs(state.status, SampleStatus.SETTLED)
            np.testing.assert_allclose(state.position, x, rtol=0, atol=1e-14)
        self.assertEqual((reader.names, reader.units), (["x", "y"], ["m", "m"]))
        self.assertEqual((reader.dimensions, reader.clock, reader.limits), (2, "recorded", {}))
        self.assertEqual(reader.first_time, 0)
        self.assertEqual(reader.settled_until, times[-1])
        self.assertEqual(reader.alive(), (False, False))
        progress = reader.progress()
        self.assertTrue(progress.is_finished)
        self.assertEqual((progress.waypoints, progress.newest), (20, times[-1]))

    def test_many_samples_equal_single_ones(self):
        times, _, reader = self.recorded()
        instants = np.linspace(0, times[-1], 101).astype(np.int64)
        block = reader.sample_many(instants)
        self.assertEqual(block.values.shape, (101, 4, 2))
        for t, values, status in zip(instants, block.values, block.status):
            state = reader.preview(t)
            self.assertEqual(status, state.status)
            np.testing.assert_array_equal(values, state.values)
        self.assertIs(reader.sample_many(instants * 1e-9, block), block)
        memory = np.empty((len(instants), 4, reader.dimensions))
        self.assertTrue(np.shares_memory(reader.sample_many(instants, out=memory).values, memory))
        np.testing.assert_array_equal(memory, np.asarray(block))
        np.testing.assert_array_equal(block[:, 1], memory[:, 1])
        self.assertEqual(block.shape, memory.shape)
        for wrong in (memory[:, :3], memory.astype(np.float32), memory[:, :, ::-1], np.zeros((2, 2))):
            with self.assertRaisesRegex(splinecast.BadRequest, "out must be a Block"):
                reader.sample_many(instants, out=wrong)
        part = reader.sample_many(instants, derivatives="pa")
        np.testing.assert_array_equal(part.values, block.values[:, [0, 2]])
        self.assertEqual(part.derivatives, "pa")

    def test_samples_without_values_are_nan_or_keep_their_memory(self):
        _, _, reader = self.recorded()
        state = reader.sample(-1)
        self.assertIs(state.status, SampleStatus.BEFORE_HISTORY)
        self.assertFalse(state.status.has_values)
        self.assertTrue(np.isnan(state.values).all())
        state = reader.sample(50 * MS)
        before = state.values.copy()
        self.assertIs(reader.sample(-1, out=state), state)
        np.testing.assert_array_equal(state.values, before)
        block = reader.sample_many([-1, 0])
        self.assertTrue(np.isnan(block.values[0]).all())
        self.assertTrue(np.isfinite(block.values[1]).all())
        self.assertEqual(reader.sample(0, splinecast.State(3)).status, SampleStatus.WRONG_DIMENSION)

    def test_a_snapshot_is_the_sampled_curve(self):
        times, _, reader = self.recorded()
        snapshot = reader.snapshot(int(times[0]), int(times[-1]))
        self.assertEqual(len(snapshot), len(snapshot.segments))
        curve = snapshot.curve()
        for t in range(0, int(times[-1]), 37 * MS):
            np.testing.assert_allclose(curve(t), reader.preview(t).position, rtol=1e-13, atol=1e-13)
        self.assertEqual(snapshot.to_ppoly().x[-1], 1.9)
        self.assertEqual(len(reader.snapshot(-2, -1)), 0)
        with self.assertRaisesRegex(splinecast.BadRequest, "no segments: before history"):
            reader.snapshot(-2, -1).curve()

    def test_refused_waypoints_raise_their_status_and_values(self):
        producer = splinecast.Producer(self.name, dimensions=2, clock="recorded")
        self.assertEqual(producer.append(0, [1, 2]), 0)
        with self.assertRaises(splinecast.Refused) as caught:
            producer.append(0, [3, 4.5])
        self.assertIs(caught.exception.status, AppendStatus.DUPLICATE)
        self.assertEqual(caught.exception.time, 0)
        np.testing.assert_array_equal(caught.exception.position, [3, 4.5])
        self.assertRegex(str(caught.exception), r"duplicate, time 0 ns, position \[3.0, 4.5\]")
        with self.assertRaises(splinecast.Refused) as caught:
            producer.append(1.0, [1, 2, 3])
        self.assertIs(caught.exception.status, AppendStatus.WRONG_DIMENSION)
        with self.assertRaises(splinecast.Refused) as caught:
            producer.append_many([1.0, 2.0, 1.5], np.zeros((3, 2)))
        self.assertIs(caught.exception.status, AppendStatus.OUT_OF_ORDER)
        self.assertEqual((caught.exception.index, caught.exception.time), (2, 1_500_000_000))
        self.assertEqual(producer.appended, 3)

    def test_a_full_ring_raises_full_until_the_solver_makes_room(self):
        producer = splinecast.Producer(self.name, clock="recorded", capacity=16)
        with self.assertRaises(splinecast.Full) as caught:
            for i in range(17):
                producer.append(i * MS, 0.5)
        self.assertIs(caught.exception.status, AppendStatus.FULL)
        with self.assertRaises(splinecast.Full):
            producer.append(1.0, 0.5, timeout=0.01)
        with splinecast.Solver(self.name).start():
            producer.append(1.0, 0.5, timeout=PATIENCE)
            producer.append_many(2 + np.arange(100) * 1e-3, np.zeros(100), timeout=PATIENCE)
            self.assertTrue(producer.wait_until_consumed(PATIENCE))
        self.assertEqual(producer.consumed, producer.appended)

    def test_the_producer_gets_what_the_solver_refused(self):
        solver = splinecast.Solver(self.name, limits={"velocity": 1.0}, beyond="refuse")
        producer = splinecast.Producer(self.name, names=["q"], clock="recorded", start="natural")
        self.assertTrue(solver.attach())
        producer.append(0, 0)
        producer.append(1.0, 0.5)
        item = producer.append(2.0, 1000)
        solve(solver)
        (refusal,) = producer.refusals()
        self.assertEqual((refusal.item, refusal.time), (item, 2_000_000_000))
        self.assertIs(refusal.reason, Refusal.BEYOND_LIMITS)
        self.assertEqual(str(producer.outcome(item)), "refused: beyond limits")
        self.assertIs(producer.outcome(item).reason, Refusal.BEYOND_LIMITS)
        self.assertEqual((refusal.excess.kind, refusal.excess.limit), ("velocity", 1))
        self.assertIn("(q)", str(refusal))
        self.assertEqual(producer.refusals(), [])
        self.assertEqual(solver.first_refusals()[0].item, item)
        reader = splinecast.Reader(self.name)
        np.testing.assert_array_equal(reader.limits["velocity"], [1])
        self.assertLessEqual(reader.excess(reader.sample(1.0)).ratio, 1)

    def test_kinds_and_start_states_are_those_of_the_stream(self):
        kinds = ["periodic:6", "quaternion", "quaternion", "quaternion", "quaternion"]
        producer = splinecast.Producer(self.name, kinds=kinds, clock="recorded", start=("velocity", [0, 0, 0, 0, 0]))
        solver = splinecast.Solver(self.name)
        solver.attach()
        for i in range(20):
            producer.append(i * 100 * MS, [i, 0, 0, 0, 2])
        solve(solver)
        reader = splinecast.Reader(self.name)
        self.assertEqual(reader.kinds, kinds)
        np.testing.assert_allclose(reader.preview(400 * MS).position, [-2, 0, 0, 0, 1], atol=1e-12)

    def test_a_stream_made_again_starts_where_the_earlier_one_has_left_the_machine(self):
        def arm():
            producer = splinecast.Producer(self.name, dimensions=1)
            self.assertTrue(producer.wait_for_solver(10))
            return producer

        with contextlib.ExitStack() as solvers:
            solvers.enter_context(splinecast.Solver(self.name).start())
            for lead in (0.05, 1, 20):  # on a busy machine a short one is too late
                with arm() as producer:
                    self.assertIsNone(producer.old_end())
                    t = time.monotonic() + lead
                    producer.append_many([t, t + 0.05], [[0.0], [0.25]])
                    self.assertTrue(producer.wait_until_consumed(PATIENCE))
                    refusals = producer.refusals()
                if len(refusals) == 0:
                    break
                solvers.close()
                splinecast.remove(self.name)
                solvers.enter_context(splinecast.Solver(self.name).start())
            producer = arm()
            for call in (lambda t: producer.append(t, [0.5]), lambda t: producer.append_many([t], [[0.5]]),
                         lambda t: producer.replace_from(t - 0.1, [t], [[0.5]]), lambda t: producer.start_from(t, [0.5])):
                with self.assertRaisesRegex(splinecast.Refused, r"elsewhere.*\(0.25\).*\(0.5\)") as raised:
                    call(time.monotonic() + 1)
                self.assertIs(raised.exception.status, splinecast.AppendStatus.ELSEWHERE)
            end, position = producer.old_end()
            np.testing.assert_allclose(position, [0.25], atol=1e-12)
            self.assertEqual(producer.start_from(end, position), 0)
            self.assertEqual(producer.append(time.monotonic() + 0.1, [0.3]), 1)
            self.assertEqual(producer.finish(), 2)
            self.assertTrue(producer.wait_until_consumed(10))
            producer.close()
            producer = arm()
            self.assertEqual(producer.start_from(0, [0.9], moved=True), 0)
            self.assertEqual(producer.append(time.monotonic() + 0.2, [0.9]), 0)
            self.assertEqual(producer.finish(), 1)
            self.assertTrue(producer.wait_until_consumed(10))
            producer.close()
        for value in (-1.0, float("nan")):
            with self.assertRaisesRegex(splinecast.BadRequest, "start tolerance must be 0 or more, not"):
                splinecast.Producer(self.name + ".tolerance", start_tolerance=value)

    def test_contexts_finish_after_a_normal_end_only(self):
        with self.assertRaisesRegex(KeyError, "the body"):
            with splinecast.Producer(self.name, clock="recorded") as producer:
                producer.append(0, 1.0)
                raise KeyError("the body")
        self.assertFalse(producer.is_finished)
        self.assertTrue(producer.is_closed)
        with splinecast.Producer(self.name, clock="recorded") as producer:
            self.assertTrue(producer.continues)
            producer.append(1.0, 2.0)
        self.assertTrue(producer.is_finished)
        with self.assertRaisesRegex(RuntimeError, "producer of '.*' is closed"):
            producer.append(2.0, 2.0)
        producer.close()

    def test_a_context_left_by_an_exception_stops_a_live_stream_at_once(self):
        with splinecast.Solver(self.name).start():
            with self.assertRaisesRegex(KeyError, "the body"):
                with splinecast.Producer(self.name) as producer:
                    begin = time.monotonic() + 0.1
                    for i in range(200):
                        producer.append(begin + i, 0.1 * i)
                    reader = splinecast.Reader(self.name, PATIENCE)
                    wait_for(lambda: reader.preview(begin + 150).velocity[0] > 0.09)
                    wait_for(lambda: reader.sample(time.monotonic()).position[0] > 0.01)
                    raise KeyError("the body")
            self.assertTrue(producer.is_closed)
            wait_for(lambda: reader.preview(begin + 150).velocity[0] == 0)
            self.assertLess(reader.preview(begin + 150).position[0], 15)

    def test_a_second_writer_is_refused(self):
        producer = splinecast.Producer(self.name)
        with self.assertRaises(splinecast.StreamBusy):
            splinecast.Producer(self.name)
        with self.assertRaises(splinecast.StreamBusy):
            splinecast.remove(self.name)
        producer.withdraw()
        self.assertNotIn(self.name, splinecast.streams())

    def test_wrong_options_name_their_values(self):
        for options, text in [
            (dict(dimensions=65), "not 65"),
            (dict(kinds=["round"]), "'round'"),
            (dict(clock="sun"), "'sun'"),
            (dict(start="fast"), "'fast'"),
            (dict(start=("velocity", [1, 2])), "2"),
            (dict(min_interval=-1.0), "-1.0"),
            (dict(capacity=1), "not 1"),
        ]:
            with self.subTest(options), self.assertRaisesRegex(splinecast.BadRequest, text):
                splinecast.Producer(self.name, **options)
        for options, text in [
            (dict(method="c3"), "'c3'"),
            (dict(tail="long"), "'long'"),
            (dict(limits={"speed": 1}), "'speed'"),
            (dict(beyond="run"), "'run'"),
            (dict(settle=65), "65"),
        ]:
            with self.subTest(options), self.assertRaisesRegex(ValueError, text):
                splinecast.Solver(self.name, **options)
        with self.assertRaisesRegex(TypeError, "'speed'"):
            splinecast.Producer(self.name, speed=1)
        with self.assertRaises(splinecast.BadRequest):
            splinecast.Reader("no/name")
        with self.assertRaisesRegex(splinecast.NoSuchStream, self.name):
            splinecast.Reader(self.name, timeout=0.01)


class Live(StreamTest):
    def test_a_live_stream_is_replaced_and_stopped(self):
        with splinecast.Solver(self.name).start() as solver:
            producer = splinecast.Producer(self.name, names=["q"])
            self.assertTrue(producer.wait_for_solver(PATIENCE))
            begin = time.monotonic_ns() + 5_000 * MS
            times = begin + np.arange(100) * 50 * MS
            producer.append_many(times, 0.01 * np.arange(100) ** 2 * 0.05)
            self.assertTrue(producer.wait_until_consumed(PATIENCE))
            reader = splinecast.Reader(self.name, timeout=PATIENCE)
            later = int(times[50])
            preview = producer.preview_replace(later, [later + 500 * MS], [[0.0]], blend=0.1)
            self.assertIs(preview.status, AppendStatus.ACCEPTED)
            self.assertTrue(preview.is_known and preview.enters)
            self.assertEqual(preview.motion.velocity.shape, (1,))
            item = producer.replace_from(later, [later + 500 * MS], [[0.0]], blend=0.1)
            outcome = producer.wait_outcome(item, PATIENCE)
            self.assertEqual(outcome[:4], (OutcomeKind.IN_FORCE, later, OutcomeWay.ENTRY, None))
            self.assertEqual(str(outcome), f"in force at {later} ns: entry")
            self.assertEqual(str(producer.outcome(item - 1)), "withdrawn")
            stop = producer.replace_from(0)
            self.assertEqual(producer.last_item, stop)
            self.assertTrue(producer.wait_until_consumed(PATIENCE))
            self.assertIs(producer.outcome(stop).way, OutcomeWay.STOP)
            self.assertIs(producer.outcome(item).kind, OutcomeKind.WITHDRAWN)
            self.assertIs(producer.outcome(stop + 1).kind, OutcomeKind.WAITING)
            self.assertEqual(producer.refusals(), [])
            rest = wait_for(lambda: (s := reader.sample(time.monotonic())).status is SampleStatus.HOLDING and s)
            np.testing.assert_array_equal(rest.velocity, [0])
            self.assertTrue(solver.is_running and solver.attached)
            producer.finish("clamped")
        self.assertFalse(solver.is_running)
        self.assertIsNone(solver.error)

    def test_wait_returns_at_a_new_revision_and_raises_when_the_stream_is_removed(self):
        _, _, reader = self.recorded()
        self.assertTrue(reader.wait(PATIENCE))
        self.assertFalse(reader.wait(0.01))
        splinecast.remove(self.name)
        with self.assertRaisesRegex(splinecast.NoSuchStream, "make a new Reader"):
            reader.wait()
        self.assertIs(reader.sample(0).status, SampleStatus.RETIRED)

    def test_stop_raises_the_error_that_ended_the_thread(self):
        splinecast.Producer(self.name, dimensions=2)
        solver = splinecast.Solver(self.name, limits={"velocity": [1, 2, 3]}).start()
        error = wait_for(lambda: solver.error)
        self.assertIsInstance(error, splinecast.BadRequest)
        self.assertFalse(solver.is_running)
        with self.assertRaises(splinecast.BadRequest):
            solver.stop()


if __name__ == "__main__":
    unittest.main()
