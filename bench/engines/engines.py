#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""What do engines make of an exported world, on pushes that gave none of its numbers, and on a body alone?

    bench/engines/engines.py --data DATA/plants --pcavr build/test/apps/pcavr/pcavr
                             [--engines mujoco,physx,rapier,bullet,ode,dart | none] [--only REGEX] [--tests N]
                             [--experiments push driven ...] [--settings export ...]
                             [--work out/engine-table] [--json FILE]

Below DATA as for pushes.py. Parameters are identified, each test is built and exported, and each
engine simulates with each setting: the recorded pushes, and for the first test of an object its body
alone: turned, let slide, pulled by a growing force and by half of the limiting one, pressed. Rows of
the engine "none" have what the identified friction alone gives, which bounds what an engine can. Printed
as a table of Markdown: medians of the figures' absolute values. Needs python3, node, npm, a C++
compiler, and Debian's libbullet-dev, libode-dev, libdart-dev, libdart-collision-ode-dev and
nlohmann-json3-dev; docs/engines.md has what the settings are.
"""
import json
import math
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(HERE.parent))
from command import recordings_parser, run  # noqa: E402
from driven import DrivenBody, rows_by_law  # noqa: E402
from experiments import FIGURES, MIN_SAMPLES, RecordedPush, canonical, push_experiment  # noqa: E402
from pushes import Bench, cases_in  # noqa: E402
from quasi_static import LimitSurface, ellipsoid, identified_surface, quasi_static_rows, surface_error  # noqa: E402
from sdf_world import BEST, DEFAULTS, EXPORT, MU_ALONE, read_world, with_setting  # noqa: E402

# What an engine with exactly the identified friction would give: driven, pushed, and with the measured contact.
LAW_ALONE = ("none", "identified law")
SURFACE_ALONE = ("none", "limit surface")
MEASURED_CONTACT = ("none", "limit surface, measured contact")
EXPERIMENTS = ["push", "driven", *FIGURES]
SETTINGS = [DEFAULTS, MU_ALONE, EXPORT, BEST]
# Options of an engine's program by setting; none: its library's defaults.
GAZEBO = {"quick": True, "iterations": 50}
BULLET = {"iterations": 50, "two_directions": True, "plane": True}
OPTIONS = {
    "physx": {DEFAULTS: {"solver": "pgs"}, MU_ALONE: {"solver": "pgs"}, EXPORT: {"solver": "tgs"},
              BEST: {"solver": "tgs", "positionIterations": 16, "velocityIterations": 4}},
    "rapier": {BEST: {"iterations": 16}},
    "bullet": {EXPORT: BULLET, BEST: {**BULLET, "compliant": True, "feet_friction": True}},
    "ode": {DEFAULTS: GAZEBO, MU_ALONE: GAZEBO, EXPORT: {**GAZEBO, "compliant": True},
            BEST: {"compliant": True, "along": True}},
    "dart": {BEST: {"along": True}},
}
# What an engine's program needs beside what pkg-config says; DART's asks for C++11.
FLAGS = {"dart": ["-ldart-collision-ode", "-std=c++20"]}
BEYOND = 1000.0  # larger figures are those of rigid contacts, for instance
COLUMNS = [("force", 100.0, "force"), ("waveform", 100.0, "waveform"), ("end", 1.0, "end"),
           ("heading", 1.0, "heading"), ("offcentre", 1.0, "off-centre"), ("breakaway", 100.0, "breakaway"), ("turn", 100.0, "turning"),
           ("slide", 100.0, "slid"),
           ("driven", 100.0, "driven"), ("creep", 1.0, "creep"), ("press", 100.0, "N/m")]


def compiled(name, work):
    """The program of an engine in C++, built in a folder where it is not newer than its sources."""
    binary = work / f"{name}_engine"
    sources = [HERE / f"{name}_engine.cpp", HERE / "experiment.hpp", pathlib.Path(__file__)]
    if not binary.exists() or binary.stat().st_mtime < max(each.stat().st_mtime for each in sources):
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", name], check=True, capture_output=True,
                               text=True).stdout.split()
        subprocess.run(["c++", "-std=c++20", "-O2", sources[0], "-o", binary, *flags, *FLAGS.get(name, [])],
                       check=True)
    return binary


def answers_of(program, jobs, file):
    """Rows by the jobs' ids."""
    file.write_text("".join(json.dumps(job) + "\n" for job in jobs))
    done = subprocess.run([*program, file], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{program}: {done.stderr.strip()[-300:]}")
    answers = (json.loads(line) for line in done.stdout.splitlines() if line.startswith("{"))
    return {tuple(answer["id"]): answer["rows"] for answer in answers}


class Engines(Bench):
    """The engines' programs, and the jobs that they are given."""

    def __init__(self, arguments):
        super().__init__(arguments)
        self.programs = {name: self.program(name) for name in arguments.engines.split(",") if name != "none"}

    def program(self, name):
        script = HERE / f"{name}_engine.mjs"
        return ["node", script, self.tools] if script.exists() else [compiled(name, self.arguments.work)]

    def worlds(self, test, parameters, work):
        """The folders of a test's world as MJCF and SDF."""
        mjcf = self.world(test, parameters, work)
        sdf = work / "sdf"
        shutil.rmtree(sdf, ignore_errors=True)
        run(self.arguments.pcavr, "export", work / "scene", "--parameters", parameters, "--to", "sdf",
            "--motion", test, "-o", sdf)
        return mjcf, sdf

    def judge_test(self, test, folders, parameters, has_canonical, work):
        """Figures of a test by engine and setting."""
        mjcf, sdf = folders
        world, manifest = read_world(sdf)
        push = RecordedPush(test, manifest["bodies"][0]["name"])
        if len(push.samples) < MIN_SAMPLES:
            raise RuntimeError("the body hardly slides")
        experiments = {"push": push_experiment(sdf), "driven": DrivenBody(push, world).experiment()}
        if has_canonical:
            experiments.update(canonical(world, manifest))
        experiments = {name: what for name, what in experiments.items() if name in self.arguments.experiments}
        found, known = {}, manifest["bodies"][0]
        if "driven" in experiments:
            rows = rows_by_law(experiments["driven"], world, known)
            found[LAW_ALONE] = {"driven": push.slid_error(rows)}
        if "push" in experiments:
            surface = LimitSurface(*(identified_surface(parameters) or ellipsoid(known)), known, world["body"])
            found[SURFACE_ALONE] = push.figures(quasi_static_rows(experiments["push"], world, surface))
            found[MEASURED_CONTACT] = {"force": surface_error(push, world, surface)}
        for engine in self.programs:
            jobs = []
            for setting in self.arguments.settings:
                options = (mujoco_options(setting, mjcf) if engine == "mujoco"
                           else OPTIONS[engine].get(setting, {}))
                for name, what in experiments.items():
                    jobs.append({"id": [setting, name], "options": options, "experiment": what,
                                 "world": with_setting(world, manifest, setting)})
            for (setting, name), rows in answers_of(self.programs[engine], jobs, work / "jobs.jsonl").items():
                figures = found.setdefault((engine, setting), {})
                if name == "push":
                    figures.update(push.figures(rows))
                    if test.name.startswith("offcentre"):
                        figures["offcentre"] = figures["heading"]
                elif name == "driven":
                    figures[name] = push.slid_error(rows)
                else:
                    figures[name] = FIGURES[name](rows, world, manifest)
        return found


def mujoco_options(setting, folder):
    return {"setting": "export, by slip speed" if setting == BEST else setting, "folder": str(folder.resolve())}


def collect(engines, arguments):
    """(test, engine, setting, figures) of all tests."""
    results = []
    for name, trains, tests in cases_in(arguments.data):
        if not tests or not re.search(arguments.only, name):
            continue
        work = arguments.work / name
        work.mkdir(parents=True, exist_ok=True)
        parameters = work / "parameters.yaml"
        run(arguments.pcavr, "identify", "friction", *trains, "-o", parameters, "--force")
        for index, test in enumerate(tests[:arguments.tests]):
            try:
                folders = engines.worlds(test, parameters, work / test.name)
                found = engines.judge_test(test, folders, parameters, index == 0, work)
            except (RuntimeError, statistics.StatisticsError) as error:
                print(f"left out: {name}/{test.name}: {error}", file=sys.stderr)
                continue
            results += [{"test": f"{name}/{test.name}", "engine": engine, "setting": setting, **figures}
                        for (engine, setting), figures in found.items()]
            if arguments.json:
                arguments.json.write_text(json.dumps(results, indent=1) + "\n")
            print(f"{name}/{test.name}", file=sys.stderr, flush=True)
    return results


def cell(values, scale):
    """Median absolute value; NaN is "no answer", and beyond what any setting gives."""
    if not values:
        return "-"
    value = statistics.median(math.inf if math.isnan(each) else abs(scale * each) for each in values)
    return f"{value:.1f}" if value < BEYOND else f"> {BEYOND:.0f}"


def print_table(results):
    print("| engine | setting | " + " | ".join(title for _, _, title in COLUMNS) + " |")
    print("| --- " * (len(COLUMNS) + 2) + "|")
    for key in dict.fromkeys((each["engine"], each["setting"]) for each in results):
        chosen = [each for each in results if (each["engine"], each["setting"]) == key]
        cells = [cell([each[figure] for each in chosen if figure in each], scale)
                 for figure, scale, _ in COLUMNS]
        print("| " + " | ".join([*key, *cells]) + " |")


def main():
    parser = recordings_parser(__doc__, "out/engine-table")
    parser.add_argument("--engines", default="mujoco,physx,rapier,bullet,ode,dart")
    parser.add_argument("--tests", type=int, default=None, help="maximum number of tests of a case")
    parser.add_argument("--experiments", nargs="+", choices=EXPERIMENTS, default=EXPERIMENTS)
    parser.add_argument("--settings", nargs="+", choices=SETTINGS, default=SETTINGS)
    parser.add_argument("--json", type=pathlib.Path, help="file for the results, written after each test")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    results = collect(Engines(arguments), arguments)
    if not results:
        print("no test was judged", file=sys.stderr)
        return 1
    print_table(results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
