"""Reads point clouds apart from the program that is judged: LAS, sweeps (.bin), PLY, PCD."""
import struct
from dataclasses import dataclass

import numpy as np


@dataclass
class Cloud:
    positions: np.ndarray            # of what was measured, doubles
    classes: np.ndarray = None       # LAS: 2 is ground
    returns: np.ndarray = None       # LAS: rows (number of the return, returns of the pulse)
    times: np.ndarray = None         # LAS: GPS times
    sensor: np.ndarray = None        # where the file says that the scanner stood


# LAS formats: record's least length, offset of the GPS time or 0.
LAS_FORMATS = {0: (20, 0), 1: (28, 20), 2: (26, 0), 3: (34, 20), 6: (30, 22), 7: (36, 22), 8: (38, 22)}


def read_las(path):
    """Formats 0 to 3 and 6 to 8, not compressed; points that are marked as withheld are left out."""
    data = path.read_bytes()
    if data[:4] != b"LASF":
        raise ValueError(f"{path}: not a LAS file")
    begin, = struct.unpack_from("<I", data, 96)
    form, size, count = struct.unpack_from("<BHI", data, 104)
    if form not in LAS_FORMATS or size < LAS_FORMATS[form][0]:
        raise ValueError(f"{path}: point format {form} with records of {size} bytes is not read here")
    if data[25] >= 4:
        count, = struct.unpack_from("<Q", data, 247)
    scale, offset = (np.array(struct.unpack_from("<3d", data, at)) for at in (131, 155))
    rows = np.frombuffer(data, np.uint8, count * size, begin).reshape(count, size)
    positions = rows[:, :12].copy().view("<i4") * scale + offset
    new, time = form >= 6, LAS_FORMATS[form][1]
    withheld = rows[:, 15] >> (2 if new else 7) & 1
    classes = rows[:, 16] if new else rows[:, 15] & 31
    bits = 4 if new else 3
    returns = np.stack([rows[:, 14] & (2**bits - 1), rows[:, 14] >> bits & (2**bits - 1)], axis=1)
    times = rows[:, time:time + 8].copy().view("<f8")[:, 0] if time else None
    keep = withheld == 0
    return Cloud(positions[keep], classes[keep].astype(int), returns[keep].astype(int),
                 None if times is None else times[keep])


def read_sweep(path):
    """KITTI: rows of four floats, the scanner at the origin; 0 0 0 is a ray that nothing returned."""
    positions = np.fromfile(path, "<f4").reshape(-1, 4)[:, :3].astype(float)
    return Cloud(measured(positions), sensor=np.zeros(3))


def measured(positions):
    """Without pixels that have no depth, and without 0 0 0, as which scanners write rays without a return."""
    return positions[np.isfinite(positions).all(axis=1) & positions.any(axis=1)]


PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
             "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
             "double": "f8", "float64": "f8"}


def read_ply(path):
    """Vertices must be the first element and have no lists."""
    data = path.read_bytes()
    end = data.index(b"\n", data.index(b"end_header")) + 1
    count, names, kinds, element, form, sensor = 0, [], [], "", "", None
    for line in data[:end].decode("latin-1").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:2] == ["comment", "sensor"]:
            sensor = np.array(words[2:5], float)
        elif words[:1] == ["element"]:
            if not element and words[1] != "vertex":
                raise ValueError(f"{path}: {words[1]} comes before the vertices")
            element, count = words[1], int(words[2]) if words[1] == "vertex" else count
        elif words[:1] == ["property"] and element == "vertex":
            names.append(words[2])
            kinds.append(PLY_TYPES[words[1]])
    at = [names.index(k) for k in "xyz"]
    if form == "ascii":
        lines = data[end:].split(b"\n", count)[:count]
        positions = np.array([line.split() for line in lines], float)[:, at]
    else:
        order = "<" if form == "binary_little_endian" else ">"
        rows = np.frombuffer(data, np.dtype([(n, order + k) for n, k in zip(names, kinds)]), count, end)
        positions = np.stack([rows[k].astype(float) for k in "xyz"], axis=1)
    return Cloud(measured(positions), sensor=sensor)


def unpacked(data, length):
    """What LZF packed: literal runs, and copies of what came out before."""
    out, at = bytearray(), 0
    while at < len(data):
        control = data[at]
        at += 1
        if control < 32:
            out += data[at:at + control + 1]
            at += control + 1
            continue
        count = control >> 5
        if count == 7:
            count += data[at]
            at += 1
        back = ((control & 31) << 8 | data[at]) + 1
        at += 1
        start, count = len(out) - back, count + 2
        piece = out[start:start + count]
        out += (piece * (count // back + 1))[:count]
    if len(out) != length:
        raise ValueError(f"{len(out)} bytes came out of {length}")
    return bytes(out)


def read_pcd(path):
    """The three kinds of data; pixels without a depth are left out. VIEWPOINT is the sensor unless it is at the
    origin, where it stands when nobody set it."""
    data = path.read_bytes()
    end = data.index(b"\n", data.index(b"\nDATA ") + 1) + 1
    head = {}
    for line in data[:end].decode("latin-1").splitlines():
        key, *words = line.split() or [""]
        head[key] = words
    counts = [int(c) for c in head.get("COUNT", ["1"] * len(head["FIELDS"]))]
    layout = [(n, ("<" + t.lower() + s).replace("<u1", "u1").replace("<i1", "i1"), (c,))
              for n, t, s, c in zip(head["FIELDS"], head["TYPE"], head["SIZE"], counts)]
    layout = [(f"{n}{k}" if n == "_" else n, *more) for k, (n, *more) in enumerate(layout)]
    points, kind = int(head["POINTS"][0]), head["DATA"][0]
    if kind == "ascii":
        first = dict(zip(head["FIELDS"], np.cumsum([0, *counts])))
        table = np.array([line.split() for line in data[end:].split(b"\n", points)[:points]])
        positions = np.stack([table[:, first[k]].astype(float) for k in "xyz"], axis=1)
    elif kind == "binary":
        rows = np.frombuffer(data, np.dtype(layout), points, end)
        positions = np.stack([rows[k][:, 0].astype(float) for k in "xyz"], axis=1)
    else:
        packed, length = struct.unpack_from("<II", data, end)
        flat, at, found = unpacked(data[end + 8:end + 8 + packed], length), 0, {}
        for name, form, (count,) in layout:  # column after column
            found[name] = np.frombuffer(flat, form, points * count, at)
            at += found[name].nbytes
        positions = np.stack([found[k].astype(float) for k in "xyz"], axis=1)
    place = np.array(head.get("VIEWPOINT", ["0"] * 3)[:3], float)
    return Cloud(measured(positions), sensor=place if place.any() else None)


READERS = {".las": read_las, ".bin": read_sweep, ".ply": read_ply, ".pcd": read_pcd}


def read_points(path):
    return READERS[path.suffix](path)
