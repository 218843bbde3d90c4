"""The checksum of a file: a seal behind the end of the file that HDF5 sees."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from .errors import RunError

#: The seal begins with these bytes and has this length. Then follow the length of the file before
#: the seal, its checksum, and a checksum of the seal.
_MAGIC, _SEAL = b"mc-seal\n", 24


def has_seal(path: Path) -> bool:
    """Whether a file of results has a checksum, right or wrong. Another program that changes the
    file drops it."""
    with path.open("rb") as file:
        return _seal_of(file) is not None


def is_sealed(path: Path) -> bool:
    """Whether a file has a checksum, which is then compared with all of its bytes.

    Raises:
        RunError: the checksum is wrong.
    """
    with path.open("rb") as file:
        seal = _seal_of(file)
        if seal is None:
            return False
        size = file.seek(0, 2) - _SEAL
        file.seek(0)
        checksum = 0
        for some in _pieces(file, size):
            checksum = zlib.crc32(some, checksum)
    right = _MAGIC + size.to_bytes(8, "little") + checksum.to_bytes(4, "little")
    if seal != right + zlib.crc32(right).to_bytes(4, "little"):
        problem, remedy = (
            f"{path} is damaged: its checksum is another one",
            "take another copy of it, or run its scenario again",
        )
        raise RunError(f"{problem}\n  fix: {remedy}", problem=problem, remedy=remedy)
    return True


def _seal_of(file: BinaryIO) -> bytes | None:
    """The last bytes of a file if they are a seal, or stand where there must be one: behind the end
    that the superblock gives (HDF5 File Format Specification, version 3.0, section II.A)."""
    head = file.read(64)
    size = file.seek(0, 2)
    end = int.from_bytes(head[28:36], "little") if head[8:10] in (b"\2\10", b"\3\10") else size
    if size < _SEAL:
        return None
    file.seek(size - _SEAL)
    seal = file.read(_SEAL)
    return seal if seal.startswith(_MAGIC) or size != end else None


def _pieces(file: BinaryIO, size: int) -> Iterator[bytes]:
    left = size
    while left > 0:
        some = file.read(min(left, 1 << 20))
        if not some:
            return
        left -= len(some)
        yield some
