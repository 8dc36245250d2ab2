"""Pictures as the renderers leave them: read, compared, and laid side by side.

Knows no renderer and no clock. A picture is (width, height, bytes of red, green, blue a pixel), in linear bytes.
"""
import array
import struct
import zlib


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    return read_pfm(data) if data.startswith(b"PF") else read_ppm(data)


def header(data, words):
    """That many words, and what follows the white space after the last."""
    found, at = [], 0
    while len(found) < words:
        if data[at:at + 1] == b"#":
            at = data.index(b"\n", at) + 1
        elif data[at:at + 1].isspace():
            at += 1
        else:
            end = at
            while not data[end:end + 1].isspace():
                end += 1
            found.append(data[at:end])
            at = end
    return found, data[at + 1:]


def read_ppm(data):
    (_, width, height, _), pixels = header(data, 4)
    return int(width), int(height), pixels


def read_pfm(data):
    (_, width, height, _), pixels = header(data, 4)
    width, height = int(width), int(height)
    row, values = 3 * width, array.array("f", pixels)  # little-endian, as everyone here writes it
    # Clamped below and above; the rows of a PFM run upwards.
    return width, height, bytes(int(255.99 * min(1.0, max(0.0, x))) for y in reversed(range(height))
                                for x in values[y * row:(y + 1) * row])


def differences(a, b):
    return bytes(x - y if x > y else y - x for x, y in zip(a[2], b[2]))


def mean_difference(a, b):
    """The mean over pixels and channels, and by how much b is brighter than a; both in levels of 255."""
    n = len(a[2])
    return sum(differences(a, b)) / n, (sum(b[2]) - sum(a[2])) / n


def amplified(a, b, factor):
    table = bytes(min(255, factor * x) for x in range(256))
    return a[0], a[1], differences(a, b).translate(table)


def write_sheet(pictures, path):
    """In a row, two pixels apart; PNG, the bytes shown as they are."""
    height, gap = pictures[0][1], b"\x30" * 6
    rows = bytearray()
    for y in range(height):
        rows += b"\0" + gap.join(p[2][3 * p[0] * y:3 * p[0] * (y + 1)] for p in pictures)
    width = sum(p[0] for p in pictures) + 2 * (len(pictures) - 1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                  + chunk(b"IDAT", zlib.compress(bytes(rows), 6)) + chunk(b"IEND", b""))


def compare(paths, sheet):
    """A sheet of all pictures, each but the first followed by four times its difference to the first; their differences."""
    pictures = [read(path) for path in paths]
    shown, found = [pictures[0]], []
    for picture in pictures[1:]:
        shown += [picture, amplified(pictures[0], picture, 4)]
        found.append(mean_difference(pictures[0], picture))
    write_sheet(shown, sheet)
    return found
