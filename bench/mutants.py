"""Lines of fem/ changed on purpose, one at a time: which of them do the tests not notice?

A sample of the mutants of cosmic-ray (`pip install cosmic-ray`, not among the requirements), of
those kinds that a slip of the pen makes, the same number for every area. The survivors are printed;
what they mean is judged by hand (tests/verify/mutants.py). An hour on an idle core.
"""

from __future__ import annotations

import argparse
import filecmp
import json
import os
import random
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TREE = "tree"
"""Copy of the sources in which lines are changed."""
SEED, NUMBER = 10, 100
AREAS = {
    "newton": (["fem/solver/newton.py"], ["newton", "limit", "patch", "march", "contact"]),
    "march": (["fem/march/march.py"], ["increments", "limit", "march", "diagnosis"]),
    "measures": (
        ["fem/results/measures.py"],
        ["turns", "resultants", "frames", "contact", "newton", "march"],
    ),
    "embedded": (
        [
            f"fem/effects/{name}.py"
            for name in ("embedded_fibers", "mean_stretch", "bulging_fibers")
        ],
        ["uniform", "screw", "newton", "bulging", "effects"],
    ),
    "kinematics": (
        [
            f"fem/kinematics/{name}.py"
            for name in sorted(("kinematics", "body", "section", "cell", "uniform", "domain"))
        ],
        ["kinematics", "uniform", "screw", "patch", "frames", "newton", "scene"],
    ),
    "border": (
        ["fem/solver/bordered.py", "fem/solver/side_conditions.py"],
        ["side_conditions", "newton", "limit", "uniform", "march"],
    ),
}
"""By area its sources, and the tests in tests/fem that see them, quickest first."""
KINDS = {
    *("NumberReplacer", "AddNot", "ReplaceAndWithOr", "ReplaceOrWithAnd"),
    *("ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ZeroIterationForLoop"),
    *("ReplaceContinueWithBreak", "ReplaceBreakWithContinue"),
    *(f"ReplaceUnaryOperator_Delete_{of}" for of in ("USub", "Not", "Invert")),
    *("ReplaceComparisonOperator_IsNot_Is", "ReplaceComparisonOperator_Is_IsNot"),
    *("ReplaceComparisonOperator_Eq_NotEq", "ReplaceComparisonOperator_NotEq_Eq"),
    *(
        f"ReplaceComparisonOperator_{old}_{new}"
        for old in ("Lt", "LtE", "Gt", "GtE")
        for new in ("Lt", "LtE", "Gt", "GtE")
        if old != new
    ),
    *(f"ReplaceBinaryOperator_{pair}" for pair in ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul")),
    *("ReplaceBinaryOperator_Pow_Mul", "ReplaceBinaryOperator_BitAnd_BitOr"),
}
"""Kinds of change; others end with a TypeError at the first call, or are in type hints."""


def _sample(session: Path) -> int:
    """Keep a sample of the mutants of a session, of every area alike; how many there were."""
    with sqlite3.connect(session) as base:
        rows = base.execute(
            "select module_path, operator_name, occurrence, start_pos_row, start_pos_col, job_id"
            " from mutation_specs"
        ).fetchall()
        rows = sorted(row for row in rows if row[1].removeprefix("core/") in KINDS)
        generator, kept = random.Random(SEED), set()
        for number, (sources, _) in enumerate(AREAS.values()):
            pool = [row for row in rows if row[0] in sources]
            share = (NUMBER + len(AREAS) - 1 - number) // len(AREAS)
            kept |= {row[-1] for row in generator.sample(pool, share)}
        marks = ",".join("?" * len(kept))
        for table in ("mutation_specs", "work_items"):
            base.execute(f"delete from {table} where job_id not in ({marks})", sorted(kept))
    return len(rows)


def _test(folder: Path) -> int:
    """Run the tests of the area of the one changed file; pytest's exit code."""
    for sources, names in AREAS.values():
        if any(not filecmp.cmp(ROOT / s, folder / TREE / s, shallow=False) for s in sources):
            tests = [f"tests/fem/test_{name}.py" for name in names]
            command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
            return subprocess.run([*command, *tests], cwd=folder / TREE, check=False).returncode
    raise SystemExit("no file is changed")


def main() -> int:
    """Make the mutants, run them and print the survivors; or, with --test, the tests of one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="a folder for the copy and the session")
    parser.add_argument("--test", action="store_true", help="run the tests of the one mutant there")
    asked = parser.parse_args()
    folder = asked.folder.resolve()
    if asked.test:
        return _test(folder)
    tree, session, config = folder / TREE, folder / "session.sqlite", folder / "config.toml"
    shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".*", "__pycache__", "runs"))
    sources = [source for files, _ in AREAS.values() for source in files]
    command = f"{sys.executable} {ROOT / 'bench/mutants.py'} --test {folder}"
    config.write_text(
        f"[cosmic-ray]\nmodule-path = {json.dumps(sources)}\ntimeout = 600.0\n"
        f'excluded-modules = []\ntest-command = "{command}"\n'
        '[cosmic-ray.distributor]\nname = "local"\n'
    )
    environment = {**os.environ, "PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1"}

    def cosmic_ray(*words: object) -> str:
        words = ("cosmic-ray", *words)
        done = subprocess.run(
            [str(w) for w in words],
            cwd=tree,
            env=environment,
            text=True,
            check=True,
            stdout=subprocess.PIPE,
        )
        return done.stdout

    cosmic_ray("init", config, session)
    print(f"{NUMBER} of {_sample(session)} mutants", flush=True)
    cosmic_ray("exec", config, session)
    for line in cosmic_ray("dump", session).splitlines():
        (item, result) = json.loads(line)
        if result["test_outcome"] != "killed":
            print(item["mutations"][0]["module_path"])
            print("\n".join(x for x in result["diff"].splitlines() if x[:2] in ("- ", "+ ")))
    return 0


if __name__ == "__main__":
    sys.exit(main())
