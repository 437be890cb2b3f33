"""Unusual files from scanners, loggers and spreadsheets, each with its expected result.

    python tests/data/corpus.py target/release/kufe [NAME ...]

Writes each file into a temporary folder, reads it with the command, and compares with the expected result: size, volume
and triangles of a hull; start and values of each channel of a recording in SI units, imported at its own rate; or a part
of the error message. Prints a line for each difference. The exit code is 1 if there is one.
"""

import base64
import csv
import io
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib
from concurrent.futures import ThreadPoolExecutor

import asammdf
import h5py
import numpy
import pyarrow
import pyarrow.parquet
import scipy.io

HULLS = {}
RECORDINGS = {}

# ---- hulls: a tetrahedron and a brick, facing outwards [m]

L, W, H = 0.25, 0.125, 0.0625
POINTS = [(0, 0, 0), (L, 0, 0), (0, W, 0), (0, 0, H)]
FACETS = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
TETRAHEDRON = {"vertices": 4, "triangles": 4, "length_m": L, "width_m": W, "height_m": H, "volume_m3": L * W * H / 6, "open_edges": 0, "flipped_edges": 0}
CORNERS = [(x, y, z) for z in (0, H) for y in (0, W) for x in (0, L)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
BRICK = {"vertices": 8, "triangles": 12, "length_m": L, "width_m": W, "height_m": H, "volume_m3": L * W * H, "open_edges": 0, "flipped_edges": 0}


def hull(name, data, expected=TETRAHEDRON, companions=None):
    """A hull file; `expected` are values of `kufe info --json`, or a part of the error message."""
    HULLS[name] = (data.encode() if isinstance(data, str) else data, expected, companions or {})


def ascii_stl(head="solid s", tail="endsolid s", number=repr, normal="0 0 1", blank=" ", end="\n"):
    lines = [head]
    for facet in FACETS:
        lines += [f"facet normal {normal}", "outer loop"]
        lines += [blank.join(["vertex", *(number(float(x)) for x in POINTS[k])]) for k in facet]
        lines += ["endloop", "endfacet"]
    return end.join([*lines, tail, ""])


hull("plain.stl", ascii_stl())
hull("name_below.stl", ascii_stl(head="solid\n"))
hull("no_name_crlf.stl", ascii_stl(head="solid", end="\r\n"))
hull("tab_after_solid.stl", ascii_stl(head="solid\tpart 1"))
hull("blank_before_solid.stl", ascii_stl(head="\n  solid s"))
hull("upper.stl", ascii_stl().upper())
hull("long_name.stl", ascii_stl(head="solid " + "x" * 400))
hull("name_of_words.stl", ascii_stl(head="solid facet normal vertex 1 2 3 endsolid"))
hull("latin_name.stl", ascii_stl(head="solid Kufe süd").encode("latin-1"))
hull("mark.stl", b"\xef\xbb\xbf" + ascii_stl().encode())
hull("exponents.stl", ascii_stl(number=lambda x: f"{x:+.6E}"))
hull("bare_points.stl", ascii_stl(number=lambda x: f"{x:g}".replace("0.", ".")if x else "0."))
hull("tabs.stl", ascii_stl(blank="\t").replace("vertex", "\t\tvertex"))
hull("zero_normals.stl", ascii_stl(normal="0 0 0"))
hull("nan_normals.stl", ascii_stl(normal="nan -nan(ind) nan"))
hull("old_mac.stl", ascii_stl(end="\r"))
hull("two_solids.stl", ascii_stl().replace("endfacet", "endfacet\nendsolid\nsolid second", 1))
hull("one_line.stl", ascii_stl().replace("\n", " ").replace("solid s", "solid s\n", 1))
hull("decimal_comma.stl", ascii_stl(number=lambda x: f"{x:.4f}".replace(".", ",")), "not a comma")
hull("cut.stl", ascii_stl()[:400], "expected")


def binary_stl(header=b"", normal=(0.0, 0.0, 1.0), attribute=0, announced=len(FACETS)):
    facets = b"".join(struct.pack("<12fH", *normal, *(x for k in facet for x in POINTS[k]), attribute) for facet in FACETS)
    return header.ljust(80, b" ") + struct.pack("<I", announced) + facets


hull("binary.stl", binary_stl(bytes(80)))
hull("binary_solid.stl", binary_stl(b"solid SolidWorks part"))
hull("binary_like_text.stl", binary_stl(b"solid\tx\nfacet normal 0 0 1\n"))
hull("binary_trailing.stl", binary_stl() + b"\0" * 31)
hull("binary_nan_normals.stl", binary_stl(normal=(math.nan,) * 3))
hull("binary_colours.stl", binary_stl(b"COLOR=\x80\x80\x80\xff", attribute=0x83FF))
hull("binary_cut.stl", binary_stl(announced=7), "announces 7 facets")


def obj(corner="{v}", facets=FACETS, points=POINTS, before="", after="", start=1):
    lines = [before, *("v {!r} {!r} {!r}".format(*map(float, point)) for point in points), after]
    lines += ["f " + " ".join(corner.format(v=k + start, n=1 + i % 3, t=1 + k % 2) for k in facet) for i, facet in enumerate(facets)]
    return "\n".join(lines) + "\n"


MORE = "vt 0 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0"
hull("plain.obj", obj())
hull("normals.obj", obj("{v}//{n}", after=MORE))
hull("textures.obj", obj("{v}/{t}", after=MORE))
hull("textures_normals.obj", obj("{v}/{t}/{n}", after=MORE))
hull("negative.obj", obj("{v}", start=-4))
hull("negative_normals.obj", obj("{v}//-1", after=MORE, start=-4))
hull("quads.obj", obj(facets=QUADS, points=CORNERS), BRICK)
hull("crlf_comments.obj", obj(before="# Rhino\nmtllib a.mtl\no part\ng side").replace("\n", "  # end\r\n").replace("g side  # end", "g side"))
hull("colours.obj", obj().replace(".0\n", ".0 0.5 0.5 0.5\n").replace("0625\n", "0625 1 1 1\n"))
hull("weights.obj", obj().replace("v ", "v  ").replace("\nf", " 1.0\nf", 1))
hull("continued.obj", obj().replace(" ", " \\\n "))
hull("lines_points.obj", obj(after="usemtl red\ns off\nl 1 2 3\np 1"))
hull("old_mac.obj", obj().replace("\n", "\r"))
hull("mark.obj", "\ufeff" + obj())
hull("faces_first.obj", "".join(sorted(obj().splitlines(True), key=lambda line: line[0])))
hull("faces_of_two.obj", obj() + "f 1 2\n")
hull("exponents.obj", obj().replace("0.25", "2.5E-1").replace("0.125", "+1.25e-01"))
hull("decimal_comma.obj", obj().replace("0.125", "0,125"), "0,125")
hull("interleaved.obj", "".join("v {!r} {!r} {!r}\n".format(*map(float, POINTS[k])) + ("f -3 -2 -1\n" if i % 3 == 2 else "") for i, k in enumerate(k for f in FACETS for k in f)))
SPREAD = "".join("v {!r} {!r} {!r}\n".format(*map(float, point)) for point in POINTS) + "v 0 0 0\n" * 100_000
hull("six_digits.obj", SPREAD + "".join("f " + " ".join(str(k - 100_004) for k in facet) + "\n" for facet in FACETS))
hull("no_such_vertex.obj", obj() + "f 1 2 9\n", "refers to vertex 8, counted from 0")

FLOAT, U8, U16, U32, I16 = 5126, 5121, 5123, 5125, 5122
LETTERS = {FLOAT: "f", U8: "B", U16: "H", U32: "I", I16: "h"}


def y_up(points):
    """Coordinates in a file with y upwards: (x, y, z) of the hull is (x, z, -y) of the file."""
    return [(x, z, -y) for x, y, z in points]


def gltf(points=None, indices=None, kind=U16, point_kind=FLOAT, normalized=False, mode=4, nodes=None, stride=0, extensions=(), form="embedded"):
    """A glTF file with its buffer embedded or in a separate file, or a GLB file."""
    points = y_up(POINTS) if points is None else points
    indices = [k for facet in FACETS for k in facet] if indices is None else indices
    letter = LETTERS[point_kind]
    size = struct.calcsize(letter)
    stride = stride or (3 * size + 3) // 4 * 4
    low = [min(point[i] for point in points) for i in range(3)]
    high = [max(point[i] for point in points) for i in range(3)]
    data = b"".join(struct.pack("<3" + letter, *point).ljust(stride, b"\x55") for point in points)
    views = [{"buffer": 0, "byteLength": len(data), "byteStride": stride}]
    accessors = [{"bufferView": 0, "componentType": point_kind, "normalized": normalized, "count": len(points), "type": "VEC3", "min": low, "max": high}]
    primitive = {"attributes": {"POSITION": 0}, "mode": mode}
    if indices != []:
        packed = struct.pack(f"<{len(indices)}{LETTERS[kind]}", *indices)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        accessors.append({"bufferView": 1, "componentType": kind, "count": len(indices), "type": "SCALAR"})
        primitive["indices"] = 1
        data += packed + b"\0" * (-len(packed) % 4)
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes or [{"mesh": 0}], "meshes": [{"primitives": [primitive]}], "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}]}
    if extensions:
        document |= {"extensionsUsed": list(extensions), "extensionsRequired": list(extensions)}
    if form == "embedded":
        document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        return json.dumps(document)
    if form == "file":
        document["buffers"][0]["uri"] = "part%201.bin"
        return json.dumps(document), {"part 1.bin": data}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(data)) + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data


FLAT = [POINTS[k] for facet in FACETS for k in facet]
# One strip around the tetrahedron, beginning with its first facet.
STRIP = [0, 2, 1, 3, 0, 2]
hull("plain.gltf", gltf())
hull("plain.glb", gltf(form="glb"))
text, companions = gltf(form="file")
hull("buffer_file.gltf", text, companions=companions)
hull("bytes.glb", gltf(kind=U8, form="glb"))
hull("long_indices.glb", gltf(kind=U32, form="glb"))
hull("no_indices.glb", gltf(y_up(FLAT), [], form="glb"))
hull("interleaved.glb", gltf(stride=32, form="glb"))
hull("strip.glb", gltf(indices=STRIP, mode=5, form="glb"))
hull("fan.glb", gltf(y_up([POINTS[3], POINTS[0], POINTS[1], POINTS[2]]), [0, 1, 2, 3, 1], mode=6, form="glb"), TETRAHEDRON | {"triangles": 3, "open_edges": 3, "volume_m3": None})
hull("millimetres.glb", gltf(y_up([tuple(1e3 * x for x in p) for p in POINTS]), nodes=[{"children": [1], "scale": [1e-3] * 3}, {"mesh": 0}], form="glb"))
hull("nested.glb", gltf(nodes=[{"children": [1], "translation": [7, 0, 0]}, {"children": [2], "scale": [2, 2, 2]}, {"mesh": 0, "scale": [0.5, 0.5, 0.5]}], form="glb"))
hull("matrix.glb", gltf(nodes=[{"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 5, 0, 1]}], form="glb"), TETRAHEDRON | {"length_m": 2 * L, "width_m": 2 * W, "height_m": 2 * H, "volume_m3": 8 * L * W * H / 6})
hull("mirrored.glb", gltf(nodes=[{"mesh": 0, "scale": [-1, 1, 1]}], form="glb"))
hull("turned.glb", gltf(nodes=[{"mesh": 0, "rotation": [0, math.sqrt(0.5), 0, math.sqrt(0.5)]}], form="glb"), TETRAHEDRON | {"length_m": W, "width_m": L})
hull("quantized.glb", gltf([tuple(round(x / L * 32767) for x in p) for p in y_up(POINTS)], point_kind=I16, normalized=True, extensions=["KHR_mesh_quantization"], nodes=[{"mesh": 0, "scale": [L] * 3}], form="glb"), TETRAHEDRON | {"tolerance": 1e-4})
hull("draco.glb", gltf(extensions=["KHR_draco_mesh_compression"], form="glb"), "Blender")
hull("meshopt.glb", gltf(extensions=["EXT_meshopt_compression"], form="glb"), "gltfpack")


def three_mf(unit='unit="meter"', objects=None, build='<item objectid="1"/>', factor=1.0, others=(), pack=zipfile.ZIP_DEFLATED):
    vertices = "".join('<vertex x="{!r}" y="{!r}" z="{!r}"/>'.format(*(x / factor for x in p)) for p in POINTS)
    triangles = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*f) for f in FACETS)
    mesh = f'<object id="1" type="model"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>'
    head = f'<?xml version="1.0" encoding="UTF-8"?><model {unit} xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">'
    model = head + "<resources>{}</resources><build>{}</build></model>"
    parts = {"[Content_Types].xml": "<Types/>"}
    parts["_rels/.rels"] = '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    parts["3D/3dmodel.model"] = model.format((objects or "{mesh}").format(mesh=mesh), build)
    for other in others:
        parts[other] = model.format(mesh, "")
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", pack) as archive:
        for name, text in parts.items():
            archive.writestr(name, text)
    return packed.getvalue()


hull("metre.3mf", three_mf())
hull("default_unit.3mf", three_mf("", factor=1e-3))
hull("inch_stored.3mf", three_mf('unit="inch"', factor=0.0254, pack=zipfile.ZIP_STORED))
hull("component.3mf", three_mf(objects='{mesh}<object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 3 4 5"/></components></object>', build='<item objectid="2"/>'))
hull("placed_twice.3mf", three_mf(build='<item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 0.0625"/>'), TETRAHEDRON | {"vertices": 7, "triangles": 8, "height_m": 2 * H, "volume_m3": 2 * L * W * H / 6})
hull("mirrored.3mf", three_mf(build='<item objectid="1" transform="1 0 0 0 -1 0 0 0 1 0 0 0"/>'))
hull("other_part.3mf", three_mf(objects='<object id="3"><components><component p:path="/3D/Objects/a.model" objectid="1"/></components></object>', build='<item objectid="3"/>', others=["3D/Objects/a.model"]))

# ---- recordings: twelve samples at 10 Hz, two of them missing in some files

N = 12
TIME = [k / 10 for k in range(N)]
SPEED = [20.0 + 0.5 * k + (0.25 if k % 3 == 1 else 0.0) for k in range(N)]
RATE = [0.5 - 0.125 * k for k in range(N)]
G = 9.80665
DEGREE = math.pi / 180


def recording(name, data, channels, expected, time="t", start=0.0, message=None, more="", **options):
    """A recording, the lines of its mapping, and the expected values of each channel or a part of the error message."""
    data = data.encode() if isinstance(data, str) else data
    expected = expected if isinstance(expected, str) else {column: list(values) for column, values in expected.items()}
    RECORDINGS[name] = (data, channels, expected, time, start, message, more, options)


def table(names, columns, delimiter=",", end="\n", comma=False, preamble=(), below=(), quoted=False, formats=None):
    """Rows of text."""
    def cell(i, x):
        text = x if isinstance(x, str) else format(x, (formats or {}).get(i, ".10g"))
        text = text.replace(".", ",") if comma and not isinstance(x, str) else text
        return f'"{text}"' if quoted else text
    head = delimiter.join(f'"{name}"' if quoted else name for name in names)
    rows = [delimiter.join(cell(i, x) for i, x in enumerate(row)) for row in zip(*columns)]
    return end.join([*preamble, head, *below, *rows, ""])


KMH = [3.6 * v for v in SPEED]
V = {"v_mps": '"v", unit = "m/s"'}
V_NO_UNIT = {"v_mps": '"v"'}
PLAIN = table(["t", "v"], [TIME, SPEED])
V_ONLY = {"v_mps": SPEED}
with_gap = SPEED[:3] + [math.nan] * 2 + SPEED[5:]

recording("plain.csv", PLAIN, V, V_ONLY)
recording("semicolons.csv", PLAIN.replace(",", ";"), V, V_ONLY)
recording("tabs.txt", PLAIN.replace(",", "\t"), V, V_ONLY)
recording("blanks.txt", PLAIN.replace(",", "    ").replace("\n", "\n  "), V, V_ONLY)
recording("blank_after_comma.csv", PLAIN.replace(",", ", "), V, V_ONLY)
recording("crlf.csv", PLAIN.replace("\n", "\r\n"), V, V_ONLY)
recording("blank_lines.csv", PLAIN.replace("\n", "\n\n"), V, V_ONLY)
recording("excel_separator.csv", "sep=;\r\n" + PLAIN.replace(",", ";").replace("\n", "\r\n"), V, V_ONLY)
recording("mark.csv", b"\xef\xbb\xbf" + PLAIN.encode(), V, V_ONLY)
recording("preamble_mark.csv", b"\xef\xbb\xbf" + ("# driver: a, sled: b\n# day 3, run 2\n\n" + PLAIN).encode(), V, V_ONLY)
recording("hash_names.csv", "# " + PLAIN, V, V_ONLY)
recording("percent.csv", "% made by a script\n% " + PLAIN, V, V_ONLY)
recording("comments_between.csv", PLAIN.replace("\n0.5,", "\n# lap 2\n0.5,"), V, V_ONLY)
recording("text_column.csv", table(["t", "place", "v"], [TIME, ["bend 2"] * N, SPEED]), V, V_ONLY)
recording("line_in_quotes.csv", table(["t", "note", "v"], [TIME, ['"one,\ntwo"'] * N, SPEED]), V, V_ONLY)
recording("doubled_quotes.csv", table(["t", "note", "v"], [TIME, ['"3"" pipe, left"'] * N, SPEED]), V, V_ONLY)
recording("exponents.csv", table(["t", "v"], [TIME, SPEED], formats={0: ".3E", 1: "+.6e"}), V, V_ONLY)
recording("repeated_head.csv", PLAIN.replace("\n0.6,", "\nt,v\n0.6,"), V, V_ONLY)
recording("empty_columns.csv", table(["t", "", "v", "", ""], [TIME, [""] * N, SPEED, [""] * N, [""] * N]), V, V_ONLY)
recording("last_delimiter.csv", PLAIN.replace("\n", ",\n").replace("t,v,", "t,v"), V, V_ONLY)
recording("cut_last_line.csv", PLAIN + "1.2,2", V, V_ONLY, message="no line end")
recording("latin_unit.csv", table(["t", "w [°/s]"], [TIME, RATE]).encode("latin-1"), {"yaw_rate_radps": '"w"'}, {"yaw_rate_radps": [DEGREE * w for w in RATE]})
recording("utf8_unit.csv", table(["t", "w [°/s]"], [TIME, RATE]), {"yaw_rate_radps": '"w"'}, {"yaw_rate_radps": [DEGREE * w for w in RATE]})
recording("utf16_little.csv", b"\xff\xfe" + PLAIN.encode("utf-16-le"), V, V_ONLY)
recording("utf16_big.csv", b"\xfe\xff" + PLAIN.encode("utf-16-be"), V, V_ONLY)
recording("utf16_no_mark.csv", PLAIN.replace(",", ";").replace(".", ",").encode("utf-16-le"), V, V_ONLY)
recording("utf16_excel.txt", b"\xff\xfe" + PLAIN.replace(",", "\t").replace("\n", "\r\n").encode("utf-16-le"), V, V_ONLY)
recording("decimal_commas.csv", table(["Zeit", "v"], [TIME, SPEED], ";", comma=True), V, V_ONLY, time="Zeit")
recording("decimal_commas_tabs.txt", table(["t", "v"], [TIME, SPEED], "\t", comma=True), V, V_ONLY)
recording("quoted_commas.csv", table(["t", "v"], [TIME, SPEED], comma=True, quoted=True), V, V_ONLY)
recording("thousands.csv", table(["t", "p [Pa]"], [TIME, [f"{95_000 + k:,}.5".replace(",", " ").replace(".", ",").replace(" ", ".") for k in range(N)]], ";", comma=True), {"air_pa": '"p"'}, {"air_pa": [95_000.5 + k for k in range(N)]})
recording("thousands_quoted.csv", table(["t", "p [Pa]"], [TIME, [f'"{95_000 + k:,}.5"' for k in range(N)]]), {"air_pa": '"p"'}, {"air_pa": [95_000.5 + k for k in range(N)]})
recording("units_row.csv", table(["t", "v"], [TIME, KMH], below=["s,km/h"]), V_NO_UNIT, V_ONLY)
recording("units_brackets_row.csv", table(["t", "v"], [TIME, KMH], below=["[s],[km/h]"]), V_NO_UNIT, V_ONLY)
recording("units_in_names.csv", table(["t (s)", "v [km/h]"], [TIME, KMH]), V_NO_UNIT, V_ONLY)
recording("units_at_ends.csv", table(["time_ms", "speed_kmh", "acc_x_gs", "yaw_deg_per_s"], [[1000 * t for t in TIME], KMH, RATE, RATE]), {"v_mps": '"speed_kmh"', "ax_mps2": '"acc_x_gs"', "yaw_rate_radps": '"yaw_deg_per_s"'}, {"v_mps": SPEED, "ax_mps2": [G * x for x in RATE], "yaw_rate_radps": [DEGREE * x for x in RATE]}, time="time_ms")
recording("duplicates.csv", table(["t", "v", "v"], [TIME, SPEED, KMH]), {"v_mps": '"v (column 2)", unit = "m/s"'}, V_ONLY)
recording("duplicate_asked.csv", table(["t", "v", "v"], [TIME, SPEED, KMH]), V, 'no channel "v"')
recording("words.csv", "t,v\n0,1\nfast,slow\n", V, "fast")
recording("wide_row.csv", PLAIN.replace("\n0.5,", "\n0.5,1,"), V, "3 cells, expected 2")
recording("no_numbers.csv", "t,v\n", V, "no row of names")
recording("empty.csv", "", V, "no row of names")
recording("no_unit.csv", PLAIN, {"v_mps": '"v"'}, "unit")
recording("too_large.csv", PLAIN.replace("20,5", "20,5") + "1.2,1e309\n", V, "1e309")
for spelling, words in {"nan": ["NaN", "nan"], "excel": ["#N/A", "#DIV/0!"], "msvc": ["1.#QNAN", "-1.#IND"], "database": ["NULL", "None"], "dashes": ["--", "-"], "empty": ["", " "], "infinity": ["inf", "1.#INF"], "na": ["n/a", "NA"]}.items():
    cells = [format(v, "g") for v in SPEED]
    cells[3:5] = words
    recording(f"missing_{spelling}.csv", table(["t", "v"], [TIME, cells]), V, {"v_mps": with_gap})


def clock(seconds, form="{h:02d}:{m:02d}:{s:06.3f}"):
    seconds = round(seconds, 6)
    return form.format(h=int(seconds // 3600), m=int(seconds // 60) % 60, s=seconds % 60)


def clocks(start, form="{h:02d}:{m:02d}:{s:06.3f}", date="{}"):
    return [date.format(clock((start + t) % 86400, form)) for t in TIME]


NOON, LATE = 43_199.5, 86_399.5
recording("clock.csv", table(["Time", "v"], [clocks(NOON), SPEED]), V, V_ONLY, time="Time", start=NOON)
recording("clock_minutes.csv", table(["Time", "v"], [clocks(59.5, "{m:02d}:{s:04.1f}"), SPEED]), V, V_ONLY, time="Time", start=59.5)
recording("clock_comma.csv", table(["Zeit", "v"], [[t.replace(".", ",") for t in clocks(NOON)], SPEED], ";", comma=True), V, V_ONLY, time="Zeit", start=NOON)
recording("midnight.csv", table(["Time", "v"], [clocks(LATE), SPEED]), V, V_ONLY, time="Time", start=LATE)
DAYS = 18_687  # from 1970 to 1 March 2021
dates = [("2021-03-01 " if t < 0.45 else "2021-03-02 ") for t in TIME]
stamps = [day + c for day, c in zip(dates, clocks(LATE))]
EPOCH = 86_400.0 * DAYS + LATE
recording("date.csv", table(["Time", "v"], [stamps, SPEED]), V, V_ONLY, time="Time", start=EPOCH)
recording("date_iso.csv", table(["Time", "v"], [[s.replace(" ", "T") + "Z" for s in stamps], SPEED]), V, V_ONLY, time="Time", start=EPOCH)
recording("date_german.csv", table(["Zeit", "v"], [[f"{s[8:10]}.{s[5:7]}.{s[:4]} {s[11:]}".replace(".", "@", 2).replace(".", ",").replace("@", ".") for s in stamps], SPEED], ";", comma=True), V, V_ONLY, time="Zeit", start=EPOCH)
recording("date_us.csv", table(["Time", "v"], [["3/1/2021 11:59:59.%d PM" % (5 + k) if k < 5 else "3/2/2021 12:00:00.%d AM" % (k - 5) for k in range(10)], SPEED[:10]]), V, {"v_mps": SPEED[:10]}, time="Time", start=LATE)
recording("date_apart.csv", table(["Date", "Time", "v"], [["2021-03-01"] * N, clocks(NOON), SPEED]), V, V_ONLY, time="Time", start=NOON)
recording("packed.csv", table(["UTC Time", "v"], [clocks(35_999.5, "{h:02d}{m:02d}{s:05.2f}"), SPEED]), V, V_ONLY, time="UTC Time", start=35_999.5)
recording("unix.csv", table(["timestamp", "v"], [[EPOCH + t for t in TIME], SPEED], formats={0: ".1f"}), V, V_ONLY, time="timestamp", start=EPOCH)
recording("unix_ms.csv", table(["timestamp", "v"], [[1000 * (EPOCH + t) for t in TIME], SPEED], formats={0: ".0f"}), V, V_ONLY, time="timestamp", start=EPOCH, more='time_unit = "ms"')
recording("backwards.csv", table(["t", "v"], [TIME[::-1], SPEED]), V, "backwards")

AIM = ['"Format","AiM CSV File"', '"Session","run 2"', '"Venue","Igls"', '"Sample Rate","10"', '"Duration","1.1"', '"Segment Times","0:43.2","0:44.1"', '"Beacon Markers","43.2","87.3"', ""]
AIM_CHANNELS = {"v_mps": '"GPS Speed"', "ay_mps2": '"GPS LatAcc"', "yaw_rate_radps": '"GPS Gyro"'}
AIM_READ = {"v_mps": SPEED, "ay_mps2": [G * x for x in RATE], "yaw_rate_radps": [DEGREE * x for x in RATE]}
aim = table(["Time", "GPS Speed", "GPS LatAcc", "GPS Gyro"], [TIME, KMH, RATE, RATE], preamble=AIM, below=['"s","km/h","g","deg/s"', ""], quoted=True)
recording("aim.csv", aim, AIM_CHANNELS, AIM_READ, time="Time")
recording("aim_crlf.csv", aim.replace("\n", "\r\n"), AIM_CHANNELS, AIM_READ, time="Time")
recording("aim_bare.csv", aim.replace('"', ""), AIM_CHANNELS, AIM_READ, time="Time")
recording("aim_gap.csv", aim.replace(f'"{KMH[3]:.10g}"', '""').replace(f'"{KMH[4]:.10g}"', '""'), AIM_CHANNELS, AIM_READ | {"v_mps": with_gap}, time="Time")

MOTEC = ['"Format","MoTeC CSV File",,,"Workbook",""', '"Venue","Igls",,,"Worksheet",""', '"Log Date","01/03/2021",,,"",""', '"Sample Rate","10.000","Hz",,"",""', '"Duration","1.1","s",,"",""', '"Range","entire outing",,,"",""', '"Beacon Markers","",,,"",""', "", ""]
motec = table(["Time", "Distance", "Ground Speed", "G Force Lat", "Gyro Yaw", "Lap"], [TIME, [2.0 * k for k in range(N)], KMH, RATE, RATE, [1] * N], preamble=MOTEC, below=['"s","m","km/h","G","deg/s",""', "", ""], quoted=True)
MOTEC_CHANNELS = {"v_mps": '"Ground Speed"', "ay_mps2": '"G Force Lat"', "yaw_rate_radps": '"Gyro Yaw"', "s_m": '"Distance"'}
MOTEC_READ = AIM_READ | {"s_m": [2.0 * k for k in range(N)]}
recording("motec.csv", motec, MOTEC_CHANNELS, MOTEC_READ, time="Time")
recording("motec_crlf.csv", motec.replace("\n", "\r\n"), MOTEC_CHANNELS, MOTEC_READ, time="Time")

RACECHRONO = ["This file is created using RaceChrono v7.0.0 ( http://racechrono.com/ ).", "Format,3", 'Session title,"Igls, run 2"', "Session type,Lap timing", "Driver name,", "Created,01/03/2021,12:00", "Note,", ""]
chrono = table(["timestamp", "fragment_id", "lap_number", "elapsed_time", "speed", "speed", "x_acc", "speed"], [[f"{EPOCH + t:.2f}" for t in TIME], [0] * 6 + [1] * 6, [""] * N, TIME, SPEED, ["", *SPEED[1:]], RATE, KMH], preamble=RACECHRONO, below=["unix time,,,s,m/s,m/s,G,km/h", ",,,,100: gps,calc,101: acc,100: gps"])
recording("racechrono.csv", chrono, {"v_mps": '"speed (calc)"', "x_mps": '"speed (100: gps) (column 8)"', "ax_mps2": '"x_acc"'}, {"v_mps": [math.nan, *SPEED[1:]], "x_mps": SPEED, "ax_mps2": [G * x for x in RATE]}, time="elapsed_time")
recording("racechrono_stamp.csv", chrono, {"v_mps": '"speed (100: gps) (column 5)"'}, V_ONLY, time="timestamp", start=EPOCH, more='time_unit = "s"')
recording("racechrono_asked.csv", chrono, {"v_mps": '"speed"'}, "speed (calc)", time="elapsed_time")

VBOX = ["File created on 01/03/2021 at 10:00:00", "", "[header]", "satellites", "time", "latitude", "longitude", "velocity kmh", "heading", "vertical velocity m/s", "Lat_Acc", "", "[channel units]", "g", "", "[comments]", "(c) Racelogic", "", "[column names]"]
minutes = [3119.0 + 0.25 * k for k in range(N)]
vbox = table(["sats", "time", "lat", "long", "velocity", "heading", "vert-vel", "Lat_Acc"], [["010"] * N, clocks(35_999.5, "{h:02d}{m:02d}{s:05.2f}"), [f"+{m:011.5f}" for m in minutes], [f"-{m:011.5f}" for m in minutes], KMH, [12.0] * N, RATE, RATE], " ", "\r\n", preamble=VBOX, below=["", "[data]"])
VBOX_CHANNELS = {"v_mps": '"velocity"', "z_mps": '"vert-vel"', "ay_mps2": '"Lat_Acc"', "lat_rad": '"lat"', "long_rad": '"long"'}
VBOX_READ = {"v_mps": SPEED, "z_mps": RATE, "ay_mps2": [G * x for x in RATE], "lat_rad": [DEGREE * m / 60 for m in minutes], "long_rad": [DEGREE * m / 60 for m in minutes]}
recording("vbox.vbo", vbox, VBOX_CHANNELS, VBOX_READ, time="time", start=35_999.5)
recording("vbox_east.vbo", vbox.replace(" -03", " +03"), VBOX_CHANNELS, VBOX_READ | {"long_rad": [-x for x in VBOX_READ["long_rad"]]}, time="time", start=35_999.5)
late = table(["sats", "time", "velocity"], [["010"] * N, clocks(LATE, "{h:02d}{m:02d}{s:05.2f}"), KMH], " ", "\r\n", preamble=["[header]", "satellites", "time", "velocity kmh", "", "[column names]"], below=["", "[data]"])
recording("vbox_midnight.vbo", late, {"v_mps": '"velocity"'}, V_ONLY, time="time", start=LATE)

# ---- Parquet


def parquet(name, columns, expected, channels=None, start=0.0, time="t", compression="snappy", **options):
    sink = io.BytesIO()
    columns = {"t": TIME} | columns if time == "t" else columns
    pyarrow.parquet.write_table(pyarrow.table(columns), sink, compression=compression, **options)
    recording(name, sink.getvalue(), channels or V, expected, time=time, start=start)


from decimal import Decimal  # noqa: E402

CENTS = [Decimal(f"{v:.2f}") for v in SPEED]
COUNTS = {"n_1": '"n"'}
for packed in ("none", "snappy", "gzip", "zstd"):
    parquet(f"{packed}.parquet", {"v": SPEED}, V_ONLY, compression=packed)
parquet("brotli.parquet", {"v": SPEED}, "brotli", compression="brotli")
parquet("dictionary.parquet", {"v": SPEED}, V_ONLY, use_dictionary=True)
parquet("pages_v2.parquet", {"v": SPEED}, V_ONLY, data_page_version="2.0", use_dictionary=False)
parquet("row_groups.parquet", {"v": SPEED}, V_ONLY, row_group_size=5)
parquet("split.parquet", {"v": SPEED}, V_ONLY, use_dictionary=False, column_encoding={"v": "BYTE_STREAM_SPLIT", "t": "PLAIN"})
parquet("single.parquet", {"v": pyarrow.array(SPEED, pyarrow.float32())}, V_ONLY)
parquet("half.parquet", {"v": pyarrow.array([numpy.float16(v) for v in SPEED], pyarrow.float16())}, V_ONLY)
parquet("nulls.parquet", {"v": pyarrow.array([None if math.isnan(v) else v for v in with_gap])}, {"v_mps": with_gap})
parquet("decimal32.parquet", {"v": pyarrow.array(CENTS, pyarrow.decimal128(7, 2))}, V_ONLY, store_decimal_as_integer=True)
parquet("decimal64.parquet", {"v": pyarrow.array(CENTS, pyarrow.decimal128(15, 4))}, V_ONLY, store_decimal_as_integer=True)
parquet("decimal128.parquet", {"v": pyarrow.array(CENTS, pyarrow.decimal128(30, 10))}, V_ONLY)
parquet("decimal256.parquet", {"v": pyarrow.array(CENTS, pyarrow.decimal256(60, 20))}, V_ONLY)
parquet("decimal_negative.parquet", {"v": pyarrow.array([Decimal(f"{w:.3f}") for w in RATE], pyarrow.decimal128(9, 3))}, {"v_mps": RATE})
for bits in (8, 16, 32, 64):
    top = [2**bits - 1 - 2 ** (bits - 6) * k for k in range(N)]
    low = [2 ** (bits - 6) * k - 2 ** (bits - 1) for k in range(N)]
    for sign, counts in (("u", top), ("", low)):
        array = pyarrow.array(counts, getattr(pyarrow, f"{sign}int{bits}")())
        parquet(f"{sign}int{bits}.parquet", {"n": array}, {"n_1": [n / 2**bits for n in counts]}, {"n_1": f'"n", scale = {2.0**-bits!r}'})
for unit, per in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
    steps = pyarrow.array([int(EPOCH) * int(per) + round((0.5 + t) * per) for t in TIME], pyarrow.timestamp(unit))
    parquet(f"stamp_{unit}.parquet", {"time": steps, "v": SPEED}, V_ONLY, time="time", start=EPOCH)
    zoned = steps.cast(pyarrow.timestamp(unit, "UTC"))
    parquet(f"stamp_{unit}_utc.parquet", {"time": zoned, "v": SPEED}, V_ONLY, time="time", start=EPOCH)
    kind = pyarrow.time32(unit) if unit == "ms" else pyarrow.time64(unit)
    hours = pyarrow.array([round((NOON + t) * per) for t in TIME], pyarrow.int32() if unit == "ms" else pyarrow.int64()).cast(kind)
    parquet(f"time_{unit}.parquet", {"time": hours, "v": SPEED}, V_ONLY, time="time", start=NOON)
old = pyarrow.array([int(EPOCH) * 10**9 + round((0.5 + t) * 1e9) for t in TIME], pyarrow.timestamp("ns"))
parquet("stamp_int96.parquet", {"time": old, "v": SPEED}, V_ONLY, time="time", start=EPOCH, use_deprecated_int96_timestamps=True)
parquet("text_column.parquet", {"place": ["bend"] * N, "v": SPEED}, V_ONLY)
parquet("only_text.parquet", {"v": ["fast"] * N}, 'no channel "v"')
parquet("nested.parquet", {"v": SPEED, "pair": [{"a": 1.0, "b": 2.0}] * N, "list": [[1.0, 2.0]] * N}, V_ONLY)
recording("no.parquet", "PAR1", V, "parquet")

# ---- MDF 4

SIGNAL = asammdf.Signal


def mdf4(name, groups, channels, expected, version="4.10", compression=0, start=0.0, time=None, **options):
    log = asammdf.MDF(version=version)
    for group in groups:
        log.append(group)
    folder = tempfile.mkdtemp()
    path = os.path.join(folder, "log.mf4")
    log.save(path, overwrite=True, compression=compression)
    log.close()
    with open(path, "rb") as file:
        recording(name, file.read(), channels, expected, time=time, start=start, **options)
    os.remove(path)
    os.rmdir(folder)


t, v, w = (numpy.array(values) for values in (TIME, SPEED, RATE))
SPEED_SIGNAL = SIGNAL(3.6 * v, t, name="GPS Speed", unit="km/h")
GPS = {"v_mps": '"GPS Speed"'}
for version in ("4.00", "4.10", "4.20"):
    mdf4(f"v{version[0]}{version[2]}.mf4", [[SPEED_SIGNAL]], GPS, V_ONLY, version)
mdf4("deflated.mf4", [[SPEED_SIGNAL]], GPS, V_ONLY, compression=1)
mdf4("transposed.mdf", [[SPEED_SIGNAL]], GPS, V_ONLY, compression=2)
mdf4("two_groups.mf4", [[SPEED_SIGNAL], [SIGNAL(w, t, name="Gyro", unit="deg/s")]], GPS | {"yaw_rate_radps": '"Gyro"'}, {"v_mps": SPEED, "yaw_rate_radps": [DEGREE * x for x in RATE]})
mdf4("counts.mf4", [[SIGNAL(numpy.round(8 * w).astype("i2"), t, name="Gyro", unit="rad/s", conversion={"a": 0.125, "b": 0.0})]], {"yaw_rate_radps": '"Gyro"'}, {"yaw_rate_radps": RATE})
mdf4("invalid.mf4", [[SIGNAL(v, t, name="v", unit="m/s", invalidation_bits=numpy.array([k in (3, 4) for k in range(N)]))]], V_NO_UNIT, {"v_mps": with_gap})
mdf4("single.mf4", [[SIGNAL(v.astype("f4"), t, name="v", unit="m/s")]], V_NO_UNIT, V_ONLY)
mdf4("duplicates.mf4", [[SIGNAL(v, t, name="v", unit="m/s")], [SIGNAL(2 * v, t, name="v", unit="m/s")]], {"v_mps": '"v (group 0)"'}, V_ONLY)
mdf4("duplicate_asked.mf4", [[SIGNAL(v, t, name="v", unit="m/s")], [SIGNAL(2 * v, t, name="v", unit="m/s")]], V_NO_UNIT, "v (group 1)")
mdf4("text.mf4", [[SIGNAL(v, t, name="v", unit="m/s"), SIGNAL(numpy.array([b"bend"] * N), t, name="place", encoding="latin-1")]], V_NO_UNIT, V_ONLY)
mdf4("late_start.mf4", [[SIGNAL(v, t + 7.5, name="v", unit="m/s")]], V_NO_UNIT, V_ONLY, start=7.5)
recording("no.mf4", "MDF     4.10", V, "no.mf4", time=None)

# ---- MATLAB


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def variable(name, kind, shape, storage, data):
    return element(14, element(6, struct.pack("<II", kind, 0)) + element(5, struct.pack(f"<{len(shape)}i", *shape)) + element(1, name.encode()) + element(storage, data))


def opaque(name, kind):
    """A variable of a MATLAB class: its name and a reference to its contents."""
    reference = variable("", 13, (6, 1), 6, struct.pack("<6I", 0xDD000000, 2, 1, 1, 1, 1))
    return element(14, element(6, struct.pack("<II", 17, 0)) + element(1, name.encode()) + element(1, b"MCOS") + element(1, kind.encode()) + reference)


def matlab5(*variables):
    return b"MATLAB 5.0 MAT-file, Platform: PCWIN64".ljust(124) + b"\0\1IM" + b"".join(variables)


def savemat(values, **options):
    sink = io.BytesIO()
    scipy.io.savemat(sink, values, **options)
    return sink.getvalue()


def matlab73(fill):
    sink = io.BytesIO()
    with h5py.File(sink, "w", userblock_size=512, libver=("earliest", "latest")) as file:
        fill(file)
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(116) + b" " * 8 + bytes([0, 2]) + b"IM"
    return head + sink.getvalue()[len(head):]


def put(group, name, values, kind="double", **options):
    group.create_dataset(name, data=numpy.asarray(values), **options).attrs["MATLAB_class"] = numpy.bytes_(kind)


def columns73(file, **options):
    put(file, "t", t[None], **options)
    put(file, "v", v[None], **options)


def struct73(file):
    file.create_group("gps").attrs["MATLAB_class"] = numpy.bytes_("struct")
    put(file["gps"], "t", t[:, None])
    put(file["gps"], "v", v[:, None])


def others73(file):
    columns73(file)
    put(file, "note", numpy.array([[104], [105]], "u2"), "char")
    references = file.create_dataset("cells", (1, 2), dtype=h5py.ref_dtype)
    references.attrs["MATLAB_class"] = numpy.bytes_("cell")
    put(file, "T", numpy.zeros((1, 6), "u4"), "table")


DOUBLES = struct.pack(f"<{N}d", *SPEED)
T_VARIABLE = variable("t", 6, (N, 1), 9, struct.pack(f"<{N}d", *TIME))
recording("plain.mat", savemat({"t": t, "v": v}), V, V_ONLY)
recording("columns.mat", savemat({"t": t, "v": v}, oned_as="column"), V, V_ONLY)
recording("packed.mat", savemat({"t": t, "v": v}, do_compression=True), V, V_ONLY)
recording("single.mat", savemat({"t": t, "v": v.astype("f4")}), V, V_ONLY)
recording("integers.mat", savemat({"t": t, "n": numpy.arange(-6, 6, dtype="i2")}), COUNTS, {"n_1": [float(n) for n in range(-6, 6)]})
recording("struct.mat", savemat({"gps": {"t": t, "v": v}}), {"v_mps": '"gps.v", unit = "m/s"'}, V_ONLY, time="gps.t")
recording("scalars_matrices.mat", savemat({"t": t, "v": v, "rate": 10.0, "m": numpy.eye(3), "note": "monday", "c": numpy.array([1, "a"], dtype=object)}), V, V_ONLY)
recording("big_endian.mat", b"MATLAB 5.0 MAT-file".ljust(124) + b"\1\0MI" + b"".join(struct.pack(">II", 14, 48 + 8 * N) + struct.pack(">IIII", 6, 8, 6, 0) + struct.pack(">IIii", 5, 8, N, 1) + struct.pack(">HH4s", 1, 1, name) + struct.pack(">II", 9, 8 * N) + struct.pack(f">{N}d", *values) for name, values in ((b"t\0\0\0", TIME), (b"v\0\0\0", SPEED))), V, V_ONLY)
recording("table.mat", matlab5(T_VARIABLE, opaque("T", "table"), variable("v", 6, (1, N), 9, DOUBLES)), V, V_ONLY, message="table2struct")
recording("only_table.mat", matlab5(opaque("T", "timetable")), V, "table2struct(T, 'ToScalar', true)")
recording("string.mat", matlab5(T_VARIABLE, opaque("note", "string"), variable("v", 6, (1, N), 9, DOUBLES)), V, V_ONLY, message="variable note is a string")
recording("datetime.mat", matlab5(opaque("t", "datetime"), variable("v", 6, (1, N), 9, DOUBLES)), V, 'no channel "t"')
recording("packed_integers.mat", matlab5(T_VARIABLE, variable("n", 6, (1, N), 2, bytes(range(N)))), COUNTS, {"n_1": [float(n) for n in range(N)]})
recording("cut.mat", savemat({"t": t, "v": v})[:-40], V, "cut short")
recording("no.mat", "no MATLAB", V, "no MATLAB v5 header")
recording("v73.mat", matlab73(columns73), V, V_ONLY)
recording("v73_chunks.mat", matlab73(lambda file: columns73(file, chunks=(1, 5), compression="gzip", compression_opts=3)), V, V_ONLY)
recording("v73_shuffled.mat", matlab73(lambda file: columns73(file, chunks=(1, 4), compression="gzip", shuffle=True)), V, V_ONLY)
recording("v73_struct.mat", matlab73(struct73), {"v_mps": '"gps.v", unit = "m/s"'}, V_ONLY, time="gps.t")
recording("v73_others.mat", matlab73(others73), V, V_ONLY, message="variable T is a table")


# ---- reading and comparing


def run(command, folder, *words):
    found = subprocess.run([command, *words], cwd=folder, capture_output=True, text=True, timeout=60)
    return found.returncode, found.stdout, found.stderr


def check_error(code, errors, expected):
    """Difference from the expected error message, or None."""
    lines = errors.strip().splitlines()
    if code != 3 or len(lines) != 1 or expected not in errors:
        return f"exit {code}, {errors.strip()!r}; expected exit 3 and one line with {expected!r}"


def read_hull(command, folder, name):
    data, expected, companions = HULLS[name]
    for file, content in {name: data, **companions}.items():
        with open(os.path.join(folder, file), "wb") as out:
            out.write(content)
    code, text, errors = run(command, folder, "info", name, "--json")
    if isinstance(expected, str):
        return check_error(code, errors, expected)
    if code != 0:
        return f"exit {code}: {errors.strip()}"
    found = json.loads(text)
    for key, value in expected.items():
        if value is not None and key != "tolerance" and not math.isclose(found[key], value, rel_tol=expected.get("tolerance", 1e-6), abs_tol=1e-12):
            return f"{key} = {found[key]}, expected {value}"


def read_recording(command, folder, name):
    data, channels, expected, time, start, message, more, _ = RECORDINGS[name]
    with open(os.path.join(folder, name), "wb") as out:
        out.write(data)
    lines = ["rate_hz = 10.0", "[logger.box]", f'files = "{name}"', more, "[channels]"]
    lines += [f"{column} = {{ from = {source} }}" for column, source in channels.items()]
    if time is not None:
        lines.insert(3, f'time = "{time}"')
    with open(os.path.join(folder, "mapping.toml"), "w") as out:
        out.write("\n".join(lines) + "\n")
    code, _, errors = run(command, folder, "runs", "import", "mapping.toml", "-o", "out")
    if isinstance(expected, str):
        return check_error(code, errors, expected)
    if code != 0:
        return f"exit {code}: {errors.strip()}"
    if message is not None and message not in errors:
        return f"printed {errors!r}, expected {message!r}"
    out = os.path.join(folder, "out")
    note = next(file for file in os.listdir(out) if file.endswith(".import.json") and file != "import.json")
    with open(os.path.join(out, note)) as file:
        found_start = json.load(file)["start_s"]
    if abs(found_start - start) > 1e-6:
        return f"starts at {found_start!r} s, expected {start!r}"
    with open(os.path.join(out, note.replace(".import.json", ".csv")), newline="") as file:
        rows = list(csv.DictReader(file))
    for column, values in expected.items():
        found = [float(row[column] or "nan") for row in rows]
        same = [math.isnan(a) and math.isnan(b) or abs(a - b) <= 2e-9 * max(1.0, abs(b)) for a, b in zip(found, values)]
        if len(found) != len(values) or not all(same):
            return f"{column} = {found}, expected {values}"


def main():
    command = os.path.abspath(sys.argv[1])
    names = sys.argv[2:] or [*HULLS, *RECORDINGS]

    def difference(name):
        with tempfile.TemporaryDirectory() as folder:
            read = read_hull if name in HULLS else read_recording
            return read(command, folder, name)

    with ThreadPoolExecutor() as pool:
        found = list(pool.map(difference, names))
    for name, reason in zip(names, found):
        if reason:
            print(f"{name}: {reason}")
    print(f"{found.count(None)} of {len(names)} files are read correctly")
    sys.exit(found.count(None) < len(names))


if __name__ == "__main__":
    main()
