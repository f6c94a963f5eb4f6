"""Sizes of pictures, so that a page does not move while it loads: PNG, WebP, JPEG and SVG."""
import pathlib
import re
import struct


SKETCHES = "tutorial-"  # black on white; all others suit dark pages, too


def size_of(path):
    """Width and height in pixels; None if the file is of another kind."""
    data = path.read_bytes()
    if data[:8] == b"\x89PNG\r\n\x1a\n":
        return struct.unpack(">II", data[16:24])
    if data[:4] == b"RIFF" and data[12:16] == b"VP8X":
        return tuple(1 + int.from_bytes(data[at:at + 3], "little") for at in (24, 27))
    if data[:4] == b"RIFF" and data[12:16] == b"VP8 ":
        return tuple(n & 0x3FFF for n in struct.unpack("<HH", data[26:30]))
    if data[:4] == b"RIFF" and data[12:16] == b"VP8L":
        bits = int.from_bytes(data[21:25], "little")
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if data[:2] == b"\xff\xd8":
        at = 2
        while data[at + 1] not in (0xC0, 0xC1, 0xC2):
            at += 2 + int.from_bytes(data[at + 2:at + 4], "big")
        return tuple(reversed(struct.unpack(">HH", data[at + 5:at + 9])))
    if found := re.search(rb'<svg[^>]* width="(\d+)" height="(\d+)"', data):
        return int(found[1]), int(found[2])
    return None


def with_sizes(body, folder, first_at_once=False):
    """The HTML of a page: each picture with its size, loaded when it comes into view; sketches have a class."""
    number = 0

    def sized(match):
        nonlocal number
        name = pathlib.Path(match[1]).name
        path = next((p for p in (folder / "images" / name, folder / "tutorials" / name) if p.exists()), folder / name)
        number += 1
        size = size_of(path) if path.exists() else None
        lazy = "" if first_at_once and number == 1 else ' loading="lazy"'
        sketch = ' class="sketch"' if name.startswith(SKETCHES) else ""
        sides = f' width="{size[0]}" height="{size[1]}"' if size else ""
        return match[0].replace("<img ", f"<img{sketch}{lazy}{sides} ", 1)

    return re.sub(r'<img [^>]*src="([^"]+)"[^>]*>', sized, body)
