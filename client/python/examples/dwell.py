"""A host that commands the beam: every 1/60 s one dwell of 16 degrees, with the pose of that moment. No live radar is touched;
the same mission gives the same bits, whenever it is flown, here and by client/examples/dwell.cpp.

  dwell.py HOST:PORT [RADAR] [DWELLS]      the radar's settings are taken, but for sector and scan
"""
import asyncio
import statistics
import sys
import time

import obliq

DWELL_DEG = 16.0


async def main(address, radar=None, count="300"):
    async with obliq.aio.connect(address, name="dwell") as server:
        info = await server.radar(radar).info()
        whole, home = info.settings, info.pose
        # As many bins a degree as the whole sector has, in wedges of eight.
        bins = max(8, int(whole.azimuth_bins / whole.sector_deg * DWELL_DEG) // 8 * 8)
        settings = whole.replace(azimuth_bins=bins, pixel_columns=2 * bins, sector_deg=DWELL_DEG, scan_mode="frame")
        left_deg = home.bearing_deg - whole.sector_deg / 2
        across = max(1, int(whole.sector_deg / DWELL_DEG))
        places = asyncio.Semaphore(server.info.limits.max_renders_queued)

        async def dwell(k):
            began = time.monotonic()
            pose = home.replace(latitude_deg=home.latitude_deg + 3e-5 * k, sim_time_ns=None,  # 200 m/s north
                                bearing_deg=left_deg + DWELL_DEG * (0.5 + k % across))
            frame = await server.render(settings, pose, planes="iq", radar=info.radar)
            places.release()
            return frame.iq.tobytes(), 1000 * (time.monotonic() - began)

        tasks, due = [], time.monotonic()
        for k in range(int(count)):
            await places.acquire()
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            tasks.append(asyncio.create_task(dwell(k)))
            due += 1 / 60
        results = await asyncio.gather(*tasks)
    times = sorted(took for _, took in results)
    print(f"{len(times)} dwells; from request to last bin: median {statistics.median(times):.1f} ms, 99 % within "
          f"{times[int(0.99 * (len(times) - 1))]:.1f} ms")
    print(f"sum {fnv1a(b''.join(data for data, _ in results)):016x}")


def fnv1a(data):
    """64 bits, as in dwell.cpp."""
    total = 0xCBF29CE484222325
    for byte in data:
        total = (total ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return total


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
