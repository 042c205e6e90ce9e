"""The validation report: self-contained, red where a claim fails."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from kinsim.cli import app
from kinsim.validate import find_scripts, holds, margin, validate

CLAIMS = Path(__file__).parent.parent / "validation" / "claims.py"

SCRIPT = '''"""A small story & <more>.

With *prose* in a second paragraph.
"""
from claims import run
from matplotlib.figure import Figure

def main(chapter):
    chapter.claim("one is | below two", 1.0, high={bound})
    figure = Figure()
    figure.subplots().plot([0, 1])
    chapter.figure(figure, "line", "a line")
    chapter.table("numbers", ["a", "b"], [[1, 2.5]])

run(main, __doc__)
'''


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "validation"
    folder.mkdir()
    shutil.copy(CLAIMS, folder)
    (folder / "good.py").write_text(SCRIPT.format(bound=2.0))
    monkeypatch.chdir(tmp_path)
    return folder


def test_report_holds_all_there_is_to_read(checkout: Path) -> None:
    records = validate(find_scripts(), Path("out"))
    assert holds(records)
    page = Path("out/index.html").read_text()
    for words in (
        "A small story &amp; &lt;more&gt;.",
        "<em>prose</em>",
        "data:image/png;base64,",
        "a line",
        "numbers",
        "2.5",
    ):
        assert words in page
    assert "http" not in page
    assert "Every claim holds." in page
    written = Path("out/claims.md").read_text().splitlines()
    assert written[2] == "| A small story & <more>. | 1 | 0 | 50.0% | `good` |"
    assert written[-1] == "| one is \\| below two | 1 | <= 2 | `good` |"


def test_the_page_opens_with_a_row_per_chapter_and_what_fails(checkout: Path) -> None:
    """What fails comes first, what holds is folded; no chapter brings HTML of its own."""
    for name, bound in (("convergence_x", 2.0), ("theorem_x", 0.5), ("canary", 2.0)):
        (checkout / f"{name}.py").write_text(
            SCRIPT.format(bound=bound).replace("With *prose*", "With <b>x</b> *prose*")
        )
    scripts = find_scripts()
    assert [script.stem for script in scripts] == ["canary", "theorem_x", "good", "convergence_x"]
    validate(scripts, Path("out"))
    page = Path("out/index.html").read_text()
    assert "<b>x</b>" not in page
    top, chapters = page.split("<h2", 1)
    assert top.index("What fails") < top.index("Chapters")
    assert top.count("one is | below two") == 1
    for name in ("canary", "theorem_x", "good", "convergence_x"):
        assert f'href="#{name}"' in top
        assert f'id="{name}"' in page
    assert chapters.count("<details") == 3
    assert chapters.count("Claims that fail") == 1


def test_margins() -> None:
    def of(measured: float, low: float = -math.inf, high: float = math.inf) -> float:
        return margin({"measured": measured, "low": low, "high": high, "holds": low <= measured <= high})

    assert of(1.0, 0.0, 2.0) == 1.0
    assert of(1.9, 0.0, 2.0) == pytest.approx(0.1)
    assert of(2.1, 0.0, 2.0) == pytest.approx(-0.1)
    assert of(3.0, high=4.0) == 0.25
    assert of(4.0, low=3.0) == 0.25
    assert of(-2.0, high=-1.0) == 0.5
    assert of(0.0, 0.0, 0.0) == of(0.0, high=0.0) == 1.0
    assert of(1.0, 0.0, 0.0) == -1.0
    assert of(math.nan, high=1.0) == -math.inf


def test_a_sentence_that_says_nothing_alone_is_refused(checkout: Path) -> None:
    (checkout / "odd.py").write_text(SCRIPT.format(bound=2.0).replace("one is |", "... is |"))
    (record,) = validate(find_scripts(["odd"]), Path("out"))
    assert "write it out" in record["error"]


def test_the_readme_is_checked_against_a_run(checkout: Path) -> None:
    """Other numbers will do; other claims, bounds or chapters will not."""
    for name in ("canary", "theorem_3", "figures", "mass_drift"):
        shutil.copy(checkout / "good.py", checkout / f"{name}.py")
    readme, out = Path("README.md"), Path("out")
    readme.write_text("before\n<!-- claims -->\nold\n<!-- end of claims -->\nafter\n")
    validate([checkout / "good.py"], out)
    record = (out / "good.json").read_text()
    for name in ("canary", "theorem_3", "figures", "mass_drift"):
        (out / f"{name}.json").write_text(record.replace('"name": "good"', f'"name": "{name}"'))

    def ci(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, str(CLAIMS.parents[1] / ".ci" / "claims.py"), str(out), *words]
        env = {**os.environ, "PYTHONPATH": str(CLAIMS.parents[1])}
        return subprocess.run(command, capture_output=True, text=True, check=False, env=env)

    assert ci("--check").returncode == 1
    assert ci().returncode == 0
    written = readme.read_text()
    assert written.startswith("before\n")
    assert written.endswith("after\n")
    assert "| A small story & <more>. | 1 | 0 | 50.0% | `good` |" in written
    assert ci("--check").returncode == 0
    readme.write_text(written.replace("| 1 | <= 2 |", "| 1.1 | <= 2 |").replace("50.0%", "45.0%"))
    assert ci("--check").returncode == 0
    for old, new in (("<= 2", "<= 3"), ("below two", "below three"), ("| 1 | 0 | 50.0%", "| 2 | 0 | 50.0%")):
        readme.write_text(written.replace(old, new))
        done = ci("--check")
        assert done.returncode == 1
        assert "the claims have changed" in done.stderr
        assert readme.read_text() == written.replace(old, new)


def test_a_failing_claim_turns_the_report_red(checkout: Path) -> None:
    (checkout / "wrong.py").write_text(SCRIPT.format(bound=0.5))
    done = CliRunner().invoke(app, ["validate"])
    assert done.exit_code == 1
    assert "Not every claim holds." in Path("out/validation/index.html").read_text()
    assert CliRunner().invoke(app, ["validate", "--only", "good"]).exit_code == 0


@pytest.mark.parametrize(
    "text", ["raise RuntimeError('broken')", "from claims import run\nrun(lambda chapter: None, '')"]
)
def test_a_script_that_breaks_or_claims_nothing_turns_the_report_red(text: str, checkout: Path) -> None:
    (checkout / "bad.py").write_text(text)
    records = validate(find_scripts(["bad"]), Path("out"))
    assert not holds(records)
    assert records[0]["error"]


@pytest.mark.parametrize(
    ("last", "line"),
    [
        ("raise RuntimeError('broken | badly <b>\\n\\nsee below')", "RuntimeError: broken | badly <b>"),
        ("import sys; sys.exit('gave up')", "gave up"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "ended with exit code -9"),
    ],
)
def test_a_crash_is_one_line_on_the_terminal_and_all_of_it_on_the_page(last: str, line: str, checkout: Path) -> None:
    (checkout / "bad.py").write_text(f"import sys\nprint('the first word', file=sys.stderr, flush=True)\n{last}\n")
    done = CliRunner().invoke(app, ["validate"])
    assert done.exit_code == 1
    assert [text for text in done.stdout.splitlines() if "bad" in text] == [f"broke: bad: {line}"]
    page = Path("out/validation/index.html").read_text()
    _, details = page.split("<details", 1)
    trace = details.split("</details>")[0]
    assert "the first word" in trace
    if "raise" in last:
        assert "Traceback (most recent call last)" in trace
        assert "see below" in trace
        assert "badly &lt;b&gt;" in trace
    assert "Not every claim holds." in page
    assert "**broke**" in Path("out/validation/claims.md").read_text()


def test_an_exit_code_that_does_not_fit_turns_the_report_red(checkout: Path) -> None:
    script = SCRIPT.format(bound=2.0).replace(
        "run(main, __doc__)", "try:\n    run(main, __doc__)\nfinally:\n    raise SystemExit(9)"
    )
    (checkout / "odd.py").write_text(script)
    records = validate(find_scripts(["odd"]), Path("out"))
    assert not holds(records)
    assert records[0]["error"] == "ended with exit code 9"


def test_bad_requests_get_one_line(checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = CliRunner().invoke(app, ["validate", "--only", "godo"])
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    assert "there are: good" in done.stderr
    done = CliRunner().invoke(app, ["validate", "--only", "good", "--out", "validation/good.py/x"])
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    monkeypatch.chdir(checkout)
    assert "run this in a checkout" in CliRunner().invoke(app, ["validate"]).stderr


def test_sigterm_in_the_second_script_keeps_what_the_first_found(checkout: Path) -> None:
    """The second ends kinsim, which says so in a line; the script that runs is ended with it."""
    (checkout / "zzz.py").write_text("import os, signal, time\nos.kill(os.getppid(), signal.SIGTERM)\ntime.sleep(60)\n")
    command = [sys.executable, "-m", "kinsim", "validate", "--out", "out"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr.count("\n")) == (130, 1), ended.stderr
    assert "interrupted; 1 of 2 scripts are done, what they found is in out" in ended.stderr
    assert Path("out/good.json").exists()
