#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Makes sound recordings wrong by random amounts, and compares what the command states with the truth.

    tests/sweep/contradictions.py --pcavr build/dev/apps/pcavr/pcavr --family rigs --seed 1 --count 200

Families: `rigs` (what is mounted, calibrated, weighed or measured wrongly), `files` (units, orders and frames of
other programs), `logs` (clocks, rates, filters, losses). An input is a simulated recording of pushes, with images,
or of an arm, or one of the folder `plants` of PCAVR_DATA where that is present; one in eight is left as it is.
A trial fails where the command

- succeeds with a value that is more than 4 of its stds off the truth, whether or not it names what is wrong,
- succeeds without a word that names what is wrong, where the data contradict each other by a factor of 1.5 or more,
- or refuses an input that is left as it is.

The family `sound` has sound recordings of random rigs alone (sound_rigs): the command may refuse none, and `doctor`
may not name a disagreement in any.

Where the data of a recording do not show what is wrong, as the force's scale without accelerations, `doctor` has to
say that it was not checked. The same seed and count give the same trials; `--only 17` runs the 17th alone and keeps
its files. Needs only python3.
"""
import argparse
import collections
import concurrent.futures
import dataclasses
import json
import math
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))
import coverage
import sound_rigs
import sources
import wrong_arms
import wrong_recordings
import wrong_scenes
from recorded_tables import Table, forget_counts
from trial import Trial, run_shell

MAX_STDS = 4.0
MAX_FACTOR = 1.5  # contradictions from here on have to be named
NOT_COMPARED = "the force's scale is not compared"  # a note of the command
LEFT_AS_IT_IS = 0.125  # share of the trials
ARM_COULOMB, ARM_VISCOUS = 1.5, 0.8  # of sources.arm_torques
SIMULATED = (("push", ()), ("probe", ()), ("push", ("--wide",)), ("turn", ()), ("press", ()))
FAMILIES = {"rigs": (wrong_recordings.RIGS, wrong_scenes.RIG_SCENES, wrong_arms.RIG_ARMS),
            "files": (wrong_recordings.FILES, wrong_scenes.FILE_SCENES, wrong_arms.FILE_ARMS),
            "logs": (wrong_recordings.LOGS, {}, wrong_arms.LOG_ARMS)}
SHARES = (0.65, 0.2, 0.15)  # of recordings of pushes, with images, of an arm


@dataclasses.dataclass
class Base:
    """A sound recording."""

    path: pathlib.Path
    kind: str
    excites_mass: bool = False
    base_tags: int = 1
    is_wide: bool = False  # sensors as in a workshop, with faults that are corrected


@dataclasses.dataclass
class Outcome:
    exit_code: int
    said: str  # warnings, notes and the error, in lower case
    scores: list  # (error in stds, parameter)


def simulate(pcavr, folder, task, seed, *options):
    done = subprocess.run([pcavr, "simulate", task, "-o", folder, "--seed", str(seed), *options],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"can't simulate {task}: {done.stderr}")
    return folder


def make_pushes(pcavr, folder, seed):
    bases = []
    for i, (task, options) in enumerate(SIMULATED):
        name = f"simulated-{task}-{i}"
        path = simulate(pcavr, folder / name, task, seed + i, "--no-images", *options)
        bases.append(Base(path, task, excites_mass=task == "probe"))
    plants = pathlib.Path(os.environ.get("PCAVR_DATA", ROOT / "../shared/data")).resolve() / "plants"
    for path in sorted(plants.glob("*-*")):
        kind = path.name.partition("-")[0]
        bases.append(Base(path, kind, excites_mass=kind == "probe"))
    return bases


def make_scenes(pcavr, folder, seed):
    few = ("--frames-per-second", "3")
    return [Base(simulate(pcavr, folder / task, task, seed, *few), task, base_tags=tags)
            for task, tags in (("tabletop", 1), ("room", 2))]


def make_arms(folder, seed):
    path = folder / "arm"
    path.mkdir()
    (path / "arm.urdf").write_text(sources.arm_urdf())
    (path / "joints.csv").write_text(sources.arm_log(random.Random(seed), duration=20.0))
    return [Base(path, "arm")]


# Judges


def report_of(output):
    return json.loads((output / "report.json").read_text())


def judge_pushes(report, base):
    scores = {}
    for name, truth in coverage.read_truth(base.path / "truth" / "parameters.yaml").items():
        coverage.score_object(report, name, truth, name, scores)
    return [(z, f"{key} of {where}") for key, score in scores.items() for z, where in score.scores]


def median_distance(found, truth):
    """Of the positions at equal stamps [m]."""
    places = {round(row[0], 4): row[1:4] for row in truth.rows}
    errors = sorted(math.dist(row[1:4], places[round(row[0], 4)]) for row in found.rows if round(row[0], 4) in places)
    return errors[len(errors) // 2]


def judge_scene(built, output, base):
    camera = median_distance(Table(output / "camera_trajectory.txt"), Table(base.path / "truth" / "camera.txt"))
    scores = [(camera / built["camera_position_sigma_m"], f"camera, {1e3 * camera:.1f} mm")]
    for item in built["objects"]:
        truth = Table(base.path / "truth" / "objects" / f"{item['name']}.txt").rows[0]
        if item["evidence"] == "not_seen":
            continue
        error = math.dist(item["t_m"], truth[1:4])
        scores.append((error / item["position_sigma_m"], f"{item['name']}, {1e3 * error:.1f} mm"))
    return scores


def judge_arm(report):
    scores = []
    for joint in ("j1", "j2"):
        for term, truth in (("coulomb", ARM_COULOMB), ("viscous", ARM_VISCOUS)):
            key = f"joint.{joint}.{term}"
            if report.get(f"{key}.is_excited"):
                scores.append((abs(report[key] - truth) / report[f"{key}_std"], f"{key} {report[key]:.3g}"))
    return scores


def words_of(out, err):
    """What is said of the inputs: warnings and errors, and the result's lists of warnings and notes."""
    lines = [line for line in err.splitlines() if "warning" in line or line.startswith("pcavr: ")]
    try:
        result = json.loads(out)
    except ValueError:
        result = {}
    lines += [json.dumps(result.get(key, [])) for key in ("input_warnings", "warnings", "notes")]
    return " ".join(lines).lower()


def run_command(pcavr, base, recording, work):
    output = work / "output"
    if base.kind == "arm":
        args = ["identify", "robot", recording / "joints.csv", "--robot", recording / "arm.urdf", "-o", output]
    elif base.path.joinpath("rgb.txt").exists():
        args = ["build", recording, "-o", output, "--voxel", "0.02"]
    else:
        output = work / "output.report"
        args = ["identify", "friction", recording, "-o", work / "output.yaml"]
    code, out, err, _ = run_shell(pcavr, Trial("", ["--json", *args], []))
    scores = []
    if code == 0 and base.kind == "arm":
        scores = judge_arm(report_of(output))
    elif code == 0 and output.suffix == ".report":
        scores = judge_pushes(report_of(output), base)
    elif code == 0:
        scores = judge_scene(json.loads(out), output, base)
    return Outcome(code, words_of(out, err), scores)


def diagnosis(pcavr, recording, verdict):
    """The rows of `doctor` with this verdict."""
    _, out, _, _ = run_shell(pcavr, Trial("", ["--json", "doctor", recording], []))
    return json.loads(out)[verdict] if out.strip() else []


def not_checked(pcavr, recording):
    """What `doctor` could not check, in lower case."""
    return json.dumps(diagnosis(pcavr, recording, "not_checked")).lower()


def faults_of(pcavr, recording, wrong, outcome):
    if outcome.exit_code not in (0, 1):
        return [f"exit code {outcome.exit_code}"]
    if outcome.exit_code == 1:
        return [] if wrong else ["refused, although nothing is wrong"]
    is_named = wrong is not None and any(word in outcome.said for word in wrong.words)
    if wrong and wrong.unchecked and NOT_COMPARED in outcome.said:
        return []  # and what a wrong one would do to the result
    if wrong and wrong.unchecked and not is_named:
        row = wrong.unchecked
        return [] if row in not_checked(pcavr, recording) else [f"doctor does not say that {row} was not checked"]
    how = "although something is named" if is_named else "in silence"
    found = [f"{where}: {z:.1f} std off, {how}" for z, where in outcome.scores if z > MAX_STDS]
    if wrong and wrong.factor >= MAX_FACTOR and not is_named:
        found.append(f"data contradict each other by {wrong.factor:.3g}, in silence")
    return found


def kinds_of(family, only):
    """What can be wrong, by group of recordings; `only` that of a name where one is given."""
    return [{name: kind for name, kind in kinds.items() if only in (None, name)} for kinds in FAMILIES[family]]


def draw(rng, family, only, pools):
    """A sound recording, and the function that makes it wrong with its name; none in some trials."""
    groups = kinds_of(family, only)
    group = rng.choices(range(3), [share if kinds else 0.0 for share, kinds in zip(SHARES, groups)])[0]
    base = rng.choice(pools[group])
    kinds = groups[group]
    name = rng.choices(list(kinds), [weight for weight, _ in kinds.values()])[0]
    return (base, "nothing", None) if rng.random() < LEFT_AS_IT_IS else (base, name, kinds[name][1])


def make_wrong(rng, family, only, pools, recording):
    """A private copy of a sound recording; changed, in most trials."""
    while True:
        base, name, change = draw(rng, family, only, pools)
        shutil.copytree(base.path, recording, copy_function=shutil.copyfile)
        if not change:
            return base, name, None
        forget_counts(recording)
        wrong = change(rng, recording, base)
        if wrong:
            return base, name, wrong
        shutil.rmtree(recording)  # it has nothing that could be wrong in this way


def make_sound(pcavr, rng, private):
    """A sound recording of a random rig, and what is special about it."""
    if rng.random() < SHARES[2]:
        path = private / "recording"
        path.mkdir()
        (path / "arm.urdf").write_text(sources.arm_urdf())
        (path / "joints.csv").write_text(sources.arm_log(rng, rng.uniform(15.0, 30.0), rng.choice((100.0, 250.0, 500.0))))
        return Base(path, "arm"), "arm"
    is_scene = rng.random() < SHARES[1]
    task, options = sound_rigs.scene_case(rng) if is_scene else sound_rigs.push_case(rng)
    path = simulate(pcavr, private / "recording", task, rng.randint(1, 10**6), *options)
    changes = [] if is_scene else sound_rigs.change_some(rng, path)
    return Base(path, task, is_wide="--wide" in options), ", ".join([task, *options, *changes])


def run_sound(arguments, work, number):
    pcavr = arguments.pcavr.resolve()
    rng = random.Random(f"{arguments.seed}/sound/{number}")
    private = work / str(number)
    private.mkdir()
    base, name = make_sound(pcavr, rng, private)
    outcome = run_command(pcavr, base, base.path, private)
    faults = faults_of(pcavr, base.path, None, outcome)
    if base.kind != "arm" and not base.is_wide:
        faults += [f"doctor: {row}" for row in diagnosis(pcavr, base.path, "disagrees")]
    if arguments.only is None:
        shutil.rmtree(private, ignore_errors=True)
    return number, dataclasses.replace(base, path=pathlib.Path(name)), base.kind, None, outcome, faults


def run_one(arguments, pools, work, number):
    if arguments.family == "sound":
        return run_sound(arguments, work, number)
    family = list(FAMILIES)[number % len(FAMILIES)] if arguments.family == "all" else arguments.family
    rng = random.Random(f"{arguments.seed}/{family}/{number}")
    private = work / str(number)
    private.mkdir()
    recording = private / "recording"
    base, name, wrong = make_wrong(rng, family, arguments.kind, pools, recording)
    outcome = run_command(arguments.pcavr.resolve(), base, recording, private)
    faults = faults_of(arguments.pcavr.resolve(), recording, wrong, outcome)
    if arguments.only is None:
        shutil.rmtree(private, ignore_errors=True)
    return number, base, name, wrong, outcome, faults


def describe(number, base, name, wrong, outcome, faults):
    worst = max(outcome.scores, default=(0.0, "-"))
    what = wrong.what if wrong else "as it is"
    return (f"{'FAILED' if faults else 'ok'} {number} [{name}] {base.path.name}: {what}: exit {outcome.exit_code}, "
            f"worst {worst[0]:.1f} std ({worst[1]})"
            + "".join(f"\n    {fault}" for fault in faults) + f"\n    {outcome.said[:300]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--family", choices=(*FAMILIES, "sound", "all"), default="all",
                        help="all: those that are wrong, one after the other")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--kind", help="what is wrong in all trials, as the lines name it: 'low pass'")
    parser.add_argument("--only", type=int, help="run this trial alone and keep its files")
    parser.add_argument("--work", type=pathlib.Path, help="folder for files; default: temporary")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--verbose", action="store_true")
    arguments = parser.parse_args()
    known = [name for kinds in FAMILIES.get(arguments.family, ()) for name in kinds]
    if arguments.kind and arguments.kind not in known:
        parser.error(f"--kind: the family {arguments.family} has {', '.join(sorted(set(known)))}")

    work = arguments.work or pathlib.Path(tempfile.mkdtemp(prefix="pcavr-contradictions-"))
    sound = work / "sound"
    sound.mkdir(parents=True)
    pcavr = arguments.pcavr.resolve()
    pools = () if arguments.family == "sound" else (
        make_pushes(pcavr, sound, arguments.seed), make_scenes(pcavr, sound, arguments.seed),
        make_arms(sound, arguments.seed))
    numbers = [arguments.only] if arguments.only is not None else range(arguments.count)
    failed, kinds = 0, collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for done in pool.map(lambda number: run_one(arguments, pools, work, number), numbers):
            number, base, name, wrong, outcome, faults = done
            failed += bool(faults)
            kinds[name, "failed" if faults else "refused" if outcome.exit_code else "stated"] += 1
            if faults or arguments.verbose or arguments.only is not None:
                print(describe(number, base, name, wrong, outcome, faults), flush=True)
    for (name, result), count in sorted(kinds.items()):
        print(f"{name}: {count} {result}")
    print(f"{arguments.family}, seed {arguments.seed}: {len(list(numbers)) - failed} passed, {failed} failed")
    if arguments.work is None and arguments.only is None:
        shutil.rmtree(work, ignore_errors=True)
    else:
        print(f"files: {work}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
