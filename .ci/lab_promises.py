#!/usr/bin/env python3
"""Fails when a report of the lab breaks a promise: `lab_promises.py out/report.json`.

The bounds are those of `lab/src/report/data.rs`.
"""

import json
import sys

HAND_FIXED_OVERLAP_MM_MAX = 0.1
BALL_OVERLAP_MM_MAX = 1.0
OWN_OVERLAP_MM_MAX = 1.0
BEYOND_LIMITS_RAD_MAX = 1e-5


def broken(report):
    """What is broken, one line each."""
    for run in report["runs"]:
        if run["beyond_walls"]:
            yield f"{run['name']}: {run['beyond_walls']} frames beyond the walls"
        for phase in run["phases"]:
            for key, most in (
                ("overlap_hand_fixed_mm_max", HAND_FIXED_OVERLAP_MM_MAX),
                ("overlap_ball_fixed_mm_max", BALL_OVERLAP_MM_MAX),
                ("overlap_hand_ball_mm_max", BALL_OVERLAP_MM_MAX),
            ):
                if phase[key] > most:
                    yield f"{run['name']}, {phase['name']}: {key} is {phase[key]}, at most {most}"
            if phase.get("free_lag_mm_max"):
                yield f"{run['name']}, {phase['name']}: free motion lags"
    for scene in report["figures"]:
        for key, most in (
            ("overlap_fixed_mm_max", HAND_FIXED_OVERLAP_MM_MAX),
            ("overlap_loose_mm_max", BALL_OVERLAP_MM_MAX),
            ("overlap_own_mm_max", OWN_OVERLAP_MM_MAX),
            ("beyond_limits_rad_max", BEYOND_LIMITS_RAD_MAX),
            ("steps_untouched", 0),
        ):
            if scene[key] > most:
                yield f"{scene['figure']}, {scene['name']}: {key} is {scene[key]}, at most {most}"
    arm_slaps = report.get("arm_slaps")
    if arm_slaps and (
        arm_slaps["tunnelled_speeds"] or arm_slaps["overlap_mm_max"] > HAND_FIXED_OVERLAP_MM_MAX
    ):
        yield f"arms went through a slapped plate: {arm_slaps['tunnelled_speeds']}"
    slaps = report.get("slaps")
    if slaps and slaps["parts_behind"]:
        yield f"{slaps['parts_behind']} parts went through a slapped plate"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        report = json.load(file)
    lines = list(broken(report))
    print("\n".join(lines) or f"lab: {len(report['runs'])} runs keep the promises")
    return 1 if lines or not report["runs"] else 0


if __name__ == "__main__":
    sys.exit(main())
