#!/usr/bin/env python3
"""Pages of `burnish --html`, looked at by a headless Chromium.

  run.py --program BURNISH --group NAME     opens, views, places, text, names, failure, speed

Exit 77, skipped, where Chromium, its driver or selenium are not installed.
"""
import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
try:
    import browser
    from selenium.webdriver import ActionChains
except ImportError:
    print("selenium is not installed (python3-selenium): skipped")
    sys.exit(77)

# The pixels of a half of the canvas: how many different colours there are among those that are drawn on, and a sum that tells pictures apart.
PIXELS = """
const view = state.view, gl = view.renderer.getContext();
view.draw();
const w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, half = Math.floor(w / 2), x = arguments[0] * half;
const data = new Uint8Array(4 * half * h);
gl.readPixels(x, 0, half, h, gl.RGBA, gl.UNSIGNED_BYTE, data);
let sum = 0, drawn = 0; const colors = new Set();
for (let i = 0; i < data.length; i += 4) {
  if (data[i + 3] === 0) continue;
  ++drawn;
  colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
  sum = (sum * 31 + i + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 2147483647;
}
return {share: drawn / (half * h), colors: colors.size, sum};
"""


def expect(condition, message):
    if not condition:
        raise AssertionError(message)


class Work:
    """A folder, the program, and one browser."""

    def __init__(self, program):
        self.program = str(Path(program).resolve())
        self.scope = tempfile.TemporaryDirectory(prefix="burnish-html-")
        self.folder = Path(self.scope.name)
        self.driver = browser.start()
        browser.block_network(self.driver)

    def close(self):
        self.driver.quit()
        self.scope.cleanup()

    def run(self, *arguments, code=0):
        done = subprocess.run([self.program, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=600)
        expect(done.returncode == code, f"{arguments}: exit {done.returncode}, not {code}: {done.stderr}")
        return done

    def vase(self):
        """A vase with four holes, cleaned: the page and the report."""
        self.run("example", "vase", "--holes", "4", "--seed", "2", "-o", "vase.stl")
        self.run("vase.stl", "-o", "clean.stl", "--html", "r.html", "--report", "r.json", "-q")
        return self.folder / "r.html", json.loads((self.folder / "r.json").read_text())

    def open(self, page):
        seconds = browser.open_page(self.driver, page)
        self.expect_quiet(page)
        return seconds

    def expect_quiet(self, page):
        log = self.driver.get_log("browser")
        expect(not log, f"{page}: messages on the console: {log}")

    def js(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def pixels(self, side):
        return self.js(PIXELS, side)

    def text(self):
        return self.js("for (const d of document.querySelectorAll('details')) d.open = true; return document.body.innerText")


def test_opens(work):
    page, _ = work.vase()
    work.open(page)
    source = page.read_text()
    expect(not re.search(r"""(src|href)\s*=\s*["']""", source.split("<script")[0]), "the page refers to other files")
    expect(source.count("<script") == source.count("</script>") == 4, "there are other scripts than the page's own")
    expect("default-src 'none'" in source, "the page may ask the network")
    resources = work.js("return performance.getEntriesByType('resource').map(e => e.name)")
    expect(not resources, f"the page asks for {resources}")
    for side in (0, 1):
        found = work.pixels(side)
        expect(0.05 < found["share"] < 0.8 and found["colors"] > 50, f"side {side}: {found}")
    expect(work.js("const gl = state.view.renderer.getContext(); return gl.getError()") == 0, "WebGL has an error")


def test_views(work):
    page, _ = work.vase()
    work.open(page)
    canvas = work.driver.find_element("id", "canvas")
    size, before = canvas.size, [work.pixels(s) for s in (0, 1)]
    camera = work.js("return burnish.camera()")
    # A drag on either half turns both.
    for half in (-0.25, 0.25):
        ActionChains(work.driver).move_to_element_with_offset(canvas, int(half * size["width"]), 0).click_and_hold().move_by_offset(60, 25).release().perform()
        after, turned = [work.pixels(s) for s in (0, 1)], work.js("return burnish.camera()")
        for s in (0, 1):
            expect(after[s]["sum"] != before[s]["sum"], f"a drag at {half} does not turn side {s}")
        expect(turned["position"] != camera["position"] and turned["target"] == camera["target"], "a drag moves what is looked at")
        before, camera = after, turned
    work.js("document.getElementById('plain').click()")
    plain = work.pixels(1)
    expect(plain["sum"] != before[1]["sum"], "plain and deviation look the same")
    expect(not work.driver.find_element("id", "legend").is_displayed(), "a legend without colours")
    work.js("document.getElementById('deviation').click()")
    expect(work.pixels(1)["sum"] == before[1]["sum"], "deviation does not come back")
    expect(work.driver.find_element("id", "legend").is_displayed(), "colours without a legend")
    work.js("document.getElementById('wireframe').click()")
    wires = work.pixels(0)
    expect(wires["sum"] != before[0]["sum"], "no wireframe")
    work.js("document.getElementById('marks').click()")
    expect(work.pixels(0)["sum"] != wires["sum"], "marks stay")


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


def test_places(work):
    page, report = work.vase()
    work.open(page)
    diagonal = report["before"]["box"]["diagonal"]
    places = work.js("return burnish.places.map(p => ({kind: p.kind, position: p.position, radius: p.radius}))")
    kinds = [p["kind"] for p in places]
    expect(kinds.count("open_loop") == report["before"]["open_loops"] == 4, f"places: {kinds}")
    expect(kinds.count("hole") == report["holes"]["count"], f"places: {kinds}")
    expect(kinds.count("change") == report["changes"]["count"], f"places: {kinds}")
    work.text()  # opens all lists
    buttons = work.driver.find_elements("css selector", "#places button")
    expect(len(buttons) == len(places), f"{len(buttons)} buttons for {len(places)} places")
    for place, button in zip(places, buttons):
        button.click()
        work.driver.execute_async_script("""const done = arguments[0];
          (function wait() { burnish.camera().flying ? requestAnimationFrame(wait) : done(); })();""")
        camera = work.js("return burnish.camera()")
        expect(distance(camera["target"], place["position"]) < 1e-5 * diagonal, f"{place}: the camera looks at {camera['target']}")
        expect(distance(camera["position"], camera["target"]) < max(4 * diagonal, 8 * place["radius"]), f"{place}: the camera is far away")
        expect(button.get_attribute("aria-pressed") == "true", f"{place}: not highlighted")
        expect(work.js("return state.view.rings.every(r => r.visible)"), f"{place}: no ring")
    # The rims of the holes: red lines where the report has open edges, at the places they have in the file.
    lines = work.js("return drawing.before.marks.open_loop.lines.count")
    expect(lines == report["before"]["open_edges"], f"{lines} lines for {report['before']['open_edges']} open edges")
    work.expect_quiet(page)


def terminal_number(value):
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def test_text(work):
    page, report = work.vase()
    work.open(page)
    rows = work.js("""return [...document.querySelectorAll('#counts tbody tr')].map(r => [...r.children].map(c => c.textContent))""")
    keys = ["facets", "points", "components", "open_edges", "open_loops", "non_manifold_edges", "non_manifold_points", "misoriented_edges", "misnested_shells",
            "degenerate_facets", "duplicate_facets", "self_intersecting_pairs", "volume", "area", "mean_edge"]
    for key, row in zip(keys, rows):
        wanted = [terminal_number(report[side][key]) for side in ("before", "after")]
        expect(row[1:] == wanted, f"{key}: the page says {row}, the report {wanted}")
    text = work.text()
    for said in ("a valid solid", report["method_reason"], report["output"]["file"], "memory bytes", str(report["options"]["memory_bytes"])):
        expect(said in text, f"the page does not say '{said}'")
    for stage in report["stages"]:
        expect(stage["name"] in text, f"the page has no stage '{stage['name']}'")
    back = report["deviation"]["output_to_input"]
    for key in ("max", "mean", "rms"):
        expect(f"{back[key]:.3g}" in text, f"the page has no deviation {key}")
    for word in ("NaN", "undefined", "null", "Infinity", "[object"):
        expect(word not in text, f"the page says '{word}'")
    embedded = work.js("return document.getElementById('report-data').textContent")
    expect(json.loads(embedded) == report, "the report in the page is not that of --report")


def test_names(work):
    work.run("example", "vase", "--holes", "1", "-o", "vase.stl")
    names = ["<img src=x onerror=document.title='bad'>.stl", "<script>document.title='bad'</script>.stl", "</script><script>document.title='bad'</script>.stl", "{{report}}.stl", "--><!--<script>.stl", "Düse \u2028漢字 & 'x' \"y\".stl"]
    for i, name in enumerate(names):  # what is before a '/' is a folder
        (work.folder / name).parent.mkdir(parents=True, exist_ok=True)
        os.link(work.folder / "vase.stl", work.folder / name)
        work.run(f"./{name}", "-o", f"clean{i}.stl", "--html", f"name{i}.html", "-q")
        page = work.folder / f"name{i}.html"
        work.open(page)
        title = work.js("return document.getElementById('title').textContent")
        expect(title == name.split("/")[-1], f"{name!r} is shown as {title!r}")
        expect(work.driver.title != "bad", f"{name!r} was run")
        expect(page.read_text().count("</script>") == 4, f"{name!r} ends a script element")
        expect(work.js("return document.querySelectorAll('img').length") == 0, f"{name!r} became an element")


def test_failure(work):
    (work.folder / "sheet.stl").write_text("solid s\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n")
    work.run("sheet.stl", "-o", "x.stl", "--html", "f.html", "--report", "f.json", "-q", code=5)
    expect(not (work.folder / "x.stl").exists(), "a result that failed was written")
    report = json.loads((work.folder / "f.json").read_text())
    work.open(work.folder / "f.html")
    text = work.text()
    expect("not written" in text and report["failure"]["message"] in text and report["failure"]["hint"] in text, f"the page does not tell the failure: {text}")
    expect("no surface was found" in text, "an empty half says nothing")
    expect("NaN" not in text, "the page says NaN")
    expect(work.pixels(0)["share"] > 0.02 and work.pixels(1)["share"] == 0, "the input is not drawn, or something else is")
    expect(work.js("return document.getElementById('deviation').disabled"), "deviation from nothing")


def cpu_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def idle_share():
    """Of the processors' time during one second: 1 when nothing else runs."""
    def ticks():
        fields = [int(f) for f in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]]
        return fields[3] + fields[4], sum(fields[:8])
    idle, total = ticks()
    time.sleep(1)
    idle_after, total_after = ticks()
    return (idle_after - idle) / max(1, total_after - total)


def expect_first_frame(work, page, seconds):
    """Within that time, at the best of three. It is a matter of the clock, so a machine that is busy with something else is not judged."""
    idle = idle_share()
    best = min(work.open(page) for _ in range(3))
    print(f"{page.name}: first frame after {best:.2f} s, processors {100 * idle:.0f} % idle before")
    expect(idle < 0.7 or best <= seconds, f"{page.name}: its first frame takes {best:.2f} s, and may take {seconds}")


def test_speed(work):
    page, _ = work.vase()
    expect_first_frame(work, page, 2)
    work.run("example", "nozzle", "--holes", "12", "-o", "n.stl")
    spent = []
    for more in ([], ["--html", "n.html"]):
        before = cpu_of_children()
        work.run("n.stl", "-o", "c.stl", "--overwrite", "--smooth", "2%", "-q", *more)
        spent.append(cpu_of_children() - before)
    large = work.folder / "n.html"
    print(f"n.html: {large.stat().st_size / 1e6:.1f} MB; CPU seconds without and with it: {spent[0]:.2f}, {spent[1]:.2f}")
    expect(large.stat().st_size <= 15e6, "the nozzle's page has more than 15 MB")
    expect(spent[1] < 1.25 * spent[0], f"--html takes more than a quarter: {spent}")
    expect_first_frame(work, large, 3)
    expect("drawn simplified" in work.text(), "the page does not say that it simplifies")
    for side in (0, 1):
        expect(work.pixels(side)["colors"] > 50, f"the nozzle's side {side} is not drawn")


def main():
    groups = {name[5:]: test for name, test in globals().items() if name.startswith("test_")}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--group", required=True, choices=groups)
    arguments = parser.parse_args()
    if browser.is_missing():
        print("Chromium or its driver is not installed (chromium, chromium-driver): skipped")
        sys.exit(77)
    work = Work(arguments.program)
    try:
        groups[arguments.group](work)
    finally:
        work.close()


main()
