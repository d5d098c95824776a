"""Pictures as rows of bytes: PNG of 8 bits a channel (W3C, Portable Network Graphics, third edition) and binary PPM."""
import sys
import zlib
from pathlib import Path


class Picture:
    """`pixels`: red, green, blue of each pixel, row by row from the top."""

    def __init__(self, width, height, pixels):
        if len(pixels) != 3 * width * height:
            sys.exit(f"a picture of {width} x {height} has {len(pixels)} bytes instead of {3 * width * height}")
        self.width, self.height, self.pixels = width, height, pixels

    def count_not(self, color):
        """How many pixels are not of this colour, (red, green, blue) in 0..255."""
        wanted = bytes(color)
        data = self.pixels
        return sum(data[k : k + 3] != wanted for k in range(0, len(data), 3))

    def count_different(self, other, limit):
        """How many pixels differ from the other picture's by more than `limit` in a channel."""
        if (self.width, self.height) != (other.width, other.height):
            sys.exit(f"{self.width} x {self.height} against {other.width} x {other.height} pixels")
        apart = [abs(a - b) > limit for a, b in zip(self.pixels, other.pixels)]
        return sum(r or g or b for r, g, b in zip(apart[0::3], apart[1::3], apart[2::3]))


def _undo_filter(kind, line, above, channels):
    """One line of a PNG back to what it was before its filter; the names of the kinds are the standard's."""
    if kind == 0:
        return
    for k in range(len(line)):
        left = line[k - channels] if k >= channels else 0
        up = above[k]
        if kind == 1:
            guess = left
        elif kind == 2:
            guess = up
        elif kind == 3:
            guess = (left + up) // 2
        else:
            corner = above[k - channels] if k >= channels else 0
            sum_ = left + up - corner
            far_left, far_up, far_corner = abs(sum_ - left), abs(sum_ - up), abs(sum_ - corner)
            guess = left if far_left <= far_up and far_left <= far_corner else up if far_up <= far_corner else corner
        line[k] = (line[k] + guess) & 255


def read_png(path):
    data = Path(path).read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        sys.exit(f"{path} is no PNG")
    place, packed, header = 8, b"", None
    while place < len(data):
        length, kind = int.from_bytes(data[place : place + 4], "big"), data[place + 4 : place + 8]
        body = data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            header = body
        elif kind == b"IDAT":
            packed += body
        place += length + 12
    width, height, depth, kind = int.from_bytes(header[:4], "big"), int.from_bytes(header[4:8], "big"), header[8], header[9]
    channels = {2: 3, 6: 4}.get(kind)
    if depth != 8 or channels is None or header[12] != 0:
        sys.exit(f"{path}: only 8 bits a channel, in colour and not interlaced, are read here")
    raw, stride = zlib.decompress(packed), channels * width
    pixels, above = bytearray(), bytes(stride)
    for row in range(height):
        start = row * (stride + 1)
        line = bytearray(raw[start + 1 : start + 1 + stride])
        _undo_filter(raw[start], line, above, channels)
        above = line
        if channels == 4:
            line = bytearray(byte for k, byte in enumerate(line) if k % 4 != 3)
        pixels += line
    return Picture(width, height, bytes(pixels))


def read_ppm(path):
    data = Path(path).read_bytes()
    words, place = [], 0
    while len(words) < 4:
        while data[place : place + 1].isspace():
            place += 1
        end = place
        while not data[end : end + 1].isspace():
            end += 1
        if data[place : place + 1] == b"#":
            place = data.index(b"\n", place) + 1
            continue
        words.append(data[place:end])
        place = end
    if words[0] != b"P6" or words[3] != b"255":
        sys.exit(f"{path} is no PPM of 8 bits a channel")
    return Picture(int(words[1]), int(words[2]), data[place + 1 :])
