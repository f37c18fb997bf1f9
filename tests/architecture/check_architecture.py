#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Checks what docs/architecture.md promises of the modules:

- a module includes only modules above it in MODULES;
- a public header (include/pcavr/M) includes no third-party library but Eigen;
- a private header (src/M) is included by its own module only, by its tests (tests/M) and by the
  fuzzers, which feed the parsers of many modules;
- no two types of a named namespace have the same name, which would violate the one definition rule;
- every test, file, module and function that docs/papers.md names exists.

    check_architecture.py [ROOT]         # default: this repository
    check_architecture.py --self-check   # finds each of its planted faults
"""
import pathlib
import re
import sys
import tempfile

MODULES = ("core geometry rosbag recording bag_import cloud contact friction object identification model robot "
           "robot_identification arm inputs prediction turning object_identification haptics "
           "devices link teleop sites marker ros2 tracking reconstruction texture scene simulation report evaluation pipeline serve").split()
HEAVY = re.compile(r"<(opencv2/|pcl/|octomap/|ceres/|apriltag/|embree3/|assimp/|fmt/|yaml-cpp/|nlohmann/|"
                   r"tbb/|zstd|lz4|bzlib|sqlite3|bullet/|btBullet|png\.h|SDL|spnav|boost/|openssl/|urdf|tinyxml|console_bridge|kdl/|zmq|dds/|fastdds/)")
INCLUDE = re.compile(r'^#include (["<][^">]+[">])', re.MULTILINE)
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'')
NAMED_TEST = re.compile(r"`([A-Z]\w+)\.([A-Z]\w+)`")
NAMED_PATH = re.compile(r"`([\w.-]+(?:/[\w.-]+)+)`")
NAMED_SYMBOL = re.compile(r"`([A-Za-z]\w*(?:_\w+|::\w+))`")
FOLDERS = "apps bench calib demo docs samples scripts src test tests".split()
SCOPE = re.compile(r"namespace\s*([\w:]*)\s*\{"
                   r"|\b(?:struct|class|enum(?:\s+class)?)\s+(?:\[\[\w+\]\]\s*)?(\w+)(?:\s+final)?"
                   r"\s*(?::(?!:)[^;{(]*)?\{"
                   r"|([{}])")


def sources(root, *folders):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".cpp", ".hpp", ".inl"):
                yield path


def module_of(root, path):
    """The module of a file below include/pcavr, src or tests; of others its top folder."""
    parts = path.relative_to(root).parts
    return parts[2] if parts[0] == "include" else parts[1] if parts[0] in ("src", "tests") else parts[0]


def include_faults(root, path):
    own = module_of(root, path)
    top = path.relative_to(root).parts[0]
    for included in INCLUDE.findall(path.read_text()):
        if top == "include" and HEAVY.match(included):
            yield f"{path}: a public header includes a heavy library: {included}"
        parts = included.strip('"<>').split("/")
        if parts[0] == "pcavr" and len(parts) > 2:
            if top in ("include", "src") and own in MODULES and (
                    parts[1] not in MODULES or MODULES.index(parts[1]) > MODULES.index(own)):
                yield f"{path}: {own} may not include {parts[1]}: {included}"
        elif parts[0] in MODULES and parts[0] != own and own != "fuzz":
            if (root / "src" / "/".join(parts)).exists():
                yield f"{path}: a private header of {parts[0]}: {included}"


def types_of(path):
    """The qualified names of the types that a file defines in named namespaces."""
    scopes = []
    for match in SCOPE.finditer(COMMENT_OR_TEXT.sub("", path.read_text())):
        namespace, type_name, brace = match.groups()
        if brace == "}":
            if scopes:
                scopes.pop()
        elif brace == "{":
            scopes.append(None)
        elif type_name:
            if scopes and all(scopes):
                yield "::".join(scopes + [type_name])
            scopes.append(None)
        else:
            scopes.append(namespace or None)


def duplicate_faults(root):
    first = {}
    for path in sources(root, "include", "src"):
        for name in types_of(path):
            if name in first and first[name] != path:
                yield f"{path}: {name} is defined in {first[name]} too"
            first.setdefault(name, path)


def path_exists(root, name):
    """A path of the repository, or MODULE/FILE without its suffix."""
    if (root / name).exists():
        return True
    return any((root / folder / f"{name}{suffix}").exists()
               for folder in ("include/pcavr", "src") for suffix in ("", ".hpp", ".cpp"))


def missing_of_papers(root):
    papers = root / "docs/papers.md"
    if not papers.exists():
        return
    text = papers.read_text()
    tests = "".join(path.read_text() for path in sources(root, "tests"))
    for suite, case in NAMED_TEST.findall(text):
        if not re.search(rf"\bTEST\w*\({suite},\s*{case}\)", tests):
            yield f"{papers}: no test {suite}.{case}"
    for name in NAMED_PATH.findall(text):
        if name.split("/")[0] in FOLDERS + list(MODULES) and not path_exists(root, name):
            yield f"{papers}: no file {name}"
    code = "".join(f"{path.stem}\n{path.read_text()}" for path in sources(root, "include", "src", "apps", "tests"))
    for name in NAMED_SYMBOL.findall(text):
        if not re.search(rf"\b{name.split('::')[-1]}\b", code):
            yield f"{papers}: nothing is called {name}"


def faults_of(root):
    found = [fault for path in sources(root, "include", "src", "apps", "bench", "tests")
             for fault in include_faults(root, path)]
    return found + list(duplicate_faults(root)) + list(missing_of_papers(root))


PLANTED = {  # by the fault that must be found: the files that have it
    "core may not include serve": {"src/core/a.cpp": '#include "pcavr/serve/server.hpp"\n'},
    "heavy library": {"include/pcavr/core/a.hpp": "#include <yaml-cpp/yaml.h>\n"},
    "private header of core": {"src/core/b.hpp": "", "src/scene/a.cpp": '#include "core/b.hpp"\n'},
    "private header of scene": {"src/scene/b.hpp": "", "apps/a.cpp": '#include "scene/b.hpp"\n'},
    "pcavr::Page is defined in": {"src/serve/a.hpp": "namespace pcavr {\nstruct Page {};\n}\n",
                                  "src/serve/b.hpp": "namespace pcavr {\nclass Page { };\n}\n"},
    "no test Core.IsMissing": {"docs/papers.md": "`Core.IsMissing`\n",
                               "tests/core/a_test.cpp": "TEST(Core, IsThere) {}\n"},
    "no file core/lost": {"docs/papers.md": "`core/lost`\n", "src/core/found.cpp": ""},
    "no file bench/lost.py": {"docs/papers.md": "`bench/lost.py`\n"},
    "nothing is called lost_and_found": {"docs/papers.md": "`lost_and_found`\n"},
}
PLAIN = {
    "docs/papers.md": "as `Core.IsTested`, `teleop.switch`, `core/b`, `tests/core`, `link/2.0-x y` and `A::B` show\n",
    "tests/core/c_test.cpp": "TEST_F(Core, IsTested) {}\n",
    "include/pcavr/core/a.hpp": "namespace pcavr {\nclass A { class B; };\n}\n",
    "src/core/b.hpp": "namespace pcavr {\nnamespace {\nstruct Local {};\n}\nclass A::B { };\n}\n",
    "src/core/b.cpp": '#include "core/b.hpp"\nnamespace pcavr {\nnamespace {\nstruct Local {};\n}\n}\n',
    "tests/core/b_test.cpp": '#include "core/b.hpp"\n#include "pcavr/serve/server.hpp"\n',
}


def faults_in(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return faults_of(root)


def self_check():
    missed = [f"not found: {fault}" for fault, files in PLANTED.items()
              if not any(fault in found for found in faults_in(files))]
    return missed + [f"found in plain files: {fault}" for fault in faults_in(PLAIN)]


def main():
    if sys.argv[1:] == ["--self-check"]:
        faults = self_check()
    else:
        default = pathlib.Path(__file__).resolve().parents[2]
        faults = faults_of(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default)
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
