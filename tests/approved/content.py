"""The content of an output as text: of a binary file what it holds, never its bytes."""

from __future__ import annotations

import base64
import io
import re
import struct

import numpy as np
from PIL import Image

TAPE_MARK = struct.pack("<i", 56)
"""Before and after each record of tape 10, seven numbers of eight bytes."""


EMBEDDED = re.compile(r'(;base64,|<script type="text/plain" id="\w+">)([\w+/=]{20,})')
"""A picture in a page."""
LEFT_OUT = re.compile(
    r"(?s:(<style>|<script>).*?(</style>|</script>))"
    r"|((?:style|script)-src &#39;sha256-)[\w+/=]+()"
)
"""Of a page: style, script, and the hashes of these two."""


def content(data: bytes) -> str:
    """Describe an output by lines of text.

    Arrays of a .npz, columns of a Parquet file and records of tape 10 become lines of names and
    numbers, a picture or a video its size, a page itself without its style and script, which are
    files of vopd/report, and with its pictures described. Anything else is its text.
    """
    if data.startswith(b"PK\3\4"):
        return _npz(data)
    if data.startswith(b"PAR1"):
        return _parquet(data)
    if data.startswith(b"\x89PNG"):
        return "PNG, {} x {} pixels\n".format(*struct.unpack(">II", data[16:24]))
    if data.startswith(b"\xff\xd8"):
        with Image.open(io.BytesIO(data)) as picture:
            steps = picture.quantization[0][0]  # of its quality
            return "JPEG, {} x {} pixels, in steps of {}\n".format(*picture.size, steps)
    if data[4:8] == b"ftyp":
        return f"MP4, {len(data)} bytes\n"
    if data.startswith(b"%PDF"):
        width, height = re.findall(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", data)[0]
        return f"PDF, {width.decode()} x {height.decode()} points\n"
    if data.startswith(TAPE_MARK) and len(data) % 64 == 0:
        return _tape10(data)
    text = data.decode("utf-8", "backslashreplace")
    return LEFT_OUT.sub(_left_out, EMBEDDED.sub(_embedded, text))


def _embedded(found: re.Match[str]) -> str:
    described = content(base64.b64decode(found[2])).strip()
    if size := re.search(r'<svg[^>]* viewBox="0 0 (\S+) (\S+)"', described):
        described = "SVG, {:.0f} x {:.0f} points".format(*map(float, size.groups()))
    return found[1] + described


def _left_out(found: re.Match[str]) -> str:
    begin, end = (part for part in found.groups() if part is not None)
    return f"{begin}...{end}"


def _tape10(data: bytes) -> str:
    records = [struct.unpack("<4x7d4x", data[k : k + 64]) for k in range(0, len(data), 64)]
    lines = (f'"time_s": {time!r} "angles_deg": {angles!r}' for time, *angles in records)
    return "\n".join(["TAPE 10", *lines, ""])


def _npz(data: bytes) -> str:
    lines = []
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        for name in sorted(arrays):
            array = arrays[name]
            kind = "text" if array.dtype.kind == "U" else str(array.dtype)
            lines.append(f'"{name}": {kind} {list(array.shape)} {array.tolist()!r}')
    return "\n".join(["NPZ", *lines, ""])


def _parquet(data: bytes) -> str:
    import pyarrow.parquet as parquet

    table = parquet.read_table(io.BytesIO(data))
    notes = {
        key.decode(): value.decode()
        for key, value in (table.schema.metadata or {}).items()
        if key not in (b"pandas", b"ARROW:schema")
    }
    return "\n".join(
        [
            "PARQUET",
            *(f"{key}: {value}" for key, value in sorted(notes.items())),
            *(
                f'"{field.name}": {field.type} {table[field.name].to_pylist()!r}'
                for field in table.schema
            ),
            "",
        ]
    )
