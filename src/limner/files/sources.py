"""Where a model's bytes come from: its own file, files beside it, and data: URIs.

A model names other files (buffers, pictures, material libraries), and whoever wrote it may have meant harm: only relative
references that stay inside the model's own folder are followed, only regular files are opened, and all of them together
count against `Limits.max_file_bytes` before they are read.
"""

from __future__ import annotations

import base64
import binascii
import os
import re
import stat
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from ..errors import FileFormatError
from .limits import Limits
from .notes import quoted

__all__ = ["Sources"]

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.\-]*:|:")


class Sources:
    """The bytes that one model may read.

    Parameters
    ----------
    path : str or path-like
        The model's file.
    limits : Limits
    """

    def __init__(self, path: str | os.PathLike[str], limits: Limits) -> None:
        self.path = Path(path)
        self.limits = limits
        self._n_read = 0

    def read_model(self) -> bytes:
        """Read the model's own file."""
        return self._read(self.path)

    def read_beside(self, reference: str, position: str = "") -> bytes:
        """Read the file that `reference` (a relative URI reference, percent-encoded or not) names.

        Raises FileFormatError, at `position` of the model, where it must not or cannot be read.
        """
        return self._read(self.locate(reference, position), reference, position)

    def locate(self, reference: str, position: str = "") -> Path:
        """Return the path that a relative reference means; it may not exist. Touches only the model's folder."""
        decoded = unquote(reference)
        self.check(decoded, position)
        beside = self.path.parent / decoded.replace("\\", "/")
        literal = self.path.parent / reference.replace("\\", "/")
        return literal if decoded != reference and not beside.exists() and literal.exists() else beside

    def check(self, reference: str, position: str = "") -> None:
        """Refuse what is no relative reference into the model's folder."""
        place = unquote(reference).replace("\\", "/")
        if not place or "\0" in place or any("\ud800" <= character <= "\udfff" for character in place):
            raise FileFormatError(f"must name a file, got {quoted(reference)}", self.path, position)
        if _SCHEME.match(place):
            raise FileFormatError(f"only files beside the model and data: URIs are read, got {quoted(reference)}", self.path, position)
        depth = 0
        for part in place.split("/"):
            depth += {"..": -1, ".": 0, "": 0}.get(part, 1)
            if depth < 0:
                break
        if depth < 0 or place.startswith("/"):
            raise FileFormatError(f"must stay inside the model's folder, got {quoted(reference)}", self.path, position)

    def read_data_uri(self, uri: str, position: str = "") -> bytes:
        """Decode a ``data:[<media type>][;base64],<data>`` URI (RFC 2397)."""
        header, comma, payload = uri.partition(",")
        if not comma:
            raise FileFormatError("a data: URI must have a comma before its data", self.path, position)
        if not header.rstrip().lower().endswith(";base64"):
            return unquote_to_bytes(payload)
        text = payload if "%" not in payload else unquote(payload)
        text = text.strip().rstrip("=")
        try:
            return base64.b64decode(text + "=" * (-len(text) % 4), validate=True)
        except (binascii.Error, ValueError) as error:
            raise FileFormatError(f"the data: URI is not valid base64: {error}", self.path, position) from None

    def read_uri(self, uri: str, position: str = "") -> bytes:
        """Read a data: URI or a file beside the model."""
        if uri[:5].lower() == "data:":
            return self.read_data_uri(uri, position)
        return self.read_beside(uri, position)

    def _read(self, path: Path, reference: str = "", position: str = "") -> bytes:
        blamed = f"{quoted(reference)} " if reference else ""
        try:
            found = os.stat(path)
            if not stat.S_ISREG(found.st_mode):
                kind = "a folder" if stat.S_ISDIR(found.st_mode) else "no regular file"
                raise FileFormatError(f"{blamed}is {kind}", self.path, position)
            self._count(found.st_size, blamed, position)
            with open(path, "rb") as stream:
                return stream.read(found.st_size)
        except FileNotFoundError:
            missing = f"{blamed}is missing" if reference else "there is no such file"
            raise FileFormatError(missing, self.path, position) from None
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
            raise FileFormatError(f"{blamed}cannot be read: {reason}", self.path, position) from None

    def _count(self, n_bytes: int, blamed: str, position: str) -> None:
        self._n_read += n_bytes
        if self._n_read > self.limits.max_file_bytes:
            raise FileFormatError(
                f"{blamed}exceeds the limit of {self.limits.max_file_bytes} bytes for one model (max_file_bytes)",
                self.path, position,
            )  # fmt: skip
