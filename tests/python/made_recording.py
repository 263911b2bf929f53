"""A recording of any length, made without a server: frames at 10 Hz, or the passes of a turning antenna."""
import support  # noqa: F401  (finds the package)
from obliq import wire
from obliq._protocol.wire import encode

START_NS = 1_767_225_600_000_000_000
SIM_START_NS = 1_000_000_000_000
DWELL = 8


def begin_of(number, begin_ns, azimuths, ranges, scan_s):
    begin = wire.FrameBegin(frame_id=number + 1, wedges=azimuths // DWELL)
    frame = begin.frame
    frame.radar, frame.frame_id, frame.wedge_azimuth_bins = "main", number + 1, DWELL
    frame.settings.azimuth_bins, frame.settings.range_bins, frame.settings.video_span_db = azimuths, ranges, 100.0
    frame.settings.frustum = wire.POLAR  # as of old recordings: it makes no frames now
    frame.azimuth_width_deg, frame.range_start_m, frame.range_spacing_m = 360.0 / azimuths, 2000.0, 20.0
    frame.pose.latitude_deg, frame.pose.longitude_deg, frame.pose.height_m = 33.0 + number * 1e-5, -99.5, 1500.0
    frame.pose.sim_time_ns, frame.pose.pose_id = SIM_START_NS + begin_ns, number + 1
    if scan_s:
        begin.scan.mode, begin.scan.clockwise, begin.scan.dwell_bins = wire.CIRCULAR_SCAN, True, DWELL
        begin.scan.rate_deg_s, begin.scan.begin_ns = 360.0 / scan_s, 1 + begin_ns
    return begin


def write(path, seconds, azimuths, ranges, rate_hz=10.0, scan_s=0.0):
    """Video of 8 bits: a frame every 1 / rate_hz seconds, or a turn every scan_s. Each value is the frame's number mod 251.
    Returns the times at which frames begin, in nanoseconds from the start."""
    step_ns = round(1e9 * (scan_s or 1 / rate_hz))
    begins = [k * step_ns for k in range(int(seconds * 1e9) // step_ns)]
    sequence = 0
    with open(path, "wb") as file:
        for number, begin_ns in enumerate(begins):
            span_ns = step_ns if scan_s else step_ns // 10  # in which its wedges come

            def add(message, after_ns, plane=b""):
                nonlocal sequence
                sequence += 1
                file.write(encode(message, sequence, 1, plane, START_NS + begin_ns + after_ns))

            add(begin_of(number, begin_ns, azimuths, ranges, scan_s), 0)
            plane = bytes([number % 251]) * (DWELL * ranges)
            for wedge in range(azimuths // DWELL):
                after_ns = (wedge + 1) * span_ns * DWELL // azimuths - span_ns // 1000
                block = wire.WedgeBlock(
                    frame_id=number + 1, plane=wire.VIDEO, first_azimuth=wedge * DWELL, n_azimuth=DWELL, n_range=ranges,
                    wedge_index=wedge, send_ns=1 + begin_ns + after_ns,
                    beam_ns=begin_ns + after_ns if scan_s else 0)
                block.pose.CopyFrom(wire.Pose(latitude_deg=33.0 + number * 1e-5, longitude_deg=-99.5, height_m=1500.0,
                                              sim_time_ns=SIM_START_NS + begin_ns, pose_id=number + 1))
                add(block, after_ns, plane)
            end = wire.FrameEnd(frame_id=number + 1, render_s=0.01)
            end.summary.frame_id, end.summary.coverage = number + 1, 1.0
            add(end, span_ns - span_ns // 2000)
    return begins
