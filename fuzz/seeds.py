"""Writes small valid files of every format that can be read, to begin fuzzing with: seeds.py FOLDER EXTENSION...

FOLDER/EXTENSION/ gets the files of an extension, FOLDER/beside/ the files that sets of scans name. Python's standard
library alone; nothing of the program is used, so that a fault of a writer cannot hide one of its reader.
"""
import hashlib
import math
import os
import struct
import sys

POINTS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.5), (0.0, 1.25, 0.0), (0.0, 0.0, 1.5), (-1.0, 2.0, 1e-3)]
TETRAHEDRON = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def text(*lines, end="\n"):
    return (end.join(lines) + end).encode()


def table(separator=" ", header=None, normals=True, colors=True):
    rows = [header] if header else []
    for i, p in enumerate(POINTS):
        values = [*p, *((0, 0.6, 0.8) if normals else ()), *((10 * i, 128, 255) if colors else ())]
        rows.append(separator.join(f"{v:g}" for v in values))
    return text(*rows)


def ply(kind):
    """All columns that samples can have; `kind`: ascii, or the order of the bytes."""
    head = ["ply", f"format {kind} 1.0", "comment sensor 0 0 5", "obj_info num_cols 2", "obj_info num_rows 3",
            f"element vertex {len(POINTS)}"]
    head += [f"property float {n}" for n in "x y z nx ny nz sensor_x sensor_y sensor_z weight intensity".split()]
    head += [f"property uchar {n}" for n in ("red", "green", "blue")]
    head += ["element range_grid 6", "property list uchar int vertex_indices", "end_header"]
    rows = [(*p, 0, 0, 1, 1, 2, 3, 1, 0.5, 1, 2, 3) for p in POINTS]
    cells = [(1, i) for i in range(5)] + [(0,)]
    if kind == "ascii":
        return text(*head, *(" ".join(f"{v:g}" for v in r) for r in rows), *(" ".join(map(str, c)) for c in cells))
    order = "<" if kind == "binary_little_endian" else ">"
    return (text(*head) + b"".join(struct.pack(order + "11f3B", *r) for r in rows) +
            b"".join(struct.pack(order + ("Bi" if len(c) == 2 else "B"), *c) for c in cells))


def ply_mesh(kind):
    head = text("ply", f"format {kind} 1.0", "element vertex 4", *(f"property double {n}" for n in "xyz"),
                "element face 4", "property list uchar int vertex_indices", "end_header")
    if kind == "ascii":
        return head + text(*(f"{p[0]} {p[1]} {p[2]}" for p in POINTS[:4]),
                           *("3 " + " ".join(map(str, t)) for t in TETRAHEDRON))
    return (head + b"".join(struct.pack("<3d", *p) for p in POINTS[:4]) +
            b"".join(struct.pack("<B3i", 3, *t) for t in TETRAHEDRON))


def ply_strips():
    return text("ply", "format ascii 1.0", "element vertex 4", *(f"property float {n}" for n in "xyz"),
                "element tristrips 1", "property list int int vertex_indices", "end_header",
                *(f"{p[0]} {p[1]} {p[2]}" for p in POINTS[:4]), "8 0 1 2 3 -1 1 2 3")


def ply_camera():
    """A range mesh of VCGLIB: where its camera stood."""
    return text("ply", "format ascii 1.0", "element camera 1", *(f"property float view_p{n}" for n in "xyz"),
                *(f"property float {a}_axis{n}" for a in "xyz" for n in "xyz"), "element vertex 4",
                *(f"property float {n}" for n in "xyz"), "element face 4",
                "property list uchar int vertex_indices", "end_header", "0 0 9 1 0 0 0 1 0 0 0 1",
                *(f"{p[0]} {p[1]} {p[2]}" for p in POINTS[:4]), *("3 " + " ".join(map(str, t)) for t in TETRAHEDRON))


def stl_binary():
    return (b"solid".ljust(80, b" ") + struct.pack("<I", 4) +
            b"".join(struct.pack("<12fH", 0, 0, 0, *(v for k in t for v in POINTS[k]), 0) for t in TETRAHEDRON))


def stl_text():
    lines = ["solid s"]
    for t in TETRAHEDRON:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex %g %g %g" % POINTS[k] for k in t), "endloop", "endfacet"]
    return text(*lines, "endsolid s")


def obj(faces):
    lines = ["# tetrahedron", "o a", *("v %g %g %g 0.1 0.2 0.3" % p for p in POINTS[:4]), "vn 0 0 1", "vt 0 0"]
    return text(*lines, *(("f %d//1 %d//1 %d//1" % tuple(k + 1 for k in t) for t in TETRAHEDRON) if faces else ()),
                *(("f -4 -3 -2 -1",) if faces else ()))


def off(colors):
    rows = ["%g %g %g" % p + (" 1 2 3 4" if colors else "") for p in POINTS[:4]]
    return text("COFF" if colors else "OFF", "4 4 6", *rows, *("3 %d %d %d" % t for t in TETRAHEDRON))


def glb():
    """A tetrahedron and points, with colors, below a node that moves them."""
    binary = b"".join(struct.pack("<3f4B", *p, 10, 20, 30, 255) for p in POINTS[:4])
    binary += struct.pack("<12H", *(k for t in TETRAHEDRON for k in t))
    head = ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"translation":[1,2,3]},'
            '{"mesh":0,"rotation":[0,0,0.6,0.8],"scale":[1,2,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,'
            '"COLOR_0":1},"indices":2},{"attributes":{"POSITION":0},"mode":0}]}],"buffers":[{"byteLength":88}],'
            '"bufferViews":[{"buffer":0,"byteLength":64,"byteStride":16},{"buffer":0,"byteOffset":64,"byteLength":24}],'
            '"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},{"bufferView":0,"byteOffset":12,'
            '"componentType":5121,"normalized":true,"type":"VEC4","count":4},{"bufferView":1,"componentType":5123,'
            '"type":"SCALAR","count":12}]}').encode()
    head += b" " * (-len(head) % 4)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(head) + len(binary)) + struct.pack("<I", len(head)) + b"JSON" +
            head + struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def las(record, version=2, extra=0):
    """LAS 1.`version` of point format `record` with `extra` bytes per point."""
    header = {2: 227, 4: 375}[version]
    lengths = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67]
    length = lengths[record] + extra
    vlr = b""
    if extra:
        name = b"amplitude".ljust(32, b"\0")
        body = (b"\0\0" + bytes([9, 0]) + name).ljust(192, b"\0")  # one float
        vlr = struct.pack("<H16sHH32s", 0, b"LASF_Spec", 4, len(body), b"extra bytes") + body
    h = bytearray(header)
    h[0:4] = b"LASF"
    h[24:26] = bytes([1, version])
    struct.pack_into("<HII", h, 94, header, header + len(vlr), 1 if vlr else 0)
    struct.pack_into("<BHI", h, 104, record, length, len(POINTS) if record < 6 else 0)
    struct.pack_into("<6d", h, 131, 0.001, 0.001, 0.001, 0, 0, 0)
    if version == 4:
        struct.pack_into("<Q", h, 247, len(POINTS))
    rows = b""
    for i, p in enumerate(POINTS):
        row = struct.pack("<3iH", *(round(1000 * v) for v in p), 100 * i).ljust(lengths[record], bytes([17]))
        rows += row + struct.pack("<f", i).ljust(extra, b"\0")[:extra]
    return bytes(h) + vlr + rows


class LazCoder:
    """An arithmetic coder whose models are as they begin: all values are equally likely."""

    def __init__(self):
        self.low, self.length, self.bytes = 0, 0xFFFFFFFF, 4

    def add(self, begin, length):
        self.low, self.length = self.low + begin, length
        while self.length < 1 << 24:
            self.low, self.length, self.bytes = self.low << 8, self.length << 8, self.bytes + 1

    def symbol(self, value, count):
        step, scale = self.length >> 15, (1 << 31) // count
        begin = (scale * value >> 16) * step
        self.add(begin, (self.length if value + 1 == count else (scale * (value + 1) >> 16) * step) - begin)

    def number(self, value):
        """Of 32 bits, from 256 to 2^19, the one before it 0."""
        bits, code = (value - 1).bit_length(), value - 1
        self.symbol(bits, 33)
        self.symbol(code >> bits - 8, 256)
        step = self.length >> bits - 8
        self.add((code & (1 << bits - 8) - 1) * step, step)

    def done(self):
        return (self.low + self.length // 2).to_bytes(self.bytes, "big") + bytes(4)


def noise(size, seed):
    """Any bytes are points: the coder has a number for each."""
    return b"".join(hashlib.sha256(b"%d %d" % (seed, k)).digest() for k in range(size // 32 + 1))[:size]


def laz(record, item_version, extra=0, chunk_points=50000):
    """LAZ of one chunk: the first point of las(), and those that some bytes happen to mean."""
    data = las(record, 4 if record >= 6 else 2, extra)
    header, offset = struct.unpack_from("<HI", data, 94)
    length, = struct.unpack_from("<H", data, 105)
    point = [(10, 30, item_version)] if record >= 6 else [(6, 20, item_version)]
    time = [(7, 8, item_version)] if record in (1, 3, 4, 5) else []
    color = {2: [(8, 6, item_version)], 3: [(8, 6, item_version)], 5: [(8, 6, item_version)], 7: [(11, 6, item_version)],
             8: [(12, 8, item_version)], 10: [(12, 8, item_version)]}.get(record, [])
    waves = {4: [(9, 29, 1)], 5: [(9, 29, 1)], 9: [(13, 29, item_version)], 10: [(13, 29, item_version)]}.get(record, [])
    items = point + time + color + waves + ([(14 if record >= 6 else 0, extra, item_version)] if extra else [])
    compressor = 3 if record >= 6 else item_version
    body = (struct.pack("<HHBBHIIqqH", compressor, 0, 3, 4, 3, 0, chunk_points, -1, -1, len(items)) +
            b"".join(struct.pack("<HHH", *item) for item in items))
    vlr = struct.pack("<H16sHH32s", 0, b"laszip encoded", 22204, len(body), b"") + body
    chunk = data[offset:offset + length]
    if record >= 6:
        layers = 9 + {7: 1, 8: 2, 9: 1, 10: 3}.get(record, 0) + extra
        chunk += struct.pack("<I", len(POINTS)) + struct.pack("<I", 96) * layers
        chunk += b"".join(noise(96, k) for k in range(layers))
    else:
        chunk += noise(600, record if record < 5 else 25)
    head = bytearray(data[:header] + vlr + data[header:offset])
    struct.pack_into("<I", head, 96, len(head))
    struct.pack_into("<I", head, 100, struct.unpack_from("<I", head, 100)[0] + 1)
    head[104] |= 128
    if compressor == 1:
        return bytes(head) + chunk
    coder = LazCoder()
    if chunk_points == 0xFFFFFFFF:  # numbers of points are in the table, too
        coder.symbol(3, 33)
        coder.symbol(len(POINTS) - 1, 8)
    coder.number(len(chunk))
    return bytes(head) + struct.pack("<q", len(head) + 8 + len(chunk)) + chunk + struct.pack("<II", 0, 1) + coder.done()


def npy(dtype, columns, order=False):
    head = "{'descr': '%s', 'fortran_order': %s, 'shape': (%d, %d), }" % (dtype, order, len(POINTS), columns)
    head = head.ljust(117) + "\n"
    kind = {"<f4": "<f", "<f8": "<d", ">f8": ">d", "<i4": "<i"}[dtype]
    values = [v for p in POINTS for v in (*p, 0, 0, 1)[:columns]]
    if dtype == "<i4":
        values = [int(v) for v in values]
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + b"".join(
        struct.pack(kind, v) for v in values)


def ptx(colors):
    rows = ["%g %g %g 0.5" % p + " 1 2 3" * colors for p in POINTS] + ["0 0 0 0.5" + " 0 0 0" * colors]
    head = ["2", "3", "1 2 3", "1 0 0", "0 1 0", "0 0 1", "1 0 0 0", "0 1 0 0", "0 0 1 0", "1 2 3 1"]
    return text(*head, *rows) + text(*head, *rows)


def pcd(data):
    rows = [(*p, 0, 0, 1, 0x00102030) for p in POINTS]
    head = text("# .PCD v0.7", "VERSION 0.7", "FIELDS x y z normal_x normal_y normal_z rgb", "SIZE 4 4 4 4 4 4 4",
                "TYPE F F F F F F U", "COUNT 1 1 1 1 1 1 1", f"WIDTH {len(rows)}", "HEIGHT 1",
                "VIEWPOINT 0 0 3 1 0 0 0", f"POINTS {len(rows)}", f"DATA {data}")
    if data == "ascii":
        return head + text(*(" ".join(f"{v:g}" for v in r) for r in rows))
    if data == "binary":
        return head + b"".join(struct.pack("<6fI", *r) for r in rows)
    columns = b"".join(struct.pack("<f" if k < 6 else "<I", r[k]) for k in range(7) for r in rows)
    packed = b"".join(bytes([len(part) - 1]) + part for part in
                      (columns[at:at + 32] for at in range(0, len(columns), 32)))  # LZF of literals alone
    return head + struct.pack("<II", len(packed), len(columns)) + packed


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def e57(integers):
    """Version 1.0: one scan with a pose; coordinates as floats or as scaled integers of 12 bits."""
    def physical(logical):
        return logical // 1020 * 1024 + logical % 1020

    n = len(POINTS)
    if integers:
        streams = []
        for axis in range(3):
            bits = sum((round(100 * p[axis]) + 1000) << (12 * i) for i, p in enumerate(POINTS))
            streams.append(bits.to_bytes((12 * n + 7) // 8, "little"))
        field = ('<{} type="ScaledInteger" minimum="-1000" maximum="3095" scale="0.01"/>')
    else:
        streams = [b"".join(struct.pack("<f", p[axis]) for p in POINTS) for axis in range(3)]
        field = '<{} type="Float" precision="single"/>'
    body = b"".join(struct.pack("<H", len(s)) for s in streams) + b"".join(streams)
    length = 6 + len(body)
    padded = (length + 3) // 4 * 4
    packet = struct.pack("<BBHH", 1, 0, padded - 1, 3) + body.ljust(padded - 6, b"\0")
    section = struct.pack("<B7xQQQ", 1, 32 + len(packet), physical(48 + 32), 0)
    fields = "".join(field.format(f"cartesian{axis}") for axis in "XYZ")
    xml = ('<?xml version="1.0" encoding="UTF-8"?><e57Root type="Structure" '
           'xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0"><formatName type="String">ASTM E57 3D Imaging Data '
           'File</formatName><guid type="String">g</guid><versionMajor type="Integer">1</versionMajor><versionMinor '
           'type="Integer"/><data3D type="Vector" allowHeterogeneousChildren="1"><vectorChild type="Structure"><guid '
           'type="String">s</guid><pose type="Structure"><rotation type="Structure"><w type="Float">1</w><x '
           'type="Float"/><y type="Float"/><z type="Float"/></rotation><translation type="Structure"><x type="Float">1'
           '</x><y type="Float"/><z type="Float"/></translation></pose><points type="CompressedVector" fileOffset='
           f'"{physical(48)}" recordCount="{n}"><prototype type="Structure">{fields}</prototype><codecs type="Vector" '
           'allowHeterogeneousChildren="1"/></points></vectorChild></data3D></e57Root>').encode()
    logical = bytearray(48) + section + packet + xml
    pages = math.ceil(len(logical) / 1020)
    logical[0:48] = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, 1024 * pages, physical(48 + len(section + packet)),
                                len(xml), 1024)
    logical = bytes(logical).ljust(1020 * pages, b"\0")
    parts = (logical[at:at + 1020] for at in range(0, len(logical), 1020))
    return b"".join(part + struct.pack(">I", crc32c(part)) for part in parts)


MATRIX = "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1"

TABLES = [table(), table(","), table(";", header="x;y;z;nx;ny;nz;red;green;blue"), table(header="//X Y Z Nx Ny Nz R G B"),
          table("\t", normals=False), text(str(len(POINTS))) + table(colors=False), table().replace(b"\n", b"\r\n")]

LAS = [*(las(record) for record in range(6)), *(las(record, 4) for record in range(6, 11)), las(1, 2, 4)]
LAZ = [*(laz(record, 2) for record in range(6)), *(laz(record, 3) for record in range(6, 11)), laz(3, 1, 4), laz(5, 1),
       laz(3, 2, 4), laz(7, 3, 4), laz(8, 4, 4), laz(7, 3, 0, 0xFFFFFFFF), LAS[3][:104] + b"\x83" + LAS[3][105:]]

FILES = {
    ".ply": [ply("ascii"), ply("binary_little_endian"), ply("binary_big_endian"), ply_mesh("ascii"),
             ply_mesh("binary_little_endian"), ply_strips(), ply_camera()],
    ".conf": [text("camera 0 0 0", "bmesh a.ply 1 2 3 0 0 0 1", "bmesh b.xyz 1e3 2 3 0.6 0 0 0.8")],
    ".mlp": [text("<!DOCTYPE MeshLabDocument>", "<MeshLabProject><MeshGroup>",
                  '<MLMesh label="a" filename="a.ply"><MLMatrix44>', MATRIX, "</MLMatrix44></MLMesh>",
                  '<MLMesh label="b" filename="b.xyz"/>', "</MeshGroup></MeshLabProject>")],
    ".aln": [text("2", "a.ply", "#", MATRIX, "b.xyz", "#", MATRIX, "0")],
    ".obj": [obj(True), obj(False)],
    ".off": [off(False), off(True), text("NOFF", "2 0 0", "1 2 3 0 0 1", "4 5 6 0 1 0")],
    ".glb": [glb()],
    ".stl": [stl_binary(), stl_text()],
    ".las": LAS,
    ".laz": LAZ,
    ".bin": [b"".join(struct.pack("<4f", *p, 0.5) for p in POINTS)],
    ".npy": [npy("<f4", 3), npy("<f8", 6), npy(">f8", 3, True), npy("<i4", 3)],
    ".ptx": [ptx(False), ptx(True)],
    ".pcd": [pcd("ascii"), pcd("binary"), pcd("binary_compressed")],
    ".e57": [e57(False), e57(True)],
}


def write(folder, name, data):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "wb") as file:
        file.write(data)


def main(folder, extensions):
    write(os.path.join(folder, "beside"), "a.ply", ply("binary_little_endian"))
    write(os.path.join(folder, "beside"), "b.xyz", table())
    for extension in extensions:
        # Extensions that are not in the list are further names of text, or new: tables are a beginning.
        for i, data in enumerate(FILES.get(extension, TABLES)):
            write(os.path.join(folder, extension), f"{i}", data)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
