"""The options of `clean`: the rows of the command line's own table, with underscores for hyphens."""
import inspect
import numbers
import os
import textwrap
from typing import NamedTuple

from . import _burnish
from ._arguments import bytes_of


class Option(NamedTuple):
    """A row of the table."""

    keyword: str
    value: str  # what stands for the value; empty: a switch
    group: str
    help: str
    opposite: str  # of a switch: the one that False stands for


OPTIONS = [Option(*row) for row in _burnish.clean_options()]


def texts_of(options):
    """Options as the command line would read them; what is None is left out. True and False stay."""
    return {keyword: text_of(value, keyword) for keyword, value in options.items() if value is not None}


def text_of(value, keyword):
    """A number, a path or a text as the command line would read it."""
    if isinstance(value, bool) or type(value).__name__ == "bool_":
        return bool(value)
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    return bytes_of(os.fspath(value) if isinstance(value, (bytes, os.PathLike)) else str(value), keyword)


def with_options(function):
    """Gives a function that ends in **options their names, and their help."""
    signature = inspect.signature(function)
    own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    named = [inspect.Parameter(o.keyword, inspect.Parameter.KEYWORD_ONLY, default=None) for o in OPTIONS]
    function.__signature__ = signature.replace(parameters=own + named)
    if function.__doc__:
        function.__doc__ = inspect.cleandoc(function.__doc__).replace("@OPTIONS@", help_text())
    return function


def help_text():
    """The table, by its groups."""
    lines, group = [], None
    for option in OPTIONS:
        if option.group != group:
            group = option.group
            lines += [f"  {group}"]
        lines += textwrap.wrap(f"{option.keyword}{'=' + option.value if option.value else '=True'}: {option.help}", 96, initial_indent="    ", subsequent_indent="        ")
    return "\n".join(lines)
