#!/usr/bin/env python3
"""Counts instructions and compares them with the counts that were agreed on.

    python3 .ci/instruction_limits.py            run the bench; fail above the limits
    python3 .ci/instruction_limits.py --update   run the bench; write benches/instructions.limits

Needs valgrind and `cargo install iai-callgrind-runner --version 0.16.1`. iai-callgrind's own
regression checks compare with the run before on the same disk, and a new machine has none.

A count above its limit by more than the tolerance fails, and so does a bench without a limit or a
limit without a bench. A count far below its limit is printed: write the limits anew, or the gain can
be lost unseen. The compiler's version moves counts too; update them together with it.
"""

import json
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
    subprocess.run(command + options, cwd=ROOT, check=True)
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


# What a scene without chains must not run, and a scene with chains in contact must: promise P7.
OF_CHAINS = re.compile(r"palpable::reach::(skeleton|limb|touch|least_deviation|cyclic_descent|goal)")


def chains_cost_only_where_they_are(home):
    """Whether callgrind saw functions of chains in the scenes that have some, and in no other."""
    good = True
    for path in sorted(home.rglob("callgrind.ten_frames.*.out")):
        seen = set(OF_CHAINS.findall(path.read_text(encoding="utf-8")))
        if "arms" not in path.name and seen:
            print(f"{path.name}: runs {', '.join(sorted(seen))} without chains")
            good = False
        if "arms_at_a_wall" in path.name and "least_deviation" not in seen:
            print(f"{path.name}: no solver was seen, so that absence says nothing")
            good = False
    return good


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
    if not chains_cost_only_where_they_are(home):
        sys.exit("chains cost instructions where there are none")


if __name__ == "__main__":
    main()
