"""The built site in a real Chromium, after `make docs`: run by hand or by `.ci`, since a machine may have no browser.

Every page asks for files of its own only, sets all its formulas, and complains of nothing.
"""

from __future__ import annotations

from pathlib import Path

import pytest

SITE = Path(__file__).parents[1] / "out" / "docs"
PAGES = sorted(SITE.rglob("*.html"))

SET = """async () => {
  if (window.MathJax?.startup) await MathJax.startup.promise
  return true
}"""


def test_there_are_pages():
    assert len(PAGES) > 20, "build the site first, with make docs"


@pytest.mark.parametrize("path", PAGES, ids=[str(path.relative_to(SITE)) for path in PAGES])
def test_a_page_needs_nothing_from_elsewhere(chromium, path):
    asked, complaints = [], []
    page = chromium.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.on("requestfailed", lambda request: complaints.append(request.url))
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(path.as_uri())
    page.wait_for_function(SET)
    assert [url for url in asked if not url.startswith((SITE.as_uri(), "data:"))] == []
    assert complaints == []
    formulas, done = page.locator(".math").count(), page.locator("mjx-container").count()
    assert done >= formulas
    assert page.locator("[data-mjx-error]").count() == 0
    page.close()
