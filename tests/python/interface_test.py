"""The interface tells of itself: docstrings, signatures, stubs, the command line's options."""
import ast
import inspect
import re
import subprocess

import burnish
from burnish import _options

PUBLIC = [name for name in burnish.__all__ if not name.startswith("__")]


def test_everything_public_has_a_docstring():
    assert burnish.__doc__
    for name in PUBLIC:
        thing = getattr(burnish, name)
        assert len(thing.__doc__ or "") > 30, name
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            if isinstance(value, property) or (inspect.isfunction(value) and not member.startswith("__")):
                assert value.__doc__, f"{name}.{member}"


def test_help_of_clean_teaches_every_option():
    text = inspect.getdoc(burnish.clean)
    for option in _options.OPTIONS:
        assert f"    {option.keyword}{'=' if option.value else '=True'}" in text
    for word in ("(n, 3) float32 or float64", "(m, 3)", "Raises:", "Example:", "percent"):
        assert word in text
    assert "@OPTIONS@" not in text


def test_every_option_of_the_command_line_is_a_keyword(program):
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    flags = set(re.findall(r"^ +(?:-[a-z], )?(--[a-z-]+)", text, re.M))
    of_the_program = {"--html", "--output", "--overwrite", "--snapshots", "--report", "--json", "--quiet", "--verbose", "--help", "--version", "--config", "--save-config", "--jobs"}
    keywords = {"--" + name.replace("_", "-") for name in inspect.signature(burnish.clean).parameters}
    assert flags - of_the_program <= keywords and len(flags) > 40


def test_the_version_is_the_programs(program):
    assert subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0] == f"burnish {burnish.__version__}"


def stub():
    with open(burnish.__file__ + "i", encoding="utf-8") as file:
        return {node.name: node for node in ast.parse(file.read()).body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}


def names_of(function):
    a = function.args
    return [x.arg for x in a.posonlyargs + a.args], [x.arg for x in a.kwonlyargs]


def test_stubs_agree_with_the_module():
    stubs = stub()
    assert set(stubs) == set(PUBLIC)
    for name in PUBLIC:
        thing = getattr(burnish, name)
        if inspect.isclass(thing):
            check_class(thing, stubs[name])
            continue
        parameters = inspect.signature(thing).parameters.values()
        positional = [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
        keyword = [p.name for p in parameters if p.kind is p.KEYWORD_ONLY]
        assert names_of(stubs[name]) == (positional, keyword), name


def check_class(kind, node):
    fields = [x.target.id for x in node.body if isinstance(x, ast.AnnAssign)]
    methods = [x.name for x in node.body if isinstance(x, ast.FunctionDef)]
    real = list(getattr(kind, "__dataclass_fields__", getattr(kind, "_fields", [])))
    if real:
        assert fields == real, kind
    assert {m for m in methods if not m.startswith("__")} == {m for m, v in vars(kind).items() if isinstance(v, property)}, kind


def test_the_package_is_marked_as_typed():
    from pathlib import Path
    assert (Path(burnish.__file__).parent / "py.typed").is_file()


def test_a_switch_has_an_opposite_that_exists():
    keywords = {o.keyword for o in _options.OPTIONS}
    assert {o.opposite for o in _options.OPTIONS if o.opposite} <= keywords
