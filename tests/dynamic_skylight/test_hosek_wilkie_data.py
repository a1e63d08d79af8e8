"""The authors' notice travels with their numbers, and the package stays light."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_notice_of_the_authors_is_installed():
    """The 3-clause BSD notice must travel with the numbers."""
    notice = ROOT / "modules" / "dynamic_skylight" / "data" / "LICENSE.hosek_wilkie"
    text = notice.read_text()
    assert "Copyright (c) 2012 - 2013, Lukas Hosek and Alexander Wilkie" in text
    assert "Redistributions in binary form must reproduce the above copyright" in text


def test_importing_the_package_does_not_import_numba():
    """The compiler costs a third of a second that only the fast cube map has use for."""
    code = "import dynamic_skylight, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
