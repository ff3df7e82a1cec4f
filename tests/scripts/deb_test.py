#!/usr/bin/env python3
"""Makes the Debian packages of a build and looks into them.

  deb_test.py CPACK BUILD_FOLDER BUILD_TYPE

All builds: the program's package: control fields, files, modes. Release builds alone, as the others hold their sources'
paths and a library too large to be packed again and again: the library's package, no path of the build in either, and the
same bytes when it is made once more.
"""
import gzip
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CPACK, BUILD, BUILD_TYPE = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
SOURCE = Path(__file__).resolve().parents[2]
IS_RELEASE = BUILD_TYPE == "Release"

PROGRAM_FILES = {
    "usr/bin/burnish", "usr/share/man/man1/burnish.1.gz", "usr/share/bash-completion/completions/burnish",
    "usr/share/zsh/vendor-completions/_burnish", "usr/share/fish/vendor_completions.d/burnish.fish",
    "usr/share/doc/burnish/README.md", "usr/share/doc/burnish/copyright", "usr/share/doc/burnish/changelog.gz",
    "usr/share/doc/burnish/changelog.Debian.gz"}


def make_packages(folder):
    components = [] if IS_RELEASE else ["-D", "CPACK_COMPONENTS_ALL=program"]
    subprocess.run([CPACK, "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", folder, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=none", *components], check=True, capture_output=True, cwd=BUILD)
    return {path.name.split("_")[0]: path for path in folder.glob("*.deb")}


def fields_of(package):
    text = subprocess.run(["dpkg-deb", "-f", package], check=True, capture_output=True, text=True).stdout
    return dict(re.findall(r"^(\S+): (.*(?:\n .*)*)", text, re.M))


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scope = tempfile.TemporaryDirectory(prefix="burnish-deb-")
        cls.folder = Path(cls.scope.name)
        cls.packages = make_packages(cls.folder / "first")
        for name, package in cls.packages.items():
            subprocess.run(["dpkg-deb", "-x", package, cls.folder / name], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.scope.cleanup()

    def files(self, package):
        root = self.folder / package
        return {p.relative_to(root).as_posix() for p in root.rglob("*") if not p.is_dir()}

    def test_packages_are_those_of_the_components(self):
        python = {"python3-burnish"} if list((BUILD / "python/burnish").glob("_burnish.*.so")) and IS_RELEASE else set()
        self.assertEqual(set(self.packages) - python, {"burnish", "libburnish-dev"} if IS_RELEASE else {"burnish"})

    def test_control_fields(self):
        version = re.search(r"project\(burnish VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        fields = fields_of(self.packages["burnish"])
        self.assertEqual({n: fields[n] for n in ("Package", "Version", "Section", "Priority")},
                         {"Package": "burnish", "Version": f"{version}-1", "Section": "graphics", "Priority": "optional"})
        self.assertRegex(fields["Maintainer"], r"^[^<>]+ <[^<>@ ]+@[^<>@ ]+>$")
        self.assertRegex(fields["Description"], r"\Arepair and smoothing of triangle meshes\n Burnish turns")
        for library in ("libc6", "libstdc++6", "libfmt", "libgmp10", "libmpfr6", "zlib1g"):
            self.assertRegex(fields["Depends"], rf"(^|, ){re.escape(library)}[\d.]* \(>= ")

    def test_files_and_modes_of_the_program(self):
        self.assertEqual(self.files("burnish"), PROGRAM_FILES)
        listed = subprocess.run(["dpkg-deb", "-c", self.packages["burnish"]], check=True, capture_output=True, text=True).stdout
        for line in listed.splitlines():
            mode, owner, *_, name = line.split()
            expected = "drwxr-xr-x" if name.endswith("/") else "-rwxr-xr-x" if name == "./usr/bin/burnish" else "-rw-r--r--"
            self.assertEqual((mode, owner), (expected, "root/root"), name)

    def test_manual_page_changelog_and_sums(self):
        root = self.folder / "burnish"
        self.assertIn(b".TH BURNISH 1", gzip.decompress((root / "usr/share/man/man1/burnish.1.gz").read_bytes()))
        changelog = gzip.decompress((root / "usr/share/doc/burnish/changelog.Debian.gz").read_bytes()).decode()
        self.assertRegex(changelog, r"\Aburnish \([\d.]+-1\) unstable; urgency=medium\n\n(  .*\n)+\n -- .+ <.+>  \w{3}, \d{2} \w{3} \d{4} 00:00:00 \+0000\n\Z")
        control = self.folder / "control"
        subprocess.run(["dpkg-deb", "-e", self.packages["burnish"], control], check=True)
        sums = dict(reversed(line.split(None, 1)) for line in (control / "md5sums").read_text().splitlines())
        self.assertEqual(sums, {name: hashlib.md5((root / name).read_bytes()).hexdigest() for name in PROGRAM_FILES})

    @unittest.skipUnless(IS_RELEASE, "not a Release build")
    def test_files_of_the_library(self):
        files = self.files("libburnish-dev")
        headers = {"usr/" + p.relative_to(SOURCE).as_posix() for p in (SOURCE / "include").rglob("*.h")}
        self.assertLessEqual(headers, files)
        for name in ("libburnish.a", "pkgconfig/burnish.pc", "cmake/burnish/burnishConfig.cmake", "cmake/burnish/burnishConfigVersion.cmake",
                     "cmake/burnish/burnishTargets.cmake"):
            self.assertTrue([f for f in files if f.startswith("usr/lib/") and f.endswith(name)], name)
        depends = fields_of(self.packages["libburnish-dev"])["Depends"].split(", ")
        self.assertLessEqual({"libfmt-dev", "zlib1g-dev", "libgmp-dev", "libmpfr-dev"}, set(depends))

    @unittest.skipUnless(IS_RELEASE, "not a Release build")
    def test_the_python_package(self):
        if "python3-burnish" not in self.packages:
            self.skipTest("built without the Python package")
        module = "usr/lib/python3/dist-packages/burnish/"
        sources = {module + p.name for p in (SOURCE / "src/python/burnish").iterdir() if p.suffix in (".py", ".pyi", ".typed")}
        documents = {f"usr/share/doc/python3-burnish/{name}" for name in ("copyright", "changelog.gz", "changelog.Debian.gz")}
        rest = self.files("python3-burnish") - sources - documents
        self.assertLessEqual(sources | documents, self.files("python3-burnish"))
        self.assertRegex(" ".join(rest), rf"^{module}_burnish\.cpython-\d+-[\w-]+\.so$")
        depends = fields_of(self.packages["python3-burnish"])["Depends"]
        major, minor = re.search(r"cpython-(\d)(\d+)", " ".join(rest)).groups()
        for word in (f"python3 (>= {major}.{minor}~)", f"python3 (<< {major}.{int(minor) + 1}~)", "python3-numpy"):
            self.assertIn(word, depends.split(", "))
        self.assertRegex(depends, r"(^|, )libc6 \(>= ")

    @unittest.skipUnless(IS_RELEASE, "not a Release build")
    def test_no_path_of_the_build_is_inside(self):
        unwanted = [str(SOURCE).encode(), str(BUILD).encode(), str(Path.home()).encode() + b"/"]
        for package in self.packages:
            for name in self.files(package):
                data = (self.folder / package / name).read_bytes()
                data = gzip.decompress(data) if name.endswith(".gz") else data
                self.assertEqual([w for w in unwanted if w in data], [], f"{package}: {name}")

    @unittest.skipUnless(IS_RELEASE, "not a Release build")
    def test_the_same_bytes_again(self):
        for name, package in make_packages(self.folder / "second").items():
            self.assertEqual(package.read_bytes(), self.packages[name].read_bytes(), name)


if __name__ == "__main__":
    for tool in ("dpkg-deb", "dpkg-shlibdeps", "gzip"):
        if not shutil.which(tool):
            print(f"skipped: no {tool} (scripts/bootstrap test)")
            sys.exit(77)
    unittest.main(argv=sys.argv[:1])
