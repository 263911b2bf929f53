"""A data set by Dask: its executor is one of concurrent.futures. dask_batch.py POSES.jsonl OUT HOST:PORT [SCHEDULER]

Without a scheduler's address: two workers on this machine. OUT must be one folder for all machines.
"""
import sys

import obliq
from distributed import Client


def main(poses, out, server, scheduler=None):
    where = {"address": scheduler} if scheduler else {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with Client(**where) as client:
        done = obliq.batch(poses, out, server=server, shard_size=16, planes="iq state", executor=client.get_executor())
    print(f"{done.frames} frames rendered, {done.parts} of {done.parts_wanted} parts, {len(obliq.Dataset(out).verify())} frames")


if __name__ == "__main__":
    main(*sys.argv[1:])
