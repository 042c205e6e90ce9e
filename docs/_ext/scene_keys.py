"""The page of all keys of scene files, made from the JSON schema that `kinsim schema` prints."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from kinsim.schema import scene_schema

Node = dict[str, Any]

INTRODUCTION = """# The keys of a scene file

A scene file is TOML. This page is made from the schema that `kinsim schema` prints, so it lists just what kinsim reads;
unknown keys are refused, with the place in the file. How to write one, step by step: {doc}`../../how-to/scene-file`.

Wherever a number with a point is asked for, a formula without variables may stand in quotes, such as `"pi/10"`.
"""

BOUNDS = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}


def scene_page() -> str:
    """The page, in MyST."""
    schema = scene_schema()
    kinds = schema["definitions"]
    plain = {name: node for name, node in schema["properties"].items() if not _variants(node)}
    parts = [INTRODUCTION, "## At the top of the file", _table(plain, schema.get("required", []))]
    for name, node in schema["properties"].items():
        if _variants(node):
            needed = ", required" if name in schema["required"] else ""
            parts += [f"## `[{name}]`{needed}", node.get("description", ""), *_tables(name, node, kinds, "###")]
    return "\n\n".join(part for part in parts if part) + "\n"


def _tables(path: str, node: Node, kinds: dict[str, Node], level: str) -> Iterator[str]:
    """The variants of a family, and those of the families inside it."""
    variants = [kinds[name] for name in _variants(node)]
    for kind in variants:
        word = kind["properties"].get("kind", {}).get("const")
        if len(variants) > 1:
            yield f"{level} {path}: `{word}`"
        yield kind["description"]
        yield _table(kind["properties"], kind.get("required", []))
        for name, inner in kind["properties"].items():
            if _variants(inner):
                yield f"{level} `[{path}.{name}]`"
                yield from _tables(f"{path}.{name}", inner, kinds, f"{level}#")


def _variants(node: Node) -> list[str]:
    """Names of the definitions that a property may be."""
    return [part["$ref"].rpartition("/")[2] for part in [node, *node.get("oneOf", [])] if "$ref" in part]


def _table(properties: dict[str, Node], required: list[str]) -> str:
    told = any("description" in node for node in properties.values())
    rows = [["key", "value", "if left out", "meaning"], [":---"] * 4]
    for name, node in properties.items():
        default = "required" if name in required else _default(node)
        rows.append([f"`{name}`", _value(node), default, node.get("description", "")])
    width = 4 if told else 3
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row[:width]) + " |" for row in rows)


def _default(node: Node) -> str:
    if "default" not in node or node["default"] in ("", None):
        return "-"
    if isinstance(node["default"], dict):
        return f"`{node['default']['kind']}`"
    return f"`{json.dumps(node['default'])}`"


def _value(node: Node) -> str:
    """What may stand there, in a few words."""
    if _variants(node):
        return "a table, see below"
    if "const" in node:
        return f"`{json.dumps(node['const'])}`"
    if "enum" in node:
        return ", ".join(f"`{json.dumps(word)}`" for word in node["enum"])
    if "anyOf" in node:
        ways = [_value(way) for way in node["anyOf"] if way.get("type") != "null" and "formula" not in str(way)[:60]]
        return " or ".join(dict.fromkeys(ways)) + _bounds(node)
    if node["type"] == "array":
        items = node["items"]
        inside = ", ".join(_value(item) for item in items) if isinstance(items, list) else _value(items)
        return f"a list: {inside}"
    names = {"number": "number", "integer": "whole number", "boolean": "`true`, `false`", "string": "text"}
    return names[node["type"]] + _bounds(node)


def _bounds(node: Node) -> str:
    return "".join(f", {sign} {node[key]:.6g}" for key, sign in BOUNDS.items() if key in node)
