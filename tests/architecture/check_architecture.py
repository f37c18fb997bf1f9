#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Checks what docs/architecture.md promises of the modules:

- a module includes only modules above it in src/CMakeLists.txt;
- a public header (include/pcavr/ROOM/MODULE) includes no third-party library but Eigen;
- a private header (src/ROOM/MODULE) is included by its own module only, by its tests (tests/MODULE)
  and by the fuzzers, which feed the parsers of many modules;
- no two types of a named namespace have the same name, which would violate the one definition rule;
- every test, file, module and function that docs/papers.md names exists;
- src/README.md has every module in one room, each room a README.md, and it names no file that does not
  exist;
- the table of docs/architecture.md has the modules in the order of src/CMakeLists.txt.

    check_architecture.py [ROOT]         # default: this repository
    check_architecture.py --self-check   # finds each of its planted faults
"""
import pathlib
import re
import sys
import tempfile

HEAVY = re.compile(r"<(opencv2/|pcl/|octomap/|ceres/|apriltag/|embree3/|assimp/|fmt/|yaml-cpp/|nlohmann/|"
                   r"tbb/|zstd|lz4|bzlib|sqlite3|bullet/|btBullet|png\.h|SDL|spnav|boost/|openssl/|urdf|tinyxml|console_bridge|kdl/|zmq|dds/|fastdds/)")
INCLUDE = re.compile(r'^#include (["<][^">]+[">])', re.MULTILINE)
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'')
NAMED_TEST = re.compile(r"`([A-Z]\w+)\.([A-Z]\w+)`")
NAMED_PATH = re.compile(r"`([\w.-]+(?:/[\w.-]+)+)`")
NAMED_SYMBOL = re.compile(r"`([A-Za-z]\w*(?:_\w+|::\w+))`")
FOLDERS = "apps bench calib demo docs python samples scripts src test tests".split()
SCOPE = re.compile(r"namespace\s*([\w:]*)\s*\{"
                   r"|\b(?:struct|class|enum(?:\s+class)?)\s+(?:\[\[\w+\]\]\s*)?(\w+)(?:\s+final)?"
                   r"\s*(?::(?!:)[^;{(]*)?\{"
                   r"|([{}])")


def sources(root, *folders):
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".cpp", ".hpp", ".inl"):
                yield path


def modules_of(root):
    """The folder below src of each module, in the order in which they may use each other."""
    listed = root / "src/CMakeLists.txt"
    rooms = re.findall(r"^pcavr_add_room\(([\w ]+)\)", listed.read_text() if listed.exists() else "", re.MULTILINE)
    modules = {}
    for room, *inside in (line.split() for line in rooms):
        modules.update({module: f"{room}/{module}" for module in inside} if inside else {room: room})
    return modules


def names_of(modules):
    """Of modules and rooms."""
    return list(modules) + [folder.split("/")[0] for folder in modules.values()]


def module_of(modules, folder):
    """The module that has a folder below src or include/pcavr; empty where none has."""
    return next((module for module, path in modules.items() if f"{folder}/".startswith(f"{path}/")), "")


def owner_of(root, modules, path):
    """The module of a file below include/pcavr, src or tests; of others its top folder."""
    top, *rest = path.relative_to(root).parts
    if top in ("include", "src"):
        return module_of(modules, "/".join(rest[1:] if top == "include" else rest))
    return rest[0] if top == "tests" else top


def include_faults(root, modules, path):
    own = owner_of(root, modules, path)
    order = list(modules)
    top = path.relative_to(root).parts[0]
    for included in INCLUDE.findall(path.read_text()):
        name = included.strip('"<>')
        if top == "include" and HEAVY.match(included):
            yield f"{path}: a public header includes a heavy library: {included}"
        if name.startswith("pcavr/") and name.count("/") > 1:
            used = module_of(modules, name.removeprefix("pcavr/"))
            if top in ("include", "src") and (not used or order.index(used) > order.index(own)):
                yield f"{path}: {own} may not include {used or 'this'}: {included}"
        elif (root / "src" / name).exists() and module_of(modules, name) not in ("", own) and own != "fuzz":
            yield f"{path}: a private header of {module_of(modules, name)}: {included}"


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


def path_exists(root, modules, name):
    """A path of the repository, of src or include/pcavr, or MODULE/FILE, without its suffix."""
    if (root / name).exists():
        return True
    module, _, file = name.partition("/")
    places = [name, f"{modules[module]}/{file}"] if module in modules else [name]
    return any((root / folder / f"{place}{suffix}").exists()
               for folder in ("include/pcavr", "src") for place in places for suffix in ("", ".hpp", ".cpp"))


def missing_of_papers(root, modules):
    papers = root / "docs/papers.md"
    if not papers.exists():
        return
    text = papers.read_text()
    names = names_of(modules)
    tests = "".join(path.read_text() for path in sources(root, "tests"))
    for suite, case in NAMED_TEST.findall(text):
        if not re.search(rf"\bTEST\w*\({suite},\s*{case}\)", tests):
            yield f"{papers}: no test {suite}.{case}"
    for name in NAMED_PATH.findall(text):
        if name.split("/")[0] in FOLDERS + names and not path_exists(root, modules, name):
            yield f"{papers}: no file {name}"
    code = "".join(f"{path.stem}\n{path.read_text()}" for path in sources(root, "include", "src", "apps", "tests"))
    for name in NAMED_SYMBOL.findall(text):
        if not re.search(rf"\b{name.split('::')[-1]}\b", code):
            yield f"{papers}: nothing is called {name}"


def faults_of_map(root, modules):
    """Of src/README.md, which leads from a task to a folder."""
    page = root / "src/README.md"
    if not page.exists():
        return
    text = page.read_text()
    names = names_of(modules)
    rooms = re.search(r"\n\| ---.*?\n\n", text, re.DOTALL)
    listed = re.findall(r"`(\w+)`", rooms.group() if rooms else "")
    for module in modules:
        if listed.count(module) != 1:
            yield f"{page}: {module} is in {listed.count(module)} rooms"
    for room in {folder.split("/")[0] for folder in modules.values()}:
        if not (root / "src" / room / "README.md").exists():
            yield f"{page}: {room} has no README.md"
    for name in NAMED_PATH.findall(text):
        if name.split("/")[0] in FOLDERS + names + ["include"] and not path_exists(root, modules, name):
            yield f"{page}: no file {name}"


def faults_of_table(root, modules):
    page = root / "docs/architecture.md"
    if not page.exists():
        return
    listed = re.findall(r"^\| `(\w+)` \|", page.read_text(), re.MULTILINE)
    if listed != list(modules):
        at = next((pair for pair in zip(listed + [""], list(modules) + [""]) if pair[0] != pair[1]))
        yield f"{page}: {at[0] or 'nothing'} stands where {at[1] or 'nothing'} is next"


def faults_of(root):
    modules = modules_of(root)
    found = [fault for path in sources(root, "include", "src", "apps", "bench", "python", "tests")
             for fault in include_faults(root, modules, path)]
    return (found + list(duplicate_faults(root)) + list(missing_of_papers(root, modules))
            + list(faults_of_map(root, modules)) + list(faults_of_table(root, modules)))


ROOMS = "pcavr_add_room(base core geometry)\npcavr_add_room(view scene)\npcavr_add_room(serve)\n"
PLANTED = {  # by the fault that must be found: the files that have it
    "core may not include serve": {"src/base/core/a.cpp": '#include "pcavr/serve/server.hpp"\n'},
    "core may not include geometry": {"src/base/core/a.cpp": '#include "pcavr/base/geometry/pose.hpp"\n'},
    "serve may not include this": {"src/serve/a.cpp": '#include "pcavr/core/a.hpp"\n'},
    "heavy library": {"include/pcavr/base/core/a.hpp": "#include <yaml-cpp/yaml.h>\n"},
    "private header of core": {"src/base/core/b.hpp": "", "src/view/scene/a.cpp": '#include "base/core/b.hpp"\n'},
    "private header of scene": {"src/view/scene/b.hpp": "", "apps/a.cpp": '#include "view/scene/b.hpp"\n'},
    "python/a.cpp: a private header of scene": {"src/view/scene/b.hpp": "", "python/a.cpp": '#include "view/scene/b.hpp"\n'},
    "pcavr::Page is defined in": {"src/serve/a.hpp": "namespace pcavr {\nstruct Page {};\n}\n",
                                  "src/serve/b.hpp": "namespace pcavr {\nclass Page { };\n}\n"},
    "no test Core.IsMissing": {"docs/papers.md": "`Core.IsMissing`\n",
                               "tests/core/a_test.cpp": "TEST(Core, IsThere) {}\n"},
    "no file core/lost": {"docs/papers.md": "`core/lost`\n", "src/base/core/found.cpp": ""},
    "no file bench/lost.py": {"docs/papers.md": "`bench/lost.py`\n"},
    "scene is in 0 rooms": {"src/README.md": "\n| --- |\n| `core`, `geometry`, `serve` |\n\n"},
    "view has no README.md": {"src/README.md": "\n| --- |\n| `core`, `geometry`, `scene`, `serve` |\n\n"},
    "scene stands where geometry is next": {"docs/architecture.md": "| `core` | a |\n| `scene` | b |\n"},
    "no file core/gone": {"src/README.md": "`core/gone`\n", "src/base/core/found.cpp": ""},
    "nothing is called lost_and_found": {"docs/papers.md": "`lost_and_found`\n"},
}
PLAIN = {
    "docs/papers.md": "as `Core.IsTested`, `teleop.switch`, `core/b`, `tests/core`, `link/2.0-x y` and `A::B` show\n",
    "tests/core/c_test.cpp": "TEST_F(Core, IsTested) {}\n",
    "include/pcavr/base/core/a.hpp": "namespace pcavr {\nclass A { class B; };\n}\n",
    "src/base/core/b.hpp": "namespace pcavr {\nnamespace {\nstruct Local {};\n}\nclass A::B { };\n}\n",
    "src/base/core/b.cpp": '#include "base/core/b.hpp"\nnamespace pcavr {\nnamespace {\nstruct Local {};\n}\n}\n',
    "src/serve/a.cpp": '#include "pcavr/base/core/a.hpp"\n',
    "tests/core/b_test.cpp": '#include "base/core/b.hpp"\n#include "pcavr/serve/server.hpp"\n',
}


def faults_in(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in {"src/CMakeLists.txt": ROOMS, **files}.items():
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
