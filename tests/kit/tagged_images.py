"""Small JPEG images with the tags that cameras of drones write."""

from __future__ import annotations

from pathlib import Path

from PIL import Image, TiffImagePlugin

Rational = TiffImagePlugin.IFDRational


def tagged_image(
    path: Path,
    latitude: tuple[int, int, float] | None = None,
    longitude: tuple[int, int, float] = (0, 0, 0.0),
    references: str = "NE",
    altitude_m: float = 0.0,
    altitude_reference: int = 0,
    xmp: str = "",
    taken: str = "",
    part: str = "",
    zone: str = "",
    lens: dict[int, object] | None = None,
    size_px: tuple[int, int] = (64, 48),
) -> None:
    """Write a grey image; XMP is in an APP1 segment of its own, as in files."""
    exif = Image.Exif()
    if latitude is not None:
        gps: dict[int, object] = {1: references[0], 3: references[1]}
        for tag, angle in ((2, latitude), (4, longitude)):
            gps[tag] = tuple(Rational(round(part * 10000), 10000) for part in angle)
        gps[5], gps[6] = bytes([altitude_reference]), Rational(round(altitude_m * 1000), 1000)
        exif[0x8825] = gps
    taken_tags = {0x9003: taken, 0x9291: part, 0x9011: zone}
    if lens or any(taken_tags.values()):  # DateTimeOriginal, SubSecTimeOriginal, OffsetTimeOriginal
        exif[0x8769] = {tag: text for tag, text in taken_tags.items() if text} | (lens or {})
    Image.new("RGB", size_px).save(path, exif=exif)
    if xmp:
        packet = (
            '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF '
            'xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description '
            f'xmlns:drone-dji="http://www.dji.com/drone-dji/1.0/" {xmp}</rdf:Description>'
            "</rdf:RDF></x:xmpmeta>"
        )
        body = b"http://ns.adobe.com/xap/1.0/\x00" + packet.encode()
        segment = b"\xff\xe1" + (len(body) + 2).to_bytes(2, "big") + body
        content = path.read_bytes()
        path.write_bytes(content[:2] + segment + content[2:])
