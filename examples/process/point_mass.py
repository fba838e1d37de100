"""A point mass under stiffness and damping, as an environment of hpf: the protocol is in docs/process.md.

    m a = k (r - x) + d (r' - v) - c v - m g sin(slope)     semi-implicit Euler, ten steps to one of the task

hpf starts this program and talks to it in JSON lines. Put a robot in the place of `rollout` and keep the rest.
With --costs it answers with a cost per step instead of the trace. Standard library only.
"""

import json
import math
import sys

MASS = 2.0        # kg
FRICTION = 8.0    # N s/m
SLOPE = 0.15      # rad, uphill
GRAVITY = 9.81    # m/s^2
SUBSTEPS = 10


def rollout(axis, time_step):
    """One motion: position, velocity and force of the environment on the mass, at the start and after every step."""
    position, velocity = axis["reference_position"][0], 0.0
    trace = {"position": [], "velocity": [], "force": []}
    dt = time_step / SUBSTEPS
    for step, stiffness in enumerate(axis["stiffness"]):
        force = -FRICTION * velocity - MASS * GRAVITY * math.sin(SLOPE)
        trace["position"].append(position)
        trace["velocity"].append(velocity)
        trace["force"].append(force)
        for _ in range(SUBSTEPS):
            offset = axis["reference_position"][step] - position
            speed = axis["reference_velocity"][step] - velocity
            force = -FRICTION * velocity - MASS * GRAVITY * math.sin(SLOPE)
            velocity += dt * (stiffness * offset + axis["damping"][step] * speed + force) / MASS
            position += dt * velocity
    return trace


def costs(trace, axis, goal, time_step):
    """What the motion costs, step by step: far from the goal late in the motion is dear, and so is stiffness."""
    steps = len(trace["position"]) - 1
    late = [time_step * (i / steps) ** 2 for i in range(1, steps + 1)]
    away = [500.0 * (x - goal) ** 2 for x in trace["position"][1:]]
    stiff = [1e-6 * k**2 for k in axis["stiffness"][1:]]
    return [weight * error + time_step * price for weight, error, price in zip(late, away, stiff)]


def say(answer):
    print(json.dumps(answer), flush=True)


def main():
    tells_costs = "--costs" in sys.argv[1:]
    hello = json.loads(sys.stdin.readline())
    goal = hello["policy"]["axes"][0]["goal"]
    say({"type": "ready", "protocol": 1, "answers": "costs" if tells_costs else "trace"})
    for line in sys.stdin:
        request = json.loads(line)
        axis = request["axes"][0]
        trace = rollout(axis, hello["time_step"])
        if tells_costs:
            say({"type": "done", "id": request["id"], "costs": costs(trace, axis, goal, hello["time_step"])})
        else:
            say({"type": "done", "id": request["id"], "axes": [trace]})


if __name__ == "__main__":
    main()
