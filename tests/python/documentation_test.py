"""The examples of docs/python.md run, in order, as they stand."""
import re


def test_examples_run(source, tmp_path, monkeypatch):
    text = (source / "docs" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert len(blocks) >= 8
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)


def test_readme_example_runs(source, tmp_path, monkeypatch):
    text = (source / "README.md").read_text(encoding="utf-8")
    block = re.search(r"From Python.*?```python\n(.*?)```", text, re.S).group(1)
    import burnish
    from conftest import CUBE_FACES, CUBE_VERTICES
    monkeypatch.chdir(tmp_path)
    burnish.write("dirty.stl", CUBE_VERTICES, CUBE_FACES[1:])
    exec(compile(block, "README.md", "exec"), {})
    assert burnish.check("clean.ply")
