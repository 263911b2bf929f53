"""A user's script, for type checkers alone: `mypy --strict` must find real types in it, and each misspelling."""
from __future__ import annotations

import asyncio
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt
import obliq
from typing_extensions import assert_type


def render(address: str) -> npt.NDArray[np.complex64]:
    with obliq.connect(address, tls=obliq.Tls(ca_file="ca.pem")) as server:
        assert_type(server, obliq.Server)
        radar = server.radar("main")
        frame = radar.frame(planes="iq state")
        assert_type(frame.iq, npt.NDArray[np.complex64] | None)
        assert_type(frame.plane("power"), npt.NDArray[np.float64])
        assert_type(radar.settings.r_max_m, float | None)
        pose = radar.pose.replace(bearing_deg=20.0)
        assert_type(pose, obliq.Pose)
        radar.pose.replace(bearing_dge=20.0)  # type: ignore[call-arg]
        radar.frame(plains="iq")  # type: ignore[call-arg]
        obliq.Settings(speckle="grund")  # type: ignore[arg-type]
        for other in server.render_many([pose], {"r_max_m": 9000.0}, planes=["iq"]):
            assert_type(other, obliq.Frame)
        for one in server.render_many([pose], return_exceptions=True):
            assert_type(one, obliq.Frame | Exception)
        for wedge in radar.wedges(rate_hz=5):
            assert_type(wedge, obliq.Wedge)
        with radar.control() as control:
            assert_type(control.set(noise=True).coverage, float | None)
        assert_type(radar.query(bearing_deg=[20.0], range_m=9000.0).visible, npt.NDArray[np.bool_])
        return frame.plane("iq")


async def awaited(address: str) -> tuple[int, int]:
    async with obliq.aio.connect(address) as server, server.radar().stream(encoding="ci16") as frames:
        async for frame in frames:
            assert_type(frame, obliq.Frame)
            return frame.shape
    return 0, 0


def data_set(folder: pathlib.Path) -> dict[str | int, str]:
    done = obliq.batch(folder / "poses.jsonl", folder / "set", local=folder / "scene.toml", min_coverage=0.9)
    assert_type(done.first_failed, dict[str, Any] | None)
    train = obliq.Dataset(folder / "set").select(split="train")
    assert_type(train[0].descriptor.scene_hash, str)
    with obliq.local("scene.toml") as server:
        assert_type(server.info.radars, tuple[str, ...])
    return train.verify()


if __name__ == "__main__":
    print(asyncio.run(awaited("127.0.0.1:7420")), render("127.0.0.1:7420"), data_set(pathlib.Path()))
