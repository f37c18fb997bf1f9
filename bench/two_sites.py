#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Paper C's system run through the two programs, over a good and over a bad link.

    bench/two_sites.py RECORDING --scene SCENE --pcavr build/test/apps/pcavr/pcavr
                       [--tracked RUN | --plant CASE --plant-seed N] [--parameters FILE]
                       [--work out/two_sites] [--seed 1]

RECORDING, which has a truth/, goes through robot-site and operator-site in real time: 200 ms each
way, then the same with 20 % loss in bursts of 3, 50 ms jitter, 5 % reordered, 5 % twice. The robot
site's black box becomes a run, and `evaluate` compares it with the truth. Prints both sides by side:
the error of each time node as the operator's and the robot's site found it (aim: 40 ms), the error
of position while sliding (aim: median 0.8 mm, 95 % 2 mm), and the corrections' bytes as a share of
streaming (aim: 1 %), the error of the rendered force outside the first 0.3 s of a contact (aim:
10 %), and the display's errors as a share of those of a plainly delayed one (aim: 25 %). Aim of the
bad link: no figure worse by more than a third.

As in paper C the parameters come from before the run, by presses and repeated pushes of the same
boxes: `simulate paper --no-images`, `identify contact`, `identify friction`. One push alone gives a
limiting friction that is some 20 % off, and t2 is then found when the correction arrives.

--plant has the simulated plant of that case in place of the recording at the robot's site: it
follows the commands, which are the motion of the recording's tool; its own truth is compared with.

--virtual BENCH (pcavr_bench_two_sites) runs the loops of both programs in virtual time, with --plant:
no machine's load is in the figures, and they come out the same to the digit.

--wrong-start gives both sites twice the mass, half the friction, and objects 10 mm off; then the
corrections of each object until its error is below 3 mm for good are printed, too (aim: 2), and the
parameters are needed. Needs only python3.
"""
import argparse
import json
import pathlib
import re
import shutil
import signal
import subprocess

from command import run
from displayed_errors import settled_force_errors, share_of_delayed

GOOD = ["--forward-delay", 0.2, "--backward-delay", 0.2]
BAD = [*GOOD, "--loss", 0.2, "--burst", 3, "--jitter", 0.05, "--reorder", 0.05, "--duplicate", 0.05]
SLIDING = "predicted.phase.sliding.translation."
ROUND_TRIP = 0.4  # [s]
WRONG = {"mass": 2.0, "sliding_friction_coefficient": 0.5, "limiting_static_friction": 0.5}
OFFSET = 0.01  # [m]


def scaled(text, key, factor):
    return re.sub(rf"(?m)^( *{key}: )(\S+)$", lambda m: f"{m[1]}{factor * float(m[2])!r}", text)


def start_wrong(arguments):
    """Replaces the scene and the parameters by copies that are wrong."""
    scene = arguments.work / "wrong_scene"
    shutil.copytree(arguments.scene, scene, dirs_exist_ok=True)
    manifest = scene / "scene.yaml"
    text = manifest.read_text()
    for key in ("pose", "start"):
        text = re.sub(rf"(?m)^(    {key}: {{t: \[)([^,]+)",
                      lambda m: f"{m[1]}{float(m[2]) + OFFSET!r}", text)
    manifest.write_text(scaled(text, "mass", WRONG["mass"]))
    parameters = pathlib.Path(arguments.parameters).read_text()
    for key, factor in WRONG.items():
        parameters = scaled(parameters, key, factor)
    arguments.scene, arguments.parameters = scene, arguments.work / "wrong.yaml"
    arguments.parameters.write_text(parameters)


def robot_source(arguments, truth):
    """The words that choose the robot of the robot's site."""
    if arguments.plant:
        return ["--plant", arguments.plant, "--seed", arguments.plant_seed, "--plant-truth", truth]
    return ["--recording", arguments.recording,
            *(["--tracked", arguments.tracked] if arguments.tracked else [])]


def run_in_virtual_time(arguments, folder, link):
    """The reports of both loops."""
    conditions = [f"{name[2:]}={value}" for name, value in zip(link[::2], link[1::2])
                  if not name.endswith("delay")]
    known = ["--parameters", arguments.parameters] if arguments.parameters else []
    words = [arguments.virtual, arguments.scene, arguments.recording, arguments.plant,
             arguments.plant_seed, folder, *known, "--seed", arguments.seed, *conditions]
    done = subprocess.run([str(word) for word in words], check=True, stdout=subprocess.PIPE)
    reports = json.loads(done.stdout)
    return reports["robot"], reports["operator"]


def run_programs(arguments, folder, truth, log, link):
    """The reports of both programs."""
    # Time enough for a connection over a bad link before the recording begins.
    config = folder / "robot.yaml"
    config.write_text("robot_site:\n  start_delay: 4\n")
    known = ["--parameters", arguments.parameters] if arguments.parameters else []
    robot = subprocess.Popen(
        [str(word) for word in [arguments.pcavr, "robot-site", arguments.scene,
                                *robot_source(arguments, truth), *known, "--port", 0, "--log", log,
                                "--config", config, "--json"]], stdout=subprocess.PIPE, text=True)
    try:
        port = json.loads(robot.stdout.readline())["port"]
        person = run(arguments.pcavr, "operator-site", arguments.scene, "--trace",
                     arguments.recording, *known, "--port", port, "--seed", arguments.seed, *link)
        if arguments.plant:  # which has no end of its own
            robot.send_signal(signal.SIGINT)
        return json.loads(robot.communicate(timeout=60)[0]), person
    finally:
        robot.kill()


def live_report(arguments, label, link):
    """What `evaluate` says of one session, and the reports of both programs."""
    folder = arguments.work / label
    folder.mkdir(parents=True, exist_ok=True)
    truth = folder / "truth" if arguments.plant else arguments.recording / "truth"
    log = folder / "robot.mcap"
    log.unlink(missing_ok=True)
    if arguments.plant:
        shutil.rmtree(truth, ignore_errors=True)
    if arguments.virtual:
        robot_report, person = run_in_virtual_time(arguments, folder, link)
    else:
        robot_report, person = run_programs(arguments, folder, truth, log, link)
    run(arguments.pcavr, "replay", log, "--scene", arguments.scene, "-o", folder / "run", "--force")
    report = run(arguments.pcavr, "evaluate", folder / "run", "--truth", truth, "-o",
                 folder / "report", "--force")
    report["share_of_delayed"] = share_of_delayed(folder / "run", truth, ROUND_TRIP)
    report["settled_force"] = settled_force_errors(folder / "run")
    return report, robot_report, person


def node_error(report, node, site):
    truth, found = (report.get(f"nodes.{node}.{key}_s") for key in ("truth", site))
    return "missed" if found is None else f"{1e3 * (found - truth):+.0f}"


def table(reports):
    nodes = [key.split(".")[1] for key in reports[0][0] if key.endswith(".truth_s")]
    yield ["", *(f"{link} link, {site}" for link in ("good", "bad")
                 for site in ("operator", "robot"))]
    for node in nodes:
        event = reports[0][0][f"nodes.{node}.event"]
        yield [f"{node} {event} [ms]", *(node_error(report, node, site) for report, _, _ in reports
                                         for site in ("predicted", "measured"))]
    for name in ("median", "p95"):
        yield [f"sliding error, {name} [mm]",
               *(cell for report, _, _ in reports
                 for cell in (f"{1e3 * report[f'{SLIDING}{name}_m']:.3f}", ""))]
    for name, share in (("median", 0.5), ("p95", 0.95)):
        yield [f"force after 0.3 s, {name} [%]",
               *(cell for errors in (report["settled_force"] for report, _, _ in reports)
                 for cell in (f"{100 * errors[int(share * (len(errors) - 1))]:.1f}", ""))]
    for i, name in enumerate(("position", "force")):
        yield [f"{name} of delayed [%]",
               *(cell for report, _, _ in reports
                 for cell in (f"{100 * report['share_of_delayed'][i]:.0f}", ""))]
    for key in sorted(key for key in reports[0][0] if key.endswith(".until_good.count")):
        yield [f"{key.split('.')[2]} until good", *(cell for report, _, _ in reports
                                                    for cell in (report.get(key, "never"), ""))]
    yield ["corrections", *(cell for _, robot, person in reports
                            for cell in (person["corrections"], len(robot["corrections"])))]
    yield ["bytes of streaming [%]",
           *(cell for _, robot, _ in reports
             for cell in ("", f"{100 * robot['correction_bytes'] / robot['streaming_bytes']:.2f}"))]
    yield ["arm found [mm/N]", *(cell for _, robot, _ in reports for cell in
                                 ("", f"{1e3 * robot.get('tool_compliance_m_per_n', 0.0):.4f}"))]
    yield ["sessions", *(cell for _, robot, person in reports
                         for cell in (person["sessions"], robot["sessions"]))]
    yield ["lead [ms]", *(cell for _, _, person in reports
                          for cell in (f"{1e3 * person['lead_s']:.0f}", ""))]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--scene", required=True)
    parser.add_argument("--pcavr", required=True)
    robot = parser.add_mutually_exclusive_group()
    robot.add_argument("--tracked")
    robot.add_argument("--plant")
    parser.add_argument("--plant-seed", type=int, default=1)
    parser.add_argument("--parameters")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/two_sites"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--wrong-start", action="store_true")
    parser.add_argument("--virtual", metavar="BENCH")
    arguments = parser.parse_args()
    if arguments.virtual and not arguments.plant:
        parser.error("--virtual needs --plant")
    arguments.work.mkdir(parents=True, exist_ok=True)
    if arguments.wrong_start:
        start_wrong(arguments)
    reports = [live_report(arguments, "good", GOOD), live_report(arguments, "bad", BAD)]
    for first, *cells in table(reports):
        print(f"{first:28}", *(f"{cell!s:>20}" for cell in cells))


if __name__ == "__main__":
    main()
