"""Presses a wall at 5 N with a planar arm of two joints in MuJoCo, by servos that lag and a force sensor with noise.

    python examples/mujoco/press.py [SEED]
hpf learns from nothing but the costs of the steps; hpf.Controller runs the arm at 1 kHz. Put your own in place of `Arm`.
"""

from __future__ import annotations

import sys

import hpf
import mujoco
import numpy as np
from numpy.typing import NDArray

ARM = """
<mujoco><option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/>
<default><joint axis="0 0 1" damping="2"/><geom mass="0.4" contype="0" conaffinity="0"/></default>
<worldbody>
  <geom name="wall" type="box" size="0.02 0.3 0.1" pos="0.62 0 0" contype="1" conaffinity="1" solref="-40 -10"/>
  <body><joint name="shoulder"/><geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03"/>
    <body pos="0.4 0 0"><joint name="elbow"/><geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.025"/>
      <geom name="tip" type="sphere" size="0.02" pos="0.4 0 0" contype="1" conaffinity="1" friction="0"/>
      <site name="tip" pos="0.4 0 0" size="0.03"/></body></body>
</worldbody>
<actuator><position joint="shoulder" kp="4000" kv="120"/><position joint="elbow" kp="4000" kv="80"/></actuator>
<sensor><touch site="tip"/></sensor></mujoco>"""
TASK = """
name = "press"
duration = 1.5
rate = 100.0
axis = [{ name = "x", start = 0.5, goal = 0.58 }]
stiffness = { initial = 200.0, min = 50.0, max = 1000.0 }
damping = { initial = 200.0, min = 50.0, max = 800.0 }
learning = { method = "auto", updates = 30, rollouts = 10, max_rollouts = 200, noise = { movement = 5.0 } }
"""
PRESS, NOISE = 5.0, 0.2  # N


def joints(x: float) -> NDArray[np.float64]:
    """The joint angles [rad] that put the tip at (x, 0) [m]."""
    elbow = float(np.arccos((x * x - 0.32) / 0.32))
    return np.array([-elbow / 2.0, elbow])


class Arm:
    """The arm and its sensor: a Cartesian position in, the force on the tip out."""

    def __init__(self, x: float, seed: int) -> None:
        self.model = mujoco.MjModel.from_xml_string(ARM)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:] = joints(x)
        self.noise = np.random.default_rng(seed)

    def step(self, x: float) -> tuple[float, float]:
        self.data.ctrl[:] = joints(x)
        mujoco.mj_step(self.model, self.data)
        pressed = float(self.data.sensordata[0])
        return pressed, -pressed + NOISE * float(self.noise.standard_normal())


def rollout(policy: hpf.Policy, seed: int = 0) -> NDArray[np.float64]:
    """The costs of the steps: how far the tip is from pressing with 5 N in the second half of the motion."""
    arm, reading, costs = Arm(0.5, seed + (policy.draw or 0)), 0.0, np.zeros(150)
    controller = hpf.Controller(policy, limits={"velocity": 1.0, "force": 50.0, "offset": 0.1}, press=PRESS)
    controller.start()
    for i in range(1500):
        pressed, reading = arm.step(float(controller.update([reading], 1e-3).position[0]))
        if i >= 750:
            costs[i // 10] += 1e-3 * (pressed - PRESS) ** 2
    return costs


if __name__ == "__main__":
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    task = hpf.Task.parse(TASK, environment=hpf.CALLABLE)
    run = hpf.learn(task, seed=seed, rollout=lambda policy: rollout(policy, seed), progress=True)
    force = [float(np.sqrt(cost / 0.75)) for cost in (run.history.total[0], run.cost)]
    print(f"{run}\nforce error, RMS: {force[0]:.2f} N before, {force[1]:.3f} N after")
