"""Writes a sequence as robots' logs, by the packages mcap, mcap-ros2-support and rosbags, which share no code with ours."""

import csv
import math
import pathlib
import tomllib

import numpy
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer
from rosbags.rosbag2 import StoragePlugin, Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
TOPICS = {
    "/camera/image_raw/compressed": "sensor_msgs/msg/CompressedImage",
    "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/odom": "nav_msgs/msg/Odometry",
    "/imu/data": "sensor_msgs/msg/Imu",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/mocap/pose": "geometry_msgs/msg/PoseStamped",
}


def stamp_of(seconds):
    nanos = round(float(seconds) * 1e9)
    return nanos // 10**9, nanos % 10**9


def quaternion(roll, pitch, yaw):
    """Turns about z, the new y, the new x (REP-103), as x, y, z, w."""
    sr, cr = math.sin(roll / 2), math.cos(roll / 2)
    sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
    sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def header(stamp, frame):
    seconds, nanos = stamp
    return {"stamp": {"sec": seconds, "nanosec": nanos}, "frame_id": frame}


def xyz(x, y, z):
    return {"x": x, "y": y, "z": z}


def rotation(x, y, z, w):
    return {"x": x, "y": y, "z": z, "w": w}


class Walk:
    """Sequence as messages: (time in ns, topic, fields). Pitch and roll are told by an IMU on the camera, or with `by_tf` by a tf
    tree from the robot's base to the camera's optical frame, which tells its height, too."""

    def __init__(self, folder, by_tf=False):
        self.by_tf = by_tf
        self.folder = pathlib.Path(folder)
        self.camera = tomllib.loads((self.folder / "camera.toml").read_text())
        with open(self.folder / "frames.csv", newline="") as file:
            self.frames = list(csv.DictReader(file))
        self.poses = [line.split() for line in (self.folder / "groundtruth.tum").read_text().splitlines()]
        self.poses = [[float(field) for field in pose] for pose in self.poses if pose and pose[0][0] != "#"]

    def topics(self):
        unused = "/imu/data" if self.by_tf else "/tf"
        return {topic: kind for topic, kind in TOPICS.items() if topic != unused}

    def messages(self):
        if self.by_tf:
            # The optical frame: x right, y down, z forward.
            yield 0, "/tf", {"transforms": [self.link((0, 1), "head", "camera", xyz(0.0, 0.0, 0.0), (-0.5, 0.5, -0.5, 0.5))]}
        for frame in self.frames:
            stamp = stamp_of(frame["timestamp_s"])
            time = stamp[0] * 10**9 + stamp[1]
            yield time, "/camera/camera_info", self.calibration(stamp)
            yield time, "/odom", self.odometry(stamp, frame)
            if self.by_tf:
                yield time, "/tf", self.transform(stamp, frame)
            else:
                yield time, "/imu/data", self.imu(stamp, frame)
            picture = (self.folder / frame["image"]).read_bytes()
            yield time, "/camera/image_raw/compressed", {
                "header": header(stamp, "camera"), "format": "jpeg", "data": numpy.frombuffer(picture, numpy.uint8)}
        for seconds, x, y, z, *turn in self.poses:
            stamp = stamp_of(seconds)
            yield stamp[0] * 10**9 + stamp[1], "/mocap/pose", {
                "header": header(stamp, "world"), "pose": {"position": xyz(x, y, z), "orientation": rotation(*turn)}}

    def calibration(self, stamp):
        camera = self.camera
        model = {"OPENCV_FISHEYE": "equidistant", "OPENCV": "plumb_bob", "PINHOLE": "plumb_bob"}[camera["model"]]
        fx, fy, cx, cy = (float(camera[name]) for name in ("fx", "fy", "cx", "cy"))
        return {
            "header": header(stamp, "camera"), "height": camera["height"], "width": camera["width"],
            "distortion_model": model, "d": numpy.array(camera.get("distortion", []), dtype=float),
            "k": numpy.array([fx, 0, cx, 0, fy, cy, 0, 0, 1], dtype=float),
            "r": numpy.eye(3).ravel(), "p": numpy.array([fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0], dtype=float),
            "binning_x": 0, "binning_y": 0,
            "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}}

    @staticmethod
    def odometry(stamp, frame):
        x, y, yaw = (float(frame[name]) for name in ("odometry_x_m", "odometry_y_m", "odometry_yaw_rad"))
        pose = {"position": xyz(x, y, 0.0), "orientation": rotation(*quaternion(0.0, 0.0, yaw))}
        still = {"linear": xyz(0.0, 0.0, 0.0), "angular": xyz(0.0, 0.0, 0.0)}
        return {
            "header": header(stamp, "odom"), "child_frame_id": "base_link",
            "pose": {"pose": pose, "covariance": numpy.zeros(36)},
            "twist": {"twist": still, "covariance": numpy.zeros(36)}}

    @staticmethod
    def link(stamp, parent, child, place, turn):
        return {
            "header": header(stamp, parent), "child_frame_id": child,
            "transform": {"translation": place, "rotation": rotation(*turn)}}

    def transform(self, stamp, frame):
        turn = quaternion(float(frame["roll_rad"]), float(frame["pitch_rad"]), 0.0)
        place = xyz(0.0, 0.0, float(self.camera["mount"]["height_m"]))
        return {"transforms": [self.link(stamp, "base_link", "head", place, turn)]}

    @staticmethod
    def imu(stamp, frame):
        roll, pitch = float(frame["roll_rad"]), float(frame["pitch_rad"])
        return {
            "header": header(stamp, "camera"), "orientation": rotation(*quaternion(roll, pitch, 0.0)),
            "orientation_covariance": numpy.zeros(9), "angular_velocity": xyz(0.0, 0.0, 0.0),
            "angular_velocity_covariance": numpy.zeros(9), "linear_acceleration": xyz(0.0, 0.0, 9.81),
            "linear_acceleration_covariance": numpy.zeros(9)}


def plain(value):
    """Fields as mcap-ros2-support takes them."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [plain(inner) for inner in value]
    if isinstance(value, numpy.ndarray):
        return value.tobytes() if value.dtype == numpy.uint8 else value.tolist()
    return value


def write_mcap(walk, path, compression):
    with open(path, "wb") as file:
        writer = Writer(file, compression=compression)
        schemas = {}
        for topic, kind in walk.topics().items():
            text, _ = STORE.generate_msgdef(kind, ros_version=2)
            schemas[topic] = writer.register_msgdef(kind, text)
        for time, topic, fields in walk.messages():
            writer.write_message(topic, schemas[topic], plain(fields), log_time=time, publish_time=time)
        writer.finish()


def typed(kind, value):
    """Fields as rosbags takes them."""
    _, members = STORE.fielddefs[kind]
    values = {}
    for name, (node, description) in members:
        if node == 2:
            values[name] = typed(description, value[name])
        elif node == 4 and description[0][0] == 2:
            values[name] = [typed(description[0][1], inner) for inner in value[name]]
        else:
            values[name] = value[name]
    return STORE.types[kind](**values)


def write_bag(walk, path, plugin=StoragePlugin.SQLITE3, version=8):
    with BagWriter(path, version=version, storage_plugin=plugin) as bag:
        connections = {topic: bag.add_connection(topic, kind, typestore=STORE) for topic, kind in walk.topics().items()}
        for time, topic, fields in walk.messages():
            message = typed(TOPICS[topic], fields)
            bag.write(connections[topic], time, STORE.serialize_cdr(message, TOPICS[topic]))


COMPRESSIONS = {"none": CompressionType.NONE, "lz4": CompressionType.LZ4, "zstd": CompressionType.ZSTD}
