"""The scan of the built site finds what a browser would fetch from elsewhere, and nothing else."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

spec = importlib.util.spec_from_file_location("offline", Path(__file__).parents[1] / ".ci" / "offline.py")
offline = importlib.util.module_from_spec(spec)
spec.loader.exec_module(offline)


@pytest.mark.parametrize(
    "page",
    [
        '<script src="https://cdn.example.org/mathjax.js"></script>',
        "<script src='//cdn.example.org/mathjax.js'></script>",
        '<link rel="stylesheet" href="https://fonts.example.org/css?family=Lato">',
        '<link rel="preconnect" href="https://fonts.example.org"/>',
        '<img src="http://example.org/picture.png">',
        '<img srcset="local.png 1x, https://example.org/picture.png 2x">',
        '<iframe src="https://example.org"></iframe>',
        '<base href="https://example.org/">',
        '<video poster="https://example.org/p.png"></video>',
        '<object data="https://example.org/p.svg"></object>',
        '<svg><use xlink:href="https://example.org/p.svg#a"></use></svg>',
        '<p style="background: url(https://example.org/p.png)">',
        "<style>@import 'https://example.org/s.css';</style>",
        "<style>@font-face { src: url(//example.org/f.woff2) }</style>",
        '<script>import("https://example.org/module.js")</script>',
        "<script>fetch('https://example.org/data.json')</script>",
        '<meta http-equiv="refresh" content="0; url=https://example.org">',
    ],
)
def test_it_finds_what_is_fetched(page):
    assert offline.in_page(f"<html><body>{page}</body></html>")


@pytest.mark.parametrize(
    "page",
    [
        '<a href="https://example.org">a link to click</a>',
        '<link rel="stylesheet" href="../_static/furo.css"><script src="_static/a.js"></script>',
        '<img src="data:image/png;base64,AAAA"><svg xmlns="http://www.w3.org/2000/svg"></svg>',
        "<p>read https://example.org</p><code>url(https://example.org)</code>",
        "<script>// see https://example.org\nlet name = 'http://www.w3.org/2000/svg'</script>",
    ],
)
def test_it_leaves_the_rest_alone(page):
    assert offline.in_page(page) == []


def test_style_sheets_and_scripts_are_judged_too():
    assert offline.in_style("body { background: url('https://example.org/p.png') }") == ["https://example.org/p.png"]
    assert offline.in_style("/* url(https://example.org/p.png) */ body { background: url(p.png) }") == []
    assert offline.in_script('load("//cdn.example.org/x.js")') == ["//cdn.example.org/x.js"]
