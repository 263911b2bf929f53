"""Times the bare trace of a frame's rays against other ray tracers, on the same mesh, the same rays and as many threads.

peers.sh calls it. Each tracer is a process of its own that traces all rays once for each line that it reads and answers
with the milliseconds of wall and of processor time, so that they take turns.
"""
import argparse
import ctypes
import json
import os
import statistics
import subprocess
import sys
import time

import numpy as np

TARGETS = {30: {"open3d": 1.5, "mitsuba": 1.2}, 10: {"open3d": 2.0, "mitsuba": 1.4}}
NONE = 0xFFFFFFFF


def read_mesh(path):
    """Vertices [n][3] float32 and triangles [n][3] uint32 of a scene's mesh.ply."""
    with open(path, "rb") as file:
        count = {}
        line = b""
        while line != b"end_header\n":
            line = file.readline()
            words = line.split()
            if words[:1] == [b"element"]:
                count[words[1]] = int(words[2])
        vertices = np.fromfile(file, "<f4", 3 * count[b"vertex"]).reshape(-1, 3)
        face = np.dtype([("corners", "u1"), ("triangle", "<u4", 3), ("face", "<u4")])
        triangles = np.ascontiguousarray(np.fromfile(file, face, count[b"face"])["triangle"])
    return vertices, triangles


class Open3d:
    def __init__(self, vertices, triangles, rays, threads):
        import libusb_package  # Open3D wants the library of the system, which may have none

        ctypes.CDLL(str(libusb_package.get_library_path()))
        import open3d

        self.name = f"Open3D {open3d.__version__}"
        self.threads = threads
        tensor = open3d.core.Tensor.from_numpy
        start = time.perf_counter()
        self.scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
        self.scene.add_triangles(tensor(vertices), tensor(triangles))
        self.rays = tensor(rays)
        self.scene.cast_rays(self.rays[:16], nthreads=threads)
        self.build_s = time.perf_counter() - start

    def trace(self):
        self.found = self.scene.cast_rays(self.rays, nthreads=self.threads)

    def hits(self):
        return self.found["t_hit"].numpy(), self.found["primitive_ids"].numpy()


class Mitsuba:
    def __init__(self, vertices, triangles, rays, threads):
        import drjit
        import mitsuba

        mitsuba.set_variant("llvm_ad_mono")
        drjit.set_thread_count(threads)
        self.drjit = drjit
        self.name = f"Mitsuba {mitsuba.__version__}"
        start = time.perf_counter()
        mesh = mitsuba.Mesh("ground", len(vertices), len(triangles))
        parameters = mitsuba.traverse(mesh)
        parameters["vertex_positions"] = vertices.ravel()
        parameters["faces"] = triangles.ravel()
        parameters.update()
        self.scene = mitsuba.load_dict({"type": "scene", "ground": mesh})
        columns = [mitsuba.Float(np.ascontiguousarray(rays[:, k])) for k in range(6)]
        self.rays = mitsuba.Ray3f(mitsuba.Point3f(*columns[:3]), mitsuba.Vector3f(*columns[3:]))
        drjit.eval(self.rays)
        drjit.sync_thread()
        self.build_s = time.perf_counter() - start

    def trace(self):
        self.found = self.scene.ray_intersect_preliminary(self.rays, coherent=True)
        self.drjit.eval(self.found)
        self.drjit.sync_thread()

    def hits(self):
        met = np.array(self.found.is_valid())
        distance = np.where(met, np.array(self.found.t), np.inf)
        return distance, np.where(met, np.array(self.found.prim_index), NONE)


PEERS = {"open3d": Open3d, "mitsuba": Mitsuba}


def be_peer(name, folder, threads):
    """The process of one peer."""
    vertices, triangles = read_mesh(f"{folder}/mesh.ply")
    rays = np.fromfile(f"{folder}/rays.f32", "<f4").reshape(-1, 6)
    tracer = PEERS[name](vertices, triangles, rays, threads)
    tracer.trace()
    distance, triangle = tracer.hits()
    distance.astype("<f4").tofile(f"{folder}/{name}.range.f32")
    triangle.astype("<u4").tofile(f"{folder}/{name}.triangle.u32")
    print("ready", f"{tracer.build_s:.3f}", tracer.name, flush=True)
    for _ in sys.stdin:
        cpu, start = time.process_time(), time.perf_counter()
        tracer.trace()
        wall_s = time.perf_counter() - start
        print(f"{1000 * wall_s:.3f} {1000 * (time.process_time() - cpu):.3f}", flush=True)


class Tracer:
    """A process that traces on demand."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.wall_ms = []
        self.cpu_ms = []
        answer = self.process.stdout.readline().split(maxsplit=2)
        if answer[:1] != ["ready"]:
            sys.exit(f"peers: {' '.join(command)} did not start")
        self.build_s, self.name = float(answer[1]), answer[2].strip()

    def trace(self):
        self.process.stdin.write("trace\n")
        self.process.stdin.flush()
        wall_ms, cpu_ms = self.process.stdout.readline().split()
        self.wall_ms.append(float(wall_ms))
        self.cpu_ms.append(float(cpu_ms))

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def agreement(folder, name):
    """How many rays of a peer meet something else than ours do."""
    ours = np.fromfile(f"{folder}/range.f32", "<f4")
    theirs = np.fromfile(f"{folder}/{name}.range.f32", "<f4")
    met, met_there = np.isfinite(ours), np.isfinite(theirs)
    both = met & met_there
    triangle = np.fromfile(f"{folder}/triangle.u32", "<u4")
    triangle_there = np.fromfile(f"{folder}/{name}.triangle.u32", "<u4")
    return {
        "hit_or_miss": int((met != met_there).sum()),
        "range_by_a_metre": int((np.abs(ours[both] - theirs[both]) > 1).sum()),
        "triangle": int((triangle[both] != triangle_there[both]).sum()),
    }


def cell_of(vertices):
    """Spacing of the ground grid: its first vertices lie in one row."""
    return float(np.median(np.diff(vertices[:100, 0])))


def report_of(tracers, folder, arguments):
    vertices, triangles = read_mesh(f"{folder}/mesh.ply")
    ours = tracers["obliq"]
    report = {"triangles": len(triangles), "cell_m": cell_of(vertices), "rays": os.path.getsize(f"{folder}/range.f32") // 4,
              "threads": arguments.threads, "repeats": arguments.repeats, "tracers": {}}
    for name, tracer in tracers.items():
        row = {"name": tracer.name, "build_s": tracer.build_s, "least_ms": min(tracer.wall_ms),
               "median_ms": statistics.median(tracer.wall_ms), "least_cpu_ms": min(tracer.cpu_ms)}
        if tracer is not ours:
            row |= {"speedup": row["least_ms"] / min(ours.wall_ms), "speedup_cpu": row["least_cpu_ms"] / min(ours.cpu_ms),
                    "target": TARGETS.get(round(report["cell_m"]), {}).get(name), "differ": agreement(folder, name)}
        row["march_speedup"] = row["least_ms"] / min(tracers["march"].wall_ms)
        report["tracers"][name] = row
    return report


def print_table(report):
    print(f"{report['triangles'] / 1e6:.1f} M triangles, cells of {report['cell_m']:g} m, {report['rays'] / 1e6:.2f} M rays, "
          f"{report['threads']} threads, {report['repeats']} repeats in turn; all but a march run Embree inside")
    print(f"{'':24}{'build s':>8}{'least ms':>10}{'median ms':>11}{'CPU ms':>9}{'Mray/s':>8}{'obliq is':>10}{'of CPU':>9}{'target':>8}"
          "  rays that differ: hit or miss, range by 1 m, triangle")
    for row in report["tracers"].values():
        line = (f"{row['name']:24}{row['build_s']:8.2f}{row['least_ms']:10.1f}{row['median_ms']:11.1f}"
                f"{row['least_cpu_ms']:9.1f}{report['rays'] / 1e3 / row['least_ms']:8.1f}")
        if "speedup" in row:
            line += (f"{row['speedup']:9.2f}x{row['speedup_cpu']:8.2f}x{row['target'] or '-':>8}  "
                     + ", ".join(map(str, row["differ"].values())))
        line += f"; the march is {row['march_speedup']:.1f} times as quick"
        print(line)


def compare(arguments):
    folder = arguments.folder
    settings = [word for value in arguments.set for word in ("--set", value)]
    common = ["--threads", str(arguments.threads)]
    ours = [f"{arguments.bin}/ray_bench", arguments.scene, *settings, *common, "--peer", folder]
    tracers = {"obliq": Tracer(ours), "march": Tracer([*ours, "--march"])}
    for name in PEERS:
        tracers[name] = Tracer([sys.executable, __file__, "--peer", name, "--folder", folder, *common])
    for _ in range(arguments.repeats):
        for tracer in tracers.values():
            tracer.trace()
    for tracer in tracers.values():
        tracer.end()

    report = report_of(tracers, folder, arguments)
    print_table(report)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(report, file, indent=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", help="scene file whose frustum has rays")
    parser.add_argument("--set", action="append", default=[], help="KEY=VALUE, beats the scene file")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--json", help="file for the figures")
    parser.add_argument("--bin", help="folder of obliq and ray_bench")
    parser.add_argument("--folder", required=True, help="for mesh, rays and hits")
    parser.add_argument("--peer", choices=PEERS, help="be this peer's process")
    arguments = parser.parse_args()
    if arguments.peer:
        be_peer(arguments.peer, arguments.folder, arguments.threads)
    else:
        compare(arguments)


if __name__ == "__main__":
    main()
