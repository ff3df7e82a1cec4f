"""Arguments of Python's own kinds, checked and as the compiled part takes them."""
import numbers
import os

from ._errors import UsageError


def path_of(value):
    """The bytes of a file's name: a str, bytes or an os.PathLike; what is no UTF-8 stands there with surrogates."""
    return bytes_of(os.fspath(value), "the path")


def bytes_of(text, what):
    """A str or bytes as the system has it."""
    try:
        found = os.fsencode(text)
    except UnicodeEncodeError as error:
        raise UsageError(f"{what} {text!r}: no name of a file has the character at position {error.start}", "os.fsdecode makes a str of any name") from None
    if b"\0" in found:
        raise UsageError(f"{what} {text!r}: found a NUL at byte {found.index(0)}", "no name of a file has one")
    return found


def name_of(text, what):
    """A group's name as bytes."""
    if isinstance(text, bytes):
        return text
    if not isinstance(text, str):
        raise UsageError(f"{what}: expected a name, found {text!r}", "a str or bytes")
    try:
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        raise UsageError(f"{what} {text!r}: the character at position {error.start} is half of one", "a str of whole characters") from None


def whole(value, what, low, high):
    """A whole number of that range."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not low <= value <= high or int(value) != value:
        raise UsageError(f"{what} {value}: expected a whole number from {low} to {high}")
    return int(value)


def positive(value, what, unit):
    """A number above 0."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not value > 0:
        raise UsageError(f"{what} {value}: expected {unit} above 0")
    return float(value)
