"""What can go wrong, as exceptions."""


class Error(Exception):
    """Why Burnish could not deliver. `str()` of it says what was found, where, and the way out.

    Attributes:
        code: the error's name as in JSON reports, such as "unreadable_input".
        hint: one sentence on what can be done about it, or "".
        result: the CleanResult of a run that failed, whose report says what was found; None otherwise.
    """

    code = "error"

    def __init__(self, message, hint="", code=None):
        super().__init__(f"{message} ({hint})" if hint else message)
        self.hint = hint
        self.result = None
        if code:
            self.code = code


class UsageError(Error, ValueError):
    """An argument means nothing: an array's shape, type, index or coordinate, or an option's value."""

    code = "usage"


class UnreadableInputError(Error, OSError):
    """A file is missing, broken, or holds no facets."""

    code = "unreadable_input"


class UnwritableOutputError(Error, OSError):
    """The output exists, or cannot be written."""

    code = "unwritable_output"


class GuaranteeError(Error):
    """The result could not be verified, or the input bounds no solid."""

    code = "guarantee_unmet"


class MemoryLimitError(Error, MemoryError):
    """The memory budget does not allow the resolution asked for."""

    code = "memory_limit"


class TimeLimitError(Error, TimeoutError):
    """The run took longer than it may: `time_limit` was given."""

    code = "time_limit"


class BugError(Error, RuntimeError):
    """A broken invariant of Burnish itself: please report it, with the input."""

    code = "bug"


_KINDS = {kind.code: kind for kind in (UsageError, UnreadableInputError, UnwritableOutputError, GuaranteeError, MemoryLimitError, TimeLimitError, BugError)}


def error_of(code, message, hint):
    """The exception for an error of the library."""
    return _KINDS.get(code, Error)(message, hint, code)
