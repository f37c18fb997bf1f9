# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""One run of the command on one bad input, and the conditions that must hold afterwards."""
import dataclasses
import json
import pathlib
import re
import signal
import subprocess
import time

MAX_COMPUTING = 20  # s of one processor; no rejection takes longer
TIMEOUT = 300.0  # s, for what waits for ever: computing is bounded above, also beside six other programs
MAX_ERROR_LENGTH = 1500  # characters of an error line, with file names
MAX_MEMORY = 6_000_000  # KiB of addresses, of which a sound run of these inputs takes a third
CONTROLS = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
NOT_FINITE = re.compile(r"(?<![A-Za-z_])[-+.]?(nan|inf|infinity)(?![A-Za-z_])", re.IGNORECASE)
RESULTS = (".csv", ".json", ".txt", ".yaml")


@dataclasses.dataclass
class Trial:
    """What to run. Paths are absolute; `inputs` must not change, `output` is complete or absent."""

    name: str
    args: list
    inputs: list
    output: pathlib.Path = None
    prefix: str = ""  # shell text before the command, such as a limit
    is_contradiction: bool = False  # the data disagree: exit code 1, or a warning
    must_fail: bool = False
    kill_after: float = None  # s, SIGTERM


@dataclasses.dataclass
class Outcome:
    trial: Trial
    faults: list
    seconds: float
    exit_code: int
    last_line: str  # of standard error


def state_of(path):
    """Name, size and modification time of all files below `path`, links not followed."""
    found = {}
    for entry in [path, *sorted(path.rglob("*"))] if path.is_dir() else [path]:
        try:
            status = entry.lstat()
        except OSError:
            continue
        if not entry.is_dir():
            found[str(entry)] = (status.st_size, status.st_mtime_ns, status.st_ino)
    return found


def run_shell(pcavr, trial):
    """Exit code, standard output, standard error and seconds; exit code None after a timeout."""
    quoted = " ".join("'" + str(arg).replace("'", "'\\''") + "'" for arg in trial.args)
    line = f"ulimit -v {MAX_MEMORY} -t {MAX_COMPUTING}; {trial.prefix} exec '{pcavr}' {quoted}"
    start = time.monotonic()
    process = subprocess.Popen(["bash", "-c", line], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               stdin=subprocess.DEVNULL)
    try:
        if trial.kill_after is not None:
            try:
                out, err = process.communicate(timeout=trial.kill_after)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGTERM)
                out, err = process.communicate(timeout=TIMEOUT)
        else:
            out, err = process.communicate(timeout=TIMEOUT)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        return None, out.decode(errors="replace"), err.decode(errors="replace"), TIMEOUT
    seconds = time.monotonic() - start
    return process.returncode, out.decode(errors="replace"), err.decode(errors="replace"), seconds


def faults_of_output(trial, exit_code, out, err):
    faults = []
    if "internal error" in err or "please report" in err:
        faults.append("internal error")
    if "out of memory" in err and "ulimit" not in trial.prefix:
        faults.append("took more than its memory")
    errors = [line for line in err.split("\n") if line.startswith("pcavr: ")]
    if CONTROLS.search("\n".join(errors)):
        faults.append("printed a control character")
    if exit_code == 1 and "inspect" not in trial.args:
        if len(errors) != 1:
            faults.append(f"{len(errors)} error lines")
        elif len(errors[0]) > MAX_ERROR_LENGTH:
            faults.append("an error line too long to read")
    if exit_code == 0 and errors:
        faults.append("success with an error line")
    if "--json" in trial.args and exit_code in (0, 1):
        try:
            json.loads(out)
        except ValueError:
            faults.append("--json did not print JSON")
    printed = (out + err).lower()
    if trial.is_contradiction and exit_code == 0 and "warning" not in printed:
        faults.append("contradicting data, success without a warning")
    if trial.must_fail and exit_code == 0:
        faults.append("success where the command must fail")
    return faults


def number_faults(output):
    """Of a result with a number that is not finite."""
    if output is None or not output.exists():
        return []
    files = [output] if output.is_file() else sorted(output.rglob("*"))
    for path in files:
        if path.suffix in RESULTS and path.is_file():
            found = NOT_FINITE.search(path.read_text(errors="replace"))
            if found:
                return [f"wrote '{found.group()}' to {path.relative_to(output.parent)}"]
    return []


def faults_of_files(trial, existed, before, exit_code):
    faults = []
    for path, state in before.items():
        after = state_of(path)
        if after != state:
            gone = sorted(set(state) - set(after))
            faults.append(f"an input was changed: {gone[:2] or sorted(set(after) ^ set(state))[:2]}")
    if trial.output is None:
        return faults
    if exit_code != 0 and not existed and trial.output.exists():
        faults.append("failed, but left an output")
    if trial.output.parent.is_dir():
        partial = [p.name for p in trial.output.parent.iterdir() if ".partial" in p.name]
        if partial:
            faults.append(f"left behind {partial[0]}")
    return faults


def run_trial(pcavr, trial):
    """Runs one trial and checks it."""
    existed = trial.output is not None and trial.output.exists()
    before = {path: state_of(path) for path in trial.inputs}
    exit_code, out, err, seconds = run_shell(pcavr, trial)
    ended = [0, 1, 2] if trial.kill_after is None else [0, 1, 2, -signal.SIGTERM,
                                                        128 + signal.SIGTERM]
    if exit_code is None:
        faults = [f"ran for more than {TIMEOUT:.0f} s"]
    elif exit_code not in ended:
        faults = [f"ended by signal {-exit_code}" if exit_code < 0 else f"exit code {exit_code}"]
    else:
        faults = faults_of_output(trial, exit_code, out, err)
        if exit_code == 0:
            faults += number_faults(trial.output)
    faults += faults_of_files(trial, existed, before, exit_code)
    last = [line for line in err.splitlines() if line.strip()]
    return Outcome(trial, faults, seconds, exit_code, last[-1] if last else "")
