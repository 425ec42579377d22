"""Pictures of a report: PNG files of a results folder, packed and embedded in the page.

Figures of few colours become PNG with a palette; shaded surfaces, on which a palette would show steps, become WebP.
"""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from io import BytesIO
from pathlib import Path

from PIL import Image

from gearwhine.output.sections import Picture, Section, arrowed

_LARGEST_PICTURE_FILE = 8 << 20  # size of a file up to which it is taken as a picture [bytes]
_LARGEST_UNPACKED_FILE = 512  # size of a file up to which it is not packed [bytes]
_TALL = 1.2  # height over width of a picture that fills a printed page
_COLOURS, _QUALITY, _EFFORT = 256, 85, 2  # colours of a palette; quality and effort of WebP
_EACH, _SHADED = 4, 3500  # distance of sampled pixels, and number of colours among them above which a picture is shaded
_KEPT_PICTURES = 128  # number of packed pictures that are kept for the next one like them
_SMALL, _WIDE = 720, 1400  # largest width of a small picture, and of any [pixels]


@dataclass(frozen=True)
class Shown:
    """A picture file with its caption, and whether it is small."""

    path: Path
    caption: str
    small: bool = False

    @property
    def place(self) -> str:
        """Name of its place in the report."""
        return f"picture {self.path.stem}"


def pictures_in(place: Path) -> list[Path]:
    """Return the picture files of a folder by name; no links, and none that is too large to be a figure."""
    paths = sorted(place.glob("*.png"))
    return [
        path
        for path in paths
        if path.is_file() and not path.is_symlink() and path.stat().st_size <= _LARGEST_PICTURE_FILE
    ]


def distribute(sections: Sequence[Section], files: Sequence[Path]) -> tuple[dict[int, list[Shown]], list[Path]]:
    """Give each file to the section that declares it; inner sections choose before the section around them.

    Returns
    -------
    dict of int to list of Shown
        Pictures by the identity of the section, in the order of declaration.
    list of Path
        Files that no section declares.
    """
    by_section: dict[int, list[Shown]] = {}
    undeclared = list(files)

    def give(section: Section) -> None:
        for inner in section.inner:
            give(inner)
        for declared in section.pictures:
            mine = [path for path in undeclared if path.stem.startswith(declared.begins)]
            for path in mine:
                undeclared.remove(path)
            if not _repeated(declared, files):
                by_section.setdefault(id(section), []).extend(
                    Shown(path, declared.caption, declared.small) for path in mine
                )

    for section in sections:
        give(section)
    return by_section, undeclared


def _repeated(declared: Picture, files: Sequence[Path]) -> bool:
    """Whether a sheet only repeats pictures that exist by themselves."""
    return bool(declared.sheet_of) and any(path.stem.startswith(declared.sheet_of) for path in files)


def figure(picture: Shown, identifier: str) -> str:
    """Return a picture with its caption as HTML."""
    caption = escape(arrowed(picture.caption) or f"File {picture.path.name}.")
    packed = _packed(picture.path.read_bytes(), _SMALL if picture.small else _WIDE)
    if packed is None:
        return f'<figure id="{identifier}"><figcaption>{caption} The file cannot be read.</figcaption></figure>\n'
    name = escape(picture.path.stem)
    kind, data, (width, height) = packed
    encoded = base64.b64encode(data).decode("ascii")
    image = f'<img alt="{caption}" width="{width}" height="{height}" src="data:{kind};base64,{encoded}">'
    tall = ' class="tall"' if height > _TALL * width else ""
    return f'<figure id="{identifier}" data-picture="{name}"{tall}>{image}<figcaption>{caption}</figcaption></figure>\n'


@lru_cache(maxsize=_KEPT_PICTURES)
def _packed(content: bytes, widest: int) -> tuple[str, bytes, tuple[int, int]] | None:
    """Return media type, content and size of a picture, packed as it is shaded or not; None if it is none.

    Commands of one folder draw some pictures alike, which are packed once.
    """
    try:
        with Image.open(BytesIO(content), formats=["PNG"]) as image:
            size = image.size
            flat = Image.new("RGB", size, "white")
            flat.paste(image, mask=image.getchannel("A") if image.mode == "RGBA" else None)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
    if len(content) <= _LARGEST_UNPACKED_FILE:
        return "image/png", content, size
    if size[0] > widest:
        flat = flat.resize((widest, max(round(size[1] * widest / size[0]), 1)), Image.Resampling.LANCZOS)
    buffer = BytesIO()
    sampled = flat.resize((max(flat.width // _EACH, 1), max(flat.height // _EACH, 1)), Image.Resampling.NEAREST)
    is_shaded = sampled.getcolors(_SHADED) is None
    if is_shaded:
        flat.save(buffer, "WEBP", quality=_QUALITY, method=_EFFORT)
    else:
        # Without dithering, which spoils the compression of flat areas.
        flat.quantize(_COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(buffer, "PNG")
    if buffer.tell() >= len(content):
        return "image/png", content, size
    return "image/webp" if is_shaded else "image/png", buffer.getvalue(), flat.size
