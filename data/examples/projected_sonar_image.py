"""Pings as the fields of ROS's marine_acoustic_msgs/ProjectedSonarImage, through libasdic by ctypes: no ROS
and nothing to compile. Prints what is strongest in each ping:

    python3 projected_sonar_image.py SCENE.yaml [LIBRARY [PINGS]]

In a node of your own (rclpy; the field names are the message's):

    for fields in pings("scene.yaml"):
        publisher.publish(fill(ProjectedSonarImage(), fields))

How asdic's ping is mapped:

header.stamp          simulated time of the ping; header.frame_id: "sonar"
ping_info.frequency, .sound_speed          Hz, m/s
ping_info.rx_beamwidths, .tx_beamwidths    one per beam, rad, half power, one way: receivers horizontally,
                      transmitter vertically; never empty, as viewers read them unasked
beam_directions       unit vectors: z ahead, x up, bearing to starboard atan2(-y, z)
ranges                centres of the bins, m
image.data            range by range: data[range * beam_count + beam]; levels in dB re 1 uPa as float32, NAN
                      where there is no energy, or, given a window of dB, as uint8 for viewers that want it
"""
import ctypes as C
import math
import struct
import sys

UINT8, FLOAT32 = 0, 8  # SonarImageData.DTYPE_*
HALF_POWER = 0.442946  # sinc^2(x) is a half at this x


class Pose(C.Structure):  # asdic/common.h
    _fields_ = [(name, C.c_double) for name in ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")]


class Beam(C.Structure):  # asdic/sonar.h
    _fields_ = [("name", C.c_char * 64)] + [(name, C.c_double) for name in (
        "pitch_rad", "yaw_rad", "roll_rad", "length_h_m", "length_v_m")]


class Sonar(C.Structure):  # asdic/sonar.h, as far as it is needed
    _fields_ = [(name, C.c_double) for name in (
        "frequency_hz", "bandwidth_hz", "ping_rate_hz", "source_level_db", "bin_length_m", "blanking_m")
    ] + [("transmitter", Beam), ("receivers", C.POINTER(Beam)), ("receiver_count", C.c_size_t)]


class LoopPing(C.Structure):  # asdic/loop.h
    _fields_ = [("ping", C.c_uint64), ("time_s", C.c_double), ("pose", Pose), ("altitude_m", C.c_double),
                ("latency_s", C.c_double), ("beams", C.c_size_t), ("bins", C.c_size_t),
                ("bin_length_m", C.c_double), ("level_db", C.POINTER(C.c_float)), ("parts", C.c_void_p)]


def load(path="libasdic.so.0"):
    """The library, told what its functions return; arguments that are doubles are passed as such."""
    lib = C.CDLL(path)
    for name in ("mission_scene", "mission_environment", "mission_sampling"):
        getattr(lib, "asdic_" + name).restype = C.c_void_p
    lib.asdic_mission_sonar.restype = C.POINTER(Sonar)
    lib.asdic_mission_ping_count.restype = C.c_size_t
    lib.asdic_mission_pose.restype = Pose
    lib.asdic_mission_pose.argtypes = [C.c_void_p, C.c_size_t, C.c_void_p]
    lib.asdic_environment_sound_speed_mps.restype = C.c_double
    lib.asdic_environment_sound_speed_mps.argtypes = [C.c_void_p, C.c_double]
    lib.asdic_loop_create.argtypes = [C.c_void_p] * 6 + [C.c_double, C.c_void_p]
    lib.asdic_context_error.restype = C.c_char_p
    return lib


def width_rad(wavelength_m, length_m):
    """Full width of a line's pattern between half-power points."""
    return 2 * math.asin(min(HALF_POWER * wavelength_m / length_m, 1))


def image(ping, window_db):
    """SonarImageData: beam by beam becomes range by range."""
    levels_db = [ping.level_db[beam * ping.bins + bin_] for bin_ in range(ping.bins)
                 for beam in range(ping.beams)]
    if window_db is None:
        dtype, data = FLOAT32, struct.pack(f"<{len(levels_db)}f", *levels_db)
    else:
        low, high = window_db
        dtype, data = UINT8, bytes(
            0 if math.isnan(level) else round(255 * min(max((level - low) / (high - low), 0), 1))
            for level in levels_db)
    return {"is_bigendian": False, "dtype": dtype, "beam_count": ping.beams, "data": data}


def message(sonar, sound_speed_mps, ping, window_db=None):
    """The fields of one ProjectedSonarImage."""
    beams = sonar.receivers[:sonar.receiver_count]
    wavelength_m = sound_speed_mps / sonar.frequency_hz
    whole_s = math.floor(ping.time_s)
    return {
        "header": {"stamp": {"sec": whole_s, "nanosec": round((ping.time_s - whole_s) * 1e9)},
                   "frame_id": "sonar"},
        "ping_info": {
            "frequency": sonar.frequency_hz,
            "sound_speed": sound_speed_mps,
            "tx_beamwidths": [width_rad(wavelength_m, sonar.transmitter.length_v_m)] * len(beams),
            "rx_beamwidths": [width_rad(wavelength_m, beam.length_h_m) for beam in beams]},
        "beam_directions": [{"x": -math.sin(beam.pitch_rad),  # a beam's pitch is positive downwards
                             "y": -math.cos(beam.pitch_rad) * math.sin(beam.yaw_rad),
                             "z": math.cos(beam.pitch_rad) * math.cos(beam.yaw_rad)} for beam in beams],
        "ranges": [(bin_ + 0.5) * ping.bin_length_m for bin_ in range(ping.bins)],
        "image": image(ping, window_db)}


def pings(scene, library="libasdic.so.0", count=None, window_db=None):
    """One message after the other along the mission of the scene file SCENE."""
    lib = load(library)
    ctx, mission, devices, loop = (C.c_void_p() for _ in range(4))
    device_count, ping = C.c_size_t(), LoopPing()

    def check(status):
        if status:
            raise RuntimeError(lib.asdic_context_error(ctx).decode())

    lib.asdic_context_create(C.byref(ctx))
    try:
        check(lib.asdic_mission_load(ctx, scene.encode(), C.byref(mission)))
        check(lib.asdic_devices_open(ctx, None, C.byref(devices), C.byref(device_count)))
        device = C.cast(devices, C.POINTER(C.c_void_p))[0]
        environment, sonar = lib.asdic_mission_environment(mission), lib.asdic_mission_sonar(mission)
        depth_m = lib.asdic_mission_pose(mission, 0, None).z_m
        speed_mps = lib.asdic_environment_sound_speed_mps(environment, depth_m)
        check(lib.asdic_loop_create(ctx, device, lib.asdic_mission_scene(mission), environment,
                                    C.cast(sonar, C.c_void_p), lib.asdic_mission_sampling(mission),
                                    depth_m, C.byref(loop)))
        there = lib.asdic_mission_ping_count(mission)
        for index in range(there if count is None else min(count, there)):
            pose = lib.asdic_mission_pose(mission, index, None)
            check(lib.asdic_loop_submit(loop, C.byref(pose)))
            check(lib.asdic_loop_collect(loop, C.byref(ping)))
            yield message(sonar[0], speed_mps, ping, window_db)
    finally:
        lib.asdic_loop_destroy(C.byref(loop))
        lib.asdic_devices_close(C.byref(devices), device_count)
        lib.asdic_mission_destroy(C.byref(mission))
        lib.asdic_context_destroy(C.byref(ctx))


def fill(target, fields):
    """Sets FIELDS, a dictionary of dictionaries and lists, in a ROS message."""
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(target, name), value)
        elif name == "beam_directions":
            import geometry_msgs.msg  # pylint: disable=import-error
            target.beam_directions = [geometry_msgs.msg.Vector3(**direction) for direction in value]
        else:
            setattr(target, name, value)
    return target


def main():
    scene, library, count = (sys.argv[1:] + ["libasdic.so.0", "1"][len(sys.argv) - 2:])[:3]
    for fields in pings(scene, library, int(count)):
        beams, directions = fields["image"]["beam_count"], fields["beam_directions"]
        levels_db = struct.unpack(f"<{beams * len(fields['ranges'])}f", fields["image"]["data"])
        best = max((level, i) for i, level in enumerate(levels_db) if not math.isnan(level))
        direction = directions[best[1] % beams]
        print(f"t = {fields['header']['stamp']['sec'] + fields['header']['stamp']['nanosec'] / 1e9:.2f} s: "
              f"{best[0]:.1f} dB at {fields['ranges'][best[1] // beams]:g} m, bearing "
              f"{math.degrees(math.atan2(-direction['y'], direction['z'])):.1f} degrees")


if __name__ == "__main__":
    main()
