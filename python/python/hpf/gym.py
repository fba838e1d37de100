"""Gymnasium: skills as actions, and policies as agents. Needs the extra ``hpf-robotics[gym]``."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, Generic, SupportsFloat, TypeVar

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from hpf._hpf import Motion, Policy, Task

Array = NDArray[np.float64]
Act = Callable[[Array, Array, Array, Array], Any]
"""An action of the environment from reference position [axis unit], reference velocity [axis unit/s], stiffness
[N/m or N m/rad] and damping [N s/m or N m s/rad], each of shape (axes,)."""
Observation = TypeVar("Observation")


def position_action(position: Array, velocity: Array, stiffness: Array, damping: Array) -> NDArray[np.float32]:
    """The action of an environment that follows positions, shape (axes,)."""
    return position.astype(np.float32)


def impedance_action(position: Array, velocity: Array, stiffness: Array, damping: Array) -> NDArray[np.float32]:
    """The action of an environment that takes an impedance: positions, stiffness and damping, shape (3 axes,)."""
    return np.concatenate([position, stiffness, damping]).astype(np.float32)


def _command(motion: Motion, i: int, act: Act) -> Any:
    i = min(i, motion.steps)
    signals = (motion.reference_position, motion.reference_velocity, motion.stiffness, motion.damping)
    return act(*(signal[i] for signal in signals))


class SkillEnv(gymnasium.Env[Observation, NDArray[np.float32]], Generic[Observation]):
    """One action is one skill: the weights of movement, stiffness and damping, carried out in ``env`` to its end.

    ``task`` says axes, duration, rate, bases and bounds; a step of ``env`` is one of its steps. Actions have shape (n,),
    each number in [-1, 1]: weights of a movement are those of the start and ``movement_scale`` [1] times the action;
    weights of stiffness and damping go from their least to their largest value. The reward is the sum over the skill, and
    an episode is one skill, or ``skills`` of them one after the other.
    """

    def __init__(
        self,
        env: gymnasium.Env[Observation, Any],
        task: Task,
        *,
        act: Act = impedance_action,
        movement_scale: float = 10.0,
        skills: int = 1,
    ) -> None:
        self.env, self.task, self.act, self.skills = env, task, act, skills
        self.start = Policy.initial(task)
        self.middle, self.half = _ranges(self.start, movement_scale)
        self.observation_space = env.observation_space
        self.action_space = Box(-1.0, 1.0, self.middle.shape, np.float32)
        self.metadata = env.metadata
        self.render_mode = env.render_mode
        self.made = 0

    def policy(self, action: NDArray[np.float32]) -> Policy:
        """The policy that ``action`` stands for."""
        share = np.clip(np.asarray(action, np.float64), -1.0, 1.0)
        return self.start.with_weights(self.middle + share * self.half)

    def action(self, policy: Policy) -> NDArray[np.float32]:
        """The action that stands for ``policy``, as near as actions go."""
        return np.clip((policy.weights - self.middle) / self.half, -1.0, 1.0).astype(np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        self.made = 0
        return self.env.reset(seed=seed, options=options)

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, SupportsFloat, bool, bool, dict[str, Any]]:
        policy = self.policy(action)
        motion = policy.planned(self.task)
        total, terminated, truncated = 0.0, False, False
        info: dict[str, Any] = {}
        signals = (motion.reference_position, motion.reference_velocity, motion.stiffness, motion.damping)
        for i in range(1, motion.steps + 1):
            command = self.act(*(signal[i] for signal in signals))
            observation, reward, terminated, truncated, info = self.env.step(command)
            total += float(reward)
            if terminated or truncated:
                break
        self.made += 1
        over = terminated or (not truncated and self.made >= self.skills)
        return observation, total, over, truncated, {**info, "policy": policy, "steps": i}

    def render(self) -> Any:
        return self.env.render()

    def close(self) -> None:
        self.env.close()


class Agent:
    """A policy as an agent of an environment: an action for every observation, in the order of time."""

    def __init__(self, policy: Policy, task: Task, *, act: Act = impedance_action) -> None:
        self.motion, self.act, self.made = policy.planned(task), act, 0

    def reset(self) -> None:
        """Begins anew."""
        self.made = 0

    @property
    def done(self) -> bool:
        """Whether the movement has ended: its last command is then repeated."""
        return self.made >= self.motion.steps

    def __call__(self, observation: object = None) -> Any:
        self.made = min(self.made + 1, self.motion.steps)
        return _command(self.motion, self.made, self.act)


def _ranges(policy: Policy, movement_scale: float) -> tuple[Array, Array]:
    """Middle and half width of every weight."""
    middle: list[float] = []
    half: list[float] = []
    for axis in json.loads(policy.to_json())["axes"]:
        middle += axis["movement"]["weights"]
        half += [movement_scale] * len(axis["movement"]["weights"])
        for gain in (axis["stiffness"], axis["damping"]):
            count = len(gain["weights"])
            middle += [0.5 * (gain["min"] + gain["max"])] * count
            half += [0.5 * (gain["max"] - gain["min"])] * count
    return np.array(middle), np.array(half)
