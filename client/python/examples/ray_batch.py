"""A data set by Ray: one task a shard, tried again where a worker dies. ray_batch.py POSES.jsonl OUT HOST:PORT [WORKERS]

OUT must be one folder for all machines. Whatever is killed, run it again: finished shards stay as they are.
"""
import sys

import obliq
import ray


def main(poses, out, server, workers="2"):
    ray.init(num_cpus=int(workers), include_dashboard=False, log_to_driver=False)
    job = obliq.prepare(poses, out, server=server, shard_size=16, planes="iq state")
    held = ray.put(job)

    @ray.remote(max_retries=5)
    def render(shared, number):
        return shared.run(number)

    waiting = [render.remote(held, number) for number in obliq.todo(job)]
    while waiting:
        done, waiting = ray.wait(waiting)
        number, frames, failed, seconds = ray.get(done[0])
        print(f"part {number}: {frames} frames, {failed} refused, {seconds:.1f} s")
    ray.shutdown()
    print(f"{len(obliq.Dataset(out).verify())} frames")


if __name__ == "__main__":
    main(*sys.argv[1:])
