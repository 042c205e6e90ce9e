"""The validation report: self-contained, red where a claim fails."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from kinsim.cli import app
from kinsim.validate import find_scripts, holds, validate

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
    assert Path("out/claims.md").read_text().splitlines()[2] == "| one is \\| below two | 1 | <= 2 | `good` |"


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
