"""Rows that provoke messages of docs/errors.md: several files, configurations, units, what one option forbids another (see error_cases.py)."""
import models
from provoked import Provoked, line

CUBE = models.binary_stl(models.cube())


def config(message, text, command="check cube.stl"):
    return Provoked(message, f"{command} --config a.ini", 2, {"a.ini": text if isinstance(text, bytes) else text.encode()})


ROWS = [
    # Several files.
    line("{} {}: one file for several inputs", "cube.stl hole.stl -o x.stl"),
    Provoked("{}: {} would write {} and {} to the same file", "cube.stl a/cube.stl -o out/", 2, {"a/cube.stl": CUBE}),
    Provoked("{}: standard input has no name that a file could get", "- -o folder/", 2, stdin=CUBE),
    line("{}: {} names an input", "cube.stl hole.stl -o ./"),
    line("{}: the folder cannot be made: {}", "cube.stl hole.stl -o other.stl/out/", 4),
    # A batch takes two descriptors for a pipe, and one for what a run tells.
    Provoked("no pipe", "ulimit -n 4; burnish check cube.stl hole.stl", 6, in_shell=True),
    Provoked("no anonymous file", "ulimit -n 5; burnish check cube.stl hole.stl", 6, in_shell=True),
    # Nothing can be written but into pipes.
    Provoked("the run was ended by signal {} ({})", "ulimit -f 0; burnish check cube.stl hole.stl", 70, in_shell=True),
    Provoked("the run ended with exit code {}, and told nothing", "trap '' XFSZ; ulimit -f 0; burnish check cube.stl hole.stl", 70, in_shell=True),
    # Configurations.
    line("{}: the configuration cannot be read: {}", "check cube.stl --config nowhere.ini"),
    line("{}: the configuration cannot be read: {}", "check cube.stl --config folder"),
    line("{}: the configuration cannot be read", "check cube.stl --config /proc/self/mem"),
    config("{}: expected a configuration, found more than a megabyte", "#" * (2**20 + 1)),
    config("{}: not a text file", b"quiet = true\0\n"),
    config("expected 'name = value', found '{}'", "quiet\n"),
    config("expected '[command]', found '{}'", "[check\n"),
    config("[{}] is there twice", "[check]\n[check]\n"),
    config("unknown command '[{}]'", "[chekc]\n"),
    config("unknown option '{}'{}", "[check]\nthickenss = true\n"),
    config("unknown option '{}'{}", "thickenss = true\n"),
    config("'{}' cannot be set in a configuration", "config = b.ini\n"),
    config("'{}' has no value", "threads = # two\n"),
    config("'{}' is there twice", "threads = 1\nthreads = 2\n"),
    config("'{}' is a switch: expected true or false, found '{}'", "quiet = yes\n"),
    config("expected a comment behind the quoted value, found '{}'", 'output-defects = "a" b\n'),
    config("a quoted value has no end", 'output-defects = "a.vtp\n'),
    config("expected one of \\\" \\\\ \\n \\r \\t in a quoted value, found '\\{}'", 'output-defects = "a\\b.vtp"\n'),
    line("{}: --save-config names the input", "cube.stl -o x.stl --save-config cube.stl"),
    line("{} and {} exclude each other", "clean --cell 1 --resolution 10 --save-config x.ini"),
    # Outputs of check and compare.
    line("{}: both --output-defects and --output-thickness", "check cube.stl --output-defects d.vtp --output-thickness d.vtp"),
    Provoked("{}: {} names the input", "check m.ply --output-thickness ./m.ply", 2, {"m.ply": b""}),
    line("{}: both {} and {}", "compare cube.stl moved.stl --align --output d.ply --aligned d.ply"),
    line("has no effect without --output-defects or --output-thickness", "check cube.stl --overwrite", 0),
    line("has no effect without --output, --map or --aligned", "compare cube.stl moved.stl --overwrite", 0),
    line("no thickness: that is one of a valid solid; clean it first, by 'burnish IN -o OUT'", "check hole.stl --thickness", 1),
]
