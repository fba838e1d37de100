"""Two nodes of Ray on the loopback of one machine, one of them killed in mid-learning: the result of a single machine.

    python tests/ray_two_nodes.py

Needs ``pip install "hpf-robotics[ray]"``. A script of its own and no part of pytest: nodes take their time to start.
Each is started by `ray start` with ports of its own, bound to the loopback, and ended by its process id.
"""

from __future__ import annotations

import logging
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

os.environ["RAY_AUTH_MODE"] = "disabled"  # both nodes are ours, and on the loopback
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

import hpf
import hpf.ray
import numpy as np
import ray

TASK = """
name = "free"
duration = 1.0
rate = 50.0
axis = [{ name = "x", start = 0.0, goal = 0.3 }]
stiffness = { initial = 100.0, min = 30.0, max = 400.0 }
damping = { initial = 50.0, min = 10.0, max = 100.0 }
learning = { method = "pi2", updates = 12, rollouts = 6, seed = 3 }
"""
HEAD, SECOND = "127.0.0.2", "127.0.0.3"  # not 127.0.0.1, which Ray takes for the address of the machine in its network


class Warnings(logging.Handler):
    """What hpf.ray warned of."""

    def __init__(self) -> None:
        super().__init__()
        self.said: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.said.append(record.getMessage())


def free_ports(count: int) -> list[int]:
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind((HEAD, 0))
        return [int(one.getsockname()[1]) for one in sockets]


def family(pid: int) -> list[int]:
    """A process and all that it started."""
    parents: dict[int, int] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            parents[int(stat.parent.name)] = int(stat.read_text().rpartition(")")[2].split()[1])
        except (OSError, ValueError):
            continue
    members = [pid]
    for member in members:
        members += [child for child, parent in parents.items() if parent == member]
    return members


def end(node: subprocess.Popen[bytes]) -> None:
    """Kills a node at once, as a power cut does."""
    for pid in family(node.pid):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            continue
    node.wait()


@contextmanager
def started(
    folder: Path, address: str, head: str | None, tries: int = 6
) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A node with one CPU, and the address of its cluster. Ray waits 30 s for a node: on a busy machine it is tried again."""
    for _ in range(tries):
        gcs, manager, objects, agent, environment, metrics, dashboard = free_ports(7)
        command = [
            str(Path(sys.executable).parent / "ray"),
            "start",
            "--block",
            "--disable-usage-stats",
            "--num-cpus=1",
        ]
        command += [
            f"--node-ip-address={address}",
            f"--node-manager-port={manager}",
            f"--object-manager-port={objects}",
        ]
        command += [f"--dashboard-agent-listen-port={agent}", f"--runtime-env-agent-port={environment}"]
        command += [f"--metrics-export-port={metrics}", "--object-store-memory=80000000", "--include-log-monitor=false"]
        if head is None:
            command += ["--head", f"--port={gcs}", f"--temp-dir={folder}", "--include-dashboard=false", "--no-monitor"]
            command += [f"--dashboard-port={dashboard}"]
        else:
            command += [f"--address={head}"]
        log = folder.parent / f"node-{address}.log"
        with log.open("wb") as file:
            node = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT)
        while node.poll() is None and b"Ray runtime started" not in log.read_bytes():
            time.sleep(1.0)
        if node.poll() is None:
            break
        print(f"the node at {address} did not start: {log.read_text().splitlines()[-1]}", flush=True)
    else:
        raise SystemExit("a node did not start")
    try:
        yield node, head or f"{address}:{gcs}"
    finally:
        if node.poll() is None:
            end(node)


def connected(address: str, nodes: int, patience_s: float = 600.0) -> None:
    """Connects to the cluster once it has so many nodes."""
    until = time.monotonic() + patience_s
    while True:
        try:
            if not ray.is_initialized():
                ray.init(address=address, _node_ip_address=HEAD, log_to_driver=False, logging_level="error")
            if sum(bool(node["Alive"]) for node in ray.nodes()) == nodes:
                return
        except (OSError, RuntimeError):
            if time.monotonic() > until:
                raise
        if time.monotonic() > until:
            raise TimeoutError(f"not {nodes} nodes within {patience_s} s")
        time.sleep(1.0)


class Rollout:
    """A motion of 0.3 s that costs what its weights are off 10, and notes the node that made it."""

    def __init__(self, diary: Path | None) -> None:
        self.diary = diary

    def __call__(self, policy: hpf.Policy) -> float:
        if self.diary is not None:
            with self.diary.open("a") as file:
                file.write(ray.get_runtime_context().get_node_id() + "\n")
            time.sleep(0.3)
        return float(np.square(policy.weights[:20] - 10.0).sum())


def dies(policy: hpf.Policy) -> float:
    """Takes its worker along wherever the first weight is above 12; otherwise costs what `Rollout` says."""
    if policy.weights[0] > 12.0:
        os._exit(1)
    return Rollout(None)(policy)


def rejects(policy: hpf.Policy) -> float:
    """The same on one machine."""
    if policy.weights[0] > 12.0:
        raise hpf.RolloutFailed("above 12")
    return Rollout(None)(policy)


def check(is_so: bool, what: str) -> None:
    print(f"{'ok' if is_so else 'FAILED'}: {what}", flush=True)
    if not is_so:
        raise SystemExit(1)


def main() -> None:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # no node is left behind
    task = hpf.Task.parse(TASK, environment=hpf.CALLABLE)
    warnings = Warnings()
    logging.getLogger("hpf.ray").addHandler(warnings)
    local = hpf.learn(task, rollout=Rollout(None))
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="hpf", dir="/tmp")))
        _, address = stack.enter_context(started(folder / "ray", HEAD, None))
        connected(address, 1)
        second, _ = stack.enter_context(started(folder / "ray", SECOND, address))
        connected(address, 2)
        stack.callback(ray.shutdown)
        diary = folder / "diary"

        (there,) = [node["NodeID"] for node in ray.nodes() if node["NodeManagerAddress"] == SECOND]

        def cut() -> None:
            """Kills the second node in the midst of a rollout: as soon as it has begun one more."""
            begun = diary.read_text().count(there)
            while diary.read_text().count(there) == begun:
                time.sleep(0.01)
            end(second)

        def watch(evaluation: hpf.Evaluation) -> None:
            if evaluation.update == 4:
                threading.Thread(target=cut, daemon=True).start()

        far = hpf.ray.learn(task, Rollout(diary), progress=watch)
        nodes = set(diary.read_text().split())
        check(len(nodes) == 2, "both nodes made rollouts")
        check(second.poll() is not None, "one of them was killed in mid-learning")
        check(len(warnings.said) > 0, f"its rollouts were lost and made again: {warnings.said[:1]}")
        check(far.policy.to_json() == local.policy.to_json(), "the same policy, byte for byte")
        check(far.history.total.tolist() == local.history.total.tolist(), "the same history")

        settings = [{"learning": {"rollouts": rollouts}} for rollouts in (4, 6)]
        runs = hpf.ray.sweep(task, seeds=(1, 2), settings=settings, rollout=Rollout(None))
        for run, (changes, seed) in zip(runs, [(one, seed) for one in settings for seed in (1, 2)], strict=True):
            alone = hpf.learn(task.replace(**changes), seed=seed, rollout=Rollout(None))
            assert run.policy is not None and run.seed == seed
            check(run.policy.to_json() == alone.policy.to_json(), f"a sweep's run is a run: {changes}, seed {seed}")

        cluster = hpf.ray.Cluster(tries=2, max_lost=100)
        lossy = hpf.ray.learn(task.replace(learning={"updates": 2}), dies, cluster=cluster)
        alone = hpf.learn(task.replace(learning={"updates": 2}), rollout=rejects)
        check(lossy.policy.to_json() == alone.policy.to_json(), "rollouts that end their worker each time are rejected")
        slow = hpf.ray.Cluster(timeout_s=5.0, tries=1, max_lost=0)
        try:
            hpf.ray.learn(task, lambda policy: time.sleep(600.0), cluster=slow, answers="costs")
        except hpf.RolloutError as error:
            check(isinstance(error.__cause__, hpf.ray.WorkLost), f"a rollout that hangs is ended: {error}")
        else:
            check(False, "a rollout that hangs is ended")


if __name__ == "__main__":
    main()
