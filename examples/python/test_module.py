"""Contracts of the module: arrays without a copy, protected against writes and steps."""

import gc
import os
import tempfile
import threading
import unittest

import mujoco_safe_python
import numpy as np

MODELS = os.path.join(os.path.dirname(__file__), "..", "..", "models")
CARTPOLE = os.path.join(MODELS, "cartpole.xml")
HUMANOID = os.path.join(MODELS, "humanoid.xml")
STEP = 0.002
GRAVITY = 9.81
FALL = f"""<mujoco><option timestep="{STEP}" gravity="0 0 -{GRAVITY}"/><worldbody><body>
  <joint name="fall" type="slide" axis="0 0 1"/><geom size=".1" mass="2"/>
</body></worldbody><actuator><motor joint="fall"/></actuator><sensor><jointpos joint="fall"/></sensor></mujoco>"""


def address(array):
    return array.__array_interface__["data"][0]


def controls(batch):
    return np.zeros((batch.count, batch.nu))


class Arrays(unittest.TestCase):
    def setUp(self):
        self.batch = mujoco_safe_python.Batch(CARTPOLE, 4)

    def test_arrays_are_views_of_the_memory_of_the_batch(self):
        batch = self.batch
        self.assertTrue(np.shares_memory(batch.states, batch.states))
        self.assertFalse(batch.states.flags.owndata)
        self.assertTrue(batch.states.flags.c_contiguous)
        self.assertEqual((batch.states.shape[0], batch.states.dtype), (4, np.float64))
        before, places = batch.states.copy(), [address(batch.states), address(batch.sensordata)]
        batch.step(controls(batch) + 1)
        self.assertEqual(places, [address(batch.states), address(batch.sensordata)])
        self.assertFalse(np.array_equal(before, batch.states), "the same memory has the new states")

    def test_a_step_or_reset_while_an_array_exists_is_an_error_that_changes_nothing(self):
        batch = self.batch
        for make in [lambda: batch.states, lambda: batch.states[1:, 2], lambda: memoryview(batch.sensordata)]:
            view, before = make(), batch.states.copy()
            with self.assertRaisesRegex(BufferError, r"arrays borrow .* \(1\)"):
                batch.step(controls(batch) + 1)
            with self.assertRaises(BufferError):
                batch.reset()
            self.assertTrue(np.array_equal(before, batch.states))
            del view
            batch.step(controls(batch) + 1)
            self.assertFalse(np.array_equal(before, batch.states))

    def test_arrays_cannot_be_written(self):
        for array in [self.batch.states, self.batch.sensordata, self.batch.states[0]]:
            with self.assertRaises(ValueError):
                array[...] = 1
            with self.assertRaises(ValueError):
                array.flags.writeable = True
            with self.assertRaises(ValueError):
                array.setflags(write=True)
            with self.assertRaises(TypeError):
                memoryview(array)[0] = 1

    def test_an_array_outlives_the_variable_of_its_batch(self):
        states = self.batch.states
        expected = states.copy()
        self.batch = None
        gc.collect()
        self.assertTrue(np.array_equal(states, expected))

    def test_use_during_a_step_of_another_thread_is_an_error(self):
        batch = mujoco_safe_python.Batch(HUMANOID, 64)
        thread = threading.Thread(target=batch.step, args=(controls(batch), 100))
        refused = 0
        thread.start()
        while thread.is_alive():
            try:
                batch.states.sum()
            except RuntimeError:
                refused += 1
        thread.join()
        self.assertGreater(refused, 0)


class Simulations(unittest.TestCase):
    def test_a_falling_body_has_the_position_of_the_semi_implicit_euler_method(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "fall.xml")
            with open(path, "w") as file:
                file.write(FALL)
            batch = mujoco_safe_python.Batch(path, 3)
        forces = np.array([[0.0], [2.0], [2 * GRAVITY]])
        steps = 50
        batch.step(forces, steps)
        acceleration = forces[:, 0] / 2 - GRAVITY
        position = acceleration * STEP**2 * steps * (steps + 1) / 2
        np.testing.assert_allclose(batch.states[:, 0], steps * STEP, rtol=1e-12)
        np.testing.assert_allclose(batch.states[:, 1], position, rtol=1e-9, atol=1e-12)
        # Readings are those of the state before the last step.
        before = acceleration * STEP**2 * steps * (steps - 1) / 2
        np.testing.assert_allclose(batch.sensordata[:, 0], before, rtol=1e-9, atol=1e-12)

    def test_a_failure_affects_one_simulation(self):
        batch = mujoco_safe_python.Batch(CARTPOLE, 3)
        wrong = controls(batch)
        wrong[1] = np.nan
        batch.step(wrong)
        self.assertEqual([index for index, _ in batch.failures()], [1])
        self.assertTrue(np.isnan(batch.sensordata[1]).all() and np.isfinite(batch.states[[0, 2]]).all())
        batch.reset()
        self.assertEqual(batch.failures(), [])

    def test_wrong_arguments_are_errors(self):
        batch = mujoco_safe_python.Batch(CARTPOLE, 3)
        for wrong in [np.zeros((2, 1)), np.zeros((3, 2))]:
            with self.assertRaisesRegex(ValueError, r"shape \(3, 1\)"):
                batch.step(wrong)
        with self.assertRaises(TypeError):
            batch.step(np.zeros((3, 1), dtype=np.float32))
        with self.assertRaisesRegex(ValueError, "nowhere"):
            batch.reset("nowhere")
        with self.assertRaises(ValueError):
            mujoco_safe_python.Batch("no such file.xml", 1)
        with self.assertRaises(ValueError):
            mujoco_safe_python.Batch(CARTPOLE, 2**62)


if __name__ == "__main__":
    unittest.main()
