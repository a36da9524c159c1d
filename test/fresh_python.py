"""Run a program in a fresh Python, and list the libraries that it imported."""

from pathlib import Path
import subprocess
import sys

ROOT = Path(__file__).resolve().parents[1]
#: Prints the top-level names of all modules, on a line of its own.
REPORT = '\nimport sys\nprint("\\n", *{name.partition(".")[0] for name in sys.modules})\n'


def run_and_list_imports(program: str) -> tuple[str, set[str]]:
    """Return what a program printed, and the top-level packages that it imported."""
    done = subprocess.run(
        [sys.executable, '-c', program + REPORT],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    *printed, packages = done.stdout.splitlines()
    return '\n'.join(printed), set(packages.split())
