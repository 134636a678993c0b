"""A result on two ranks."""

from __future__ import annotations

import json
from pathlib import Path

from tests.conftest import MpiRun
from tests.run.conftest import small


def test_two_ranks_each_have_the_states(mpirun: MpiRun, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import json, sys\n"
        "from pathlib import Path\n"
        "import fiberbend\n"
        "from fiberbend.process.ranks import rank\n"
        "case = json.loads(Path(sys.argv[1]).read_text())\n"
        "r = fiberbend.run(case)\n"
        "grid = r.mesh('last')\n"
        "found = rank(), grid.n_cells, r.last('angle_deg'), r.kept_in\n"
        "sys.stdout.write(' '.join(map(str, found)) + '\\n')  # at once, so that lines stay whole\n"
    )
    case = small(mesh={"axial": "6 mm"}, output={})
    case["effects"][0] = {"pressure": {"to": "10 kPa"}}
    case["effects"][1]["winding"]["as"] = "smeared"
    (tmp_path / "case.json").write_text(json.dumps(case))
    done = mpirun(2, [script, tmp_path / "case.json"])
    assert done.returncode == 0, done.stderr
    first, second = sorted(line.split() for line in done.stdout.splitlines() if "kPa" not in line)
    assert first[1:3] == second[1:3]
    assert first[3] != second[3]
    assert not Path(first[3]).exists()
    assert not Path(second[3]).exists()
