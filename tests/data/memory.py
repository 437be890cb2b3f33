"""Peak memory of each reader for its worst inputs of about 4 MB and 100 MB.

    python tests/data/memory.py target/release/kufe [NAME ...]

Writes each input into a temporary folder, reads it with the command, and prints a row a reader: the largest
resident memory of the process in MB, and its exit code (0 read, 3 refused).
"""

import base64
import io
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

# Time limit of a reader [s]; a slower one is killed, which gives exit -9.
LONGEST_S = 60
WATCH = """
import os, subprocess, sys, threading
limit, folder, *words = sys.argv[1:]
process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
slow = threading.Timer(float(limit), process.kill)
slow.start()
_, status, usage = os.wait4(process.pid, 0)
slow.cancel()
print(usage.ru_maxrss, os.waitstatus_to_exitcode(status))
"""
SIZES = {"4 MB": 4_000_000, "100 MB": 100_000_000}
INPUTS = {}


def reader(name, words):
    """Registers a function that returns an input of about `size` bytes."""

    def register(make):
        INPUTS[name] = (make, words)
        return make

    return register


def repeated(line, size):
    return line * (size // len(line))


@reader("run.csv", ["runs", "check", "runs.csv", "-o", "out"])
def run_csv(size):
    head = "t_s,v_mps,ax_mps2," + ",".join(f"c{k}" for k in range(97)) + "\n"
    rows = size // 210
    return (head + "".join(f"{0.01 * k:.2f}" + ",1" * 99 + "\n" for k in range(rows))).encode()


@reader("runs.csv", ["runs", "check", "index.csv", "-o", "out"])
def index_csv(size):
    rows = "".join(f"r{k},run.csv\n" for k in range(size // 16))
    return ("run,file\n" + rows).encode()


@reader("log.csv", ["runs", "init", "log.csv", "-o", "mapping.toml"])
def log_csv(size):
    head = "Time [s]," + ",".join(f"c{k} [g]" for k in range(99)) + "\n"
    return (head + "".join(f"{0.01 * k:.2f}" + ",1" * 99 + "\n" for k in range(size // 206))).encode()


@reader("experiments.csv", ["friction", "fit", "experiments.csv", "-o", "out"])
def experiments_csv(size):
    return b"specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n" + repeated(b"a,8e6,1e5,4e-3,1e-4\n", size)


@reader("track_t.csv", ["simulate", "model.toml", "track_t.csv", "-o", "out", "--most-s", "1"])
def track_csv(size):
    return ("s_m,slope_rad,curvature_1pm,bank_rad\n" + "".join(f"{k},0,0,0\n" for k in range(size // 14))).encode()


@reader("heights.csv", ["press", "surface.toml", "-o", "out"])
def heights_csv(size):
    n = int((size // 14) ** 0.5)
    return ("x_m,y_m,z_m\n" + "".join(f"{i / n:.5f},{j / n:.4f},0\n" for i in range(n) for j in range(n))).encode()


@reader("table.lut", ["info", "table.lut"])
def lut(size):
    return b'{"format":"kufe-lut","axes":[' + repeated(b"[", size)


@reader("nested.lut", ["info", "nested.lut"])
def nested(size):
    return b'{"format":"kufe-lut","format_version":1,"checks":[' + repeated(b"0,", size) + b"0]}"


@reader("result.json", ["info", "result.json"])
def result(size):
    return b'{"p_max_pa":[' + repeated(b"0,", size) + b"0]}"


@reader("report", ["report", "page"])
def page(size):
    return b'{"points":[' + repeated(b"0,", size) + b"0]}"


@reader("table.json", ["report", "series"])
def series(size):
    return b"[" + repeated(b'{"step":1,"folder":"","error":null},', size) + b"{}]"


@reader("fit.json", ["validate", "runs.csv", "--model", "model.toml", "--fit", "fit.json", "-o", "out"])
def fit(size):
    return b'{"front":[' + repeated(b"0,", size) + b"0]}"


@reader("table.fmu", ["info", "table.fmu"])
def fmu(size):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("modelDescription.xml", "w", force_zip64=True) as entry:
            entry.write(b"<fmiModelDescription>")
            for _ in range(min(size * 250, 1_500_000_000) // 1_000_000):
                entry.write(b"[0," * 333_333)
        with archive.open("resources/table.lut", "w", force_zip64=True) as entry:
            for _ in range(min(size * 250, 1_500_000_000) // 1_000_000):
                entry.write(b"[0," * 333_333)
    return packed.getvalue()


@reader("hull.3mf", ["hull", "check", "hull.3mf"])
def three_mf(size):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("3D/3dmodel.model", "w", force_zip64=True) as entry:
            entry.write(b'<model unit="millimeter"><resources><object id="1"><mesh><vertices>')
            for _ in range(min(size * 250, 1_500_000_000) // 1_000_000):
                entry.write(b'<vertex x="0" y="0" z="0"/>' * 37_000)
    return packed.getvalue()


@reader("hull.stl", ["hull", "check", "hull.stl"])
def stl(size):
    count = size // 50
    return bytes(80) + struct.pack("<I", count) + bytes(50 * count)


@reader("ascii.stl", ["hull", "check", "ascii.stl"])
def ascii_stl(size):
    return b"solid s\n" + repeated(b"facet\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n", size)


@reader("hull.obj", ["hull", "check", "hull.obj"])
def obj(size):
    return b"v 0 0 0\nv 1 0 0\nv 0 1 0\n" + repeated(b"f 1 2 3\n", size)


@reader("hull.glb", ["hull", "check", "hull.glb"])
def glb(size):
    nodes = size // 40
    text = json.dumps({"asset": {"version": "2.0"}, "nodes": [{"children": [k + 1]} for k in range(nodes)]}).encode()
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<II", 2, 20 + len(text)) + struct.pack("<I", len(text)) + b"JSON" + text


@reader("uses.gltf", ["hull", "check", "uses.gltf"])
def uses(size):
    """One strip of triangles in many instances."""
    points = 2000
    data = struct.pack(f"<{3 * points}f", *(0.001 * (k % 7) + k for k in range(3 * points)))
    count = max(1_000_000, size // 12) // points - 1
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    nodes = ",".join('{"mesh":0,"translation":[0,0,%d]}' % k for k in range(count))
    text = (
        '{"asset":{"version":"2.0"},"nodes":[%s],"scenes":[{"nodes":%s}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],'
        '"buffers":[{"byteLength":%d,"uri":"%s"}],"bufferViews":[{"buffer":0,"byteLength":%d}],'
        '"accessors":[{"bufferView":0,"componentType":5126,"count":%d,"type":"VEC3","min":[0,0,0],"max":[6000,6000,6000]}]}'
        % (nodes, list(range(count)), len(data), uri, len(data), points)
    )
    return text.encode() + b" " * max(0, size - len(text))


@reader("mesh.vtu", ["press", "meshed_vtu.toml", "-o", "out"])
def vtu(size):
    head = b'<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="1"><Points>' \
        b'<DataArray type="Float64" NumberOfComponents="3" format="ascii">' % (size // 6)
    return head + repeated(b"0 0 0 ", size) + b"</DataArray></Points></Piece></UnstructuredGrid></VTKFile>"


@reader("mesh.msh", ["press", "meshed_msh.toml", "-o", "out"])
def msh(size):
    count = size // 14
    rows = b"".join(b"%d 0 0 0\n" % k for k in range(1, count + 1))
    return b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % count + rows + b"$EndNodes\n"


def matlab(packed):
    return bytes(116) + bytes(8) + b"\x00\x01IM" + struct.pack("<II", 15, len(packed)) + packed


@reader("run.mat", ["runs", "init", "run.mat", "-o", "mapping.toml"])
def mat(size):
    values = size * 60
    body = struct.pack("<IIII", 6, 8, 6, 0) + struct.pack("<IIii", 5, 8, 1, min(values, 2**31 // 8 - 64))
    body += struct.pack("<HH4s", 1, 1, b"a\0\0\0") + struct.pack("<II", 9, 8 * min(values, 2**31 // 8 - 64))
    packer = zlib.compressobj(9)
    out = packer.compress(struct.pack("<II", 14, len(body) + 8 * min(values, 2**31 // 8 - 64)) + body)
    for _ in range(8 * min(values, 2**31 // 8 - 64) // 1_000_000):
        out += packer.compress(bytes(1_000_000))
    return matlab(out + packer.flush())


def parquet_of(size):
    import numpy
    import pyarrow
    import pyarrow.parquet

    sink = io.BytesIO()
    rows = 2_000_000
    columns = max(1, size // 200_000)
    table = pyarrow.table({"t_s": numpy.zeros(rows), **{f"c{k}": numpy.zeros(rows) for k in range(min(columns, 60))}})
    with pyarrow.parquet.ParquetWriter(sink, table.schema, compression="zstd") as writer:
        for _ in range(2 if size < 10_000_000 else 10):
            writer.write_table(table, row_group_size=rows)
    return sink.getvalue()


@reader("run.parquet", ["runs", "init", "run.parquet", "-o", "mapping.toml"])
def parquet(size):
    return parquet_of(size)


@reader("run.mf4", ["runs", "init", "run.mf4", "-o", "mapping.toml"])
def mdf4(size):
    import asammdf
    import numpy

    values = numpy.zeros(min(size * 3, 30_000_000))
    log = asammdf.MDF(version="4.10")
    log.append([asammdf.Signal(values, numpy.arange(len(values)) * 0.0, name="a")])
    with tempfile.TemporaryDirectory() as folder:
        path = log.save(os.path.join(folder, "log.mf4"), compression=1)
        with open(path, "rb") as file:
            return file.read()


@reader("run73.mat", ["runs", "init", "run73.mat", "-o", "mapping.toml"])
def mat73(size):
    import h5py

    sink = io.BytesIO()
    with h5py.File(sink, "w", userblock_size=512) as file:
        # Chunks that are not written are zeros.
        for name in ("a", "b"):
            file.create_dataset(name, (1, size * 2), "f8", chunks=(1, 1_000_000), compression="gzip")
    head = b"MATLAB 7.3 MAT-file".ljust(124) + bytes([0, 2]) + b"IM"
    return head + sink.getvalue()[len(head):]


@reader("case.toml", ["press", "case.toml", "-o", "out"])
def case(size):
    return b"[runner]\n" + repeated(b"a = [[[[[[]]]]]]\n", size)


@reader("model.toml", ["simulate", "model_big.toml", "track_w.csv", "-o", "out"])
def model(size):
    return b"[effects.x]\n" + repeated(b"a = [[[[[[]]]]]]\n", size)


CASE = """[runner]
shape = { kind = "bob", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.030 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.05
SURFACE
[load]
fz_n = 1000.0
"""
SHAPE = CASE.splitlines()[1]


def prepare(command, folder, name, data):
    """Writes the input and the other files that the command needs."""
    for kind in ("model", "case"):
        subprocess.run([command, "init", f"{kind}.toml", "--kind", kind, "-q"], cwd=folder, check=True)
    files = {
        "runs.csv": "run,file\na,run.csv\n",
        "surface.toml": CASE.replace("SURFACE", 'surface = "heights.csv"'),
        "meshed_vtu.toml": CASE.replace("SURFACE", "").replace(SHAPE, 'elastic = true\nmesh = "mesh.vtu"'),
        "meshed_msh.toml": CASE.replace("SURFACE", "").replace(SHAPE, 'elastic = true\nmesh = "mesh.msh"'),
        "track_w.csv": "s_m,slope_rad,curvature_1pm,bank_rad\n" + "".join(f"{k},0.1,0,0\n" for k in range(0, 100, 10)),
    }
    for other, text in files.items():
        with open(os.path.join(folder, other), "w") as file:
            file.write(text)
    own = {"runs.csv": "index.csv", "report": "page/friction.json", "table.json": "series/table.json", "model.toml": "model_big.toml"}.get(name, name)
    path = os.path.join(folder, own)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def peak(command, folder, words):
    """The largest resident memory of the command [MB], and its exit code."""
    # Measured in a separate process, because the peak includes the memory of the parent at the start.
    watch = [sys.executable, "-c", WATCH, str(LONGEST_S), folder, command, *words]
    memory, code = subprocess.run(watch, capture_output=True, check=True, text=True).stdout.split()
    return float(memory) / 1024, int(code)


def main():
    command = os.path.abspath(sys.argv[1])
    names = sys.argv[2:] or list(INPUTS)
    print("| input | " + " | ".join(f"{size}: file, peak [MB], exit" for size in SIZES) + " |")
    print("|---|" + "---|" * len(SIZES))
    for name in names:
        make, words = INPUTS[name]
        cells = []
        for size in SIZES.values():
            folder = tempfile.mkdtemp()
            try:
                data = make(size)
                prepare(command, folder, name, data)
                memory, code = peak(command, folder, words)
                cells.append(f"{len(data) / 1e6:.1f}, {memory:.0f}, {code}")
            finally:
                shutil.rmtree(folder)
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
