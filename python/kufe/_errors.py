"""What the package raises."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._kufe import Contact


class Error(Exception):
    """What every failure of this package is; the text is the one that the command prints."""

    __module__ = "kufe"


class InputError(Error, ValueError):
    """A file, or a value in it, is wrong, or a file cannot be written."""

    __module__ = "kufe"


class FileError(InputError, OSError):
    """The system cannot read or write a file; `errno` is its reason."""

    __module__ = "kufe"


class MissingFileError(FileError, FileNotFoundError):
    """A file does not exist."""

    __module__ = "kufe"


class NotConvergedError(Error):
    """An iteration stopped short of the requested accuracy."""

    __module__ = "kufe"

    best: Contact | list[dict[str, Any]] | None = None
    """The best answer with its errors, as the function returns it; None where there is none."""
