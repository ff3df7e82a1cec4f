"""The bodies of named tests, C++ and scenarios, and whether one asserts a message."""
import re
from pathlib import Path

from provoked import regex_of

ROOT = Path(__file__).resolve().parents[2]
LEAST_PIECE = 8  # letters of a message that a test has to hold
CPP_TEST = re.compile(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)\s*\{\n(.*?)^\}", re.MULTILINE | re.DOTALL)
SCENARIO = re.compile(r"^@scenario\(.*\)\ndef (\w+)\(.*\):\n((?:[ \t]+.*\n|\n)+)", re.MULTILINE)
LITERAL = re.compile(r'"((?:\\.|[^"\\\n])*)"|\'((?:\\.|[^\'\\\n])*)\'')
# What separates fixed text within a literal: metacharacters of regular expressions, and fields of formats.
JOINT = re.compile(r"\d+|\\[dwsSDWnAZb]|\{[^}]*\}|[.\])?][*+?]+|\[[^\]]*\][*+]?|[()|^$*+]")


def bodies():
    """{name: text} of all tests: Suite.Name in C++, the function's name of a scenario."""
    found = {}
    for path in sorted((ROOT / "tests").glob("**/*_test.cpp")):
        found.update({f"{suite}.{name}": body for suite, name, body in CPP_TEST.findall(path.read_text(encoding="utf-8"))})
    for path in [*(ROOT / "tests/cli").glob("*scenarios.py")]:
        found.update(SCENARIO.findall(path.read_text(encoding="utf-8")))
    return found


def pieces_of(body):
    """The fixed pieces of text in the literals of a test."""
    literals = [one or other for one, other in LITERAL.findall(body)]
    return {re.sub(r"\\(?=\W)", "", part).strip(" :,") for literal in literals for part in JOINT.split(literal)}


def asserts(body, message, others):
    """Whether a literal of the test holds the message, or a piece of it that is in none of the `others`."""
    if any(regex_of(message).search(one or other) for one, other in LITERAL.findall(body)):
        return len(message.replace("{}", "")) >= LEAST_PIECE
    return any(len(piece) >= LEAST_PIECE and piece in message and not any(piece in other for other in others) for piece in pieces_of(body))
