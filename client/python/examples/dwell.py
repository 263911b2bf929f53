"""A host that commands the beam: every 1/60 s one dwell of 16 degrees, with the pose, tilt and noise of that moment. No live
radar is touched; the same mission gives the same bits, whenever it is flown, here and by client/examples/dwell.cpp.

  dwell.py HOST:PORT [RADAR] [DWELLS] [iq|video]      each is as the live radar is, but for sector and scan
"""
import asyncio
import statistics
import sys
import time

import numpy as np
import obliq

DWELL_DEG = 16.0


async def main(address, radar=None, count="300", plane="iq"):
    async with obliq.aio.connect(address, name="dwell") as server:
        info = await server.radar(radar).info()
        whole, home = info.settings, info.pose
        # As many bins a degree as the whole sector has, in wedges of eight.
        bins = max(8, int(whole.azimuth_bins / whole.sector_deg * DWELL_DEG) // 8 * 8)
        settings = obliq.Settings(azimuth_bins=bins, sector_deg=DWELL_DEG, scan_mode="frame")  # planes_per_bin stays the radar's
        left_deg = home.bearing_deg - whole.sector_deg / 2
        across = max(1, int(whole.sector_deg / DWELL_DEG))
        places = asyncio.Semaphore(server.info.limits.max_renders_queued)

        async def dwell(k, due):
            began = min(due, time.monotonic())
            pose = home.replace(latitude_deg=home.latitude_deg + 3e-5 * k, sim_time_ns=None, tilt_auto=None,  # 200 m/s north
                                bearing_deg=left_deg + DWELL_DEG * (0.5 + k % across),
                                tilt_deg=home.tilt_deg - 0.5 * (k // across % 2))  # two bars
            try:
                frame = await server.render(settings.replace(noise_frame=k), pose, planes=plane, radar=info.radar, as_live=True)
            finally:
                places.release()
            return getattr(frame, plane), 1000 * (time.monotonic() - began)

        tasks, due = [], time.monotonic()
        for k in range(int(count)):
            await places.acquire()
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            tasks.append(asyncio.create_task(dwell(k, due)))
            due += 1 / 60
        results = await asyncio.gather(*tasks)
    times = sorted(took for _, took in results)
    late = times[int(0.99 * (len(times) - 1))]
    print(f"from request to last values: median {statistics.median(times):.1f} ms, 99 % {late:.1f} ms")
    within = [100 * sum(took <= limit for took in times) / len(times) for limit in (33, 50)]
    print(f"{len(times)} dwells, {within[0]:.2f} % within 33 ms, {within[1]:.2f} % within 50 ms")
    print(f"sum {weighted(values for values, _ in results):016x}")


def weighted(parts):
    """As in dwell.cpp: every value (of I&Q, the bits of I and Q) times the next odd number, modulo 2^64."""
    total, first = 0, 0
    for part in parts:
        values = part.view("<u4").ravel() if part.dtype.kind == "c" else part.ravel()
        weights = 2 * np.arange(first, first + values.size, dtype="u8") + 1
        total = (total + int((weights * values).sum())) % 2**64
        first += values.size
    return total


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
