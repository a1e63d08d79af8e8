"""Every test marked `gl`, and what failed."""

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

from vrut_lite_lab.card_check.parts import Keep
from vrut_lite_lab.checkout import ROOT


def measure(folder: Path, keep: Keep) -> None:
    """Run them on all cores; kernels are compiled first, side by side."""
    report = folder / "gl_tests.xml"
    one_core = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "LP_NUM_THREADS"), "1")
    environment = os.environ | one_core
    python = [sys.executable]
    subprocess.run([*python, "tests/compile_first.py"], cwd=ROOT, env=environment, check=False)
    subprocess.run(
        [*python, "-m", "pytest", "-m", "gl", "-n", str(os.cpu_count()), "--dist", "worksteal",
         "-q", "--durations=15", f"--junit-xml={report}", "-p", "no:cacheprovider"],
        cwd=ROOT, env=environment, check=False,
    )  # fmt: skip
    suite = ElementTree.parse(report).getroot().find("testsuite")
    assert suite is not None
    cases = suite.findall("testcase")
    keep(
        {
            "tests": len(cases),
            "skipped": sum(case.find("skipped") is not None for case in cases),
            "failed": {
                f"{case.get('classname')}::{case.get('name')}": (fault.get("message") or "")[:300]
                for case in cases
                for fault in (*case.findall("failure"), *case.findall("error"))
            },
        }
    )
