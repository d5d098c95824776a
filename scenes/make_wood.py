#!/usr/bin/env python3
"""Writes wood.png, the texture of the pole in family.toml: grain along v, as many waves round u as it needs to close.

Standard library only, the same bytes on every machine with the same zlib.
"""
import math
import struct
import sys
import zlib

WIDTH, HEIGHT = 192, 384
DARK, LIGHT = (92, 52, 22), (206, 142, 78)


def grain(turn, height):
    """How light the wood is, 0 to 1, at this part of a turn and of the height. Both ends of either meet."""
    angle, along = 2 * math.pi * turn, 2 * math.pi * height
    sway = 0.5 * math.sin(along + math.sin(angle)) + 0.2 * math.sin(3 * along + 2 * angle)
    rings = 0.5 + 0.5 * math.sin(8 * angle + 3 * sway)
    fibres = 0.5 + 0.5 * math.sin(37 * angle + 2 * sway + 1.5 * math.sin(2 * along))
    knot = math.exp(-40 * ((1 - math.cos(angle - 2)) / 2 + (1 - math.cos(along - 4)) / 2))
    return max(0.0, 0.25 + 0.5 * rings**1.5 + 0.25 * fibres - 0.6 * knot)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


rows = bytearray()
for y in range(HEIGHT):
    rows.append(0)  # no filter
    for x in range(WIDTH):
        share = grain(x / WIDTH, y / HEIGHT)
        rows += bytes(round(d + (l - d) * min(1.0, share)) for d, l in zip(DARK, LIGHT))

with open(sys.argv[1] if len(sys.argv) > 1 else "wood.png", "wb") as out:
    out.write(b"\x89PNG\r\n\x1a\n")
    out.write(chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)))
    out.write(chunk(b"IDAT", zlib.compress(bytes(rows), 9)))
    out.write(chunk(b"IEND", b""))
