"""Gymnasium: the checker's verdict, skills as actions, policies as agents."""

from __future__ import annotations

from typing import Any

import gymnasium
import hpf
import numpy as np
import pytest
from conftest import TASKS
from gymnasium.spaces import Box
from gymnasium.utils.env_checker import check_env
from hpf.gym import Agent, SkillEnv, impedance_action
from numpy.typing import NDArray


class Spring(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """A mass of 1 kg by an impedance, pushed; it is to be at 0.3 m, softly."""

    observation_space = Box(-np.inf, np.inf, (2,), np.float32)
    action_space = Box(-np.inf, np.inf, (3,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        super().reset(seed=seed)
        self.state = np.array([0.0, 0.0])
        self.push = float(self.np_random.normal(-2.0, 0.1))
        return self.state.astype(np.float32), {}

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        reference, stiffness, damping = (float(number) for number in action)
        force = stiffness * (reference - self.state[0]) - damping * self.state[1] + self.push
        velocity = self.state[1] + 0.01 * force
        self.state = np.array([self.state[0] + 0.01 * velocity, velocity])
        return self.state.astype(np.float32), -abs(self.state[0] - 0.3) - 1e-5 * stiffness, False, False, {}


@pytest.fixture
def task() -> hpf.Task:
    return hpf.Task.load(TASKS / "reach.toml", disturbance=None)


def test_the_checker_of_gymnasium_finds_nothing(task: hpf.Task) -> None:
    check_env(SkillEnv(Spring(), task), skip_render_check=True)
    check_env(SkillEnv(Spring(), task, skills=3), skip_render_check=True)


def test_an_action_is_a_skill(task: hpf.Task) -> None:
    env = SkillEnv(Spring(), task)
    env.reset(seed=1)
    weights = hpf.Policy.initial(task).weights
    action = env.action(hpf.Policy.initial(task))
    assert env.action_space.contains(action) and env.policy(action).weights == pytest.approx(weights, rel=1e-5)
    observation, reward, terminated, truncated, info = env.step(action)
    assert terminated and not truncated and info["steps"] == 100 and isinstance(info["policy"], hpf.Policy)
    assert abs(observation[0] - 0.3) < 0.1 and float(reward) < 0


def test_an_agent_makes_the_motion_of_its_policy(task: hpf.Task) -> None:
    env, agent = SkillEnv(Spring(), task), Agent(hpf.Policy.initial(task), task, act=impedance_action)
    env.reset(seed=1)
    _, whole, *_ = env.step(env.action(hpf.Policy.initial(task)))
    observation, _ = env.env.reset(seed=1)
    total = 0.0
    while not agent.done:
        observation, reward, *_ = env.env.step(agent(observation))
        total += float(reward)
    assert total == pytest.approx(float(whole), rel=1e-3)
    agent.reset()
    assert not agent.done


def test_a_skill_env_is_an_environment_to_learn_in(task: hpf.Task) -> None:
    env = SkillEnv(Spring(), task)

    def rollout(policy: hpf.Policy) -> float:
        env.reset(seed=policy.draw or 0)
        return -float(env.step(env.action(policy))[1])

    learning = {"method": "pi2", "updates": 5, "rollouts": 6, "noise": {"movement": 3.0}}
    run = hpf.learn(task.replace(cost=None, environment=hpf.CALLABLE, accept=None, learning=learning), rollout=rollout)
    assert run.cost < run.history.total[0]
