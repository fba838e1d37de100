#!/usr/bin/env python3
"""Checks logs and ROS 2 bags of hpf with other programs' readers: PyPI `mcap` with its decoders, `rerun mcap check`.

    pip install mcap mcap-protobuf-support mcap-ros2-support rerun-sdk
    python3 check_mcap.py LOG.mcap...

Exits with 1 when anything is wrong with a log or Rerun is missing, with 2 when the readers are missing.
"""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

try:
    from mcap.reader import make_reader
    from mcap.stream_reader import StreamReader
    from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoders
    from mcap_ros2.decoder import DecoderFactory as Ros2Decoders
except ImportError as error:
    print(f"{error}: pip install mcap mcap-protobuf-support mcap-ros2-support rerun-sdk", file=sys.stderr)
    sys.exit(2)

PROTOBUF = ("protobuf", "protobuf")
EVERY_SAMPLE, ONCE, SOME = "every sample", "once", "some"
TOPICS = {
    "/tool/pose": ("foxglove.PoseInFrame", *PROTOBUF, EVERY_SAMPLE),
    "/reference/pose": ("foxglove.PoseInFrame", *PROTOBUF, EVERY_SAMPLE),
    "/tf": ("foxglove.FrameTransforms", *PROTOBUF, EVERY_SAMPLE),
    "/path/reference": ("foxglove.PosesInFrame", *PROTOBUF, ONCE),
    "/path/learned": ("foxglove.PosesInFrame", *PROTOBUF, ONCE),
    "/scene": ("foxglove.SceneUpdate", *PROTOBUF, SOME),
    "/log": ("foxglove.Log", *PROTOBUF, SOME),
    "/hpf/state": ("hpf.State", *PROTOBUF, EVERY_SAMPLE),
    "/hpf/update": ("hpf.Update", *PROTOBUF, SOME),
    "/hpf/axes": ("sensor_msgs/msg/JointState", "ros2msg", "cdr", EVERY_SAMPLE),
}
BAG = {
    "/tool/pose": "geometry_msgs/msg/PoseStamped",
    "/reference/pose": "geometry_msgs/msg/PoseStamped",
    "/tool/wrench": "geometry_msgs/msg/WrenchStamped",
    "/joint_states": "sensor_msgs/msg/JointState",
    "/gains": "std_msgs/msg/Float64MultiArray",
    "/tf": "tf2_msgs/msg/TFMessage",
}
METADATA = {
    "task", "method", "seed", "duration_s", "rate_hz", "task_sha256", "policy_sha256", "hpf_version", "log_version",
}

problems = []


def check(holds, message):
    """Notes a problem unless `holds`, and goes on."""
    if not holds:
        problems.append(message)
        print(f"  WRONG: {message}")


def check_order(path):
    """Every record from front to back, every CRC checked: what stands first and last."""
    kinds = []
    with path.open("rb") as file:
        for record in StreamReader(file, validate_crcs=True).records:
            kinds.append(type(record).__name__)
    front = kinds[: kinds.index("Message")] if "Message" in kinds else kinds
    check(front[:4] == ["Header", "Metadata", "Attachment", "Attachment"], f"the file begins with {front[:4]}")
    check(kinds[-1] == "Footer", f"the file ends with {kinds[-1]}")


def check_head(reader):
    """Metadata and attachments; returns the policy and the metadata."""
    metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    check(list(metadata) == ["hpf.run"], f"metadata is {list(metadata)}")
    run = metadata.get("hpf.run", {})
    check(set(run) == METADATA, f"the keys of hpf.run are {sorted(run)}")
    attachments = list(reader.iter_attachments())
    found = [(a.name, a.media_type) for a in attachments]
    expected = [("task.toml", "application/toml"), ("policy.json", "application/json")]
    check(found == expected, f"attachments are {found}")
    if found != expected:
        return None, run
    for attachment, key in zip(attachments, ["task_sha256", "policy_sha256"]):
        print(f"  attachment {attachment.name}: {len(attachment.data)} bytes")
        check(attachment.log_time == 0 and attachment.create_time == 0, f"{attachment.name} has a clock time")
        check(hashlib.sha256(attachment.data).hexdigest() == run.get(key), f"{key} is not that of {attachment.name}")
    policy = json.loads(attachments[1].data)
    check(run.get("task") == policy["task"], "metadata and policy name different tasks")
    for key, value in sorted(run.items()):
        print(f"  {key} = {value}")
    return policy, run


def check_topics(summary, samples):
    """Topics, schemas, encodings and numbers of messages."""
    channels = {channel.topic: channel for channel in summary.channels.values()}
    check(set(channels) == set(TOPICS), f"topics are {sorted(channels)}")
    for topic in TOPICS.keys() & channels.keys():
        channel = channels[topic]
        schema = summary.schemas[channel.schema_id]
        count = summary.statistics.channel_message_counts.get(channel.id, 0)
        print(f"  {topic}: {count} messages, {schema.name}, {channel.message_encoding}")
        *expected, how_many = TOPICS[topic]
        found = [schema.name, schema.encoding, channel.message_encoding]
        check(found == expected, f"{topic} is {found}")
        wanted = {EVERY_SAMPLE: count == samples, ONCE: count == 1, SOME: count > 0 or topic == "/hpf/update"}
        check(wanted[how_many], f"{topic} has {count} messages, not {how_many} of {samples}")


def check_messages(path, duration, axes):
    """Decodes every message; holds times to the duration, rest time included, and the last messages to each other."""
    times, last, time_line = {}, {}, []
    with path.open("rb") as file:
        factories = [ProtobufDecoders(), Ros2Decoders()]
        reader = make_reader(file, validate_crcs=True, decoder_factories=factories)
        for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            times.setdefault(channel.topic, []).append(message.log_time)
            time_line.append(message.log_time)
            last[channel.topic] = decoded
            check(message.log_time == message.publish_time, f"{channel.topic} has two times")
    check(time_line == sorted(time_line), "messages do not stand in the order of time")
    # The last step may end a rounding error behind the duration.
    end = round(duration * 1e9) + 1000
    for topic, of_topic in times.items():
        check(of_topic[0] == 0, f"{topic} starts at {of_topic[0]} ns")
        check(of_topic[-1] <= end, f"{topic} ends at {of_topic[-1]} ns, after {duration} s")
    if set(last) - {"/hpf/update"} != set(TOPICS) - {"/hpf/update"}:
        return
    state, joints = last["/hpf/state"], last["/hpf/axes"]
    named = {axis.name: axis for axis in [*state.linear_axes, *state.rotary_axes]}
    check(list(joints.name) == axes, f"/hpf/axes names {list(joints.name)}")
    check(set(named) == set(axes), f"/hpf/state names {sorted(named)}")
    for axis in state.linear_axes:
        position = joints.position[list(joints.name).index(axis.name)]
        check(position == axis.position_m, f"/hpf/axes and /hpf/state differ in {axis.name}")
    check(abs(state.time_s - duration) < 1e-6, f"/hpf/state ends at {state.time_s} s")
    tool = point(last["/tool/pose"].pose.position)
    frames = {t.child_frame_id: point(t.translation) for t in last["/tf"].transforms}
    check(frames == {"tool": tool, "reference": point(last["/reference/pose"].pose.position)}, f"/tf holds {frames}")
    moving = {entity.id for entity in last["/scene"].entities}
    check(moving == {"force", "stiffness"}, f"/scene ends with {moving}")
    path_end = point(last["/path/learned"].poses[-1].position)
    check(path_end == tool, "/path/learned does not end where the tool does")
    if update := last.get("/hpf/update"):
        names = [field.name for field in update.DESCRIPTOR.fields if field.name.endswith("_cost")]
        terms = sum(getattr(update, name) for name in names if name != "total_cost")
        check(abs(terms - update.total_cost) <= 1e-9 * abs(update.total_cost), "costs by term are not the total")
    print(f"  last of /log: {last['/log'].message}")


def point(vector):
    return vector.x, vector.y, vector.z


def check_with_rerun(path):
    """What Rerun finds wrong with the structure and the time lines."""
    tool = Path(sys.executable).with_name("rerun")
    if not tool.exists():
        problems.append("rerun-sdk is missing")
        print("  MISSING: rerun-sdk is not installed beside this Python: pip install rerun-sdk")
        return
    # Nothing of a check is sent anywhere.
    environment = os.environ | {"DO_NOT_TRACK": "1", "NO_COLOR": "1"}
    command = [tool, "mcap", "check", "--full", path]
    found = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    # A table: status, channel, chunks, topic, issues.
    table = found.stdout[found.stdout.rfind("\u2500") + 1 :].splitlines()
    rows = [row for row in table if len(row.split()) >= 5]
    bad = [row for row in rows if not row.startswith("ok ")]
    seen = len(TOPICS.keys() & {row.split()[3] for row in rows})
    check(found.returncode == 0, f"rerun mcap check exits with {found.returncode}: {found.stderr.strip()}")
    check(not bad, "rerun mcap check finds:\n" + "\n".join(bad))
    # A learned run has every topic; one that is only simulated has no update.
    check(seen >= len(TOPICS) - 1, f"rerun mcap check sees {seen} topics:\n{found.stdout}")
    print(f"  rerun mcap check: {len(rows)} rows, {len(bad)} bad")


def check_bag(path):
    """A bag of `hpf export --ros2`: every message decodes as ROS does it, and they agree with each other."""
    counts, last = {}, {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[Ros2Decoders()])
        channels = reader.get_summary().channels.values()
        check({channel.topic for channel in channels} == set(BAG), f"topics are {[c.topic for c in channels]}")
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            last[channel.topic] = decoded
            found = (schema.name, schema.encoding, channel.message_encoding)
            check(found == (BAG.get(channel.topic), "ros2msg", "cdr"), f"{channel.topic} is {found}")
            check("reliability: " in channel.metadata["offered_qos_profiles"], f"{channel.topic} offers no quality")
            stamped = decoded.transforms[0] if channel.topic == "/tf" else decoded
            if channel.topic != "/gains":
                stamp = stamped.header.stamp
                check(stamp.sec * 10**9 + stamp.nanosec == message.log_time, f"{channel.topic} has two times")
    check(len(counts) == len(BAG) and len(set(counts.values())) == 1, f"messages by topic are {counts}")
    print(f"  {sum(counts.values())} messages, {counts}")
    joints, gains, (tool, reference) = last["/joint_states"], last["/gains"], last["/tf"].transforms
    check(len(joints.name) == len(joints.position) == len(joints.velocity) == len(joints.effort), "joints differ")
    rows, columns = gains.layout.dim
    check((rows.size, columns.size, rows.stride) == (len(joints.name), 2, len(gains.data)), "gains have another shape")
    check(all(gain > 0 for gain in gains.data), "gains are not positive")
    for topic, frame in [("/tool/pose", tool), ("/reference/pose", reference)]:
        check(point(last[topic].pose.position) == point(frame.transform.translation), f"{topic} and /tf differ")
        check(last[topic].header.frame_id == frame.header.frame_id == "world", f"{topic} is in another frame")


def check_log(path):
    """All of the above for one log, or for one bag."""
    print(path)
    with path.open("rb") as file:
        profile = make_reader(file).get_header().profile
    if profile == "ros2":
        check_bag(path)
        return
    check_order(path)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        check(summary is not None and summary.statistics is not None, "there is no summary")
        if summary is None or summary.statistics is None:
            return
        check(len(summary.chunk_indexes) == summary.statistics.chunk_count > 0, "the chunk index is not whole")
        check(summary.statistics.message_start_time == 0, "time does not start at 0")
        policy, run = check_head(reader)
        if policy is None:
            return
        duration, rate = float(run["duration_s"]), float(run["rate_hz"])
        check(duration == policy["duration_s"], "metadata and policy differ in duration")
        # The movement and the rest time after it, as the table beside the log has them.
        samples = len(path.with_name("trajectory.csv").read_text().splitlines()) - 1
        check(samples > duration * rate + 1.5, "the motion ends with the movement")
        check_topics(summary, samples)
    check_messages(path, (samples - 1) / rate, [axis["name"] for axis in policy["axes"]])
    check_with_rerun(path)


if len(sys.argv) < 2:
    sys.exit(__doc__)
for argument in sys.argv[1:]:
    try:
        check_log(Path(argument))
    except Exception as error:  # Whatever a reader stumbles over is wrong with the log.
        check(False, f"{argument}: {type(error).__name__}: {error}")
if problems:
    sys.exit(f"{len(problems)} problems: {problems[0]}")
print("all is well")
