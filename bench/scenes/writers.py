"""Files of surveys, written apart from the program that is judged: LAS 1.2, the way of an aircraft, sweeps."""
import struct

import numpy as np

POINT = np.dtype([("at", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("class", "u1"), ("angle", "i1"),
                  ("user", "u1"), ("source", "<u2"), ("time", "<f8")])  # format 1
HEADER = 227  # bytes


def write_las(path, positions, times, source, number=1, of=1, classes=1, scale=0.01):
    """Point format 1. Returns the positions as they are in the file: whole multiples of the scale."""
    offset = np.floor(positions.min(axis=0) / 1000) * 1000
    rows = np.zeros(len(positions), POINT)
    rows["at"] = np.round((positions - offset) / scale)
    rows["returns"] = np.asarray(number) | np.asarray(of) << 3
    rows["class"], rows["source"], rows["time"], rows["intensity"] = classes, source, times, 800
    written = rows["at"] * scale + offset
    low, high = written.min(axis=0), written.max(axis=0)
    header = struct.pack("<4sHH16sBB32s32sHHHIIBHI5I", b"LASF", 0, 0, bytes(16), 1, 2, b"scenes", b"scenes", 1, 2026,
                         HEADER, HEADER, 0, 1, POINT.itemsize, len(rows), *returns_of(number, len(rows)))
    header += struct.pack("<12d", *[scale] * 3, *offset, *np.stack([high, low], axis=1).ravel())
    path.write_bytes(header + rows.tobytes())
    return written


def returns_of(number, count):
    """How many points are the first return of their pulse, the second, to the fifth."""
    return np.bincount(np.broadcast_to(number, count), minlength=6)[1:6].tolist()


def write_way(path, times, places):
    """Where the scanner was: lines `time x y z`."""
    np.savetxt(path, np.column_stack([times, places]), "%.3f")


def write_sweep(path, positions):
    """As KITTI: rows of x y z intensity, the scanner at the origin. Returns the positions as they are in the file."""
    rows = np.full((len(positions), 4), 0.3, "<f4")
    rows[:, :3] = positions
    rows.tofile(path)
    return rows[:, :3].astype(float)
