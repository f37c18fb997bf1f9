#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Does each half of an object's recordings, identified together, say the same?

    bench/pooled_halves.py --data DATA/real/push_cmu/recordings --pcavr build/bench/apps/pcavr/pcavr [--work out/halves]

Each folder below DATA with test*/ is one object on one support. Its recordings are divided in four ways: every
second one, the first and the last ones, and two by chance (seeds 1, 2). Each half is identified by
`pcavr identify friction REC REC ...`. Printed per comparison and parameter: the difference in stds of both; then
how many are within 2.5. Needs only python3.
"""
import random
import sys

from command import recordings_parser, run
from held_out_pushes import MAX_Z, pairs_of, parameters


def divisions(recordings):
    """(name, both halves)"""
    middle = len(recordings) // 2
    yield "every second", (recordings[0::2], recordings[1::2])
    yield "first and last", (recordings[:middle], recordings[middle:])
    for seed in (1, 2):
        mixed = random.Random(seed).sample(recordings, len(recordings))
        yield f"by chance, seed {seed}", (mixed[:middle], mixed[middle:])


def main():
    arguments = recordings_parser(__doc__, "out/halves").parse_args()
    within = total = 0
    for number, folder in enumerate(sorted(path for path in arguments.data.iterdir() if path.is_dir())):
        recordings = sorted(folder.glob("test*"))
        if len(recordings) < 4:
            continue
        for name, halves in divisions(recordings):
            found = []
            for index, half in enumerate(halves):
                file = arguments.work / f"{number}-{name.replace(' ', '-')}-{index}.yaml"
                file.parent.mkdir(parents=True, exist_ok=True)
                run(arguments.pcavr, "identify", "friction", *half, "-o", file, "--force")
                found.append(parameters(file))
            for key, z in pairs_of(found):
                within += abs(z) <= MAX_Z
                total += 1
                print(f"{folder.name}, {name}, {key}: {z:+.2f}", flush=True)
    print(f"{within} of {total} differences within {MAX_Z} stds")
    return 0


if __name__ == "__main__":
    sys.exit(main())
