"""One motion in many formats, each made by an independent writer, imitated by hpf: a table of commands and RMSE.

The motion: x from 0 to 0.3 m by minimum jerk in 2 s, y a hump of 50 mm, sampled at 100 Hz. The RMSE is that of the
policy's reference (trajectory.csv) from the motion itself, calculated here by numpy.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode
from rosbags.typesys import Stores, get_typestore

PROGRAM = str(Path(sys.argv[1]).resolve())
DURATION, RATE = 2.0, 100
TIME = np.arange(int(DURATION * RATE) + 1) / RATE
EPOCH = 1_700_000_000_000_000_000
STAMPS = EPOCH + (TIME * 1e9).round().astype(np.int64)
# The worst RMSE of a source that is read right [m]: 20 functions in 2 s.
ALLOWED = 0.5e-3


def motion(time):
    """x and y [m] at a time [s]."""
    u = np.clip(time / DURATION, 0, 1)
    s = u**3 * (10 - 15 * u + 6 * u**2)
    return 0.3 * s, 0.2 * (s - s**2)


X, Y = motion(TIME)
store = get_typestore(Stores.ROS2_HUMBLE)
types = store.types


def header(i):
    time = types["builtin_interfaces/msg/Time"](sec=int(STAMPS[i] // 10**9), nanosec=int(STAMPS[i] % 10**9))
    return types["std_msgs/msg/Header"](stamp=time, frame_id="base")


def point(i):
    return types["geometry_msgs/msg/Point"](x=X[i], y=Y[i], z=0.5 - X[i])


def vector(x, y, z):
    return types["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)


TURN = types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)


def pose(i):
    return types["geometry_msgs/msg/Pose"](position=point(i), orientation=TURN)


def pose_stamped(i):
    return types["geometry_msgs/msg/PoseStamped"](header=header(i), pose=pose(i))


def transform(i):
    moved = types["geometry_msgs/msg/Transform"](translation=vector(X[i], Y[i], 0.5 - X[i]), rotation=TURN)
    return types["geometry_msgs/msg/TransformStamped"](header=header(i), child_frame_id="tool", transform=moved)


def odometry(i):
    with_covariance = types["geometry_msgs/msg/PoseWithCovariance"](pose=pose(i), covariance=np.zeros(36))
    twist = types["geometry_msgs/msg/Twist"](linear=vector(0.0, 0.0, 0.0), angular=vector(0.0, 0.0, 0.0))
    twist = types["geometry_msgs/msg/TwistWithCovariance"](twist=twist, covariance=np.zeros(36))
    return types["nav_msgs/msg/Odometry"](
        header=header(i), child_frame_id="tool", pose=with_covariance, twist=twist
    )


def joints(i):
    return types["sensor_msgs/msg/JointState"](
        header=header(i), name=["j1", "j2"], position=np.array([X[i], Y[i]]), velocity=np.zeros(2), effort=np.zeros(2)
    )


def wrench(i):
    force = types["geometry_msgs/msg/Wrench"](force=vector(float(i), 0.0, 0.0), torque=vector(0.0, 0.0, 0.0))
    return types["geometry_msgs/msg/WrenchStamped"](header=header(i), wrench=force)


def bag(folder, topics, **options):
    """A bag of ROS 2 whose messages arrive in bursts of four."""
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    if options:
        writer.set_compression(**options)
    with writer:
        for topic, make in topics:
            first = make(0)
            connection = writer.add_connection(topic, first.__msgtype__, typestore=store)
            for i in range(len(TIME)):
                arrival = int(STAMPS[i // 4 * 4]) + i % 4
                writer.write(connection, arrival, store.serialize_cdr(make(i), first.__msgtype__))


def sources(folder):
    """Name, file and options of each source."""
    table = pd.DataFrame({"time_s": TIME, "x_m": X, "y_m": Y})
    table.to_csv(folder / "own.csv", index=False)
    yield "CSV with hpf's names (pandas)", "own.csv", ""
    table.to_csv(folder / "german.csv", index=False, sep=";", decimal=",", encoding="utf-16")
    yield "semicolons, decimal comma, UTF-16 (pandas)", "german.csv", ""
    table.to_csv(folder / "tabs.tsv", index=False, sep="\t", encoding="utf-8-sig")
    yield "tabs, byte order mark (pandas)", "tabs.tsv", ""
    np.savetxt(folder / "saved.txt", np.column_stack([TIME, X, Y]), header="time_s x_m y_m")
    yield "numpy.savetxt, commented header", "saved.txt", ""
    np.savetxt(folder / "bare.txt", np.column_stack([TIME, X, Y]))
    yield "numpy.savetxt, no header", "bare.txt", "--time #1:s --axis x=#2:m --axis y=#3:m"
    odd = pd.DataFrame({"stamp": STAMPS, "id": 7, "px": 1e3 * X, "py": 1e3 * Y, "state": "ok"})
    odd.to_csv(folder / "odd.csv", index=False)
    yield "own names, ns, mm, a column of words (pandas)", "odd.csv", "--time stamp:ns --axis x=px:mm --axis y=py:mm"
    pd.DataFrame({"x [cm]": 1e2 * X, "y [cm]": 1e2 * Y}).to_csv(folder / "untimed.csv", index=False)
    yield "no time, units in names (pandas)", "untimed.csv", "--sample-rate 100 --axis x=x --axis y=y"

    rtde = {"timestamp": 1234.5 + TIME}
    rtde |= {f"actual_TCP_pose_{i}": [X, Y, 0.4 + 0 * X, 0 * X, 3.1 + 0 * X, 0 * X][i] for i in range(6)}
    rtde |= {f"actual_TCP_force_{i}": 0.1 * i + 0 * X for i in range(6)}
    pd.DataFrame(rtde).to_csv(folder / "rtde.txt", index=False, sep=" ")
    yield "Universal Robots, RTDE client", "rtde.txt", "--preset ur"
    pose_columns = {f"O_T_EE[{i}]": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, X, Y, 0.5, 1][i] + 0 * X for i in range(16)}
    pd.DataFrame({"time": (1e3 * TIME).round().astype(int)} | pose_columns).to_csv(folder / "franka.csv", index=False)
    yield "Franka, states as columns", "franka.csv", "--preset franka"
    tum = np.column_stack([1.3e9 + TIME, X, Y, 1 + 0 * X, 0 * X, 0 * X, 0 * X, 1 + 0 * X])
    np.savetxt(folder / "groundtruth.txt", tum, fmt="%.6f", header="timestamp tx ty tz qx qy qz qw")
    yield "TUM RGB-D trajectory", "groundtruth.txt", "--preset tum"
    euroc = pd.DataFrame({"#timestamp [ns]": STAMPS, " p_RS_R_x [m]": X, " p_RS_R_y [m]": Y, " p_RS_R_z [m]": 1.0, " q_w []": 1.0})
    euroc.to_csv(folder / "euroc.csv", index=False)
    yield "EuRoC ground truth", "euroc.csv", "--preset euroc"
    with open(folder / "take.csv", "w") as file:
        file.write("Format Version,1.23,Take Name,take,Capture Frame Rate,100,Length Units,Millimeters\n\n")
        for kind, words in [("Type", "Rigid Body"), ("Name", "tool"), ("ID", "1")]:
            file.write(f",{kind}" + f",{words}" * 7 + "\n")
        file.write(",," + ",".join(["Rotation"] * 4 + ["Position"] * 3) + "\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z\n")
        for i, t in enumerate(TIME):
            file.write(f"{i},{t:.6f},0,0,0,1,{1e3 * X[i]:.6f},{1e3 * Y[i]:.6f},500\n")
    yield "OptiTrack Motive export", "take.csv", "--preset optitrack"
    np.save(folder / "lasa.npy", np.vstack([TIME, 1e3 * X, 1e3 * Y]))
    yield "LASA stroke, .npy of 3 x n, mm", "lasa.npy", "--preset lasa"

    np.save(folder / "plain.npy", np.column_stack([TIME, X, Y]).astype(np.float32))
    yield ".npy, float32", "plain.npy", "--time #1:s --axis x=#2:m --axis y=#3:m"
    named = np.zeros(len(TIME), dtype=[("time_s", "<f8"), ("x_m", ">f8"), ("y_m", "<f8")])
    named["time_s"], named["x_m"], named["y_m"] = TIME, X, Y
    np.save(folder / "named.npy", named)
    yield ".npy with named fields, both byte orders", "named.npy", ""
    np.savez_compressed(folder / "arrays.npz", t=TIME, pos=np.column_stack([X, Y]), dt=0.01)
    yield ".npz, compressed", "arrays.npz", "--time t:s --axis x=pos_0:m --axis y=pos_1:m"

    bag(folder / "poses", [("/pose", pose_stamped)])
    yield "ROS 2 bag (MCAP), PoseStamped", "poses", ""
    bag(folder / "zstd", [("/pose", pose_stamped)], mode=CompressionMode.STORAGE, fmt=CompressionFormat.ZSTD)
    yield "the same, chunks packed with zstd", "zstd", ""
    bag(folder / "tf", [("/tf", lambda i: types["tf2_msgs/msg/TFMessage"](transforms=[transform(i)]))])
    yield "ROS 2 bag, TFMessage", "tf", ""
    bag(folder / "odometry", [("/odom", odometry)])
    yield "ROS 2 bag, Odometry", "odometry", ""
    bag(folder / "joints", [("/joint_states", joints)])
    yield "ROS 2 bag, JointState", "joints", ""
    bag(folder / "several", [("/pose", pose_stamped), ("/other", pose_stamped), ("/wrench", wrench)])
    yield "ROS 2 bag, pose and wrench of several topics", "several", "--topic /pose,/wrench --force-column x=force.x"


def main():
    print("| source | options of `hpf imitate FILE` | RMSE [mm] |\n|---|---|---|")
    is_right = True
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, file, options in sources(folder):
            command = [PROGRAM, "imitate", file, "--out", f"run_{file}", "--quiet", "--json", *options.split()]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
            if done.returncode != 0:
                print(f"FAILED: {name}: {' '.join(command[1:])}\n{done.stderr}", file=sys.stderr)
                is_right = False
                continue
            run = pd.read_csv(folder / f"run_{file}" / "trajectory.csv")
            run = run[run["time_s"] <= DURATION + 1e-9]
            paths = [run[[column for column in run if "_reference_" in column and "velocity" not in column]]]
            made = motion(run["time_s"].to_numpy())
            squares = [(paths[0].iloc[:, a].to_numpy() - made[a]) ** 2 for a in range(2)]
            rmse = float(np.sqrt(np.mean(np.sum(squares, axis=0))))
            is_right &= rmse < ALLOWED
            print(f"| {name} | `{options or '-'}` | {1e3 * rmse:.3f} |" + ("" if rmse < ALLOWED else " FAILED"))
            json.loads(done.stdout)
    sys.exit(0 if is_right else 1)


main()
