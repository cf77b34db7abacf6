#!/usr/bin/env python3
"""Counts instructions and compares them with the counts that were agreed on.

    python3 .ci/instruction_limits.py            run the bench; fail above the limits
    python3 .ci/instruction_limits.py --update   run the bench; write benches/instructions.limits

Needs valgrind and `cargo install iai-callgrind-runner --version 0.16.1`. iai-callgrind's own
regression checks compare with the run before on the same disk, and a new machine has none.

A count above its limit by more than the tolerance fails, and so does a bench without a limit or a
limit without a bench. A count far below its limit is printed: write the limits anew, or the gain can
be lost unseen. The compiler's version moves counts too; update them together with it.

Prints a table of what each scene's frames spend where, by the source files that the instructions come from
(promise P7), and how series grow. Fails where a scene without chains runs what chains are answered with, or
one without loose bodies what moves those, and where a series outgrows the class that it is documented with.
"""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMITS = ROOT / "benches" / "instructions.limits"
TOLERANCE = 0.03
HEAD = "# Instructions, counted by valgrind: `python3 .ci/instruction_limits.py --update` writes them.\n"


def run_bench():
    """Runs the bench; the folder its summaries are below."""
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    home = target / "iai-limits"
    # Summaries of benches that are gone must not be taken for new ones.
    shutil.rmtree(home, ignore_errors=True)
    command = ["cargo", "bench", "--locked", "--package", "palpable", "--bench", "instructions"]
    options = ["--", "--save-summary=json", f"--home={home}"]
    frames = target / "iai-frames"
    frames.mkdir(parents=True, exist_ok=True)
    environment = os.environ | {"PALPABLE_FRAMES": str(frames.resolve())}
    save = ["cargo", "test", "--locked", "--package", "palpable", "--test", "frames"]
    subprocess.run(save, cwd=ROOT, check=True, env=environment)
    subprocess.run(command + options, cwd=ROOT, check=True, env=environment)
    return home


def counts(home):
    """Instructions of every bench, by name."""
    found = {}
    for path in sorted(home.rglob("summary.json")):
        summary = json.loads(path.read_text(encoding="utf-8"))
        for profile in summary["profiles"]:
            callgrind = profile["summaries"]["total"]["summary"].get("Callgrind")
            if callgrind:
                name = f"{summary['function_name']}.{summary['id']}"
                found[name] = int(callgrind["Ir"]["metrics"]["Left"]["Int"])
    return found


# Benches of whole frames, and the bench of each by the name of its file.
FRAMES = re.compile(r"callgrind\.((?:ten_frames|typical_frame|heaviest_frame|growth_frame)\..+)\.out$")

# What a scene without chains must not run, and which benches have chains, or chains in contact.
# `skeleton::propose` is where it is asked whether there are any.
OF_CHAINS = re.compile(
    r"palpable::reach::(skeleton(?!::propose)|limb|touch|least_deviation|cyclic_descent|goal)"
)
WITH_CHAINS = re.compile(r"arms|fingers|chains")
CHAINS_IN_CONTACT = ("typical_frame.arms_led_by_their_tips", "heaviest_frame.two_arms")

# The same for loose bodies; `src/impulses.rs` itself asks whether there are any.
OF_LOOSE = re.compile(r"/src/impulses/")
WITHOUT_LOOSE = re.compile(
    r"empty|free_hand|pressed_hand|slid_hand|free_arms|arms_at_a_wall|settled_arms|sliding_hand"
    r"|arms_cyclic|arms_led|detached_hand|nothing|beside_pieces|hand_pieces|chains"
)
LOOSE_AT_WORK = ("ten_frames.rolling_sphere", "heaviest_frame.pile")


def costs(text):
    """Instructions by function and source file, of one callgrind output: `fn` names the function, `fl`, `fi`
    and `fe` the file, which inlined code changes. A line of numbers costs there; the line behind `calls` is
    what the callee cost."""
    found, function, file, is_callees = {}, None, None, False
    for line in text.splitlines():
        if line.startswith("fn="):
            function = line[3:]
        elif line.startswith(("fl=", "fi=", "fe=")):
            file = line[3:]
        elif line.startswith("calls="):
            is_callees = True
        elif line[:1].isdigit() or line[:1] in "+-*":
            numbers = line.split()
            # A cost of zero is left out.
            if not is_callees and len(numbers) > 1:
                found[function, file] = found.get((function, file), 0) + int(numbers[1])
            is_callees = False
    return found


def frame_outputs(home):
    """Text of each bench of frames, by name."""
    found = {}
    for path in sorted(home.rglob("callgrind.*.out")):
        match = FRAMES.search(path.name)
        if match:
            found[match.group(1)] = path.read_text(encoding="utf-8")
    return found


def nobody_pays_for_what_is_not_there(outputs):
    """Whether chains and loose bodies cost instructions in the scenes that have some, and in no other."""
    good = True
    for name, text in outputs.items():
        chains = set(OF_CHAINS.findall(text))
        if not WITH_CHAINS.search(name) and chains:
            print(f"{name}: runs {', '.join(sorted(chains))} without chains")
            good = False
        if name in CHAINS_IN_CONTACT and "least_deviation" not in chains:
            print(f"{name}: no solver was seen, so that absence says nothing")
            good = False
        loose = sum(cost for (_, file), cost in costs(text).items() if OF_LOOSE.search(file))
        if WITHOUT_LOOSE.search(name) and loose:
            print(f"{name}: {loose} instructions of impulses without loose bodies")
            good = False
        if name in LOOSE_AT_WORK and not loose:
            print(f"{name}: no impulses were seen, so that absence says nothing")
            good = False
    missing = set(CHAINS_IN_CONTACT + LOOSE_AT_WORK) - outputs.keys()
    if missing:
        print(f"not benched: {', '.join(sorted(missing))}")
    return good and not missing


STAGES = ("couple", "pairs", "contacts", "reach", "advance", "driven", "impulses", "publish", "events")
COLUMNS = STAGES + ("geometry", "rest")


def column_of(function, file):
    """The stage or layer that instructions belong to: by their source file, and for a library's code that was
    inlined by the function. `rest` is state, memory and libraries."""
    by_file = re.search(r"/src/([a-z_]+)(?:\.rs|/)", file.removeprefix(str(ROOT)))
    by_function = re.match(r"<?palpable::([a-z_]+)::", function)
    match = by_file if file.startswith(f"{ROOT}/src/") else by_function
    name = match.group(1) if match else "rest"
    return name if name in COLUMNS else "rest"


def print_table(outputs):
    """Instructions of each scene's frames by stage; `.` is none at all."""
    print(f"\n{'instructions of a frame':<38}{'all':>10}" + "".join(f"{c:>10}" for c in COLUMNS))
    for name, text in outputs.items():
        if name.startswith("growth_frame") and "nothing" not in name:
            continue
        frames = 10 if name.startswith("ten_frames") else 1
        sums = dict.fromkeys(COLUMNS, 0)
        for (function, file), cost in costs(text).items():
            sums[column_of(function, file)] += cost
        cells = "".join(f"{sums[c] // frames if sums[c] else '.':>10}" for c in COLUMNS)
        print(f"{name:<38}{sum(sums.values()) // frames:>10}{cells}")


# The most that instructions may grow by when a thing is doubled, as a power of two, for the last doubling:
# boxes of bodies are compared each with each (`src/impulses/islands.rs`), all else is a pass.
GROWTH_MAX = {
    "beside_pieces": 1.1,
    "boxes_asleep": 2.1,
    "boxes_awake": 2.1,
    "chains": 1.3,
    "contacts": 1.3,
}


def growth_is_as_documented(found):
    """Prints every series of 1, 2, 4 ... things; whether none outgrows its class."""
    series = {}
    for name, count in found.items():
        match = re.fullmatch(r"growth_frame\.(\w+)_(\d+)", name)
        if match:
            series.setdefault(match.group(1), {})[int(match.group(2))] = count
    good = bool(series)
    print("\ngrowth of a frame: instructions for 1, 2, 4 ... things; powers of two between them")
    for name, by_index in series.items():
        counts = [by_index[index] for index in sorted(by_index)]
        powers = [math.log2(after / before) for before, after in zip(counts, counts[1:])]
        print(f"{name:<16}" + "".join(f"{count:>10}" for count in counts))
        print(" " * 26 + "".join(f"{power:>10.2f}" for power in powers))
        if powers[-1] > GROWTH_MAX.get(name, math.inf):
            print(f"{name}: grows with the power {powers[-1]:.2f}")
            good = False
    return good


def print_units(found):
    """What one more unit of a stage takes, by the frames that got a few more each."""
    allowed = {"advance": (0, 1, 2, 4), "impulse": (0, 32, 64, 128), "reach": (0, 1, 2, 4)}
    print("\ninstructions of a unit, between frames that are allowed more and more of them")
    for stage, units in allowed.items():
        counts = [found.get(f"units.{stage}_{index}", 0) for index in range(len(units))]
        steps = zip(zip(counts, counts[1:]), zip(units, units[1:]))
        each = [(after - before) // (more - less) for (before, after), (less, more) in steps]
        print(f"{stage:<16}" + "".join(f"{count:>10}" for count in each))


def read_limits():
    """The limits by name."""
    limits = {}
    for line in LIMITS.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            name, count = line.split("=")
            limits[name.strip()] = int(count)
    return limits


def write_limits(found):
    width = max(len(name) for name in found)
    lines = [f"{name:<{width}} = {count}\n" for name, count in sorted(found.items())]
    LIMITS.write_text(HEAD + "".join(lines), encoding="utf-8")


def compare(found, limits):
    """Prints a line for each bench; whether all are within their limits."""
    good = True
    for name in sorted(found.keys() | limits.keys()):
        count, limit = found.get(name), limits.get(name)
        if count is None or limit is None:
            verdict = "NO BENCH" if count is None else "NO LIMIT"
            good = False
        elif count > limit * (1 + TOLERANCE):
            verdict = "TOO MANY"
            good = False
        elif count < limit * (1 - TOLERANCE):
            verdict = "fewer: lower the limit"
        else:
            verdict = "ok"
        change = f"{100 * (count / limit - 1):+7.2f} %" if count and limit else " " * 9
        print(f"{name:<44} {count or 0:>10} limit {limit or 0:>10} {change}  {verdict}")
    return good


def main():
    update = sys.argv[1:] == ["--update"]
    if sys.argv[1:] and not update:
        sys.exit(__doc__)
    home = run_bench()
    found = counts(home)
    if not found:
        sys.exit("the bench wrote no summaries")
    if update:
        write_limits(found)
    if not compare(found, read_limits()):
        sys.exit("instruction counts are not within benches/instructions.limits")
    outputs = frame_outputs(home)
    print_table(outputs)
    print_units(found)
    if not growth_is_as_documented(found):
        sys.exit("a series outgrows its class")
    if not nobody_pays_for_what_is_not_there(outputs):
        sys.exit("chains or loose bodies cost instructions where there are none")


if __name__ == "__main__":
    main()
