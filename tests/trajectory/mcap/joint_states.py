# Writes joint_states.mcap: pip install mcap-ros2-support && python joint_states.py joint_states.mcap
import sys
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer
DEF = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
with open(sys.argv[1], "wb") as f:
    w = Writer(f, compression=CompressionType.NONE)
    s = w.register_msgdef("sensor_msgs/msg/JointState", DEF)
    t = w.register_msgdef("std_msgs/msg/String", "string data")
    def put(sec, ns, name, **kw):
        m = {"header": {"stamp": {"sec": sec, "nanosec": ns}, "frame_id": "base"}, "name": name, "position": [], "velocity": [], "effort": []}
        m.update(kw)
        w.write_message("/joint_states", s, m, log_time=sec * 10**9 + ns, publish_time=sec * 10**9 + ns)
    put(1700000000, 5, ["hip", "left_knee", "a"], position=[0.1, -0.2, 1e-300], velocity=[1.0, 2.0, 3.0], effort=[-1.5, 0.0, 7.0])
    w.write_message("/chatter", t, {"data": "hello"}, log_time=0, publish_time=0)
    put(1700000000, 10000005, ["gripper"], position=[0.04])
    put(1700000001, 0, ["left_knee", "hip"], position=[-0.25, 0.15])
    w.finish()
