#!/usr/bin/env python3
"""Writes scans of KITTI as a recording of ROS, without any code of this project: a .bag by Debian's python3-rosbag and its
messages, a .db3 by Python's sqlite3, an .mcap by its specification.

usage: write_recording.py FOLDER POSES OUT.bag|OUT.db3|OUT.mcap COUNT
FOLDER: 000000.bin.gz ... (float32 x y z intensity); POSES: a 3x4 pose of the lidar in its first frame, a line a scan.
"""
import gzip, math, sqlite3, struct, sys

FOLDER, POSES, OUT, COUNT = *sys.argv[1:4], int(sys.argv[4])
BEGIN, PERIOD, HEIGHT = 1_317_038_400_000_000_000, 100_000_000, 1.73  # [ns], [ns], [m]
FIELDS = ["x", "y", "z", "intensity"]


def quaternion(r):
    """x, y, z, w of a rotation matrix whose trace is positive."""
    w = math.sqrt(1 + r[0][0] + r[1][1] + r[2][2]) / 2
    return [(r[2][1] - r[1][2]) / (4 * w), (r[0][2] - r[2][0]) / (4 * w), (r[1][0] - r[0][1]) / (4 * w), w]


def drive():
    """Stamp, place and quaternion of the vehicle, points of each scan."""
    with open(POSES) as file:
        for k, line in zip(range(COUNT), file):
            v = [float(word) for word in line.split()]
            r = [v[0:3], v[4:7], v[8:11]]
            # The lidar is HEIGHT above the vehicle's origin, in the world and on the vehicle.
            place = [v[3] - r[0][2] * HEIGHT, v[7] - r[1][2] * HEIGHT, v[11] + HEIGHT - r[2][2] * HEIGHT]
            yield BEGIN + k * PERIOD, place, quaternion(r), gzip.open(f"{FOLDER}/{k:06}.bin.gz").read()


class Cdr:
    """A message of ROS 2: little-endian, each number at a multiple of its size."""

    def __init__(self):
        self.body = bytearray()

    def put(self, kind, *values):
        size = struct.calcsize(kind)
        for value in values:
            self.body += bytes(-len(self.body) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, text):
        self.put("I", len(text) + 1)
        self.body += text.encode() + b"\0"
        return self

    def header(self, ns, frame):
        return self.put("i", ns // 10**9).put("I", ns % 10**9).text(frame)

    def message(self):
        return b"\0\1\0\0" + bytes(self.body)


def transform(ns, parent, child, place, q):
    return Cdr().put("I", 1).header(ns, parent).text(child).put("d", *place, *q).message()


def cloud(ns, points):
    m = Cdr().header(ns, "velodyne").put("I", 1, len(points) // 16, len(FIELDS))
    for i, name in enumerate(FIELDS):
        m.text(name).put("I", 4 * i).put("B", 7).put("I", 1)
    m.put("B", 0).put("I", 16, len(points), len(points))
    m.body += points
    return m.put("B", 1).message()


TYPES = {"/tf_static": "tf2_msgs/msg/TFMessage", "/tf": "tf2_msgs/msg/TFMessage", "/LIDAR_TOP": "sensor_msgs/msg/PointCloud2"}


def messages():
    """Topic, stamp and bytes of each message of ROS 2."""
    yield "/tf_static", BEGIN, transform(BEGIN, "base_link", "velodyne", [0, 0, HEIGHT], [0, 0, 0, 1])
    for ns, place, q, points in drive():
        yield "/tf", ns, transform(ns, "odom", "base_link", place, q)
        yield "/LIDAR_TOP", ns, cloud(ns, points)


def write_db3():
    db = sqlite3.connect(OUT)
    db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
               "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    for i, (name, kind) in enumerate(TYPES.items()):
        db.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (i + 1, name, kind))
    ids = {name: i + 1 for i, name in enumerate(TYPES)}
    for name, ns, data in messages():
        db.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", (ids[name], ns, data))
    db.commit()
    db.close()


def write_mcap():
    text = lambda t: struct.pack("<I", len(t)) + t.encode()
    with open(OUT, "wb") as out:
        record = lambda op, content: out.write(struct.pack("<BQ", op, len(content)) + content)
        out.write(b"\x89MCAP0\r\n")
        record(1, text("ros2") + text("write_recording.py"))
        ids = {name: i + 1 for i, name in enumerate(TYPES)}
        for name, i in ids.items():
            record(3, struct.pack("<H", i) + text(TYPES[name]) + text("ros2msg") + text(""))
            record(4, struct.pack("<HH", i, i) + text(name) + text("cdr") + struct.pack("<I", 0))
        for name, ns, data in messages():
            record(5, struct.pack("<HIQQ", ids[name], 0, ns, ns) + data)
        record(15, struct.pack("<I", 0))
        record(2, struct.pack("<QQI", 0, 0, 0))
        out.write(b"\x89MCAP0\r\n")


def write_bag():
    import genpy, rosbag
    from geometry_msgs.msg import TransformStamped
    from sensor_msgs.msg import PointCloud2, PointField
    from tf2_msgs.msg import TFMessage

    def tf(ns, parent, child, place, q):
        t = TransformStamped()
        t.header.stamp, t.header.frame_id, t.child_frame_id = time(ns), parent, child
        v, r = t.transform.translation, t.transform.rotation
        (v.x, v.y, v.z), (r.x, r.y, r.z, r.w) = place, q
        return TFMessage([t])

    time = lambda ns: genpy.Time(ns // 10**9, ns % 10**9)
    with rosbag.Bag(OUT, "w", compression=rosbag.Compression.BZ2) as bag:
        bag.write("/tf_static", tf(BEGIN, "base_link", "velodyne", [0, 0, HEIGHT], [0, 0, 0, 1]), time(BEGIN))
        for ns, place, q, points in drive():
            m = PointCloud2(height=1, width=len(points) // 16, point_step=16, row_step=len(points), is_dense=True, data=points)
            m.header.stamp, m.header.frame_id = time(ns), "velodyne"
            m.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(FIELDS)]
            bag.write("/tf", tf(ns, "odom", "base_link", place, q), time(ns))
            bag.write("/LIDAR_TOP", m, time(ns))


{"bag": write_bag, "db3": write_db3, "mcap": write_mcap}[OUT.rsplit(".", 1)[1]]()
