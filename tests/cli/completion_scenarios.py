"""What is made of the option tables: completion in real shells, the manual page, docs/options.md, the version."""
import json
import os
import pty
import re
import select
import shlex
import shutil
import subprocess
import time
from pathlib import Path

from runner import expect
from scenarios import scenario

FILES = ["a.stl", "b.txt", "c.PLY", "d e.obj", "f.json", "v.nrrd"]

# The line up to the cursor, as words; what has to be offered; what must not be.
ASKED = [
    (["--met"], {"--method"}, set()),
    (["--method", ""], {"auto", "local", "levelset"}, {"a.stl", "check"}),
    (["ch"], {"check"}, {"clean"}),
    (["check", ""], {"a.stl", "c.PLY", "d e.obj"}, {"b.txt", "f.json", "v.nrrd"}),
    ([""], {"a.stl", "v.nrrd", "clean", "mesh", "help"}, {"b.txt", "f.json"}),
    (["a.stl", "--report", ""], {"f.json"}, {"a.stl"}),
    (["clean", "a.stl", "--region", ""], {"b.txt", "a.stl"}, {"f.json"}),
    (["curvature", "a.stl", "--method", ""], {"front", "nodal"}, {"local"}),
    (["field", "a.stl", "--data", "phi,le"], {"phi,level"}, set()),
    (["example", ""], {"sphere", "vase", "knot", "nozzle"}, {"a.stl"}),
    (["ic", "a.stl", "--case", ""], {"folder"}, {"a.stl"}),
    (["help", "me"], {"mesh"}, {"--memory"}),
    (["completion", "z"], {"zsh"}, set()),
]


def has_shell(name):
    if shutil.which(name):
        return True
    print(f"  skipped: no {name} (scripts/bootstrap test)")
    return False


def script(box, shell):
    text = box.succeed(["completion", shell]).text()
    box.write(f"completion.{shell}", text.encode())
    expect(subprocess.run([shell, "-n", str(box.folder / f"completion.{shell}")]).returncode == 0, f"{shell} -n refuses the script")
    for name in FILES:
        box.write(name, b"")
    return text


def run_shell(box, command):
    """What a shell prints that is started in the sandbox, with the program in its path and no settings of its user."""
    environment = {**os.environ, "PATH": f"{Path(box.program).parent}:{os.environ['PATH']}", "HOME": str(box.folder), "XDG_CONFIG_HOME": str(box.folder)}
    result = subprocess.run(command, cwd=box.folder, env=environment, capture_output=True, text=True, timeout=60)
    expect(result.returncode == 0, f"{command[0]}: {result.stderr}")
    return result.stdout


def expect_offers(shell, words, offered, wanted, unwanted):
    offered = {o.rstrip("/") for o in offered}
    expect(wanted <= offered and not unwanted & offered, f"{shell}: burnish {words}\noffered {sorted(offered)}\nexpected {sorted(wanted)}, without {sorted(unwanted)}")


def bash_offers(box, words):
    line = " ".join(shlex.quote(w) for w in ["burnish", *words])
    return run_shell(box, ["bash", "--norc", "-c", f"source completion.bash; COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
                           "_burnish; (( ${#COMPREPLY[@]} == 0 )) || printf '%s\\n' \"${COMPREPLY[@]}\""]).splitlines()


@scenario("completion")
def bash_offers_what_the_tables_say(box):
    if not has_shell("bash"):
        return
    text = script(box, "bash")
    expect("complete -F _burnish burnish" in text, "nothing is registered")
    for words, wanted, unwanted in ASKED:
        expect_offers("bash", words, bash_offers(box, words), wanted, unwanted)
    # bash divides --name=value into three words; an operand too many has no completion; behind -- there are no options.
    expect_offers("bash", "--smooth=", bash_offers(box, ["--smooth", "=", "a"]), {"auto"}, {"a.stl"})
    expect_offers("bash", "--smooth=", bash_offers(box, ["--smooth", "="]), {"auto"}, {"="})
    expect(bash_offers(box, ["check", "a.stl", ""]) == [], "an operand too many is offered")
    expect(bash_offers(box, ["check", "--", "--"]) == [], "an option is offered behind --")


@scenario("completion")
def fish_offers_what_the_tables_say(box):
    if not has_shell("fish"):
        return
    script(box, "fish")
    for words, wanted, unwanted in ASKED:
        line = " ".join(["burnish", *words])
        out = run_shell(box, ["fish", "--no-config", "-c", f"source completion.fish; complete -C {shlex.quote(line)}"])
        expect_offers("fish", words, {o.split("\t")[0] for o in out.splitlines()}, wanted, unwanted)


class Zsh:
    """A zsh on a terminal of its own, without anybody's settings, where the completion is loaded."""

    def __init__(self, box):
        environment = {"PATH": f"{Path(box.program).parent}:{os.environ['PATH']}", "HOME": str(box.folder), "TERM": "dumb", "LC_ALL": "C"}
        self.terminal, there = pty.openpty()
        self.process = subprocess.Popen(["zsh", "-f", "-i"], cwd=box.folder, env=environment, stdin=there, stdout=there, stderr=there, start_new_session=True)
        os.close(there)
        self.say("PS1=; unsetopt zle_bracketed_paste; autoload -Uz compinit; compinit -u -D; source completion.zsh; stty -echo columns 200; "
                 "LISTMAX=1000; zstyle ':completion:*' list-prompt ''; print REA''DY\n", until="READY")

    def say(self, text, until=None, quiet=1.0):
        """What the terminal shows after `text` was typed: up to a word, or until it has been quiet."""
        os.write(self.terminal, text.encode())
        shown, end = "", time.monotonic() + 30
        while time.monotonic() < end and (until is None or until not in shown):
            if not select.select([self.terminal], [], [], quiet if until is None else 0.2)[0]:
                if until is None:
                    break
                continue
            shown += os.read(self.terminal, 65536).decode("utf-8", "replace")
        return shown

    def offers(self, words):
        line = " ".join(["burnish", *words])
        shown = self.say(line + "\t\t")
        self.say("\x15")
        shown = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]|[\x07\x08]", " ", shown)
        return shown.replace("\\ ", " ")

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.terminal)


@scenario("completion")
def zsh_offers_what_the_tables_say(box):
    if not has_shell("zsh"):
        return
    script(box, "zsh")
    zsh = Zsh(box)
    try:
        for words, wanted, unwanted in ASKED:
            shown = zsh.offers(words)
            absent = [w for w in wanted if w not in shown]
            # What is typed already is not shown again.
            absent = [w for w in absent if not (words[-1] and w.startswith(words[-1]) and w[len(words[-1]):] in shown)]
            present = [w for w in unwanted if re.search(rf"(?<![\w.-]){re.escape(w)}(?![\w.-])", shown.replace("burnish " + " ".join(words[:-1]), ""))]
            expect(not absent and not present, f"zsh: burnish {words}: absent {absent}, present {present}\n{shown!r}")
    finally:
        zsh.close()


@scenario("completion")
def every_suffix_that_is_offered_is_taken(box):
    """The lists of suffixes are for completion and manuals; the program judges by its own."""
    tables = re.findall(r"\| (?:`-\w`, )?`(--[a-z-]+) [^`]*` \| a file: ([^|]*) \|", box.succeed(["man", "--markdown"]).text())
    expect(len(tables) > 10, f"too few files among the options: {tables}")
    takes = {"--output": [], "--output-defects": ["check"], "--truth": ["example", "sphere", "-o", "x.stl"]}
    for command in ["clean", "check", "compare", "field", "curvature", "mesh", "example"]:
        section = re.search(rf"\n## {command}\n(.*?)(\n## |\Z)", box.succeed(["man", "--markdown"]).text(), re.S)[1]
        found = re.search(r"`(--output(?:-defects)?) [^`]*` \| a file: ([^|]*) \|", section)
        option, suffixes = found[1], re.findall(r"`(\.\w+)`", found[2])
        operands = {"example": ["sphere"], "compare": ["missing.stl", "missing.stl"]}.get(command, ["missing.stl"])
        for suffix in suffixes:
            result = box.run([command, *operands, option, f"out{suffix}"])
            # Nothing is wrong with the name of the output: the run comes as far as the input that is missing (a library may be missing, too).
            expected = 0 if command == "example" else 3
            expect(result.code == expected or "built without" in result.messages(), f"{command} {option} out{suffix}: exit code {result.code}\n{result.messages()}")
        refused = box.run([command, *operands, option, "out.xyz"])
        expect(refused.code == 2, f"{command} {option} out.xyz: exit code {refused.code}")


def commands_of(box):
    listed = box.succeed(["help"]).text().split("Commands:\n")[1]
    return [line.split()[0] for line in listed.splitlines() if line.startswith("  ") and not line.startswith("  help")]


def options_in_help(box, command):
    return re.findall(r"^  (?:-\w, |    )(--[a-z-]+)(?: (\S+))?$|^  (?:-\w, |    )(--[a-z-]+)(?: (\S+))?  ", box.succeed(["help", command]).text(), re.M)


@scenario("manual")
def the_manual_page_has_every_option_of_every_command(box):
    page = box.succeed(["man"]).text()
    sections = {name: text for name, text in re.findall(r'\.SS "burnish ([a-z]+)"\n(.*?)(?=\n\.S[SH] )', page, re.S)}
    commands = commands_of(box)
    expect(set(sections) == set(commands), f"commands of the page {sorted(sections)}, of the program {sorted(commands)}")
    for command in commands:
        rows = [(a or c, b or d) for a, b, c, d in options_in_help(box, command)]
        expect(rows, f"no options in the help of {command}")
        terms = set(re.findall(r"^(?:\\fB\\-\w\\fR, )?\\fB(\S+)\\fR(?: \\fI(.*)\\fR)?$", sections[command], re.M))
        told = {(name.replace("\\-", "-"), value.replace("\\-", "-")) for name, value in terms}
        expect(set(rows) == told, f"{command}: in help alone {set(rows) - told}, in the page alone {told - set(rows)}")


@scenario("manual")
def the_manual_page_is_well_formed(box):
    page = box.succeed(["man"])
    box.write("burnish.1", page.out)
    for name in ["NAME", "SYNOPSIS", "DESCRIPTION", "COMMANDS", "EXIT STATUS", "ENVIRONMENT", "FILES", "EXAMPLES", "SEE ALSO"]:
        expect(f"\n.SH {name}\n" in page.text(), f"no section {name}")
    for linter in (["mandoc", "-T", "lint", "-W", "warning", "burnish.1"], ["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", "burnish.1"]):
        if not shutil.which(linter[0]):
            print(f"  skipped: no {linter[0]} (scripts/bootstrap test)")
            continue
        result = subprocess.run(linter, cwd=box.folder, capture_output=True, text=True, env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})
        complaints = result.stderr + (result.stdout if linter[0] == "mandoc" else "")
        expect(result.returncode == 0 and not complaints, f"{' '.join(linter)}\n{complaints}")


@scenario("manual")
def the_documented_options_are_those_of_the_program(box):
    expected = Path(__file__).resolve().parents[2] / "docs" / "options.md"
    expect(box.succeed(["man", "--markdown"]).text() == expected.read_text(), "docs/options.md is not current: run scripts/generate_docs")


@scenario("version")
def the_version_tells_how_it_was_built(box):
    text = box.succeed(["--version"]).text()
    facts = json.loads(box.succeed(["--version", "--json"]).text())
    expect(text.splitlines()[0] == f"burnish {facts['version']}" and re.fullmatch(r"\d+\.\d+\.\d+", facts["version"]), text)
    rows = {line[:14].strip(): line[14:] for line in text.splitlines()[1:]}
    expect(rows == {"commit": facts["commit"] or "unknown", "compiler": facts["compiler"], "build type": facts["build_type"] or "none",
                    "parallel": facts["parallel"], "licence": "GPL-3.0-or-later", **{n: v or "no" for n, v in facts["dependencies"].items()}}, text)
    expect({"CGAL", "Eigen", "fmt", "zlib", "OpenVDB", "CGNS"} <= set(facts["dependencies"]), str(facts))
    expect(not re.search(r"/(home|work|build|tmp|usr)/|\d\d:\d\d", text), f"a path or a time: {text}")
